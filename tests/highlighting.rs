//! Highlighting for editors is made from the tables of the language: the grammar of TextMate (Visual Studio Code), the syntax
//! of Vim, the words of Emacs and of tree-sitter. `BMOD_WRITE=1 cargo test --test all highlighting::` writes the files; without it they are
//! compared.

use bmod::check::functions;
use bmod::editor::vocabulary::{self as words, Entry};
use serde_json::{Value, json};
use std::path::Path;

/// Words that declare, beside the kinds of variables.
const DECLARATIONS: &[&str] = &[
    "set",
    "singleton",
    "alias",
    "parameter",
    "scalar",
    "table",
    "variable",
    "equation",
    "model",
    "acronym",
    "file",
    "figure",
];
/// Words that belong to the `variable` behind them.
const KINDS: &[&str] = &[
    "positive",
    "nonnegative",
    "negative",
    "free",
    "binary",
    "integer",
    "semicont",
    "semiint",
    "sos1",
    "sos2",
];
/// Words inside of a statement that are not names there.
const INSIDE: &[&str] = &[
    "using",
    "minimizing",
    "maximizing",
    "minimize",
    "maximize",
    "scenario",
    "do",
    "then",
    "to",
    "downto",
    "by",
];
const CONSTANTS: &[&str] = &["inf", "eps", "na", "undf", "yes", "no", "all"];

fn named(list: &[Entry]) -> Vec<&'static str> {
    list.iter()
        .map(|e| e.word)
        .filter(|w| w.as_bytes()[0].is_ascii_alphabetic())
        .collect()
}

/// Words by what they are coloured as.
struct Words {
    declarations: Vec<String>,
    statements: Vec<&'static str>,
    operators: Vec<&'static str>,
    functions: Vec<&'static str>,
    directives: Vec<&'static str>,
    attributes: Vec<&'static str>,
}

fn all() -> Words {
    let plural = |w: &&str| match *w {
        "alias" => "alias(?:es)?".to_owned(),
        w if w.ends_with(['1', '2']) => w.to_owned(),
        w if matches!(
            w,
            "set"
                | "parameter"
                | "scalar"
                | "table"
                | "variable"
                | "equation"
                | "model"
                | "acronym"
                | "file"
        ) =>
        {
            format!("{w}s?")
        }
        w => w.to_owned(),
    };
    let mut statements = named(words::STATEMENTS);
    statements.retain(|w| !DECLARATIONS.contains(w) && !KINDS.contains(w));
    statements.extend([
        "puttl", "puthd", "putpage", "options", "endif", "endloop", "endwhile", "endfor",
    ]);
    // `min` and `max` are functions too: only a parenthesis tells.
    statements.extend(INSIDE);
    let mut operators = named(words::INNER);
    operators.retain(|w| !CONSTANTS.contains(w) && !statements.contains(w));
    operators.extend(["eq", "ne", "lt", "le", "gt", "ge"]);
    let mut functions: Vec<&str> = functions::names().collect();
    let mut attributes: Vec<&str> = [
        words::RECORD_ATTRIBUTES,
        words::LABEL_ATTRIBUTES,
        words::MODEL_ATTRIBUTES,
    ]
    .into_iter()
    .flat_map(named)
    .collect();
    let mut directives = named(words::DIRECTIVES);
    for list in [
        &mut statements,
        &mut operators,
        &mut functions,
        &mut attributes,
        &mut directives,
    ] {
        list.sort_unstable();
        list.dedup();
    }
    Words {
        declarations: DECLARATIONS.iter().chain(KINDS).map(plural).collect(),
        statements,
        operators,
        functions,
        directives,
        attributes,
    }
}

