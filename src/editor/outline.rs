//! What a text consists of: symbols and solves, blocks to fold, the kind of each word, lenses.

use super::Editor;
use super::complete::{CompletionKind, kind};
use super::lines::{LineKind, directive};
use super::place::Range;
use super::project::Document;
use super::scan::{Role, Statement};
use super::vocabulary;
use crate::check::functions;
use crate::source::Marks;
use crate::syntax::words::Class;
use rustc_hash::FxHashMap;
use serde::Serialize;

/// A symbol, a solve, or a figure in the outline.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct OutlineItem {
    /// The name; of a solve the statement.
    pub name: String,
    /// The statement's keyword.
    pub detail: String,
    /// What it is.
    pub kind: CompletionKind,
    /// The whole.
    pub range: Range,
    /// The name.
    #[serde(rename = "selectionRange")]
    pub selection: Range,
}

/// Lines that can be folded.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Fold {
    /// First line, from 0.
    #[serde(rename = "startLine")]
    pub start: u32,
    /// Last line.
    #[serde(rename = "endLine")]
    pub end: u32,
    /// What they are.
    pub kind: FoldKind,
}

/// What folded lines are.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FoldKind {
    /// Comments.
    Comment,
    /// A statement, or lines between directives.
    Region,
}

/// A word with its kind, for highlighting.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub struct Token {
    /// Line from 0.
    pub line: u32,
    /// UTF-16 units before it in its line.
    pub character: u32,
    /// UTF-16 units that it has.
    pub length: u32,
    /// Its kind: place in [`TOKEN_KINDS`].
    pub kind: u32,
}

/// The kinds of words, in names of the language server protocol: sets are types, equations are methods, models classes,
/// labels are members of enumerations, explanatory texts and directives have names of their own.
#[rustfmt::skip]
pub const TOKEN_KINDS: &[&str] = &[
    "comment", "macro", "keyword", "type", "parameter", "variable", "method", "class", "function",
    "number", "string", "enumMember", "property", "operator",
];

/// Something to do with a statement.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Lens {
    /// The statement's first line.
    pub range: Range,
    /// What it says.
    pub title: &'static str,
    /// What it does: `bmod.run`, `bmod.why`.
    pub command: &'static str,
}

fn statement_kind(s: &Statement, word: &str) -> CompletionKind {
    match s.class {
        Class::Set | Class::Alias => CompletionKind::Set,
        Class::Parameter | Class::Table => CompletionKind::Parameter,
        Class::Variable => CompletionKind::Variable,
        Class::Equation => CompletionKind::Equation,
        Class::Model => CompletionKind::Model,
        _ if word == "solve" => CompletionKind::Function,
        _ => CompletionKind::Other,
    }
}

impl Document {
    fn statement_range(&self, s: &Statement) -> Range {
        let tokens = &self.scan.tokens;
        let last = s.end.clamp(s.first + 1, tokens.len()) - 1;
        self.range(tokens[s.first].lo, tokens[last].hi)
    }
}

impl Editor {
    /// Declarations, definitions of equations, solves and figures, in the order of the text.
    pub fn outline(&self, file: &str) -> Vec<OutlineItem> {
        let Some(d) = self.document(file) else {
            return Vec::new();
        };
        let mut out = Vec::new();
        for s in &d.scan.statements {
            let tokens = s.first..s.end.min(d.scan.tokens.len());
            let word = d.word(s.first).to_lowercase();
            let kind = statement_kind(s, &word);
            let mut add = |name: String, token: usize, range: Range, detail: &str| {
                out.push(OutlineItem {
                    name,
                    detail: detail.to_owned(),
                    kind,
                    range,
                    selection: d.token_range(token),
                });
            };
            match s.class {
                _ if s.class.declares() && d.scan.tokens[s.first].role == Role::Keyword => {
                    let declared = |t: &usize| d.scan.tokens[*t].role == Role::Declared;
                    let names: Vec<usize> = tokens.clone().filter(declared).collect();
                    for (n, &t) in names.iter().enumerate() {
                        let end = names.get(n + 1).copied().unwrap_or(tokens.end).max(t + 1) - 1;
                        let range = d.range(d.scan.tokens[t].lo, d.scan.tokens[end.max(t)].hi);
                        add(d.word(t).to_owned(), t, range, &word);
                    }
                }
                Class::Equation if d.scan.tokens[s.first].role == Role::Defined => {
                    let name = format!("{}..", d.word(s.first));
                    add(name, s.first, d.statement_range(s), "definition");
                }
                Class::Other if matches!(word.as_str(), "solve" | "figure") && tokens.len() > 1 => {
                    let words = tokens.map(|t| d.word(t)).filter(|w| *w != ";");
                    let names: Vec<&str> = match word.as_str() {
                        "solve" => words.collect(),
                        _ => vec![d.word(s.first + 1)],
                    };
                    let named = s.first + usize::from(word == "figure");
                    add(names.join(" "), named, d.statement_range(s), &word);
                }
                _ => {}
            }
        }
        out
    }

