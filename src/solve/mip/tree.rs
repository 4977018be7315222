//! Branch and bound over any relaxation.
//!
//! A node has bounds of its own, on the columns that were branched on. Its relaxation gives a bound for all below it; what
//! cannot be better than the best solution is left. From a node the search plunges: it goes on with one of the two
//! children at once, which costs the relaxation a few pivots, and leaves the other in a heap; when a plunge ends, the open
//! node with the least bound is next. So at any time the least bound of the open nodes and the best solution enclose
//! the value.
//!
//! Branching is by pseudo-costs, what a unit of a column has cost so far, which a look at both children makes reliable
//! first (Achterberg, Koch & Martin 2005).

use super::branching::{Branch, Pseudo};
use super::driver::Found;
use super::model::{Change, INTEGRAL, Mip, Units};
use super::propagate::Propagator;
use super::relaxation::{Control, Relaxation, Solved};
use super::symmetry::Symmetry;
use crate::solve::Progress;
use crate::solve::lp::Ended;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// What a search is to reach, and where it may stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// `optCR`: the gap between solution and bound, relative to the solution, that is small enough.
    pub relative_gap: f64,
    /// `optCA`: the same, absolute.
    pub absolute_gap: f64,
    /// `nodLim`: nodes; 0: any number.
    pub nodes: u64,
    /// `cutOff`: only solutions that are better than this count.
    pub cutoff: Option<f64>,
    /// `cheat`: a new solution must be better by this.
    pub cheat: f64,
    /// `tryInt`: the levels at the start, rounded, are tried as a solution where they are this near to integers.
    pub try_start: f64,
    /// `priorOpt`: `.prior` decides what is branched on first.
    pub priorities: bool,
    /// Keep what became of every node.
    pub record: bool,
}

impl Default for Aim {
    fn default() -> Self {
        Self {
            relative_gap: 1e-4,
            absolute_gap: 0.0,
            nodes: 0,
            cutoff: None,
            cheat: 0.0,
            try_start: 0.0,
            priorities: false,
            record: false,
        }
    }
}

impl Aim {
    /// The same of sign × objective, which is minimized.
    pub fn minimizing(self, sign: f64) -> Self {
        let cutoff = self.cutoff.map(|c| sign * c);
        Self { cutoff, ..self }
    }
}

/// How a search ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// Nothing is left open.
    Complete,
    /// The gap is small enough.
    Gap,
    /// `nodLim`.
    Nodes,
    /// Another limit, or the user.
    Stopped(Ended),
    /// The relaxation is unbounded.
    Unbounded,
}

/// A node as a picture needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Number of the parent; none for the root.
    pub parent: Option<u32>,
    /// The first bound that makes the node differ from its parent.
    pub change: Option<Change>,
    /// Value of the relaxation (of the parent's, where it was not solved).
    pub value: f64,
    /// `branched`, `infeasible`, `bound`, `solution`, `open`.
    pub fate: &'static str,
    /// Value of the best solution that was found here, by the relaxation or by a heuristic.
    pub solution: Option<f64>,
}

/// A gap, relative to the solution, that is none.
pub(super) const PROVED: f64 = 1e-9;

/// How many nodes are recorded.
const RECORDS: usize = 100_000;

/// Bounds on the way to a node.
struct Path {
    changes: Vec<Change>,
    /// Columns that symmetries are to leave where they are from here on.
    pinned: Vec<usize>,
    parent: Option<Rc<Path>>,
}

impl Drop for Path {
    // A path may be longer than a stack of calls is deep.
    fn drop(&mut self) {
        let mut next = self.parent.take();
        while let Some(path) = next {
            next = match Rc::try_unwrap(path) {
                Ok(mut path) => path.parent.take(),
                Err(_) => None,
            };
        }
    }
}

struct Node<S> {
    bound: f64,
    depth: u32,
    number: u32,
    path: Option<Rc<Path>>,
    start: S,
    /// For pseudo-costs: column, direction and distance of the branch that made it.
    from: Option<(usize, usize, f64)>,
}

