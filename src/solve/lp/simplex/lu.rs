//! Sparse LU factors of a basis, with Forrest–Tomlin updates (Suhl & Suhl 1990, 1993).
//!
//! Everything stands in the space of the rows: a pivot is called by its row, in which the slot of its column is solved for, so that
//! no permutation is applied between the steps of a solve. Pivots are those of few entries (Markowitz 1957) that are no smaller than a
//! tenth of the largest in their column. An update takes the pivot of the leaving column out of the order and puts it at the end.
//! Where a right-hand side has few entries, the rows that a triangle leads to are found first (Gilbert & Peierls 1988).

/// No row.
const NONE: u32 = u32::MAX;

/// A pivot against the largest entry of its column, at least.
const THRESHOLD: f64 = 0.1;

/// Columns and rows that are looked at for a pivot once there is one.
const SEARCH: usize = 8;

/// What a sparse solve leaves that is smaller is rounding.
const DROP: f64 = 1e-14;

/// An entry of the active matrix that is smaller is rounding.
const CANCELLED: f64 = 1e-16;

/// What rounding may take of the pivot of an update.
const LOST: f64 = 1e-11;

/// Lines of a sparse matrix that grow and shrink.
#[derive(Clone, Default)]
struct Lines {
    start: Vec<u32>,
    length: Vec<u32>,
    room: Vec<u32>,
    index: Vec<u32>,
    value: Vec<f64>,
}

impl Lines {
    /// Empty lines with room for so many entries each.
    fn with_room(room: Vec<u32>) -> Self {
        let mut start = Vec::with_capacity(room.len());
        let mut total = 0;
        for &r in &room {
            start.push(total);
            total += r;
        }
        Self {
            start,
            length: vec![0; room.len()],
            room,
            index: vec![0; total as usize],
            value: vec![0.0; total as usize],
        }
    }

    fn range(&self, k: usize) -> std::ops::Range<usize> {
        let start = self.start[k] as usize;
        start..start + self.length[k] as usize
    }

    fn indices(&self, k: usize) -> &[u32] {
        &self.index[self.range(k)]
    }

    #[inline]
    fn line(&self, k: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let r = self.range(k);
        let index = self.index[r.clone()].iter().map(|&i| i as usize);
        index.zip(self.value[r].iter().copied())
    }

    fn push(&mut self, k: usize, i: u32, v: f64) {
        if self.length[k] == self.room[k] {
            let old = self.range(k);
            self.start[k] = self.index.len() as u32;
            self.room[k] = 2 * self.room[k] + 4;
            let end = self.index.len() + self.room[k] as usize;
            self.index.extend_from_within(old.clone());
            self.value.extend_from_within(old);
            self.index.resize(end, 0);
            self.value.resize(end, 0.0);
        }
        let end = self.range(k).end;
        (self.index[end], self.value[end]) = (i, v);
        self.length[k] += 1;
    }

    /// Takes an entry out; its value, if it was there.
    fn remove(&mut self, k: usize, i: u32) -> Option<f64> {
        let at = self.start[k] as usize + self.indices(k).iter().position(|&x| x == i)?;
        let value = self.value[at];
        self.remove_at(k, at);
        Some(value)
    }

    fn remove_at(&mut self, k: usize, at: usize) {
        let last = self.range(k).end - 1;
        self.index[at] = self.index[last];
        self.value[at] = self.value[last];
        self.length[k] -= 1;
    }

    /// The same matrix the other way.
    fn transposed(&self) -> Self {
        let mut room = vec![0; self.start.len()];
        for k in 0..self.start.len() {
            self.indices(k).iter().for_each(|&i| room[i as usize] += 1);
        }
        let mut out = Self::with_room(room);
        for k in 0..self.start.len() {
            for (i, v) in self.line(k) {
                out.push(i, k as u32, v);
            }
        }
        out
    }
}

/// Lines of the active matrix by their number of entries.
struct Counts {
    first: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
}