fn text_mate(w: &Words) -> String {
    let one_of = |list: &[&str]| list.join("|");
    let rule =
        |name: &str, pattern: String| json!({ "name": format!("{name}.bmod"), "match": pattern });
    let block = |name: &str, word: &str, end: &str| -> Value {
        json!({
            "name": format!("{name}.bmod"),
            "begin": format!(r"(?i)^\s*\$+\s*{word}\b"), "end": format!(r"(?i)^\s*\$+\s*{end}\b"),
            "beginCaptures": { "0": { "name": "keyword.control.directive.bmod" } },
            "endCaptures": { "0": { "name": "keyword.control.directive.bmod" } },
        })
    };
    let grammar = json!({
        "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
        "comment": "Made from the tables of the language by `BMOD_WRITE=1 cargo test --test all highlighting::`.",
        "name": "bmod",
        "scopeName": "source.bmod",
        "fileTypes": ["blk", "gms"],
        "patterns": [
            block("comment.block", "ontext", "offtext"),
            block("string.unquoted", "onecho[sv]?", "offecho"),
            rule("comment.line.documentation", r"^\*[=>#!].*$".into()),
            rule("comment.line.asterisk", r"^\*.*$".into()),
            {
                "match": r"(?i)^\s*(\$+\s*(?:title|include|batinclude|set|setglobal|setlocal|gdxin|gdxout|goto|label|log|echo))\b(.*)$",
                "captures": {
                    "1": { "name": "keyword.control.directive.bmod" },
                    "2": { "name": "string.unquoted.bmod", "patterns": [{ "include": "#percent" }] },
                },
            },
            rule("keyword.control.directive", format!(r"(?i)^\s*\$+\s*(?:{})\b", one_of(&w.directives))),
            rule("keyword.control.directive", r"(?i)^\$+\s*[a-z]+".into()),
            rule("comment.line.double-slash", r"//.*$".into()),
            rule("comment.line.bang", r"!!.*$".into()),
            rule("string.quoted.single", r"'[^'\n]*'".into()),
            rule("string.quoted.double", "\"[^\"\\n]*\"".into()),
            { "include": "#percent" },
            rule("keyword.operator.relation", r"(?i)=[elgnxcb]=".into()),
            { "match": format!(r"(?i)(?<=[\w)\]])(\.)({})\b", one_of(&w.attributes)), "captures": { "2": { "name": "variable.other.property.bmod" } } },
            rule("storage.type", format!(r"(?i)(?<![\w.])(?:{})\b(?!\s*[.=]|(?<!s)\()", w.declarations.join("|"))),
            rule("support.function", format!(r"(?i)(?<![\w.])(?:{})(?=\s*[(\[{{])", one_of(&w.functions))),
            rule("constant.language", r"(?i)(?<![\w.])(?:pi)\b".into()),
            rule("keyword.control", format!(r"(?i)(?<![\w.])(?:{})\b(?!\s*\.[a-z])", one_of(&w.statements))),
            rule("keyword.operator.word", format!(r"(?i)(?<![\w.])(?:{})\b", one_of(&w.operators))),
            rule("constant.language", format!(r"(?i)(?<![\w.])(?:{})\b", CONSTANTS.join("|"))),
            { "match": r"(?i)^\s*([a-z]\w*)(?:\([^()]*(?:\([^()]*\)[^()]*)*\))?(?:\$[^.]*)?\s*(?=\.\.)", "captures": { "1": { "name": "entity.name.function.equation.bmod" } } },
            rule("constant.numeric", r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?!\w)".into()),
            rule("keyword.operator", r"\.\.|:=|\$=|<=>|<=|>=|<>|->|\*\*|[-+*/=<>$]".into()),
        ],
        "repository": {
            "percent": { "name": "variable.other.constant.bmod", "match": r"%[A-Za-z_][\w.]*%" },
        },
    });
    serde_json::to_string_pretty(&grammar).expect("JSON") + "\n"
}

