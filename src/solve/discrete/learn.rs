//! What contradictions teach: bounds of binary columns that no better solution has together.
//!
//! The trail says which row moved a bound. Where a row contradicts the bounds of a node, the bounds that it takes are replaced by those
//! that led to them, the last first, until all are of binary columns and only one follows from the last decision (the first unique
//! implication point, Marques-Silva & Sakallah 1999; for linear rows Achterberg 2007): one of these bounds must be otherwise, wherever
//! else they meet. A relaxation without a better point contradicts in the same way, by the sum of its rows with their multipliers
//! (Witzig, Berthold & Heinz 2017).

use super::model::{INTEGRAL, Mip};
use super::propagate::Propagator;
use std::collections::BTreeSet;

/// Clauses that are kept at most.
const KEPT: usize = 1000;

/// Literals that a clause has at most, and for a binary column each.
const SHORT: usize = 10;
const PER_BINARY: f64 = 0.1;

/// Entries of rows that the search for one reason looks at, at most, by entries of the program.
const EFFORT: usize = 10;

/// Terms of a row, and what their sum is not above.
pub type Sum = (Vec<(usize, f64)>, f64);

/// No step.
const NONE: u32 = u32::MAX;

/// A bound of a binary column: that it is 1, or 0.
#[derive(Clone, Copy)]
struct Literal {
    column: u32,
    is_one: bool,
}

impl Literal {
    fn holds(self, lower: &[f64], upper: &[f64]) -> bool {
        let j = self.column as usize;
        if self.is_one {
            lower[j] >= 1.0
        } else {
            upper[j] <= 0.0
        }
    }

    fn not(self) -> Self {
        Self {
            is_one: !self.is_one,
            ..self
        }
    }
}

/// Not all of the literals hold. Of the first two, which are watched, neither does, unless all others do.
struct Clause {
    literals: Vec<Literal>,
    /// How often it moved bounds, lately.
    used: u32,
}

/// What a clause says of bounds.
pub(super) enum Said {
    /// Nothing.
    Nothing,
    /// This column is this.
    Implied(usize, f64),
    /// They contradict it.
    Contradiction,
}

/// What was learned.
pub(super) struct Learned {
    clauses: Vec<Clause>,
    /// By column: clauses that watch it.
    watched: Vec<Vec<u32>>,
    /// Literals that a clause may have.
    longest: usize,
}

impl Learned {
    fn new(mip: &Mip) -> Self {
        let p = &mip.problem;
        let is_binary = |j: &usize| mip.is_binary(*j, &p.lower, &p.upper);
        let binaries = (0..p.n()).filter(is_binary).count();
        Self {
            clauses: Vec::new(),
            watched: vec![Vec::new(); p.n()],
            longest: SHORT + (PER_BINARY * binaries as f64) as usize,
        }
    }

    pub(super) fn watching(&self, column: usize) -> &[u32] {
        &self.watched[column]
    }

    /// Follows a clause; literals that do not hold are watched.
    pub(super) fn say(&mut self, k: usize, lower: &[f64], upper: &[f64]) -> Said {
        let clause = &mut self.clauses[k];
        for w in 0..clause.literals.len().min(2) {
            if !clause.literals[w].holds(lower, upper) {
                continue;
            }
            let rest = clause.literals.iter().skip(2);
            let other = rest.enumerate().find(|l| !l.1.holds(lower, upper));
            if let Some((other, _)) = other {
                clause.literals.swap(w, other + 2);
                let [now, before] = [w, other + 2].map(|i| clause.literals[i].column as usize);
                self.watched[before].retain(|&c| c as usize != k);
                self.watched[now].push(k as u32);
            }
        }
        let mut open = clause
            .literals
            .iter()
            .take(2)
            .filter(|l| !l.holds(lower, upper));
        let said = match (open.next(), open.next()) {
            (Some(last), None) if !last.not().holds(lower, upper) => {
                Said::Implied(last.column as usize, f64::from(u8::from(!last.is_one)))
            }
            (None, _) => Said::Contradiction,
            _ => return Said::Nothing,
        };
        clause.used += 1;
        said
    }

    /// Clauses of one literal, which holds nowhere.
    fn alone(&self) -> impl Iterator<Item = usize> {
        (0..self.clauses.len()).filter(|&k| self.clauses[k].literals.len() == 1)
    }

    /// Its number.
    fn push(&mut self, literals: Vec<Literal>) -> usize {
        self.clauses.push(Clause { literals, used: 1 });
        self.watch(self.clauses.len() - 1);
        self.clauses.len() - 1
    }

    fn watch(&mut self, k: usize) {
        for l in self.clauses[k].literals.iter().take(2) {
            self.watched[l.column as usize].push(k as u32);
        }
    }