impl Counts {
    fn new(lengths: &[u32]) -> Self {
        let m = lengths.len();
        let mut counts = Self {
            first: vec![NONE; m + 1],
            next: vec![NONE; m],
            previous: vec![NONE; m],
        };
        (0..m)
            .rev()
            .for_each(|k| counts.link(k, lengths[k] as usize));
        counts
    }

    fn link(&mut self, k: usize, count: usize) {
        let after = std::mem::replace(&mut self.first[count], k as u32);
        (self.next[k], self.previous[k]) = (after, NONE);
        if after != NONE {
            self.previous[after as usize] = k as u32;
        }
    }

    fn unlink(&mut self, k: usize, count: usize) {
        let (before, after) = (self.previous[k], self.next[k]);
        match before {
            NONE => self.first[count] = after,
            b => self.next[b as usize] = after,
        }
        if after != NONE {
            self.previous[after as usize] = before;
        }
    }

    fn of(&self, count: usize) -> impl Iterator<Item = usize> + '_ {
        let some = |k: u32| (k != NONE).then_some(k as usize);
        std::iter::successors(some(self.first[count]), move |&k| some(self.next[k]))
    }
}

/// The matrix while pivots are taken out of it.
struct Active {
    columns: Lines,
    /// Where the rows have entries.
    rows: Lines,
    by_column: Counts,
    by_row: Counts,
    /// Largest entry of each column; negative where it is not known.
    largest: Vec<f64>,
    /// A smaller entry is no pivot.
    zero: f64,
    /// Multipliers of the pivot at hand, 0 between pivots.
    multiplier: Vec<f64>,
    met: Vec<bool>,
}

impl Active {
    fn largest(&mut self, j: usize) -> f64 {
        if self.largest[j] < 0.0 {
            let values = &self.columns.value[self.columns.range(j)];
            self.largest[j] = values.iter().fold(0.0, |t, v| t.max(v.abs()));
        }
        self.largest[j]
    }

    /// Takes a column without a pivot out.
    fn give_up(&mut self, j: usize) {
        self.by_column.unlink(j, self.columns.length[j] as usize);
        for k in self.columns.range(j) {
            let i = self.columns.index[k] as usize;
            self.by_row.unlink(i, self.rows.length[i] as usize);
            self.rows.remove(i, j as u32);
            self.by_row.link(i, self.rows.length[i] as usize);
        }
        self.columns.length[j] = 0;
    }

    /// The next pivot: row and column.
    fn search(&mut self) -> Option<(usize, usize)> {
        let mut best: Option<(usize, f64, usize, usize)> = None;
        let mut looked = 0;
        let consider = |best: &mut Option<_>, cost: usize, v: f64, i: usize, j: usize| {
            let better = |&(c, size, _, _): &(usize, f64, usize, usize)| {
                cost < c || cost == c && v.abs() > size
            };
            if best.as_ref().is_none_or(better) {
                *best = Some((cost, v.abs(), i, j));
            }
        };
        for count in 1..self.by_column.first.len() {
            let mut next = self.by_column.first[count];
            while next != NONE {
                let j = next as usize;
                next = self.by_column.next[j];
                let largest = self.largest(j);
                if largest <= self.zero {
                    self.give_up(j);
                    continue;
                }
                for (i, v) in self.columns.line(j) {
                    if v.abs() >= THRESHOLD * largest {
                        let cost = (self.rows.length[i] as usize - 1) * (count - 1);
                        consider(&mut best, cost, v, i, j);
                    }
                }
                looked += 1;
                let cheap = best.is_some_and(|b| b.0 <= (count - 1) * (count - 1));
                if cheap || best.is_some() && looked >= SEARCH {
                    return best.map(|b| (b.2, b.3));
                }
            }
            let rows: [Option<usize>; SEARCH] = {
                let mut of = self.by_row.of(count);
                std::array::from_fn(|_| of.next())
            };
            for i in rows.into_iter().flatten() {
                for k in self.rows.range(i) {
                    let j = self.rows.index[k] as usize;
                    let cost = (count - 1) * (self.columns.length[j] as usize - 1);
                    if best.is_some_and(|b| b.0 < cost) {
                        continue;
                    }
                    let largest = self.largest(j);
                    let v = self.columns.line(j).find(|e| e.0 == i).map_or(0.0, |e| e.1);
                    if largest > self.zero && v.abs() >= THRESHOLD * largest {
                        consider(&mut best, cost, v, i, j);
                    }
                }
                looked += 1;
                let cheap = best.is_some_and(|b| b.0 <= count * (count - 1));
                if cheap || best.is_some() && looked >= SEARCH {
                    return best.map(|b| (b.2, b.3));
                }
            }
        }
        best.map(|b| (b.2, b.3))
    }

