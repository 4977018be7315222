//! The iteration planner: every "for each tuple such that …" runs over nonzeros.
//!
//! Sums, assignments, loops and equation domains are all a set of free slots, tables in which the
//! tuple must be (index sets, tuple sets), and conjuncts of a condition. The planner adds tables
//! whose zero makes the condition false or the term vanish, picks for each step the cheapest table
//! given what is bound, and tests the rest as soon as it can be tested.
//!
//! Invariant: a plan never changes *which* tuples count, only how they are found; the order of the
//! indices in the text does not matter for speed. Where a user sees the order, tuples come in
//! label order ([`Branch::ordered`], or sorted after).

use super::Machine;
use super::support::{Analysis, Premise, SAME, Sparse, product};
use crate::check::node::*;
use crate::check::symbols::DomainPosition;
use crate::check::visit::Visitor;
use crate::data::sort::sort_tuples;
use crate::data::universe::Label;
use std::sync::{Arc, PoisonError};

/// How to enumerate a domain.
#[derive(Debug)]
pub struct Plan {
    /// The tuples of all branches count.
    branches: Vec<Branch>,
    /// Conditions that draw random numbers, where tuples are gathered: evaluated in their order.
    late: Box<[usize]>,
    /// What it takes for granted.
    premises: Vec<Premise>,
}

/// A nest of scans and tests that finds tuples.
#[derive(Debug)]
struct Branch {
    /// Steps, outermost first.
    steps: Vec<Step>,
    /// Whether tuples come in label order of the domain's slots.
    ordered: bool,
    /// Whether it runs over indices of inner sums too, so that a tuple may come several times.
    projects: bool,
    /// Records that are visited, about.
    work: f64,
}

/// A step of a plan.
#[derive(Debug)]
enum Step {
    /// For each record of a table that agrees with what is bound.
    Scan {
        /// The table.
        table: TableId,
        /// Its key.
        key: Box<[Part]>,
        /// Positions that are bound.
        mask: u32,
        /// Position and slot of what it binds.
        bind: Box<[(u8, Slot)]>,
        /// The same where the key has a lag of the slot.
        unlag: Box<[(u8, Slot)]>,
        /// Positions that must equal what the same record binds.
        equal: Box<[u8]>,
    },
    /// A record must be there.
    Member(TableId, Key),
    /// One of the alternatives must have its records, each as far as the positions of a mask say.
    Any(Box<[Vec<(Driver, u32)>]>),
    /// Conjuncts of the condition (by number) must be true together. Their own sums leave these slots changed,
    /// which scans around still read.
    Filter(Box<[usize]>, Box<[Slot]>),
}

/// A table whose record must be nonzero for the tuple to count.
#[derive(Clone)]
struct Candidate {
    table: TableId,
    key: Key,
    /// Must be tested if it is not scanned.
    required: bool,
    done: bool,
}

impl Candidate {
    fn new(r: &Driver, required: bool) -> Self {
        Self {
            table: r.table,
            key: r.key.clone(),
            required,
            done: false,
        }
    }
}

/// Which tuples of a domain are wanted.
#[derive(Clone, Copy, Default)]
pub(super) struct Wanted<'n> {
    /// Those for which this is not `rest`; all without it.
    pub value: Option<&'n Node>,
    /// What the value is to be different from.
    pub rest: f64,
    /// And those that are stored now: an assignment changes them too.
    pub stored: Option<(TableId, &'n Key)>,
    /// And those for which these conditions of a loop can hold, if they draw random numbers.
    pub drawn: &'n [Node],
    /// It is the domain of a sum, not of a statement.
    pub inside: bool,
}

impl<'n> Wanted<'n> {
    /// Those for which a body is not 0, if it matters.
    pub(super) fn nonzero(value: Option<&'n Node>) -> Self {
        Self {
            value,
            inside: true,
            ..Self::default()
        }
    }

    /// Whether random numbers are drawn.
    fn draws(&self, d: &Domain) -> bool {
        let all = d.conditions.iter().chain(self.value).chain(self.drawn);
        all.into_iter().any(Node::has_random)
    }
}

/// Which table is scanned next.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Pick {
    /// The one with the smallest fan-out.
    Cheapest,
    /// One that keeps the tuples in the order of the slots: where random numbers are drawn.
    InOrder,
}

