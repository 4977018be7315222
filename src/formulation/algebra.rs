//! A formulation as data for other programs: trees with the names of the text, which need no tables beside them.

use super::gradient::gradient;
use super::names::Names;
use super::text::taken;
use super::tree::{Binder, Expr, IndexId, Part, Sense, Source, Variable};
use super::{Formulation, Origin, Row, Scope, Sign};
use crate::check::functions::attribute_word;
use crate::check::node::SymbolId;
use crate::report::json::Number;
use serde::Serialize;

/// A model as formulas: objective, equations, variables, with the names of the text. As JSON with `serde`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Algebra {
    /// Its name.
    pub name: String,
    /// The problem type; empty for a model that is not solved.
    pub using: String,
    /// `min` or `max`; none for a model without objective.
    pub sense: Option<&'static str>,
    /// The objective function.
    pub objective: Option<Expression>,
    /// Its equations.
    pub equations: Vec<AlgebraEquation>,
    /// Its variables.
    pub variables: Vec<AlgebraVariable>,
    /// Coefficients that could not be written in symbols and are numbers: of what, and why.
    pub by_instance: Vec<String>,
}

/// The rows of an equation.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct AlgebraEquation {
    /// Its name.
    pub name: String,
    /// Its explanatory text.
    pub text: String,
    /// What it runs over.
    #[serde(flatten)]
    pub over: Over,
    /// Labels of its rows.
    pub key: Vec<Index>,
    /// Left side, as it was written.
    pub left: Expression,
    /// `=e=`, `=l=`, `=g=`, `=n=`.
    pub relation: &'static str,
    /// Right side, as it was written.
    pub right: Expression,
    /// The normal form: `left - right` is the sum of these and of a constant. Of a nonlinear equation the coefficients
    /// are the derivatives. Empty where there are none (kinks).
    pub terms: Vec<AlgebraTerm>,
    /// The variable that it is paired with: the partner in a complementarity problem; in a dual the variable of the primal
    /// whose column it is.
    pub pair: Option<String>,
}

/// `coefficient · variable(indices)`, summed up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlgebraTerm {
    /// What is summed over.
    #[serde(flatten)]
    pub over: Over,
    /// The coefficient.
    pub coefficient: Expression,
    /// The variable.
    pub variable: String,
    /// Its indices.
    pub indices: Vec<Index>,
}

/// A variable of a formulation.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct AlgebraVariable {
    /// Its name.
    pub name: String,
    /// The sets it is declared over.
    pub domain: Vec<String>,
    /// `free`, `positive` or `negative`.
    pub sign: &'static str,
    /// For multipliers: `rows`, `lower bounds`, `upper bounds`, `fixed values`, and the equation or variable. `gradient`: the
    /// variable at which the dual of a quadratic program takes the gradient.
    pub multiplier_of: Option<(&'static str, String)>,
}

/// What an equation or a sum runs over.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Over {
    /// Indices and the sets they run over.
    pub over: Vec<(String, String)>,
    /// What must hold.
    pub conditions: Vec<Expression>,
}

/// One index of a reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Index {
    /// An index that runs.
    Index(String),
    /// A label.
    Label(String),
    /// The element of a singleton set.
    Singleton(String),
    /// A lag or lead: lags have a negative offset.
    Lag {
        /// Where to start.
        base: Box<Index>,
        /// How far.
        offset: Box<Expression>,
        /// `++`, `--`
        circular: bool,
    },
}

