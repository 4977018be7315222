//! A formulation as a model: statements of the language.

use super::data::{Data, Statements, head, number, quoted};
use super::names::Names;
use super::tree::*;
use super::{Formulation, NewData, Row, Scope, Sign};
use crate::check::functions::attribute_word;
use crate::check::node::{SymbolId, TableId};
use crate::check::symbols::{Store, Symbols};
use crate::data::input::Input;
use crate::data::table::Table;
use crate::report::names::join;
use rustc_hash::FxHashSet;
use std::fmt::Write;
use std::sync::Arc;

/// Writes expressions as statements of the language.
pub struct Writer<'a> {
    scope: Scope<'a>,
    f: &'a Formulation,
    /// Names of indices.
    pub names: Names<'a>,
    /// Whether attributes of the user's variables are parameters of the model (it stands alone).
    pub alone: bool,
    /// Tuple sets that sums around run over: these cannot be run over a second time.
    driving: Vec<String>,
}

/// Names that no new index may have, in lower case.
pub fn taken(symbols: &Symbols, f: &Formulation) -> FxHashSet<String> {
    let own = symbols.iter().map(|(_, s)| s.name.to_lowercase());
    let new = f.data.iter().map(|d| d.name.to_lowercase());
    let rows = f.rows.iter().map(|r| r.name.to_lowercase());
    let multipliers = f.multipliers.iter().map(|m| m.name.to_lowercase());
    own.chain(new).chain(rows).chain(multipliers).collect()
}

/// How tightly an operator binds.
mod level {
    pub(super) const OR: u8 = 1;
    pub(super) const AND: u8 = 2;
    pub(super) const NOT: u8 = 3;
    pub(super) const RELATION: u8 = 4;
    pub(super) const SUM: u8 = 5;
    pub(super) const PRODUCT: u8 = 6;
    pub(super) const POWER: u8 = 7;
    pub(super) const DOLLAR: u8 = 8;
    pub(super) const ATOM: u8 = 9;
}

/// The name of an attribute's parameter in a model that stands alone.
pub fn attribute_name(symbols: &Symbols, s: SymbolId, offset: u32) -> String {
    format!("{}_{}", symbols.get(s).name, attribute_word(offset))
}

impl<'a> Writer<'a> {
    /// A writer for the expressions of a formulation.
    pub fn new(scope: Scope<'a>, f: &'a Formulation, alone: bool) -> Self {
        Self {
            scope,
            f,
            names: Names::new(scope.symbols, &f.indices, taken(scope.symbols, f)),
            alone,
            driving: Vec::new(),
        }
    }