    /// Takes a pivot out; its row goes to U and its column to L. Returns the pivot.
    fn eliminate(&mut self, p: usize, q: usize, lower: &mut Lines, upper: &mut Lines) -> f64 {
        self.by_row.unlink(p, self.rows.length[p] as usize);
        self.by_column.unlink(q, self.columns.length[q] as usize);
        let pivot = self.columns.remove(q, p as u32).unwrap_or(0.0);
        let multipliers: Vec<(u32, f64)> = self
            .columns
            .line(q)
            .map(|(i, v)| (i as u32, v / pivot))
            .collect();
        self.columns.length[q] = 0;
        lower.start[p] = lower.index.len() as u32;
        for &(i, l) in &multipliers {
            self.by_row
                .unlink(i as usize, self.rows.length[i as usize] as usize);
            self.rows.remove(i as usize, q as u32);
            self.multiplier[i as usize] = l;
            lower.index.push(i);
            lower.value.push(l);
        }
        lower.length[p] = multipliers.len() as u32;
        upper.start[p] = upper.index.len() as u32;
        for k in self.rows.range(p) {
            let j = self.rows.index[k] as usize;
            if j == q {
                continue;
            }
            let before = self.columns.length[j] as usize;
            let Some(u) = self.columns.remove(j, p as u32) else {
                continue;
            };
            upper.index.push(j as u32);
            upper.value.push(u);
            if !multipliers.is_empty() {
                self.subtract(j, u, &multipliers);
            }
            self.largest[j] = -1.0;
            self.by_column.unlink(j, before);
            self.by_column.link(j, self.columns.length[j] as usize);
        }
        upper.length[p] = upper.index.len() as u32 - upper.start[p];
        self.rows.length[p] = 0;
        for &(i, _) in &multipliers {
            self.multiplier[i as usize] = 0.0;
            self.by_row
                .link(i as usize, self.rows.length[i as usize] as usize);
        }
        pivot
    }

    /// Takes u times the multipliers off a column.
    fn subtract(&mut self, j: usize, u: f64, multipliers: &[(u32, f64)]) {
        let mut k = self.columns.start[j] as usize;
        let mut met = 0;
        while k < self.columns.range(j).end {
            let i = self.columns.index[k] as usize;
            let l = self.multiplier[i];
            if l != 0.0 {
                self.met[i] = true;
                met += 1;
                let v = self.columns.value[k] - l * u;
                if v.abs() <= CANCELLED {
                    self.columns.remove_at(j, k);
                    self.rows.remove(i, j as u32);
                    continue;
                }
                self.columns.value[k] = v;
            }
            k += 1;
        }
        for &(i, l) in multipliers {
            if met > 0 && std::mem::take(&mut self.met[i as usize]) {
                continue;
            }
            self.columns.push(j, i, -l * u);
            self.rows.push(i as usize, j as u32, 0.0);
        }
    }
}

/// A vector, most of whose entries may be 0.
#[derive(Clone, Default)]
struct Spread {
    value: Vec<f64>,
    /// Where it may not be 0, unless it is full. A row may be named twice.
    list: Vec<u32>,
    full: bool,
}

impl Spread {
    #[inline]
    fn add(&mut self, i: usize, v: f64) {
        if self.value[i] == 0.0 && !self.full {
            self.list.push(i as u32);
        }
        self.value[i] += v;
    }

    /// The entries that are not 0.
    fn entries(&mut self) -> Vec<(u32, f64)> {
        let full = self.full;
        let mut out = Vec::new();
        self.drain(|i, v| out.push((i as u32, v)));
        self.full = full;
        for &(i, v) in &out {
            self.value[i as usize] = v;
            self.list.push(i);
        }
        out
    }

