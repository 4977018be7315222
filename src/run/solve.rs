//! The `solve` statement: generate, solve, certify, store, report.

use super::generate::{GenerateOptions, Generated};
use super::options::ListOptions;
use super::{Flow, Frame, Machine};
use crate::check::node::*;
use crate::check::symbols::attribute;
use crate::data::table::Table;
use crate::data::value::{EPS, NA, number};
use crate::diag::Diagnostic;
use crate::model::instance::{ColumnKind, Instance, Relation};
use crate::model::language::LANGUAGE;
use crate::model::option::Kind;
use crate::model::origin::{Blocks, Origin};
use crate::model::outcome::{Basis, ModelStatus, SolverStatus};
use crate::model::problem_type::{Discrete, ProblemType};
use crate::report::names::Names;
use crate::report::why::{Explanation, explain};
use crate::report::{json, levels, listing, solution, summary};
use crate::solve::answer::{Answer, answer_with, certify};
use crate::solve::backend::{Backend, Task};
use crate::solve::certificate::nonlinear::activity;
use crate::solve::mip::{self, Aim};
use crate::solve::registry::BACKENDS;
use crate::solve::why;
use crate::solve::{Budget, Limits, Monitor, Progress, Settings, SolveError, range};
use crate::source::Span;
use std::sync::Arc;

/// What solvers see of a run, and the names of rows and columns, made when asked for.
struct RunNames<'a, 'h> {
    machine: &'a Machine<'h>,
    origin: &'a Origin,
}

impl Monitor for RunNames<'_, '_> {
    fn log(&mut self, line: &str) {
        self.machine.print(&format!("{line}\n"));
    }

    fn interrupted(&mut self) -> bool {
        self.machine.host().interrupted()
    }

    fn seconds(&mut self) -> f64 {
        self.machine.host().elapsed()
    }

    fn memory(&mut self) -> usize {
        self.machine.host().memory()
    }

    fn progress(&mut self, progress: &Progress) {
        self.machine.host().progress(&progress.line());
    }

    fn row_name(&self, row: usize) -> String {
        self.machine.origin_name(&self.origin.rows, row)
    }

    fn column_name(&self, column: usize) -> String {
        self.machine.origin_name(&self.origin.columns, column)
    }
}

/// How to mend a start at which a function has no value; `x`: a variable that stands in it.
fn start_help(message: &str, x: &str) -> String {
    if message.contains("the base of a real power") {
        return "a whole power of a number that may be negative is `sqr(x)` or `power(x, n)`"
            .into();
    }
    let (name, key) = x.split_at(x.find('(').unwrap_or(x.len()));
    format!(
        "variables start at 0, or at the bound next to it: give a start, and a bound inside of the function's domain, such as `{name}.l{key} = 1; {name}.lo{key} = 1e-6;`"
    )
}

impl<'h> Machine<'h> {
    /// `equil('b3','x')`
    pub fn origin_name(&self, blocks: &Blocks, i: usize) -> String {
        match blocks.get(i as u32) {
            Some(b) => self.record_name(b.symbol, b.key(i as u32)),
            None => "an auxiliary row or column".into(),
        }
    }

    /// A model option: the model's own attribute, the `option` statement, or the default.
    pub(super) fn model_option(&self, model: SymbolId, name: &'static str, default: f64) -> f64 {
        // What is `na` was not said: so reads what was never assigned.
        let own = self.models.get(&model).and_then(|m| m.get(name));
        own.map(number)
            .filter(|x| !x.is_nan())
            .or_else(|| self.options.number(name))
            .unwrap_or(default)
    }

    /// Whether the model's own options lie in their ranges; what does not is said. GAMS lets pass what may be words.
    fn has_valid_attributes(&mut self, model: SymbolId, span: Span) -> bool {
        let Some(state) = self.models.get(&model) else {
            return true;
        };
        let outside = LANGUAGE.rows.iter().filter_map(|row| {
            let value = state.get(row.name).map(number).filter(|v| !v.is_nan())?;
            let (low, high) = row.kind.range();
            (!(low..=high).contains(&value)).then_some((row, value))
        });
        let mut valid = true;
        for (row, value) in outside.collect::<Vec<_>>() {
            let name = format!("{}.{}", self.symbols.get(model).name, row.name);
            let message = format!("`{name}` takes {}, not {value}", row.kind.words());
            let may_be_word = matches!(row.kind, Kind::WordsOrReal(..));
            let d = match may_be_word {
                true => Diagnostic::warning("E0423", span),
                false => Diagnostic::execution("E0423", span),
            };
            valid &= may_be_word;
            if !may_be_word || self.passed_over.insert(name) {
                d.says(message).label("at this solve").note(self);
            }
        }
        valid
    }

