//! Statements.

use super::plan::Wanted;
use super::random::Random;
use super::scan::Scans;
use super::support::Analysis;
use super::{Flow, Frame, Machine};
use crate::check::expansion::Tuples;
use crate::check::node::*;
use crate::check::symbols::attribute;
use crate::data::table::Table;
use crate::data::universe::Label;
use crate::data::value::{number, truth};
use crate::diag::Diagnostic;
use crate::source::Span;
use std::ops::ControlFlow;

/// Records to be written, one after the other.
#[derive(Default)]
struct Records {
    keys: Vec<Label>,
    values: Vec<f64>,
}

impl Records {
    /// Membership for each value.
    fn members(&self) -> Vec<f64> {
        let members = self.values.iter().map(|&v| f64::from(u8::from(truth(v))));
        members.collect()
    }
}

/// Whether the assignment passes over this value of its right side.
fn skips(a: &Assignment, value: f64) -> bool {
    a.nonzero && !truth(value)
}

/// What `execError` and `maxExecError` count to.
const MAX_STATEMENT_ERRORS: usize = 1_000_000_000;

impl Machine<'_> {
    pub(super) fn block(&mut self, code: &[Code], frame: &mut Frame) -> Flow {
        for c in code {
            match self.statement(c, frame) {
                Flow::Next => {}
                flow => return flow,
            }
        }
        Flow::Next
    }

    /// Makes the tables that a statement scans tidy.
    fn tidy(&mut self, c: &Code) {
        for &t in c.scans.get_or_init(|| Scans::of(c)).iter() {
            let table = &mut self.store.tables[t as usize];
            if !table.is_tidy() {
                table.tidy();
            }
        }
    }

    fn statement(&mut self, c: &Code, frame: &mut Frame) -> Flow {
        self.options.at.set(c.span);
        if self.interrupted() {
            return Flow::Stop;
        }
        self.take_collected();
        self.tidy(c);
        if self.options.list.is_some() {
            self.follow_unsolved(c);
        }
        match &c.kind {
            CodeKind::Assign(a) => match a.in_turn {
                true => self.assign_in_turn(a, frame),
                false => self.assign(a, a.covers, frame),
            },
            CodeKind::Loop(d, anew, body) => return self.run_loop(d, anew, body, frame),
            CodeKind::While(cond, body) => {
                let outer = self.take_undecided();
                while !self.waits(cond) && truth(self.eval(cond, frame)) {
                    if let ControlFlow::Break(flow) = self.turn(body, frame) {
                        return flow;
                    }
                    self.tidy(c);
                    if self.take_undecided() {
                        break;
                    }
                }
                self.leave_undecided(outer);
            }
            CodeKind::Repeat(body, until) => {
                let outer = self.take_undecided();
                loop {
                    if let ControlFlow::Break(flow) = self.turn(body, frame) {
                        return flow;
                    }
                    self.tidy(c);
                    if self.take_undecided() || self.waits(until) || truth(self.eval(until, frame))
                    {
                        break;
                    }
                }
                self.leave_undecided(outer);
            }
            CodeKind::For(f) => return self.run_for(c.span, f, frame),
            CodeKind::If(arms, otherwise) => {
                for (cond, body) in arms {
                    if truth(self.eval(cond, frame)) {
                        return self.block(body, frame);
                    }
                }
                return self.block(otherwise, frame);
            }
            CodeKind::Break(loops) => return Flow::Break(*loops),
            CodeKind::Continue => return Flow::Continue,
            CodeKind::Display(items) => self.display(items, c.span),
            CodeKind::Abort(items, no_error) => {
                // Behind a solve that was not made (`bmod list`) an abort judges numbers that are not there.
                let judges = self.options.list.is_none() || self.report().solves.is_empty();
                if judges {
                    return self.abort(items, *no_error, c.span);
                }
            }
            CodeKind::Solve(s) => return self.solve(s, c.span, frame),
            CodeKind::Option(name, value) => self.set_option(name, value),
            CodeKind::Clear(s, attribute) => {
                self.generated.remove(s);
                self.store.clear(self.symbols.get(*s), *attribute);
            }
            CodeKind::Format(s, numbers) => {
                // Decimals alone leave the layout as it is.
                let format = self.formats.entry(*s).or_default();
                let keep = numbers.len().min(format.len());
                format.splice(..keep, numbers.iter().copied());
            }
            CodeKind::Project {
                target,
                source,
                positions,
            } => self.project(*target, *source, positions),
            CodeKind::Shuffle(p, set) => self.shuffle(self.symbols.get(*p).table, *set),
            CodeKind::Permute(target, [numbers, set]) => {
                self.permute(*target, *numbers, *set, c.span);
            }
            CodeKind::Match(target, sets) => self.match_sets(*target, sets),
            CodeKind::Put(keyword, items) => self.put(keyword, items, frame, c.span),
            CodeKind::Exchange(x) => self.exchange(x, c.span),
            CodeKind::Draw(s, file) => self.draw(*s, file.as_deref(), frame, c.span),
        }
        if self.stopped() {
            Flow::Stop
        } else {
            Flow::Next
        }
    }

    /// One turn of a loop's body; Break: the loop ends, and goes on as told.
    fn turn(&mut self, body: &[Code], frame: &mut Frame) -> ControlFlow<Flow> {
        if !self.keep_going() {
            return ControlFlow::Break(Flow::Stop);
        }
        self.loops += 1;
        let flow = self.block(body, frame);
        self.loops -= 1;
        match flow {
            Flow::Next | Flow::Continue => ControlFlow::Continue(()),
            Flow::Break(loops) if loops > 1 => ControlFlow::Break(Flow::Break(loops - 1)),
            Flow::Break(_) => ControlFlow::Break(Flow::Next),
            Flow::Stop => ControlFlow::Break(Flow::Stop),
        }
    }

    /// `anew` are the conjuncts of the condition that are asked at every turn.
    fn run_loop(&mut self, d: &Domain, anew: &[Node], body: &[Code], frame: &mut Frame) -> Flow {
        if !d.conditions.is_empty() && Analysis::new(self, &d.slots, false).any_undefined(anew) {
            // `na and 0` is `na`, which counts as true: none stands alone.
            let mut whole = d.clone();
            let mut all = std::mem::take(&mut whole.conditions);
            all.extend_from_slice(anew);
            return self.run_loop(&whole, &all, body, frame);
        }
        if d.slots.is_empty() {
            // Everything is under control already: once, if the tuple is there.
            let plan = self.plan(d, Wanted::default());
            let mut once = false;
            self.run_plan(d, &plan, frame, &mut |_| {
                once = true;
                false
            });
            if once
                && self.all_hold(anew, frame)
                && let ControlFlow::Break(flow) = self.turn(body, frame)
            {
                return flow;
            }
            return Flow::Next;
        }
        let tuples = self.tuples(d, anew, frame);
        for t in tuples.chunks_exact(d.slots.len()) {
            for (&s, &l) in d.slots.iter().zip(t) {
                frame[s as usize] = l;
            }
            if !self.all_hold(anew, frame) {
                if !self.keep_going() {
                    return Flow::Stop;
                }
            } else if let ControlFlow::Break(flow) = self.turn(body, frame) {
                return flow;
            }
        }
        Flow::Next
    }

    fn run_for(&mut self, span: Span, f: &For<TableId, Node, Code>, frame: &mut Frame) -> Flow {
        let (table, down) = (f.variable, f.down);
        let mut value = |n: &Node| {
            let x = number(self.eval(n, frame));
            if x.is_nan() {
                self.finite(x, "a number of `for`", n.span);
            }
            x
        };
        let (from, to) = (value(&f.from), value(&f.to));
        let by = f.by.as_ref().map_or(1.0, value);
        let mistake = |m: &Self| {
            m.execution_error(
                "E0406",
                span,
                format!("the step of `for` is {by}; it must be positive"),
                "use `downto` to count down",
            );
        };
        if from.is_nan() || to.is_nan() || by.is_nan() {
            return Flow::Next;
        }
        // The current value of the scalar counts, so that the body may change it.
        // Steps are added up and compared as they are: 0.1 to 0.3 by 0.1 ends before 0.30000000000000004.
        self.store.table_mut(table).set(&[], from);
        loop {
            let k = number(self.store.table(table).get(&[]));
            if (down && k < to) || (!down && k > to) || k.is_nan() {
                return Flow::Next;
            }
            if let ControlFlow::Break(flow) = self.turn(&f.body, frame) {
                return flow;
            }
            // As in GAMS the step is looked at when it is taken.
            if by <= 0.0 {
                mistake(self);
                return Flow::Next;
            }
            let k = number(self.store.table(table).get(&[]));
            self.store
                .table_mut(table)
                .set(&[], if down { k - by } else { k + by });
        }
    }

    fn target_table(&self, target: Target) -> Option<TableId> {
        match target {
            Target::Table(t) | Target::Set(t) | Target::Singleton(t) => Some(t),
            Target::Fix(s) => Some(self.symbols.get(s).table + attribute::L),
            _ => None,
        }
    }

    fn assign(&mut self, a: &Assignment, covers: bool, frame: &mut Frame) {
        let (domain, target, key, value) = (&a.domain, a.target, &a.key, &a.value);
        let symbol = self.target_table(target).and_then(|t| self.table_symbol(t));
        if let (Some(s), Target::Table(t)) = (symbol, target)
            && [attribute::L, attribute::M].contains(&(t - self.symbols.get(s).table))
        {
            self.generated.remove(&s);
        }
        if domain.slots.is_empty() {
            if let Some(s) = symbol {
                self.assign_one(s, a, frame);
                return;
            }
            if !self.all_hold(&domain.conditions, frame) {
                return;
            }
            let text = match &value.kind {
                NodeKind::Text(t) => Some(t.to_string()),
                _ => None,
            };
            let v = self.eval(value, frame);
            if skips(a, v) {
                return;
            }
            let count = |what| self.whole(v, what, [0, MAX_STATEMENT_ERRORS], value.span);
            match target {
                Target::Errors => {
                    if let Some(n) = count("`execError`") {
                        self.failed_statements.set(n);
                        self.errors_assigned.set(Some(value.span));
                    }
                }
                Target::MostErrors => {
                    if let Some(n) = count("`maxExecError`") {
                        self.most_errors = n;
                    }
                }
                Target::Seed => {
                    if let Some(seed) = self.finite(v, "`execSeed`", value.span) {
                        *self.random.borrow_mut() = Random::new(seed as i64);
                    }
                }
                Target::Object(s, a) => self.set_object_attribute(s, a, v, text, value.span),
                _ => {}
            }
            return;
        }
        let Some(symbol) = symbol else { return };
        // Where the value is the target's default it need be written over what is stored only; and not even there
        // in a table that is made anew.
        let table = match target {
            Target::Table(t) | Target::Set(t) => Some(t),
            _ => None,
        };
        let covers = covers && matches!(target, Target::Table(_));
        let wanted = Wanted {
            value: table.map(|_| value),
            rest: table
                .filter(|_| !a.nonzero)
                .map_or(0.0, |t| self.store.table(t).default_value()),
            stored: table.filter(|_| !covers && !a.nonzero).map(|t| (t, key)),
            ..Wanted::default()
        };
        let plan = self.plan(domain, wanted);
        for t in plan.scanned() {
            self.store.tables[t as usize].tidy();
        }
        let mut out = Records::default();
        self.run_plan(domain, &plan, frame, &mut |f| {
            self.evaluate(symbol, a, value, f, &mut out);
            self.keep_going()
        });
        *self.current.borrow_mut() = None;
        if self.stopped() {
            return;
        }
        self.write(target, out, covers);
    }

    /// Each element reads what those before it have written. As in GAMS what has its first label before that of the
    /// symbol's first record is not seen before the end.
    fn assign_in_turn(&mut self, a: &Assignment, frame: &mut Frame) {
        let (domain, target) = (&a.domain, a.target);
        let symbol = self.target_table(target).and_then(|t| self.table_symbol(t));
        let Some(symbol) = symbol.filter(|_| !domain.slots.is_empty()) else {
            return self.assign(a, false, frame);
        };
        let owner = self.symbols.get(symbol);
        let count = match owner.has_attributes() {
            true => attribute::COUNT,
            false => 1,
        };
        let own = owner.table..owner.table + count;
        let least = own.clone().filter_map(|t| {
            let table = &mut self.store.tables[t as usize];
            table.tidy();
            (!table.is_empty()).then(|| table.key(0)[0])
        });
        let first: Option<Label> = least.min();
        let outer = Domain {
            conditions: Vec::new(),
            ..domain.clone()
        };
        let tuples = self.tuples(&outer, &[], frame);
        let fixed = |n: &Node| matches!(&n.kind, NodeKind::Data(t, key) if own.contains(t) && key.is_fixed());
        let mut nodes = domain.conditions.iter().chain([&a.value]);
        let copies = nodes.any(|n| n.any(fixed)).then(|| {
            let mut value = a.value.clone();
            let mut conditions = domain.conditions.clone();
            for n in conditions.iter_mut().chain([&mut value]) {
                n.change(&mut |n| {
                    if fixed(n) {
                        n.kind = NodeKind::Const(self.eval(n, frame));
                    }
                });
            }
            (value, conditions)
        });
        let (value, conditions) = match &copies {
            Some((value, conditions)) => (value, conditions),
            None => (&a.value, &domain.conditions),
        };
        let mut late = Records::default();
        for t in tuples.chunks_exact(domain.slots.len()) {
            for (&s, &l) in domain.slots.iter().zip(t) {
                frame[s as usize] = l;
            }
            if !self.keep_going() {
                break;
            }
            if !self.all_hold(conditions, frame) {
                continue;
            }
            let (at, before) = (late.keys.len(), late.values.len());
            self.evaluate(symbol, a, value, frame, &mut late);
            if late.values.len() > before && first.is_some_and(|f| late.keys[at] >= f) {
                let one = Records {
                    keys: late.keys.split_off(at),
                    values: late.values.split_off(before),
                };
                match target {
                    Target::Table(t) => self.store.table_mut(t).set(&one.keys, one.values[0]),
                    _ => self.write(target, one, false),
                }
            }
        }
        *self.current.borrow_mut() = None;
        if !self.stopped() {
            self.write(target, late, false);
        }
    }

    fn assign_one(&mut self, s: SymbolId, a: &Assignment, frame: &mut Frame) {
        let (domain, target) = (&a.domain, a.target);
        let mut k = [0; 20];
        let n = a.key.parts.len();
        let mut members = domain.members.iter();
        let assigns = self.all_hold(&domain.conditions, frame)
            && members.all(|m| self.is_member(m.table, &m.key, frame))
            && self.key(&a.key, frame, &mut k);
        if !assigns {
            // A singleton set loses its element even where no element is assigned.
            if let Target::Singleton(t) = target {
                self.store.table_mut(t).clear();
            }
            return;
        }
        if n > 0 {
            self.at_record(s, &k[..n]);
        } else {
            *self.current.borrow_mut() = None;
        }
        let v = self.eval(&a.value, frame);
        if skips(a, v) {
            return;
        }
        match target {
            Target::Table(t) => self.store.table_mut(t).set(&k[..n], v),
            _ => {
                let (keys, values) = (k[..n].to_vec(), vec![v]);
                self.write(target, Records { keys, values }, false);
            }
        }
    }

    /// Notes the record that is assigned, for messages.
    #[inline]
    fn at_record(&self, symbol: SymbolId, key: &[Label]) {
        match &mut *self.current.borrow_mut() {
            Some((of, labels)) => {
                *of = symbol;
                labels.clear();
                labels.extend_from_slice(key);
            }
            none => *none = Some((symbol, key.to_vec())),
        }
    }

    /// Evaluates the right side for the labels in the frame.
    #[inline]
    fn evaluate(
        &self,
        symbol: SymbolId,
        a: &Assignment,
        value: &Node,
        frame: &mut Frame,
        out: &mut Records,
    ) {
        let mut k = [0; 20];
        let n = a.key.parts.len();
        if !self.key(&a.key, frame, &mut k) {
            return;
        }
        self.at_record(symbol, &k[..n]);
        let v = self.eval(value, frame);
        if skips(a, v) {
            return;
        }
        out.keys.extend_from_slice(&k[..n]);
        out.values.push(v);
    }

    /// Stores records.
    fn write(&mut self, target: Target, out: Records, covers: bool) {
        match target {
            Target::Table(t) => {
                let table = self.store.table_mut(t);
                if covers {
                    let (dim, default) = (table.dim(), table.default_value());
                    *table = Table::from_records(dim, default, out.keys, out.values);
                } else {
                    table.merge(&out.keys, &out.values);
                }
            }
            Target::Set(t) => self.store.table_mut(t).merge(&out.keys, &out.members()),
            Target::Singleton(t) => {
                let dim = self.store.table(t).dim();
                let members = out.members();
                let chosen = Table::from_records(dim, 0.0, out.keys, members);
                // Whatever is assigned, and whether anything is: the old element goes.
                self.store.table_mut(t).clear();
                if let Some(first) = chosen.keys().next() {
                    self.store.table_mut(t).set(first, 1.0);
                    if chosen.len() > 1 && self.options.number("strictsingleton") != Some(0.0) {
                        let n = chosen.len();
                        self.execution_error(
                            "E0407",
                            self.options.at.get(),
                            format!("a singleton set has one element; {n} were assigned"),
                            "the first one is kept",
                        );
                    }
                }
                self.store.table_mut(t).tidy();
            }
            Target::Fix(s) => {
                let t = self.symbols.get(s).table;
                for o in [attribute::L, attribute::LO, attribute::UP] {
                    self.store.table_mut(t + o).merge(&out.keys, &out.values);
                }
            }
            _ => {}
        }
    }

    fn abort(&mut self, items: &[Shown], no_error: bool, span: Span) -> Flow {
        let text = items.iter().find_map(|i| match i {
            Shown::Text(t) => Some(format!(": {t}")),
            _ => None,
        });
        self.display(items, span);
        if !no_error {
            let text = text.unwrap_or_default();
            Diagnostic::execution("E0480", span)
                .says(format!("the model stopped itself{text}"))
                .label("`abort`")
                .note(self);
        }
        Flow::Stop
    }

    fn set_option(&mut self, name: &str, value: &str) {
        self.options.assign(name, value);
        if name == "seed" {
            *self.random.borrow_mut() = self.options.random();
        }
    }

    /// `option m(i:j,k)`
    fn match_sets(&mut self, target: SymbolId, sets: &[(bool, TableId)]) {
        let mut all: Option<Tuples> = None;
        for &(matched, t) in sets {
            self.store.table_mut(t).tidy();
            let set = Tuples::of(self.store.table(t));
            all = Some(match all {
                None => set,
                Some(before) if matched => before.beside(&set),
                Some(before) => before.times(&set),
            });
        }
        let table = self.symbols.get(target).table;
        let table = self.store.table_mut(table);
        table.clear();
        for key in all.iter().flat_map(Tuples::rows).map(|r| r.labels) {
            table.set(key, 1.0);
        }
        table.tidy();
    }

    /// `option shuffle = p`: the values over all elements of its set change places, the last one first (Fisher and Yates);
    /// without any, they are the positions.
    fn shuffle(&mut self, p: TableId, set: TableId) {
        let labels = |t: &Table| t.iter().map(|(k, _)| k[0]).collect::<Vec<Label>>();
        self.store.table_mut(set).tidy();
        let labels = labels(self.store.table(set));
        let table = self.store.table_mut(p);
        table.tidy();
        let mut values: Vec<f64> = match table.is_empty() {
            true => (1..=labels.len()).map(|n| n as f64).collect(),
            false => labels.iter().map(|l| table.get(&[*l])).collect(),
        };
        for n in (1..values.len()).rev() {
            let k = self.random.borrow_mut().uniform_int(0.0, n as f64) as usize;
            values.swap(n, k);
        }
        let table = self.store.table_mut(p);
        for (label, value) in labels.iter().zip(values) {
            table.set(&[*label], value);
        }
        table.tidy();
    }

    /// `option p > s`: for each element of the first index of `p` an order of the elements of `s`, as pairs of an
    /// element and what stands in its place.
    fn permute(&mut self, target: SymbolId, numbers: TableId, set: TableId, span: Span) {
        let [numbers, set] = [numbers, set].map(|t| {
            self.store.table_mut(t).tidy();
            let labels = self.store.table(t).iter().map(|(k, _)| k[0]);
            labels.collect::<Vec<Label>>()
        });
        let table = self.symbols.get(target).table;
        let table = self.store.table_mut(table);
        table.clear();
        let mut order: Vec<usize> = (0..set.len()).collect();
        let mut more = true;
        for &number in &numbers {
            if !more {
                break;
            }
            for (&place, &k) in set.iter().zip(&order) {
                table.set(&[number, place, set[k]], 1.0);
            }
            more = next_order(&mut order);
        }
        table.tidy();
        if more {
            let (elements, orders) = (set.len(), numbers.len());
            let message = format!("{elements} elements have more than {orders} orders");
            self.execution_error("E0409", span, message, "the rest is left out");
        }
    }

    /// `option p < q`: counts where `q` has more positions; to a set: membership.
    fn project(&mut self, target: SymbolId, source: SymbolId, positions: &[usize]) {
        let (t, s) = (self.symbols.get(target), self.symbols.get(source));
        let (tt, st, to_set, from_set) = (t.table, s.table, t.is_set(), s.is_set());
        self.store.table_mut(st).tidy();
        let d = positions.len();
        let records = self.store.table(st).iter();
        let rows = records.map(|(k, v)| (positions.iter().map(|&p| k[p]).collect(), v));
        let mut rows: Vec<(Vec<Label>, f64)> = rows.collect();
        rows.sort_by(|a, b| a.0.cmp(&b.0));
        let same_dim = d == self.store.table(st).dim();
        let (mut keys, mut values): (Vec<Label>, Vec<f64>) = (Vec::new(), Vec::new());
        for (i, (k, v)) in rows.iter().enumerate() {
            let repeated = i > 0 && rows[i - 1].0 == *k;
            let counts = to_set || from_set || !same_dim;
            let v = if counts { 1.0 } else { *v };
            match (repeated, values.last_mut()) {
                (true, Some(last)) => *last = if to_set { v } else { *last + 1.0 },
                _ => {
                    keys.extend_from_slice(k);
                    values.push(v);
                }
            }
        }
        let table = self.store.table_mut(tt);
        if d == 0 {
            let v = values.last().copied().unwrap_or(0.0);
            table.set(&[], v);
        } else {
            *table = Table::from_records(d, 0.0, keys, values);
        }
    }
}

/// The next order of numbers, as a dictionary has them. False: there is none.
fn next_order(order: &mut [usize]) -> bool {
    let Some(k) = order.windows(2).rposition(|w| w[0] < w[1]) else {
        return false;
    };
    let larger = order.iter().rposition(|&x| x > order[k]).unwrap_or(k);
    order.swap(k, larger);
    order[k + 1..].reverse();
    true
}