    fn name(&self, s: SymbolId) -> &'a str {
        &self.scope.get(s).name
    }

    /// The set of a membership.
    fn set_name(&self, e: &Expr) -> &str {
        match e {
            Expr::Member(s, _) => self.name(*s),
            Expr::NewMember(n, _) => &self.f.data[*n].name,
            _ => "",
        }
    }

    fn variable(&self, v: Variable) -> String {
        self.f.variable(self.scope.symbols, v)
    }
    fn part(&mut self, p: &Part) -> String {
        match p {
            Part::Index(k) => self.names.of(*k).to_string(),
            Part::Label(l) => quoted(self.scope.store.universe.name(*l)),
            Part::Singleton(s, _) => self.name(*s).to_string(),
            Part::Lag(l) => {
                let base = self.part(&l.base);
                let (sign, offset) = match &l.offset {
                    Expr::Number(x) if *x < 0.0 => ('-', Expr::Number(-x)),
                    Expr::Negate(e) => ('-', (**e).clone()),
                    e => ('+', e.clone()),
                };
                let offset = self.at(&offset, level::POWER);
                match l.circular {
                    true => format!("{base}{sign}{sign}{offset}"),
                    false => format!("{base}{sign}{offset}"),
                }
            }
        }
    }

    fn key(&mut self, key: &[Part]) -> String {
        if key.is_empty() {
            return String::new();
        }
        let mut parts: Vec<String> = Vec::new();
        for p in key {
            // A singleton stands for all its positions.
            if !matches!(p, Part::Singleton(_, n) if *n > 0) {
                parts.push(self.part(p));
            }
        }
        format!("({})", parts.join(","))
    }

    fn source(&self, s: Source, key: &str) -> String {
        match s {
            Source::Parameter(p) => format!("{}{key}", self.name(p)),
            Source::Attribute(v, offset) if self.alone => {
                format!("{}{key}", attribute_name(self.scope.symbols, v, offset))
            }
            Source::Attribute(v, offset) => {
                format!("{}.{}{key}", self.name(v), attribute_word(offset))
            }
            Source::New(n) => format!("{}{key}", self.f.data[n].name),
        }
    }

    /// An expression.
    pub fn expr(&mut self, e: &Expr) -> String {
        self.at(e, 0)
    }

    /// An expression, in parentheses if it binds less tightly than its place asks.
    fn at(&mut self, e: &Expr, place: u8) -> String {
        let (text, mine) = self.plain(e);
        if mine < place {
            format!("({text})")
        } else {
            text
        }
    }

    fn plain(&mut self, e: &Expr) -> (String, u8) {
        use level::*;
        match e {
            Expr::Number(x) => match number(*x) {
                t if t.starts_with('-') => (t, SUM),
                t => (t, ATOM),
            },
            Expr::Data(s, k) => {
                let key = self.key(k);
                (self.source(*s, &key), ATOM)
            }
            Expr::Member(s, k) => {
                let key = self.key(k);
                (format!("{}{key}", self.name(*s)), ATOM)
            }
            Expr::NewMember(n, k) => {
                let key = self.key(k);
                (format!("{}{key}", self.f.data[*n].name), ATOM)
            }
            Expr::Variable(v, k) => {
                let key = self.key(k);
                (format!("{}{key}", self.variable(*v)), ATOM)
            }
            Expr::Ord(_, p) => (format!("ord({})", self.part(p)), ATOM),
            Expr::Card(s) => (format!("card({})", self.name(*s)), ATOM),
            Expr::SameAs(a, b) => {
                let (a, b) = (self.part(a), self.part(b));
                (format!("sameas({a},{b})"), ATOM)
            }
            Expr::LabelAttribute(a, _, p) => {
                let p = self.part(p);
                (format!("{p}.{}", a.name()), ATOM)
            }
            Expr::Negate(a) => (format!("-{}", self.at(a, PRODUCT)), SUM),
            Expr::Not(a) => (format!("not {}", self.at(a, RELATION)), NOT),
            Expr::Sum(t) => (self.joined(t, PRODUCT, ["-", " + ", " - "]), SUM),
            Expr::Product(t) => (self.joined(t, POWER, ["1/", "*", "/"]), PRODUCT),
            Expr::Binary(op, a, b) => {
                let mine = match op {
                    BinaryOp::Power => POWER,
                    BinaryOp::And => AND,
                    BinaryOp::Or | BinaryOp::Xor => OR,
                    BinaryOp::Implies | BinaryOp::Equivalent => 0,
                    _ => RELATION,
                };
                let (a, b) = (self.at(a, mine + 1), self.at(b, mine + 1));
                match op.name() {
                    "**" => (format!("{a}**{b}"), mine),
                    word => (format!("{a} {word} {b}"), mine),
                }
            }
            Expr::Call(f, args) => {
                let args: Vec<String> = args.iter().map(|a| self.expr(a)).collect();
                (format!("{}({})", f.name(), args.join(",")), ATOM)
            }
            Expr::DataCall(f, args) => {
                let args: Vec<String> = args.iter().map(|a| self.expr(a)).collect();
                let word = f.name();
                match args.is_empty() {
                    true => (word.to_string(), ATOM),
                    false => (format!("{word}({})", args.join(",")), ATOM),
                }
            }
            Expr::Dollar(a, c) => {
                let (a, c) = (self.at(a, DOLLAR), self.expr(c));
                (format!("{a}$({c})"), DOLLAR)
            }
            Expr::Aggregate(op, d, e) => {
                let word = op.name();
                let before = (self.names.enter(&d.indices), self.driving.len());
                let domain = self.domain(d);
                let body = self.expr(e);
                self.names.leave(before.0);
                self.driving.truncate(before.1);
                (format!("{word}({domain}, {body})"), ATOM)
            }
            Expr::Opaque(why) => (format!("[{why}]"), ATOM),
        }
    }

    /// Terms with what stands before each: before the first if it is inverse, before another, before another that is inverse.
    fn joined(&mut self, terms: &[(bool, Expr)], inside: u8, signs: [&str; 3]) -> String {
        let mut out = String::new();
        for (n, (inverse, e)) in terms.iter().enumerate() {
            out.push_str(match (n, inverse) {
                (0, false) => "",
                (0, true) => signs[0],
                (_, false) => signs[1],
                (_, true) => signs[2],
            });
            let text = self.at(e, inside);
            out.push_str(&text);
        }
        out
    }

    /// `(i,j)$(…)`, `arc(i,j)$(…)`: what a sum runs over; its indices have names.
    fn domain(&mut self, d: &Binder) -> String {
        let covers = |c: &Expr| match c {
            Expr::Member(_, k) | Expr::NewMember(_, k) => {
                let plain = |p: &Part| matches!(p, Part::Index(_));
                let has = |i: &IndexId| k.contains(&Part::Index(*i));
                let free = !self.driving.iter().any(|d| d == self.set_name(c));
                free && k.len() > 1 && k.iter().all(plain) && d.indices.iter().all(has)
            }
            _ => false,
        };
        let tuple = d.conditions.iter().position(covers);
        if let Some(t) = tuple {
            let name = self.set_name(&d.conditions[t]).to_string();
            self.driving.push(name);
        }
        let head = match tuple {
            Some(t) => self.expr(&d.conditions[t]),
            None => {
                let indices = d.indices.iter();
                let names: Vec<&str> = indices.map(|k| self.names.of(*k)).collect();
                match names.as_slice() {
                    [one] => one.to_string(),
                    _ => format!("({})", names.join(",")),
                }
            }
        };
        let rest = d.conditions.iter().enumerate();
        let rest: Vec<Expr> = rest
            .filter(|(n, _)| Some(*n) != tuple)
            .map(|(_, c)| c.clone())
            .collect();
        match conjunction(rest) {
            None => head,
            Some(c) => format!("{head}${}", self.condition(&c)),
        }
    }

    /// A condition behind `$`.
    fn condition(&mut self, c: &Expr) -> String {
        format!("({})", self.expr(c))
    }

    /// The definition of a row.
    pub fn row(&mut self, r: &Row) -> String {
        let before = self.names.enter(&r.binder.indices);
        // Indices of the row that are in its key control it; others would be sums.
        let key = self.key(&r.key);
        let condition = conjunction(r.binder.conditions.clone());
        let condition = condition.map(|c| format!("${}", self.condition(&c)));
        let (left, right) = (self.expr(&r.left), self.expr(&r.right));
        self.names.leave(before);
        let relation = r.relation.name();
        let condition = condition.unwrap_or_default();
        format!(
            "{}{key}{condition}..\n   {left} {relation} {right};\n",
            r.name
        )
    }
}

