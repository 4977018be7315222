//! `bmod lsp`: the language server protocol over standard input and output, on top of [`crate::editor`].
//!
//! One thread answers. Changes are taken in at once; the model is compiled when nothing else is waiting, so a person who types
//! fast is never behind. Runs are processes of their own.

use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;

use lsp_server::{Connection, ErrorCode, Message, Notification, Request, Response};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};
use serde_json::{Value, json};

use super::args::EXECUTION;
use crate::editor::{
    CompletionKind, Diagnostic, Edit, Editor, Files, Fix, Location, Position, Range, TOKEN_KINDS,
};
use crate::host::{Found, HostError};
use crate::system;

/// Files larger than this are not read for an editor.
const LARGEST: u64 = 64 << 20;
/// Where a main file is looked for: so many files, and none larger than this.
const MOST_FILES: usize = 300;
const LARGEST_MAIN: u64 = 1 << 20;

/// Carries out `bmod lsp`: until the editor says goodbye.
pub(super) fn lsp() -> u8 {
    let (connection, threads) = Connection::stdio();
    let status = serve(&connection);
    drop(connection);
    let _ = threads.join();
    status
}

/// Files on disk, beside those that are open.
struct Disk;

/// The file of this name beside the one that asks for it, or in the current folder.
fn on_disk(path: &str, from: Option<&Path>) -> Option<PathBuf> {
    let beside = from.and_then(Path::parent).map(|f| f.join(path));
    let mut places = [beside, Some(path.into())].into_iter().flatten();
    places.find(|p| p.is_file())
}

impl Files for Disk {
    fn read(&self, path: &str, from: Option<&Path>) -> Found<Vec<u8>> {
        let file = on_disk(path, from).ok_or(HostError::NotFound)?;
        if file.metadata().map_err(system::other)?.len() > LARGEST {
            return Err(HostError::Other("it is too large for an editor".into()));
        }
        let bytes = std::fs::read(&file).map_err(system::other)?;
        Ok((file, bytes))
    }

    fn exists(&self, path: &str, from: Option<&Path>) -> bool {
        on_disk(path, from).is_some()
    }
}

struct Server<'a> {
    connection: &'a Connection,
    editor: Editor,
    versions: HashMap<String, i64>,
    /// Files whose models are to be compiled.
    waiting: Vec<String>,
    told: HashMap<String, Vec<Diagnostic>>,
}

fn serve(connection: &Connection) -> u8 {
    let Ok((id, _)) = connection.initialize_start() else {
        return EXECUTION;
    };
    let answer = json!({
        "capabilities": capabilities(),
        "serverInfo": { "name": "bmod", "version": env!("CARGO_PKG_VERSION") },
    });
    if connection.initialize_finish(id, answer).is_err() {
        return EXECUTION;
    }
    let mut server = Server {
        connection,
        editor: Editor::new(Some(Box::new(Disk))),
        versions: HashMap::new(),
        waiting: Vec::new(),
        told: HashMap::new(),
    };
    loop {
        let message = match server.waiting.is_empty() {
            true => connection.receiver.recv().ok(),
            false => match connection.receiver.try_recv() {
                Ok(m) => Some(m),
                Err(_) => {
                    let file = server.waiting.remove(0);
                    server.check(&file);
                    continue;
                }
            },
        };
        match message {
            None => return 0,
            Some(Message::Request(r)) => match connection.handle_shutdown(&r) {
                Ok(true) => return 0,
                Ok(false) => server.answer(r),
                Err(_) => return EXECUTION,
            },
            Some(Message::Notification(n)) => server.hear(&n),
            Some(Message::Response(_)) => {}
        }
    }
}

fn capabilities() -> Value {
    json!({
        "positionEncoding": "utf-16",
        "textDocumentSync": { "openClose": true, "change": 2, "save": true },
        "hoverProvider": true,
        "completionProvider": { "triggerCharacters": [".", "'", "\"", "$"] },
        "signatureHelpProvider": { "triggerCharacters": ["(", ","] },
        "definitionProvider": true,
        "referencesProvider": true,
        "renameProvider": { "prepareProvider": true },
        "documentSymbolProvider": true,
        "foldingRangeProvider": true,
        "documentFormattingProvider": true,
        "codeActionProvider": { "codeActionKinds": ["quickfix"] },
        "codeLensProvider": {},
        "executeCommandProvider": { "commands": ["bmod.run", "bmod.why"] },
        "semanticTokensProvider": {
            "legend": { "tokenTypes": TOKEN_KINDS, "tokenModifiers": [] },
            "full": true,
        },
    })
}

