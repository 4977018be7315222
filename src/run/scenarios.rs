//! `solve m using lp min z scenario dict;`: a model is solved once as it stands and once for each scenario of a set.
//!
//! The records of `dict` say `symbol.role.other`: a parameter, or the `lower`, `upper`, `fixed` of a variable, takes
//! the scenario's part of `other`; `level` and `marginal` are collected in `other`; `opt` names options
//! (`updateType`, `skipBaseCase`) and where the attributes of the model go. What has no value in a scenario is 0, unless
//! `updateType` is 1 (as in the base case) or 2 (as in the scenario before). A scenario without any value is left out.
//!
//! Invariant: behind the solve all symbols are as the base case left them, but those that collect results.

use super::{Flow, Frame, Machine};
use crate::check::node::{SolveCode, SymbolId, TableId};
use crate::check::symbols::{Symbol, SymbolKind, attribute};
use crate::data::table::Table;
use crate::data::universe::Label;
use crate::data::value::EPS;
use crate::diag::Diagnostic;
use crate::source::Span;

/// Attributes of a model that are reported where a label has their name.
#[rustfmt::skip]
const REPORTED: &[&str] = &[
    "domusd", "iterusd", "objest", "nodusd", "modelstat", "numnopt", "numinfes", "objval", "resusd",
    "solvestat", "suminfes",
];

/// A dictionary, read.
#[derive(Default)]
struct Plan {
    /// The set of the scenarios.
    scenarios: TableId,
    /// Tables that take a scenario's part of the last one.
    inputs: Vec<(Vec<TableId>, TableId)>,
    /// A table and the one that collects it.
    outputs: Vec<(TableId, TableId)>,
    options: Option<TableId>,
    report: Option<TableId>,
}

