//! Where a name is declared and used, and another name for it.

use super::Editor;
use super::place::{Location, Position, Range};
use super::project::Document;
use super::scan::Role;
use crate::check::functions;
use crate::syntax::words;
use rustc_hash::FxHashMap;
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

/// The words of a text, as pieces of it, and what stands before them.
fn words_in(text: &str) -> impl Iterator<Item = (usize, usize, Option<u8>)> {
    let bytes = text.as_bytes();
    let mut i = 0;
    std::iter::from_fn(move || {
        while i < bytes.len() && words::word_end(bytes, i) == i {
            i += 1;
        }
        let lo = i;
        i = words::word_end(bytes, i);
        let before = lo.checked_sub(1).map(|b| bytes[b]);
        (lo < i).then_some((lo, i, before))
    })
}

/// The sets that a label in data names: `#i`, `a.#i`, `set.i`; in a table that is one word.
fn symbols_in_label(label: &str, behind_set: bool) -> Vec<(usize, usize)> {
    let is_set = |end: usize| {
        let word = &label[..end];
        let before = word.len().checked_sub(4).map(|n| word.as_bytes()[n]);
        word.get(word.len().saturating_sub(3)..)
            .is_some_and(|w| w.eq_ignore_ascii_case("set"))
            && before.is_none_or(|b| b == b'.')
    };
    words_in(label)
        .filter(|&(lo, _, before)| match before {
            None => behind_set,
            Some(b'#') => true,
            Some(b'.') => is_set(lo - 1),
            _ => false,
        })
        .map(|(lo, hi, _)| (lo, hi))
        .collect()
}

impl Document {
    /// Whether a token of data stands behind `set.`.
    fn is_behind_set(&self, token: usize) -> bool {
        token > 1
            && self.scan.tokens[token - 1].role == Role::Dot
            && self.word(token - 2).eq_ignore_ascii_case("set")
    }

    /// Whether the argument of a directive is a name of the preprocessor: `$eval x …`, `$if set x`, `%x%`.
    fn is_control(&self, token: usize) -> bool {
        let Some(before) = token.checked_sub(1) else {
            return false;
        };
        let word = self.word(before).to_ascii_lowercase();
        match self.scan.tokens[before].role {
            _ if word == "%" => true,
            Role::Directive => word.contains("eval"),
            Role::Argument => matches!(word.as_str(), "set" | "setglobal" | "setlocal"),
            _ => false,
        }
    }

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
            Role::Label if !symbols_in_label(word, self.is_behind_set(token)).is_empty() => {
                Some(Subject::Symbol(word.trim_start_matches('#').to_lowercase()))
            }
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
            let text = self.word(n);
            let whole = || vec![(0, text.len())];
            let pieces = match t.role {
                Role::Name | Role::Declared | Role::Defined if is_symbol => whole(),
                Role::Argument if is_symbol && !self.is_control(n) => whole(),
                // An expression in brackets, or an acronym as a value.
                Role::Number if is_symbol && t.data => {
                    words_in(text).map(|(lo, hi, _)| (lo, hi)).collect()
                }
                Role::Label if is_symbol => symbols_in_label(text, self.is_behind_set(n)),
                Role::Label => whole(),
                Role::Quoted if !is_symbol && between_quotes(text).is_some() => {
                    vec![(1, text.len() - 1)]
                }
                Role::Comment if is_symbol && text.starts_with("*=") => {
                    let quoted = |before| matches!(before, Some(b'\'' | b'"' | b'.'));
                    let claimed = words_in(text).filter(|w| !quoted(w.2));
                    claimed.map(|(lo, hi, _)| (lo, hi)).collect()
                }
                _ => continue,
            };
            let declares = matches!(t.role, Role::Declared | Role::Defined);
            let named = |(lo, hi): &(usize, usize)| text[*lo..*hi].eq_ignore_ascii_case(name);
            let pieces = pieces.into_iter().filter(named);
            out.extend(pieces.map(|(lo, hi)| (t.lo + lo, t.lo + hi, declares)));
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
        let given = self.substitution(file, at);
        if !given.is_empty() {
            return given;
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
        let (word, rest) =
            super::lines::directive(d.text.get(r.lo..r.hi)?, &crate::source::Marks::new(false))?;
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
        let subject = Subject::Symbol(name.to_owned());
        self.known(file, name).is_some()
            || self
                .project(file)
                .iter()
                .any(|(_, d)| d.mentions(&subject).iter().any(|m| m.2))
    }

    /// Another name for the symbol at a place, everywhere: in all files of the model, and in claims in comments.
    ///
    /// # Errors
    /// If there is no symbol, the new name cannot be one, or the model would have an error with it: says so in words.
    pub fn rename(&self, file: &str, at: Position, new: &str) -> Result<Vec<Edit>, String> {
        let symbol = self.prepare_rename(file, at);
        let (_, old) = symbol.ok_or("there is no symbol here")?;
        let first = new.as_bytes().first();
        let is_name = first.is_some_and(u8::is_ascii_alphabetic)
            && words::word_end(new.as_bytes(), 0) == new.len();
        let small = new.to_lowercase();
        let taken_word = words::is_reserved(&small)
            || words::statement_word(new, 0, new.len()).is_some()
            || super::scan::INNER_WORDS.contains(&small.as_str())
            || functions::callee(&small).is_some();
        if !is_name || taken_word {
            return Err(format!(
                "`{new}` is no name: a letter, then letters, digits and `_`, and no word of the language"
            ));
        }
        if small != old && self.is_symbol(file, &small) {
            return Err(format!("there is a symbol `{new}` already"));
        }
        let places = self.references(file, at, true).into_iter();
        let edits: Vec<Edit> = places
            .map(|l| Edit {
                file: l.file,
                range: l.range,
                new_text: new.to_owned(),
            })
            .collect();
        match self.new_error(file, &edits) {
            Some(why) => Err(format!(
                "the name is used where it cannot be followed; with another one: {why}"
            )),
            None => Ok(edits),
        }
    }

    /// What is wrong with a model after some changes that is not wrong before them.
    fn new_error(&self, file: &str, edits: &[Edit]) -> Option<String> {
        let main = self.main_of(file);
        let mut changed = FxHashMap::default();
        for (name, d) in self.open.iter().chain(&self.included) {
            let mut text = d.text.clone();
            let here = edits.iter().filter(|e| e.file == *name);
            let mut places: Vec<_> = here.map(|e| (e.range, &e.new_text)).collect();
            places.sort_by_key(|p| std::cmp::Reverse(p.0.start));
            for (range, new) in places {
                text.replace_range(d.offset(range.start)..d.offset(range.end), new);
            }
            if self.open.contains_key(name) || text != d.text {
                changed.insert(name.clone(), Document::new(name, text));
            }
        }
        let after = self.errors(&changed, &main);
        if after.is_empty() {
            return None;
        }
        let before = self.errors(&self.open, &main).len();
        let more = after.len() > before;
        more.then(|| after.into_iter().next_back()).flatten()
    }
}
