//! `bmod lsp` as an editor meets it: a process, spoken to over pipes.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

struct Client {
    server: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    next: i64,
    /// What the server said of its own accord.
    heard: Vec<Value>,
}

impl Client {
    fn new() -> Self {
        let mut server = Command::new(env!("CARGO_BIN_EXE_bmod"))
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("bmod begins");
        let to = server.stdin.take().expect("a pipe");
        let from = BufReader::new(server.stdout.take().expect("a pipe"));
        let mut client = Self {
            server,
            to,
            from,
            next: 0,
            heard: Vec::new(),
        };
        let can = client.ask("initialize", json!({ "capabilities": {} }));
        assert_eq!(can["capabilities"]["hoverProvider"], true);
        client.tell("initialized", json!({}));
        client
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        write!(self.to, "Content-Length: {}\r\n\r\n{text}", text.len()).expect("it is written");
        self.to.flush().expect("it is sent");
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    fn read(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            self.from.read_line(&mut line).expect("a line");
            let line = line.trim();
            if line.is_empty() {
                break;
            }
            if let Some((name, n)) = line.split_once(':')
                && name.eq_ignore_ascii_case("content-length")
            {
                length = n.trim().parse().expect("a number");
            }
        }
        let mut bytes = vec![0; length];
        self.from.read_exact(&mut bytes).expect("a message");
        serde_json::from_slice(&bytes).expect("JSON")
    }

    /// The whole answer to a request.
    fn answer(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = self.next;
        self.send(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.read();
            if message["id"] == id {
                return message;
            }
            self.heard.push(message);
        }
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        let answer = self.answer(method, params);
        assert!(answer["error"].is_null(), "{method}: {answer}");
        answer["result"].clone()
    }

    /// What is wrong in a file, when the server has said it.
    fn diagnostics(&mut self, uri: &str, version: i64) -> Vec<Value> {
        loop {
            let found = self
                .heard
                .iter()
                .find(|m| m["params"]["uri"] == uri && m["params"]["version"] == version);
            if let Some(m) = found {
                return m["params"]["diagnostics"]
                    .as_array()
                    .expect("a list")
                    .clone();
            }
            let message = self.read();
            self.heard.push(message);
        }
    }

    fn open(&mut self, file: &Path) -> String {
        let uri = format!("file://{}", file.display());
        let text = std::fs::read_to_string(file).expect("a file");
        self.tell("textDocument/didOpen", json!({ "textDocument": { "uri": uri, "languageId": "bmod", "version": 1, "text": text } }));
        uri
    }

    fn end(mut self) {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        assert!(self.server.wait().expect("it ends").success());
    }
}

/// Where the `n`th time (from 0) a text has `what`.
fn at(text: &str, what: &str, n: usize) -> Value {
    let (offset, _) = text.match_indices(what).nth(n).expect("the text has it");
    let before = &text[..offset];
    let start = before.rfind('\n').map_or(0, |n| n + 1);
    json!({ "line": before.matches('\n').count(), "character": before[start..].encode_utf16().count() })
}