/// Gathering and sorting a tuple costs so many times what visiting it does.
const GATHERING: f64 = 3.0;
/// A further branch costs as much as visiting so many records.
const BRANCHING: f64 = 16.0;

impl Plan {
    /// Whether tuples can be used as they are found.
    fn direct(&self) -> Option<&Branch> {
        match self.branches.as_slice() {
            [one] if !one.projects && self.late.is_empty() => Some(one),
            _ => None,
        }
    }

    /// Tables that are scanned: they must be tidy.
    pub(super) fn scanned(&self) -> impl Iterator<Item = TableId> {
        let steps = self.branches.iter().flat_map(|b| &b.steps);
        steps.flat_map(|s| match s {
            Step::Scan { table, .. } => vec![*table],
            Step::Any(all) => {
                let tables = all.iter().flatten().map(|(r, _)| r.table);
                tables.filter(|&t| t != SAME).collect()
            }
            _ => Vec::new(),
        })
    }
}

/// What so many branches cost.
fn cost(branches: &[Branch]) -> f64 {
    match branches {
        [one] if !one.projects => one.work,
        _ => {
            let each = branches.iter();
            each.map(|b| BRANCHING + GATHERING * b.work).sum()
        }
    }
}

/// Records that the conditions and what is wanted need.
fn supports(d: &Domain, wanted: Wanted, analysis: &mut Analysis) -> Vec<Sparse> {
    let mut supports: Vec<Sparse> = Vec::new();
    if !d.slots.is_empty() {
        supports.extend(analysis.conjuncts(&d.conditions));
        let drawn = wanted.drawn.iter().filter(|c| c.has_random());
        supports.extend(drawn.filter_map(|c| {
            let support = analysis.nonzero(c, false)?.support;
            Some(Sparse {
                rest: 0.0,
                support,
                forced: true,
            })
        }));
        if let Some(v) = wanted.value
            && let Some(mut s) = analysis.resting_at(wanted.rest, v, v.has_var)
        {
            s.support.extend(wanted.stored.map(|(table, key)| {
                let key = key.clone();
                vec![Driver { table, key }]
            }));
            s.forced |= analysis.draws;
            // A number that is 0 keeps nothing from being drawn.
            supports.extend((!analysis.draws || !s.support.is_empty()).then_some(s));
        }
    }
    supports
}

/// Where random numbers are drawn, as in GAMS: every index is looked at by itself, in order, and tells of the records that
/// each alternative needs what it can with those before. The records that all tuples need come first.
fn levels(d: &Domain, supports: Vec<Sparse>, inside: bool) -> (Vec<Candidate>, Vec<Levels>) {
    let (mut first, mut levels) = (Vec::new(), Vec::new());
    for s in supports {
        match s.support.as_slice() {
            [one] => {
                for r in one {
                    let slots = slots_of_key(&r.key);
                    if slots.iter().any(|&s| is_inner(s, d)) {
                        levels.push(vec![vec![r.clone()]]);
                    } else if !inside || slots.iter().any(|s| d.slots.contains(s)) {
                        first.push(Candidate::new(r, s.forced));
                    }
                }
            }
            _ if s.forced => levels.push(s.support),
            _ => {}
        }
    }
    (first, levels)
}

/// Alternatives, each of records.
type Levels = Vec<Vec<Driver>>;

/// Records that every tuple needs, which drive the first branch, and the alternatives that replace it where that is
/// less work; those that must be are marked.
fn drivers(d: &Domain, supports: Vec<Sparse>) -> (Vec<Vec<Candidate>>, Vec<Alternatives>) {
    let mut open: Vec<Alternatives> = Vec::new();
    let mut first: Vec<Candidate> = Vec::new();
    for s in supports {
        let inner = |c: &Candidate| slots_of_key(&c.key).iter().any(|&s| is_inner(s, d));
        let candidate = |m: Driver| {
            let mut c = Candidate::new(&m, false);
            c.required = s.forced && !inner(&c);
            c
        };
        let alternatives: Vec<Vec<Candidate>> = s
            .support
            .into_iter()
            .map(|a| a.into_iter().map(candidate).collect())
            .collect();
        if let [one] = alternatives.as_slice() {
            first.extend(one.iter().filter(|c| !inner(c)).cloned());
            if !one.iter().any(inner) {
                continue;
            }
        }
        open.push((s.forced, alternatives));
    }
    (vec![first], open)
}

