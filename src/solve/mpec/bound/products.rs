//! Products of the two sides: a lower bound that knows what every solution must obey together.
//!
//! Let the program come apart ([`super::sides`]), and let a = (x, 1) and b = (z, 1) be a solution. The product of a
//! valid equation or inequality of A with one of B holds for it, and so does that of an equation with any column of the other
//! side (the first level of the reformulation–linearisation technique of Sherali & Adams, between the sides only):
//!
//! ```text
//!     t_kl = (G_A a)_k (G_B b)_l ≥ 0,  = 0 for a pair;     (E_A a) b_jᵀ = 0,   a_i (E_B b)ᵀ = 0 .
//! ```
//!
//! Multipliers Λ of the first, not negative but for pairs, and any U, V of the others prove a bound of the objective c·a:
//! with D = c e_1ᵀ − G_Aᵀ Λ G_B − E_Aᵀ U − V E_B, where e_1 is the column 1 of B,
//!
//! ```text
//!     c·a = Σ λ_kl t_kl + aᵀ D b ≥ aᵀ D b ,     which is D_11 if D is 0 elsewhere.
//! ```
//!
//! The pairs, the only thing that is not linear, have become equations. Identities that follow from the equations of both
//! sides are contained: in limit analysis, xᵀ(compatibility) − uᵀ(equilibrium) is the work equation
//! α = −f_Dᵀu + Σ tan φ nᵢ|γᵢ|.
//!
//! **How the multipliers are found.** U and V make D vanish elsewhere if and only if Λ's part in R_A ⊗ R_B is that of the
//! objective, where R_A holds the slacks G_A a that E_A a = 0 allows. So only Λ is looked for ([`super::cone`]): the linear
//! program of the products, a hundred thousand columns of it for walls of some thirty blocks, is never written down.
//!
//! **How they become a proof.** D is computed in interval arithmetic; it is not quite 0, and Λ not quite positive.
//!
//! * *Room*: H with G_Aᵀ H G_B + … = 0 but for −κ at (1, 1), as many entries positive as can be, proves Σ h_kl t_kl ≤ κ. What
//!   Λ lacks in sign a multiple of H mends. Products that H has no room in can be large without end; Λ is 0 there.
//! * *Sizes*: x is bounded by linear programs ([`weak::derive`]), |x_i| ≤ X_i. From t_1l = (G_B b)_l the room has bounds of
//!   those columns of B that are bounded by themselves; the equations of B bound others by them ([`Sides::spread`]).
//!   Then |aᵀDb| ≤ Σ |D_ij| X_i Z_j.
//!
//! **Why the sizes are a proof** although D·Z enters into Z: let Z_j be twice what H promises and a little more, and let a
//! solution have N = max |z_j| / Z_j > 1. H proves |z_j| ≤ R_j + N ε_j for it, where R_j + ε_j ≤ ¾ Z_j has been computed with
//! directed rounding. Hence |z_j| ≤ ¾ N Z_j for all of them, and N ≤ ¾ N: a contradiction. So N ≤ 1.

use faer::linalg::solvers::Svd;
use faer::{Mat, Scale};

use super::super::pairs::Program;
use super::cone::{Search, Space};
use super::sides::{Factor, Half, Sides};
use super::weak;
use crate::solve::Budget;
use crate::solve::interval::{Interval, WideSum};
use crate::solve::lp::Ended;
use crate::solve::lp::form::Problem;
use crate::solve::lp::simplex::Simplex;

/// The state of a proof.
pub(super) struct Products<'a, 'm> {
    /// What it may spend.
    pub budget: &'a Budget<'m>,
}

/// What is tried at most.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    /// Products of an inequality of each side.
    pub products: usize,
    /// Steps of the search for multipliers.
    pub steps: usize,
}

/// Steps after which the room is tried first, and how often that number is doubled at most.
const ROOM: (usize, u32) = (500, 5);

/// What a unit of κ costs beside a unit of room.
const PRICE: f64 = 1e-2;

/// Length of a step in the search for room.
const STRIDE: f64 = 10.0;

/// Part of the products that may turn out to have too little room when the multipliers are made right.
const UNSETTLED: f64 = 0.002;

