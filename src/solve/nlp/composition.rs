//! Whether an expression is convex or concave, by the rules of composition.
//!
//! A convex function that rises in its argument is convex of a convex argument, one that falls of a concave one; any convex function
//! is of an affine argument. Signs and ranges come from interval arithmetic over the bounds of the variables. The rules know nothing of
//! what is convex only as a whole, such as x² − x y + y².
//!
//! Source: Grant, Boyd & Ye, "Disciplined convex programming" (2006).

use super::relaxation::operation;
use crate::model::builder::Term;
use crate::model::instance::{Columns, Function, Op};
use crate::solve::interval::Interval;

/// What is known about an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Composed {
    /// Values that it can have.
    pub range: Interval,
    /// It is convex, and may be concave as well: then it is affine.
    pub convex: bool,
    /// It is concave.
    pub concave: bool,
    /// 0 of a number, 1 of an affine expression, 2 of a quadratic one, 3 of any other.
    pub degree: u8,
    /// It is a sum of squares of affine expressions: its root is a norm.
    squares: bool,
}

impl Composed {
    fn affine(degree: u8, range: Interval) -> Self {
        Self {
            range,
            convex: true,
            concave: true,
            degree,
            squares: degree == 0 && range.low >= 0.0,
        }
    }

    fn unknown(degree: u8, range: Interval) -> Self {
        Self {
            range,
            convex: false,
            concave: false,
            degree,
            squares: false,
        }
    }

    /// The number that it is, if it is one.
    fn number(&self) -> Option<f64> {
        (self.degree == 0 && self.range.low == self.range.high).then_some(self.range.low)
    }

    fn is_affine(&self) -> bool {
        self.degree <= 1
    }

    /// Multiplied by a number.
    pub fn times(self, factor: f64) -> Self {
        let range = self.range * factor;
        let (convex, concave) = match factor < 0.0 {
            true => (self.concave, self.convex),
            false => (self.convex, self.concave),
        };
        Self {
            range,
            convex,
            concave,
            squares: self.squares && factor >= 0.0,
            ..self
        }
    }

    fn and(self, other: Self) -> Self {
        Self {
            range: self.range + other.range,
            convex: self.convex && other.convex,
            concave: self.concave && other.concave,
            degree: self.degree.max(other.degree),
            squares: self.squares && other.squares,
        }
    }

    /// The square of an affine expression.
    fn square(self) -> Self {
        Self {
            convex: true,
            degree: 2,
            squares: true,
            ..self
        }
    }

    /// A function of it.
    fn under(self, f: Graph, degree: u8, range: Interval) -> Self {
        let of = |curved: bool, with_rising: bool, with_falling: bool| {
            curved && (self.is_affine() || f.rises && with_rising || f.falls && with_falling)
        };
        Self {
            range,
            convex: of(f.convex, self.convex, self.concave),
            concave: of(f.concave, self.concave, self.convex),
            degree,
            squares: degree == 2,
        }
    }
}

/// The graph of a function of one argument over a range of it.
#[derive(Clone, Copy)]
struct Graph {
    convex: bool,
    concave: bool,
    /// Also where the function ends: a convex one that ends below does not rise to infinity there.
    rises: bool,
    falls: bool,
}

impl Graph {
    /// Rises and is concave, as √ and the logarithm.
    const ROOT: Self = Self {
        convex: false,
        concave: true,
        rises: true,
        falls: false,
    };

    const EXPONENTIAL: Self = Self {
        convex: true,
        concave: false,
        rises: true,
        falls: false,
    };

    /// −x log x.
    const ENTROPY: Self = Self {
        convex: false,
        concave: true,
        rises: false,
        falls: false,
    };

    /// A whole power.
    fn whole_power(k: i32, a: Interval) -> Self {
        let (right, left, even) = (a.low >= 0.0, a.high <= 0.0, k % 2 == 0);
        match k {
            ..0 => Self {
                convex: right || left && even,
                concave: left && !even,
                rises: left && even,
                falls: right || left && !even,
            },
            _ => Self {
                convex: right || even,
                concave: left && !even,
                rises: right || !even,
                falls: left && even,
            },
        }
    }

    /// A real power, of arguments that are not below 0.
    fn power(p: f64, a: Interval) -> Self {
        Self {
            convex: !(0.0..1.0).contains(&p),
            concave: (0.0..=1.0).contains(&p),
            rises: p > 0.0 && (p <= 1.0 || a.low >= 0.0),
            falls: p < 0.0,
        }
    }
}