impl<S> PartialEq for Node<S> {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl<S> Eq for Node<S> {}

impl<S> PartialOrd for Node<S> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<S> Ord for Node<S> {
    /// The heap's largest is the next: least bound, then deepest, then last made.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let bound = other.bound.total_cmp(&self.bound);
        let depth = self.depth.cmp(&other.depth);
        bound.then(depth).then(self.number.cmp(&other.number))
    }
}

/// Finds solutions of the program that is left where columns are fixed.
pub type Neighbourhood<'n> = &'n dyn Fn(&Mip, &[Change], f64, &mut Control) -> Option<Vec<f64>>;

/// The search.
pub struct Search<'a, R: Relaxation> {
    pub(super) mip: &'a Mip,
    pub(super) relaxation: R,
    pub(super) aim: Aim,
    pub(super) units: Units,
    /// Bounds that hold everywhere.
    pub(super) root: [Vec<f64>; 2],
    /// Bounds of the present node.
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    propagator: Propagator,
    open: BinaryHeap<Node<R::Start>>,
    /// Value and point of the best solution.
    pub best: Option<(f64, Vec<f64>)>,
    /// Step of the values, 0 if they have none.
    step: f64,
    pub(super) pseudo: Vec<[Pseudo; 2]>,
    /// Nodes solved.
    pub nodes: u64,
    /// No solution is better than this.
    pub bound: f64,
    /// What became of the nodes, if that is asked for.
    pub records: Vec<Record>,
    /// A node was left although nothing is known about it.
    pub incomplete: bool,
    /// Solves the rest where some columns are fixed; None inside such a search.
    pub neighbourhood: Option<Neighbourhood<'a>>,
    /// Permutations that leave the program as it is.
    pub(super) symmetry: Option<&'a Symmetry>,
    pub(super) dives: Dives,
    next_log: f64,
    /// Nodes made.
    pub made: u32,
    /// Number of the present node.
    at: u32,
    /// Nodes whose relaxation was not solved.
    failures: u32,
    /// Nodes of a plunge: more than it takes to decide all columns once, for bounds may be infinite.
    longest: u32,
}

/// What the relaxation of a node says.
enum Evaluated {
    /// Nothing is left below it: what became of it.
    Leaf(&'static str),
    /// Nothing is known of it, and too many such nodes were divided before.
    GivenUp,
    /// The search ends here.
    Ended(End),
    /// It is left as it is for now.
    Later,
    /// It is divided.
    Divided(Branch),
}

/// What reduced costs did to a node.
enum Fixed {
    /// Nothing that its point does not satisfy.
    Nothing,
    /// The point is to be computed again.
    Moved,
    /// Nothing better is left below it.
    Empty,
}

/// Lower and upper bounds, and how many steps led to them.
pub(super) type Here = (Vec<f64>, Vec<f64>, usize);

/// How many nodes may be divided without a value of their relaxation.
const FAILURES: u32 = 200;

/// What heuristics have cost.
#[derive(Default)]
pub(super) struct Dives {
    /// Iterations of dives and of searches near a solution.
    pub iterations: u64,
    /// Iterations of looks at children.
    pub probes: u64,
    /// The value of the solution near which was searched last.
    pub last_near: f64,
    /// How many there were.
    pub count: u64,
}

impl<'a, R: Relaxation> Search<'a, R> {
    /// Nothing is solved yet.
    pub fn new(mip: &'a Mip, relaxation: R, aim: Aim, units: Units) -> Self {
        let p = &mip.problem;
        let n = p.n();
        let (lower, upper) = (p.lower.clone(), p.upper.clone());
        let mut propagator = Propagator::new(mip);
        propagator.continuous = relaxation.is_linear();
        Self {
            step: mip.granularity(),
            mip,
            relaxation,
            aim,
            units,
            root: [lower.clone(), upper.clone()],
            lower,
            upper,
            propagator,
            open: BinaryHeap::new(),
            best: None,
            pseudo: vec![Default::default(); n],
            nodes: 0,
            bound: f64::NEG_INFINITY,
            records: Vec::new(),
            incomplete: false,
            neighbourhood: None,
            symmetry: None,
            dives: Dives::default(),
            next_log: 0.0,
            made: 0,
            at: 0,
            failures: 0,
            longest: 100 + 2 * mip.integer.iter().filter(|i| **i).count() as u32,
        }
    }