/// How often what has too little room is left out.
const ROUNDS: usize = 8;

/// Room that counts, of at most 1.
const LEAST: f64 = 0.05;

/// Steps between looks at the multipliers, at first.
const LOOK: usize = 500;

/// Distance at which the search has come to its end.
const FOUND: f64 = 1e-12;

impl Products<'_, '_> {
    /// The bound, −∞ if none is proved. `level` is the best solution known, `cutoff` a little above its
    /// value. The columns of side A in `whole`, the program without its pairs, get the bounds that solutions not above the
    /// cutoff have.
    pub(super) fn bound(
        &mut self,
        program: &Program,
        whole: &mut Problem,
        cutoff: f64,
        level: &[f64],
        limits: Limits,
    ) -> f64 {
        let best = program.objective(level);
        let none = f64::NEG_INFINITY;
        let Some(sides) = Sides::new(program, cutoff) else {
            return none;
        };
        let mut first = sides.first();
        let known = sides.pick(true, level);
        let derived = self.watched(|stop| weak::derive(&mut first, cutoff, &known, stop));
        self.budget.spend(derived);
        for (k, &j) in sides.columns(true).iter().enumerate() {
            whole.lower[j] = whole.lower[j].max(first.lower[k]);
            whole.upper[j] = whole.upper[j].min(first.upper[k]);
        }
        let mut simplex = Simplex::new(&first);
        let solved = self.watched(|stop| simplex.solve(stop)) == Ended::Solved;
        self.budget.spend(simplex.iterations);
        let y = simplex.point().filter(|_| solved);
        let low = y.map_or(none, |p| {
            weak::bound(&first, &first.cost, &p.y) + first.offset
        });
        self.log(&format!("side A alone {low}"));
        let bounds = first.lower.iter().zip(&first.upper);
        let sizes: Vec<f64> = bounds.map(|(l, u)| l.abs().max(u.abs())).collect();
        let count = sides.a.inequalities.len() * sides.b.inequalities.len();
        if count > limits.products || sizes.iter().any(|x| x.is_infinite()) {
            return low;
        }
        let mut levels = [known, sides.pick(false, level)];
        levels.iter_mut().for_each(|l| l.push(1.0));
        let proof = Proof::new(&sides, sizes, levels);
        let lifted = proof.and_then(|p| self.lifted(&p, best, limits));
        lifted.map_or(low, |v| v.max(low))
    }

    /// What the products prove.
    fn lifted(&mut self, proof: &Proof, goal: f64, limits: Limits) -> Option<f64> {
        let room = self.room(proof)?;
        let objective = [proof.sides.objective(), Factor::one()];
        let mut search = Search::new(&proof.space, proof.part(&objective));
        let mut best = f64::NEG_INFINITY;
        let (mut made, mut distance) = (0, f64::INFINITY);
        loop {
            let steps = LOOK.max(made / 4).min(limits.steps - made);
            let over = self.steps(&mut search, steps, |i, y| match room.kinds[i] {
                Kind::Constant => y + 1.0,
                Kind::Free => y,
                Kind::Zero => 0.0,
                Kind::Signed => y.max(0.0),
            });
            made += steps;
            let last = over || made >= limits.steps || search.distance < FOUND;
            // To make multipliers right takes as long as some hundred steps.
            if !last && search.distance > 0.5 * distance {
                continue;
            }
            distance = search.distance;
            let low = self.watched(|stop| {
                proof.bound(&objective, &search.y, &room, &mut || stop(0).is_some())
            });
            self.log(&format!(
                "{made} steps, {distance:.1e} apart, bound {:.9}, proved {low:.9}",
                constant(&search.y),
            ));
            best = best.max(low);
            if last || super::is_closed(best, goal) {
                return Some(best);
            }
        }
    }

