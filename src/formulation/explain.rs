//! A model and its answer in words.

use super::convex::{Shape, shape};
use super::derive::Primal;
use super::math::explained;
use super::range::{self, Ranges};
use super::side::{costs, short};
use super::text::record;
use crate::check::node::SymbolId;
use crate::check::symbols::{Store, Symbols};
use crate::model::instance::{Relation, Sense};
use crate::model::origin::Blocks;
use crate::run::{Machine, Studied};
use crate::solve::ModelStatus;

/// More records than this are not named.
const MAX_NAMES: usize = 12;

/// What is asked of a model in words.
pub struct Explained<'a> {
    /// All names.
    pub symbols: &'a Symbols,
    /// Data.
    pub store: &'a Store,
    /// The model with its answer.
    pub primal: &'a Primal,
    /// How its solve ended.
    pub status: ModelStatus,
    /// Ranges of a linear program.
    pub ranges: Option<&'a Ranges>,
}

/// Rows and columns up to which ranges are found for an explanation.
const MAX_RANGES: usize = 200;

/// A solve in words, and its ranges if it is a small linear program.
pub fn of(m: &Machine, primal: &Primal, studied: &Studied) -> (Vec<String>, Option<Ranges>) {
    let answer = studied.answer.as_ref();
    let i = &primal.generated.instance;
    let small = i.row_count() + i.column_count() <= MAX_RANGES;
    let ranges = match small {
        true => range::of(m, primal, studied, &[]).ok(),
        false => None,
    };
    let words = explain(&Explained {
        symbols: &m.symbols,
        store: &m.store,
        primal,
        status: answer.map_or(ModelStatus::NoSolution, |a| a.1.status),
        ranges: ranges.as_ref(),
    });
    (words, ranges)
}

/// Paragraphs: what is decided, what the answer is, what binds and what it is worth, what is unused.
pub fn explain(e: &Explained) -> Vec<String> {
    let mut out = vec![e.decided(), e.size()];
    match e.status {
        ModelStatus::Optimal | ModelStatus::LocallyOptimal | ModelStatus::Solved => {
            out.push(e.answer());
            out.extend(e.binding());
            out.extend(e.unused());
            out.extend(e.reduced());
        }
        s => out.push(format!(
            "The solve ended with: {}.",
            s.name().to_lowercase()
        )),
    }
    out.retain(|p| !p.is_empty());
    out
}

