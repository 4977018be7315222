//! Statements of other languages: AMPL, MiniZinc, Pyomo, JuMP, MATLAB, LINGO, spreadsheets; and keywords that are misspelled.
//!
//! Only statements that did not parse come here, so nothing legal is refused.

use super::explain::{Explanation, Failure, GoOn, closing};
use super::words::{self, Class};
use crate::diag::{Diagnostic, nearest};
use crate::source::Span;

/// Where a statement comes from. What is said about a language is said once: a file in another language is one mistake.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Language {
    /// A statement that many languages have: each is explained.
    Any,
    /// `for … end` and `if … end` of other languages.
    Blocks,
    Ampl,
    MiniZinc,
    Python,
    Julia,
    Matlab,
    Lingo,
}

/// How a word must stand to begin a statement of another language.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Stands {
    /// It is no name: neither `=`, `(`, `.` nor `$` follows.
    Alone,
    /// `:` follows.
    Colon,
    /// A type or a range follows: `var int: x`, `var 0..10: x`.
    Typed,
    /// `(` follows, or anything that makes it no name.
    Call,
    /// `=` follows.
    Equals,
}

/// Words that begin statements of other languages.
struct Idiom {
    words: &'static [&'static str],
    stands: Stands,
    language: Language,
    message: &'static str,
    help: &'static str,
}

const OBJECTIVE: &str = "write `variable z; equation obj; obj.. z =e= …; model m / all /; solve m using lp minimizing z;`";
const CONSTRAINT: &str =
    "declare `equation e(i);`, define it with `e(i).. … =l= …;` and list it in a model";
const PROGRAM: &str = "a model declares sets, parameters, variables and equations, and says `solve m using lp minimizing z;`; the rest of this text was not read";
const SHOW: &str = "write `display x.l, p;`; formatted text is written with `put`";
const LP: &str = "declare `variable x, y, z; equation obj, c1;`, define `obj.. z =e= 3*x + 2*y;` and `c1.. x + y =l= 4;`, then `model m / all /; solve m using lp minimizing z;`";