    /// Room, and the sizes of side B's columns that it proves.
    fn room(&mut self, proof: &Proof) -> Option<Room> {
        let target = Mat::zeros(proof.space.p.ncols(), proof.space.q.ncols());
        let mut search = Search::new(&proof.space, target);
        for k in 0..=ROOM.1 {
            let steps = if k == 0 { ROOM.0 } else { ROOM.0 << (k - 1) };
            let over = self.steps(&mut search, steps, |i, y| match proof.kinds[i] {
                Kind::Constant => y + STRIDE * PRICE,
                Kind::Signed if y < 1.0 => (y + STRIDE).clamp(0.0, 1.0),
                _ => y,
            });
            if over {
                return None;
            }
            let (room, without) = self.watched(|stop| {
                Room::new(proof, &search.y, k == ROOM.1, &mut || stop(0).is_some())
            });
            self.log(&format!(
                "no room in {without} of {}, {:.1e} in all",
                proof.kinds.len(),
                -constant(&search.y),
            ));
            if room.is_some() {
                return room;
            }
        }
        self.log("no room was found");
        None
    }

    /// Makes steps; whether a limit was reached.
    fn steps(
        &mut self,
        search: &mut Search,
        steps: usize,
        nearest: impl Fn(usize, f64) -> f64,
    ) -> bool {
        for k in 0..steps {
            let over = k % 16 == 0 && self.watched(|stop| stop(0)).is_some();
            if over {
                return true;
            }
            search.step(&nearest);
        }
        false
    }

    fn log(&mut self, what: &str) {
        self.budget.log_timed(&format!("products: {what}"));
    }

    /// Runs with the limits.
    fn watched<T>(&mut self, run: impl FnOnce(&mut dyn FnMut(u64) -> Option<Ended>) -> T) -> T {
        run(&mut super::watch(self.budget, u64::MAX))
    }
}

/// The product 1 · 1.
fn constant(y: &Mat<f64>) -> f64 {
    y[(y.nrows() - 1, y.ncols() - 1)]
}

/// What the multiplier of a product may be.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Not negative.
    Signed,
    /// Anything: that of a pair, which is 0.
    Free,
    /// There is no room.
    Zero,
    /// That of 1 · 1: the bound.
    Constant,
}

/// H, scaled.
struct Room {
    high: Mat<f64>,
    /// By columns.
    kinds: Vec<Kind>,
    /// Z, and 1.
    sizes: Vec<f64>,
}

impl Room {
    /// From multipliers that are nearly such, and in how many there is none. None: they are not near enough, which does not
    /// matter if they are the `last`, or do not bound all columns of B.
    fn new(
        proof: &Proof,
        near: &Mat<f64>,
        last: bool,
        stop: &mut dyn FnMut() -> bool,
    ) -> (Option<Self>, usize) {
        let mut kinds = proof.kinds.clone();
        let rows = near.nrows();
        let mut high = near.clone();
        let mut weight = Mat::<f64>::from_fn(near.nrows(), near.ncols(), |_, _| 1.0);
        let target = Mat::zeros(proof.space.p.ncols(), proof.space.q.ncols());
        let mut without = 0;
        for round in 0..=ROUNDS {
            let mut small = 0;
            for (i, kind) in kinds.iter_mut().enumerate() {
                let (k, l) = (i % rows, i / rows);
                if *kind == Kind::Signed && high[(k, l)] < LEAST {
                    *kind = Kind::Zero;
                    (high[(k, l)], weight[(k, l)]) = (0.0, 0.0);
                    small += 1;
                }
            }
            without += small;
            if small == 0 {
                break;
            }
            let settled = round == 0 || last || (small as f64) < UNSETTLED * kinds.len() as f64;
            if round == ROUNDS || !settled {
                return (None, without);
            }
            high = proof.space.corrected(&high, &target, &weight, stop);
        }
        let mut out = Self {
            high,
            kinds,
            sizes: Vec::new(),
        };
        match proof.sizes(&out, stop) {
            Some(sizes) => {
                out.sizes = sizes;
                (Some(out), without)
            }
            None => (None, without),
        }
    }
}

/// One side in matrices.
struct Basis {
    /// What each inequality is multiplied by.
    scale: Vec<f64>,
    /// Pseudo-inverse of the equations.
    inverse: Mat<f64>,
    /// Orthonormal basis of the scaled slacks.
    slacks: Mat<f64>,
    /// Linear forms of the columns in that basis.
    forms: Mat<f64>,
}

