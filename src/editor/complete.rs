//! What may stand at a place.

use super::Editor;
use super::hover::{call_around, declaration};
use super::place::{Position, Range};
use super::project::Document;
use super::scan::{INNER_WORDS, Role};
use super::vocabulary::{self as words, Entry};
use crate::check::Program;
use crate::check::functions;
use crate::check::symbols::{DomainPosition, Symbol, SymbolKind};
use crate::solve::registry::{BACKENDS, OPTION_TABLES};
use crate::syntax::words::Class;
use serde::Serialize;

/// A word that may stand at a place.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Completion {
    /// The word.
    pub label: String,
    /// What it is.
    pub kind: CompletionKind,
    /// Its declaration, or how it is written.
    pub detail: String,
    /// What it means.
    pub documentation: String,
    /// What it replaces: what is written of it already.
    pub range: Range,
}

/// What a proposed word is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CompletionKind {
    /// A word of the language.
    Keyword,
    /// A function.
    Function,
    /// A set or an alias.
    Set,
    /// A parameter or a scalar.
    Parameter,
    /// A variable.
    Variable,
    /// An equation.
    Equation,
    /// A model.
    Model,
    /// A figure, a file, an acronym.
    Other,
    /// A label.
    Label,
    /// An attribute: `.l`.
    Attribute,
    /// A `$` directive.
    Directive,
    /// An option, or its value.
    Option,
}

/// Labels that are proposed.
const MOST_LABELS: usize = 1000;

pub(super) fn kind(s: &Symbol) -> CompletionKind {
    match s.kind {
        SymbolKind::Set { .. } | SymbolKind::Alias(_) => CompletionKind::Set,
        SymbolKind::Parameter { .. } => CompletionKind::Parameter,
        SymbolKind::Variable(_) => CompletionKind::Variable,
        SymbolKind::Equation(_) => CompletionKind::Equation,
        SymbolKind::Model(_) => CompletionKind::Model,
        SymbolKind::File(_) | SymbolKind::Acronym(_) | SymbolKind::Figure(_) => {
            CompletionKind::Other
        }
    }
}

struct List<'a> {
    out: Vec<Completion>,
    range: Range,
    programs: Vec<&'a Program>,
}

impl List<'_> {
    fn add(
        &mut self,
        label: impl Into<String>,
        kind: CompletionKind,
        detail: impl Into<String>,
        documentation: &str,
    ) {
        self.out.push(Completion {
            label: label.into(),
            kind,
            detail: detail.into(),
            documentation: documentation.to_owned(),
            range: self.range,
        });
    }

    fn entries(&mut self, list: &[Entry], kind: CompletionKind) {
        for e in list {
            self.add(e.word, kind, e.form, e.meaning);
        }
    }

    /// Attributes as GAMS spells them: `modelStat`.
    fn attributes(&mut self, list: &[Entry]) {
        for e in list {
            let label = e.form.split_once('.').map_or(e.word, |f| f.1);
            self.add(label, CompletionKind::Attribute, e.form, e.meaning);
        }
    }

    fn symbols(&mut self, wanted: impl Fn(&Symbol) -> bool) {
        let mut seen = Vec::new();
        for p in self.programs.clone() {
            for (_, s) in p.symbols.iter().skip(1) {
                let name = s.name.to_lowercase();
                if wanted(s) && !seen.contains(&name) {
                    seen.push(name);
                    self.add(&*s.name, kind(s), declaration(p, s), &s.text);
                }
            }
            // The last good program knows what half-typed text has lost.
            if seen.len() > 5000 {
                break;
            }
        }
    }

    /// Labels of an index position, or of all of them.
    fn labels(&mut self, symbol: &str, position: Option<usize>, quoted: bool) {
        for p in self.programs.clone() {
            let Some(s) = p.symbols.find(symbol).map(|s| p.symbols.get(s)) else {
                continue;
            };
            let positions: Vec<&DomainPosition> = match position {
                Some(n) => s.domain.get(n).into_iter().collect(),
                None => s.domain.iter().collect(),
            };
            for d in positions {
                match d {
                    DomainPosition::Set(id) => self.elements(p, p.symbols.get(*id), quoted),
                    _ => self.all_labels(p, quoted),
                }
            }
            return;
        }
    }

    fn elements(&mut self, p: &Program, set: &Symbol, quoted: bool) {
        let t = p.store.table(set.table);
        for r in 0..t.len().min(MOST_LABELS) as u32 {
            if let [label] = t.key(r) {
                let text = p.store.element_text(set.table, &[*label]).unwrap_or("");
                let detail = format!("element of {}", set.name);
                self.label(p.store.universe.name(*label), quoted, detail, text);
            }
        }
    }

    /// Labels of the set of that name.
    fn elements_of(&mut self, name: &str) {
        for p in self.programs.clone() {
            if let Some(s) = p.symbols.find(name).map(|s| p.symbols.get(s)) {
                if s.is_set() {
                    self.elements(p, s, false);
                }
                return;
            }
        }
    }

    fn all_labels(&mut self, p: &Program, quoted: bool) {
        for l in 0..p.store.universe.len().min(MOST_LABELS) as u32 {
            self.label(p.store.universe.name(l), quoted, "label".into(), "");
        }
    }

    fn label(&mut self, name: &str, quoted: bool, detail: String, text: &str) {
        let plain = name
            .chars()
            .all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '+'));
        let label = match quoted || plain {
            true => name.to_owned(),
            false => format!("'{name}'"),
        };
        self.add(label, CompletionKind::Label, detail, text);
    }
}