/// A file's path out of its address; what is no file on disk keeps its address.
fn path(uri: &str) -> String {
    let Some(rest) = uri.strip_prefix("file://") else {
        return uri.to_owned();
    };
    let path = percent_decode_str(rest).decode_utf8_lossy();
    // `/c:/folder` of Windows.
    match path.as_bytes() {
        [b'/', drive, b':', ..] if drive.is_ascii_alphabetic() => path[1..].to_owned(),
        _ => path.into_owned(),
    }
}

/// What stands in an address as it is, beside letters and digits.
const PLAIN: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'/')
    .remove(b'-')
    .remove(b'_')
    .remove(b'.')
    .remove(b'~');

/// A file's address.
fn uri(path: &str) -> String {
    if path.contains("://") || path.starts_with("untitled:") {
        return path.to_owned();
    }
    let root = if path.starts_with('/') { "" } else { "/" };
    format!("file://{root}{}", utf8_percent_encode(path, PLAIN))
}

fn location(l: &Location) -> Value {
    json!({ "uri": uri(&l.file), "range": l.range })
}

fn locations(list: &[Location]) -> Value {
    list.iter().map(location).collect()
}

/// Edits by file.
fn workspace_edit(edits: &[Edit]) -> Value {
    let mut changes = serde_json::Map::new();
    for e in edits {
        let list = changes.entry(uri(&e.file)).or_insert_with(|| json!([]));
        if let Some(list) = list.as_array_mut() {
            list.push(text_edit(e));
        }
    }
    json!({ "changes": changes })
}

fn text_edit(e: &Edit) -> Value {
    json!({ "range": e.range, "newText": e.new_text })
}

fn diagnostic(d: &Diagnostic) -> Value {
    let related: Vec<Value> = d
        .related
        .iter()
        .map(|r| json!({ "location": location(&r.location), "message": r.message }))
        .collect();
    json!({
        "range": d.range, "severity": d.severity, "code": d.code, "source": "bmod", "message": d.message,
        "relatedInformation": related,
    })
}

/// Numbers that the protocol gives to kinds: of completions, of symbols.
fn numbers(kind: CompletionKind) -> (u8, u8) {
    use CompletionKind as K;
    match kind {
        K::Keyword => (14, 19),
        K::Function => (3, 24),
        K::Set => (13, 10),
        K::Parameter => (21, 14),
        K::Variable => (6, 13),
        K::Equation => (2, 6),
        K::Model => (9, 2),
        K::Other => (18, 19),
        K::Label => (20, 22),
        K::Attribute => (10, 7),
        K::Directive => (14, 19),
        K::Option => (12, 14),
    }
}

fn range_of(v: &Value) -> Option<Range> {
    let at = |v: &Value| -> Option<Position> { serde_json::from_value(v.clone()).ok() };
    Some(Range {
        start: at(&v["start"])?,
        end: at(&v["end"])?,
    })
}