    /// Hands the entries out and leaves 0.
    fn drain(&mut self, mut to: impl FnMut(usize, f64)) {
        let all = 0..if self.full { self.value.len() } else { 0 };
        let listed = self
            .list
            .iter()
            .take(if self.full { 0 } else { usize::MAX });
        for i in all.chain(listed.map(|&i| i as usize)) {
            let v = std::mem::take(&mut self.value[i]);
            if v != 0.0 {
                to(i, v);
            }
        }
        self.list.clear();
        self.full = false;
    }
}

/// What the search for the rows of a sparse solve needs.
#[derive(Clone, Default)]
struct Reach {
    marked: Vec<bool>,
    stack: Vec<(u32, u32)>,
    /// The rows, those that others lead to first.
    found: Vec<u32>,
    /// Solves of each kind that are full without a search, for the last one led to many rows.
    full: [u8; 6],
}

/// Solves without a search after one that led to many rows.
const FULL: u8 = 10;

impl Reach {
    /// The rows to which the entries lead, unless they are more than a tenth.
    fn find(&mut self, kind: usize, lines: &Lines, from: &[u32]) -> bool {
        let most = self.marked.len() / 10;
        if self.full[kind] > 0 || from.len() > most {
            self.full[kind] = self.full[kind].saturating_sub(1);
            return false;
        }
        self.found.clear();
        let mut few = true;
        for &start in from {
            if std::mem::replace(&mut self.marked[start as usize], true) {
                continue;
            }
            self.stack.push((start, 0));
            while let Some((k, next)) = self.stack.last_mut() {
                let line = lines.indices(*k as usize);
                let rest = &line[*next as usize..];
                match rest.iter().position(|&i| !self.marked[i as usize]) {
                    Some(at) => {
                        *next += at as u32 + 1;
                        let i = rest[at];
                        self.marked[i as usize] = true;
                        self.stack.push((i, 0));
                    }
                    None => {
                        self.found.push(*k);
                        self.stack.pop();
                    }
                }
            }
            if self.found.len() > most {
                few = false;
                self.full[kind] = FULL;
                break;
            }
        }
        self.found
            .iter()
            .for_each(|&k| self.marked[k as usize] = false);
        few
    }
}

/// Solves with a triangle: a row's value, over its pivot if there are pivots, times its line is taken off other rows. `order` has
/// all rows whose line is not empty or that have a pivot, those that lead to others first.
fn triangle<'a>(
    lines: &Lines,
    pivots: Option<&[f64]>,
    order: impl Iterator<Item = &'a u32>,
    drop: f64,
    (reach, kind): (&mut Reach, usize),
    w: &mut Spread,
) {
    let (start, length) = (&lines.start[..], &lines.length[..]);
    let (index, entry) = (&lines.index[..], &lines.value[..]);
    let step = |value: &mut [f64], p: usize| {
        let mut x = value[p];
        if x.abs() <= drop {
            value[p] = 0.0;
            return;
        }
        if let Some(pivots) = pivots {
            x /= pivots[p];
            value[p] = x;
        }
        let range = start[p] as usize..(start[p] + length[p]) as usize;
        for (&i, &v) in index[range.clone()].iter().zip(&entry[range]) {
            value[i as usize] -= v * x;
        }
    };
    if !w.full && reach.find(kind, lines, &w.list) {
        w.list.clear();
        w.list.extend(reach.found.iter().rev());
        w.list.iter().for_each(|&p| step(&mut w.value, p as usize));
    } else {
        w.full = true;
        let pivots = order.filter(|&&p| p != NONE);
        pivots.for_each(|&p| step(&mut w.value, p as usize));
    }
}