impl Editor {
    /// What may stand at a place, whatever is written of it already.
    pub fn completion(&self, file: &str, at: Position) -> Vec<Completion> {
        let Some(d) = self.document(file) else {
            return Vec::new();
        };
        let at = d.offset(at);
        // A label in data may have signs in it.
        let label = d.scan.token_at(at).map(|n| d.scan.tokens[n]);
        let label = label.filter(|t| t.data && t.role == Role::Label && t.lo < at);
        let from = label.map_or(0, |t| t.lo);
        let belongs = |c: char| match label {
            Some(_) => c.is_alphanumeric() || matches!(c, '_' | '-' | '+'),
            None => c.is_ascii_alphanumeric() || c == '_',
        };
        let end = d.text[from..at].rfind(|c| !belongs(c)).map(|n| from + n);
        let word = end.map_or(from, |n| {
            n + d.text[n..].chars().next().map_or(1, char::len_utf8)
        });
        let mut list = List {
            out: Vec::new(),
            range: d.range(word, at),
            programs: self
                .analysis(file)
                .map(|a| a.programs().collect())
                .unwrap_or_default(),
        };
        propose(&mut list, d, word, at);
        list.out.sort_by(|a, b| a.label.cmp(&b.label));
        list.out.dedup_by(|a, b| a.label == b.label);
        list.out
    }
}