#[rustfmt::skip]
const IDIOMS: &[Idiom] = &[
    Idiom { words: &["param", "par"], stands: Stands::Alone, language: Language::Ampl,
        message: "parameters are declared with `parameter` or `scalar`",
        help: "write `parameter p(i) / a 1, b 2 /;` or `scalar n / 5 /;`" },
    Idiom { words: &["int", "float", "bool", "array"], stands: Stands::Alone, language: Language::MiniZinc,
        message: "this is a declaration of MiniZinc",
        help: "numbers are declared with `scalar n / 4 /;` or `parameter p(i) / a 1, b 2 /;`, unknowns with `variable x(i);`" },
    Idiom { words: &["double", "string", "const", "auto", "real", "number", "constant", "constants", "index", "indices", "vector", "matrix"], stands: Stands::Alone, language: Language::Any,
        message: "this is not a declaration of this language",
        help: "numbers are declared with `scalar` or `parameter`, sets with `set`, unknowns with `variable`" },
    Idiom { words: &["var"], stands: Stands::Typed, language: Language::MiniZinc,
        message: "variables are declared with `variable`",
        help: "write `variable x;`; bounds are assigned afterwards: `x.lo = 0; x.up = 10;`" },
    Idiom { words: &["var", "vars", "dvar"], stands: Stands::Alone, language: Language::Ampl,
        message: "variables are declared with `variable`",
        help: "write `positive variable x(i);`; bounds are assigned afterwards: `x.up(i) = 5;`" },
    Idiom { words: &["subject", "such"], stands: Stands::Alone, language: Language::Ampl,
        message: "constraints are equations here", help: CONSTRAINT },
    Idiom { words: &["constraint", "constraints", "restriction", "restrictions"], stands: Stands::Alone, language: Language::MiniZinc,
        message: "constraints are equations here", help: CONSTRAINT },
    Idiom { words: &["minimize", "minimise", "maximize", "maximise", "min", "max", "minimizing", "maximizing", "objective"],
        stands: Stands::Alone, language: Language::Ampl,
        message: "the objective is a variable that an equation defines", help: OBJECTIVE },
    Idiom { words: &["minimize", "maximize"], stands: Stands::Call, language: Language::Any,
        message: "the objective is a variable that an equation defines", help: OBJECTIVE },
    Idiom { words: &["max", "min"], stands: Stands::Equals, language: Language::Lingo,
        message: "the objective is a variable that an equation defines", help: OBJECTIVE },
    Idiom { words: &["let"], stands: Stands::Alone, language: Language::Any,
        message: "an assignment begins with the name", help: "write `a = 4;` or `p(i) = 4;`" },
    Idiom { words: &["fix"], stands: Stands::Alone, language: Language::Any,
        message: "a variable is fixed by its attribute `.fx`", help: "write `x.fx = 4;`" },
    Idiom { words: &["data", "reset", "commands", "end"], stands: Stands::Alone, language: Language::Ampl,
        message: "this is not a statement of this language",
        help: "leave it out; data stand with their declarations, `parameter p(i) / a 1, b 2 /;`, or in a file, `$include data.inc`" },
    Idiom { words: &["check", "assert"], stands: Stands::Colon, language: Language::Any,
        message: "a check is written with `abort`", help: "write `abort$(not condition) 'what is wrong';`" },
    Idiom { words: &["sets", "data", "model", "calc"], stands: Stands::Colon, language: Language::Lingo,
        message: "sections with a colon are LINGO's", help: "write `set i / a, b /; parameter p(i) / a 1, b 2 /;`" },
    Idiom { words: &["endsets", "enddata"], stands: Stands::Alone, language: Language::Lingo,
        message: "sections with a colon are LINGO's", help: "leave it out" },
    Idiom { words: &["st"], stands: Stands::Alone, language: Language::Lingo,
        message: "constraints are equations here", help: LP },
    Idiom { words: &["bounds"], stands: Stands::Alone, language: Language::Lingo,
        message: "bounds are assigned", help: "write `x.lo = 0; x.up = 5;`" },
    Idiom { words: &["include"], stands: Stands::Alone, language: Language::Any,
        message: "`include` is a directive: it begins with `$` in the first column", help: "write `$include data.inc`" },
    Idiom { words: &["print", "println", "printf", "show", "echo", "writeln", "disp", "fprintf"], stands: Stands::Call, language: Language::Any,
        message: "values are shown with `display`", help: SHOW },
    Idiom { words: &["export", "save", "write", "dump"], stands: Stands::Call, language: Language::Any,
        message: "values are written to files with `execute_unload`",
        help: "write `execute_unload 'results.csv', x;`; formatted text is written with `put`" },
    Idiom { words: &["load", "read"], stands: Stands::Call, language: Language::Any,
        message: "data are read by directives",
        help: "write `$include data.inc` for statements; `$gdxIn data.csv` and `$load p` for the values of `p`" },
    Idiom { words: &["output"], stands: Stands::Alone, language: Language::MiniZinc,
        message: "values are shown with `display`", help: SHOW },
    Idiom { words: &["plot", "scatter", "chart"], stands: Stands::Call, language: Language::Any,
        message: "pictures are drawn with `figure` and `draw`",
        help: "write `figure f { polyline(t) x = ord(t), y = p(t); };` and `draw f 'f.svg';`" },
    Idiom { words: &["def", "import", "from", "class", "async", "try", "with"], stands: Stands::Alone, language: Language::Python,
        message: "this is a Python program, not a model", help: PROGRAM },
    Idiom { words: &["using"], stands: Stands::Alone, language: Language::Julia,
        message: "this is a Julia program, not a model", help: PROGRAM },
    Idiom { words: &["function"], stands: Stands::Alone, language: Language::Matlab,
        message: "this is a program, not a model; there are no functions to declare",
        help: "a formula that is used often can be a `$macro f(x) (…)`; the rest of this text was not read" },
    Idiom { words: &["return"], stands: Stands::Alone, language: Language::Blocks,
        message: "there are no functions to return from", help: "a formula that is used often can be a `$macro f(x) (…)`" },
    Idiom { words: &["cvx_begin", "clear", "clc", "close"], stands: Stands::Alone, language: Language::Any,
        message: "this is a command of MATLAB", help: "leave it out: a model starts with nothing in it" },
    Idiom { words: &["forall"], stands: Stands::Call, language: Language::Any,
        message: "an equation holds for all elements of the index behind its name",
        help: "write `e(i).. x(i) =l= 4;`; statements are repeated by `loop(i, … );`" },
    Idiom { words: &["stop", "quit", "exit"], stands: Stands::Call, language: Language::Any,
        message: "a model ends where its text ends", help: "leave it out; `$exit` ends the text here, `abort 'why';` the run" },
    Idiom { words: &["do", "begin"], stands: Stands::Alone, language: Language::Blocks,
        message: "blocks begin with `loop`, `for`, `while`, `repeat` or `if`", help: "write `while(a < 5, … );` or `repeat … until a >= 5;`" },
    Idiom { words: &["positive", "negative", "nonnegative", "free", "binary", "integer"], stands: Stands::Call, language: Language::Any,
        message: "the word `variable` is missing", help: "write `positive variable x;`, `free variable z;` …" },
    Idiom { words: &["endif", "endfor", "endwhile", "endloop", "done", "fi"], stands: Stands::Alone, language: Language::Blocks,
        message: "blocks end with `);`", help: "write `if(c, … );`; `$onEnd` allows `if c then … endif;`" },
];

