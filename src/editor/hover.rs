//! What a word is: the declaration, text, domain and values of a symbol, the meaning of a word of the language.

use super::Editor;
use super::navigate::Subject;
use super::place::{Position, Range};
use super::project::Document;
use super::scan::Role;
use super::vocabulary::{self as words, Entry};
use crate::check::Program;
use crate::check::functions;
use crate::check::symbols::{Symbol, SymbolKind, attribute};
use crate::data::table::Table;
use crate::data::value;
use crate::syntax::ast::VariableKind;
use serde::Serialize;
use std::fmt::Write;

/// What is known about a word, in Markdown.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Hover {
    /// The word.
    pub range: Range,
    /// Markdown.
    pub contents: String,
}

/// What is being written between parentheses.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Signature {
    /// `price(i,j)`
    pub label: String,
    /// What it means.
    pub documentation: String,
    /// The parts of the label, by UTF-16 units.
    pub parameters: Vec<(u32, u32)>,
    /// Which of them is being written.
    pub active: u32,
}

/// Records of data that are shown.
const SHOWN: usize = 12;

/// A number as a user writes it.
fn number(x: f64, p: &Program) -> String {
    if let Some(n) = value::as_acronym(x) {
        return p
            .store
            .acronyms
            .get(n as usize)
            .map_or_else(|| "?".into(), |a| a.to_string());
    }
    match x {
        _ if value::is_eps(x) => "eps".into(),
        _ if value::is_na(x) => "na".into(),
        _ if value::is_undf(x) => "undf".into(),
        f64::INFINITY => "inf".into(),
        f64::NEG_INFINITY => "-inf".into(),
        _ => format!("{x}"),
    }
}

fn kind(s: &Symbol) -> String {
    let name = match s.kind {
        SymbolKind::Set { singleton: true } => "singleton set".into(),
        SymbolKind::Variable(VariableKind::Unstated) => "free variable".into(),
        SymbolKind::Variable(k) => format!("{} variable", k.name()),
        _ => s.kind_name().to_string(),
    };
    name[..1].to_uppercase() + &name[1..]
}

/// A symbol as it would be declared: `Parameter price(i,j) 'per ton'`.
pub(super) fn declaration(p: &Program, s: &Symbol) -> String {
    let domain = p.symbols.domain_names(s).join(",");
    let mut out = format!("{} {}", kind(s), s.name);
    if !domain.is_empty() {
        let _ = write!(out, "({domain})");
    }
    if !s.text.is_empty() {
        let _ = write!(out, " '{}'", s.text);
    }
    out
}

/// The first records of a table.
fn records(p: &Program, t: &Table, with_values: bool) -> String {
    let mut parts = Vec::new();
    for r in 0..t.len().min(SHOWN) as u32 {
        let key: Vec<&str> = t.key(r).iter().map(|l| p.store.universe.name(*l)).collect();
        let key = key.join(".");
        parts.push(match (with_values, key.is_empty()) {
            (true, true) => number(t.value(r), p),
            (true, false) => format!("{key} {}", number(t.value(r), p)),
            _ => key,
        });
    }
    if t.len() > SHOWN {
        parts.push(format!("… ({} in all)", t.len()));
    }
    parts.join(", ")
}