    /// A value that only a better solution is below.
    pub(super) fn cutoff(&self) -> f64 {
        let asked = self
            .aim
            .cutoff
            .map_or(f64::INFINITY, |c| self.units.inner(c));
        let Some((v, _)) = &self.best else {
            return asked;
        };
        (v - self.better(*v).max(self.cheat())).min(asked)
    }

    /// By how much a solution is better than one of this value, if it is.
    fn better(&self, v: f64) -> f64 {
        match self.step > 0.0 && self.relaxation.is_exact() {
            true => self.step * (1.0 - 1e-6),
            false if self.relaxation.is_linear() => 1e-9 * v.abs().max(1e-3),
            // what a nonlinear solver leaves of digits
            false => 1e-7 * v.abs().max(0.1),
        }
    }

    fn cheat(&self) -> f64 {
        self.aim.cheat / self.units.price
    }

    /// From here on contradictions teach clauses.
    pub fn learn(&mut self) {
        self.propagator.trace(self.mip);
    }

    /// Runs from the root.
    pub fn run(&mut self, control: &mut Control) -> End {
        let mut end = self.search(control);
        if let Some((v, _)) = self.best {
            if end == End::Complete && !self.incomplete {
                self.bound = v;
            }
            // Solutions that are better by less than `cheat` were passed over.
            if self.cheat() > self.better(v) {
                self.bound = self.bound.min(v - self.cheat());
                end = if end == End::Complete { End::Gap } else { end };
            }
        }
        // What is no better than the solution is open no longer.
        let gap = self.best.as_ref().map(|b| self.units.gap(b.0, self.bound));
        let all = gap.is_some_and(|[_, relative]| relative <= PROVED);
        let cutoff = self.cutoff();
        let nodes = std::mem::take(&mut self.open).into_iter();
        let (done, open): (Vec<_>, Vec<_>) = nodes.partition(|n| all || n.bound >= cutoff);
        self.open = open.into();
        done.iter().for_each(|n| self.fate(n.number, "bound"));
        self.log(control, true);
        end
    }

    /// What it found, in its own columns and units.
    pub(super) fn found(self, end: End) -> Found {
        Found {
            value: self.best.as_ref().map_or(f64::INFINITY, |b| b.0),
            exact: self.relaxation.is_exact(),
            relaxed: self.nodes > 1,
            x: self.best.map(|b| b.1),
            bound: self.bound,
            nodes: self.nodes,
            incomplete: self.incomplete,
            end,
            records: self.records,
            made: self.made,
            failed: None,
        }
    }

    fn search(&mut self, control: &mut Control) -> End {
        let root = Node {
            bound: f64::NEG_INFINITY,
            depth: 0,
            number: self.note(None, None, f64::NEG_INFINITY),
            path: None,
            start: self.relaxation.start(),
            from: None,
        };
        self.open.push(root);
        if let (Some((v, _)), Some(r)) = (&self.best, self.records.first_mut()) {
            r.solution = Some(*v);
        }
        while let Some(node) = self.open.pop() {
            let cutoff = self.cutoff();
            if node.bound >= cutoff {
                self.open.push(node);
                break;
            }
            self.bound = self.bound.max(node.bound);
            self.log(control, false);
            if self.is_close() {
                self.open.push(node);
                return End::Gap;
            }
            if self.aim.nodes > 0 && self.nodes >= self.aim.nodes {
                self.open.push(node);
                return End::Nodes;
            }
            if let Some(end) = self.plunge(node, control) {
                return end;
            }
        }
        End::Complete
    }

    /// Whether solution and bound are as near as was asked for.
    fn is_close(&self) -> bool {
        let Some((v, _)) = &self.best else {
            return false;
        };
        let [gap, relative] = self.units.gap(*v, self.bound);
        let least = if self.relaxation.is_linear() {
            1e-9
        } else {
            1e-8
        };
        gap <= self.aim.absolute_gap.max(least) || relative <= self.aim.relative_gap
    }