impl Basis {
    /// `level` is a solution, whose slacks are to have this `size`.
    fn new(half: &Half, level: &[f64], size: f64) -> Option<Self> {
        let n = half.count + 1;
        let dense = |list: &[Factor]| {
            let mut out = Mat::<f64>::zeros(list.len(), n);
            for (k, f) in list.iter().enumerate() {
                f.all(half.count).for_each(|(j, v)| out[(k, j)] += v);
            }
            out
        };
        let equations = dense(&half.equations);
        let (rank, inverse, null) = match half.equations.is_empty() {
            true => (0, Mat::zeros(n, 0), Mat::identity(n, n)),
            false => {
                let svd = equations.svd().ok()?;
                let (rank, shrunk) = shrunk(&svd);
                let inverse = shrunk * svd.U().subcols(0, rank).transpose();
                (rank, inverse, svd.V().to_owned())
            }
        };
        let value = |f: &Factor| -> f64 { f.all(half.count).map(|(j, v)| v * level[j]).sum() };
        let last = half.inequalities.len() - 1;
        let used: Vec<f64> = half.inequalities[..last].iter().map(value).collect();
        let used: Vec<f64> = used.into_iter().filter(|v| *v > USED).collect();
        let mean = used.iter().sum::<f64>() / used.len().max(1) as f64;
        let mut scale = vec![if mean > 0.0 { size / mean } else { 1.0 }; last];
        scale.push(1.0);
        let null = null.subcols(rank, n - rank);
        let mut slacks = dense(&half.inequalities) * null;
        for l in 0..slacks.ncols() {
            let column = slacks.col_as_slice_mut(l).iter_mut();
            column.zip(&scale).for_each(|(v, s)| *v *= s);
        }
        let svd = slacks.thin_svd().ok()?;
        let (rank, shrunk) = shrunk(&svd);
        Some(Self {
            scale,
            inverse,
            slacks: svd.U().subcols(0, rank).to_owned(),
            forms: shrunk.transpose() * null.transpose(),
        })
    }
}

/// The rank, and V over S up to it.
fn shrunk(svd: &Svd<f64>) -> (usize, Mat<f64>) {
    let s: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let rank = s.iter().filter(|v| **v > RANK * s[0]).count();
    let mut shrunk = svd.V().subcols(0, rank).to_owned();
    for (k, s) in s[..rank].iter().enumerate() {
        shrunk.col_as_slice_mut(k).iter_mut().for_each(|v| *v /= s);
    }
    (rank, shrunk)
}

/// Mean of the slacks that are not 0, of either side, beside the column 1: the search takes several times as many steps
/// where they are three times as large or small.
const SIZE: [f64; 2] = [0.5, 0.15];

/// Singular values below this, relative to the largest, are 0.
const RANK: f64 = 1e-10;

/// Slacks above this are not 0.
const USED: f64 = 1e-6;

/// A linear form of side A times one of side B.
type Form = [Factor; 2];

/// What is known before multipliers are.
struct Proof<'s> {
    sides: &'s Sides,
    space: Space,
    scale: [Vec<f64>; 2],
    inverse: [Mat<f64>; 2],
    forms: [Mat<f64>; 2],
    /// X, and 1.
    sizes: Vec<f64>,
    /// Of the products, by columns.
    kinds: Vec<Kind>,
}

impl<'s> Proof<'s> {
    fn new(sides: &'s Sides, mut sizes: Vec<f64>, levels: [Vec<f64>; 2]) -> Option<Self> {
        let [a, b] = [
            Basis::new(&sides.a, &levels[0], SIZE[0])?,
            Basis::new(&sides.b, &levels[1], SIZE[1])?,
        ];
        sizes.push(1.0);
        let rows = a.scale.len();
        let mut kinds = vec![Kind::Signed; rows * b.scale.len()];
        sides
            .pairs()
            .for_each(|(k, l)| kinds[l * rows + k] = Kind::Free);
        *kinds.last_mut()? = Kind::Constant;
        Some(Self {
            sides,
            space: Space {
                p: a.slacks,
                q: b.slacks,
            },
            scale: [a.scale, b.scale],
            inverse: [a.inverse, b.inverse],
            forms: [a.forms, b.forms],
            sizes,
            kinds,
        })
    }