/// What is known about a symbol, in Markdown.
pub(super) fn symbol(p: &Program, s: &Symbol) -> String {
    let mut out = format!("```bmod\n{}\n```\n", declaration(p, s));
    let data = || p.store.table(s.table);
    match &s.kind {
        SymbolKind::Set { .. } | SymbolKind::Alias(_) => {
            if let SymbolKind::Alias(of) = s.kind {
                let _ = writeln!(out, "alias of `{}`\n", p.symbols.get(of).name);
            }
            match data().len() {
                0 if s.assigned => out.push_str("assigned when the model runs"),
                0 => out.push_str("no elements"),
                n => {
                    let s = if n == 1 { "" } else { "s" };
                    let _ = write!(out, "{n} element{s}: {}", records(p, data(), false));
                }
            }
        }
        SymbolKind::Parameter { scalar } => match data().len() {
            0 if s.assigned => out.push_str("assigned when the model runs"),
            0 if s.has_data => out.push('0'),
            0 => out.push_str("no values"),
            n => {
                if !scalar && s.dim() > 0 {
                    let _ = write!(out, "{n} record{}: ", if n == 1 { "" } else { "s" });
                }
                out.push_str(&records(p, data(), true));
                if s.assigned {
                    out.push_str("; assigned when the model runs");
                }
            }
        },
        SymbolKind::Variable(_) => {
            let part = |(name, a)| {
                let t = p.store.table(s.table + a);
                (!t.is_empty()).then(|| format!(".{name}: {}", records(p, t, true)))
            };
            let all = [
                ("lo", attribute::LO),
                ("up", attribute::UP),
                ("l", attribute::L),
            ];
            let parts: Vec<String> = all.into_iter().filter_map(part).collect();
            out.push_str(&parts.join("\n\n"));
        }
        SymbolKind::Equation(None) => out.push_str("not defined yet"),
        SymbolKind::Equation(Some(n)) => {
            if let Some(e) = p.equations.get(*n) {
                let text = p.map.text(e.span).trim();
                let _ = write!(out, "```bmod\n{text};\n```");
            }
        }
        SymbolKind::File(path) if !path.is_empty() => {
            let _ = write!(out, "writes `{path}`");
        }
        _ => {}
    }
    out
}

fn entry(e: &Entry) -> String {
    format!("```bmod\n{}\n```\n{}", e.form, e.meaning)
}

impl Editor {
    /// What stands at a place: a symbol with its declaration, text and values, a label with its sets, a word of the language.
    pub fn hover(&self, file: &str, at: Position) -> Option<Hover> {
        if let Some((range, contents)) = self.substitution_text(file, at) {
            return Some(Hover { range, contents });
        }
        let d = self.document(file)?;
        let token = d.scan.token_at(d.offset(at))?;
        let word = d.word(token);
        let range = d.token_range(token);
        let known = match d.scan.tokens[token].role {
            Role::Keyword => words::find(words::STATEMENTS, word)
                .or_else(|| words::find(words::INNER, word))
                .map(entry),
            Role::Operator => words::find(words::INNER, word).map(entry),
            Role::Directive => {
                let name = word.trim_start_matches(['$', ' ']);
                let exact = words::DIRECTIVES
                    .iter()
                    .find(|e| e.word.eq_ignore_ascii_case(name));
                exact.map(entry)
            }
            Role::Attribute => self.attribute(file, d, token),
            _ => None,
        };
        let contents = known.or_else(|| match d.subject(token)? {
            Subject::Symbol(name) => self
                .symbol_contents(file, &name)
                .or_else(|| function(&name)),
            Subject::Label(name) => self.label(file, &name),
        })?;
        Some(Hover { range, contents })
    }

    fn symbol_contents(&self, file: &str, name: &str) -> Option<String> {
        self.known(file, name).map(|(p, s)| symbol(p, s))
    }

    fn attribute(&self, file: &str, d: &Document, token: usize) -> Option<String> {
        let word = d.word(token);
        let of = token.checked_sub(2).map(|t| d.word(t).to_lowercase())?;
        let list: &[&'static [Entry]] = match self.known(file, &of).map(|(_, s)| &s.kind) {
            Some(SymbolKind::Model(_)) => &[words::MODEL_ATTRIBUTES],
            Some(SymbolKind::Set { .. } | SymbolKind::Alias(_)) => &[words::LABEL_ATTRIBUTES],
            _ => &[
                words::RECORD_ATTRIBUTES,
                words::MODEL_ATTRIBUTES,
                words::LABEL_ATTRIBUTES,
            ],
        };
        let exact = list
            .iter()
            .flat_map(|l| l.iter())
            .find(|e| e.word.eq_ignore_ascii_case(word));
        exact.map(entry)
    }