    fn note(&mut self, parent: Option<u32>, change: Option<Change>, value: f64) -> u32 {
        if self.aim.record && self.records.len() < RECORDS {
            self.records.push(Record {
                parent,
                change,
                value,
                fate: "open",
                solution: None,
            });
        }
        self.made += 1;
        self.made - 1
    }

    fn fate(&mut self, number: u32, fate: &'static str) {
        if let Some(r) = self.records.get_mut(number as usize) {
            r.fate = fate;
        }
    }

    /// Bounds of a node. False: nothing is left of it.
    fn load(&mut self, path: &Option<Rc<Path>>) -> bool {
        self.lower.copy_from_slice(&self.root[0]);
        self.upper.copy_from_slice(&self.root[1]);
        self.propagator.at_root(self.mip);
        let mut steps = Vec::new();
        let mut next = path.as_ref();
        while let Some(p) = next {
            steps.push(p.clone());
            next = p.parent.as_ref();
        }
        let mut columns = Vec::new();
        for p in steps.iter().rev() {
            if !self.decide(&p.changes) {
                return false;
            }
            columns.extend(p.changes.iter().map(|c| c.column));
        }
        let fine = self.propagate(&columns);
        self.send_bounds();
        fine
    }

    /// Bounds of the present node, to come back to.
    pub(super) fn here(&self) -> Here {
        (
            self.lower.clone(),
            self.upper.clone(),
            self.propagator.length(),
        )
    }

    /// The bounds are those of the node again.
    pub(super) fn back_to(&mut self, (lower, upper, length): Here) {
        (self.lower, self.upper) = (lower, upper);
        self.propagator.back_to(length);
        self.send_bounds();
    }

    /// All bounds of the present node go to the relaxation.
    pub(super) fn send_bounds(&mut self) {
        for column in 0..self.lower.len() {
            let (lower, upper) = (self.lower[column], self.upper[column]);
            self.relaxation.set_bounds(Change {
                column,
                lower,
                upper,
            });
        }
    }

    /// Narrows bounds. False: nothing is left.
    fn decide(&mut self, changes: &[Change]) -> bool {
        self.propagator.next_level();
        changes.iter().all(|c| {
            let (l, u) = (&mut self.lower[c.column], &mut self.upper[c.column]);
            if c.lower > *l {
                *l = c.lower;
                self.propagator.decide(c.column, 0, c.lower);
            }
            if c.upper < *u {
                *u = c.upper;
                self.propagator.decide(c.column, 1, c.upper);
            }
            l <= u
        })
    }

    /// What follows from bounds of the present node that moved, and from the best solution's value. False: nothing is left.
    fn propagate(&mut self, columns: &[usize]) -> bool {
        if self.relaxation.is_linear() {
            self.propagator.limit(self.mip, self.cutoff());
        }
        let fine = self
            .propagator
            .run(self.mip, Some(columns), &mut self.lower, &mut self.upper);
        if !fine {
            let [lower, upper] = &self.root;
            self.propagator.learn_from_run(self.mip, [lower, upper]);
        }
        fine
    }

    /// Applies changes and what follows from them. False: nothing is left.
    pub(super) fn apply(&mut self, changes: &[Change]) -> bool {
        if !self.decide(changes) {
            return false;
        }
        let columns: Vec<usize> = changes.iter().map(|c| c.column).collect();
        let fine = self.propagate(&columns);
        for &column in columns.iter().chain(&self.propagator.moved) {
            let (lower, upper) = (self.lower[column], self.upper[column]);
            if lower <= upper {
                self.relaxation
                    .set_bounds(Change::new(column, lower, upper));
            }
        }
        fine
    }

