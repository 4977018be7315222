//! Linear programs with complementarity constraints, by branch and bound on the pieces.
//!
//! A node has chosen pieces for some pairs; the others are relaxed to their envelope. Its bound is
//! the value of that linear program, solved by the simplex method from the parent's basis; where the
//! solution satisfies all pairs the node is done, otherwise the pair that is farthest from all its
//! pieces is branched on. Nodes are taken in the order of their bounds, so at any time the least
//! bound of the open nodes and the best solution enclose the value.

use super::pairs::{Pair, Piece};
use crate::solve::lp::Ended;
use crate::solve::lp::form::Problem;
use crate::solve::lp::simplex::{Basis, Simplex};
use std::collections::BinaryHeap;
use std::rc::Rc;

/// A complementarity violation up to this is none.
const TOLERANCE: f64 = 1e-9;

/// A linear program with pairs; a pair's `column` and `row` are the program's.
pub(super) struct Lpcc<'a> {
    /// The linear program; the rows of pairs and their columns have bounds of their own.
    pub problem: &'a Problem,
    /// The pairs.
    pub pairs: &'a [Pair],
    /// Right-hand side of each pair's row: F is the row's activity minus this.
    pub rhs: &'a [f64],
}

/// Limits of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Nodes.
    pub nodes: usize,
    /// Only solutions with a value below this are of interest.
    pub cutoff: f64,
    /// A solution with a value below this ends the search.
    pub enough: f64,
    /// Nodes whose bound is within this of the best solution are not looked at.
    pub gap: f64,
}

/// Proves a bound of a node's linear program, for its multipliers: those of its solution, or (`true`) of its
/// infeasibility; +∞ says that it is empty, −∞ that nothing was proved.
pub(super) type Prover<'p> = &'p mut dyn FnMut(&Problem, &[f64], bool) -> f64;

/// What a search found.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// Value and point of the best solution below the cutoff.
    pub best: Option<(f64, Vec<f64>)>,
    /// No solution has a value below this (or the best solution's, if that is less).
    pub bound: f64,
    /// Nothing is left open: the best solution is a global one, or there is none below the cutoff.
    pub complete: bool,
    /// A branch is unbounded.
    pub unbounded: bool,
    /// Nodes solved.
    pub nodes: usize,
    /// Simplex iterations.
    pub iterations: u64,
}

impl Found {
    /// There is no solution at all, if the cutoff was +∞.
    pub(super) fn is_empty(&self) -> bool {
        self.complete && self.best.is_none() && self.bound == f64::INFINITY
    }
}

struct Node {
    bound: f64,
    depth: usize,
    number: usize,
    chosen: Rc<Chosen>,
    basis: Rc<Basis>,
}

/// Pieces chosen on the way to a node.
enum Chosen {
    None,
    Also(usize, Piece, Rc<Chosen>),
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Node {
    /// The heap's largest is the next: least bound, then deepest, then first made.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let bound = other.bound.total_cmp(&self.bound);
        let depth = self.depth.cmp(&other.depth);
        bound.then(depth).then(other.number.cmp(&self.number))
    }
}