/// What only one language has, wherever it stands in a line.
#[rustfmt::skip]
const TRACES: &[(Language, &[&str])] = &[
    (Language::Python, &[
        "concretemodel(", "abstractmodel(", "solverfactory(", "nonnegativereals", "pyo.", "np.array", "=lambda ", "= lambda ", "(lambda ", "quicksum(", "addconstr(",
        "addvar(", "setobjective(", "lpproblem(", "lpvariable(", "initialize=",
    ]),
    (Language::Julia, &["highs.", "dict(", "optimize!(", "set_objective(", ".optimizer"]),
    (Language::Matlab, &["linprog(", "optimproblem(", "optimvar(", "sdpvar(", "zeros(", "ones(", "linspace("]),
];

/// Statements that other languages begin with other words, and misspelled keywords.
pub(super) fn statement(f: &Failure<'_>) -> Option<Explanation> {
    let text = f.text.trim_start();
    let lead = f.text.len() - text.len();
    let word = &text[..words::word_end(text.as_bytes(), 0)];
    let rest = text[word.len()..].trim_start();
    let lower = word.to_ascii_lowercase();
    let blocks = || match word.is_empty() || f.raw.class == Class::Equation {
        true => None,
        false => blocks(f, &lower, rest, lead),
    };
    let start = f.span(lead, lead);
    let found = comment(f, text, lead).or_else(|| line(f.expanded, start));
    if let Some(found) = found.or_else(blocks) {
        return Some(found);
    }
    if text.to_ascii_lowercase().starts_with("s.t.") {
        let d = f.error("E0231", lead, 4);
        let d = d.says("constraints are equations here").help(CONSTRAINT);
        return Some(said(d, Language::Ampl));
    }
    let found = IDIOMS
        .iter()
        .find(|i| i.words.contains(&lower.as_str()) && i.stands.fits(rest))
        .filter(|_| !rest.to_ascii_lowercase().starts_with("variable"));
    if let Some(i) = found {
        let d = f.error("E0231", lead, word.len());
        let mut found = said(d.says(i.message).help(i.help), i.language);
        if lower == "do" {
            found.go_on = line_end(f, lead);
        }
        return Some(found);
    }
    misspelled(f, word, rest, lead)
}

impl Stands {
    fn fits(self, rest: &str) -> bool {
        let equals = rest.starts_with('=') && !rest.starts_with("==");
        let name = equals || rest.starts_with(['(', '.', '$']);
        match self {
            Stands::Alone => !name,
            Stands::Colon => rest.starts_with(':'),
            Stands::Typed => {
                let types = ["int", "float", "bool", "set"];
                rest.starts_with(|c: char| c.is_ascii_digit())
                    || types.iter().any(|t| rest.starts_with(t))
            }
            Stands::Call => rest.starts_with('(') || !name,
            Stands::Equals => equals,
        }
    }
}