    pub(super) fn solve(&mut self, s: &SolveCode, span: Span, frame: &mut Frame) -> Flow {
        let flow = match s.scenario {
            Some(dict) => self.scenarios(dict, s, span, frame),
            None => self.solve_once(s, span, frame),
        };
        self.report().solving = None;
        self.look_soon();
        flow
    }

    pub(super) fn solve_once(&mut self, s: &SolveCode, span: Span, frame: &mut Frame) -> Flow {
        if self.failed() || self.statements_failed() > 0 {
            return self.unsolved(s, span);
        }
        if !self.has_valid_attributes(s.model, span) {
            return Flow::Stop;
        }
        let begin = self.elapsed();
        let options = GenerateOptions {
            hold_fixed: self.model_option(s.model, "holdfixed", 0.0) != 0.0,
            scale: self.model_option(s.model, "scaleopt", 0.0) != 0.0,
            keep_paired: s.using.has_pairs(),
        };
        if self.study(s, span) {
            return Flow::Next;
        }
        let name = self.symbols.get(s.model).name.to_string();
        self.doing.replace(format!("generating {name}"));
        self.host().progress(&self.doing.borrow());
        self.begins(s, None);
        // Equations have slots of their own: the loop around the solve keeps its labels.
        let mut own = frame.clone();
        let generated = self.generate(s, options, &mut own);
        self.doing.replace(super::STATEMENTS.into());
        let Some(mut generated) = generated else {
            return match self.stopped() {
                true => Flow::Stop,
                false => self.unsolved(s, span),
            };
        };
        let generated_at = self.elapsed();
        if let Some(list) = self.options.list.clone() {
            self.print_listing(&name, &generated, &list);
            self.report().solves.push(self.not_solved(s, &generated));
            self.leave_unsolved(s.model, &generated, span);
            return Flow::Next;
        }
        let choice = self.options.texts.get(s.using.name()).cloned();
        let task = Task::new(s.using, &generated.instance).by(choice.as_deref());
        let Some(mut options) = self.option_file(s.model, &task, span) else {
            return Flow::Stop;
        };
        // The command line and the `option` statement have the last word.
        options.extend(self.options.solver_options.iter().cloned());
        let settings = Settings {
            options,
            search: self.search_aim(s.model),
        };
        self.begins(s, Some(&generated));
        self.host().progress(&format!(
            "solving {name}: {} rows, {} columns",
            generated.instance.row_count(),
            generated.instance.column_count()
        ));
        if s.using.is_system() {
            let square = s.using == ProblemType::Cns;
            self.examine(&generated.instance, &generated.origin, square, span);
        }
        let mut monitor = self.names(&generated);
        let budget = Budget::new(&mut monitor, self.limits(s.model), self.options.log);
        let instance = &generated.instance;
        let start = self.start(s.model, instance, &settings);
        let task = Task {
            basis: start.as_deref(),
            ..task
        };
        let result = answer_with(BACKENDS, &task, &settings, &budget);
        match result {
            Ok(mut a) => {
                self.certified(s, &generated, &mut a);
                if let Some(basis) = &a.outcome.basis {
                    let basis = Arc::new(basis.clone());
                    self.options.bases.insert(s.model, basis);
                }
                self.study_answer(&generated, &a);
                let end = self.elapsed();
                generated.seconds = json::Seconds {
                    generate: generated_at - begin,
                    solve: end - generated_at,
                    total: end - begin,
                };
                self.take_answer(s, generated, a, span)
            }
            Err(e) => {
                self.report_refusal(s, &generated, &e, span);
                Flow::Stop
            }
        }
    }