fn propose(list: &mut List, d: &Document, word: usize, at: usize) {
    let line = d.text[..at].rfind('\n').map_or(0, |n| n + 1);
    let before = &d.text[line..word];
    // A directive's name.
    if before.trim_end() == "$" || before.trim_start() == "$$" {
        for e in words::DIRECTIVES {
            let label = e.form[1..].split_whitespace().next().unwrap_or(e.word);
            list.add(label, CompletionKind::Directive, e.form, e.meaning);
        }
        return;
    }
    let tokens = &d.scan.tokens;
    // Tokens that end before the word.
    let n = tokens.partition_point(|t| t.hi <= word && t.lo < word);
    let inside = tokens
        .get(n)
        .filter(|t| t.lo < word && word <= t.hi || t.lo < at && at < t.hi);
    let (inside, n) = match (inside, n.checked_sub(1)) {
        // A quote that is not closed, or whose end is here.
        (None, Some(b))
            if tokens[b].role == Role::Quoted && tokens[b].hi == at && !is_closed(d.word(b)) =>
        {
            (Some(&tokens[b]), b)
        }
        (inside, _) => (inside, n),
    };
    let role = inside.map(|t| t.role);
    if let Some(b) = n.checked_sub(1)
        && tokens[b].role == Role::Comment
        && d.text[tokens[b].hi.min(at)..at].chars().all(|c| c == ' ')
    {
        return;
    }
    match role {
        Some(Role::Comment | Role::Raw | Role::Text) => return,
        Some(Role::Quoted) => return in_quotes(list, d, n),
        _ => {}
    }
    let statement = d
        .scan
        .statement_at(word.saturating_sub(1).max(line))
        .filter(|s| s.first < n);
    let Some(statement) = statement else {
        return at_start(list);
    };
    let last = &tokens[n - 1];
    if last.role == Role::Dot && last.hi == word && statement.class != Class::Model && !last.data {
        return attributes(list, d, n);
    }
    let lists = statement.class.declares() && statement.class != Class::Equation
        || statement.class == Class::Model;
    if lists && in_declaration(list, d, statement.first, n, statement.class) {
        return;
    }
    let first = d.word(statement.first).to_lowercase();
    let previous = d.word(n - 1).to_lowercase();
    match first.as_str() {
        "solve" => return in_solve(list, &previous),
        "option" | "options" if matches!(previous.as_str(), "option" | "options" | ",") => {
            for t in functions::problem_types() {
                list.add(t, CompletionKind::Option, "option", "solver of the type");
            }
            for row in OPTION_TABLES.iter().flat_map(|t| t.all()) {
                let default = format!("default {}", row.default);
                list.add(row.name, CompletionKind::Option, default, row.meaning);
            }
            return;
        }
        "option" | "options"
            if previous == "="
                && n > 1
                && functions::problem_types().any(|t| t.eq_ignore_ascii_case(d.word(n - 2))) =>
        {
            for b in BACKENDS {
                list.add(b.about().name, CompletionKind::Option, "solver", "");
            }
            return;
        }
        "draw" => return list.symbols(|s| matches!(s.kind, SymbolKind::Figure(_))),
        "figure" if matches!(previous.as_str(), "{" | ";") => {
            for k in crate::check::figure_kinds() {
                list.add(k, CompletionKind::Keyword, "element of a figure", "");
            }
            return;
        }
        _ => {}
    }
    if last.role == Role::Semicolon {
        return at_start(list);
    }
    anything(list);
}

fn is_closed(word: &str) -> bool {
    word.len() > 1 && word.ends_with(&word[..1])
}

/// Where a statement begins.
fn at_start(list: &mut List) {
    list.entries(words::STATEMENTS, CompletionKind::Keyword);
    list.symbols(|_| true);
}

/// In an expression.
fn anything(list: &mut List) {
    list.symbols(|_| true);
    for e in words::FUNCTIONS {
        let label = e.form.split('(').next().unwrap_or(e.word);
        list.add(label, CompletionKind::Function, e.form, e.meaning);
    }
    for name in functions::names() {
        if !words::FUNCTIONS.iter().any(|e| e.word == name) {
            list.add(name, CompletionKind::Function, format!("{name}(…)"), "");
        }
    }
    for w in INNER_WORDS {
        match words::INNER.iter().find(|e| e.word == *w) {
            Some(e) => list.add(*w, CompletionKind::Keyword, e.form, e.meaning),
            None => list.add(*w, CompletionKind::Keyword, "", ""),
        }
    }
    for e in words::INNER.iter().filter(|e| e.word.starts_with('=')) {
        list.add(e.word, CompletionKind::Keyword, e.form, e.meaning);
    }
}