/// The factors.
#[derive(Clone)]
pub(super) struct Lu {
    /// L by columns and by rows, without the diagonal.
    lower: Lines,
    lower_rows: Lines,
    /// The rows of L's columns and rows, those that lead to others first.
    lower_order: Vec<u32>,
    lower_rows_order: Vec<u32>,
    /// U by columns and by rows, without the diagonal; columns are called by their pivots.
    upper: Lines,
    upper_rows: Lines,
    pivot: Vec<f64>,
    /// The rows in the order of U; [`NONE`] where a pivot was.
    order: Vec<u32>,
    place: Vec<u32>,
    row_of_slot: Vec<u32>,
    slot_of_row: Vec<u32>,
    /// Rows that updates have eliminated, in their order, and what they took of other rows.
    eliminated: Vec<u32>,
    multipliers: Lines,
    nonzeros: usize,
    work: Spread,
    reach: Reach,
    /// The last entering column, and what L made of it.
    entering: Vec<(usize, f64)>,
    spike: Vec<(u32, f64)>,
    /// The last row of U's inverse and its pivot.
    row: (u32, Vec<(u32, f64)>),
}

/// Why there are no factors.
pub(super) enum Broken {
    /// These slots have no pivots; these rows are left, one for each.
    Dependent(Vec<(usize, usize)>),
    Numbers,
}

impl Lu {
    /// Factors of the matrix with these columns; entries smaller than `zero` times the largest are no pivots.
    pub(super) fn new(m: usize, columns: &[Vec<(usize, f64)>], zero: f64) -> Result<Self, Broken> {
        let mut lengths = vec![0u32; m];
        let mut most = 0.0f64;
        for &(i, v) in columns.iter().flatten() {
            if !v.is_finite() {
                return Err(Broken::Numbers);
            }
            most = most.max(v.abs());
            lengths[i] += u32::from(v != 0.0);
        }
        let filled = |c: &Vec<(usize, f64)>| c.iter().filter(|e| e.1 != 0.0).count() as u32;
        let mut active = Active {
            columns: Lines::with_room(columns.iter().map(filled).collect()),
            rows: Lines::with_room(lengths.clone()),
            by_row: Counts::new(&lengths),
            by_column: Counts::new(&columns.iter().map(filled).collect::<Vec<u32>>()),
            largest: vec![-1.0; m],
            zero: zero * most,
            multiplier: vec![0.0; m],
            met: vec![false; m],
        };
        for (j, column) in columns.iter().enumerate() {
            for &(i, v) in column.iter().filter(|e| e.1 != 0.0) {
                active.columns.push(j, i as u32, v);
                active.rows.push(i, j as u32, 0.0);
            }
        }
        let (mut lower, mut upper) = (Lines::with_room(vec![0; m]), Lines::with_room(vec![0; m]));
        let mut row_of_slot = vec![NONE; m];
        let mut slot_of_row = vec![NONE; m];
        let mut pivot = vec![0.0; m];
        let mut order = Vec::with_capacity(m + 200);
        while let Some((p, q)) = active.search() {
            pivot[p] = active.eliminate(p, q, &mut lower, &mut upper);
            (row_of_slot[q], slot_of_row[p]) = (p as u32, q as u32);
            order.push(p as u32);
        }
        if order.len() < m {
            let left = |of: &[u32]| -> Vec<usize> { (0..m).filter(|&k| of[k] == NONE).collect() };
            let (slots, rows) = (left(&row_of_slot), left(&slot_of_row));
            return Err(Broken::Dependent(slots.into_iter().zip(rows).collect()));
        }
        lower.room.clone_from(&lower.length);
        upper.room.clone_from(&upper.length);
        upper
            .index
            .iter_mut()
            .for_each(|j| *j = row_of_slot[*j as usize]);
        let mut place = vec![0; m];
        (order.iter().enumerate()).for_each(|(k, &p): (usize, &u32)| place[p as usize] = k as u32);
        let lower_rows = lower.transposed();
        let filled = |lines: &Lines, p: &u32| lines.length[*p as usize] > 0;
        let down = order.iter().filter(|p| filled(&lower, p));
        let up = order.iter().rev().filter(|p| filled(&lower_rows, p));
        Ok(Self {
            nonzeros: m + lower.index.len() + upper.index.len(),
            lower_order: down.copied().collect(),
            lower_rows_order: up.copied().collect(),
            lower_rows,
            upper: upper.transposed(),
            upper_rows: upper,
            lower,
            pivot,
            order,
            place,
            row_of_slot,
            slot_of_row,
            eliminated: Vec::new(),
            multipliers: Lines::default(),
            work: Spread {
                value: vec![0.0; m],
                ..Spread::default()
            },
            reach: Reach {
                marked: vec![false; m],
                ..Reach::default()
            },
            entering: Vec::new(),
            spike: Vec::new(),
            row: (NONE, Vec::new()),
        })
    }

