//! Derivatives in symbols: an expression becomes one term for each place where a variable stands in it.
//!
//! Of a linear expression these terms are its normal form. The walk carries the factor by which the whole changes with
//! the part at hand (reverse mode), and what runs around it.

use super::tree::*;

/// `± Σ_binder factors · v(key)`; of a nonlinear expression the factors are the derivative by `v(key)`.
#[derive(Clone, Debug)]
pub struct Term {
    /// It is subtracted.
    pub negative: bool,
    /// What it runs over, inside the row.
    pub binder: Binder,
    /// Its coefficient: factors; true for those that divide.
    pub factors: Vec<(bool, Expr)>,
    /// The variable.
    pub variable: Variable,
    /// Its key.
    pub key: Vec<Part>,
}

impl Term {
    /// The coefficient as one expression, its sign in front.
    pub fn coefficient(&self) -> Expr {
        let p = product(self.factors.clone());
        if self.negative { negate(p) } else { p }
    }
}

/// Why there is no derivative.
pub type NoDerivative = String;

/// The walk.
pub struct Gradient<'a> {
    indices: &'a mut Indices,
    binder: Binder,
    factors: Vec<(bool, Expr)>,
    terms: Vec<Term>,
}

/// The terms of `left − right`.
pub fn gradient(
    left: &Expr,
    right: &Expr,
    indices: &mut Indices,
) -> Result<Vec<Term>, NoDerivative> {
    let mut g = Gradient {
        indices,
        binder: Binder::default(),
        factors: Vec::new(),
        terms: Vec::new(),
    };
    g.walk(left, false)?;
    g.walk(right, true)?;
    Ok(g.terms)
}