/// Between quotes: a label where an index stands.
fn in_quotes(list: &mut List, d: &Document, token: usize) {
    let t = &d.scan.tokens[token];
    // What is between the quotes is replaced.
    let end = if is_closed(d.word(token)) {
        t.hi - 1
    } else {
        t.hi
    };
    list.range = d.range(t.lo + 1, end);
    if t.data {
        return in_data(list, d, token);
    }
    match call_around(d, t.lo) {
        Some((name, position)) => list.labels(d.word(name), Some(position), true),
        None => {
            if let Some(p) = list.programs.first().copied() {
                list.all_labels(p, true);
            }
        }
    }
}

/// In the data or the table of the symbol declared last before a token.
fn in_data(list: &mut List, d: &Document, token: usize) {
    let declared = d.scan.tokens[..token]
        .iter()
        .rposition(|t| t.role == Role::Declared);
    if let Some(n) = declared {
        list.labels(d.word(n), None, false);
    }
}

fn attributes(list: &mut List, d: &Document, n: usize) {
    let name = n.checked_sub(2).map_or("", |n| d.word(n));
    let known = list
        .programs
        .iter()
        .find_map(|p| p.symbols.find(name).map(|s| p.symbols.get(s).kind.clone()));
    match known {
        Some(SymbolKind::Model(_)) => list.attributes(words::MODEL_ATTRIBUTES),
        Some(SymbolKind::Set { .. } | SymbolKind::Alias(_)) => {
            list.attributes(words::LABEL_ATTRIBUTES)
        }
        _ => list.attributes(words::RECORD_ATTRIBUTES),
    }
}

/// In a declaration; whether anything was proposed that is not an expression.
fn in_declaration(list: &mut List, d: &Document, first: usize, n: usize, class: Class) -> bool {
    let tokens = &d.scan.tokens;
    let declared = tokens[first..n]
        .iter()
        .rposition(|t| t.role == Role::Declared)
        .map(|k| first + k);
    let Some(declared) = declared else {
        return true;
    };
    let since = &tokens[declared..n];
    let slashes = since.iter().filter(|t| t.role == Role::Slash).count();
    let opens = since.iter().filter(|t| t.role == Role::Open).count();
    let closes = since.iter().filter(|t| t.role == Role::Close).count();
    if class == Class::Model {
        if slashes % 2 == 1 {
            let pair = tokens[n - 1].role == Role::Dot;
            list.symbols(|s| match s.kind {
                SymbolKind::Variable(_) => pair,
                SymbolKind::Equation(_) | SymbolKind::Model(_) => !pair,
                _ => false,
            });
            list.add(
                "all",
                CompletionKind::Keyword,
                "Model m / all /;",
                "All equations declared so far.",
            );
        }
    } else if slashes % 2 == 1 || class == Class::Table && opens == closes {
        let before = list.out.len();
        list.labels(d.word(declared), None, false);
        if list.out.len() == before {
            // Not known yet: the domain as it stands in the text.
            let words = declared + 1..n;
            let in_domain = words.take_while(|&t| tokens[t].role != Role::Close);
            for t in in_domain.filter(|&t| tokens[t].role != Role::Open) {
                list.elements_of(d.word(t));
            }
        }
    } else if opens > closes {
        list.symbols(Symbol::is_set);
    }
    true
}

fn in_solve(list: &mut List, previous: &str) {
    let is = |p: &[&str]| p.iter().any(|p| previous.starts_with(p));
    match previous {
        "solve" => list.symbols(|s| matches!(s.kind, SymbolKind::Model(_))),
        _ if previous.starts_with("us") => {
            for t in functions::problem_types() {
                list.add(t, CompletionKind::Keyword, "problem type", "");
            }
        }
        _ if is(&["min", "max"]) => {
            list.symbols(|s| matches!(s.kind, SymbolKind::Variable(_)) && s.dim() == 0)
        }
        _ => {
            for w in ["using", "minimizing", "maximizing", "scenario"] {
                if let Some(e) = words::INNER.iter().find(|e| e.word == w) {
                    list.add(w, CompletionKind::Keyword, e.form, e.meaning);
                }
            }
        }
    }
}