    /// From a node down until nothing is left below it. Some: why the search must end.
    fn plunge(&mut self, mut node: Node<R::Start>, control: &mut Control) -> Option<End> {
        if !self.load(&node.path) {
            self.fate(node.number, "infeasible");
            return None;
        }
        self.relaxation.restart(&node.start);
        let deepest = node.depth + self.longest;
        loop {
            self.nodes += 1;
            self.at = node.number;
            let branch = match self.evaluate(&mut node, control) {
                Evaluated::Divided(branch) => branch,
                Evaluated::Leaf(fate) => {
                    self.fate(node.number, fate);
                    return None;
                }
                Evaluated::GivenUp => return None,
                Evaluated::Later => {
                    self.postpone(node);
                    return None;
                }
                Evaluated::Ended(end) => return self.put_back(node, end),
            };
            self.fate(node.number, "branched");
            node = self.descend(&node, branch)?;
            let least = self
                .open
                .peek()
                .map_or(node.bound, |n| n.bound.min(node.bound));
            self.bound = self.bound.max(least);
            self.log(control, false);
            if self.aim.nodes > 0 && self.nodes >= self.aim.nodes {
                return self.put_back(node, End::Nodes);
            }
            if self.is_close() {
                return self.put_back(node, End::Gap);
            }
            if node.depth > deepest {
                self.postpone(node);
                return None;
            }
        }
    }

    /// A node stays open, to be gone on with from here.
    fn postpone(&mut self, mut node: Node<R::Start>) {
        node.start = self.relaxation.start();
        self.open.push(node);
    }

    /// The search ends at a node that stays open.
    fn put_back(&mut self, node: Node<R::Start>, end: End) -> Option<End> {
        let least = self
            .open
            .peek()
            .map_or(node.bound, |n| n.bound.min(node.bound));
        self.bound = self.bound.max(least);
        self.postpone(node);
        Some(end)
    }

    /// Solves the relaxation under the present bounds; where these leave nothing below the cutoff, that is learned.
    pub(super) fn relax(&mut self, cutoff: f64, control: &mut Control) -> Solved {
        let solved = self.relaxation.solve(cutoff, control);
        let empty = match solved {
            Solved::Value(v) => v >= cutoff,
            Solved::Infeasible | Solved::Cutoff => true,
            _ => false,
        };
        if empty
            && self.propagator.learns()
            && let Some((terms, side)) = self.relaxation.sum(cutoff)
        {
            let [lower, upper] = &self.root;
            self.propagator
                .learn(self.mip, &terms, side, [lower, upper]);
        }
        solved
    }

    /// Solves the relaxation of a node, again where that tightens its bounds.
    fn evaluate(&mut self, node: &mut Node<R::Start>, control: &mut Control) -> Evaluated {
        let mut resolves = 0;
        loop {
            // Below an unbounded relaxation the basis is not dual feasible: its value on the way bounds nothing.
            let cutoff = match node.depth > 0 && !node.bound.is_finite() {
                true => f64::INFINITY,
                false => self.cutoff(),
            };
            let solved = self.relax(cutoff, control);
            let value = match solved {
                Solved::Value(v) => v,
                Solved::Cutoff => return Evaluated::Leaf("bound"),
                Solved::Infeasible => return Evaluated::Leaf("infeasible"),
                Solved::Unbounded(d) => return self.follow(node, &d, control),
                Solved::Stopped(why) => return Evaluated::Ended(End::Stopped(why)),
                // Nothing is known: what is below is looked at with the parent's bound, while there is something to branch on.
                Solved::Failed => node.bound,
            };
            let failed = solved == Solved::Failed;
            if let Some((j, side, far)) = node.from.take()
                && node.bound.is_finite()
                && !failed
                && resolves == 0
            {
                self.pseudo[j][side].add((value - node.bound).max(0.0) / far.max(1e-6));
            }
            node.bound = node.bound.max(value);
            if let Some(r) = self.records.get_mut(node.number as usize) {
                r.value = node.bound;
            }
            if node.bound >= self.cutoff() && !failed {
                return Evaluated::Leaf("bound");
            }
            if node.depth == 0 {
                self.bound = self.bound.max(node.bound);
            }
            if resolves < 5 && !failed {
                match self.fix_by_costs(value, node.depth == 0) {
                    Fixed::Nothing => {}
                    Fixed::Moved => {
                        resolves += 1;
                        continue;
                    }
                    Fixed::Empty => return Evaluated::Leaf("bound"),
                }
            }
            if failed {
                self.failures += 1;
                if self.failures > FAILURES {
                    self.incomplete = true;
                    return Evaluated::GivenUp;
                }
            }
            let point = self.relaxation.x().to_vec();
            let branch = match failed {
                false => self.branch(&point, value, control),
                true => self.split_widest(),
            };
            match branch {
                // One side is empty: the node goes on without it.
                Some(Branch::Fixed(changes)) => {
                    let changes = self.with_orbit(&changes, &node.path);
                    if !self.apply(&changes) {
                        return Evaluated::Leaf("infeasible");
                    }
                    let (pinned, parent) = (Vec::new(), node.path.take());
                    node.path = Some(Rc::new(Path {
                        changes,
                        pinned,
                        parent,
                    }));
                    resolves += 1;
                    // Without finite bounds this may go on for ever: the others have their turn.
                    if resolves > self.longest {
                        return Evaluated::Later;
                    }
                }
                None if failed => {
                    self.incomplete = true;
                    return Evaluated::Leaf("open");
                }
                Some(branch) => return self.divided(node, branch, &point, failed, control),
                None => {
                    return match self.split_integral(&point, node.bound, control) {
                        Ok(branch) => self.divided(node, branch, &point, failed, control),
                        Err(fate) => Evaluated::Leaf(fate),
                    };
                }
            }
        }
    }

