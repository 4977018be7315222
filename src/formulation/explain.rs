//! A model and its answer in words.

mod said;

use super::Scope;
use super::derive::Primal;
use super::math::explained;
use super::range::{self, Ranges, RowRange};
use super::side::{costs, short};
use crate::check::node::SymbolId;
use crate::model::instance::{ColumnKind, Relation, Sense};
use crate::model::origin::Blocks;
use crate::report::format::counted;
use crate::run::{Machine, Studied};
use crate::solve::ModelStatus;
use crate::solve::nlp::convex::{Shape, shape};
use said::{MAX_NAMES, Said, listed, worth};

/// A reduced cost, or a way to another optimum, below this is 0, relative.
const NONE: f64 = 1e-9;

/// What is asked of a model in words.
pub struct Explained<'a> {
    /// Names, and data as they were at the solve.
    pub scope: Scope<'a>,
    /// The model with its answer.
    pub primal: &'a Primal,
    /// How its solve ended.
    pub status: ModelStatus,
    /// Ranges of a linear program.
    pub ranges: Option<&'a Ranges>,
    /// The cones of a program that is recognised as convex.
    pub cones: Option<String>,
}

/// Rows and columns up to which ranges are found for an explanation.
const MAX_RANGES: usize = 1000;

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
        scope: Scope::of(m),
        primal,
        status: answer.map_or(ModelStatus::NoSolution, |a| a.1.status),
        ranges: ranges.as_ref(),
        cones: primal.cones(),
    });
    (words, ranges)
}