impl Gradient<'_> {
    fn walk(&mut self, e: &Expr, negative: bool) -> Result<(), NoDerivative> {
        if !e.has_variable() {
            return Ok(());
        }
        match e {
            Expr::Variable(v, key) => {
                self.terms.push(Term {
                    negative,
                    binder: self.binder.clone(),
                    factors: self.factors.clone(),
                    variable: *v,
                    key: key.clone(),
                });
                Ok(())
            }
            Expr::Negate(a) => self.walk(a, !negative),
            Expr::Sum(t) => t.iter().try_for_each(|(m, e)| self.walk(e, negative != *m)),
            Expr::Product(t) => self.product(t, negative),
            Expr::Dollar(a, c) => {
                let n = self.binder.conditions.len();
                self.add_conditions(c);
                self.walk(a, negative)?;
                self.binder.conditions.truncate(n);
                Ok(())
            }
            Expr::Aggregate(AggregateOp::Sum, d, a) => self.inside(d, |g| g.walk(a, negative)),
            Expr::Aggregate(AggregateOp::Prod, d, a) => self.prod(d, a, negative),
            Expr::Binary(BinaryOp::Power, a, b) => self.power(a, b, negative),
            Expr::Call(f, args) => self.call(*f, args, negative),
            Expr::Aggregate(AggregateOp::Smin | AggregateOp::Smax, ..) => {
                Err("`smin` and `smax` of variables have kinks".into())
            }
            Expr::Opaque(why) => Err(format!("it depends on {why}")),
            _ => Err("a relation or condition on variables has no derivative".into()),
        }
    }

    fn add_conditions(&mut self, c: &Expr) {
        match c {
            Expr::Binary(BinaryOp::And, a, b) => {
                self.add_conditions(a);
                self.add_conditions(b);
            }
            c if self.binder.conditions.contains(c) => {}
            c => self.binder.conditions.push(c.clone()),
        }
    }

    /// Walks below a sum's indices and conditions.
    fn inside<T>(&mut self, d: &Binder, f: impl FnOnce(&mut Self) -> T) -> T {
        let (i, c) = (self.binder.indices.len(), self.binder.conditions.len());
        self.binder.indices.extend(&d.indices);
        d.conditions.iter().for_each(|c| self.add_conditions(c));
        let r = f(self);
        self.binder.indices.truncate(i);
        self.binder.conditions.truncate(c);
        r
    }

    /// Walks into `e` with further factors. Sums in them get indices of their own: they stand beside those of `e` now.
    fn with(
        &mut self,
        factors: Vec<(bool, Expr)>,
        e: &Expr,
        negative: bool,
    ) -> Result<(), NoDerivative> {
        if !e.has_variable() {
            return Ok(());
        }
        let n = self.factors.len();
        for (d, f) in factors {
            let f = renamed(&f, self.indices);
            self.factors.push((d, f));
        }
        let r = self.walk(e, negative);
        self.factors.truncate(n);
        r
    }

    fn product(&mut self, t: &[(bool, Expr)], negative: bool) -> Result<(), NoDerivative> {
        for (k, (divide, e)) in t.iter().enumerate() {
            if !e.has_variable() {
                continue;
            }
            let mut others: Vec<(bool, Expr)> = Vec::new();
            for (n, (d, f)) in t.iter().enumerate() {
                if n != k {
                    others.push((*d, f.clone()));
                }
            }
            if *divide {
                let square = Expr::Call(Function::Sqr, vec![e.clone()]);
                others.push((true, square));
            }
            self.with(others, e, negative != *divide)?;
        }
        Ok(())
    }

    /// `prod(d, a)`: the product over all others.
    fn prod(&mut self, d: &Binder, a: &Expr, negative: bool) -> Result<(), NoDerivative> {
        let map: Vec<(IndexId, IndexId)> = d
            .indices
            .iter()
            .map(|&k| (k, self.indices.add(self.indices.set[k])))
            .collect();
        let mut others = Binder {
            indices: map.iter().map(|m| m.1).collect(),
            conditions: d.conditions.iter().map(|c| rename(c, &map)).collect(),
        };
        let same = |m: &(IndexId, IndexId)| Expr::SameAs(Part::Index(m.1), Part::Index(m.0));
        if let Some(all) = conjunction(map.iter().map(same).collect()) {
            others.conditions.push(Expr::Not(Box::new(all)));
        }
        let body = rename(a, &map);
        let rest = Expr::Aggregate(AggregateOp::Prod, Box::new(others), Box::new(body));
        self.inside(d, |g| g.with(vec![(false, rest)], a, negative))
    }

    fn power(&mut self, a: &Expr, b: &Expr, negative: bool) -> Result<(), NoDerivative> {
        let lower = match less_one(b) {
            Expr::Number(1.0) => a.clone(),
            Expr::Number(0.0) => Expr::Number(1.0),
            m => Expr::Binary(BinaryOp::Power, Box::new(a.clone()), Box::new(m)),
        };
        self.with(vec![(false, b.clone()), (false, lower)], a, negative)?;
        let whole = Expr::Binary(BinaryOp::Power, Box::new(a.clone()), Box::new(b.clone()));
        let log = Expr::Call(Function::Log, vec![a.clone()]);
        self.with(vec![(false, whole), (false, log)], b, negative)
    }

    fn call(&mut self, f: Function, args: &[Expr], negative: bool) -> Result<(), NoDerivative> {
        if f == Function::IfThen && !args[0].has_variable() {
            let truth = &args[0];
            let yes = guarded(args[1].clone(), vec![truth.clone()]);
            let no = guarded(args[2].clone(), vec![Expr::Not(Box::new(truth.clone()))]);
            return [yes, no].iter().try_for_each(|e| self.walk(e, negative));
        }
        if f.is_nonsmooth() {
            return Err(format!("`{}` of a variable has kinks or jumps", f.name()));
        }
        for (k, a) in args.iter().enumerate() {
            if !a.has_variable() {
                continue;
            }
            let Some(factors) = derivative(f, args, k) else {
                let name = f.name();
                return Err(format!(
                    "the derivative of `{name}` is no function of the language"
                ));
            };
            self.with(factors, a, negative)?;
        }
        Ok(())
    }
}

fn number(x: f64) -> Expr {
    Expr::Number(x)
}

fn call(f: Function, args: Vec<Expr>) -> Expr {
    Expr::Call(f, args)
}

