//! What an editor asks about a model: what is wrong, what a name is, what may stand here, where it is declared.
//!
//! An [`Editor`] holds the texts that are open. [`Editor::check`] compiles a model (as `bmod check` does, nothing is run)
//! and says what is wrong; all other questions are answered from the texts as they stand and from the last program that
//! compiled so far, so a half-typed text loses nothing. There are no files, threads or clocks here: what is not open is
//! read through [`Files`]. `bmod lsp` and the playground's page are thin layers on this module.
//!
//! All answers are values that serialize to JSON in the shapes of the language server protocol.
//!
//! ```
//! use bmod::editor::{Editor, Position};
//!
//! let mut editor = Editor::new(None);
//! editor.open("blend.blk", "Set i / corn, soy /;\nParameter price(i) 'per ton' / corn 30, soy 90 /;\ndisplay prise;\n");
//! let wrong = editor.check("blend.blk");
//! assert_eq!(wrong[0].diagnostics[0].code, "E0301");
//! assert_eq!(wrong[0].diagnostics[0].fixes[0].edits[0].new_text, "price");
//! let hover = editor.hover("blend.blk", Position { line: 1, character: 12 }).unwrap();
//! assert!(hover.contents.contains("per ton"));
//! ```

mod analysis;
mod complete;
mod hover;
mod layout;
mod lines;
mod navigate;
mod outline;
mod place;
mod project;
mod scan;
mod substitution;
pub mod vocabulary;

pub use analysis::{Diagnostic, FileDiagnostics, Fix, Related};
pub use complete::{Completion, CompletionKind};
pub use hover::{Hover, Signature};
pub use layout::format;
pub use navigate::Edit;
pub use outline::{Fold, FoldKind, Lens, OutlineItem, TOKEN_KINDS, Token};
pub use place::{Location, Position, Range};
pub use project::Files;

use crate::check::Program;
use crate::check::symbols::Symbol;
use analysis::Analysis;
use project::Document;
use rustc_hash::FxHashMap;

/// The texts that are open, and what is known about them. See the module.
#[derive(Default)]
pub struct Editor {
    open: FxHashMap<String, Document>,
    /// Files that open ones include.
    included: FxHashMap<String, Document>,
    files: Option<Box<dyn Files>>,
    /// By main file.
    analyses: FxHashMap<String, Analysis>,
    /// Main files of files that are only included.
    mains: FxHashMap<String, String>,
}

impl Editor {
    /// Nothing is open. `files` has what models include beside it; without it only open texts are known.
    pub fn new(files: Option<Box<dyn Files>>) -> Self {
        Self {
            files,
            ..Self::default()
        }
    }

    /// A text is open, or has changed.
    pub fn open(&mut self, file: &str, text: impl Into<String>) {
        self.included.remove(file);
        self.open
            .insert(file.to_owned(), Document::new(file, text.into()));
    }

    /// A piece of a text has changed; without a piece all of it.
    pub fn change(&mut self, file: &str, range: Option<Range>, new: &str) {
        let text = match (range, self.open.get(file)) {
            (Some(r), Some(d)) => {
                let (lo, hi) = (d.offset(r.start), d.offset(r.end));
                let (lo, hi) = (lo.min(hi), lo.max(hi));
                format!("{}{new}{}", &d.text[..lo], &d.text[hi..])
            }
            _ => new.to_owned(),
        };
        self.open(file, text);
    }

    /// A text is open no more: what holds is what [`Files`] have. Gives the models that include it, which are to be checked again.
    pub fn close(&mut self, file: &str) -> Vec<String> {
        self.open.remove(file);
        self.analyses.remove(file);
        let including = self
            .analyses
            .iter()
            .filter(|(_, a)| a.files.iter().any(|f| f == file));
        including.map(|(main, _)| main.clone()).collect()
    }

    /// A file is checked as part of this one, which includes it; should it turn out not to, the file is checked by itself.
    pub fn set_main(&mut self, file: &str, main: &str) {
        self.mains.insert(file.to_owned(), main.to_owned());
    }

    /// The text of a file that is open or included.
    pub fn text(&self, file: &str) -> Option<&str> {
        self.document(file).map(|d| d.text.as_str())
    }

    /// The files that are open.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        self.open.keys().map(String::as_str)
    }

    /// The main file that a file is checked with: itself, or one that includes it.
    pub fn main_of(&self, file: &str) -> String {
        if let Some(main) = self.mains.get(file) {
            let known = self.analyses.get(main);
            if known.is_none_or(|a| a.may_include(file)) {
                return main.clone();
            }
        }
        let mut mains: Vec<_> = self
            .analyses
            .iter()
            .filter(|(main, a)| *main != file && a.files.iter().skip(1).any(|f| f == file))
            .map(|(main, _)| main.clone())
            .collect();
        mains.sort();
        mains.into_iter().next().unwrap_or_else(|| file.to_owned())
    }

    fn document(&self, file: &str) -> Option<&Document> {
        self.open.get(file).or_else(|| self.included.get(file))
    }

    fn analysis(&self, file: &str) -> Option<&Analysis> {
        self.analyses.get(&self.main_of(file))
    }

    /// The symbol of a name, and the newest program that knows it.
    fn known(&self, file: &str, name: &str) -> Option<(&Program, &Symbol)> {
        let mut all = self.analysis(file)?.programs();
        all.find_map(|p| Some((p, p.symbols.get(p.symbols.find(name)?))))
    }

    /// The layout of a text, as `bmod fmt` has it, as one edit; none where nothing changes.
    pub fn format(&self, file: &str) -> Vec<Edit> {
        let Some(d) = self.document(file) else {
            return Vec::new();
        };
        let new_text = format(&d.text, project::has_slashes(file));
        if new_text == d.text {
            return Vec::new();
        }
        vec![Edit {
            file: file.to_owned(),
            range: d.range(0, d.text.len()),
            new_text,
        }]
    }
}