    /// What a solver sees of the run, and the names of an instance.
    fn names<'a>(&'a self, g: &'a Generated) -> RunNames<'a, 'h> {
        RunNames {
            machine: self,
            origin: &g.origin,
        }
    }

    /// Stores and reports what a solve gave.
    fn take_answer(&mut self, s: &SolveCode, generated: Generated, a: Answer, span: Span) -> Flow {
        if self.is_submitted(s) {
            return self.submit(s, generated, a, span);
        }
        self.store_answer(s, &generated, &a, span);
        self.report_solve(s, &generated, &a);
        if self.options.keep_solutions {
            self.kept.push(KeptSolve {
                model: self.symbols.get(s.model).name.to_string(),
                using: s.using,
                generated,
                answer: a,
            });
        }
        match self.interrupted() {
            true => Flow::Stop,
            false => Flow::Next,
        }
    }

    /// Stores what a solve gave.
    pub(super) fn store_answer(
        &mut self,
        s: &SolveCode,
        generated: &Generated,
        a: &Answer,
        span: Span,
    ) {
        self.store_outside(s, generated);
        self.store(generated, a);
        self.ranged(s, generated, a);
        self.remember(s, generated, a);
        let savepoint = self.model_option(s.model, "savepoint", 0.0);
        self.save_point(s.model, savepoint, &generated.origin, span);
    }

    /// Says why a model cannot be solved as it is, at the equation that is to blame.
    fn report_refusal(&mut self, s: &SolveCode, generated: &Generated, e: &SolveError, span: Span) {
        let origin = &generated.origin;
        let name = &self.symbols.get(s.model).name;
        let mut message = format!("the model `{name}` was not solved: {}", e.message);
        if let Some(r) = e.row {
            message.push_str(&format!(" (row {})", self.origin_name(&origin.rows, r)));
        }
        let column = e.column.map(|c| self.origin_name(&origin.columns, c));
        if let Some(c) = &column {
            message.push_str(&format!(" (column {c})"));
        }
        // The equation is the better place, where one is to blame.
        let blamed = e.row.and_then(|r| {
            let symbol = origin.rows.of(r as u32).symbol;
            let of = |d: &&EquationDef| d.symbol == symbol;
            self.equations.iter().find(of).map(|d| d.span)
        });
        let mut d = Diagnostic::execution("E0422", blamed.unwrap_or(span)).says(message);
        if e.message.contains("at the start point") {
            d = d.help(start_help(&e.message, column.as_deref().unwrap_or("x")));
        }
        match blamed {
            Some(_) => d.label("this row").other(span, "at this solve"),
            None => d.label("at this solve"),
        }
        .note(self);
        let report = self.not_solved(s, generated);
        self.report().solves.push(report);
    }

    /// After an error the run ends here; errors that `maxExecError` lets pass skip the solve.
    fn unsolved(&mut self, s: &SolveCode, span: Span) -> Flow {
        if self.failed() {
            self.explain_assigned_errors();
            self.consequence(span, "so this is not solved, and the run ends here");
            return Flow::Stop;
        }
        self.consequence(span, "so this solve is skipped");
        let status = [
            ("modelstat", ModelStatus::NoSolution as u8),
            ("solvestat", SolverStatus::ProcessingSkipped as u8),
        ];
        let state = self.models.entry(s.model).or_default();
        let status = status.map(|(name, code)| (name, f64::from(code)));
        state.attributes.extend(status);
        Flow::Next
    }

    fn limits(&self, model: SymbolId) -> Limits {
        let left = (self.options.time_limit - self.elapsed()).max(0.0);
        let count = |name, default: f64| self.model_option(model, name, default).clamp(0.0, 1e18);
        Limits {
            seconds: self.model_option(model, "reslim", 1e10).min(left),
            iterations: count("iterlim", 2_147_483_647.0) as u64,
            evaluation_failures: count("domlim", 0.0) as u64,
            memory: self.memory,
            memory_is_requested: self.options.max_memory.is_some(),
        }
    }

    /// The basis that the last solve of a model has left, if it fits; `bratio = 1` and a `method` ask for none.
    fn start(&self, model: SymbolId, g: &Instance, settings: &Settings) -> Option<Arc<Basis>> {
        let basis = self.options.bases.get(&model)?;
        let fits = basis.len() == g.column_count() + g.row_count();
        let wanted = self.model_option(model, "bratio", 0.25) < 1.0;
        (fits && wanted && settings.option("method").is_none()).then(|| Arc::clone(basis))
    }

    /// What a search over discrete columns is to reach.
    fn search_aim(&self, model: SymbolId) -> Aim {
        let standard = Aim::default();
        let stated = |name| {
            let of_model = self.models.get(&model).and_then(|m| m.get(name));
            of_model.map(number).or_else(|| self.options.number(name))
        };
        let number = |name, default| {
            let value: f64 = stated(name).unwrap_or(default);
            if value.is_finite() { value } else { default }
        };
        Aim {
            relative_gap: number("optcr", standard.relative_gap),
            absolute_gap: number("optca", standard.absolute_gap),
            nodes: number("nodlim", 0.0).clamp(0.0, 1e18) as u64,
            cutoff: stated("cutoff").filter(|c| c.is_finite()),
            cheat: number("cheat", 0.0),
            try_start: number("tryint", 0.0),
            priorities: number("prioropt", 0.0) != 0.0,
            record: self.options.collect,
        }
    }

    /// The ranges of an optimal linear program, where `option ranging` asks for them, as attributes of its symbols.
    fn ranged(&mut self, s: &SolveCode, g: &Generated, a: &Answer) {
        self.ranges.clear();
        let linear = g.instance.is_linear() && g.instance.objective.is_some();
        let wanted = self.options.number("ranging") == Some(1.0);
        let integers = Task::new(s.using, &g.instance).has_integers();
        if !wanted || !linear || integers || s.using.has_pairs() || a.status != ModelStatus::Optimal
        {
            return;
        }
        let end = self.elapsed() + self.limits(s.model).seconds;
        let (p, all) = (&g.instance, |_| true);
        let in_time = || self.elapsed() < end && !self.host().interrupted();
        let r = range::ranges(p, &a.outcome.level, &a.activity, &all, &all, &in_time);
        use Derived::{PriceLo, PriceUp, RangeLo, RangeUp};
        let mut set = |blocks: &Blocks, i: usize, values: &[(Derived, f64)]| {
            let b = blocks.of(i as u32);
            let key = b.key(i as u32);
            for &(d, v) in values {
                let empty = || Table::new(key.len(), NA);
                let table = self.ranges.entry((b.symbol, d)).or_insert_with(empty);
                table.set(key, v);
            }
        };
        for r in &r.rows {
            let ([low, high], [below, above]) = (r.interval, r.price);
            let prices = [(PriceLo, below), (PriceUp, above)];
            set(&g.origin.rows, r.row, &[(RangeLo, low), (RangeUp, high)]);
            set(&g.origin.rows, r.row, &prices);
        }
        for c in &r.costs {
            let [low, high] = c.interval;
            let range = [(RangeLo, low), (RangeUp, high)];
            set(&g.origin.columns, c.column, &range);
        }
        self.ranges.values_mut().for_each(Table::tidy);
    }

    /// A proved interval for the objective of a linear program, with discrete columns or without, where `certify` asks for one. Why
    /// there is none, or one side only, goes to the answer's message.
    fn certified(&self, s: &SolveCode, g: &Generated, a: &mut Answer) {
        let wanted = self.options.certify || self.options.number("certify") == Some(1.0);
        if !wanted || g.instance.objective.is_none() || a.bounds.is_some() {
            return;
        }
        if !g.instance.is_linear() || s.using.has_pairs() {
            add_message(a, "no bound is proved: the model is not linear".into());
            return;
        }
        self.host()
            .progress("proving an interval for the objective");
        let mut monitor = self.names(g);
        let limits = Limits {
            iterations: u64::MAX,
            ..self.limits(s.model)
        };
        let budget = Budget::new(&mut monitor, limits, self.options.log);
        let Ok(proof) = certify(&g.instance, a, &budget) else {
            return;
        };
        let mut missing = vec![("lower ", proof.no_low), ("upper ", proof.no_high)];
        if missing[0].1 == missing[1].1 {
            missing.truncate(1);
            missing[0].0 = "";
        }
        for (side, missing) in missing {
            let Some(u) = missing else { continue };
            let place = self.row_or_column(g, u.row, u.column);
            let place = place.map_or(String::new(), |name| format!(": {name}"));
            add_message(a, format!("no {side}bound is proved: {}{place}", u.why));
        }
        let bounds = [proof.low, proof.high];
        a.bounds = bounds.iter().any(|b| b.is_finite()).then_some(bounds);
    }

    /// Rows without variables get level and marginal 0 and their bounds, variables that are held fixed their level.
    /// With `solveOpt` replace or clear all rows of the equations lose what a solve before has left.
    fn store_outside(&mut self, s: &SolveCode, g: &Generated) {
        const MERGE: f64 = 1.0;
        let of_rows = [attribute::L, attribute::M, attribute::LO, attribute::UP];
        if self.model_option(s.model, "solveopt", MERGE) != MERGE {
            for item in &s.equations {
                let equation = self.equations[item.definition].symbol;
                let t = self.symbols.get(equation).table;
                for o in of_rows {
                    self.store.table_mut(t + o).clear();
                }
            }
        }
        for rows in g.origin.left_out.chunk_by(|a, b| a.symbol == b.symbol) {
            let t = self.symbols.get(rows[0].symbol).table;
            for (k, o) in of_rows.into_iter().enumerate() {
                let table = self.store.table_mut(t + o);
                for row in rows {
                    let [lower, upper] = row.bounds;
                    table.set(&row.key, [0.0, 0.0, lower, upper][k]);
                }
                table.tidy();
            }
        }
        let mut levels = Vec::new();
        for (v, key) in &g.origin.held {
            let t = self.symbols.get(*v).table;
            let value = self.store.table(t + attribute::LO).get(key);
            levels.push(t + attribute::L);
            self.store.table_mut(t + attribute::L).set(key, value);
        }
        levels.dedup();
        for t in levels {
            self.store.table_mut(t).tidy();
        }
    }

    /// Writes levels, marginals and bounds of rows back.
    fn store(&mut self, g: &Generated, a: &Answer) {
        let mut write = |blocks: &Blocks, offset: u32, values: &[f64]| {
            for b in &blocks.list {
                let t = self.symbols.get(b.symbol).table + offset;
                let r = b.start as usize..(b.start + b.len) as usize;
                // What an interior point leaves of a zero is no number that a model means.
                let plain = |v: &f64| if v.abs() < 1e-100 { 0.0 } else { *v };
                let values: Vec<f64> = values[r].iter().map(plain).collect();
                let t = self.store.table_mut(t);
                // Zeros are set too: what the last solve left must go.
                t.merge(&b.keys, &values);
                t.tidy();
            }
        };
        write(&g.origin.columns, attribute::L, &a.outcome.level);
        for b in g.origin.columns.list.iter().chain(&g.origin.rows.list) {
            self.generated.insert(b.symbol, b.keys.clone());
        }
        let (columns, rows) = (&g.instance.columns, &g.instance.rows);
        let optimal = g.instance.matched.is_none()
            && g.instance.objective.is_some()
            && matches!(a.status, ModelStatus::Optimal | ModelStatus::LocallyOptimal);
        let fixed = |j: usize| optimal && columns.lower[j] == columns.upper[j];
        let mut marginals = stored(&a.outcome.column_marginal, fixed);
        let mut row_marginals = a.outcome.row_marginal.clone();
        // A pair whose column is held fixed is none.
        for &j in &g.origin.held_columns {
            marginals[j as usize] = columns.marginal[j as usize];
            if let Some(r) = g.instance.matched.as_ref().and_then(|m| m[j as usize]) {
                row_marginals[r as usize] = 0.0;
            }
        }
        write(&g.origin.columns, attribute::M, &marginals);
        // A row without relation has its constant inside its level; one that binds is at its right side, not perturbed by rounding.
        let levels: Vec<f64> = (0..rows.rhs.len())
            .map(|i| {
                let (level, b) = (a.activity[i], rows.rhs[i]);
                let binds = rows.relation[i] == Relation::Equal || a.outcome.row_marginal[i] != 0.0;
                match rows.relation[i] {
                    Relation::Free => level - b,
                    _ if binds && (level - b).abs() <= 1e-9 * b.abs().max(1.0) => b,
                    _ => level,
                }
            })
            .collect();
        write(&g.origin.rows, attribute::L, &levels);
        let equal = |i: usize| optimal && rows.relation[i] == Relation::Equal;
        let marginals = stored(&row_marginals, equal);
        write(&g.origin.rows, attribute::M, &marginals);
        let bounds = rows
            .relation
            .iter()
            .zip(&rows.rhs)
            .map(|(r, &b)| r.bounds(b));
        let (lower, upper): (Vec<f64>, Vec<f64>) = bounds.map(|[l, u]| (l, u)).unzip();
        write(&g.origin.rows, attribute::LO, &lower);
        write(&g.origin.rows, attribute::UP, &upper);
    }

    /// Model attributes after a solve.
    fn remember(&mut self, s: &SolveCode, g: &Generated, a: &Answer) {
        let r = &a.residuals;
        let instance: &Instance = &g.instance;
        let objective = match instance.objective {
            // Perhaps no point was returned.
            Some(_) => objective_level(g, a).unwrap_or(NA),
            None => r.pairs.unwrap_or(0.0),
        };
        // A program that leaves no discrete choice needs no search: its optimum is its bound.
        let discrete = s.using.discrete() == Discrete::Decided && !s.using.has_pairs();
        let (bound, nodes) = match &a.search {
            Some(search) => (search.bound.unwrap_or(NA), search.nodes as f64),
            None if discrete && a.status == ModelStatus::Optimal => (objective, 0.0),
            None if discrete => (NA, 0.0),
            None => (NA, NA),
        };
        let infeasible = !r.is_feasible(crate::solve::certificate::TOLERANCE);
        let count = r.infeasible_count as f64;
        let [count, sum, largest] = match r.unsolved {
            Some((sum, largest)) => [count, sum, largest],
            None if infeasible => [count, r.primal_sum.unwrap_or(0.0), r.primal.unwrap_or(0.0)],
            None => [0.0; 3],
        };
        let kinds = instance.columns.kind.iter();
        let discrete_columns = kinds
            .filter(|k| !matches!(k, ColumnKind::Continuous | ColumnKind::OrderedSet))
            .count();
        let values = [
            ("modelstat", f64::from(a.status as u8)),
            ("solvestat", f64::from(a.outcome.status as u8)),
            ("objval", objective),
            ("objest", bound),
            ("nodusd", nodes),
            ("iterusd", a.outcome.iterations as f64),
            ("resusd", g.seconds.solve),
            ("etsolve", g.seconds.total),
            ("etsolver", g.seconds.solve),
            ("resgen", g.seconds.generate),
            ("numequ", instance.row_count() as f64),
            ("numvar", g.columns() as f64),
            ("numnz", g.origin.nonzeros as f64),
            ("numnlnz", g.origin.nonlinear_nonzeros as f64),
            ("numnlins", g.origin.nonlinear_nonzeros as f64),
            ("numinfes", count),
            ("suminfes", sum),
            ("maxinfes", largest),
            ("meaninfes", if count > 0.0 { sum / count } else { 0.0 }),
            ("numnopt", 0.0),
            ("numredef", 0.0),
            ("numvarproj", 0.0),
            ("trylinear", 0.0),
            ("numdepnd", 0.0),
            ("numdvar", discrete_columns as f64),
            ("domusd", 0.0),
            ("marginals", 1.0),
            ("number", f64::from(self.report().solves.len() as u32 + 1)),
            ("line", self.map.listing_line(self.options.at.get()) as f64),
            ("linkused", 0.0),
        ];
        let state = self.models.entry(s.model).or_default();
        state.attributes.extend(values);
    }

    pub(super) fn report_solve(&mut self, s: &SolveCode, g: &Generated, a: &Answer) {
        let r = &a.residuals;
        let solve = json::SolveReport {
            sense: s.objective.map(|(sense, _)| sense),
            objective_name: s
                .objective
                .map(|(_, z)| self.symbols.get(z).name.to_string()),
            solver: a.outcome.solver.to_string(),
            model_status: a.status.into(),
            solver_status: a.outcome.status.into(),
            objective: objective_level(g, a).map(json::Number),
            search: a
                .search
                .as_ref()
                .map(|found| self.search_report(g, a, found)),
            iterations: a.outcome.iterations,
            residual: r.into(),
            complementarity_sum: r
                .complementarity_sum
                .filter(|_| s.using.has_pairs() && s.using.has_objective()),
            bounds: a.bounds.map(|b| b.map(json::Number)),
            stationarity: a.stationarity.map(|s| s.name()),
            message: self.solve_message(g, a),
            hint: self.hint(s.using, g, a),
            why: self.options.why.then(|| self.explanation(s, g, a)),
            ..self.not_solved(s, g)
        };
        if !self.options.quiet {
            let mut text = summary::solve(&solve, self.options.color);
            text.push_str(&self.levels(s.model, g, a));
            self.print(&text);
        }
        self.report().solves.push(solve);
    }

    /// Levels and marginals, where the text shows no numbers itself, or where all are asked for. `solPrint` = 0 or 2, a loop
    /// around the solve, and a point that is no solution leave them out.
    fn levels(&self, model: SymbolId, g: &Generated, a: &Answer) -> String {
        const REPORT: f64 = 1.0;
        let all = self.options.all;
        let wanted = !self.shows_numbers
            && self.loops == 0
            && self.model_option(model, "solprint", REPORT) == REPORT
            && a.status.has_solution();
        if !wanted && !all {
            return String::new();
        }
        let names = self.names(g);
        let values = levels::Values {
            column_level: &a.outcome.level,
            column_marginal: &a.outcome.column_marginal,
            row_level: &a.activity,
            row_marginal: &a.outcome.row_marginal,
        };
        levels::levels(&g.instance, &names, &values, all)
    }

    /// Notes in the report that a solve begins, and what was wrong so far: should the run be ended from outside, this
    /// is what is known.
    fn begins(&self, s: &SolveCode, generated: Option<&Generated>) {
        let solve = self.not_solved(s, generated.unwrap_or(&Generated::default()));
        let diagnostics =
            crate::report::diagnostic::Diagnostic::all(&self.diagnostics.borrow(), &self.map);
        let mut report = self.report();
        report.solving = Some(solve);
        report.diagnostics = diagnostics;
    }

    /// The report of a model that was generated only.
    fn not_solved(&self, s: &SolveCode, g: &Generated) -> json::SolveReport {
        json::SolveReport {
            rows: g.instance.row_count(),
            columns: g.columns(),
            nonzeros: g.origin.nonzeros,
            nonlinear_nonzeros: g.origin.nonlinear_nonzeros,
            seconds: g.seconds,
            ..json::SolveReport::new(&self.symbols.get(s.model).name, s.using)
        }
    }

    /// Bound, gap and nodes of a search, with names.
    fn search_report(&self, g: &Generated, a: &Answer, found: &mip::Report) -> json::Search {
        let value = objective_level(g, a);
        let gap = |(v, b): (f64, f64)| json::Number((v - b).abs() / v.abs().max(1e-10));
        let node = |r: &mip::Record| json::TreeNode {
            parent: r.parent,
            column: r
                .change
                .map(|c| self.origin_name(&g.origin.columns, c.column)),
            bounds: r
                .change
                .map(|c| [json::Number(c.lower), json::Number(c.upper)]),
            value: json::Number(g.instance.sign() * r.value),
            fate: r.fate,
            solution: r.solution.map(|v| json::Number(g.instance.sign() * v)),
        };
        json::Search {
            bound: found.bound.map(json::Number),
            gap: value.zip(found.bound).map(gap),
            nodes: found.nodes,
            tree: found.records.iter().map(node).collect(),
            left_out: found.left_out,
        }
    }

    /// What explains the status, for `bmod why`.
    fn explanation(&self, s: &SolveCode, g: &Generated, a: &Answer) -> Explanation {
        let mut monitor = self.names(g);
        let budget = Budget::new(&mut monitor, self.limits(s.model), self.options.log);
        let found = why::findings(s.using, &g.instance, a, &budget);
        let names = self.names(g);
        explain(&found, &g.instance, &names)
    }

    /// Where a reader finds out why there is no solution. The multipliers that prove an infeasible linear program so tell how
    /// many rows and bounds it takes.
    fn hint(&self, using: ProblemType, g: &Generated, a: &Answer) -> Option<String> {
        if self.options.why {
            return None;
        }
        let file = &self.map.files()[0].name;
        match a.status {
            ModelStatus::Infeasible => {
                let ray = &a.outcome.ray;
                let largest = ray.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                let rows = ray.iter().filter(|v| v.abs() > 1e-9 * largest).count();
                let what = match rows {
                    _ if ray.len() != g.instance.row_count() => "what contradicts what".into(),
                    0 => "which bounds contradict each other".into(),
                    1 => "which row contradicts its variables' bounds".into(),
                    n => format!("which of {n} rows contradict each other"),
                };
                Some(format!("`bmod why {file}` shows {what}"))
            }
            ModelStatus::LocallyInfeasible | ModelStatus::IntermediateInfeasible => {
                Some(format!("`bmod why {file}` shows what is violated"))
            }
            ModelStatus::Unbounded | ModelStatus::UnboundedNoSolution => {
                Some(format!("`bmod why {file}` shows what grows without limit"))
            }
            _ if a.outcome.solver == mip::NAME
                && a.outcome.status != SolverStatus::NormalCompletion =>
            {
                larger_models(&Task::new(using, &g.instance))
            }
            _ => None,
        }
    }

    /// What else there is to say: the solver's remark, and the worst row or column of a failure.
    fn solve_message(&self, g: &Generated, a: &Answer) -> Option<String> {
        let r = &a.residuals;
        let mut parts: Vec<String> = a.outcome.message.iter().cloned().collect();
        if matches!(
            a.status,
            ModelStatus::Infeasible
                | ModelStatus::LocallyInfeasible
                | ModelStatus::IntermediateInfeasible
        ) {
            let worst = self.row_or_column(g, r.worst_row, r.worst_column);
            if let Some(w) = worst {
                parts.push(format!("the largest residual is at {w}"));
            }
        }
        (!parts.is_empty()).then(|| parts.join("; "))
    }

    pub(super) fn print_listing(&mut self, model: &str, g: &Generated, list: &ListOptions) {
        let activity = activity(&g.instance, &g.instance.columns.level);
        let selection = listing::Selection {
            names: list.only.clone(),
            limit: list.limit,
        };
        let names = self.names(g);
        let mut text = listing::listing(&g.instance, &names, &activity, &selection);
        if text.is_empty() && !list.only.is_empty() {
            let asked = list.only.join("`, `");
            text = format!(
                "  no row or column is called `{asked}`; there are {}\n",
                symbols(g, &names)
            );
        }
        self.print(&format!(
            "model {model}: {} rows, {} columns, {} nonzeros\n\n{text}\n",
            g.instance.row_count(),
            g.instance.column_count(),
            g.origin.nonzeros
        ));
    }

    /// The name of a row, or else of a column.
    fn row_or_column(
        &self,
        g: &Generated,
        row: Option<usize>,
        column: Option<usize>,
    ) -> Option<String> {
        let row = row.map(|i| self.origin_name(&g.origin.rows, i));
        row.or_else(|| Some(self.origin_name(&g.origin.columns, column?)))
    }
    /// The solves that were kept.
    pub fn kept(&self) -> &[KeptSolve] {
        &self.kept
    }

    /// Everything about the solves of the run, as JSON (`--solution`).
    pub fn solutions(&self, file: &str) -> String {
        let kept = self.kept.iter();
        let names: Vec<RunNames> = kept.map(|k| self.names(&k.generated)).collect();
        let solved: Vec<solution::Solved> = self
            .kept
            .iter()
            .zip(&names)
            .map(|(k, names)| solution::Solved {
                model: &k.model,
                using: k.using,
                instance: &k.generated.instance,
                outcome: &k.answer.outcome,
                activity: &k.answer.activity,
                names,
            })
            .collect();
        solution::to_json(file, &solved)
    }
}