fn sqr(e: &Expr) -> Expr {
    call(Function::Sqr, vec![e.clone()])
}

fn minus(a: Expr, b: Expr) -> Expr {
    sum(vec![(false, a), (true, b)])
}

/// An exponent less 1, in numbers where it is one.
fn less_one(n: &Expr) -> Expr {
    let ratio = match n {
        Expr::Product(t) => t.as_slice(),
        _ => &[],
    };
    match (n, ratio) {
        (Expr::Number(x), _) => number(x - 1.0),
        (_, [(false, Expr::Number(p)), (true, Expr::Number(q))]) => over(number(p - q), number(*q)),
        _ => minus(n.clone(), number(1.0)),
    }
}

fn plus(a: Expr, b: Expr) -> Expr {
    sum(vec![(false, a), (false, b)])
}

fn power(a: &Expr, b: Expr) -> Expr {
    Expr::Binary(BinaryOp::Power, Box::new(a.clone()), Box::new(b))
}

/// The derivative of a function by its k-th argument, as factors; None where the language has no function for it.
#[allow(clippy::too_many_lines)] // one function per line
fn derivative(f: Function, args: &[Expr], k: usize) -> Option<Vec<(bool, Expr)>> {
    use Function as F;
    let x = &args[0];
    let whole = || call(f, args.to_vec());
    let mul = |e| vec![(false, e)];
    let div = |e| vec![(true, e)];
    Some(match (f, k) {
        (F::Exp, _) => mul(whole()),
        (F::Log, _) => div(x.clone()),
        (F::Log2, _) => vec![(true, x.clone()), (true, call(F::Log, vec![number(2.0)]))],
        (F::Log10, _) => vec![(true, x.clone()), (true, call(F::Log, vec![number(10.0)]))],
        (F::Sqrt, _) => vec![(false, number(0.5)), (true, whole())],
        (F::Sqr, _) => vec![(false, number(2.0)), (false, x.clone())],
        (F::Power, 0) => {
            let n = args[1].clone();
            let lower = match &n {
                Expr::Number(2.0) => x.clone(),
                Expr::Number(1.0) => number(1.0),
                _ => call(f, vec![x.clone(), less_one(&n)]),
            };
            vec![(false, n), (false, lower)]
        }
        (F::RPower | F::VcPower, 0) => {
            let n = args[1].clone();
            let lower = call(f, vec![x.clone(), less_one(&n)]);
            vec![(false, n), (false, lower)]
        }
        (F::RPower | F::CvPower, 1) => {
            vec![(false, whole()), (false, call(F::Log, vec![x.clone()]))]
        }
        (F::SignPower, 0) => {
            let n = args[1].clone();
            let size = call(F::Abs, vec![x.clone()]);
            vec![(false, n.clone()), (false, power(&size, less_one(&n)))]
        }
        (F::Sin, _) => mul(call(F::Cos, vec![x.clone()])),
        (F::Cos, _) => mul(negate(call(F::Sin, vec![x.clone()]))),
        (F::Tan, _) => mul(plus(number(1.0), sqr(&whole()))),
        (F::ArcSin, _) => div(call(F::Sqrt, vec![minus(number(1.0), sqr(x))])),
        (F::ArcCos, _) => vec![
            (false, number(-1.0)),
            (true, call(F::Sqrt, vec![minus(number(1.0), sqr(x))])),
        ],
        (F::ArcTan, _) => div(plus(number(1.0), sqr(x))),
        (F::ArcTan2, 0) => vec![
            (false, args[1].clone()),
            (true, plus(sqr(x), sqr(&args[1]))),
        ],
        (F::ArcTan2, _) => vec![
            (false, negate(x.clone())),
            (true, plus(sqr(x), sqr(&args[1]))),
        ],
        (F::Sinh, _) => mul(call(F::Cosh, vec![x.clone()])),
        (F::Cosh, _) => mul(call(F::Sinh, vec![x.clone()])),
        (F::Tanh, _) => mul(minus(number(1.0), sqr(&whole()))),
        (F::ErrorF, _) => vec![
            (false, call(F::Exp, vec![over(negate(sqr(x)), number(2.0))])),
            (
                true,
                call(
                    F::Sqrt,
                    vec![times(number(2.0), Expr::DataCall(DataFunction::Pi, vec![]))],
                ),
            ),
        ],
        (F::Entropy, _) => mul(negate(plus(call(F::Log, vec![x.clone()]), number(1.0)))),
        (F::Centropy, 0 | 1) => {
            let shift = args.get(2).cloned().unwrap_or(number(1e-20));
            let (a, b) = (plus(x.clone(), shift.clone()), plus(args[1].clone(), shift));
            match k {
                0 => mul(plus(
                    call(F::Log, vec![over(a.clone(), b)]),
                    over(x.clone(), a),
                )),
                _ => vec![(false, negate(x.clone())), (true, b)],
            }
        }
        (F::Sigmoid, _) => vec![
            (false, whole()),
            (false, call(F::Sigmoid, vec![negate(x.clone())])),
        ],
        (F::Logit, _) => vec![(true, x.clone()), (true, minus(number(1.0), x.clone()))],
        (F::Poly, 0) => {
            let terms = args[2..].iter().enumerate().map(|(n, a)| {
                let n = n as f64;
                let power = call(F::Power, vec![x.clone(), number(n)]);
                let factors = match n {
                    0.0 => vec![(false, a.clone())],
                    1.0 => vec![(false, number(2.0)), (false, a.clone()), (false, x.clone())],
                    _ => vec![(false, number(n + 1.0)), (false, a.clone()), (false, power)],
                };
                (false, product(factors))
            });
            mul(sum(terms.collect()))
        }
        (F::Poly, k) => mul(call(F::Power, vec![x.clone(), number(k as f64 - 1.0)])),
        (F::EDist, k) => vec![(false, args[k].clone()), (true, whole())],
        (F::Div | F::Div0, 0) => div(args[1].clone()),
        (F::Div | F::Div0, _) => vec![(false, negate(x.clone())), (true, sqr(&args[1]))],
        (F::LseMax, k) => mul(call(F::Exp, vec![minus(args[k].clone(), whole())])),
        (F::LseMin, k) => mul(call(F::Exp, vec![minus(whole(), args[k].clone())])),
        (F::LseMaxSc, k) if k > 0 => {
            let e = times(x.clone(), minus(args[k].clone(), whole()));
            mul(call(F::Exp, vec![e]))
        }
        (F::LseMinSc, k) if k > 0 => {
            let e = times(x.clone(), minus(whole(), args[k].clone()));
            mul(call(F::Exp, vec![e]))
        }
        (F::BetaReg, 0) => {
            let (a, b) = (&args[1], &args[2]);
            vec![
                (false, power(x, less_one(a))),
                (false, power(&minus(number(1.0), x.clone()), less_one(b))),
                (true, call(F::Beta, vec![a.clone(), b.clone()])),
            ]
        }
        (F::GammaReg, 0) => {
            let a = &args[1];
            vec![
                (false, power(x, less_one(a))),
                (false, call(F::Exp, vec![negate(x.clone())])),
                (true, call(F::Gamma, vec![a.clone()])),
            ]
        }
        (F::NcpCm, 0 | 1) => {
            let s = call(
                F::Sigmoid,
                vec![over(minus(x.clone(), args[1].clone()), args[2].clone())],
            );
            match k {
                0 => mul(minus(number(1.0), s)),
                _ => mul(s),
            }
        }
        (F::NcpF, 0 | 1) => {
            let smoothing = args.get(2).cloned().unwrap_or(number(0.0));
            let inside = sum(vec![
                (false, sqr(x)),
                (false, sqr(&args[1])),
                (false, times(number(2.0), smoothing)),
            ]);
            let ratio = over(args[k].clone(), call(F::Sqrt, vec![inside]));
            mul(minus(ratio, number(1.0)))
        }
        _ => return None,
    })
}