impl Machine<'_> {
    /// The solves of a statement.
    pub(super) fn scenarios(
        &mut self,
        dict: SymbolId,
        s: &SolveCode,
        span: Span,
        frame: &mut Frame,
    ) -> Flow {
        self.store.tables.iter_mut().for_each(Table::tidy);
        let plan = match self.scenario_plan(dict) {
            Ok(plan) => plan,
            Err(why) => {
                let help =
                    "its records look like `s.scenario.''`, `demand.param.demands`, `x.level.xs`";
                Diagnostic::execution("E0424", span)
                    .says(format!(
                        "the dictionary of the scenarios cannot be used: {why}"
                    ))
                    .label("not solved")
                    .help(help)
                    .note(self);
                return Flow::Stop;
            }
        };
        let skip = self.scenario_option(&plan, "skipbasecase") != 0.0;
        let update = self.scenario_option(&plan, "updatetype");
        if !skip && let Flow::Stop = self.solve_once(s, span, frame) {
            return Flow::Stop;
        }
        self.store.tables.iter_mut().for_each(Table::tidy);
        let base = self.store.tables.clone();
        let state = self.models.get(&s.model).cloned();
        let collect =
            |t: TableId| Table::new(base[t as usize].dim(), base[t as usize].default_value());
        let mut results: Vec<Table> = plan.outputs.iter().map(|o| collect(o.1)).collect();
        let mut report = plan.report.map(collect);
        let set = &base[plan.scenarios as usize];
        for scenario in set.all_keys().chunks_exact(set.dim().max(1)) {
            for (n, table) in base.iter().enumerate() {
                let input = plan.inputs.iter().any(|i| i.0.contains(&(n as TableId)));
                if update != 2.0 || !input {
                    self.store.tables[n] = table.clone();
                }
            }
            let mut given = plan.inputs.is_empty();
            for (targets, source) in &plan.inputs {
                for &t in targets {
                    let target = self.store.table_mut(t);
                    if update == 0.0 {
                        target.clear();
                        target.set_default(0.0);
                    }
                    for (key, v) in base[*source as usize].iter() {
                        if let Some(rest) = key.strip_prefix(scenario) {
                            target.set(rest, v);
                            given = true;
                        }
                    }
                }
            }
            if !given {
                continue;
            }
            if let Flow::Stop = self.solve_once(s, span, frame) {
                return Flow::Stop;
            }
            for ((from, _), to) in plan.outputs.iter().zip(&mut results) {
                let from = self.store.table_mut(*from);
                from.tidy();
                if from.dim() == 0 {
                    to.set(scenario, from.get(&[]));
                } else {
                    from.iter()
                        .for_each(|(k, v)| to.set(&[scenario, k].concat(), v));
                }
            }
            for name in REPORTED {
                if let (Some(report), Some(label)) = (&mut report, self.store.universe.get(name)) {
                    let v = self.models.get(&s.model).and_then(|m| m.get(name));
                    let v = v.filter(|v| *v != 0.0).unwrap_or(EPS);
                    report.set(&[scenario, &[label]].concat(), v);
                }
            }
        }
        self.store.tables = base;
        self.models.extend(state.map(|state| (s.model, state)));
        for ((_, to), table) in plan.outputs.iter().zip(results) {
            *self.store.table_mut(*to) = table;
        }
        if let (Some(to), Some(table)) = (plan.report, report) {
            *self.store.table_mut(to) = table;
        }
        Flow::Next
    }

    fn scenario_option(&self, plan: &Plan, name: &str) -> f64 {
        let label = self.store.universe.get(name);
        match (plan.options, label) {
            (Some(t), Some(label)) => self.store.table(t).get(&[label]),
            _ => 0.0,
        }
    }

    fn scenario_plan(&self, dict: SymbolId) -> Result<Plan, String> {
        let (mut plan, mut found) = (Plan::default(), None);
        let dict = self.store.table(self.symbols.rooted(dict).table);
        let name = |l: Label| self.store.universe.name(l);
        let depth = dict
            .iter()
            .find(|(k, _)| name(k[1]).eq_ignore_ascii_case("scenario"))
            .and_then(|(k, _)| self.symbols.find(name(k[0])))
            .map_or(1, |s| self.symbols.get(s).dim());
        for (key, _) in dict.iter() {
            let find = |l: Label| match self.symbols.find(name(l)) {
                Some(s) => Ok(self.symbols.rooted(s)),
                None => Err(format!("`{}` is not known", name(l))),
            };
            let first = find(key[0])?;
            let role = name(key[1]).to_lowercase();
            if role == "scenario" {
                found = first.is_set().then_some(first.table);
                continue;
            }
            if role == "opt" {
                plan.options = Some(first.table);
                let report = find(key[2]).ok().filter(|s| s.dim() == depth + 1);
                plan.report = report.map(|s| s.table);
                continue;
            }
            let other = find(key[2])?;
            let (input, offsets): (bool, &[u32]) = match role.as_str() {
                "param" => (true, &[0]),
                "lower" => (true, &[attribute::LO]),
                "upper" => (true, &[attribute::UP]),
                "fixed" => (true, &[attribute::LO, attribute::UP]),
                "level" => (false, &[attribute::L]),
                "marginal" => (false, &[attribute::M]),
                _ => return Err(format!("there is no role `{role}`")),
            };
            let parameter = |s: &Symbol| matches!(s.kind, SymbolKind::Parameter { .. });
            let fits = match role.as_str() {
                "param" => parameter(first),
                _ => first.has_attributes(),
            };
            if !fits || !parameter(other) || other.dim() != first.dim() + depth {
                let (first, other) = (&first.name, &other.name);
                return Err(format!("`{first}.{role}.{other}` does not fit"));
            }
            let tables = offsets.iter().map(|o| first.table + o);
            match input {
                true => plan.inputs.push((tables.collect(), other.table)),
                false => plan.outputs.extend(tables.map(|t| (t, other.table))),
            }
        }
        match found {
            Some(scenarios) => Ok(Plan { scenarios, ..plan }),
            None => Err("no record has the role `scenario`".into()),
        }
    }
}
