//! Permutations of columns that leave a program as it is, and what branching may leave out because of them.
//!
//! Vehicles, machines or bins that are alike make many solutions of one. Where a binary column is branched on, its orbit is
//! where permutations take it that move nothing the node has been branched up on: on the side where the column is 0 all of
//! its orbit may be 0, for a solution with another of them at 1 has its like on the other side (orbital branching,
//! Ostrowski, Linderoth, Rossi & Smriglio 2011).
//!
//! Permutations are found by refining colours: a column's colour is a hash of its data and of the colours beside it. Two
//! columns of one colour are marked, one in each of two copies, which are refined until colours say what goes where. A
//! hash may err: what it says is checked against the rows.

use super::model::Mip;
use std::collections::HashMap;

/// Entries of rows that the search may look at, besides this many times all entries.
const WORK: u64 = 10_000_000;
const WORK_PER_ENTRY: u64 = 20;

/// Columns of one colour that a column is paired with, at most, and failures in a row after which no more are.
const PARTNERS: usize = 40;
const FAILURES: usize = 3;

/// Permutations that are kept, at most.
const MOST: usize = 500;

/// A row as a permutation sees it: sides, and entries in order.
type Shape = ([u64; 2], Vec<(u32, u64)>);

/// What a permutation moves and where to, in order.
type Moves = Vec<(u32, u32)>;

/// Permutations of the columns of a program.
pub(super) struct Symmetry {
    moves: Vec<Moves>,
    binary: Vec<bool>,
}

impl Symmetry {
    /// Those of a program that are found with moderate effort; None: none that moves a binary column.
    pub(super) fn find(mip: &Mip) -> Option<Self> {
        if !mip.sets.is_empty() || !mip.held.is_empty() {
            return None;
        }
        let p = &mip.problem;
        let is_binary = |j| mip.is_binary(j, &p.lower, &p.upper);
        let binary: Vec<bool> = (0..p.n()).map(is_binary).collect();
        let mut finder = Finder {
            mip,
            sides: (0..p.m())
                .map(|i| mix(p.row_lower[i].to_bits(), p.row_upper[i].to_bits()))
                .collect(),
            left: WORK + WORK_PER_ENTRY * p.rows.value.len() as u64,
        };
        let moves = finder.search(&binary);
        (!moves.is_empty()).then_some(Self { moves, binary })
    }

    /// Whether the column is one whose orbit counts.
    pub(super) fn is_binary(&self, column: usize) -> bool {
        self.binary[column]
    }

    /// How many permutations there are.
    pub(super) fn count(&self) -> usize {
        self.moves.len()
    }

    /// Where permutations that move none of these columns take one, itself first.
    pub(super) fn orbit(&self, column: usize, pinned: &[usize]) -> Vec<usize> {
        let moved = |moves: &[(u32, u32)], j: usize| {
            let found = moves.binary_search_by_key(&(j as u32), |e| e.0);
            found.ok().map(|k| moves[k].1 as usize)
        };
        let free = |m: &&Moves| pinned.iter().all(|&j| moved(m, j).is_none());
        let usable: Vec<_> = self.moves.iter().filter(free).collect();
        let mut orbit = vec![column];
        let mut next = 0;
        while next < orbit.len() {
            for moves in &usable {
                if let Some(k) = moved(moves, orbit[next])
                    && !orbit.contains(&k)
                {
                    orbit.push(k);
                }
            }
            next += 1;
        }
        orbit
    }
}

/// Mixes two numbers into one that says little of either.
fn mix(a: u64, b: u64) -> u64 {
    let mut x = a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ b.rotate_left(29);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// What a marked column's colour is mixed with.
const MARK: u64 = 0x6d61_726b;

struct Finder<'a> {
    mip: &'a Mip,
    /// By row: a hash of its sides.
    sides: Vec<u64>,
    /// Entries that may still be looked at.
    left: u64,
}