/// A formula.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Expression {
    /// A number.
    Number(Number),
    /// A record of a parameter, or of an attribute of a variable (`x.up`).
    Data {
        /// The symbol.
        name: String,
        /// `l`, `m`, `lo`, `up` …
        #[serde(skip_serializing_if = "Option::is_none")]
        attribute: Option<&'static str>,
        /// Its indices.
        indices: Vec<Index>,
    },
    /// Membership of a set.
    Member {
        /// The set.
        set: String,
        /// The tuple.
        indices: Vec<Index>,
    },
    /// A variable.
    Variable {
        /// Its name.
        name: String,
        /// Its indices.
        indices: Vec<Index>,
    },
    /// `ord(i)`
    Ord(Index),
    /// `card(s)`
    Card(String),
    /// `sameas(i,j)`
    SameAs(Index, Index),
    /// `i.val`, `i.pos` …
    Label(&'static str, Index),
    /// `-a`
    Negate(Box<Expression>),
    /// `not a`
    Not(Box<Expression>),
    /// Terms; true for those that are subtracted.
    Sum(Vec<(bool, Expression)>),
    /// Factors; true for those that divide.
    Product(Vec<(bool, Expression)>),
    /// `a ** b`, relations, logic: the operator of the language.
    Binary(&'static str, Box<Expression>, Box<Expression>),
    /// A function.
    Call(&'static str, Vec<Expression>),
    /// `a $ c`
    Dollar(Box<Expression>, Box<Expression>),
    /// `sum`, `prod`, `smin`, `smax`, `sand`, `sor`.
    Aggregate {
        /// Which.
        function: &'static str,
        /// What it runs over.
        #[serde(flatten)]
        over: Over,
        /// What of.
        body: Box<Expression>,
    },
    /// A part of the text that has no symbols here (a random number): what it is.
    Opaque(&'static str),
}

/// The formulation with the names of the text.
pub fn algebra(scope: Scope, f: &Formulation) -> Algebra {
    let mut indices = f.indices.clone();
    let terms: Vec<_> = f
        .rows
        .iter()
        .map(|r| gradient(&r.left, &r.right, &mut indices).unwrap_or_default())
        .collect();
    let mut n = Naming {
        scope,
        f,
        names: Names::new(scope.symbols, &indices, taken(scope.symbols, f)),
    };
    let mut equations = Vec::new();
    for (r, terms) in f.rows.iter().zip(terms) {
        let (mut e, before) = n.equation(r);
        for t in terms {
            let (over, inner) = n.over(&t.binder);
            e.terms.push(AlgebraTerm {
                over,
                coefficient: n.expression(&t.coefficient()),
                variable: n.variable(t.variable),
                indices: n.key(&t.key),
            });
            n.names.leave(inner);
        }
        n.names.leave(before);
        equations.push(e);
    }
    let domain = |d: &[SymbolId]| d.iter().map(|s| n.name(*s)).collect();
    let own = f.own.iter().map(|&v| AlgebraVariable {
        name: n.name(v),
        domain: scope.symbols.domain_names(scope.get(v)),
        sign: Sign::of(super::derive::kind(scope.symbols, v)).name(),
        multiplier_of: None,
    });
    let multipliers = f.multipliers.iter().map(|m| AlgebraVariable {
        name: m.name.clone(),
        domain: domain(&m.domain),
        sign: m.sign.name(),
        multiplier_of: Some(match m.origin {
            Origin::Row(s) => ("rows", n.name(s)),
            Origin::Lower(s) => ("lower bounds", n.name(s)),
            Origin::Upper(s) => ("upper bounds", n.name(s)),
            Origin::Fixed(s) => ("fixed values", n.name(s)),
            Origin::Missing(s) => ("missing bounds", n.name(s)),
            Origin::Point(s) => ("gradient", n.name(s)),
        }),
    });
    let variables = own.chain(multipliers).collect();
    Algebra {
        name: f.name.clone(),
        using: f.using.clone(),
        sense: f.objective.as_ref().map(|o| match o.0 {
            Sense::Minimize => "min",
            Sense::Maximize => "max",
        }),
        objective: f.objective.as_ref().map(|o| n.expression(&o.1)),
        equations,
        variables,
        by_instance: f.by_instance.clone(),
    }
}

/// Puts names for numbers.
struct Naming<'a> {
    scope: Scope<'a>,
    f: &'a Formulation,
    names: Names<'a>,
}

impl Naming<'_> {
    fn name(&self, s: SymbolId) -> String {
        self.scope.get(s).name.to_string()
    }

    fn variable(&self, v: Variable) -> String {
        self.f.variable(self.scope.symbols, v)
    }

    /// The equation without its terms; its indices have names until the number is given to [`Names::leave`].
    fn equation(&mut self, r: &Row) -> (AlgebraEquation, usize) {
        let (over, before) = self.over(&r.binder);
        let e = AlgebraEquation {
            name: r.name.clone(),
            text: r.text.clone(),
            over,
            key: self.key(&r.key),
            left: self.expression(&r.left),
            relation: r.relation.name(),
            right: self.expression(&r.right),
            terms: Vec::new(),
            pair: r.pair.map(|v| self.variable(v)),
        };
        (e, before)
    }

    fn over(&mut self, b: &Binder) -> (Over, usize) {
        let before = self.names.enter(&b.indices);
        let set = |n: &Self, k: &IndexId| n.name(n.names.set(*k));
        let over = b
            .indices
            .iter()
            .map(|k| (self.names.of(*k).to_string(), set(self, k)))
            .collect();
        let conditions = b.conditions.iter().map(|c| self.expression(c)).collect();
        (Over { over, conditions }, before)
    }

    fn key(&mut self, key: &[Part]) -> Vec<Index> {
        key.iter().map(|p| self.index(p)).collect()
    }

    fn index(&mut self, p: &Part) -> Index {
        match p {
            Part::Index(k) => Index::Index(self.names.of(*k).to_string()),
            Part::Label(l) => Index::Label(self.scope.store.universe.name(*l).to_string()),
            Part::Singleton(s, _) => Index::Singleton(self.name(*s)),
            Part::Lag(l) => Index::Lag {
                base: Box::new(self.index(&l.base)),
                offset: Box::new(self.expression(&l.offset)),
                circular: l.circular,
            },
        }
    }

    fn all(&mut self, list: &[Expr]) -> Vec<Expression> {
        list.iter().map(|e| self.expression(e)).collect()
    }

    fn boxed(&mut self, e: &Expr) -> Box<Expression> {
        Box::new(self.expression(e))
    }

    fn marked(&mut self, list: &[(bool, Expr)]) -> Vec<(bool, Expression)> {
        list.iter().map(|(b, e)| (*b, self.expression(e))).collect()
    }

    fn expression(&mut self, e: &Expr) -> Expression {
        match e {
            Expr::Number(x) => Expression::Number(Number(*x)),
            Expr::Data(source, k) => {
                let (name, attribute) = match *source {
                    Source::Parameter(p) => (self.name(p), None),
                    Source::Attribute(s, o) => (self.name(s), Some(attribute_word(o))),
                    Source::New(n) => (self.f.data[n].name.clone(), None),
                };
                Expression::Data {
                    name,
                    attribute,
                    indices: self.key(k),
                }
            }
            Expr::Member(s, k) => Expression::Member {
                set: self.name(*s),
                indices: self.key(k),
            },
            Expr::NewMember(n, k) => Expression::Member {
                set: self.f.data[*n].name.clone(),
                indices: self.key(k),
            },
            Expr::Variable(v, k) => Expression::Variable {
                name: self.variable(*v),
                indices: self.key(k),
            },
            Expr::Ord(_, p) => Expression::Ord(self.index(p)),
            Expr::Card(s) => Expression::Card(self.name(*s)),
            Expr::SameAs(a, b) => Expression::SameAs(self.index(a), self.index(b)),
            Expr::LabelAttribute(a, _, p) => Expression::Label(a.name(), self.index(p)),
            Expr::Negate(a) => Expression::Negate(self.boxed(a)),
            Expr::Not(a) => Expression::Not(self.boxed(a)),
            Expr::Sum(t) => Expression::Sum(self.marked(t)),
            Expr::Product(t) => Expression::Product(self.marked(t)),
            Expr::Binary(op, a, b) => Expression::Binary(op.name(), self.boxed(a), self.boxed(b)),
            Expr::Call(f, args) => Expression::Call(f.name(), self.all(args)),
            Expr::DataCall(f, args) => Expression::Call(f.name(), self.all(args)),
            Expr::Dollar(a, c) => Expression::Dollar(self.boxed(a), self.boxed(c)),
            Expr::Aggregate(op, d, e) => {
                let (over, before) = self.over(d);
                let body = self.boxed(e);
                self.names.leave(before);
                Expression::Aggregate {
                    function: op.name(),
                    over,
                    body,
                }
            }
            Expr::Opaque(why) => Expression::Opaque(why),
        }
    }
}