    /// A product's part in the space.
    fn part(&self, of: &Form) -> Mat<f64> {
        let side = |which: usize, f: &Factor| {
            let forms = &self.forms[which];
            let mut out = Mat::<f64>::zeros(forms.nrows(), 1);
            for (j, v) in f.all(forms.ncols() - 1) {
                out += Scale(v) * forms.subcols(j, 1);
            }
            out
        };
        side(0, &of[0]) * side(1, &of[1]).transpose()
    }

    /// Multipliers made right from some that are nearly, or from none: they prove what is of this part.
    fn mended(
        &self,
        near: &Mat<f64>,
        part: &Mat<f64>,
        room: &Room,
        stop: &mut dyn FnMut() -> bool,
    ) -> Mat<f64> {
        let rows = near.nrows();
        let mut weight = room.high.clone();
        for (i, kind) in room.kinds.iter().enumerate() {
            let (k, l) = (i % rows, i / rows);
            weight[(k, l)] = match kind {
                Kind::Free | Kind::Constant => 1.0,
                _ => room.high[(k, l)].min(1.0),
            };
        }
        self.space.corrected(near, part, &weight, stop)
    }

    /// With as much of the room as their signs lack.
    fn signed(&self, mut y: Mat<f64>, room: &Room) -> Mat<f64> {
        let rows = y.nrows();
        let mut lack = 0.0f64;
        for (i, kind) in room.kinds.iter().enumerate() {
            if *kind == Kind::Signed {
                let (k, l) = (i % rows, i / rows);
                lack = lack.max(-y[(k, l)] / room.high[(k, l)]);
            }
        }
        y += Scale(lack * 1.001) * &room.high;
        y
    }

    /// What multipliers prove of the objective.
    fn bound(
        &self,
        form: &Form,
        near: &Mat<f64>,
        room: &Room,
        stop: &mut dyn FnMut() -> bool,
    ) -> f64 {
        let y = self.mended(near, &self.part(form), room, stop);
        self.proved(form, &self.signed(y, room), &room.sizes)
    }

    /// Sizes of side B's columns, and 1; None where not all are proved before `stop` says so.
    fn sizes(&self, room: &Room, stop: &mut dyn FnMut() -> bool) -> Option<Vec<f64>> {
        let b = &self.sides.b;
        let last = self.space.p.nrows() - 1;
        // |z_j| ≤ (most / h + |constant|) / |v| from inequality l with a single column, and the column 1 of A.
        let reach = |l: usize, most: f64| match b.inequalities[l].terms[..] {
            [(j, v)] if room.kinds[l * (last + 1) + last] == Kind::Signed => {
                let h = room.high[(last, l)] * self.scale[1][l];
                let constant = b.inequalities[l].constant.abs();
                Some((j, 1.000_001 * (most / h + constant) / v.abs()))
            }
            _ => None,
        };
        let promised = -constant(&room.high);
        let mut sizes = vec![f64::INFINITY; b.count];
        let mut by = vec![usize::MAX; b.count];
        for l in 0..b.inequalities.len() {
            if let Some((j, reach)) = reach(l, promised)
                && 2.0 * reach + 1.0 < sizes[j]
            {
                (sizes[j], by[j]) = (2.0 * reach + 1.0, l);
            }
        }
        self.sides.spread(&mut sizes);
        // Other columns by multipliers of their own, for either sign.
        let nothing = Mat::zeros(last + 1, self.space.q.nrows());
        let mut tried: Vec<(usize, Mat<f64>)> = Vec::new();
        for j in 0..b.count {
            if stop() {
                return None;
            }
            if sizes[j].is_infinite() && b.opposite[j].is_none() {
                let part = self.part(&[Factor::one(), Factor::column(j)]);
                let y = self.mended(&nothing, &part, room, stop);
                let ends = [1.0, -1.0].map(|s| constant(&self.signed(Scale(s) * &y, room)).abs());
                sizes[j] = 2.0 * ends[0].max(ends[1]) + 1.0;
                tried.push((j, y));
                self.sides.spread(&mut sizes);
            }
        }
        if sizes.iter().any(|r| r.is_infinite()) {
            return None;
        }
        sizes.push(1.0);
        let low = self.proved(&[Factor::default(), Factor::default()], &room.high, &sizes);
        let mut used = by.iter().filter(|l| **l != usize::MAX);
        let holds = |&l: &usize| reach(l, -low).is_some_and(|(j, r)| r <= 0.75 * sizes[j]);
        let stands = |(j, y): &(usize, Mat<f64>)| {
            [1.0, -1.0].iter().all(|&s| {
                let form = [Factor::one(), Factor::column(*j).times(s)];
                let low = self.proved(&form, &self.signed(Scale(s) * y, room), &sizes);
                low >= -0.75 * sizes[*j]
            })
        };
        (used.all(holds) && tried.iter().all(stands)).then_some(sizes)
    }