/// Paragraphs: what is decided, what the answer is, what binds and what it is worth, what is unused.
pub fn explain(e: &Explained) -> Vec<String> {
    let mut out = vec![e.decided(), e.size()];
    match e.status {
        s if s.is_solution() || s == ModelStatus::IntegerSolution => {
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
        let symbol = self.scope.get(s);
        let (_, words, unit) = explained(&symbol.text);
        let domain = self.scope.symbols.domain_names(symbol);
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
        let unit = explained(&self.scope.get(s).text).2;
        unit.map_or(String::new(), |u| format!(" {u}"))
    }

    fn name(&self, blocks: &Blocks, i: usize) -> String {
        self.scope.called(blocks, i)
    }

    fn decided(&self) -> String {
        let p = self.primal;
        let z = p.objective.map(|o| o.1);
        let blocks = p.generated.origin.columns.list.iter();
        let variables = blocks.map(|b| b.symbol).filter(|s| Some(*s) != z);
        let variables: Vec<String> = variables.map(|s| self.described(s)).collect();
        let aim = match p.objective {
            Some((sense, z)) => {
                let name = self.described(z);
                let comma = if name.contains(',') { "," } else { "" };
                let how = match sense {
                    Sense::Minimize => "small",
                    Sense::Maximize => "large",
                };
                format!(", so that {name}{comma} is as {how} as possible")
            }
            None => ", so that all its conditions hold".into(),
        };
        let variables = variables.join("; on ");
        format!("The model {} decides on {variables}{aim}.", p.name)
    }

    /// How many columns are discrete choices.
    fn discrete(&self) -> usize {
        let c = &self.primal.generated.instance.columns;
        let undecided =
            |j: &usize| c.kind[*j] != ColumnKind::Continuous && c.lower[*j] < c.upper[*j];
        match self.primal.using.starts_with('r') {
            true => 0,
            false => (0..c.kind.len()).filter(undecided).count(),
        }
    }

    fn size(&self) -> String {
        let p = self.primal;
        let i = &p.generated.instance;
        let (curved, semi) = match i.sign() < 0.0 {
            true => ("concave", "negative"),
            false => ("convex", "positive"),
        };
        let row = |k| self.name(&p.generated.origin.rows, k);
        let global = "an optimum that is found is an optimum over all points";
        let local = "an optimum that is found may be a local one";
        let discrete = self.discrete();
        let kind = match (i.objective.is_some(), shape(i)) {
            (false, _) => {
                "It is a complementarity problem or a system of equations and has no objective"
                    .into()
            }
            (_, Shape::Linear) if discrete > 0 => {
                format!("It is linear but for {}", discretely(discrete))
            }
            (_, Shape::Linear) => format!("It is linear, and so convex: {global}"),
            (_, Shape::ConvexQuadratic { in_rows: true, .. }) => format!(
                "Its quadratic functions stand where it is convex (their Hessians are semidefinite): {global}"
            ),
            (_, Shape::ConvexQuadratic { .. }) => format!(
                "Its rows are linear, and its quadratic objective is {curved} (the Hessian is {semi} semidefinite): {global}"
            ),
            (_, Shape::Quadratic(_) | Shape::Nonlinear(_)) if self.cones.is_some() => {
                let cones = self.cones.as_deref().unwrap_or_default();
                format!("It is convex ({cones}): {global}")
            }
            (_, Shape::Quadratic(Some(k))) => {
                format!("{} is quadratic and not convex: {local}", row(k))
            }
            (_, Shape::Quadratic(None)) => {
                format!("Its objective is quadratic and not {curved}: {local}")
            }
            (_, Shape::Nonlinear(_)) => format!("It is not linear; unless it is convex, {local}"),
        };
        let also = match discrete > 0 && !i.is_linear() {
            true => format!(" It has {}.", discretely(discrete)),
            false => String::new(),
        };
        let rows = counted(i.row_count(), "row");
        let columns = counted(i.column_count(), "column");
        format!("It has {rows} and {columns} ({}). {kind}.{also}", p.using)
    }

    fn answer(&self) -> String {
        let p = self.primal;
        let Some(a) = &p.answer else {
            return "It was solved.".into();
        };
        let i = &p.generated.instance;
        let column = i.objective.map(|o| o.column as usize);
        let convex = matches!(shape(i), Shape::Linear | Shape::ConvexQuadratic { .. });
        let proved = (convex || self.cones.is_some() && self.status == ModelStatus::Optimal)
            && self.status != ModelStatus::IntegerSolution;
        let mut text = match p.objective.zip(column) {
            Some(((sense, z), column)) => format!(
                "The {} {}{} is {}{}.",
                match sense {
                    Sense::Minimize => "smallest",
                    Sense::Maximize => "largest",
                },
                self.scope.get(z).name,
                if proved { "" } else { " found" },
                short(a.level[column]),
                self.unit(z)
            ),
            None => "It was solved.".into(),
        };
        let columns = &p.generated.origin.columns;
        let others = (0..a.level.len()).filter(|j| Some(*j) != column);
        let (nonzero, zeros): (Vec<usize>, Vec<usize>) =
            others.partition(|&j| a.level[j].abs() > 1e-9);
        text.pop();
        text.push_str(&match nonzero.len() {
            0 => return text + ": all variables are 0.",
            n if n > MAX_NAMES => format!(": {n} variables are not 0"),
            _ => {
                let one = |&j: &usize| format!("{} = {}", self.name(columns, j), short(a.level[j]));
                let each: Vec<String> = nonzero.iter().map(one).collect();
                format!(", at {}", each.join(", "))
            }
        });
        text.push_str(&match zeros.len() {
            0 => ".".to_string(),
            1 => "; one other is 0.".to_string(),
            n => format!("; the {n} others are 0."),
        });
        text
    }

    /// What binds, and what a unit more is worth, and for how long.
    fn binding(&self) -> Vec<String> {
        let p = self.primal;
        let (Some(a), Some((_, z))) = (&p.answer, p.objective) else {
            return Vec::new();
        };
        let g = &p.generated;
        let rows = &g.instance.rows;
        let discrete = self.discrete() > 0;
        let defines = g.instance.objective_row().map(|r| r.0);
        let mut by_row = self.ranges.map_or(&[][..], |r| &r.rows).iter().peekable();
        let mut out = Vec::new();
        for i in 0..rows.relation.len() {
            let range = by_row.next_if(|r| r.row == i);
            let equal = rows.relation[i] == Relation::Equal;
            let off = (a.activity[i] - rows.rhs[i]).abs();
            let tight = equal || off <= 1e-7 * (1.0 + a.activity[i].abs());
            let price = a.row_marginal[i];
            let silent = match (discrete, range) {
                (true, _) => equal,
                (_, None) => price == 0.0,
                _ => false,
            };
            if !tight || silent || rows.relation[i] == Relation::Free || equal && defines == Some(i)
            {
                continue;
            }
            let objective = &self.scope.get(z).name;
            let (lead, number, words) = match discrete {
                true => Default::default(),
                false => worth(range, price, objective, g.instance.is_linear()),
            };
            out.push(Said {
                at: i,
                verb: ["binds", "bind"],
                place: String::new(),
                words,
                lead,
                number,
            });
        }
        let mut out = self.told(&g.origin.rows, "row", out);
        let two = |r: &&RowRange| r.price[0] != r.price[1] && r.price.iter().all(|p| p.is_finite());
        if self.ranges.is_some_and(|r| r.rows.iter().any(|r| two(&r))) {
            out.push(
                "The vertex is degenerate: a unit less is not worth what a unit more is.".into(),
            );
        }
        out
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
                out.push(Said {
                    at: i,
                    verb: ["does not bind", "do not bind"],
                    place: String::new(),
                    words: format!("its slack is {}", short(slack)),
                    lead: "their slacks are".into(),
                    number: slack,
                });
            }
        }
        self.told(&g.origin.rows, "row", out)
    }

    /// Columns at a bound, and what would make them leave it.
    fn reduced(&self) -> Vec<String> {
        let p = self.primal;
        let g = &p.generated;
        let (Some(a), Some((sense, z))) = (&p.answer, p.objective) else {
            return Vec::new();
        };
        if !g.instance.is_linear() || self.discrete() > 0 {
            return Vec::new();
        }
        let objective = &self.scope.get(z).name;
        let c = &g.instance.columns;
        let (_, cost) = costs(&g.instance);
        let mut by_column = self.ranges.map_or(&[][..], |r| &r.costs).iter().peekable();
        let one_price = |r: &Ranges| r.rows.iter().all(|r| r.price[0] == r.price[1]);
        let unique = self.ranges.is_some_and(one_price);
        let mut out = Vec::new();
        let mut others = Vec::new();
        for (j, &d) in a.column_marginal.iter().enumerate() {
            let range = by_column.next_if(|r| r.column == j);
            let lower = a.level[j] == c.lower[j];
            if !lower && a.level[j] != c.upper[j] || c.lower[j] == c.upper[j] {
                continue;
            }
            // It stays at a bound as long as its coefficient is on one side of this.
            let falls = lower == (sense == Sense::Minimize);
            let limit = range.map(|r| r.interval[usize::from(!falls)]);
            let away = limit.map_or(d, |limit| cost[j] - limit);
            if away.abs() <= NONE * (1.0 + cost[j].abs()) {
                others.push(self.name(&g.origin.columns, j));
                continue;
            }
            let [how, to] = [["rise", "above"], ["fall", "below"]][usize::from(falls)];
            let (now, by) = (short(cost[j]), short(d));
            let (lead, number, words) = match limit {
                Some(limit) if a.level[j] == 0.0 && limit.is_finite() => (
                    format!("what a coefficient would have to {how} by to leave them is"),
                    away.abs(),
                    format!(
                        "its coefficient, {now}, would have to {how} {to} {}",
                        short(limit)
                    ),
                ),
                _ if unique => (
                    format!("raising one a little changes {objective}, per unit, by"),
                    d,
                    format!("raising it a little changes {objective} by {by} per unit"),
                ),
                _ => {
                    let words = format!("its reduced cost is {by}");
                    ("the reduced costs are".into(), d, words)
                }
            };
            let verb = match lower {
                true => ["is at its lower bound", "are at their lower bounds"],
                false => ["is at its upper bound", "are at their upper bounds"],
            };
            out.push(Said {
                at: j,
                verb,
                place: format!(", {}", short(a.level[j])),
                words,
                lead,
                number,
            });
        }
        let mut out = self.told(&g.origin.columns, "column", out);
        if !others.is_empty() {
            let (is, could) = match self.ranges.is_some() {
                true => ("is", "can"),
                false => ("may", "could"),
            };
            let be = if is == "may" { " be" } else { "" };
            out.push(format!(
                "The optimum {is} not{be} the only one: {} {could} leave a bound without changing {objective}.",
                listed(&others, MAX_NAMES)
            ));
        }
        out
    }
}

fn discretely(n: usize) -> String {
    let columns = counted(n, "discrete column");
    format!("{columns}, which are decided by a search")
}