    /// What to do where the relaxation is unbounded along a direction: an ordered set that forbids it is divided.
    fn follow(&mut self, node: &Node<R::Start>, d: &[f64], control: &mut Control) -> Evaluated {
        let far: Vec<f64> = self
            .relaxation
            .x()
            .iter()
            .zip(d)
            .map(|(x, d)| x.abs() + d.abs())
            .collect();
        match self.branch_on_set(&far, node.bound, 1, control) {
            Some(branch) => Evaluated::Divided(branch),
            None => Evaluated::Ended(End::Unbounded),
        }
    }

    /// What to do where nothing discrete is violated: the point is a solution, or integer to the tolerance only
    /// (rounded it is no solution, or one whose value is not the node's). Err: what became of the node.
    fn split_integral(
        &mut self,
        point: &[f64],
        bound: f64,
        control: &mut Control,
    ) -> Result<Branch, &'static str> {
        let offered = self.offer(point, control);
        let branch = match offered {
            true if bound < self.cutoff() => self.split_rounded(point).or_else(|| self.split_set()),
            true => None,
            false => self.split_widest(),
        };
        if branch.is_none() && !offered {
            self.incomplete |= self.cutoff() > bound;
        }
        branch.ok_or(if offered { "solution" } else { "infeasible" })
    }

    /// A node that is to be divided, unless what heuristics find makes that superfluous.
    fn divided(
        &mut self,
        node: &Node<R::Start>,
        branch: Branch,
        point: &[f64],
        failed: bool,
        control: &mut Control,
    ) -> Evaluated {
        if let Branch::Fixed(_) = branch {
            return Evaluated::Leaf("infeasible");
        }
        if !failed {
            self.heuristics(node.depth, point, control);
            if node.bound >= self.cutoff() {
                return Evaluated::Leaf("bound");
            }
        }
        Evaluated::Divided(branch)
    }

    /// Makes the children of a node and goes to one of them. None: neither has a point.
    fn descend(&mut self, node: &Node<R::Start>, branch: Branch) -> Option<Node<R::Start>> {
        let Branch::Two {
            sides,
            column,
            far,
            first,
        } = branch
        else {
            return None;
        };
        let sides = sides.map(|side| self.with_orbit(&side, &node.path));
        let start = self.relaxation.start();
        let before = self.here();
        let child = |s: &mut Self, side: usize| {
            let changes = sides[side].clone();
            Node {
                bound: node.bound,
                depth: node.depth + 1,
                number: s.note(Some(node.number), changes.first().copied(), node.bound),
                path: Some(Rc::new(Path {
                    pinned: s.pinned_by(&changes),
                    changes,
                    parent: node.path.clone(),
                })),
                start: start.clone(),
                from: column.map(|j| (j, side, far[side])),
            }
        };
        let (next, other) = (child(self, first), child(self, 1 - first));
        if self.apply(&sides[first]) {
            self.open.push(other);
            return Some(next);
        }
        self.fate(next.number, "infeasible");
        self.back_to(before);
        if self.apply(&sides[1 - first]) {
            return Some(other);
        }
        self.fate(other.number, "infeasible");
        None
    }