/// A message about a statement of a language: after a program in another language nothing more is read.
fn said(diagnostic: Diagnostic, language: Language) -> Explanation {
    let program = matches!(
        language,
        Language::Python | Language::Julia | Language::Matlab
    );
    Explanation {
        language,
        go_on: if program { GoOn::Nowhere } else { GoOn::Behind },
        ..Explanation::of(diagnostic)
    }
}

/// A comment mark of another language, or `*` within a line.
pub(super) fn no_comment(f: &Failure<'_>, at: usize, mark: &str) -> Diagnostic {
    const HELP: &str = "a comment is a line with `*` in its first column; in a `.blk` file also `//` to the end of the line; `$onEolCom` allows `!!`";
    let message = match mark {
        "*" => "`*` begins a comment only in the first column".to_owned(),
        _ => format!("`{mark}` does not begin a comment here"),
    };
    f.error("E0230", at, mark.len()).says(message).help(HELP)
}

/// Comment marks of other languages: their line is spoiled.
fn comment(f: &Failure<'_>, text: &str, lead: usize) -> Option<Explanation> {
    let mark = ["#=", "#", "//", "/*", "--", "%%", "%", "!", "\"\"\"", "*"];
    let mark = mark.into_iter().find(|m| text.starts_with(m))?;
    let name = text[1..].split_once('%').filter(|_| mark == "%");
    if name.is_some_and(|(name, _)| !name.contains(char::is_whitespace)) {
        // `%name%` without a value.
        return None;
    }
    let mut found = Explanation::of(no_comment(f, lead, mark));
    let lo = f.span(lead, lead + mark.len()).lo as usize;
    let closing = match mark {
        "/*" => "*/",
        "#=" => "=#",
        "\"\"\"" => "\"\"\"",
        _ => "\n",
    };
    let behind = &f.expanded[(lo + mark.len()).min(f.expanded.len())..];
    if let Some(n) = behind.find(closing) {
        found.go_on = GoOn::At((lo + mark.len() + n + closing.len()) as u32);
    }
    Some(found)
}

/// What the line on which a statement begins tells of its language, however the statement was cut.
pub(super) fn line(expanded: &str, statement: Span) -> Option<Explanation> {
    let lo = statement.lo as usize;
    let line = expanded[lo..].split('\n').next().unwrap_or("");
    let place = |at: usize, len: usize| Span::new((lo + at) as u32, (lo + at + len) as u32);
    if let Some(mut found) = macros(line, &place) {
        if found.language == Language::Lingo {
            found.go_on = GoOn::At((lo + behind(&expanded[lo..])) as u32);
        }
        return Some(found);
    }
    let word = &line[..words::word_end(line.as_bytes(), 0)];
    let (rest, lower) = (line[word.len()..].trim_start(), word.to_ascii_lowercase());
    let section = rest.starts_with(':') && !rest.starts_with(":=");
    let known = |i: &&Idiom| i.stands == Stands::Colon && i.words.contains(&lower.as_str());
    match IDIOMS.iter().find(known).filter(|_| section) {
        Some(i) => {
            let d = Diagnostic::error("E0231", place(0, word.len()));
            Some(said(d.says(i.message).help(i.help), i.language))
        }
        None => trace(line, &place),
    }
}