    /// Statements over several lines, comments, and what stands between directives.
    pub fn folds(&self, file: &str) -> Vec<Fold> {
        let Some(d) = self.document(file) else {
            return Vec::new();
        };
        let mut out = Vec::new();
        let mut add = |start: usize, end: usize, kind| {
            if end > start {
                out.push(Fold {
                    start: start as u32,
                    end: end as u32,
                    kind,
                });
            }
        };
        let lines = &d.scan.lines;
        for s in &d.scan.statements {
            let r = d.statement_range(s);
            add(r.start.line as usize, r.end.line as usize, FoldKind::Region);
        }
        let mut comment: Option<usize> = None;
        let mut open: Vec<usize> = Vec::new();
        for (n, k) in lines.kinds.iter().enumerate() {
            match (k, comment) {
                (LineKind::Comment | LineKind::Raw, None) => comment = Some(n),
                (LineKind::Comment | LineKind::Raw, Some(_)) => {}
                (_, Some(first)) => {
                    add(first, n - 1, FoldKind::Comment);
                    comment = None;
                }
                _ => {}
            }
            if *k == LineKind::Directive {
                let r = lines.range(n, &d.text);
                let word = directive(&d.text[r.lo..r.hi], &Marks::new(false));
                let word = word.map(|w| w.0).unwrap_or_default();
                if word.starts_with("ifthen") {
                    open.push(n);
                } else if word == "endif"
                    && let Some(first) = open.pop()
                {
                    add(first, n, FoldKind::Region);
                }
            }
        }
        if let Some(first) = comment {
            let last = lines.kinds.len().saturating_sub(1);
            add(first, last, FoldKind::Comment);
        }
        out.sort_by_key(|f| (f.start, std::cmp::Reverse(f.end)));
        out.dedup_by_key(|f| f.start);
        out
    }

    /// The kind of each word, in the order of the text, for highlighting.
    pub fn tokens(&self, file: &str) -> Vec<Token> {
        let Some(d) = self.document(file) else {
            return Vec::new();
        };
        let mut kinds: FxHashMap<String, CompletionKind> = FxHashMap::default();
        for p in self.analysis(file).into_iter().flat_map(|a| a.programs()) {
            for (_, s) in p.symbols.iter().skip(1) {
                let known = kinds.entry(s.name.to_lowercase());
                known.or_insert_with(|| kind(s));
            }
        }
        for s in &d.scan.statements {
            for t in s.first..s.end.min(d.scan.tokens.len()) {
                if d.scan.tokens[t].role == Role::Declared {
                    let kind = statement_kind(s, "");
                    kinds.insert(d.word(t).to_lowercase(), kind);
                }
            }
        }
        let mut out = Vec::new();
        for (n, t) in d.scan.tokens.iter().enumerate() {
            let Some(name) = token_kind(d, n, &kinds) else {
                continue;
            };
            let range = d.range(t.lo, t.hi);
            let kind = TOKEN_KINDS.iter().position(|k| *k == name).unwrap_or(0) as u32;
            out.push(Token {
                line: range.start.line,
                character: range.start.character,
                length: range.end.character.saturating_sub(range.start.character),
                kind,
            });
        }
        out
    }

    /// Something to do with statements: a model can be run at its solves, and asked why.
    pub fn lenses(&self, file: &str) -> Vec<Lens> {
        let Some(d) = self.document(file) else {
            return Vec::new();
        };
        let statements = d.scan.statements.iter();
        let solves = statements.filter(|s| d.word(s.first).eq_ignore_ascii_case("solve"));
        let both = |range| {
            [("Run", "bmod.run"), ("Why", "bmod.why")].map(|(title, command)| Lens {
                range,
                title,
                command,
            })
        };
        solves.flat_map(|s| both(d.token_range(s.first))).collect()
    }
}

fn token_kind(
    d: &Document,
    n: usize,
    kinds: &FxHashMap<String, CompletionKind>,
) -> Option<&'static str> {
    Some(match d.scan.tokens[n].role {
        Role::Comment => "comment",
        Role::Directive => "macro",
        Role::Raw
            if d.scan.lines.kinds[d.scan.lines.line_of(d.scan.tokens[n].lo)] == LineKind::Raw =>
        {
            "comment"
        }
        Role::Raw => "string",
        Role::Keyword => "keyword",
        Role::Number => "number",
        Role::Quoted | Role::Text => "string",
        Role::Label => "enumMember",
        Role::Attribute => "property",
        Role::Operator => "operator",
        Role::Name | Role::Declared | Role::Defined | Role::Argument => {
            let name = d.word(n).to_lowercase();
            match kinds.get(&name) {
                Some(CompletionKind::Set) => "type",
                Some(CompletionKind::Parameter) => "parameter",
                Some(CompletionKind::Variable) => "variable",
                Some(CompletionKind::Equation) => "method",
                Some(_) => "class",
                None if functions::callee(&name).is_some() => "function",
                None if vocabulary::INNER.iter().any(|e| e.word == name) => "keyword",
                None => return None,
            }
        }
        Role::Open | Role::Close | Role::Comma | Role::Semicolon | Role::Slash | Role::Dot => {
            return None;
        }
    })
}
