//! From an interior point to a basis.
//!
//! At an optimum that is not degenerate the basic variables are those strictly between their
//! bounds. An interior point blurs that: a variable counts as basic the more, the farther it is
//! from its bounds compared with its reduced cost. The m best are offered as a basis; dependent
//! ones among them are replaced when it is factorised, those at their bounds before those inside.
//!
//! Where more than m are strictly inside, the optimal points are a face of that many dimensions more, the
//! interior point is in its middle, and every dimension costs a push. If there are thousands, a second
//! interior-point run on the [`face`], with a random objective, ends near one of its vertices for less.

use super::form::{Point, Problem};
use super::simplex::push::Start;
use super::simplex::{State, jitter};

/// Dimensions of the optimal face from which a second interior-point run is cheaper than pushes.
const WIDE: usize = 1500;

/// The weight of a variable in the objective of a face is at most one over this.
const NEAR: f64 = 1e-3;

/// A column or row at an interior point.
struct Place {
    value: f64,
    lower: f64,
    upper: f64,
    /// Size of its multiplier.
    price: f64,
}

impl Place {
    /// Distance to the nearest bound.
    fn distance(&self) -> f64 {
        (self.value - self.lower).min(self.upper - self.value)
    }

    fn is_low(&self) -> bool {
        self.value - self.lower <= self.upper - self.value
    }

    fn is_free(&self) -> bool {
        self.lower.is_infinite() && self.upper.is_infinite()
    }

    /// Whether the multiplier holds it at a bound.
    fn is_held(&self) -> bool {
        self.score() <= 1.0
    }

    /// How much it is inside rather than at a bound.
    fn score(&self) -> f64 {
        if self.lower == self.upper {
            return f64::NEG_INFINITY;
        }
        self.distance().max(1e-300) / self.price.max(1e-300)
    }
}

/// The columns, then the rows.
fn places<'a>(p: &'a Problem, point: &'a Point) -> impl Iterator<Item = Place> + 'a {
    let columns = (0..p.n()).map(|j| Place {
        value: point.x[j],
        lower: p.lower[j],
        upper: p.upper[j],
        price: point.d[j].abs(),
    });
    let rows = (0..p.m()).map(|i| Place {
        value: p.activity(i, &point.x),
        lower: p.row_lower[i],
        upper: p.row_upper[i],
        price: point.y[i].abs(),
    });
    columns.chain(rows)
}

/// Whether the optimal points, as the interior point sees them, are a face of very many dimensions.
pub fn is_wide(p: &Problem, point: &Point) -> bool {
    let inside = places(p, point).filter(|v| !v.is_held()).count();
    inside > p.m() + WIDE
}

/// The face on which the interior point is, with an objective that has one optimal point: what is
/// at a bound stays where it is, and all else is drawn to its bound, with random weights that spare what is
/// near it already. And the interior point with the multipliers that such an objective has: distance times multiplier is
/// nearly the same everywhere, so that it is in the middle of the face's own path.
pub fn face(p: &Problem, point: &Point) -> (Problem, Point) {
    let mut face = p.clone();
    face.cost.fill(0.0);
    let mut centre = Point {
        x: point.x.clone(),
        y: vec![0.0; p.m()],
        d: Vec::new(),
    };
    for (j, v) in places(p, point).enumerate() {
        if v.is_free() || v.lower == v.upper {
            continue;
        }
        let row = j.checked_sub(p.n());
        if v.is_held() {
            let (lower, upper) = match row {
                Some(i) => (&mut face.row_lower[i], &mut face.row_upper[i]),
                None => (&mut face.lower[j], &mut face.upper[j]),
            };
            // Where it is: with all of them at the bounds themselves the equations have no solution, by a little.
            let at = v.value.max(*lower).min(*upper);
            (*lower, *upper) = (at, at);
            continue;
        }
        let sign = if v.is_low() { 1.0 } else { -1.0 };
        let weight = sign * jitter(j) / v.distance().max(NEAR);
        match row {
            Some(i) => {
                centre.y[i] = weight;
                p.rows.line(i).for_each(|(k, a)| face.cost[k] += a * weight);
            }
            None => face.cost[j] += weight,
        }
    }
    (face, centre)
}

/// A basis suggested by an interior point, and perhaps one of its face; and where all variables are.
pub fn start(p: &Problem, point: &Point, of_face: Option<&Point>) -> Start {
    let (m, n) = (p.m(), p.n());
    let mut start = Start {
        basis: Vec::with_capacity(m + n),
        value: Vec::with_capacity(m + n),
        held: Vec::with_capacity(m + n),
        inside: Vec::with_capacity(m + n),
        of_face: of_face.is_some(),
        y: point.y.clone(),
    };
    let mut order: Vec<(bool, f64, usize)> = Vec::with_capacity(m + n);
    let mut second = of_face.map(|f| places(p, f));
    for (j, first) in places(p, point).enumerate() {
        // What was fixed on the face comes last, in the order of the first point.
        let held = first.is_held();
        let v = match second.as_mut().and_then(Iterator::next) {
            Some(v) if !held => v,
            Some(v) => Place {
                value: v.value,
                ..first
            },
            None => first,
        };
        start.basis.push(match (v.is_free(), v.is_low()) {
            (true, _) => State::Free,
            (_, true) => State::Lower,
            _ => State::Upper,
        });
        start.value.push(v.value);
        start.held.push(held);
        start.inside.push(!held && !v.is_held());
        order.push((of_face.is_some() && held, v.score(), j));
    }
    let last = |a: &(bool, f64, usize), b: &(bool, f64, usize)| {
        a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)).then(a.2.cmp(&b.2))
    };
    order.sort_by(last);
    for &(_, _, j) in order.iter().take(m) {
        start.basis[j] = State::Basic;
    }
    start
}