/// Whether they must be taken, and what drives each branch.
type Alternatives = (bool, Vec<Vec<Candidate>>);

/// A nest of scans in the making.
struct Nest<'a, 'h> {
    machine: &'a Machine<'h>,
    domain: &'a Domain,
    /// Slots that are run over, and those of them that are not bound yet.
    indices: Vec<Slot>,
    free: Vec<Slot>,
    candidates: Vec<Candidate>,
    /// Conjuncts, with the slots that they read.
    filters: Vec<(&'a [usize], Vec<Slot>)>,
    /// What a slot's label is known to be a member of, by the tables that bound it.
    known: Vec<(Slot, TableId)>,
    steps: Vec<Step>,
    /// Slots as they were bound.
    order: Vec<Slot>,
    in_order: bool,
    /// What tells where random numbers are drawn, and for how many slots of the order it is asked.
    levels: &'a [Levels],
    asked: usize,
    /// Inside of a sum.
    inside: bool,
}

impl<'a, 'h> Nest<'a, 'h> {
    fn new(
        machine: &'a Machine<'h>,
        d: &'a Domain,
        filters: &'a [Box<[usize]>],
        drivers: &[Candidate],
        (levels, inside): (&'a [Levels], bool),
    ) -> Self {
        let members = d.members.iter().map(|m| Candidate::new(m, true));
        let free = run_over(d, drivers);
        let filters = filters.iter().map(|list| {
            let conditions = || list.iter().map(|&i| &d.conditions[i]);
            let mut used: Vec<Slot> = conditions().flat_map(slots_of).collect();
            used.retain(|s| free.contains(s));
            if conditions().any(Node::has_random) {
                // Drawn once per tuple.
                used = free.clone();
            }
            (&**list, used)
        });
        Self {
            machine,
            domain: d,
            filters: filters.collect(),
            candidates: members.chain(drivers.iter().cloned()).collect(),
            known: Vec::new(),
            steps: Vec::new(),
            order: Vec::new(),
            in_order: true,
            indices: free.clone(),
            free,
            levels,
            asked: 0,
            inside,
        }
    }

    /// Asks the alternatives about each slot that was bound, and at first, in a statement, about what stands around it.
    fn ask(&mut self) {
        let around = (self.order.is_empty() && !self.inside).then_some(0);
        for n in around.into_iter().chain(self.asked + 1..=self.order.len()) {
            let bound = &self.order[..n];
            let open = |s: &Slot| {
                let later = self.domain.slots.contains(s) && !bound.contains(s);
                later || is_inner(*s, self.domain)
            };
            let tells = |r: &Driver| {
                // Records are in the order of their positions: only the first ones can be looked up.
                let parts = r.key.parts.iter().map(slots_of_part);
                let known: Vec<_> = parts.take_while(|p| !p.iter().any(open)).collect();
                let whole = known.len() == r.key.parts.len();
                let here = bound.last().map_or(whole, |s| known.concat().contains(s));
                let asked = here && (r.table != SAME || whole);
                asked.then(|| (r.clone(), (1 << known.len()) - 1))
            };
            for alternatives in self.levels {
                let tests = alternatives.iter();
                let tests: Vec<Vec<_>> = tests
                    .map(|all| all.iter().filter_map(tells).collect())
                    .collect();
                if tests.iter().all(|all| !all.is_empty()) {
                    self.steps.push(Step::Any(tests.into()));
                }
            }
        }
        self.asked = self.order.len();
    }

    /// Tests what can be tested with the slots that are bound.
    fn settle(&mut self) {
        self.ask();
        let Self {
            machine,
            domain: d,
            free,
            steps,
            ..
        } = self;
        for c in self.candidates.iter_mut().filter(|c| !c.done && c.required) {
            if slots_of_key(&c.key).iter().any(|s| free.contains(s)) {
                continue;
            }
            c.done = true;
            let implied = match c.key.parts.as_slice() {
                [Part::Slot(s)] => {
                    let mut sets = self.known.iter().filter(|(k, _)| k == s);
                    sets.any(|&(_, t)| machine.within(t, c.table))
                }
                _ => false,
            };
            if !implied {
                steps.push(Step::Member(c.table, c.key.clone()));
            }
        }
        self.filters.retain(|(list, used)| {
            if used.iter().any(|s| free.contains(s)) {
                return true;
            }
            let conditions = || list.iter().map(|&i| &d.conditions[i]);
            if !conditions().all(|c| machine.scanned_by(c, steps)) {
                let changed = conditions().flat_map(slots_of);
                let changed = changed.filter(|s| is_inner(*s, d) && self.indices.contains(s));
                steps.push(Step::Filter((*list).into(), changed.collect()));
            }
            false
        });
    }

    /// The table to be scanned next, with its fan-out.
    fn next(&self, pick: Pick, changing: Option<TableId>) -> Option<(f64, usize)> {
        let mut best: Option<(f64, f64, usize)> = None;
        let candidates = self.candidates.iter().enumerate();
        for (i, c) in candidates.filter(|(_, c)| !c.done && c.table != SAME) {
            let Some(new) = binds(&c.key, &self.free) else {
                continue;
            };
            let plain = c.key.is_plain();
            if pick == Pick::InOrder && (new != self.free[..new.len()] || !plain) {
                continue;
            }
            let t = self.machine.store.table(c.table);
            let rows = t.len() as f64;
            let mut groups = 1.0;
            if t.is_tidy() && changing != Some(c.table) {
                for (p, part) in c.key.parts.iter().enumerate() {
                    if !mentions(part, &self.free) {
                        groups *= f64::from(t.distinct()[p]);
                    }
                }
            }
            // Fan-out per slot that it binds.
            let fan = (rows / groups.clamp(1.0, rows.max(1.0))).max(1e-3);
            let each = fan.powf(1.0 / new.len() as f64);
            if best.is_none_or(|(b, ..)| each < b * 0.999) {
                best = Some((each, fan, i));
            }
        }
        best.map(|(_, fan, i)| (fan, i))
    }

    /// Scans a candidate's table, which binds its free slots.
    fn scan(&mut self, i: usize) {
        let c = &mut self.candidates[i];
        c.done = true;
        let (mut mask, mut bind, mut unlag, mut equal) = (0u32, Vec::new(), Vec::new(), Vec::new());
        for lagged in [false, true] {
            for (p, part) in c.key.parts.iter().enumerate() {
                if matches!(part, Part::Lag(_)) != lagged {
                    continue;
                }
                let list = if lagged { &mut unlag } else { &mut bind };
                match base_slot(part).filter(|s| self.free.contains(s)) {
                    Some(s) if self.order.contains(&s) => equal.push(p as u8),
                    Some(s) => {
                        list.push((p as u8, s));
                        self.order.push(s);
                    }
                    None => mask |= 1 << p,
                }
            }
        }
        self.free.retain(|s| !self.order.contains(s));
        self.in_order &= unlag.is_empty();
        for &(p, s) in &bind {
            if self.machine.store.table(c.table).dim() == 1 {
                self.known.push((s, c.table));
            }
            if let Some(t) = self.machine.position_set(c.table, p as usize) {
                self.known.push((s, t));
            }
        }
        self.steps.push(Step::Scan {
            table: c.table,
            key: c.key.parts.clone().into(),
            mask,
            bind: bind.into(),
            unlag: unlag.into(),
            equal: equal.into(),
        });
    }
}

/// The slots of a domain, and those of inner sums where drivers lead from them to one of the domain.
fn run_over(d: &Domain, drivers: &[Candidate]) -> Vec<Slot> {
    let mut free: Vec<Slot> = d.slots.clone();
    let used: Vec<Vec<Slot>> = drivers.iter().map(|c| slots_of_key(&c.key)).collect();
    loop {
        let before = free.len();
        for slots in &used {
            if slots.iter().any(|s| free.contains(s)) {
                for &s in slots {
                    if is_inner(s, d) && !free.contains(&s) {
                        free.push(s);
                    }
                }
            }
        }
        if free.len() == before {
            return free;
        }
    }
}

impl Machine<'_> {
    /// The plan of a domain.
    pub(super) fn plan(&self, d: &Domain, wanted: Wanted) -> Arc<Plan> {
        let known = || d.plan.0.lock().unwrap_or_else(PoisonError::into_inner);
        let last = known().clone();
        if let Some(Ok(p)) = last.map(Arc::downcast::<Plan>)
            && p.premises.iter().all(|p| self.holds_still(p))
        {
            return p;
        }
        let p = Arc::new(self.make_plan(d, wanted));
        *known() = Some(p.clone());
        p
    }

