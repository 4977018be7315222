//! Options of the solver for programs with equilibrium constraints.

use crate::model::named::named;
use crate::model::option::{Kind, OptionTable, row};
use crate::solve::Settings;

named! {
    /// Which way to go.
    pub enum Method {
        /// `pieces` where it applies, otherwise `relaxation`.
        Auto "auto";
        /// A sequence of relaxed nonlinear programs.
        Relaxation "relaxation";
        /// Linear programs on the pieces; for linear programs only.
        Pieces "pieces";
        /// None: the start point is judged, and solved on its own branch at most.
        Check "check";
    }
}

/// How long to look for a lower bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Not at all.
    None,
    /// A thousand nodes.
    Quick,
    /// As many seconds.
    Seconds(f64),
}

/// All options, `option mpec_… = …` or `--option mpec_…=…`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// `mpec_method` = `auto | relaxation | pieces | check`.
    pub method: Method,
    /// `mpec_mu`: first μ, where it is given.
    pub mu: Option<f64>,
    /// `mpec_factor`: μ is multiplied by this from one program to the next, where it is given.
    pub factor: Option<f64>,
    /// `mpec_mu_end`: last μ.
    pub last: f64,
    /// `mpec_starts`: further starts, after the first local solution.
    pub starts: usize,
    /// `mpec_swaps` = `no | yes`: whether anything better than the first local solution is looked for.
    pub swaps: bool,
    /// `mpec_nodes`: nodes of a search for a descent direction.
    pub nodes: usize,
    /// `mpec_bound` = `none | quick | SECONDS`.
    pub bound: Bound,
}

impl Options {
    /// What these ask for, whose values the table has passed.
    pub fn new(asked: &Settings) -> Self {
        let word = |name| asked.option(name).unwrap_or_default();
        let number = |name| asked.number_of(&OPTIONS, name);
        Self {
            method: Method::named(&word("mpec_method")).unwrap_or(Method::Auto),
            mu: asked.number("mpec_mu"),
            factor: asked.number("mpec_factor"),
            last: number("mpec_mu_end"),
            starts: number("mpec_starts") as usize,
            swaps: asked.switch("mpec_swaps").unwrap_or(false),
            nodes: number("mpec_nodes") as usize,
            bound: match word("mpec_bound").as_str() {
                "" | "none" | "no" => Bound::None,
                "quick" | "yes" => Bound::Quick,
                _ => Bound::Seconds(number("mpec_bound")),
            },
        }
    }
}

const LIMITLESS: Kind = Kind::Real(0.0, f64::INFINITY);

/// What `mpec` and `rmpec` take.
#[rustfmt::skip]
pub const OPTIONS: OptionTable = OptionTable {
    backend: "bmpec",
    title: "mpec, rmpec: bmod's own, on the linear, nonlinear and complementarity solvers",
    rows: &[
        row("mpec_method", Kind::Words(&["auto", "relaxation", "pieces", "check"]), "auto", "what leads to the branch: `pieces` where it applies, otherwise `relaxation`; `check` judges the levels as they are"),
        row("mpec_mu", LIMITLESS, "1, or 1e-2", "first μ; the smaller one up to 120 rows and columns"),
        row("mpec_factor", Kind::Inside(0.0, 1.0), "1e-3, or 0.1", "what μ is multiplied by from one program to the next; the larger one up to 120 rows and columns"),
        row("mpec_mu_end", LIMITLESS, "1e-8", "last μ"),
        row("mpec_starts", Kind::Whole(0.0, 1e9), "4", "random starts after the first local solution"),
        row("mpec_swaps", Kind::Switch, "no", "whether anything better than the first local solution is looked for"),
        row("mpec_nodes", Kind::Whole(0.0, 1e9), "300", "nodes of a search for a descent direction"),
        row("mpec_bound", Kind::WordsOrReal(&["none", "no", "quick", "yes"], 0.0, f64::INFINITY), "none", "how long a lower bound is looked for: `quick` is a thousand nodes, a number is seconds"),
    ],
    more: None,
    ignored: &[],
};