/// What is known about an expression over bounds of the columns.
pub fn composed(term: &Term, columns: &Columns) -> Composed {
    let bounds = |&j: &u32| Interval {
        low: columns.lower[j as usize],
        high: columns.upper[j as usize],
    };
    let at: &[Interval] = &term.columns.iter().map(bounds).collect::<Vec<_>>();
    let constants: &[f64] = &term.constants;
    let mut stack: Vec<(Composed, usize)> = Vec::new();
    for (place, op) in term.ops.iter().enumerate() {
        let a = stack.split_off(stack.len().saturating_sub(op.arguments()));
        let begin = a.first().map_or(place, |a| a.1);
        let ranges: Vec<Interval> = a.iter().map(|a| a.0.range).collect();
        let range = operation(*op, &ranges, at, constants);
        let degree = if a.iter().all(|a| a.0.degree == 0) {
            0
        } else {
            3
        };
        let other = Composed::unknown(degree, range);
        let sum = |a: &[(Composed, usize)]| {
            let zero = Composed::affine(0, Interval::point(0.0));
            let total = a.iter().fold(zero, |s, a| s.and(a.0));
            Composed { range, ..total }
        };
        let value = match (*op, &a[..]) {
            (Op::Const(_), _) => Composed::affine(0, range),
            (Op::Var(_) | Op::Affine(..), _) => {
                Composed::affine(u8::from(range.low != range.high), range)
            }
            _ if degree == 0 => Composed::affine(0, range),
            (Op::Add(_), all) => sum(all),
            (Op::Negate, [a]) => a.0.times(-1.0),
            (Op::Multiply(_), all) => product(all, term, place, other),
            (Op::Divide, [(a, _), (b, _)]) => match (a.number(), b.number()) {
                (_, Some(b)) if b != 0.0 => a.times(1.0 / b),
                (Some(a), _) => {
                    let f = Graph::whole_power(-1, b.range);
                    let inverse = operation(Op::PowerInt(-1), &[b.range], at, constants);
                    b.under(f, degree, inverse).times(a)
                }
                _ => other,
            },
            (Op::PowerInt(k), [(a, _)]) => whole_power(*a, k, range),
            (Op::Call(Function::Sqr, _), [(a, _)]) => whole_power(*a, 2, range),
            (Op::Call(Function::Power, _), [(a, _), (k, _)]) => match k.number() {
                Some(k) if k.fract() == 0.0 && k.abs() < 1e3 => {
                    let power = operation(Op::PowerInt(k as i32), &[a.range], at, constants);
                    whole_power(*a, k as i32, power)
                }
                _ => other,
            },
            (Op::Power | Op::Call(Function::RPower | Function::VcPower, _), [(a, _), (p, _)]) => {
                match p.number() {
                    Some(0.5) if a.squares => norm(other),
                    Some(p) => {
                        let power = operation(Op::Power, &ranges, at, constants);
                        let squared = if p == 2.0 && a.is_affine() { 2 } else { degree };
                        a.under(Graph::power(p, a.range), squared, power)
                    }
                    None => other,
                }
            }
            (Op::Call(Function::Sqrt, _), [(a, _)]) if a.squares => norm(other),
            (Op::Call(Function::EDist, _), all) if all.iter().all(|a| a.0.is_affine()) => {
                norm(other)
            }
            (Op::Call(f, _), [(a, _)]) => {
                let graph = match f {
                    Function::Exp => Some(Graph::EXPONENTIAL),
                    Function::Log | Function::Log2 | Function::Log10 | Function::Sqrt => {
                        Some(Graph::ROOT)
                    }
                    Function::Entropy => Some(Graph::ENTROPY),
                    _ => None,
                };
                graph.map_or(other, |g| a.under(g, degree, range))
            }
            _ => other,
        };
        stack.push((value, begin));
    }
    let none = Composed::unknown(3, Interval::ALL);
    stack.pop().map_or(none, |v| v.0)
}

/// A norm of affine expressions.
fn norm(other: Composed) -> Composed {
    Composed {
        convex: true,
        ..other
    }
}

/// a to a whole power.
fn whole_power(a: Composed, k: i32, range: Interval) -> Composed {
    let degree = match k {
        2 if a.is_affine() => 2,
        _ => 3,
    };
    a.under(Graph::whole_power(k, a.range), degree, range)
}