    fn make_plan(&self, d: &Domain, wanted: Wanted) -> Plan {
        let draws = wanted.draws(d);
        let pick = match draws {
            true => Pick::InOrder,
            false => Pick::Cheapest,
        };
        let mut analysis = Analysis::new(self, &d.slots, draws);
        let supports = supports(d, wanted, &mut analysis);
        let (mut branches, mut open, mut asked) = (Vec::new(), Vec::new(), Vec::new());
        if draws {
            let (first, levels) = levels(d, supports, wanted.inside);
            branches.push(first);
            asked = levels;
        } else {
            (branches, open) = drivers(d, supports);
        }
        // As in GAMS one condition is evaluated where another is false: an error in it is reported.
        let count = d.conditions.len();
        let filters: Vec<Box<[usize]>> = if d.conditions.iter().all(|c| analysis.is_safe(c)) {
            (0..count).map(|i| [i].into()).collect()
        } else {
            vec![(0..count).collect()]
        };
        let random = |list: &[usize]| list.iter().any(|&i| d.conditions[i].has_random());
        let (late, early): (Vec<_>, Vec<_>) = filters.iter().cloned().partition(|f| random(f));
        let gathers = |list: &[Vec<Candidate>]| {
            let mut all = list.iter().flatten();
            list.len() > 1 || all.any(|c| slots_of_key(&c.key).iter().any(|&s| is_inner(s, d)))
        };
        let levels = (asked.as_slice(), wanted.inside);
        let changing = wanted.stored.map(|s| s.0);
        let make = |list: &[Vec<Candidate>]| -> Vec<Branch> {
            let filters = if gathers(list) { &early } else { &filters };
            let branch = |c: &Vec<Candidate>| self.branch(d, filters, c, levels, pick, changing);
            list.iter().map(branch).collect()
        };
        let mut premises = analysis.premises;
        let mut tables: Vec<TableId> = d.members.iter().map(|m| m.table).collect();
        let named = open.iter().flat_map(|(_, o)| o).chain(&branches).flatten();
        tables.extend(named.map(|c| c.table));
        tables.extend(asked.iter().flatten().flatten().map(|r| r.table));
        tables.retain(|&t| t != SAME);
        tables.sort_unstable();
        tables.dedup();
        let size = |&t: &TableId| Premise::Size(t, self.store.table(t).len());
        premises.extend(tables.iter().map(size));
        let mut made = make(&branches);
        open.sort_by_key(|(forced, _)| !forced);
        for (forced, alternatives) in open {
            let Some(wider) = product(&branches, &alternatives) else {
                continue;
            };
            let other = make(&wider);
            if forced || cost(&other) < cost(&made) {
                (branches, made) = (wider, other);
            }
        }
        Plan {
            late: match gathers(&branches) {
                true => late.concat().into(),
                false => Box::default(),
            },
            branches: made,
            premises,
        }
    }