impl Explained<'_> {
    /// A symbol with its explanatory text.
    fn described(&self, s: SymbolId) -> String {
        let symbol = self.symbols.get(s);
        let (_, words, unit) = explained(&symbol.text);
        let domain = self.symbols.domain_names(symbol);
        let name = match domain.is_empty() {
            true => symbol.name.to_string(),
            false => format!("{}({})", symbol.name, domain.join(",")),
        };
        let unit = unit.map_or(String::new(), |u| format!(" [{u}]"));
        match words.is_empty() {
            true => format!("{name}{unit}"),
            false => format!("{name}, {words}{unit}"),
        }
    }

    fn unit(&self, s: SymbolId) -> String {
        let unit = explained(&self.symbols.get(s).text).2;
        unit.map_or(String::new(), |u| format!(" {u}"))
    }

    fn name(&self, blocks: &Blocks, i: usize) -> String {
        let b = blocks.of(i as u32);
        record(
            self.store,
            &self.symbols.get(b.symbol).name,
            b.key(i as u32),
        )
    }

    fn decided(&self) -> String {
        let p = self.primal;
        let z = p.objective.map(|o| o.1);
        let blocks = p.generated.origin.columns.list.iter();
        let variables: Vec<String> = blocks
            .map(|b| b.symbol)
            .filter(|s| Some(*s) != z)
            .map(|s| self.described(s))
            .collect();
        let aim = match p.objective {
            Some((Sense::Minimize, z)) => {
                format!(", so that {} is as small as possible", self.described(z))
            }
            Some((Sense::Maximize, z)) => {
                format!(", so that {} is as large as possible", self.described(z))
            }
            None => ", so that all its conditions hold".into(),
        };
        format!(
            "The model {} decides on {}{aim}.",
            p.name,
            variables.join("; on ")
        )
    }

    fn size(&self) -> String {
        let p = self.primal;
        let i = &p.generated.instance;
        let (rows, columns) = (i.row_count(), i.column_count());
        let maximum = i.sign() < 0.0;
        let curved = if maximum { "concave" } else { "convex" };
        let semi = if maximum { "negative" } else { "positive" };
        let kind = match (i.objective.is_some(), shape(i)) {
            (false, _) => {
                "It is a complementarity problem or a system of equations and has no objective".into()
            }
            (_, Shape::Linear) => {
                "It is linear, and so convex: an optimum that is found is an optimum over all points".into()
            }
            (_, Shape::ConvexQuadratic { in_rows: true, .. }) => {
                "Its quadratic functions stand where it is convex (their Hessians are semidefinite): an optimum that is \
                 found is an optimum over all points"
                    .into()
            }
            (_, Shape::ConvexQuadratic { .. }) => format!(
                "Its rows are linear, and its quadratic objective is {curved} (the Hessian is {semi} semidefinite): an \
                 optimum that is found is an optimum over all points"
            ),
            (_, Shape::Quadratic(Some(row))) => format!(
                "{} is quadratic and not convex: an optimum that is found may be a local one",
                self.name(&p.generated.origin.rows, row)
            ),
            (_, Shape::Quadratic(None)) => format!(
                "Its objective is quadratic and not {curved}: an optimum that is found may be a local one"
            ),
            (_, Shape::Nonlinear(_)) => {
                "It is not linear; unless it is convex, an optimum that is found may be a local one".into()
            }
        };
        format!(
            "It has {rows} rows and {columns} columns ({}). {kind}.",
            p.using
        )
    }

    fn answer(&self) -> String {
        let p = self.primal;
        let (Some(a), Some((sense, z))) = (&p.answer, p.objective) else {
            return "It was solved.".into();
        };
        let column = p
            .generated
            .instance
            .objective
            .map_or(0, |o| o.column as usize);
        let word = match sense {
            Sense::Minimize => "smallest",
            Sense::Maximize => "largest",
        };
        let name = &self.symbols.get(z).name;
        let mut text = format!(
            "The {word} {name} is {}{}.",
            short(a.level[column]),
            self.unit(z)
        );
        let columns = &p.generated.origin.columns;
        let nonzero: Vec<String> = (0..a.level.len())
            .filter(|&j| j != column && a.level[j].abs() > 1e-9)
            .map(|j| format!("{} = {}", self.name(columns, j), short(a.level[j])))
            .collect();
        let zeros = a.level.len() - 1 - nonzero.len();
        text.push_str(&match nonzero.len() {
            0 => " All variables are 0.".to_string(),
            n if n <= MAX_NAMES => format!(" It is reached at {}", nonzero.join(", ")),
            n => format!(" It is reached with {n} variables that are not 0"),
        });
        if !nonzero.is_empty() {
            text.push_str(&match zeros {
                0 => ".".to_string(),
                1 => "; one other is 0.".to_string(),
                n => format!("; the {n} others are 0."),
            });
        }
        text
    }

    /// What binds, and what a unit more is worth, and for how long.
    fn binding(&self) -> Vec<String> {
        let p = self.primal;
        let (Some(a), Some((_, z))) = (&p.answer, p.objective) else {
            return Vec::new();
        };
        let g = &p.generated;
        let objective = &self.symbols.get(z).name;
        let mut out = Vec::new();
        for i in 0..g.instance.row_count() {
            let relation = g.instance.rows.relation[i];
            let tight = relation == Relation::Equal
                || (a.activity[i] - g.instance.rows.rhs[i]).abs()
                    <= 1e-7 * (1.0 + a.activity[i].abs());
            let defines = g
                .instance
                .matrix
                .row(i)
                .any(|(j, _)| g.instance.objective.is_some_and(|o| o.column as usize == j));
            if !tight || relation == Relation::Free || defines && relation == Relation::Equal {
                continue;
            }
            let name = self.name(&g.origin.rows, i);
            let range = self.ranges.and_then(|r| r.rows.iter().find(|r| r.row == i));
            out.push(match range {
                Some(r) if r.price[0] == r.price[1] => format!(
                    "{name} binds: one unit more on its right side changes {objective} by {}, from {} to {}.",
                    short(r.price[1]),
                    short(r.interval[0]),
                    short(r.interval[1])
                ),
                Some(r) => {
                    let of = |price: f64, word: &str| match price.is_finite() {
                        true => format!("one unit {word} changes {objective} by {}", short(price)),
                        false => format!("with {word} nothing is feasible"),
                    };
                    let degenerate = match r.price.iter().all(|p| p.is_finite()) {
                        true => ", and the vertex is degenerate",
                        false => "",
                    };
                    let [more, less] = [of(r.price[1], "more"), of(-r.price[0], "less")];
                    format!("{name} binds{degenerate}: {more}, {less}.")
                }
                None if a.row_marginal[i] == 0.0 => continue,
                None => format!(
                    "{name} binds: a little more on its right side changes {objective} by {} per unit.",
                    short(a.row_marginal[i])
                ),
            });
        }
        shortened(out, "rows that bind")
    }

    fn unused(&self) -> Vec<String> {
        let p = self.primal;
        let Some(a) = &p.answer else {
            return Vec::new();
        };
        let g = &p.generated;
        let mut out = Vec::new();
        for i in 0..g.instance.row_count() {
            let slack = (a.activity[i] - g.instance.rows.rhs[i]).abs();
            let relation = g.instance.rows.relation[i];
            let inequality = matches!(relation, Relation::Less | Relation::Greater);
            if inequality && slack > 1e-7 * (1.0 + a.activity[i].abs()) {
                let name = self.name(&g.origin.rows, i);
                out.push(format!("{name} does not bind: {} are left.", short(slack)));
            }
        }
        shortened(out, "rows that do not bind")
    }

    fn reduced(&self) -> Vec<String> {
        let p = self.primal;
        let (Some(a), Some((_, z)), true) =
            (&p.answer, p.objective, p.generated.instance.is_linear())
        else {
            return Vec::new();
        };
        let objective = &self.symbols.get(z).name;
        let g = &p.generated;
        let c = &g.instance.columns;
        let (_, cost) = costs(&g.instance);
        let mut out = Vec::new();
        let mut others = Vec::new();
        for (j, &d) in a.column_marginal.iter().enumerate() {
            let at = a.level[j] == c.lower[j] || a.level[j] == c.upper[j];
            if !at || c.lower[j] == c.upper[j] {
                continue;
            }
            let name = self.name(&g.origin.columns, j);
            if d.abs() < 1e-9 {
                others.push(name);
                continue;
            }
            let which = if a.level[j] == c.lower[j] {
                "lower"
            } else {
                "upper"
            };
            let change = match a.level[j] == 0.0 && cost[j] != 0.0 {
                true => format!(
                    "its coefficient, {}, would have to become {}",
                    short(cost[j]),
                    short(cost[j] - d)
                ),
                false => format!("a unit more would change {objective} by {}", short(d)),
            };
            out.push(format!(
                "{name} is at its {which} bound, {}: {change}.",
                short(a.level[j])
            ));
        }
        let mut out = shortened(out, "variables at a bound");
        if !others.is_empty() {
            others.truncate(MAX_NAMES);
            out.push(format!(
                "The optimum may not be the only one: {} could leave a bound without changing {objective}.",
                others.join(", ")
            ));
        }
        out
    }
}

fn shortened(mut list: Vec<String>, what: &str) -> Vec<String> {
    let more = list.len().saturating_sub(MAX_NAMES);
    if more > 0 {
        list.truncate(MAX_NAMES);
        list.push(format!("There are {more} more {what}."));
    }
    list
}
