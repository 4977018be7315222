//! What the page's editor asks while a person types.

use bmod::editor::{Editor, FileDiagnostics, Fold, Position, TOKEN_KINDS};
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A question about a file, with what has changed since the last one.
#[derive(Deserialize)]
pub struct Edit {
    file: String,
    /// The file that is run.
    main: String,
    /// Texts that are new or have changed.
    open: BTreeMap<String, String>,
    /// Files that have gone.
    close: Vec<String>,
    #[serde(flatten)]
    question: Question,
}

#[derive(Deserialize)]
#[serde(tag = "ask", rename_all = "lowercase")]
enum Question {
    /// What is wrong, and how the text looks.
    Look,
    Completion {
        at: Position,
    },
    Hover {
        at: Position,
    },
    Definition {
        at: Position,
    },
    Rename {
        at: Position,
        name: String,
    },
    Format,
}

/// What a look at a file shows.
#[derive(Serialize)]
struct Look {
    wrong: Vec<FileDiagnostics>,
    /// Line, first UTF-16 unit, length, kind.
    tokens: Vec<[u32; 4]>,
    kinds: &'static [&'static str],
    folds: Vec<Fold>,
}

thread_local! {
    static EDITOR: RefCell<Editor> = RefCell::new(Editor::new(None));
}

/// The answer in JSON.
pub fn answer(edit: Edit) -> String {
    EDITOR.with_borrow_mut(|editor| {
        for file in &edit.close {
            editor.close(file);
        }
        for (file, text) in edit.open {
            editor.open(&file, text);
        }
        let names: Vec<String> = editor.files().map(str::to_string).collect();
        for name in &names {
            editor.set_main(name, &edit.main);
        }
        ask(editor, &edit.file, edit.question)
    })
}

fn ask(editor: &mut Editor, file: &str, question: Question) -> String {
    use super::{error, written};
    match question {
        Question::Look => {
            let wrong = editor.check(file);
            let tokens = editor.tokens(file);
            written(&Look {
                wrong,
                tokens: tokens
                    .iter()
                    .map(|t| [t.line, t.character, t.length, t.kind])
                    .collect(),
                kinds: TOKEN_KINDS,
                folds: editor.folds(file),
            })
        }
        Question::Completion { at } => written(&editor.completion(file, at)),
        Question::Hover { at } => written(&editor.hover(file, at)),
        Question::Definition { at } => written(&editor.definition(file, at)),
        Question::Rename { at, name } => match editor.rename(file, at, &name) {
            Ok(edits) => written(&edits),
            Err(why) => error(&why.to_string()),
        },
        Question::Format => written(&editor.format(file)),
    }
}