fn vim(w: &Words) -> String {
    let words = |list: &[&str]| list.join(" ");
    let declarations: Vec<String> = w
        .declarations
        .iter()
        .map(|d| d.replace("(?:es)?", "").replace("s?", "[s]"))
        .collect();
    format!(
        "\" Made from the tables of the language by `BMOD_WRITE=1 cargo test --test all highlighting::`.
if exists('b:current_syntax')
  finish
endif
syntax case ignore
syntax keyword bmodType {}
syntax keyword bmodStatement {}
syntax keyword bmodOperator {}
syntax keyword bmodConstant {} pi
syntax match bmodFunction /\\<\\%({}\\)\\ze\\s*[([{{]/
syntax match bmodAttribute /[[:alnum:]_)]\\.\\zs\\%({}\\)\\>/
syntax match bmodDirective /^\\s*\\$\\+\\s*\\a\\+/
syntax match bmodNumber /\\<\\d\\+\\%(\\.\\d*\\)\\?\\%([eE][-+]\\?\\d\\+\\)\\?\\>/
syntax match bmodRelation /=[elgnxcb]=\\|\\.\\./
syntax match bmodVariable /%[[:alpha:]_][[:alnum:]_.]*%/
syntax region bmodString start=/'/ end=/'/ oneline
syntax region bmodString start=/\"/ end=/\"/ oneline
syntax match bmodComment /^\\*.*$/
syntax match bmodComment /\\/\\/.*$/
syntax region bmodComment start=/^\\s*\\$\\+\\s*ontext\\>/ end=/^\\s*\\$\\+\\s*offtext\\>/
highlight default link bmodType Type
highlight default link bmodStatement Statement
highlight default link bmodOperator Operator
highlight default link bmodConstant Constant
highlight default link bmodFunction Function
highlight default link bmodAttribute Identifier
highlight default link bmodDirective PreProc
highlight default link bmodNumber Number
highlight default link bmodRelation Operator
highlight default link bmodVariable Macro
highlight default link bmodString String
highlight default link bmodComment Comment
let b:current_syntax = 'bmod'
",
        declarations.join(" "),
        words(&w.statements),
        words(&w.operators),
        CONSTANTS.join(" "),
        w.functions.join("\\|"),
        w.attributes.join("\\|"),
    )
}

fn emacs(w: &Words) -> String {
    let list = |name: &str, words: &[&str]| {
        let words: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
        format!("(defconst bmod-{name}\n  '({}))\n\n", words.join(" "))
    };
    let mut declarations: Vec<String> = Vec::new();
    for d in &w.declarations {
        let singular = d.replace("(?:es)?", "").replace("s?", "");
        if singular != *d {
            declarations.push(format!("{singular}s"));
        }
        declarations.push(singular);
    }
    let declarations: Vec<&str> = declarations.iter().map(String::as_str).collect();
    format!(
        ";;; bmod-words.el --- the words of bmod  -*- lexical-binding: t -*-
;; Made from the tables of the language by `BMOD_WRITE=1 cargo test --test all highlighting::`.

{}{}{}{}{}(provide 'bmod-words)
;;; bmod-words.el ends here
",
        list("declarations", &declarations),
        list("statements", &w.statements),
        list("operators", &w.operators),
        list("functions", &w.functions),
        list("constants", CONSTANTS),
    )
}

/// The words that tree-sitter's grammar is made with: they begin statements.
fn tree_sitter_words(w: &Words) -> String {
    let types = w.declarations.iter().map(|d| d.replace("?:", ""));
    let (tables, types): (Vec<_>, Vec<_>) = types
        .filter(|d| d != "singleton" && !KINDS.contains(&d.as_str()))
        .partition(|d| d.starts_with("table"));
    let keywords: Vec<_> = w
        .statements
        .iter()
        .filter(|s| !INSIDE.contains(s))
        .collect();
    let words = json!({
        "comment": "Made from the tables of the language by `BMOD_WRITE=1 cargo test --test all highlighting::`.",
        "types": types, "kinds": KINDS, "tables": tables, "keywords": keywords,
    });
    serde_json::to_string_pretty(&words).expect("JSON") + "\n"
}

/// What tree-sitter's nodes are coloured as; of two patterns the second counts.
fn tree_sitter_query(w: &Words) -> String {
    let words = |pattern: &str, name: &str, list: &[&str]| {
        format!(
            "({pattern}\n  (#match? @{name} \"^(?i:{})$\"))\n",
            list.join("|")
        )
    };
    let constants = [CONSTANTS, &["pi"]].concat();
    [
        "; Made from the tables of the language by `BMOD_WRITE=1 cargo test --test all highlighting::`.
(comment) @comment
((comment) @comment.doc
  (#match? @comment.doc \"^[*][=>#!]\"))
(directive_word) @preproc
(directive_text) @string.special
[(type) (table_word)] @type
(keyword) @keyword
(string) @string
(text) @string
(number) @number
(percent) @constant
[(relation) (operator) \"..\"] @operator
[\"(\" \")\" \"[\" \"]\" \"{\" \"}\"] @punctuation.bracket
[\";\" \",\"] @punctuation.delimiter
(declared name: (name) @variable)
(definition . (name) @function)
(definition . (call function: (name) @function))
"
        .into(),
        words("(call function: (name) @function.builtin)", "function.builtin", &w.functions),
        words("(name) @keyword.operator", "keyword.operator", &w.operators),
        words("(name) @constant.builtin", "constant.builtin", &constants),
        words("(label) @constant.builtin", "constant.builtin", &constants),
        words("(statement (name) @keyword)", "keyword", INSIDE),
        words("(attribute name: (name) @property)", "property", &w.attributes),
    ]
    .concat()
}

#[test]
fn files_for_editors() {
    let w = all();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("editors");
    for (file, text) in [
        ("vscode/syntaxes/bmod.tmLanguage.json", text_mate(&w)),
        ("vim/syntax/bmod.vim", vim(&w)),
        ("emacs/bmod-words.el", emacs(&w)),
        ("tree-sitter-bmod/words.json", tree_sitter_words(&w)),
        (
            "tree-sitter-bmod/queries/highlights.scm",
            tree_sitter_query(&w),
        ),
    ] {
        let file = folder.join(file);
        if std::env::var_os("BMOD_WRITE").is_some() {
            std::fs::write(&file, text).expect("written");
            continue;
        }
        let there = std::fs::read_to_string(&file).unwrap_or_default();
        assert!(
            there == text,
            "{} is not what the tables say: BMOD_WRITE=1 cargo test --test all highlighting::",
            file.display()
        );
    }
}