    /// Where there are many, the half that was used less, or is older, is forgotten. Whether there were.
    fn forget(&mut self) -> bool {
        if self.clauses.len() <= KEPT {
            return false;
        }
        let mut order: Vec<usize> = (0..self.clauses.len()).collect();
        let rank = |c: &Clause| {
            if c.literals.len() == 1 {
                u32::MAX
            } else {
                c.used
            }
        };
        order.sort_by_key(|&k| std::cmp::Reverse((rank(&self.clauses[k]), k)));
        let mut stays = vec![false; self.clauses.len()];
        order[..KEPT / 2].iter().for_each(|&k| stays[k] = true);
        let mut stays = stays.into_iter();
        self.clauses.retain(|_| stays.next() == Some(true));
        self.watched.iter_mut().for_each(Vec::clear);
        for k in 0..self.clauses.len() {
            self.clauses[k].used /= 2;
            self.watch(k);
        }
        true
    }
}

/// A bound that moved.
struct Step {
    column: u32,
    /// 1: the upper one.
    side: usize,
    value: f64,
    /// The step that moved it before, if any.
    before: u32,
    /// The row that moved it, and whether by its upper side; none: a decision.
    row: Option<(u32, bool)>,
    level: u32,
}

/// All bounds of a node that differ from those of the root, in the order in which they moved, and what was learned from such.
pub(super) struct Trail {
    steps: Vec<Step>,
    /// By side and column: the last step.
    last: [Vec<u32>; 2],
    level: u32,
    pub(super) learned: Learned,
}

impl Trail {
    fn new(mip: &Mip) -> Self {
        let columns = mip.problem.n();
        Self {
            steps: Vec::new(),
            last: [vec![NONE; columns], vec![NONE; columns]],
            level: 0,
            learned: Learned::new(mip),
        }
    }

    /// One more step, by a row in which the column has this coefficient, or by a decision.
    pub(super) fn push(
        &mut self,
        column: usize,
        side: usize,
        value: f64,
        row: Option<(usize, f64)>,
    ) {
        let last = &mut self.last[side][column];
        let before = std::mem::replace(last, self.steps.len() as u32);
        self.steps.push(Step {
            column: column as u32,
            side,
            value,
            before,
            row: row.map(|(i, a)| (i as u32, (a > 0.0) == (side == 1))),
            level: self.level,
        });
    }

    fn back_to(&mut self, length: usize) {
        for step in self.steps.drain(length..).rev() {
            self.last[step.side][step.column as usize] = step.before;
        }
    }

    /// The step that gave a bound what it was before step `at`, if one did.
    fn bound(&self, column: usize, side: usize, at: usize) -> Option<usize> {
        let mut k = self.last[side][column];
        while k != NONE && k as usize >= at {
            k = self.steps[k as usize].before;
        }
        (k != NONE).then_some(k as usize)
    }
}

impl Propagator {
    /// From here on it is kept how bounds came about, and learned from contradictions.
    pub fn trace(&mut self, mip: &Mip) {
        self.trail = Some(Trail::new(mip));
    }

    /// Whether contradictions teach.
    pub fn learns(&self) -> bool {
        self.trail.is_some()
    }

    /// The bounds are those of the root.
    pub fn at_root(&mut self, mip: &Mip) {
        if let Some(trail) = &mut self.trail {
            trail.back_to(0);
            if trail.learned.forget() {
                self.queue.clear();
            }
            for k in trail.learned.alone() {
                self.queue.push(mip.problem.m() + 1 + k);
            }
        }
        self.enqueue_objective(mip);
    }

    /// What follows, until the next, is one decision and what it implies.
    pub fn next_level(&mut self) {
        if let Some(trail) = &mut self.trail {
            trail.level += 1;
        }
    }

    /// A bound is decided.
    pub fn decide(&mut self, column: usize, side: usize, value: f64) {
        if let Some(trail) = &mut self.trail {
            trail.push(column, side, value, None);
        }
    }

    /// Where the trail is, to go back there.
    pub fn length(&self) -> usize {
        self.trail.as_ref().map_or(0, |t| t.steps.len())
    }

    /// Bounds are again what they were.
    pub fn back_to(&mut self, length: usize) {
        if let Some(trail) = &mut self.trail {
            trail.back_to(length);
        }
    }

    /// Learns from the row at which the last run ended; `root` are bounds that hold everywhere.
    pub fn learn_from_run(&mut self, mip: &Mip, root: [&[f64]; 2]) {
        if self.learns()
            && let Some((row, upper)) = self.contradicted.take()
            && let Some((terms, side)) = self.row_of(mip, row, upper)
        {
            self.learn(mip, &terms, side, root);
        }
    }