    /// One nest of scans, driven by what must be there. `changing`: the table that the statement writes to,
    /// whose order must be made anew each time.
    fn branch(
        &self,
        d: &Domain,
        filters: &[Box<[usize]>],
        drivers: &[Candidate],
        levels: (&[Levels], bool),
        pick: Pick,
        changing: Option<TableId>,
    ) -> Branch {
        let mut nest = Nest::new(self, d, filters, drivers, levels);
        let (mut rows_so_far, mut work) = (1.0, 1.0);
        nest.settle();
        while d.slots.iter().any(|s| nest.free.contains(s)) {
            let Some((fan, next)) = nest.next(pick, changing) else {
                // A slot that no table binds: cannot happen, since every controlled index has its set.
                debug_assert!(false, "a slot without a driver");
                break;
            };
            rows_so_far *= fan;
            work += rows_so_far;
            nest.scan(next);
            nest.settle();
        }
        // Inner indices that are left are for the filters to run over.
        nest.free.clear();
        nest.settle();
        Branch {
            ordered: nest.in_order && nest.order == d.slots,
            projects: nest.order.len() > d.slots.len(),
            steps: nest.steps,
            work,
        }
    }

    /// Whether a condition holds because a step scans the record that must not be 0.
    fn scanned_by(&self, condition: &Node, steps: &[Step]) -> bool {
        let (t, wanted) = match &condition.kind {
            NodeKind::Data(t, wanted) => (t, wanted),
            NodeKind::Binary(BinaryOp::Or, a, b) if !condition.has_random() => {
                // `na` on one side is `na`, which counts as true as well.
                return self.scanned_by(a, steps) || self.scanned_by(b, steps);
            }
            _ => return false,
        };
        let same = |(a, b): (&Part, &Part)| match (a, b) {
            (Part::Slot(a), Part::Slot(b)) => a == b,
            (Part::Label(a), Part::Label(b)) => a == b,
            _ => false,
        };
        self.store.table(*t).default_value() == 0.0
            && steps.iter().any(|s| match s {
                Step::Scan { table, key, .. } => {
                    table == t && key.iter().zip(&wanted.parts).all(same)
                }
                _ => false,
            })
    }