    pub(super) fn updates(&self) -> usize {
        self.eliminated.len()
    }

    pub(super) fn nonzeros(&self) -> usize {
        self.nonzeros
    }

    /// L and the updates; `kind` as in [`Reach`].
    fn forward_lower(&mut self, kind: usize, drop: f64) {
        let w = &mut self.work;
        let (order, reach) = (self.lower_order.iter(), (&mut self.reach, kind));
        triangle(&self.lower, None, order, drop, reach, w);
        for (k, &p) in self.eliminated.iter().enumerate() {
            let sum: f64 = self.multipliers.line(k).map(|(i, v)| v * w.value[i]).sum();
            if sum != 0.0 {
                w.add(p as usize, -sum);
            }
        }
    }

    fn forward_upper(&mut self, kind: usize, drop: f64) {
        let order = self.order.iter().rev();
        let (pivots, reach) = (Some(&self.pivot[..]), (&mut self.reach, kind));
        triangle(&self.upper, pivots, order, drop, reach, &mut self.work);
    }

    fn backward_upper(&mut self, drop: f64) {
        let (pivots, reach) = (Some(&self.pivot[..]), (&mut self.reach, 4));
        let order = self.order.iter();
        triangle(&self.upper_rows, pivots, order, drop, reach, &mut self.work);
    }

    /// The updates and L.
    fn backward_lower(&mut self, drop: f64) {
        let w = &mut self.work;
        for (k, &p) in self.eliminated.iter().enumerate().rev() {
            let x = w.value[p as usize];
            if x != 0.0 {
                self.multipliers.line(k).for_each(|(i, v)| w.add(i, -v * x));
            }
        }
        let order = self.lower_rows_order.iter();
        triangle(&self.lower_rows, None, order, drop, (&mut self.reach, 5), w);
    }

    /// Solves B x = a; with `enters`, `a` may become a column of the basis next. False: numbers broke down.
    pub(super) fn forward(
        &mut self,
        a: &[(usize, f64)],
        enters: bool,
        x: &mut Vec<(usize, f64)>,
    ) -> bool {
        a.iter().for_each(|&(i, v)| self.work.add(i, v));
        let kind = 2 * usize::from(enters);
        self.forward_lower(kind, DROP);
        if enters {
            self.entering.clear();
            self.entering.extend_from_slice(a);
            self.spike = self.work.entries();
        }
        self.forward_upper(kind + 1, DROP);
        x.clear();
        let slots = &self.slot_of_row;
        let mut good = true;
        self.work.drain(|i, v| {
            good &= v.is_finite();
            x.push((slots[i] as usize, v));
        });
        good
    }

    /// Solves Bᵀ y = a. False: numbers broke down.
    pub(super) fn backward(&mut self, a: &[(usize, f64)], y: &mut Vec<(usize, f64)>) -> bool {
        let row = |k: usize| self.row_of_slot[k] as usize;
        a.iter().for_each(|&(k, v)| self.work.add(row(k), v));
        self.backward_upper(DROP);
        if let &[(k, 1.0)] = a {
            self.row = (self.row_of_slot[k], self.work.entries());
        }
        self.backward_lower(DROP);
        y.clear();
        let mut good = true;
        self.work.drain(|i, v| {
            good &= v.is_finite();
            y.push((i, v));
        });
        good
    }

    /// Solves B x = a in place.
    pub(super) fn forward_dense(&mut self, a: &mut [f64]) {
        self.work.full = true;
        self.work.value.copy_from_slice(a);
        self.forward_lower(0, 0.0);
        self.forward_upper(1, 0.0);
        a.fill(0.0);
        let slots = &self.slot_of_row;
        self.work.drain(|i, v| a[slots[i] as usize] = v);
    }