impl Lpcc<'_> {
    /// Bounds of a pair's column and of its row's activity, on a piece or in the envelope.
    fn apply(&self, simplex: &mut Simplex, node: &mut Problem, k: usize, piece: Option<Piece>) {
        let pair = &self.pairs[k];
        let (column, row) = (pair.column, pair.row);
        let between = (self.problem.lower[column], self.problem.upper[column]);
        let [x, f] = pair.ranges(piece, between, self.rhs[k]);
        simplex.set_bounds(column, x.0, x.1);
        simplex.set_bounds(self.problem.n() + row, f.0, f.1);
        (node.lower[column], node.upper[column]) = x;
        (node.row_lower[row], node.row_upper[row]) = f;
    }

    /// Pair that is farthest from being satisfied, among those without a piece.
    fn worst(&self, x: &[f64], decided: &[bool]) -> Option<usize> {
        let mut worst: Option<(usize, f64)> = None;
        for (k, p) in self.pairs.iter().enumerate().filter(|(k, _)| !decided[*k]) {
            let f = self.problem.activity(p.row, x) - self.rhs[k];
            let v = p.natural(x[p.column], f);
            if v > TOLERANCE && worst.is_none_or(|w| v > w.1) {
                worst = Some((k, v));
            }
        }
        worst.map(|w| w.0)
    }

    fn objective(&self, x: &[f64]) -> f64 {
        let terms = x.iter().zip(&self.problem.cost).map(|(x, c)| x * c);
        terms.sum::<f64>() + self.problem.offset
    }

    /// One node for each piece that pair k may be on.
    fn children(
        &self,
        node: &Node,
        k: usize,
        bound: f64,
        basis: &Rc<Basis>,
        number: &mut usize,
    ) -> Vec<Node> {
        let pieces = [Piece::Inside, Piece::Lower, Piece::Upper];
        let allowed = pieces.into_iter().filter(|&p| self.pairs[k].allows(p));
        let child = |piece: Piece| {
            *number += 1;
            Node {
                bound,
                depth: node.depth + 1,
                number: *number - 1,
                chosen: Rc::new(Chosen::Also(k, piece, node.chosen.clone())),
                basis: basis.clone(),
            }
        };
        allowed.map(child).collect()
    }

    /// Puts the pieces that a node has chosen in place; which pairs have one.
    fn apply_all(&self, simplex: &mut Simplex, here: &mut Problem, chosen: &Chosen) -> Vec<bool> {
        let mut decided = vec![false; self.pairs.len()];
        (0..self.pairs.len()).for_each(|k| self.apply(simplex, here, k, None));
        let mut chosen = chosen;
        while let Chosen::Also(k, piece, rest) = chosen {
            self.apply(simplex, here, *k, Some(*piece));
            decided[*k] = true;
            chosen = rest;
        }
        decided
    }

    /// Searches. With a prover nothing counts as a bound, and no node as infeasible, but what it proves.
    pub(super) fn search(
        &self,
        limits: &Limits,
        mut prover: Option<Prover>,
        stop: &mut dyn FnMut(u64) -> Option<Ended>,
    ) -> Found {
        let mut simplex = Simplex::new(self.problem);
        let mut here = self.problem.clone();
        let mut out = Found {
            best: None,
            bound: f64::INFINITY,
            complete: true,
            unbounded: false,
            nodes: 0,
            iterations: 0,
        };
        let mut heap = BinaryHeap::from([Node {
            bound: f64::NEG_INFINITY,
            depth: 0,
            number: 0,
            chosen: Rc::new(Chosen::None),
            basis: Rc::new(simplex.basis()),
        }]);
        let mut number = 1;
        // Bounds of nodes that were given up.
        let mut lost = f64::INFINITY;
        let cutoff = |out: &Found| out.best.as_ref().map_or(limits.cutoff, |b| b.0);
        while let Some(node) = heap.pop() {
            if node.bound >= cutoff(&out) - limits.gap {
                heap.push(node);
                break;
            }
            if out.nodes >= limits.nodes || stop(simplex.iterations).is_some() {
                heap.push(node);
                out.complete = false;
                break;
            }
            out.nodes += 1;
            let decided = self.apply_all(&mut simplex, &mut here, &node.chosen);
            let ended = simplex.solve_from_basis(&node.basis, stop);
            let point = match ended {
                Ended::Solved => simplex.point(),
                Ended::Infeasible(y) => {
                    let proved = prover
                        .as_mut()
                        .map_or(f64::INFINITY, |p| p(&here, &y, true));
                    lost = lost.min(proved.max(node.bound));
                    continue;
                }
                Ended::Unbounded(_) => None,
                _ => {
                    out.complete = false;
                    lost = lost.min(node.bound);
                    continue;
                }
            };
            let (value, branch_on) = match &point {
                Some(p) => {
                    let reached = self.objective(&p.x);
                    let value = prover
                        .as_mut()
                        .map_or(reached, |prover| prover(&here, &p.y, false));
                    (value.max(node.bound), self.worst(&p.x, &decided))
                }
                // Unbounded so far: the pairs that are left may bound it.
                None => (f64::NEG_INFINITY, decided.iter().position(|d| !d)),
            };
            if value >= cutoff(&out) - limits.gap {
                lost = lost.min(value);
                continue;
            }
            let Some(k) = branch_on else {
                let Some(p) = point else {
                    (out.unbounded, out.complete) = (true, false);
                    lost = f64::NEG_INFINITY;
                    break;
                };
                if prover.is_some() {
                    lost = lost.min(value);
                }
                let reached = self.objective(&p.x);
                if reached < cutoff(&out) {
                    out.best = Some((reached, p.x));
                }
                if reached < limits.enough {
                    out.complete = false;
                    lost = lost.min(node.bound);
                    break;
                }
                continue;
            };
            let basis = Rc::new(simplex.basis());
            heap.extend(self.children(&node, k, value, &basis, &mut number));
        }
        let open = heap.iter().map(|n| n.bound).fold(lost, f64::min);
        out.bound = open.min(cutoff(&out));
        out.iterations = simplex.iterations;
        out
    }
}