/// The whole model as text. `include`: the file of the user's text, which is then included instead of its data; `solve`:
/// what stands behind the model.
pub fn model(
    scope: Scope,
    f: &Formulation,
    include: Option<&str>,
    head: &str,
    solve: bool,
    apart: Option<&mut Vec<Arc<Input>>>,
) -> String {
    let mut w = Writer::new(scope, f, include.is_none());
    let mut rows = String::new();
    for r in &f.rows {
        let _ = writeln!(rows, "{}", w.row(r));
    }
    let objective = f.objective.as_ref().map(|(sense, e)| (*sense, w.expr(e)));
    let mut equations: Vec<String> = f
        .rows
        .iter()
        .map(|r| declaration(scope.symbols, &r.name, &r.domain, &r.text))
        .collect();
    let mut free: Vec<String> = Vec::new();
    if let Some((_, e)) = &objective {
        let name = &f.objective_name;
        let _ = writeln!(rows, "{name}_row..\n   {name} =e= {e};\n");
        equations.push(format!("   {name}_row"));
        free.push(format!("   {name}"));
    }
    let mut start = String::new();
    for a in &f.start {
        let before = w.names.enter(&a.indices);
        let key: Vec<Part> = a.indices.iter().map(|k| Part::Index(*k)).collect();
        let key = w.key(&key);
        w.names.leave(before);
        let (target, word, data) = (&a.target, a.attribute, &a.data.name);
        let _ = writeln!(start, "{target}.{word}{key}${data}{key} = {data}{key};");
    }
    let mut data_text = Statements::new(scope, apart);
    data_text.text.push_str(head);
    match include {
        Some(file) => {
            let quote = if file.contains(' ') { "\"" } else { "" };
            let _ = writeln!(data_text.text, "$include {quote}{file}{quote}\n");
        }
        None => needed(scope, f, &w).statements(&mut data_text),
    }
    for (set, name) in &w.names.aliases {
        let root = &scope.get(*set).name;
        let _ = writeln!(data_text.text, "Alias ({root},{name});");
    }
    introduced(f).for_each(|d| data_text.introduced(d));
    let mut out = data_text.text;
    let list = |sign: Sign| variables(scope.symbols, f, sign, include.is_none());
    free.extend(list(Sign::Free));
    let mut declare = |word: &str, list: Vec<String>| {
        if !list.is_empty() {
            let _ = writeln!(out, "{word}\n{};\n", list.join("\n"));
        }
    };
    declare("Variables", free);
    declare("Positive variables", list(Sign::Positive));
    declare("Negative variables", list(Sign::Negative));
    declare("Equations", equations);
    out.push_str("* An index of a larger set stands for one of a smaller set under a condition that says so.\n$onUni\n\n");
    out.push_str(&rows);
    out.push_str("$offUni\n\n");
    let mut items: Vec<String> = Vec::new();
    for r in &f.rows {
        items.push(match (r.pair, f.objective.is_some()) {
            (Some(v), false) => format!("{}.{}", r.name, w.variable(v)),
            _ => r.name.clone(),
        });
    }
    if objective.is_some() {
        items.push(format!("{}_row", f.objective_name));
    }
    let _ = writeln!(out, "Model {} / {} /;\n", f.name, items.join(", "));
    out.push_str(&start);
    if let Some((sense, _)) = objective.filter(|_| solve) {
        let word = match sense {
            Sense::Minimize => "minimizing",
            Sense::Maximize => "maximizing",
        };
        let (name, z) = (&f.name, &f.objective_name);
        let _ = writeln!(out, "solve {name} using {} {word} {z};", f.using);
    } else if solve {
        let _ = writeln!(out, "solve {} using {};", f.name, f.using);
    }
    out
}