    /// A lower bound of a product of linear forms, by scaled multipliers of the products, where the columns of B have these
    /// sizes. What should not be negative is taken for 0 where it is.
    fn proved(&self, form: &Form, y: &Mat<f64>, sizes: &[f64]) -> f64 {
        let (m, n) = (self.sizes.len(), sizes.len());
        let rows = y.nrows();
        let used = Mat::from_fn(rows, y.ncols(), |k, l| {
            let v = y[(k, l)] * self.scale[0][k] * self.scale[1][l];
            match self.kinds[l * rows + k] {
                Kind::Free | Kind::Constant => v,
                _ => v.max(0.0),
            }
        });
        let mut u = Mat::zeros(self.sides.a.equations.len(), n);
        let mut v = Mat::zeros(m, self.sides.b.equations.len());
        let mut rest = self.rest(form, &used, &u, &v);
        for _ in 0..REFINED {
            let mut d = Mat::from_fn(m, n, |i, j| rest[i * n + j].middle());
            let more = self.inverse[0].transpose() * &d;
            for (e, f) in self.sides.a.equations.iter().enumerate() {
                for (i, a) in f.all(m - 1) {
                    (0..n).for_each(|j| d[(i, j)] -= a * more[(e, j)]);
                }
            }
            u += more;
            v += d * &self.inverse[1];
            rest = self.rest(form, &used, &u, &v);
        }
        let mut loss = Interval::default();
        for (i, line) in rest.chunks(n).enumerate() {
            for (d, size) in line.iter().zip(sizes) {
                loss = loss + Interval::point(d.magnitude()) * self.sizes[i] * *size;
            }
        }
        let low = (Interval::point(constant(&used)) - loss).low;
        if low.is_nan() { f64::NEG_INFINITY } else { low }
    }

    /// D, by rows.
    fn rest(&self, form: &Form, y: &Mat<f64>, u: &Mat<f64>, v: &Mat<f64>) -> Vec<Interval> {
        let (a, b) = (&self.sides.a, &self.sides.b);
        let (m, n) = (a.count + 1, b.count + 1);
        let mut sums = vec![WideSum::default(); m * n];
        for (i, s) in form[0].all(m - 1) {
            form[1]
                .all(n - 1)
                .for_each(|(j, t)| sums[i * n + j].add_product(s, t));
        }
        for (l, g) in b.inequalities.iter().enumerate() {
            for (k, f) in a.inequalities.iter().enumerate() {
                let price = -y[(k, l)];
                for (i, s) in f.all(m - 1).filter(|_| price != 0.0) {
                    for (j, t) in g.all(n - 1) {
                        let sum = &mut sums[i * n + j];
                        match t.abs() == 1.0 {
                            true => sum.add_product(price * t, s),
                            false => sum.add_interval(Interval::point(price) * s * t),
                        }
                    }
                }
            }
        }
        for (e, f) in a.equations.iter().enumerate() {
            for (i, s) in f.all(m - 1) {
                (0..n).for_each(|j| sums[i * n + j].add_product(-s, u[(e, j)]));
            }
        }
        for (e, g) in b.equations.iter().enumerate() {
            for (j, t) in g.all(n - 1) {
                (0..m).for_each(|i| sums[i * n + j].add_product(-t, v[(i, e)]));
            }
        }
        sums.into_iter().map(WideSum::value).collect()
    }
}

/// How often U and V are refined.
const REFINED: usize = 2;