    /// Solves Bᵀ y = a in place.
    pub(super) fn backward_dense(&mut self, a: &mut [f64]) {
        self.work.full = true;
        for (&p, &v) in self.row_of_slot.iter().zip(a.iter()) {
            self.work.value[p as usize] = v;
        }
        self.backward_upper(0.0);
        self.backward_lower(0.0);
        a.fill(0.0);
        self.work.drain(|i, v| a[i] = v);
    }

    /// Replaces the column in a slot. False: it is not done, for the pivot would be noise.
    pub(super) fn replace(&mut self, slot: usize, column: &[(usize, f64)]) -> bool {
        let p = self.row_of_slot[slot];
        if self.entering != column {
            column.iter().for_each(|&(i, v)| self.work.add(i, v));
            self.forward_lower(2, DROP);
            self.spike = self.work.entries();
            self.work.drain(|_, _| {});
        }
        if self.row.0 != p {
            self.work.add(p as usize, 1.0);
            self.backward_upper(DROP);
            self.row.1 = self.work.entries();
            self.work.drain(|_, _| {});
        }
        let (spike, row) = (
            std::mem::take(&mut self.spike),
            std::mem::take(&mut self.row.1),
        );
        self.entering.clear();
        self.row.0 = NONE;
        // The row without the others: its entry in the new column is the new pivot.
        let old = self.pivot[p as usize];
        let value = &mut self.work.value;
        spike.iter().for_each(|&(i, v)| value[i as usize] = v);
        let (mut pivot, mut size) = (value[p as usize], value[p as usize].abs());
        for &(i, z) in row.iter().filter(|e| e.0 != p) {
            let part = z * old * value[i as usize];
            pivot += part;
            size += part.abs();
        }
        spike.iter().for_each(|&(i, _)| value[i as usize] = 0.0);
        if !pivot.is_finite() || pivot.abs() <= LOST * size {
            return false;
        }
        self.put(p, pivot, &spike);
        let multipliers = &mut self.multipliers;
        multipliers.start.push(multipliers.index.len() as u32);
        for &(i, z) in row.iter().filter(|e| e.0 != p) {
            multipliers.index.push(i);
            multipliers.value.push(-z * old);
        }
        multipliers
            .length
            .push(multipliers.index.len() as u32 - multipliers.start[self.eliminated.len()]);
        self.nonzeros += row.len();
        self.eliminated.push(p);
        true
    }

    /// Puts a column and its pivot at the end of U, in place of the column and the row of this pivot.
    fn put(&mut self, p: u32, pivot: f64, column: &[(u32, f64)]) {
        let k = p as usize;
        let gone = self.upper.length[k] + self.upper_rows.length[k];
        for at in self.upper_rows.range(k) {
            let j = self.upper_rows.index[at] as usize;
            self.upper.remove(j, p);
        }
        for at in self.upper.range(k) {
            let i = self.upper.index[at] as usize;
            self.upper_rows.remove(i, p);
        }
        (self.upper.length[k], self.upper_rows.length[k]) = (0, 0);
        for &(i, v) in column.iter().filter(|e| e.0 != p) {
            self.upper.push(k, i, v);
            self.upper_rows.push(i as usize, p, v);
        }
        self.nonzeros += self.upper.length[k] as usize;
        self.nonzeros -= gone as usize;
        self.pivot[k] = pivot;
        self.order[self.place[k] as usize] = NONE;
        self.place[k] = self.order.len() as u32;
        self.order.push(p);
    }
}

#[cfg(test)]
mod tests {
    use super::super::jitter;
    use super::*;

    const M: usize = 60;

    /// A sparse column that makes the matrix regular, with a slot's own entry the largest.
    fn column(slot: usize, salt: usize) -> Vec<(usize, f64)> {
        let at = |k: usize| 7 * slot + 13 * k + 31 * salt;
        let mut entries = vec![(slot, 4.0 + jitter(at(9)))];
        for k in 0..4 {
            let i = (jitter(at(k)) * 1e6) as usize % M;
            if entries.iter().all(|e| e.0 != i) {
                entries.push((i, 2.0 * jitter(at(k + 20)) - 1.5));
            }
        }
        entries
    }