    /// The bounds of one side of a branch; where they make a binary column 0, its orbit is 0 as well: of solutions that
    /// permutations make of each other the other side has one.
    fn with_orbit(&self, changes: &[Change], path: &Option<Rc<Path>>) -> Vec<Change> {
        let (Some(symmetry), &[c]) = (self.symmetry, changes) else {
            return changes.to_vec();
        };
        if !symmetry.is_binary(c.column) || c.upper != 0.0 {
            return changes.to_vec();
        }
        let mut pinned = Vec::new();
        let mut next = path.as_ref();
        while let Some(p) = next {
            pinned.extend(&p.pinned);
            next = p.parent.as_ref();
        }
        let zero = |column| Change { column, ..c };
        let orbit = symmetry.orbit(c.column, &pinned).into_iter();
        orbit.map(zero).collect()
    }

    /// Columns that symmetries must not move below such a side of a branch: all but a binary one that is 0.
    fn pinned_by(&self, changes: &[Change]) -> Vec<usize> {
        let Some(symmetry) = self.symmetry else {
            return Vec::new();
        };
        let is_zero = |c: &Change| symmetry.is_binary(c.column) && c.upper == 0.0;
        match changes.iter().all(is_zero) {
            true => Vec::new(),
            false => changes.iter().map(|c| c.column).collect(),
        }
    }

    /// Integer columns whose reduced costs keep them from going far. What that does to the node.
    fn fix_by_costs(&mut self, value: f64, at_root: bool) -> Fixed {
        let room = self.cutoff() - value;
        if !room.is_finite() {
            return Fixed::Nothing;
        }
        let Some(reduced) = self.relaxation.reduced() else {
            return Fixed::Nothing;
        };
        let x = self.relaxation.x();
        let mut changes = Vec::new();
        for (j, &d) in reduced.iter().enumerate().filter(|e| self.mip.integer[e.0]) {
            let (l, u) = (self.lower[j], self.upper[j]);
            if d.abs() < 1e-7 || l == u || self.mip.threshold[j] > 0.0 {
                continue;
            }
            let far = (room / d.abs() + 1e-6).floor();
            if d > 0.0 && x[j] - l < 1e-9 && l + far < u {
                changes.push(Change {
                    column: j,
                    lower: l,
                    upper: l + far,
                });
            } else if d < 0.0 && u - x[j] < 1e-9 && u - far > l {
                changes.push(Change {
                    column: j,
                    lower: u - far,
                    upper: u,
                });
            }
        }
        if changes.is_empty() {
            return Fixed::Nothing;
        }
        let x = x.to_vec();
        if at_root {
            for c in &changes {
                self.root[0][c.column] = self.root[0][c.column].max(c.lower);
                self.root[1][c.column] = self.root[1][c.column].min(c.upper);
            }
        }
        if !self.apply(&changes) {
            return Fixed::Empty;
        }
        let outside = |j: &usize| x[*j] < self.lower[*j] - 1e-9 || x[*j] > self.upper[*j] + 1e-9;
        match self.propagator.moved.iter().any(outside) {
            true => Fixed::Moved,
            false => Fixed::Nothing,
        }
    }

