//! Where a name is declared and used, and another name for it.

use super::Editor;
use super::place::{Location, Position, Range};
use super::project::Document;
use super::scan::Role;
use crate::check::functions;
use crate::syntax::words;
use serde::Serialize;

/// A change of a text.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Edit {
    /// The file.
    pub file: String,
    /// The piece that is replaced.
    pub range: Range,
    /// What stands there instead.
    #[serde(rename = "newText")]
    pub new_text: String,
}

/// Why a name cannot be changed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RenameError {
    /// There is no symbol at this place.
    NoSymbol,
    /// The new name is none, or a word of the language.
    NotAName(String),
    /// There is a symbol of this name.
    Taken(String),
}

impl std::fmt::Display for RenameError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoSymbol => f.write_str("there is no symbol here"),
            Self::NotAName(n) => write!(
                f,
                "`{n}` is no name: a letter, then letters, digits and `_`, and no word of the language"
            ),
            Self::Taken(n) => write!(f, "there is a symbol `{n}` already"),
        }
    }
}

/// What stands at a place.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Subject {
    /// A symbol, in lower case.
    Symbol(String),
    /// A label.
    Label(String),
}

/// What stands between the quotes of a word that has two; a quote may be open while a person types.
fn between_quotes(word: &str) -> Option<&str> {
    let quote = word.chars().next()?;
    let inside = word.strip_prefix(quote)?.strip_suffix(quote)?;
    (!inside.is_empty()).then_some(inside)
}

impl Document {
    /// The symbol or label that a token names.
    pub(super) fn subject(&self, token: usize) -> Option<Subject> {
        let word = self.word(token);
        match self.scan.tokens[token].role {
            Role::Name | Role::Declared | Role::Defined | Role::Argument
                if words::is_letter(*word.as_bytes().first()?) =>
            {
                Some(Subject::Symbol(word.to_lowercase()))
            }
            // In data an unquoted word is a label, a quoted one a label or a text.
            Role::Label => Some(Subject::Label(word.to_owned())),
            Role::Quoted => between_quotes(word).map(|l| Subject::Label(l.to_owned())),
            _ => None,
        }
    }

    /// The pieces where a symbol or label is named. With a `*=` a comment claims something about symbols.
    fn mentions(&self, subject: &Subject) -> Vec<(usize, usize, bool)> {
        let mut out = Vec::new();
        let (name, is_symbol) = match subject {
            Subject::Symbol(n) => (n.as_str(), true),
            Subject::Label(n) => (n.as_str(), false),
        };
        for (n, t) in self.scan.tokens.iter().enumerate() {
            let declares = matches!(t.role, Role::Declared | Role::Defined);
            match t.role {
                Role::Name | Role::Declared | Role::Defined | Role::Argument
                    if is_symbol && self.word(n).eq_ignore_ascii_case(name) =>
                {
                    out.push((t.lo, t.hi, declares));
                }
                Role::Label if !is_symbol && self.word(n).eq_ignore_ascii_case(name) => {
                    out.push((t.lo, t.hi, false))
                }
                Role::Quoted if !is_symbol => {
                    let inside = between_quotes(self.word(n));
                    if inside.is_some_and(|l| l.eq_ignore_ascii_case(name)) {
                        out.push((t.lo + 1, t.hi - 1, false));
                    }
                }
                Role::Comment if is_symbol && self.word(n).starts_with("*=") => {
                    let text = self.word(n);
                    let mut i = 2;
                    while i < text.len() {
                        let end = words::word_end(text.as_bytes(), i);
                        let quoted = i > 0 && matches!(text.as_bytes()[i - 1], b'\'' | b'"' | b'.');
                        if end > i && !quoted && text[i..end].eq_ignore_ascii_case(name) {
                            out.push((t.lo + i, t.lo + end, false));
                        }
                        i = end.max(i + 1);
                        while !text.is_char_boundary(i) {
                            i += 1;
                        }
                    }
                }
                _ => {}
            }
        }
        out
    }
}

impl Editor {
    pub(super) fn subject(&self, file: &str, at: Position) -> Option<(Subject, Range)> {
        let d = self.document(file)?;
        let token = d.scan.token_at(d.offset(at))?;
        Some((d.subject(token)?, d.token_range(token)))
    }

