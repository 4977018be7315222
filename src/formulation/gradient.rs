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

/// The walk.
pub struct Gradient<'a> {
    indices: &'a mut Indices,
    binder: Binder,
    factors: Vec<(bool, Expr)>,
    terms: Vec<Term>,
}

/// The terms of `left − right`. Err: why there is no derivative.
pub fn gradient(left: &Expr, right: &Expr, indices: &mut Indices) -> Result<Vec<Term>, String> {
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
    fn walk(&mut self, e: &Expr, negative: bool) -> Result<(), String> {
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
    fn with(&mut self, factor: Expr, e: &Expr, negative: bool) -> Result<(), String> {
        if !e.has_variable() {
            return Ok(());
        }
        let n = self.factors.len();
        match renamed(&factor, self.indices) {
            Expr::Product(t) => self.factors.extend(t),
            f => self.factors.push((false, f)),
        }
        let r = self.walk(e, negative);
        self.factors.truncate(n);
        r
    }

    fn product(&mut self, t: &[(bool, Expr)], negative: bool) -> Result<(), String> {
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
                others.push((true, sqr(e.clone())));
            }
            self.with(product(others), e, negative != *divide)?;
        }
        Ok(())
    }

    /// `prod(d, a)`: the product over all others.
    fn prod(&mut self, d: &Binder, a: &Expr, negative: bool) -> Result<(), String> {
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
        self.inside(d, |g| g.with(rest, a, negative))
    }

    fn power(&mut self, a: &Expr, b: &Expr, negative: bool) -> Result<(), String> {
        let lower = match less_one(b.clone()) {
            Expr::Number(1.0) => a.clone(),
            Expr::Number(0.0) => number(1.0),
            m => power(a.clone(), m),
        };
        self.with(b.clone() * lower, a, negative)?;
        let whole = power(a.clone(), b.clone());
        self.with(whole * call(Function::Log, a.clone()), b, negative)
    }

    fn call(&mut self, f: Function, args: &[Expr], negative: bool) -> Result<(), String> {
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
            let Some(factor) = derivative(f, args, k) else {
                let name = f.name();
                return Err(format!(
                    "the derivative of `{name}` is no function of the language"
                ));
            };
            self.with(factor, a, negative)?;
        }
        Ok(())
    }
}

fn number(x: f64) -> Expr {
    Expr::Number(x)
}

fn call(f: Function, x: Expr) -> Expr {
    Expr::Call(f, vec![x])
}

fn sqr(x: Expr) -> Expr {
    call(Function::Sqr, x)
}

/// An exponent less 1, in numbers where it is one.
fn less_one(n: Expr) -> Expr {
    match &n {
        Expr::Number(x) => number(x - 1.0),
        Expr::Product(t) => match t.as_slice() {
            [(false, Expr::Number(p)), (true, Expr::Number(q))] => number(p - q) / number(*q),
            _ => n - number(1.0),
        },
        _ => n - number(1.0),
    }
}

/// The derivative of a function by its k-th argument; None where the language has no function for it.
fn derivative(f: Function, args: &[Expr], k: usize) -> Option<Expr> {
    use Function as F;
    let x = || args[0].clone();
    let y = || args[1].clone();
    let z = |default| args.get(2).cloned().unwrap_or(number(default));
    let by = || args[k].clone();
    let one = || number(1.0);
    let whole = || Expr::Call(f, args.to_vec());
    Some(match (f, k) {
        (F::Exp, _) => whole(),
        (F::Log, _) => one() / x(),
        (F::Log2, _) => one() / x() / call(F::Log, number(2.0)),
        (F::Log10, _) => one() / x() / call(F::Log, number(10.0)),
        (F::Sqrt, _) => number(0.5) / whole(),
        (F::Sqr, _) => number(2.0) * x(),
        (F::Power, 0) if args[1] == number(2.0) => y() * x(),
        (F::Power, 0) if args[1] == one() => one(),
        (F::Power | F::RPower | F::VcPower, 0) => y() * Expr::Call(f, vec![x(), less_one(y())]),
        (F::RPower | F::CvPower, 1) => whole() * call(F::Log, x()),
        (F::SignPower, 0) => y() * power(call(F::Abs, x()), less_one(y())),
        (F::Sin, _) => call(F::Cos, x()),
        (F::Cos, _) => -call(F::Sin, x()),
        (F::Tan, _) => one() + sqr(whole()),
        (F::ArcSin, _) => one() / call(F::Sqrt, one() - sqr(x())),
        (F::ArcCos, _) => number(-1.0) / call(F::Sqrt, one() - sqr(x())),
        (F::ArcTan, _) => one() / (one() + sqr(x())),
        (F::ArcTan2, 0) => y() / (sqr(x()) + sqr(y())),
        (F::ArcTan2, _) => -x() / (sqr(x()) + sqr(y())),
        (F::Sinh, _) => call(F::Cosh, x()),
        (F::Cosh, _) => call(F::Sinh, x()),
        (F::Tanh, _) => one() - sqr(whole()),
        (F::ErrorF, _) => {
            let pi = Expr::DataCall(DataFunction::Pi, vec![]);
            call(F::Exp, -sqr(x()) / number(2.0)) / call(F::Sqrt, number(2.0) * pi)
        }
        (F::Entropy, _) => -(call(F::Log, x()) + one()),
        (F::Centropy, 0) => {
            let (a, b) = (x() + z(1e-20), y() + z(1e-20));
            call(F::Log, a.clone() / b) + x() / a
        }
        (F::Centropy, 1) => -x() / (y() + z(1e-20)),
        (F::Sigmoid, _) => whole() * call(F::Sigmoid, -x()),
        (F::Logit, _) => one() / x() / (one() - x()),
        (F::Poly, 0) => {
            let terms = args[2..].iter().enumerate().map(|(n, a)| {
                let (n, a) = (n as f64, a.clone());
                let term = match n {
                    0.0 => a,
                    1.0 => number(2.0) * a * x(),
                    _ => number(n + 1.0) * a * Expr::Call(F::Power, vec![x(), number(n)]),
                };
                (false, term)
            });
            sum(terms.collect())
        }
        (F::Poly, k) => Expr::Call(F::Power, vec![x(), number(k as f64 - 1.0)]),
        (F::EDist, _) => by() / whole(),
        (F::Div | F::Div0, 0) => one() / y(),
        (F::Div | F::Div0, _) => -x() / sqr(y()),
        (F::LseMax, _) => call(F::Exp, by() - whole()),
        (F::LseMin, _) => call(F::Exp, whole() - by()),
        (F::LseMaxSc, k) if k > 0 => call(F::Exp, x() * (by() - whole())),
        (F::LseMinSc, k) if k > 0 => call(F::Exp, x() * (whole() - by())),
        (F::BetaReg, 0) => {
            let (a, b) = (y(), z(0.0));
            let beta = Expr::Call(F::Beta, vec![a.clone(), b.clone()]);
            power(x(), less_one(a)) * power(one() - x(), less_one(b)) / beta
        }
        (F::GammaReg, 0) => power(x(), less_one(y())) * call(F::Exp, -x()) / call(F::Gamma, y()),
        (F::NcpCm, 0) => one() - call(F::Sigmoid, (x() - y()) / z(0.0)),
        (F::NcpCm, 1) => call(F::Sigmoid, (x() - y()) / z(0.0)),
        (F::NcpF, 0 | 1) => {
            let squares = sqr(x()) + sqr(y()) + number(2.0) * z(0.0);
            by() / call(F::Sqrt, squares) - one()
        }
        _ => return None,
    })
}