    /// Takes a point as a solution if its integers, rounded, are one; the rest is solved for where need be.
    pub(super) fn offer(&mut self, x: &[f64], control: &mut Control) -> bool {
        let mut y = x.to_vec();
        for (j, y) in y.iter_mut().enumerate() {
            let t = self.mip.threshold[j];
            if self.mip.integer[j] {
                *y = y.round();
            } else if t > 0.0 && (self.upper[j] <= 0.0 || y.abs() <= INTEGRAL * t) {
                *y = 0.0;
            } else if t > 0.0 && (self.lower[j] >= t || *y >= t * (1.0 - INTEGRAL)) {
                *y = y.max(t);
            }
        }
        for set in &self.mip.sets {
            for j in self.mip.outside(set, x) {
                if y[j].abs() <= INTEGRAL {
                    y[j] = 0.0;
                }
            }
        }
        if !self.mip.is_discrete(&y) {
            return false;
        }
        if self.relaxation.is_linear() && self.mip.is_feasible(&y) {
            let value = self.mip.value(&y);
            self.take(value, y, control);
            return true;
        }
        let Some((value, y)) = self.complete(&y, control) else {
            return false;
        };
        self.take(value, y, control);
        true
    }

    /// The best point whose discrete columns are as in this one.
    fn complete(&mut self, y: &[f64], control: &mut Control) -> Option<(f64, Vec<f64>)> {
        let start = self.relaxation.start();
        for (column, &y) in y.iter().enumerate() {
            let t = self.mip.threshold[column];
            let (lower, upper) = match (self.mip.integer[column], t > 0.0) {
                (true, _) => (y, y),
                (false, true) if y == 0.0 => (0.0, 0.0),
                (false, true) => (self.lower[column].max(t), self.upper[column]),
                (false, false) => continue,
            };
            self.relaxation.set_bounds(Change {
                column,
                lower,
                upper,
            });
        }
        let mip = self.mip;
        for column in mip.sets.iter().flat_map(|s| mip.outside(s, y)) {
            self.relaxation.set_bounds(Change {
                column,
                lower: 0.0,
                upper: 0.0,
            });
        }
        let solved = self.relaxation.solve_decided(y, control);
        let found = match solved {
            Solved::Value(v) => Some((v, self.relaxation.x().to_vec())),
            _ => None,
        };
        self.send_bounds();
        self.relaxation.restart(&start);
        let (value, mut x) = found?;
        for (j, x) in x.iter_mut().enumerate().filter(|e| self.mip.integer[e.0]) {
            *x = y[j];
        }
        Some((value, x))
    }

    pub(super) fn take(&mut self, value: f64, x: Vec<f64>, control: &mut Control) {
        let asked = self
            .aim
            .cutoff
            .map_or(f64::INFINITY, |c| self.units.inner(c));
        if value <= asked && self.best.as_ref().is_none_or(|b| value < b.0) {
            self.best = Some((value, x));
            if let Some(r) = self.records.get_mut(self.at as usize) {
                r.solution = Some(value);
            }
            self.next_log = 0.0;
            self.log(control, false);
        }
    }

    /// A line of progress: now and then, and for every new solution.
    fn log(&mut self, control: &mut Control, last: bool) {
        let seconds = control.budget.seconds();
        if seconds < self.next_log && !last {
            return;
        }
        self.next_log = seconds + 2.0;
        // Where a node's value is no bound there is none.
        let bound = Some(self.bound).filter(|b| b.is_finite() && self.relaxation.is_exact());
        let best = self.best.as_ref().map(|b| b.0);
        let gap = best.zip(bound).map(|(v, b)| self.units.gap(v, b)[1]);
        let shown = |v: Option<f64>| v.map(|v| self.units.shown(v));
        let text = |v: Option<f64>| v.map_or("-".into(), |v| format!("{v:.10}"));
        let line = format!(
            "{} nodes, {} open, bound {}, solution {}, gap {}, {} iterations, {seconds:.1} s",
            self.nodes,
            self.open.len(),
            text(shown(bound)),
            text(shown(best)),
            gap.map_or("-".into(), |g| format!("{:.3} %", 100.0 * g)),
            control.iterations,
        );
        control.budget.log(&line);
        control.budget.progress(Progress {
            method: "branch and bound",
            iteration: self.nodes,
            objective: shown(best),
            gap,
            ..Progress::default()
        });
    }
}