/// The product at a place, of expressions that begin where they say: a number times one of them, or x log x.
fn product(factors: &[(Composed, usize)], term: &Term, place: usize, other: Composed) -> Composed {
    let number: f64 = factors.iter().filter_map(|f| f.0.number()).product();
    let rest = (0..factors.len()).filter(|&k| factors[k].0.number().is_none());
    match rest.collect::<Vec<_>>()[..] {
        [only] => factors[only].0.times(number),
        [first, second] => {
            let end = |k: usize| factors.get(k + 1).map_or(place, |f| f.1);
            let text = |k: usize| &term.ops[factors[k].1..end(k)];
            let affine = |k: usize| factors[k].0.is_affine();
            let is_log_of = |log: usize, x: usize| match text(log) {
                [argument @ .., Op::Call(Function::Log, 1)] => {
                    affine(x) && is_same(term, argument, text(x))
                }
                _ => false,
            };
            if affine(first) && is_same(term, text(first), text(second)) {
                return other.square().times(number);
            }
            let known = Composed {
                convex: is_log_of(second, first) || is_log_of(first, second),
                degree: if affine(first) && affine(second) {
                    2
                } else {
                    3
                },
                ..other
            };
            known.times(number)
        }
        _ => other,
    }
}

/// Whether two parts of a program are the same expression.
fn is_same(term: &Term, a: &[Op], b: &[Op]) -> bool {
    let copy = |ops: &[Op]| {
        let mut out = Term::default();
        ops.iter().for_each(|op| out.copy(term, *op));
        out
    };
    copy(a) == copy(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_agree_with_what_is_known() {
        let mut columns = Columns::default();
        columns.push(0.0, 4.0);
        columns.push(f64::NEG_INFINITY, f64::INFINITY);
        columns.push(-3.0, -1.0);
        let [x, y, z] = [0, 1, 2].map(Term::column);
        let call = |f, a: &Term| Term::call(f, [a.clone()]);
        let two = Term::constant(2.0);
        let cases = [
            (call(Function::Exp, &(x.clone() + y.clone())), "convex"),
            (call(Function::Log, &(1.0 + x.clone())), "concave"),
            (-call(Function::Log, &(1.0 + x.clone())), "convex"),
            (call(Function::Sqrt, &call(Function::Log, &x)), "concave"),
            (call(Function::Exp, &y.clone().powi(2)), "convex"),
            (y.clone().powi(3), "neither"),
            (x.clone().powi(3), "convex"),
            (z.clone().powi(3), "concave"),
            (z.clone().powi(-1), "concave"),
            (1.0 / x.clone(), "convex"),
            (-2.0 / (1.0 + x.clone()), "concave"),
            (1.0 / y.clone(), "neither"),
            (x.clone() * y.clone(), "neither"),
            (x.clone() * call(Function::Log, &x), "convex"),
            (y.clone() * call(Function::Log, &x), "neither"),
            (x.clone().powi(2).powi(2), "convex"),
            ((x.clone().powi(2) - 1.0).powi(2), "neither"),
            (
                Term::call(Function::RPower, [x.clone(), Term::constant(0.6)]),
                "concave",
            ),
            (
                Term::call(
                    Function::RPower,
                    [1.0 + y.clone().powi(2), Term::constant(1.5)],
                ),
                "convex",
            ),
            // where the base is not above 0 the power does not exist: no convex set of points is left
            (
                Term::call(
                    Function::RPower,
                    [y.clone().powi(2) - 1.0, Term::constant(1.5)],
                ),
                "neither",
            ),
            (
                call(
                    Function::Sqrt,
                    &(1.0 + 2.0 * y.clone().powi(2) + (x.clone() - y.clone()).powi(2)),
                ),
                "convex",
            ),
            (
                call(Function::Sqrt, &(y.clone() * y.clone() + z.clone().powi(2))),
                "convex",
            ),
            (call(Function::Sqrt, &(y.clone().powi(2) - 1.0)), "neither"),
            (
                Term::call(Function::EDist, [x.clone(), y.clone()]),
                "convex",
            ),
            (call(Function::Sin, &x), "neither"),
            (two * (3.0 - x), "affine"),
        ];
        for (term, expected) in cases {
            let known = composed(&term, &columns);
            let said = match (known.convex, known.concave) {
                (true, true) => "affine",
                (true, false) => "convex",
                (false, true) => "concave",
                (false, false) => "neither",
            };
            assert_eq!(said, expected, "{term:?}");
        }
    }
}