impl Server<'_> {
    fn send(&self, message: impl Into<Message>) {
        // An editor that has gone away is noticed when the next message is read.
        let _ = self.connection.sender.send(message.into());
    }

    /// Does something that no text may make fail; should it, what was known is built again from the texts.
    fn safely<T>(&mut self, work: impl FnOnce(&mut Self) -> T) -> Option<T> {
        let done = catch_unwind(AssertUnwindSafe(|| work(self)));
        if done.is_err() {
            let text = |f: &str| Some((f.to_owned(), self.editor.text(f)?.to_owned()));
            let texts: Vec<(String, String)> = self.editor.files().filter_map(text).collect();
            self.editor = Editor::new(Some(Box::new(Disk)));
            for (file, text) in texts {
                self.editor.open(&file, text);
            }
        }
        done.ok()
    }

    fn hear(&mut self, n: &Notification) {
        let document = &n.params["textDocument"];
        let Some(file) = document["uri"].as_str().map(path) else {
            return;
        };
        if let Some(version) = document["version"].as_i64() {
            self.versions.insert(file.clone(), version);
        }
        match n.method.as_str() {
            "textDocument/didOpen" => {
                let text = document["text"].as_str().unwrap_or_default().to_owned();
                if let Some(main) = find_main(Path::new(&file), &text) {
                    self.editor.set_main(&file, &main);
                }
                self.safely(|s| s.editor.open(&file, text));
            }
            "textDocument/didChange" => {
                let changes = n.params["contentChanges"]
                    .as_array()
                    .cloned()
                    .unwrap_or_default();
                for c in changes {
                    let text = c["text"].as_str().unwrap_or_default();
                    let range = range_of(&c["range"]);
                    self.safely(|s| s.editor.change(&file, range, text));
                }
            }
            "textDocument/didClose" => {
                // What was not saved is gone for the models that include it, too.
                let mains = self.editor.close(&file);
                self.waiting.retain(|f| *f != file);
                self.publish(&file, &[]);
                for main in mains {
                    if !self.waiting.contains(&main) {
                        self.waiting.push(main);
                    }
                }
                return;
            }
            "textDocument/didSave" => {}
            _ => return,
        }
        if !self.waiting.contains(&file) {
            self.waiting.push(file);
        }
    }

    fn check(&mut self, file: &str) {
        let found = self.safely(|s| s.editor.check(file)).unwrap_or_default();
        for f in found {
            self.publish(&f.file, &f.diagnostics);
            self.told.insert(f.file, f.diagnostics);
        }
    }

    fn publish(&self, file: &str, diagnostics: &[Diagnostic]) {
        let list: Vec<Value> = diagnostics.iter().map(diagnostic).collect();
        let params =
            json!({ "uri": uri(file), "version": self.versions.get(file), "diagnostics": list });
        self.send(Notification::new(
            "textDocument/publishDiagnostics".into(),
            params,
        ));
    }

    fn answer(&mut self, r: Request) {
        let id = r.id.clone();
        let answer = match self.safely(|s| s.result(&r)) {
            Some(Ok(result)) => Response::new_ok(id, result),
            Some(Err((code, message))) => Response::new_err(id, code as i32, message),
            None => Response::new_err(
                id,
                ErrorCode::InternalError as i32,
                "bmod failed at this text; please report it".into(),
            ),
        };
        self.send(answer);
    }

    fn result(&mut self, r: &Request) -> Result<Value, (ErrorCode, String)> {
        let p = &r.params;
        let file = path(p["textDocument"]["uri"].as_str().unwrap_or_default());
        let at: Position = serde_json::from_value(p["position"].clone()).unwrap_or_default();
        let editor = &self.editor;
        Ok(match r.method.as_str() {
            "textDocument/hover" => editor.hover(&file, at).map_or(Value::Null, |h| {
                json!({ "range": h.range, "contents": { "kind": "markdown", "value": h.contents } })
            }),
            "textDocument/completion" => {
                let items = editor.completion(&file, at).into_iter().map(|c| {
                    json!({
                        "label": c.label, "kind": numbers(c.kind).0, "detail": c.detail,
                        "documentation": { "kind": "markdown", "value": c.documentation },
                        "textEdit": { "range": c.range, "newText": c.label },
                    })
                });
                items.collect()
            }
            "textDocument/signatureHelp" => editor.signature(&file, at).map_or(Value::Null, |s| {
                let parameters: Vec<Value> = s.parameters.iter().map(|p| json!({ "label": [p.0, p.1] })).collect();
                json!({
                    "signatures": [{ "label": s.label, "documentation": s.documentation, "parameters": parameters }],
                    "activeSignature": 0, "activeParameter": s.active,
                })
            }),
            "textDocument/definition" => locations(&editor.definition(&file, at)),
            "textDocument/references" => {
                let declaration = p["context"]["includeDeclaration"].as_bool().unwrap_or(true);
                locations(&editor.references(&file, at, declaration))
            }
            "textDocument/prepareRename" => editor
                .prepare_rename(&file, at)
                .map_or(Value::Null, |(range, name)| json!({ "range": range, "placeholder": name })),
            "textDocument/rename" => {
                let new = p["newName"].as_str().unwrap_or_default();
                let edits = editor.rename(&file, at, new);
                workspace_edit(&edits.map_err(|e| (ErrorCode::RequestFailed, e))?)
            }
            "textDocument/documentSymbol" => {
                let items = editor.outline(&file).into_iter().map(|i| {
                    json!({
                        "name": i.name, "detail": i.detail, "kind": numbers(i.kind).1,
                        "range": i.range, "selectionRange": i.selection,
                    })
                });
                items.collect()
            }
            "textDocument/foldingRange" => json!(editor.folds(&file)),
            "textDocument/formatting" => editor.format(&file).iter().map(text_edit).collect(),
            "textDocument/codeLens" => {
                let lenses = editor.lenses(&file).into_iter().map(|l| {
                    let command = json!({ "title": l.title, "command": l.command, "arguments": [file] });
                    json!({ "range": l.range, "command": command })
                });
                lenses.collect()
            }
            "textDocument/semanticTokens/full" => json!({ "data": self.semantic_tokens(&file) }),
            "textDocument/codeAction" => self.actions(&file, &p["range"]),
            "workspace/executeCommand" => self.execute(p)?,
            other => {
                let message = format!("bmod does not know `{other}`");
                return Err((ErrorCode::MethodNotFound, message));
            }
        })
    }

    /// Each token as its distance from the one before, in the way of the protocol.
    fn semantic_tokens(&self, file: &str) -> Vec<u32> {
        let mut out = Vec::new();
        let (mut line, mut character) = (0, 0);
        for t in self.editor.tokens(file) {
            let from = if t.line == line { character } else { 0 };
            out.extend([t.line - line, t.character - from, t.length, t.kind, 0]);
            (line, character) = (t.line, t.character);
        }
        out
    }

    /// The fixes of what is wrong in a range.
    fn actions(&self, file: &str, range: &Value) -> Value {
        let Some(range) = range_of(range) else {
            return json!([]);
        };
        let here = |d: &&Diagnostic| d.range.start <= range.end && range.start <= d.range.end;
        let found = self.told.get(file).into_iter().flatten().filter(here);
        let action = |d: &Diagnostic, f: &Fix| {
            json!({
                "title": f.title, "kind": "quickfix", "isPreferred": true,
                "diagnostics": [diagnostic(d)], "edit": workspace_edit(&f.edits),
            })
        };
        found
            .flat_map(|d| d.fixes.iter().map(move |f| action(d, f)))
            .collect()
    }

    /// Runs a model, or asks why: a process of its own, whose output is shown when it ends.
    fn execute(&self, p: &Value) -> Result<Value, (ErrorCode, String)> {
        let command = match p["command"].as_str() {
            Some("bmod.run") => "run",
            Some("bmod.why") => "why",
            other => {
                let message = format!("there is no command `{}`", other.unwrap_or_default());
                return Err((ErrorCode::InvalidParams, message));
            }
        };
        let file = path(p["arguments"][0].as_str().unwrap_or_default());
        let program =
            std::env::current_exe().map_err(|e| (ErrorCode::InternalError, e.to_string()))?;
        let sender = self.connection.sender.clone();
        std::thread::spawn(move || {
            let mut run = Command::new(program);
            run.arg(command).arg(&file);
            if let Some(folder) = Path::new(&file).parent() {
                run.current_dir(folder);
            }
            let (kind, message) = match run.output() {
                Ok(o) => {
                    let text =
                        String::from_utf8_lossy(&o.stdout) + String::from_utf8_lossy(&o.stderr);
                    (
                        if o.status.success() { 3 } else { 1 },
                        text.trim_end().to_owned(),
                    )
                }
                Err(e) => (1, format!("bmod cannot be run: {e}")),
            };
            for method in ["window/logMessage", "window/showMessage"] {
                let params = json!({ "type": kind, "message": message });
                let _ = sender.send(Notification::new(method.into(), params).into());
            }
        });
        Ok(Value::Null)
    }
}