/// Every request on the first wall, whose model lies in another file.
#[test]
fn every_request() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("models");
    let file = folder.join("wall.blk");
    let text = std::fs::read_to_string(&file).expect("a model");
    let mut c = Client::new();
    let uri = c.open(&file);
    assert_eq!(c.diagnostics(&uri, 1), Vec::<Value>::new());
    let document = json!({ "uri": uri });
    let here = |place: Value| json!({ "textDocument": document, "position": place });
    let whole = json!({ "textDocument": document });

    let hover = c.ask("textDocument/hover", here(at(&text, "static using", 0)));
    assert!(
        hover["contents"]["value"]
            .as_str()
            .expect("words")
            .contains("static theorem"),
        "{hover}"
    );
    // A name declared in the file that this one includes, and the name of that file.
    for word in ["static using", "block_limit.blk\n"] {
        let found = c.ask("textDocument/definition", here(at(&text, word, 0)));
        let file = found[0]["uri"].as_str().expect("a file");
        assert!(file.ends_with("models/block_limit.blk"), "{found}");
    }
    let mut params = here(at(&text, "alpha;", 0));
    params["context"] = json!({ "includeDeclaration": true });
    let found = c.ask("textDocument/references", params);
    let in_file = |name: &str| {
        found
            .as_array()
            .expect("a list")
            .iter()
            .filter(|l| l["uri"].as_str().is_some_and(|u| u.ends_with(name)))
            .count()
    };
    assert!(
        in_file("wall.blk") >= 2
            && in_file("block_limit.blk") >= 3
            && in_file("mechanism.blk") >= 1,
        "{found}"
    );
    let items = c.ask(
        "textDocument/completion",
        here(at(&text, "static using", 0)),
    );
    assert!(
        items
            .as_array()
            .expect("a list")
            .iter()
            .any(|i| i["label"] == "kinematic"),
        "{items}"
    );
    let name = c.ask("textDocument/prepareRename", here(at(&text, "alpha;", 0)));
    assert_eq!(name["placeholder"], "alpha");
    let mut params = here(at(&text, "alpha;", 0));
    params["newName"] = json!("load");
    let edit = c.ask("textDocument/rename", params.clone());
    assert!(
        edit["changes"].as_object().expect("by file").len() >= 3,
        "{edit}"
    );
    params["newName"] = json!("a b");
    let refused = c.answer("textDocument/rename", params);
    assert!(
        refused["error"]["message"]
            .as_str()
            .expect("why")
            .contains("no name")
    );
    let symbols = c.ask("textDocument/documentSymbol", whole.clone());
    let names: Vec<&str> = symbols
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|s| s["name"].as_str())
        .collect();
    assert_eq!(
        names,
        [
            "course",
            "pos",
            "len",
            "solve static using lp maximizing alpha",
            "solve kinematic using lp minimizing rate"
        ]
    );
    assert!(
        c.ask("textDocument/foldingRange", whole.clone())
            .as_array()
            .expect("a list")
            .len()
            > 2
    );
    let tokens = c.ask("textDocument/semanticTokens/full", whole.clone());
    assert_eq!(tokens["data"].as_array().expect("numbers").len() % 5, 0);
    let signature = c.ask(
        "textDocument/signatureHelp",
        here(at(&text, "pos) 'length", 0)),
    );
    assert_eq!(
        (
            &signature["signatures"][0]["label"],
            &signature["activeParameter"]
        ),
        (&json!("len(course,pos)"), &json!(1))
    );
    let mut params = whole.clone();
    params["options"] = json!({ "tabSize": 3, "insertSpaces": true });
    assert_eq!(c.ask("textDocument/formatting", params), json!([]));
    let lenses = c.ask("textDocument/codeLens", whole.clone());
    assert_eq!(lenses.as_array().expect("a list").len(), 4);

    // A slip: what is wrong, and what mends it.
    let mut place = at(&text, "static using", 0);
    let end = json!({ "line": place["line"], "character": place["character"].as_u64().expect("a number") + 6 });
    let range = json!({ "start": place.take(), "end": end });
    c.tell("textDocument/didChange", json!({ "textDocument": { "uri": uri, "version": 2 }, "contentChanges": [{ "range": range, "text": "statik" }] }));
    let wrong = c.diagnostics(&uri, 2);
    assert_eq!(
        (wrong.len(), &wrong[0]["code"], &wrong[0]["range"]),
        (1, &json!("E0301"), &range),
        "{wrong:?}"
    );
    let actions = c.ask(
        "textDocument/codeAction",
        json!({ "textDocument": document, "range": range, "context": { "diagnostics": wrong } }),
    );
    assert_eq!(actions[0]["edit"]["changes"][&uri][0]["newText"], "static");
    c.tell("textDocument/didChange", json!({ "textDocument": { "uri": uri, "version": 3 }, "contentChanges": [{ "range": range, "text": "static" }] }));
    assert_eq!(c.diagnostics(&uri, 3), Vec::<Value>::new());

    let unknown = c.answer("textDocument/nonsense", whole);
    assert_eq!(unknown["error"]["code"], -32601);
    c.end();
}

/// A file that is only included is checked with the model beside it that includes it.
#[test]
fn a_part_of_a_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::write(
        folder.join("a main.blk"),
        "Set i / a, b /;\n$include part.blk\ndisplay p;\n",
    )
    .expect("written");
    std::fs::write(folder.join("part.blk"), "Parameter p(i) / a 1, b 2 /;\n").expect("written");
    let mut c = Client::new();
    let uri = c.open(&folder.join("part.blk"));
    assert_eq!(c.diagnostics(&uri, 1), Vec::<Value>::new());
    c.tell("textDocument/didChange", json!({ "textDocument": { "uri": uri, "version": 2 }, "contentChanges": [{ "text": "Parameter p(i) / a 1, c 2 /;\n" }] }));
    let wrong = c.diagnostics(&uri, 2);
    assert_eq!(wrong.len(), 1, "{wrong:?}");
    // The model has the file as it was saved when its text is closed.
    let main = c.open(&folder.join("a main.blk")).replace(" ", "%20");
    assert_eq!(c.diagnostics(&main, 1), Vec::<Value>::new());
    c.heard.clear();
    c.tell(
        "textDocument/didClose",
        json!({ "textDocument": { "uri": uri } }),
    );
    let told = |c: &mut Client| loop {
        let m = c.read();
        if m["params"]["uri"] == main.as_str() {
            return m["params"]["diagnostics"].clone();
        }
    };
    assert_eq!(told(&mut c), json!([]));
    // Its name only ends like that of the file that is included.
    std::fs::write(folder.join("t.blk"), "Scalar y;\ny = q;\n").expect("written");
    let uri = c.open(&folder.join("t.blk"));
    assert_eq!(c.diagnostics(&uri, 1).len(), 1);
    c.end();
}

/// The lens at a `solve`: the model is run as a process of its own, and what it says comes as a message.
#[test]
fn a_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("m.blk");
    std::fs::write(&file, "Scalar s / 5 /;\ndisplay s;\n").expect("written");
    let mut c = Client::new();
    c.open(&file);
    c.ask(
        "workspace/executeCommand",
        json!({ "command": "bmod.run", "arguments": [format!("file://{}", file.display())] }),
    );
    let shown = loop {
        let m = c.read();
        if m["method"] == "window/showMessage" {
            break m;
        }
    };
    assert!(
        shown["params"]["message"]
            .as_str()
            .expect("words")
            .contains('5'),
        "{shown}"
    );
    let refused = c.answer(
        "workspace/executeCommand",
        json!({ "command": "rm", "arguments": [] }),
    );
    assert!(
        refused["error"]["message"]
            .as_str()
            .expect("why")
            .contains("no command")
    );
    c.end();
}