    /// Largest residual of B x = a and of Bᵀ y = a for sparse and full right-hand sides.
    fn residual(lu: &mut Lu, columns: &[Vec<(usize, f64)>]) -> f64 {
        let mut worst = 0.0f64;
        for k in [0, 17, 42] {
            let a = vec![(k, 1.0), ((k + 5) % M, -2.0)];
            let (mut x, mut full) = (Vec::new(), vec![0.0; M]);
            a.iter().for_each(|&(i, v)| full[i] = v);
            let mut transposed = full.clone();
            assert!(lu.forward(&a, false, &mut x));
            let mut rest = full.clone();
            for (slot, v) in x {
                columns[slot].iter().for_each(|&(i, b)| rest[i] -= v * b);
            }
            worst = rest.iter().fold(worst, |t, r| t.max(r.abs()));
            let mut rest = full.clone();
            lu.forward_dense(&mut full);
            for (slot, v) in full.into_iter().enumerate() {
                columns[slot].iter().for_each(|&(i, b)| rest[i] -= v * b);
            }
            worst = rest.iter().fold(worst, |t, r| t.max(r.abs()));
            let mut y = Vec::new();
            assert!(lu.backward(&a, &mut y));
            let mut sparse = vec![0.0; M];
            y.iter().for_each(|&(i, v)| sparse[i] = v);
            let given = transposed.clone();
            lu.backward_dense(&mut transposed);
            for y in [sparse, transposed] {
                for (slot, column) in columns.iter().enumerate() {
                    let product: f64 = column.iter().map(|&(i, b)| b * y[i]).sum();
                    worst = worst.max((product - given[slot]).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn solves_after_each_update() {
        let mut columns: Vec<_> = (0..M).map(|k| column(k, 0)).collect();
        let Ok(mut lu) = Lu::new(M, &columns, 1e-11) else {
            panic!("regular");
        };
        assert!(residual(&mut lu, &columns) < 1e-12);
        for step in 0..90 {
            let slot = 11 * step % M;
            columns[slot] = column(slot, step + 1);
            // With what earlier solves have kept, and without.
            let mut kept = Vec::new();
            if step % 3 > 0 {
                assert!(lu.forward(&columns[slot], true, &mut kept));
            }
            if step % 2 > 0 {
                assert!(lu.backward(&[(slot, 1.0)], &mut kept));
            }
            assert!(lu.replace(slot, &columns[slot]));
            assert_eq!(lu.updates(), step + 1);
            assert!(residual(&mut lu, &columns) < 1e-10, "{step}");
        }
    }

    #[test]
    fn names_what_is_dependent() {
        let mut columns: Vec<_> = (0..M).map(|k| column(k, 0)).collect();
        columns[20] = columns[3].clone();
        columns[30].clear();
        let Err(Broken::Dependent(left)) = Lu::new(M, &columns, 1e-11) else {
            panic!("singular");
        };
        let slots: Vec<usize> = left.iter().map(|l| l.0).collect();
        assert!(slots == [3, 30] || slots == [20, 30], "{slots:?}");
        for (slot, row) in left {
            columns[slot] = vec![(row, 1.0)];
        }
        assert!(Lu::new(M, &columns, 1e-11).is_ok());
        columns[5][0].1 = f64::NAN;
        assert!(matches!(Lu::new(M, &columns, 1e-11), Err(Broken::Numbers)));
    }

    #[test]
    fn refuses_a_pivot_that_is_noise() {
        let columns: Vec<_> = (0..M).map(|k| column(k, 0)).collect();
        let Ok(mut lu) = Lu::new(M, &columns, 1e-11) else {
            panic!("regular");
        };
        // The column is in the basis already.
        assert!(!lu.replace(8, &columns[9]));
        assert!(residual(&mut lu, &columns) < 1e-12);
    }
}
