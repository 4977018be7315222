//! Options of the solver for programs with equilibrium constraints.

use crate::solve::{Settings, SolveError};

/// Which way to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// `pieces` where it applies, otherwise `relaxation`, and `penalty` where that fails.
    Auto,
    /// A sequence of relaxed nonlinear programs.
    Relaxation,
    /// A sequence of penalised nonlinear programs.
    Penalty,
    /// Linear programs on the pieces; for linear programs only.
    Pieces,
    /// None: the start point is judged, and solved on its own branch at most.
    Check,
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
    /// `mpec_method` = `auto | relaxation | penalty | pieces | check`.
    pub method: Method,
    /// `mpec_relaxation` = `scholtes | aggregate`: every product at most μ, or their sum.
    pub aggregate: bool,
    /// `mpec_mu`: first μ.
    pub mu: f64,
    /// `mpec_factor`: μ is multiplied by this from one program to the next.
    pub factor: f64,
    /// `mpec_mu_end`: last μ.
    pub last: f64,
    /// `mpec_starts`: further starts, after the first local solution.
    pub starts: usize,
    /// `mpec_swaps` = `yes | no`: whether anything better than the first local solution is looked for.
    pub swaps: bool,
    /// `mpec_nodes`: nodes of a search for a descent direction.
    pub nodes: usize,
    /// `mpec_bound` = `none | quick | SECONDS`.
    pub bound: Bound,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            aggregate: false,
            mu: 1e-2,
            factor: 0.1,
            last: 1e-8,
            starts: 4,
            swaps: true,
            nodes: 300,
            bound: Bound::None,
        }
    }
}

impl Options {
    /// Reads them. Errors: a value that an option does not take.
    pub fn new(settings: &Settings) -> Result<Self, SolveError> {
        let mut out = Self::default();
        for (name, value) in &settings.options {
            let name = name.to_lowercase();
            let Some(option) = name.strip_prefix("mpec_") else {
                continue;
            };
            let text = value.to_lowercase();
            let number = text.parse::<f64>().ok().filter(|v| *v >= 0.0);
            let refused = |takes: &str| {
                SolveError::new(format!("the option `{name}` takes {takes}, not `{value}`"))
            };
            match option {
                "method" => {
                    out.method = match text.as_str() {
                        "auto" => Method::Auto,
                        "relaxation" => Method::Relaxation,
                        "penalty" => Method::Penalty,
                        "pieces" => Method::Pieces,
                        "check" => Method::Check,
                        _ => {
                            return Err(refused(
                                "`auto`, `relaxation`, `penalty`, `pieces` or `check`",
                            ));
                        }
                    }
                }
                "relaxation" => {
                    out.aggregate = match text.as_str() {
                        "scholtes" => false,
                        "aggregate" => true,
                        _ => return Err(refused("`scholtes` or `aggregate`")),
                    }
                }
                "swaps" => {
                    out.swaps = match text.as_str() {
                        "yes" => true,
                        "no" => false,
                        _ => return Err(refused("`yes` or `no`")),
                    }
                }
                "bound" => {
                    out.bound = match (text.as_str(), number) {
                        ("none" | "no", _) => Bound::None,
                        ("quick" | "yes", _) => Bound::Quick,
                        (_, Some(s)) => Bound::Seconds(s),
                        _ => return Err(refused("`none`, `quick` or seconds")),
                    }
                }
                "mu" | "mu_end" | "factor" | "starts" | "nodes" => {
                    let v = number.ok_or_else(|| refused("a number that is not negative"))?;
                    match option {
                        "mu" => out.mu = v,
                        "mu_end" => out.last = v,
                        "starts" => out.starts = v as usize,
                        "nodes" => out.nodes = v as usize,
                        _ if v > 0.0 && v < 1.0 => out.factor = v,
                        _ => return Err(refused("a number between 0 and 1")),
                    }
                }
                _ => {}
            }
        }
        Ok(out)
    }
}