/// What may do better than the own search, which is made for small models and came to a limit.
fn larger_models(task: &Task) -> Option<String> {
    let own = "the own search is made for small models";
    let other = |b: &&&dyn Backend| b.about().name != mip::NAME && b.takes(task);
    if let Some(backend) = BACKENDS.iter().find(other) {
        let (using, name) = (task.using, backend.about().name);
        return Some(format!("{own}: `option {using} = {name};` may do better"));
    }
    let i = task.instance;
    let for_highs = i.is_linear() && !task.has_pairs() && i.discrete.sets.is_empty();
    let highs = "HiGHS (bmod with the cargo feature `highs`) may do better";
    (for_highs && !cfg!(feature = "highs")).then(|| format!("{own}: {highs}"))
}

/// Level of the objective variable, if a point was returned.
fn objective_level(g: &Generated, a: &Answer) -> Option<f64> {
    let o = g.instance.objective.filter(|_| !a.is_without_point())?;
    Some(a.outcome.level[o.column as usize])
}

/// Says something more of an answer.
fn add_message(a: &mut Answer, more: String) {
    let message = a.outcome.message.take();
    a.outcome.message = Some(message.map_or(more.clone(), |m| format!("{m}; {more}")));
}

/// Names of the equations and variables of a model, for a message.
fn symbols(g: &Generated, names: &RunNames) -> String {
    let blocks = g.origin.rows.list.iter().chain(&g.origin.columns.list);
    let name = |b: &crate::model::origin::Block| &*names.machine.symbols.get(b.symbol).name;
    let mut all: Vec<&str> = blocks.map(name).collect();
    all.dedup();
    all.join(", ")
}

