//! One mistake, one message. What a mistake leads to is not reported: names whose declaration or definition failed are
//! *lost*, and statements that use them fail without a word; the same about a symbol is said once, with the other places.

use super::symbols::{Symbol, SymbolKind};
use super::{Checked, Compiler, Failed};
use crate::check::node::SymbolId;
use crate::diag::{Diagnostic, Label, Severity};
use crate::source::{SourceMap, Span};
use crate::syntax::ast::Ident;
use rustc_hash::FxHashSet;

/// About a symbol: repeated, these are one mistake in its declaration.
const ONCE: [&str; 9] = [
    "E0301", "E0302", "E0304", "E0306", "E0315", "E0326", "E0334", "E0339", "E0348",
];
/// Of each group the first one in a statement says it all: what is wrong there is wrong in all of it.
const ONCE_PER_STATEMENT: [&[&str]; 6] = [
    // Data that cannot be read: what the rest of them mean is a guess.
    &[
        "E0241", "E0242", "E0243", "E0245", "E0247", "E0248", "E0250", "E0251", "E0252", "E0253",
        "E0254", "E0345",
    ],
    &["E0310"],
    &["E0333"],
    &["E0338"],
    &["E0375"],
    &["E0329", "E0330"],
];
/// A text is missing in which anything may be declared.
const TEXT_MISSING: [&str; 7] = [
    "E0102", "E0103", "E0104", "E0105", "E0112", "E0114", "E0300",
];
/// What E0308 says of a label that another position of its symbol's domain has.
pub(super) const EXCHANGED: &str = "labels stand in the order of the declaration";
/// What E0319 says of variables and equations.
pub(super) const NOTHING_SOLVED: &str = "nothing was solved or assigned above";
/// Other places that a message shows.
const MAX_PLACES: usize = 4;

/// What earlier mistakes have spoiled.
#[derive(Default, Debug)]
pub(super) struct Lost {
    /// Names, in lower case, in statements that could not be read, in declarations that failed, and unknown ones.
    names: FxHashSet<String>,
    /// A statement could not be read.
    statements: bool,
    /// Symbols that are declared in two ways.
    symbols: FxHashSet<SymbolId>,
    /// Sets whose data could not be read.
    pub(super) elements: FxHashSet<SymbolId>,
    /// Definitions of equations with errors, by their number.
    pub(super) definitions: FxHashSet<usize>,
    /// Number of diagnostics before the statement at hand.
    pub(super) statement: usize,
    /// Indices of the statement at hand that were found not to be bound.
    unbound: Vec<String>,
    /// Names that were not known: the diagnostic, and the name.
    unknown: Vec<(usize, String)>,
}

impl Diagnostic {
    /// Reports it to the user, unless it repeats another.
    pub(super) fn report(self, c: &mut Compiler) {
        c.keep(self);
    }

    /// Reports it; what it belongs to is not there.
    pub(super) fn fail<T>(self, c: &mut Compiler) -> Checked<T> {
        self.report(c);
        Err(Failed)
    }
}

impl Compiler {
    /// A statement begins.
    pub(super) fn begin_statement(&mut self) {
        self.lost.statement = self.diagnostics.len();
        self.lost.unbound.clear();
    }