impl Finder<'_> {
    fn search(&mut self, binary: &[bool]) -> Vec<Moves> {
        let p = &self.mip.problem;
        let data = |j: usize| {
            let priority = self.mip.priority.get(j).map_or(0, |v| v.to_bits());
            let bounds = mix(p.lower[j].to_bits(), p.upper[j].to_bits());
            let kind = mix(
                u64::from(self.mip.integer[j]),
                self.mip.threshold[j].to_bits(),
            );
            mix(mix(p.cost[j].to_bits(), priority), mix(bounds, kind))
        };
        let mut colors: Vec<u64> = (0..p.n()).map(data).collect();
        self.refine(&mut colors);
        let mut all = Vec::new();
        let mut first = 0;
        while first < binary.len() && self.left > 0 && all.len() < MOST {
            let alike = |k: &usize| colors[*k] == colors[first];
            let partners: Vec<usize> = match binary[first] {
                true => (first + 1..binary.len()).filter(alike).collect(),
                false => Vec::new(),
            };
            let mut failures = 0;
            for &partner in partners.iter().take(PARTNERS) {
                match self.exchange(&colors, first, partner) {
                    Some(moves) => {
                        all.push(moves);
                        failures = 0;
                    }
                    None => failures += 1,
                }
                if failures >= FAILURES || self.left == 0 {
                    break;
                }
            }
            // What comes is to leave this column where it is.
            if !partners.is_empty() {
                colors[first] = mix(colors[first], MARK);
                self.refine(&mut colors);
            }
            first += 1;
        }
        all
    }

    /// Colours mixed with those of the columns in the same rows.
    fn round(&mut self, colors: &[u64]) -> Vec<u64> {
        let p = &self.mip.problem;
        self.left = self.left.saturating_sub(2 * p.rows.value.len() as u64 + 1);
        let sum = |entries: &mut dyn Iterator<Item = (usize, f64)>, of: &[u64]| {
            let add = |s: u64, (k, a): (usize, f64)| s.wrapping_add(mix(of[k], a.to_bits()));
            entries.fold(0u64, add)
        };
        let rows: Vec<u64> = (0..p.m())
            .map(|i| mix(self.sides[i], sum(&mut p.rows.line(i), colors)))
            .collect();
        (0..p.n())
            .map(|j| mix(colors[j], sum(&mut p.columns.line(j), &rows)))
            .collect()
    }

    /// Until no more columns differ.
    fn refine(&mut self, colors: &mut Vec<u64>) {
        let mut count = 0;
        loop {
            let next = self.round(colors);
            let more = distinct(&sorted(&next));
            *colors = next;
            if more == count || self.left == 0 {
                return;
            }
            count = more;
        }
    }

    /// A permutation that takes one column to another of its colour.
    fn exchange(&mut self, colors: &[u64], from: usize, to: usize) -> Option<Moves> {
        let mut sides = [colors.to_vec(), colors.to_vec()];
        let mut pair = (from, to);
        for _ in 0..4 {
            sides[0][pair.0] = mix(sides[0][pair.0], MARK);
            sides[1][pair.1] = mix(sides[1][pair.1], MARK);
            let mut count = 0;
            loop {
                sides = [self.round(&sides[0]), self.round(&sides[1])];
                let order = [sorted(&sides[0]), sorted(&sides[1])];
                if order[0] != order[1] || self.left == 0 {
                    return None;
                }
                let more = distinct(&order[0]);
                if more == count {
                    break;
                }
                count = more;
            }
            let (moves, open) = pairing(&sides);
            if self.is_symmetry(&moves) {
                return Some(moves);
            }
            pair = open?;
        }
        None
    }

    /// Whether rows become rows where columns are moved so.
    fn is_symmetry(&mut self, moves: &[(u32, u32)]) -> bool {
        let p = &self.mip.problem;
        let same = |a: usize, b: usize| {
            let of = |j: usize| {
                let priority = self.mip.priority.get(j).copied();
                let data = [p.cost[j], p.lower[j], p.upper[j], self.mip.threshold[j]];
                (data.map(f64::to_bits), self.mip.integer[j], priority)
            };
            of(a) == of(b)
        };
        if !moves.iter().all(|&(a, b)| same(a as usize, b as usize)) {
            return false;
        }
        let mut rows: Vec<usize> = moves
            .iter()
            .flat_map(|m| p.columns.line(m.0 as usize).map(|e| e.0))
            .collect();
        rows.sort_unstable();
        rows.dedup();
        let image = |j: usize| {
            let found = moves.binary_search_by_key(&(j as u32), |m| m.0);
            found.map_or(j as u32, |k| moves[k].1)
        };
        let mut counts: HashMap<Shape, i32> = HashMap::new();
        for &i in &rows {
            let sides = [p.row_lower[i].to_bits(), p.row_upper[i].to_bits()];
            let before = p.rows.line(i).map(|(j, a)| (j as u32, a.to_bits()));
            let mut after: Vec<_> = p
                .rows
                .line(i)
                .map(|(j, a)| (image(j), a.to_bits()))
                .collect();
            after.sort_unstable();
            self.left = self.left.saturating_sub(2 * after.len() as u64);
            *counts.entry((sides, before.collect())).or_default() += 1;
            *counts.entry((sides, after)).or_default() -= 1;
        }
        counts.values().all(|c| *c == 0)
    }
}

/// What goes where, by colours on either side: what has its colour on both stays; and two columns that are to be marked
/// should that be wrong.
fn pairing(sides: &[Vec<u64>; 2]) -> (Moves, Option<(usize, usize)>) {
    let differ = |j: &usize| sides[0][*j] != sides[1][*j];
    let order = |side: usize| {
        let mut columns: Vec<usize> = (0..sides[0].len()).filter(differ).collect();
        columns.sort_by_key(|&j| (sides[side][j], j));
        columns
    };
    let pairs: Vec<(usize, usize)> = order(0).into_iter().zip(order(1)).collect();
    let of = |k: usize| sides[0][pairs[k].0];
    let open = (1..pairs.len()).find(|&k| of(k) == of(k - 1));
    let mut moves: Moves = pairs.iter().map(|&(a, b)| (a as u32, b as u32)).collect();
    moves.sort_unstable();
    (moves, open.map(|k| pairs[k]))
}

fn sorted(colors: &[u64]) -> Vec<u64> {
    let mut colors = colors.to_vec();
    colors.sort_unstable();
    colors
}

fn distinct(sorted: &[u64]) -> usize {
    1 + sorted.windows(2).filter(|w| w[0] != w[1]).count()
}
