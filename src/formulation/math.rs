//! Formulas as they are set: sums with what stands below them, fractions, indices as subscripts. From here to text, LaTeX and
//! MathML it is one step each ([`super::render`]).

use super::data::number as shortest;
use super::names::Names;
use super::tree::*;
use super::{Formulation, Row, Scope};
use crate::check::functions::attribute_word;
use crate::check::node::SymbolId;
use crate::check::symbols::{Symbols, attribute};
use rustc_hash::FxHashSet;

/// A piece of a formula.
#[derive(Clone, PartialEq, Debug)]
pub enum Math {
    /// A number.
    Number(String),
    /// A name of a symbol.
    Name(Name),
    /// A label or another word that is quoted.
    Quoted(String),
    /// Words between formulas.
    Words(String),
    /// An operator or relation, as Unicode has it, with space around.
    Operator(&'static str),
    /// A sign in front of a term.
    Prefix(&'static str),
    /// Side by side; factors too.
    Row(Vec<Math>),
    /// In parentheses.
    Parentheses(Box<Math>),
    /// A parenthesis that opens, of a pair between which a line breaks.
    Open(&'static str),
    /// One that closes.
    Close(&'static str),
    /// In brackets: 1 if it holds, else 0.
    Bracket(Box<Math>),
    /// With indices.
    Indexed(Box<Math>, Vec<Math>),
    /// A bound: with a bar below (lower) or above (upper).
    Bar(Box<Math>, bool),
    /// With a superscript that is a mark and no power.
    Marked(Box<Math>, &'static str),
    /// A fraction.
    Fraction(Box<Math>, Box<Math>),
    /// A power.
    Power(Box<Math>, Box<Math>),
    /// A square root.
    Root(Box<Math>),
    /// An absolute value.
    Absolute(Box<Math>),
    /// A Euclidean norm.
    Norm(Box<Math>),
    /// A sum, a product, a minimum …: what it runs over, and what of.
    Big(&'static str, Box<Math>, Box<Math>),
    /// A function.
    Function(&'static str, Vec<Math>),
}

/// A name as it is set.
#[derive(Clone, PartialEq, Debug)]
pub struct Name {
    /// Letters; a Greek letter as Unicode has it.
    pub base: String,
    /// What is behind an underscore.
    pub below: String,
    /// The user's own LaTeX, from the explanatory text.
    pub latex: Option<String>,
}

#[rustfmt::skip]
const GREEK: [(&str, &str); 36] = [
    ("alpha", "α"), ("beta", "β"), ("gamma", "γ"), ("delta", "δ"), ("epsilon", "ε"), ("zeta", "ζ"),
    ("eta", "η"), ("theta", "θ"), ("iota", "ι"), ("kappa", "κ"), ("lambda", "λ"), ("mu", "μ"), ("nu", "ν"),
    ("xi", "ξ"), ("pi", "π"), ("rho", "ρ"), ("sigma", "σ"), ("tau", "τ"), ("upsilon", "υ"), ("phi", "φ"),
    ("chi", "χ"), ("psi", "ψ"), ("omega", "ω"), ("varepsilon", "ε"), ("Gamma", "Γ"), ("Delta", "Δ"),
    ("Theta", "Θ"), ("Lambda", "Λ"), ("Xi", "Ξ"), ("Pi", "Π"), ("Sigma", "Σ"), ("Phi", "Φ"), ("Psi", "Ψ"),
    ("Omega", "Ω"), ("varphi", "φ"), ("ell", "ℓ"),
];

/// The Greek letter of this name.
pub fn greek(name: &str) -> Option<&'static str> {
    GREEK.iter().find(|g| g.0 == name).map(|g| g.1)
}

/// A relation as it is set.
pub fn relation_sign(r: Relation) -> &'static str {
    match r {
        Relation::Equal => "=",
        Relation::Greater => "≥",
        Relation::Less => "≤",
        Relation::Free => "⋚",
    }
}

/// The LaTeX command of a Greek letter.
pub fn command(letter: &str) -> Option<&'static str> {
    GREEK.iter().find(|g| g.1 == letter).map(|g| g.0)
}

/// A name as it is set, without an explanatory text.
pub fn name(text: &str) -> Name {
    let (base, below) = match text.split_once('_') {
        Some((a, b)) if !a.is_empty() && !b.is_empty() => (a, b),
        _ => (text, ""),
    };
    Name {
        base: greek(base).unwrap_or(base).to_string(),
        below: below.to_string(),
        latex: None,
    }
}

/// The symbol with which an explanatory text begins (`$\alpha$ load factor`), the rest of it, and the unit at its end.
pub fn explained(text: &str) -> (Option<&str>, &str, Option<&str>) {
    let (symbol, rest) = match text.strip_prefix('$').and_then(|t| t.split_once('$')) {
        Some((symbol, rest)) => (Some(symbol), rest.trim_start()),
        None => (None, text),
    };
    match rest.strip_suffix(']').and_then(|t| t.rsplit_once('[')) {
        Some((words, unit)) => (symbol, words.trim_end(), Some(unit)),
        None => (symbol, rest, None),
    }
}

/// The name of a symbol, by its explanatory text if that begins with one.
pub fn symbol_name(symbols: &Symbols, s: SymbolId) -> Name {
    let symbol = symbols.get(s);
    let plain = name(&symbol.name);
    let Some(latex) = explained(&symbol.text).0 else {
        return plain;
    };
    // Indices behind the symbol are those of the reference.
    let base = latex.split('_').next().unwrap_or(latex).trim();
    let word = base.trim_start_matches('\\');
    Name {
        base: greek(word).unwrap_or(word).to_string(),
        below: String::new(),
        latex: Some(base.to_string()),
    }
}

/// Turns expressions into formulas.
pub struct Setter<'a> {
    /// All names and data.
    pub scope: Scope<'a>,
    f: &'a Formulation,
    /// Names of indices.
    pub names: Names<'a>,
}

mod level {
    pub(super) const LOGIC: u8 = 1;
    pub(super) const RELATION: u8 = 2;
    pub(super) const SUM: u8 = 3;
    pub(super) const PRODUCT: u8 = 4;
    pub(super) const ATOM: u8 = 6;
}

impl<'a> Setter<'a> {
    /// A setter for the formulas of a formulation.
    pub fn new(scope: Scope<'a>, f: &'a Formulation) -> Self {
        let taken: FxHashSet<String> = scope
            .symbols
            .iter()
            .map(|(_, s)| s.name.to_lowercase())
            .collect();
        Self {
            scope,
            f,
            names: Names::new(scope.symbols, &f.indices, taken),
        }
    }

    /// The name of a variable.
    pub fn variable(&self, v: Variable) -> Math {
        Math::Name(match v {
            Variable::Own(s) => symbol_name(self.scope.symbols, s),
            Variable::Multiplier(n) => {
                let text = &self.f.multipliers[n].name;
                match self.scope.symbols.find(text) {
                    Some(s) => symbol_name(self.scope.symbols, s),
                    None => name(text),
                }
            }
        })
    }

    fn own(&self, s: SymbolId) -> Math {
        Math::Name(symbol_name(self.scope.symbols, s))
    }

    fn indexed(&mut self, base: Math, key: &[Part]) -> Math {
        if key.is_empty() {
            return base;
        }
        let parts = key.iter().map(|p| self.part(p)).collect();
        Math::Indexed(Box::new(base), parts)
    }

    fn part(&mut self, p: &Part) -> Math {
        match p {
            Part::Index(k) => Math::Name(name(self.names.of(*k))),
            Part::Label(l) => Math::Quoted(self.scope.store.universe.name(*l).to_string()),
            Part::Singleton(s, _) => self.own(*s),
            Part::Lag(l) => {
                let base = self.part(&l.base);
                let (minus, offset) = match &l.offset {
                    Expr::Number(x) if *x < 0.0 => (true, Expr::Number(-x)),
                    Expr::Negate(e) => (true, (**e).clone()),
                    Expr::Sum(t) if t.iter().all(|t| t.0) => (true, negate(l.offset.clone())),
                    e => (false, e.clone()),
                };
                let operator = match (minus, l.circular) {
                    (false, false) => "+",
                    (true, false) => "−",
                    (false, true) => "⊕",
                    (true, true) => "⊖",
                };
                let offset = self.at(&offset, level::PRODUCT);
                Math::Row(vec![base, Math::Prefix(operator), offset])
            }
        }
    }

    /// An expression.
    pub fn expr(&mut self, e: &Expr) -> Math {
        self.at(e, 0)
    }

    fn at(&mut self, e: &Expr, place: u8) -> Math {
        let (m, mine) = self.plain(e);
        if mine < place {
            Math::Parentheses(Box::new(m))
        } else {
            m
        }
    }

    fn plain(&mut self, e: &Expr) -> (Math, u8) {
        use level::*;
        match e {
            Expr::Number(x) => {
                // Without the rounding of what was multiplied out: 0.2 · 0.2 is 0.04.
                let digits = match x.is_normal() {
                    true => format!("{x:.14e}").parse().unwrap_or(*x),
                    false => *x,
                };
                let text = shortest(digits).replace('-', "−");
                let mine = if text.starts_with('−') { SUM } else { ATOM };
                (Math::Number(text), mine)
            }
            Expr::Data(Source::Parameter(p), k) => {
                let base = self.own(*p);
                (self.indexed(base, k), ATOM)
            }
            Expr::Data(Source::Attribute(s, o), k) => {
                let base = self.own(*s);
                let base = match *o {
                    attribute::LO => Math::Bar(Box::new(base), false),
                    attribute::UP => Math::Bar(Box::new(base), true),
                    attribute::L => Math::Marked(Box::new(base), "*"),
                    o => Math::Marked(Box::new(base), attribute_word(o)),
                };
                (self.indexed(base, k), ATOM)
            }
            Expr::Data(Source::New(n), k) => {
                let base = Math::Name(name(&self.f.data[*n].name));
                (self.indexed(base, k), ATOM)
            }
            Expr::Member(s, k) => {
                let set = self.own(*s);
                (self.member(set, k), RELATION)
            }
            Expr::NewMember(n, k) => {
                let set = Math::Name(name(&self.f.data[*n].name));
                (self.member(set, k), RELATION)
            }
            Expr::Variable(v, k) => {
                let base = self.variable(*v);
                (self.indexed(base, k), ATOM)
            }
            Expr::Ord(_, p) => (Math::Function("ord", vec![self.part(p)]), ATOM),
            Expr::Card(s) => (Math::Absolute(Box::new(self.own(*s))), ATOM),
            Expr::SameAs(a, b) => {
                let (a, b) = (self.part(a), self.part(b));
                (Math::Row(vec![a, Math::Operator("="), b]), RELATION)
            }
            Expr::LabelAttribute(a, _, p) => {
                let word = match a {
                    LabelAttribute::Val => "val",
                    LabelAttribute::First => "first",
                    LabelAttribute::Last => "last",
                    LabelAttribute::Len => "len",
                    _ => "pos",
                };
                (Math::Function(word, vec![self.part(p)]), ATOM)
            }
            Expr::Negate(a) => {
                let a = self.at(a, PRODUCT);
                (Math::Row(vec![Math::Prefix("−"), a]), SUM)
            }
            Expr::Not(a) => {
                let a = self.at(a, RELATION + 1);
                (Math::Row(vec![Math::Prefix("¬"), a]), RELATION)
            }
            Expr::Sum(t) => {
                let mut row = Vec::new();
                for (n, (minus, e)) in t.iter().enumerate() {
                    match (n, minus) {
                        (0, false) => {}
                        (0, true) => row.push(Math::Prefix("−")),
                        (_, false) => row.push(Math::Operator("+")),
                        (_, true) => row.push(Math::Operator("−")),
                    }
                    row.push(self.at(e, PRODUCT));
                }
                (Math::Row(row), SUM)
            }
            Expr::Product(t) => self.product(t),
            Expr::Binary(BinaryOp::Power, a, b) => {
                let a = self.at(a, ATOM);
                let b = self.expr(b);
                (Math::Power(Box::new(a), Box::new(b)), ATOM - 1)
            }
            Expr::Binary(op, a, b) => {
                let (word, mine) = match op {
                    BinaryOp::And => ("∧", LOGIC),
                    BinaryOp::Or => ("∨", LOGIC),
                    BinaryOp::Xor => ("⊻", LOGIC),
                    BinaryOp::Implies => ("⇒", LOGIC),
                    BinaryOp::Equivalent => ("⇔", LOGIC),
                    BinaryOp::Eq => ("=", RELATION),
                    BinaryOp::Ne => ("≠", RELATION),
                    BinaryOp::Lt => ("<", RELATION),
                    BinaryOp::Le => ("≤", RELATION),
                    BinaryOp::Gt => (">", RELATION),
                    _ => ("≥", RELATION),
                };
                let (a, b) = (self.at(a, mine + 1), self.at(b, mine + 1));
                (Math::Row(vec![a, Math::Operator(word), b]), mine)
            }
            Expr::Call(f, args) => self.call(*f, args),
            Expr::DataCall(DataFunction::Pi, _) => (Math::Name(name("pi")), ATOM),
            Expr::DataCall(f, args) => {
                let args = args.iter().map(|a| self.expr(a)).collect();
                (Math::Function(f.name(), args), ATOM)
            }
            Expr::Dollar(a, c) => {
                let c = Math::Bracket(Box::new(self.expr(c)));
                match **a {
                    Expr::Number(1.0) => (c, ATOM),
                    _ => (Math::Row(vec![self.at(a, PRODUCT), c]), PRODUCT),
                }
            }
            Expr::Aggregate(op, d, e) => {
                let word = match op {
                    AggregateOp::Sum => "∑",
                    AggregateOp::Prod => "∏",
                    AggregateOp::Smin => "min",
                    AggregateOp::Smax => "max",
                    AggregateOp::Sand => "⋀",
                    AggregateOp::Sor => "⋁",
                };
                let before = self.names.enter(&d.indices);
                let under = self.domain(d);
                let body = self.at(e, PRODUCT);
                self.names.leave(before);
                (Math::Big(word, Box::new(under), Box::new(body)), PRODUCT)
            }
            Expr::Opaque(why) => (Math::Words(format!("[{why}]")), ATOM),
        }
    }

    fn member(&mut self, set: Math, key: &[Part]) -> Math {
        let parts: Vec<Math> = key.iter().map(|p| self.part(p)).collect();
        let tuple = match parts.len() {
            1 => parts.into_iter().next().unwrap_or(Math::Row(vec![])),
            _ => Math::Parentheses(Box::new(listed(parts))),
        };
        Math::Row(vec![tuple, Math::Operator("∈"), set])
    }

    fn product(&mut self, t: &[(bool, Expr)]) -> (Math, u8) {
        let divisors: Vec<&Expr> = t.iter().filter(|f| f.0).map(|f| &f.1).collect();
        let mut above: Vec<&Expr> = t.iter().filter(|f| !f.0).map(|f| &f.1).collect();
        // A sum at the end stands beside the fraction.
        let mut beside = Vec::new();
        if !divisors.is_empty() {
            while above.len() > 1 && matches!(above.last(), Some(Expr::Aggregate(..))) {
                beside.extend(above.pop());
            }
        }
        let row = |list: &[&Expr], s: &mut Self| {
            let only = list.len() == 1;
            let last = list.len().saturating_sub(1);
            let factors = list.iter().enumerate().map(|(n, e)| match e {
                _ if only => s.at(
                    e,
                    if divisors.is_empty() {
                        level::PRODUCT
                    } else {
                        0
                    },
                ),
                // A sum ends where its term ends: another factor behind it would be taken in.
                Expr::Aggregate(..) if n < last => Math::Parentheses(Box::new(s.expr(e))),
                e => s.at(e, level::PRODUCT),
            });
            let factors: Vec<Math> = factors.collect();
            match factors.len() {
                0 => Math::Number("1".into()),
                1 => factors.into_iter().next().unwrap_or(Math::Row(vec![])),
                _ => Math::Row(factors),
            }
        };
        let numerator = row(&above, self);
        if divisors.is_empty() {
            return (numerator, level::PRODUCT);
        }
        let denominator = row(&divisors, self);
        let mut out = vec![Math::Fraction(Box::new(numerator), Box::new(denominator))];
        while let Some(e) = beside.pop() {
            out.push(self.at(e, level::PRODUCT));
        }
        (Math::Row(out), level::PRODUCT)
    }

    fn call(&mut self, f: Function, args: &[Expr]) -> (Math, u8) {
        use level::*;
        let first = |place: u8, s: &mut Self| Box::new(s.at(&args[0], place));
        let power = |base: Box<Math>, p: Math| (Math::Power(base, Box::new(p)), ATOM - 1);
        match f {
            Function::Sqr => power(first(ATOM, self), Math::Number("2".into())),
            Function::Sqrt => (Math::Root(first(0, self)), ATOM),
            Function::Abs => (Math::Absolute(first(0, self)), ATOM),
            Function::EDist => {
                let parts = listed(args.iter().map(|a| self.expr(a)).collect());
                (Math::Norm(Box::new(parts)), ATOM)
            }
            Function::Power | Function::RPower | Function::VcPower | Function::CvPower => {
                let base = first(ATOM, self);
                power(base, self.expr(&args[1]))
            }
            Function::Exp => power(Box::new(Math::Name(name("e"))), self.expr(&args[0])),
            _ => {
                let word = match f {
                    Function::Log => "ln",
                    Function::ErrorF => "Φ",
                    f => f.name(),
                };
                let args = args.iter().map(|a| self.expr(a)).collect();
                (Math::Function(word, args), ATOM)
            }
        }
    }

    /// What a sum or a row runs over.
    pub fn domain(&mut self, d: &Binder) -> Math {
        let covers = |c: &Expr| match c {
            Expr::Member(_, k) | Expr::NewMember(_, k) => {
                d.indices.iter().all(|i| k.contains(&Part::Index(*i)))
            }
            _ => false,
        };
        let tuple = d.conditions.iter().position(covers);
        let mut out = match tuple {
            Some(t) => vec![self.expr(&d.conditions[t])],
            None => {
                let names = d
                    .indices
                    .iter()
                    .map(|k| Math::Name(name(self.names.of(*k))));
                vec![listed(names.collect())]
            }
        };
        let rest = d.conditions.iter().enumerate();
        for (n, (_, c)) in rest.filter(|(n, _)| Some(*n) != tuple).enumerate() {
            let first = n == 0 && tuple.is_none() && !d.indices.is_empty();
            out.push(Math::Operator(if first { ":" } else { "," }));
            out.push(self.expr(c));
        }
        Math::Row(out)
    }

    /// A row: the formula, and what it runs over if it has indices.
    pub fn row(&mut self, r: &Row) -> (Math, Option<Math>) {
        let before = self.names.enter(&r.binder.indices);
        let (left, right) = (self.expr(&r.left), self.expr(&r.right));
        let relation = Math::Operator(relation_sign(r.relation));
        let mut formula = vec![left, relation, right];
        if let (Some(v), None) = (r.pair, &self.f.objective) {
            formula.push(Math::Operator("⟂"));
            let base = self.variable(v);
            formula.push(self.indexed(base, &r.key));
        }
        let runs = match r.binder == Binder::default() {
            true => None,
            false => Some(self.domain(&r.binder)),
        };
        self.names.leave(before);
        (Math::Row(formula), runs)
    }
}

/// With commas between.
pub fn listed(parts: Vec<Math>) -> Math {
    let mut out = Vec::new();
    for (n, p) in parts.into_iter().enumerate() {
        if n > 0 {
            out.push(Math::Operator(","));
        }
        out.push(p);
    }
    Math::Row(out)
}