    /// Keeps a diagnostic, unless it repeats another.
    fn keep(&mut self, d: Diagnostic) {
        let from = self.lost.statement.min(self.diagnostics.len());
        let here = &mut self.diagnostics[from..];
        let said = |group: &&[&str]| {
            let unreadable = group[0] == "E0241" && matches!(d.code, "E0304" | "E0308" | "E0341");
            let label = |e: &Diagnostic| e.code == "E0308" && d.code.starts_with("E025");
            (group.contains(&d.code) || unreadable)
                && here.iter().any(|e| group.contains(&e.code) || label(e))
        };
        if ONCE_PER_STATEMENT.iter().any(said) {
            return;
        }
        // Labels that one set lacks are one mistake of a data statement.
        // So are variables that are shown before anything is solved.
        let alike = d.code == "E0308" || d.label == NOTHING_SOLVED;
        let same_set = |e: &&mut Diagnostic| {
            alike && e.code == d.code && e.label == d.label && !d.label.is_empty()
        };
        if let Some(first) = here.iter_mut().find(same_set) {
            return also(first, d.span, "nor is this");
        }
        // Labels in the places of others: the other positions of the same records are wrong too.
        let exchanged = |e: &Diagnostic| {
            e.code == "E0308" && e.help.as_ref().is_some_and(|h| h.contains(EXCHANGED))
        };
        if exchanged(&d) && here.iter().any(exchanged) {
            return;
        }
        let same = |e: &&mut Diagnostic| e.code == d.code && e.message == d.message;
        if ONCE.contains(&d.code)
            && let Some(first) = self.diagnostics.iter_mut().find(same)
        {
            return also(first, d.span, "also here");
        }
        if self.diagnostics.last() != Some(&d) {
            self.diagnostics.push(d);
        }
    }

    /// The names in a statement that could not be read may be declared, assigned or defined in it.
    pub(super) fn lose_statement(&mut self, text: &str) {
        self.lost.statements = true;
        let mut quote = None;
        let outside = |c: char| {
            match quote {
                Some(q) if c == q || c == '\n' => quote = None,
                None if matches!(c, '\'' | '"') => quote = Some(c),
                _ => {}
            }
            quote.is_none()
        };
        let code: String = text
            .chars()
            .map({
                let mut outside = outside;
                move |c| if outside(c) { c } else { ' ' }
            })
            .collect();
        let words = code.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        for word in words.filter(|w| w.starts_with(|c: char| c.is_ascii_alphabetic())) {
            self.lose(word);
        }
    }

    /// A name is spoiled: if it is not known, that is no news; if it is a symbol, it may have values.
    pub(super) fn lose(&mut self, name: &str) {
        self.lost.names.insert(name.to_lowercase());
        if let Some(s) = self.symbols.find(name) {
            let root = self.symbols.root(s);
            self.symbols.get_mut(root).assigned = true;
        }
    }

    /// What was meant as the definition of an equation is none.
    pub(super) fn lose_definition(&mut self) {
        self.lost.statements = true;
    }

    /// A declaration failed.
    pub(super) fn lose_declaration(&mut self, name: &str) {
        self.lose(name);
        if let Some(s) = self.symbols.find(name) {
            self.lost.symbols.insert(s);
        }
    }

    /// Whether an earlier message explains that a name is not known, has no data or no definition.
    pub(super) fn is_lost(&self, name: &str) -> bool {
        self.lost.names.contains(&name.to_lowercase()) || self.text_missing()
    }

    /// Whether a symbol is declared in two ways: nothing is said about its uses.
    pub(super) fn is_torn(&self, s: SymbolId) -> bool {
        self.lost.symbols.contains(&s)
    }

    /// Whether something was lost, and so a model may lack equations.
    pub(super) fn lacks_something(&self) -> bool {
        !self.lost.names.is_empty() || self.text_missing()
    }

    /// Whether an equation may be missing because its definition could not be read.
    pub(super) fn lacks_equations(&self) -> bool {
        self.lost.statements || self.text_missing()
    }

    fn text_missing(&self) -> bool {
        let missing =
            |d: &Diagnostic| d.severity == Severity::Error && TEXT_MISSING.contains(&d.code);
        self.diagnostics.iter().any(missing)
    }

    /// An "unknown name", said once.
    pub(super) fn unknown<T>(&mut self, id: &Ident, d: Diagnostic) -> Checked<T> {
        if !self.is_lost(&id.name) {
            let before = self.diagnostics.len();
            d.report(self);
            if self.diagnostics.len() > before {
                self.lost.unknown.push((before, id.name.to_string()));
            }
        } else if let Some((at, _)) = self
            .lost
            .unknown
            .iter()
            .find(|(_, n)| n.eq_ignore_ascii_case(&id.name))
        {
            also(&mut self.diagnostics[*at], id.span, "also here");
        }
        self.lost.names.insert(id.name.to_lowercase());
        Err(Failed)
    }