/// Marginals as GAMS stores them: a 0 is EPS where nothing can move, in a fixed column and in the row of an equation, which
/// are outside the basis.
fn stored(marginals: &[f64], outside: impl Fn(usize) -> bool) -> Vec<f64> {
    let stored = |(k, &m): (usize, &f64)| if m == 0.0 && outside(k) { EPS } else { m };
    marginals.iter().enumerate().map(stored).collect()
}

/// A solve that is kept for `--solution` and `bmod bench`.
pub struct KeptSolve {
    model: String,
    using: ProblemType,
    generated: Generated,
    answer: Answer,
}

impl KeptSolve {
    /// The model's name, the problem type and the instance.
    pub fn parts(&self) -> (&str, ProblemType, &Instance) {
        (&self.model, self.using, &self.generated.instance)
    }
}

impl RunNames<'_, '_> {
    fn parts(&self, blocks: &Blocks, i: usize) -> (String, Vec<String>) {
        let b = blocks.of(i as u32);
        let labels = b
            .key(i as u32)
            .iter()
            .map(|&l| self.machine.store.universe.name(l).to_string())
            .collect();
        (self.machine.symbols.get(b.symbol).name.to_string(), labels)
    }
}

impl Names for RunNames<'_, '_> {
    fn row_parts(&self, row: usize) -> (String, Vec<String>) {
        self.parts(&self.origin.rows, row)
    }

    fn column_parts(&self, column: usize) -> (String, Vec<String>) {
        self.parts(&self.origin.columns, column)
    }
}