    /// The set that a table's position runs over, by its declaration.
    fn position_set(&self, table: TableId, position: usize) -> Option<TableId> {
        let symbol = self.symbols.get(self.table_symbol(table)?);
        match symbol.domain.get(position)? {
            DomainPosition::Set(d) => Some(self.symbols.get(*d).table),
            _ => None,
        }
    }

    /// Whether every member of set table `a` is in `b`.
    fn within(&self, a: TableId, b: TableId) -> bool {
        if a == b {
            return true;
        }
        match (self.table_symbol(a), self.table_symbol(b)) {
            (Some(x), Some(y)) => {
                let y_set = self.symbols.get(y);
                // Declared subsets are checked on the way in; a set that assignments shrink is no bound.
                self.symbols.get(x).is_set() && !y_set.dynamic && self.symbols.is_subset(x, y)
            }
            _ => false,
        }
    }

    /// Runs a plan: `f` is called for each tuple with the frame filled in; it returns false to stop.
    pub(super) fn run_plan(
        &self,
        d: &Domain,
        plan: &Plan,
        frame: &mut Vec<Label>,
        f: &mut dyn FnMut(&mut Vec<Label>) -> bool,
    ) -> bool {
        if let Some(one) = plan.direct() {
            return self.run_steps(d, &one.steps, frame, f);
        }
        let tuples = self.gather(d, plan, frame);
        tuples.chunks_exact(d.slots.len()).all(|t| {
            for (&s, &l) in d.slots.iter().zip(t) {
                frame[s as usize] = l;
            }
            let late = plan.late.iter().map(|&i| &d.conditions[i]);
            !self.all_hold(late, frame) || f(frame)
        })
    }

    /// All tuples of a plan, flat, each once, in label order.
    fn gather(&self, d: &Domain, plan: &Plan, frame: &mut Vec<Label>) -> Vec<Label> {
        let mut out = Vec::new();
        for b in &plan.branches {
            self.run_steps(d, &b.steps, frame, &mut |f| {
                out.extend(d.slots.iter().map(|&s| f[s as usize]));
                self.keep_going()
            });
        }
        match plan.direct() {
            Some(one) if one.ordered => out,
            one => sort_tuples(out, d.slots.len(), one.is_none()),
        }
    }

    fn run_steps(
        &self,
        d: &Domain,
        steps: &[Step],
        frame: &mut Vec<Label>,
        f: &mut dyn FnMut(&mut Vec<Label>) -> bool,
    ) -> bool {
        let Some((step, rest)) = steps.split_first() else {
            return f(frame);
        };
        let holds = match step {
            Step::Filter(list, changed) => {
                let before: Vec<Label> = changed.iter().map(|&s| frame[s as usize]).collect();
                let holds = self.all_hold(list.iter().map(|&i| &d.conditions[i]), frame);
                for (&s, l) in changed.iter().zip(before) {
                    frame[s as usize] = l;
                }
                holds
            }
            Step::Member(t, key) => self.is_member(*t, key, frame),
            Step::Any(alternatives) => {
                let mut there = |(r, mask): &(Driver, u32)| self.has_record(r, *mask, frame);
                alternatives.iter().any(|all| all.iter().all(&mut there))
            }
            Step::Scan {
                table,
                key,
                mask,
                bind,
                unlag,
                equal,
            } => {
                let t = self.store.table(*table);
                let order;
                let rows = if *mask == 0 {
                    t.all()
                } else {
                    let Some(k) = self.labels_at(key, *mask, frame) else {
                        return true;
                    };
                    order = t.order(*mask);
                    t.group(&order, &k[..key.len()])
                };
                let last = rest.is_empty();
                for r in 0..rows.len() {
                    let record = t.visit(rows.get(r));
                    for &(p, s) in bind.iter() {
                        frame[s as usize] = record[p as usize];
                    }
                    if !unlag.iter().all(|&(p, s)| {
                        let label = self.unlag(&key[p as usize], record[p as usize], frame);
                        label.is_some_and(|l| {
                            frame[s as usize] = l;
                            true
                        })
                    }) || !equal
                        .iter()
                        .all(|&p| self.part(&key[p as usize], frame) == Some(record[p as usize]))
                    {
                        continue;
                    }
                    let go_on = if last {
                        f(frame)
                    } else {
                        self.run_steps(d, rest, frame, f)
                    };
                    if !go_on {
                        return false;
                    }
                }
                return true;
            }
        };
        !holds || self.run_steps(d, rest, frame, f)
    }