/// `@variable(m, x >= 0)`, `@SUM(…)`, `@m.Constraint(…)`
fn macros(text: &str, place: &dyn Fn(usize, usize) -> Span) -> Option<Explanation> {
    let name = text.strip_prefix('@')?;
    let len = words::word_end(name.as_bytes(), 0);
    let (word, rest) = (name[..len].to_ascii_lowercase(), &name[len..]);
    let (language, help) = match word.as_str() {
        "variable" => (
            Language::Julia,
            "write `positive variable x(i);`; bounds are assigned: `x.up(i) = 5;`; the rest of this text was not read",
        ),
        "constraint" | "nlconstraint" => (Language::Julia, CONSTRAINT),
        "objective" | "nlobjective" => (Language::Julia, OBJECTIVE),
        "expression" | "nlexpression" => (
            Language::Julia,
            "declare a variable and define it by an equation: `e.. total =e= x + y;`",
        ),
        "for" | "sum" => (
            Language::Lingo,
            "write `e(i).. sum(j, x(i,j)) =l= a(i);`: the equation's index says for which, the sum's over which",
        ),
        "gin" => (Language::Lingo, "write `integer variable x;`"),
        "bin" => (Language::Lingo, "write `binary variable x;`"),
        "free" => (Language::Lingo, "write `free variable x;`"),
        "bnd" => (Language::Lingo, "write `x.lo = 0; x.up = 5;`"),
        _ if rest.is_empty() || rest.starts_with('.') => (Language::Python, PROGRAM),
        _ => return None,
    };
    let origin = match language {
        Language::Julia => "this is JuMP, not a model of this language",
        Language::Lingo => "this is LINGO, not a model of this language",
        _ => "this is a Python program, not a model",
    };
    let d = Diagnostic::error("E0231", place(0, len + 1));
    Some(said(d.says(origin).help(help), language))
}

/// The end of the line: where a language without `;` is read on.
pub(super) fn line_end(f: &Failure<'_>, at: usize) -> GoOn {
    let lo = f.span(at, at).lo as usize;
    let line = memchr::memchr(b'\n', &f.expanded.as_bytes()[lo..]);
    line.map_or(GoOn::Behind, |n| GoOn::At((lo + n + 1) as u32))
}

/// `for i in I`, `if a > 1:`, `while c { … }`, `end`.
fn blocks(f: &Failure<'_>, word: &str, rest: &str, lead: usize) -> Option<Explanation> {
    let say = |message: String, help: &str| {
        let d = f.error("E0231", lead, word.len()).says(message).help(help);
        Some(said(d, Language::Blocks))
    };
    let second = rest[..words::word_end(rest.as_bytes(), 0)].to_ascii_lowercase();
    let head = rest.split('\n').next().unwrap_or("");
    match (word, second.as_str()) {
        ("end", "" | "for" | "if" | "while" | "loop" | "repeat") if Stands::Alone.fits(rest) => {
            let after = f
                .expanded
                .get(f.raw.span.hi as usize..)
                .unwrap_or("")
                .trim_start();
            let cut = words::word_end(after.as_bytes(), 0);
            let mut found = said(
                f.error("E0233", lead, 3).says("blocks end with `);`")
                    .help("write `for(k = 1 to n, … );` and `if(c, … );`"),
                Language::Blocks,
            );
            // `end if`: the splitter has cut before `if`.
            if second.is_empty()
                && matches!(
                    after[..cut].to_ascii_lowercase().as_str(),
                    "for" | "if" | "while" | "loop" | "repeat"
                )
            {
                let semicolon =
                    memchr::memchr(b';', after.as_bytes()).map_or(after.len(), |n| n + 1);
                found.go_on = GoOn::At((f.expanded.len() - after.len() + semicolon) as u32);
            } else if rest.starts_with('\n') || text_goes_on(f, lead) {
                found.go_on = line_end(f, lead);
            }
            Some(found)
        }
        ("for" | "forall", _)
            if head.to_ascii_lowercase().contains(" in ") && !rest.starts_with('(') =>
        {
            let python = head.trim_end().ends_with(':');
            let d = f.error("E0231", lead, word.len()).says("a loop over a set is written with `loop`")
                .help("write `loop(i, … );`; in an equation the index stands behind its name: `e(i).. …`");
            let blocks = [Language::Blocks, Language::Python];
            Some(said(d, blocks[usize::from(python)]))
        }
        ("for" | "while" | "if" | "loop", _) if body_in_braces(rest) => say(
            "statements are not grouped by braces".into(),
            "they stand inside of the parentheses, after a comma: `if(c, … );`, `while(c, … );`",
        ),
        // `p(i) = 1 if a(i) > 0;`: the splitter has cut before the word.
        ("for" | "if" | "while", _) if !rest.starts_with('(') && behind_code(f, lead) => Some(Explanation::of(
            f.error("E0232", lead, word.len()).says(format!("`{word}` cannot stand behind an expression"))
                .help("a condition stands behind `$`: `p(i)$(a(i) > 0) = …;`; an equation holds for all elements of the index behind its name, `e(i).. …`"),
        )),
        ("for" | "while" | "if" | "loop" | "elseif" | "else", _)
            if !rest.starts_with(['(', '[', '{']) =>
        {
            let mut found = say(
                format!("`{word}` needs parentheses around its condition and its statements"),
                match word {
                    "while" => "write `while(a < 5, … );`",
                    "for" => "write `for(k = 1 to n, … );`; over the elements of a set runs `loop(i, … );`",
                    "loop" => "write `loop(i, … );`",
                    _ => "write `if(c, … );`, `if(c, … ; else … );`",
                },
            )?;
            if head.trim_end().ends_with(':') {
                found.language = Language::Python;
                found.go_on = GoOn::Nowhere;
            }
            Some(found)
        }
        ("solve", "minimize" | "maximize" | "satisfy") => {
            let d = f.error("E0231", lead, 5)
                .says("`solve` names a model first")
                .help("write `model m / all /; solve m using lp minimizing z;`");
            Some(said(d, Language::MiniZinc))
        }
        ("solve", "" | "using" | "minimizing" | "maximizing") if f.raw.class == Class::Other => {
            Some(Explanation::of(
                f.error("E0218", lead, 5).says("`solve` names a model first")
                    .help("write `model m / all /; solve m using lp minimizing z;`"),
            ))
        }
        ("set" | "sets", "of") => {
            let d = f.error("E0231", lead, word.len())
                .says("the elements of a set stand between slashes")
                .help("write `set i / a, b, c /;` or `set t / 1*10 /;`");
            Some(said(d, Language::MiniZinc))
        }
        _ => None,
    }
}