    /// An index that nothing binds; several in one statement are one message.
    pub(super) fn unbound<T>(&mut self, name: &Ident, d: Diagnostic) -> Checked<T> {
        let lower = name.name.to_lowercase();
        let from = self.lost.statement.min(self.diagnostics.len());
        let first = self.diagnostics[from..]
            .iter_mut()
            .find(|e| e.code == d.code);
        match first {
            None => {
                self.lost.unbound = vec![lower];
                d.report(self);
            }
            Some(first) if !self.lost.unbound.contains(&lower) => {
                self.lost.unbound.push(lower);
                let (last, others) = self.lost.unbound.split_last().expect("two at least");
                first.message = format!(
                    "the indices `{}` and `{last}` are not bound here",
                    others.join("`, `")
                );
                let list = self.lost.unbound.join(",");
                first.help = Some(match self.in_equation {
                    true => format!(
                        "sum over them, `sum(({list}), …)`, or add them to the equation's domain, `e({list})..`"
                    ),
                    false => format!(
                        "sum over them, `sum(({list}), …)`, or write them on the left, `p({list}) = …`"
                    ),
                });
                also(first, name.span, "nor is this");
            }
            Some(_) => {}
        }
        Err(Failed)
    }

    /// The symbol in whose text, written without quotes, a name stands: `variables x y z`.
    fn in_text(&self, name: &str, map: &SourceMap) -> Option<SymbolId> {
        let word = |w: &str| {
            w.split('(')
                .next()
                .is_some_and(|w| w.eq_ignore_ascii_case(name))
        };
        let mut symbols = self
            .symbols
            .iter()
            .filter(|(_, s)| s.text.split_whitespace().any(word));
        let unquoted = |s: &Symbol| {
            let behind = map.expanded().get(s.declared.hi as usize..);
            let before = behind.and_then(|b| b.split(&*s.text).next());
            before.is_some_and(|b| !b.contains(['\'', '"', ';', '/']))
        };
        symbols.find(|(_, s)| unquoted(s)).map(|(id, _)| id)
    }

    /// At the end of the text: names that were not known where they stand and are declared further down.
    pub(super) fn declared_below(&mut self, map: &SourceMap) {
        let mut gone = Vec::new();
        let mut said = false;
        let mut texts = Vec::new();
        for (at, name) in std::mem::take(&mut self.lost.unknown) {
            let Some(s) = self.symbols.find(&name) else {
                let (said, s) = (texts.len(), self.in_text(&name, map));
                texts.extend(s.filter(|s| !texts.contains(s)));
                match s {
                    Some(_) if said == texts.len() => gone.push(at),
                    Some(s) => {
                        let symbol = self.symbols.get(s);
                        let d = &mut self.diagnostics[at];
                        d.others.push(Label {
                            span: symbol.declared,
                            text: format!("`{}` is read as the text of this", symbol.text),
                        });
                        d.help = Some("commas stand between names that are declared".into());
                    }
                    None => {}
                }
                continue;
            };
            let symbol = self.symbols.get(s);
            let d = &mut self.diagnostics[at];
            if symbol.declared.lo <= d.span.lo || matches!(symbol.kind, SymbolKind::Acronym(_)) {
                continue;
            }
            // Declarations that come too late are one mistake.
            if std::mem::replace(&mut said, true) {
                gone.push(at);
                continue;
            }
            d.message = format!("`{name}` is used before it is declared");
            d.label = "not known here yet".into();
            d.others.push(Label {
                span: symbol.declared,
                text: "declared here".into(),
            });
            d.help = Some("move the declaration above the first use".into());
        }
        let mut k = 0;
        self.diagnostics.retain(|_| {
            k += 1;
            !gone.contains(&(k - 1))
        });
    }
}

fn also(first: &mut Diagnostic, span: Span, text: &str) {
    let known = first.span == span || first.others.iter().any(|o| o.span == span);
    if !known && first.others.len() < MAX_PLACES {
        first.others.push(Label {
            span,
            text: text.into(),
        });
    }
}