    /// The labels of a key at the positions of a mask.
    #[inline]
    fn labels_at(&self, key: &[Part], mask: u32, frame: &mut Vec<Label>) -> Option<[Label; 20]> {
        let mut k = [0; 20];
        for (p, part) in key.iter().enumerate().filter(|(p, _)| mask >> p & 1 == 1) {
            k[p] = self.part(part, frame)?;
        }
        Some(k)
    }

    /// Whether there is a record with the labels at the positions of a mask.
    fn has_record(&self, r: &Driver, mask: u32, frame: &mut Vec<Label>) -> bool {
        let parts = &r.key.parts;
        if mask.count_ones() as usize == parts.len() {
            return self.is_member(r.table, &r.key, frame);
        }
        let Some(k) = self.labels_at(parts, mask, frame) else {
            return false;
        };
        let t = self.store.table(r.table);
        !t.group(&t.order(mask), &k[..parts.len()]).is_empty()
    }

    /// All tuples of a domain, flat, in label order; of a loop, with the conditions that are tested at each turn.
    pub(super) fn tuples(&self, d: &Domain, drawn: &[Node], frame: &mut Vec<Label>) -> Vec<Label> {
        let wanted = Wanted {
            drawn,
            ..Wanted::default()
        };
        let plan = self.plan(d, wanted);
        if plan.late.is_empty() {
            return self.gather(d, &plan, frame);
        }
        let mut out = Vec::new();
        self.run_plan(d, &plan, frame, &mut |f| {
            out.extend(d.slots.iter().map(|&s| f[s as usize]));
            self.keep_going()
        });
        out
    }
}

/// Whether a slot belongs to a sum inside the expression, not to the statement around.
fn is_inner(slot: Slot, d: &Domain) -> bool {
    d.slots.iter().max().is_some_and(|&m| slot > m)
}

/// The slot whose label a record's label at this part gives.
fn base_slot(p: &Part) -> Option<Slot> {
    match p {
        Part::Slot(s) => Some(*s),
        Part::Lag(l) => base_slot(&l.base),
        _ => None,
    }
}

/// The free slots that scanning a key binds; None when it binds none, or a lag is not known by then.
fn binds(key: &Key, free: &[Slot]) -> Option<Vec<Slot>> {
    let mut new = Vec::new();
    for p in &key.parts {
        if let Part::Lag(l) = p
            && (slots_of(&l.offset).iter().any(|s| free.contains(s))
                || matches!(l.base, Part::Lag(_)))
        {
            return None;
        }
        if let Some(s) = base_slot(p).filter(|s| free.contains(s) && !new.contains(s)) {
            new.push(s);
        }
    }
    (!new.is_empty()).then_some(new)
}

/// Slots that a key reads.
pub(super) fn slots_of_key(key: &Key) -> Vec<Slot> {
    key.parts.iter().flat_map(slots_of_part).collect()
}

/// Whether a part mentions one of the slots.
fn mentions(p: &Part, slots: &[Slot]) -> bool {
    slots_of_part(p).iter().any(|s| slots.contains(s))
}

/// Slots that an expression reads, those of its own sums too.
fn slots_of(n: &Node) -> Vec<Slot> {
    let mut slots = Slots(Vec::new());
    slots.node(n);
    slots.0
}

fn slots_of_part(p: &Part) -> Vec<Slot> {
    let mut slots = Slots(Vec::new());
    slots.part(p);
    slots.0
}

/// Collects slots.
struct Slots(Vec<Slot>);

impl Visitor<'_> for Slots {
    fn part(&mut self, p: &Part) {
        if let Part::Slot(s) = p {
            self.0.push(*s);
        }
        p.walk(self);
    }
}