    /// The sets that have a label, and its texts.
    fn label(&self, file: &str, name: &str) -> Option<String> {
        let p = self
            .analysis(file)?
            .programs()
            .find(|p| p.store.universe.get(name).is_some())?;
        let label = p.store.universe.get(name)?;
        let mut out = String::new();
        for (_, s) in p.symbols.iter().skip(1) {
            if !matches!(s.kind, SymbolKind::Set { .. })
                || s.dim() != 1
                || p.store.table(s.table).find(&[label]).is_none()
            {
                continue;
            }
            let _ = write!(out, "element of `{}`", s.name);
            if let Some(text) = p.store.element_text(s.table, &[label]) {
                let _ = write!(out, ": {text}");
            }
            out.push_str("\n\n");
        }
        (!out.is_empty()).then(|| format!("`'{name}'`\n\n{}", out.trim_end()))
    }

    /// What is being written between the parentheses around a place: a function with its arguments, a symbol with its
    /// domain.
    pub fn signature(&self, file: &str, at: Position) -> Option<Signature> {
        let d = self.document(file)?;
        let (token, position) = call_around(d, d.offset(at))?;
        let name = d.word(token).to_lowercase();
        let known = self.known(file, &name).map(|(p, s)| {
            let domain = p.symbols.domain_names(s);
            let label = format!("{}({})", s.name, domain.join(","));
            (label, declaration(p, s))
        });
        let (label, documentation) = known.or_else(|| {
            let all = words::FUNCTIONS.iter().chain(words::INNER);
            let e = all
                .into_iter()
                .find(|e| e.word == name && e.form.contains('('))?;
            Some((e.form.to_owned(), e.meaning.to_owned()))
        })?;
        let parameters = parts(&label);
        if parameters.is_empty() {
            return None;
        }
        let active = position.min(parameters.len() - 1) as u32;
        Some(Signature {
            label,
            documentation,
            parameters,
            active,
        })
    }
}

/// Functions without an entry: their name and how many arguments they take.
fn function(name: &str) -> Option<String> {
    if let Some(e) = words::FUNCTIONS.iter().find(|e| e.word == name) {
        return Some(entry(e));
    }
    let (_, least, most) = functions::callee(name)?;
    let how_many = match (least, most) {
        (0, 0) => "no arguments".to_owned(),
        (1, 1) => "1 argument".to_owned(),
        (a, b) if a == b => format!("{a} arguments"),
        (a, usize::MAX) => format!("{a} arguments or more"),
        (a, b) => format!("{a} to {b} arguments"),
    };
    Some(format!("```bmod\n{name}(…)\n```\na function of {how_many}"))
}

/// The name before the innermost open parenthesis around a byte, and how many commas stand between.
pub(super) fn call_around(d: &Document, at: usize) -> Option<(usize, usize)> {
    let tokens = &d.scan.tokens;
    let mut n = tokens.partition_point(|t| t.hi <= at && t.lo < at);
    let mut depth = 0usize;
    let mut commas = 0;
    while n > 0 {
        n -= 1;
        match tokens[n].role {
            Role::Close => depth += 1,
            Role::Open if depth > 0 => depth -= 1,
            Role::Open => {
                let before = n.checked_sub(1)?;
                return match tokens[before].role {
                    Role::Name | Role::Declared | Role::Defined | Role::Keyword => {
                        Some((before, commas))
                    }
                    // `x.l(` : the symbol.
                    Role::Attribute => before.checked_sub(2).map(|n| (n, commas)),
                    _ => None,
                };
            }
            Role::Comma if depth == 0 => commas += 1,
            Role::Semicolon => return None,
            _ => {}
        }
    }
    None
}

/// The parts between the first parenthesis and the last, by UTF-16 units.
fn parts(label: &str) -> Vec<(u32, u32)> {
    let (Some(open), Some(close)) = (label.find('('), label.rfind(')')) else {
        return Vec::new();
    };
    let units = |to: usize| label[..to].encode_utf16().count() as u32;
    let mut out = Vec::new();
    let mut depth = 0usize;
    let mut from = open + 1;
    for (n, c) in label[open + 1..close].char_indices() {
        let n = open + 1 + n;
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => {
                out.push((from, n));
                from = n + 1;
            }
            _ => {}
        }
    }
    if close > open + 1 {
        out.push((from, close));
    }
    let trim = |(lo, hi): (usize, usize)| {
        let part = &label[lo..hi];
        let lo = hi - part.trim_start().len();
        (units(lo), units(lo + part.trim().len()))
    };
    out.into_iter().map(trim).collect()
}