/// The model that a file belongs to, if it solves nothing itself: the first in its folder that includes it.
fn find_main(file: &Path, text: &str) -> Option<String> {
    let solves = |l: &str| {
        l.trim_start()
            .get(..6)
            .is_some_and(|w| w.eq_ignore_ascii_case("solve "))
    };
    let name = file.file_name()?.to_str()?;
    if text.lines().any(solves) {
        return None;
    }
    let mut files: Vec<PathBuf> = std::fs::read_dir(file.parent()?)
        .ok()?
        .take(MOST_FILES)
        .filter_map(|e| Some(e.ok()?.path()))
        .filter(|p| p.extension().is_some_and(|e| e == "blk" || e == "gms") && p != file)
        .filter(|p| p.metadata().is_ok_and(|m| m.len() <= LARGEST_MAIN))
        .collect();
    files.sort();
    let includes = |p: &PathBuf| {
        let text = std::fs::read(p).unwrap_or_default();
        let text = String::from_utf8_lossy(&text).into_owned();
        text.lines().any(|l| {
            let small = l.trim_start().to_ascii_lowercase();
            let named = l.trim().trim_end_matches(['\'', '"', ';']);
            let before = named.strip_suffix(name);
            let whole = before.is_some_and(|b| b.ends_with([' ', '\t', '\'', '"', '/', '\\']));
            small.starts_with("$include") && whole
        })
    };
    let main = files.into_iter().find(includes)?;
    Some(main.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::{path, uri};

    #[test]
    fn addresses_of_files() {
        let name = "/tmp/eine Wand/größer.blk";
        assert_eq!(uri(name), "file:///tmp/eine%20Wand/gr%C3%B6%C3%9Fer.blk");
        assert_eq!(path(&uri(name)), name);
        assert_eq!(path("file:///c%3A/x.blk"), "c:/x.blk");
        assert_eq!(path("untitled:Untitled-1"), "untitled:Untitled-1");
        assert_eq!(path("file:///a%zz"), "/a%zz");
    }
}