    /// Learns from a row that contradicts the bounds, the sum of the terms not above `side`.
    pub fn learn(&mut self, mip: &Mip, terms: &[(usize, f64)], side: f64, root: [&[f64]; 2]) {
        if let Some(literals) = self.contradiction(mip, terms, side, root)
            && let Some(trail) = &mut self.trail
        {
            let k = trail.learned.push(literals);
            self.queue.push(mip.problem.m() + 1 + k);
        }
    }

    /// Bounds of binary columns that contradict each other, the last first. None: there are none, or too many.
    fn contradiction(
        &self,
        mip: &Mip,
        terms: &[(usize, f64)],
        side: f64,
        root: [&[f64]; 2],
    ) -> Option<Vec<Literal>> {
        let trail = self.trail.as_ref()?;
        let mut open = BTreeSet::new();
        let now = trail.steps.len();
        let excess = trail.reason(terms, side, now, root, &mut open);
        if excess <= 1e-7 {
            return None;
        }
        let level = trail.steps[*open.last()?].level;
        let mut effort = EFFORT * (mip.problem.rows.value.len() + 1000);
        let mut literals = Vec::new();
        while let Some(at) = open.pop_last() {
            let step = &trail.steps[at];
            let j = step.column as usize;
            let binary = mip.is_binary(j, root[0], root[1]);
            let others = || open.last().is_some_and(|&k| trail.steps[k].level == level);
            let stays = binary && !(step.level == level && others());
            let Some((row, upper)) = step.row.filter(|_| !stays) else {
                if !binary || literals.len() == trail.learned.longest {
                    return None;
                }
                let (column, is_one) = (step.column, step.side == 0);
                literals.push(Literal { column, is_one });
                continue;
            };
            let (mut terms, side) = self.row_of(mip, row as usize, upper)?;
            effort = effort.checked_sub(terms.len())?;
            // what the others must reach so that no more is left for this bound
            let room = match (mip.integer[j], step.side) {
                (false, _) => 0.0,
                (true, 0) => INTEGRAL - 1.0,
                (true, _) => 1.0 - INTEGRAL,
            };
            let own = terms.iter().find(|t| t.0 == j)?.1;
            let needed = side - own * (step.value + room);
            terms.retain(|t| t.0 != j);
            if trail.reason(&terms, needed, at, root, &mut open) < -1e-9 {
                return None;
            }
        }
        Some(literals)
    }

    /// A row as `Σ terms ≤ side`, by its upper or its lower side. None: a clause, and there are none.
    fn row_of(&self, mip: &Mip, i: usize, upper: bool) -> Option<Sum> {
        let p = &mip.problem;
        Some(match i.checked_sub(p.m()) {
            Some(0) => (mip.costs().collect(), self.cutoff),
            Some(k) => {
                let literals = &self.trail.as_ref()?.learned.clauses[k - 1].literals;
                let sign = |l: &Literal| if l.is_one { 1.0 } else { -1.0 };
                let ones = literals.iter().filter(|l| l.is_one).count();
                let terms = literals.iter().map(|l| (l.column as usize, sign(l)));
                (terms.collect(), ones as f64 - 1.0)
            }
            None if upper => (p.rows.line(i).collect(), p.row_upper[i]),
            None => (
                p.rows.line(i).map(|(j, a)| (j, -a)).collect(),
                -p.row_lower[i],
            ),
        })
    }
}

impl Trail {
    /// Steps before `at` whose bounds keep `Σ terms` from being below `needed`; of those that would, the ones with the least effect
    /// are left out. By how much it is above, relative to the largest term.
    fn reason(
        &self,
        terms: &[(usize, f64)],
        needed: f64,
        at: usize,
        root: [&[f64]; 2],
        open: &mut BTreeSet<usize>,
    ) -> f64 {
        let (mut sum, mut size) = (0.0, needed.abs().max(1.0));
        let mut steps = Vec::new();
        for &(j, a) in terms.iter().filter(|t| t.1 != 0.0) {
            let side = usize::from(a < 0.0);
            let everywhere = a * root[side][j];
            let step = self.bound(j, side, at);
            let here = step.map_or(everywhere, |k| a * self.steps[k].value);
            sum += here.max(everywhere);
            size = size.max(here.abs());
            if let Some(k) = step.filter(|_| here > everywhere) {
                steps.push((here - everywhere, k));
            }
        }
        steps.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let (all, mut excess) = (sum - needed, sum - needed - 1e-9 * size);
        for (gain, k) in steps {
            if gain <= excess {
                excess -= gain;
            } else {
                open.insert(k);
            }
        }
        all / size
    }
}