/// Whether something other than a statement's end stands before a word on its line.
fn behind_code(f: &Failure<'_>, lead: usize) -> bool {
    let before = &f.expanded[..f.span(lead, lead).lo as usize];
    let line = before.rsplit('\n').next().unwrap_or("").trim_end();
    line.ends_with(|c: char| c.is_ascii_alphanumeric() || matches!(c, ')' | ']' | '}' | '\''))
}

fn text_goes_on(f: &Failure<'_>, lead: usize) -> bool {
    f.text[lead + 3..].contains('\n')
}

/// `(a < 3) { …`
fn body_in_braces(rest: &str) -> bool {
    let end = rest.starts_with('(').then(|| closing(rest.as_bytes(), 0));
    end.flatten()
        .is_some_and(|k| rest[k + 1..].trim_start().starts_with('{'))
}

/// A word that only another language has.
fn trace(line: &str, place: &dyn Fn(usize, usize) -> Span) -> Option<Explanation> {
    let lower = line.to_ascii_lowercase();
    let signs = TRACES.iter().flat_map(|t| t.1.iter().map(|s| (t.0, *s)));
    let sign = |(language, sign): (Language, &str)| {
        let len = sign.trim_end_matches(['(', ' ', '=']).len();
        Some((language, lower.find(sign)?, len))
    };
    let list = line.contains('[') && line.trim_end().ends_with(']');
    let list = list && line.contains(" for ") && line.contains(" in ");
    let list = list.then(|| (Language::Python, 0, line.trim_end().len()));
    let (language, at, len) = { signs }.find_map(sign).or(list)?;
    let name = match language {
        Language::Julia => "a Julia program",
        Language::Matlab => "a MATLAB program",
        _ => "a Python program",
    };
    let d = Diagnostic::error("E0231", place(at, len))
        .says(format!("this is {name}, not a model"))
        .help(PROGRAM);
    Some(said(d, language))
}