    /// The files that a file is checked with.
    pub(super) fn project<'a>(&'a self, file: &'a str) -> Vec<(&'a str, &'a Document)> {
        let mut names: Vec<&str> = vec![file];
        if let Some(a) = self.analysis(file) {
            names = a.files.iter().map(String::as_str).collect();
            if !names.contains(&file) {
                names.push(file);
            }
            let mut seen = Vec::new();
            names.retain(|n| !seen.contains(n) && (seen.push(*n), true).1);
        }
        let found = names
            .into_iter()
            .filter_map(|n| Some((self.documents_name(n)?, self.document(n)?)));
        found.collect()
    }

    fn documents_name<'a>(&'a self, file: &'a str) -> Option<&'a str> {
        let found = self
            .open
            .get_key_value(file)
            .or_else(|| self.included.get_key_value(file));
        found.map(|(name, _)| name.as_str())
    }

    /// Where the name at a place is declared, and for an equation where it is defined; the file that an `$include` names.
    pub fn definition(&self, file: &str, at: Position) -> Vec<Location> {
        if let Some(included) = self.included_file(file, at) {
            return vec![Location {
                file: included,
                range: Range::default(),
            }];
        }
        let Some((subject, _)) = self.subject(file, at) else {
            return Vec::new();
        };
        let mut out = Vec::new();
        for (name, d) in self.project(file) {
            for (lo, hi, declares) in d.mentions(&subject) {
                // A label belongs to the first data that have it.
                if declares || matches!(subject, Subject::Label(_)) && out.is_empty() {
                    out.push(Location {
                        file: name.to_owned(),
                        range: d.range(lo, hi),
                    });
                }
            }
        }
        if let (true, Subject::Symbol(name)) = (out.is_empty(), &subject) {
            out.extend(self.declared(file, name));
        }
        out
    }

    /// Where the compiler met a declaration: behind an `$if`, say.
    fn declared(&self, file: &str, name: &str) -> Option<Location> {
        let a = self.analysis(file)?;
        let p = a.program.as_ref()?;
        let s = p.symbols.get(p.symbols.find(name)?);
        a.location(&p.map, s.declared)
    }

    /// The file that the `$include` at a place names.
    fn included_file(&self, file: &str, at: Position) -> Option<String> {
        let d = self.document(file)?;
        let line = d.scan.lines.line_of(d.offset(at));
        let r = d.scan.lines.range(line, &d.text);
        let (word, rest) = super::lines::directive(d.text.get(r.lo..r.hi)?, b'$')?;
        if !matches!(word.as_str(), "include" | "batinclude") {
            return None;
        }
        let rest = rest.trim().trim_matches(['\'', '"']);
        let name = match word.as_str() {
            "include" => rest,
            _ => rest.split_whitespace().next()?,
        };
        let from = std::path::Path::new(file).parent()?;
        let path = super::project::plain(&from.join(name))
            .to_string_lossy()
            .into_owned();
        let longer = format!("{path}.gms");
        let known = [path, longer, name.to_owned()];
        known.into_iter().find(|p| self.document(p).is_some())
    }

    /// Where the symbol or label at a place is named, its declaration among them if that is asked for.
    pub fn references(&self, file: &str, at: Position, with_declaration: bool) -> Vec<Location> {
        let Some((subject, _)) = self.subject(file, at) else {
            return Vec::new();
        };
        let mut out = Vec::new();
        for (name, d) in self.project(file) {
            let mentions = d.mentions(&subject).into_iter();
            out.extend(
                mentions
                    .filter(|m| with_declaration || !m.2)
                    .map(|m| Location {
                        file: name.to_owned(),
                        range: d.range(m.0, m.1),
                    }),
            );
        }
        out
    }

    /// Whether the name at a place can be changed: its place and the name.
    pub fn prepare_rename(&self, file: &str, at: Position) -> Option<(Range, String)> {
        let (Subject::Symbol(name), range) = self.subject(file, at)? else {
            return None;
        };
        self.is_symbol(file, &name).then_some((range, name))
    }

    fn is_symbol(&self, file: &str, name: &str) -> bool {
        let known = self
            .analysis(file)
            .is_some_and(|a| a.programs().any(|p| p.symbols.find(name).is_some()));
        let subject = Subject::Symbol(name.to_owned());
        known
            || self
                .project(file)
                .iter()
                .any(|(_, d)| d.mentions(&subject).iter().any(|m| m.2))
    }

    /// Another name for the symbol at a place, everywhere: in all files of the model, and in claims in comments.
    ///
    /// # Errors
    /// If there is no symbol, or the new name cannot be one.
    pub fn rename(&self, file: &str, at: Position, new: &str) -> Result<Vec<Edit>, RenameError> {
        let (_, old) = self.prepare_rename(file, at).ok_or(RenameError::NoSymbol)?;
        let first = new.as_bytes().first();
        let is_name = first.is_some_and(u8::is_ascii_alphabetic)
            && words::word_end(new.as_bytes(), 0) == new.len();
        let small = new.to_lowercase();
        let taken_word = words::is_reserved(&small)
            || words::statement_word(new, 0, new.len()).is_some()
            || super::scan::INNER_WORDS.contains(&small.as_str())
            || functions::callee(&small).is_some();
        if !is_name || taken_word {
            return Err(RenameError::NotAName(new.to_owned()));
        }
        if small != old && self.is_symbol(file, &small) {
            return Err(RenameError::Taken(new.to_owned()));
        }
        let places = self.references(file, at, true).into_iter();
        Ok(places
            .map(|l| Edit {
                file: l.file,
                range: l.range,
                new_text: new.to_owned(),
            })
            .collect())
    }
}