/// The data that a formulation introduces.
fn introduced(f: &Formulation) -> impl Iterator<Item = &NewData> {
    f.data.iter().chain(f.start.iter().map(|a| &a.data))
}

/// The user's data that a formulation reads and that are others elsewhere, by name.
pub fn changed<'t>(
    scope: Scope,
    f: &Formulation,
    other: &dyn Fn(TableId) -> Option<&'t Table>,
) -> Vec<String> {
    needed(scope, f, &Writer::new(scope, f, false)).changed(other)
}

/// What a formulation needs of the user's data.
fn needed<'a>(scope: Scope<'a>, f: &Formulation, w: &Writer) -> Data<'a> {
    let mut data = Data::new(scope);
    for &(set, _) in &w.names.aliases {
        data.set(set);
    }
    w.names.used.iter().for_each(|&s| data.set(s));
    f.rows.iter().for_each(|r| data.row(r));
    if let Some((_, e)) = &f.objective {
        data.expr(e);
    }
    let domains = introduced(f).map(|d| &d.domain);
    let domains = domains.chain(f.multipliers.iter().map(|m| &m.domain));
    domains.flatten().for_each(|s| data.set(*s));
    f.own.iter().for_each(|v| data.domain_of(*v));
    data
}

/// Declarations of the variables of a sign; `own`: the user's among them, with the kind that they were declared with,
/// discrete ones relaxed.
fn variables(symbols: &Symbols, f: &Formulation, sign: Sign, own: bool) -> Vec<String> {
    let is = |v: &&SymbolId| own && Sign::of(super::derive::kind(symbols, **v)) == sign;
    let mine = f.own.iter().filter(is).map(|v| {
        let s = symbols.get(*v);
        let domain = super::derive::domain_of(symbols, *v);
        declaration(symbols, &s.name, &domain, &s.text)
    });
    let new = f.multipliers.iter().filter(|m| m.sign == sign);
    let new = new.map(|m| declaration(symbols, &m.name, &m.domain, ""));
    mine.chain(new).collect()
}

fn declaration(symbols: &Symbols, name: &str, domain: &[SymbolId], text: &str) -> String {
    let text = match text.is_empty() {
        true => String::new(),
        false => format!(" {}", quoted(text)),
    };
    format!("   {}{text}", head(symbols, name, domain))
}

/// `x('a','b')`
pub fn record(store: &Store, name: &str, key: &[crate::data::universe::Label]) -> String {
    let labels: Vec<String> = key
        .iter()
        .map(|l| store.universe.name(*l).to_string())
        .collect();
    join(name, &labels)
}