/// The kind of variables that a word of other languages means.
pub(super) fn variable_kind(word: &str) -> Option<&'static str> {
    Some(match word.to_ascii_lowercase().as_str() {
        "binary" | "bin" | "boolean" | "bool" => "binary",
        "integer" | "int" => "integer",
        "positive" | "nonnegative" | "nonneg" => "positive",
        "negative" => "negative",
        "semicont" => "semicont",
        "semiint" => "semiint",
        _ => return None,
    })
}

/// `paramter a(i) / … /;`
fn misspelled(f: &Failure<'_>, word: &str, rest: &str, lead: usize) -> Option<Explanation> {
    #[rustfmt::skip]
    const KEYWORDS: [&str; 22] = [
        "set", "sets", "parameter", "parameters", "scalar", "scalars", "table", "variable",
        "variables", "positive", "equation", "equations", "model", "solve", "display", "option",
        "alias", "acronym", "loop", "repeat", "figure", "abort",
    ];
    if f.raw.class != Class::Algebra || word.len() < 3 {
        return None;
    }
    let after = f.expanded[f.raw.span.hi as usize..].trim_start();
    if rest.is_empty() && after.to_ascii_lowercase().starts_with("variable") {
        #[rustfmt::skip]
        const KINDS: [&str; 8] = [
            "free", "positive", "nonnegative", "negative", "binary", "integer", "semicont",
            "semiint",
        ];
        let meant = nearest(word, KINDS).unwrap_or("positive");
        let d = f
            .error("E0219", lead, word.len())
            .says(format!("`{word}` is no kind of variable"))
            .label(format!("write `{meant}`"))
            .help(format!("there are: {}", KINDS.join(", ")));
        return Some(Explanation::of(d));
    }
    if !rest.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return None;
    }
    let meant = nearest(word, KEYWORDS)?;
    let next = &rest[..words::word_end(rest.as_bytes(), 0)];
    let meant = match next.to_ascii_lowercase().as_str() {
        "variable" | "variables" => "positive",
        _ => meant,
    };
    let d = f.error("E0219", lead, word.len());
    let d = d.says(format!("`{word}` is not a statement"));
    Some(Explanation::of(d.label(format!("write `{meant}`"))))
}

/// A keyword inside an expression, before which the splitter has cut: `b = if a > 0 then 1 else 2;`.
pub(super) fn keyword_inside(f: &Failure<'_>) -> Option<Explanation> {
    if f.at < f.text.trim_end().len() {
        return None;
    }
    let after = f.expanded.get(f.raw.span.hi as usize..)?.trim_start();
    let word = &after[..words::word_end(after.as_bytes(), 0)];
    let lo = f.expanded.len() - after.len();
    let span = Span::new(lo as u32, (lo + word.len()) as u32);
    words::statement_word(after, 0, word.len())?;
    let d = if f.text.trim().eq_ignore_ascii_case("abort") && word.eq_ignore_ascii_case("if") {
        Diagnostic::error("E0231", span)
            .says("a condition stands behind `$`")
            .help("write `abort$(a > 0) 'why';`")
    } else if f.raw.class.declares() || f.text.trim_start().len() < 8 && f.raw.class == Class::Other
    {
        words::reserved(word, span)
    } else if word.eq_ignore_ascii_case("if") && f.raw.class == Class::Algebra {
        Diagnostic::error("E0231", span)
            .says("`if` is a statement; it cannot stand in an expression")
            .help("write `ifThen(c, a, b)`, or `a$(c) + b$(not c)`")
    } else {
        return None;
    };
    Some(Explanation {
        go_on: GoOn::At((lo + behind(after)) as u32),
        ..Explanation::of(d)
    })
}

/// Behind the statement's `;`, parentheses respected.
pub(super) fn behind(text: &str) -> usize {
    let mut depth = 0usize;
    for (k, b) in text.bytes().enumerate() {
        match b {
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            b';' if depth == 0 => return k + 1,
            _ => {}
        }
    }
    memchr::memchr(b';', text.as_bytes()).map_or(text.len(), |n| n + 1)
}
