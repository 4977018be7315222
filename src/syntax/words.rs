//! The words that begin statements, and how the bytes of a text are classed.

use crate::diag::Diagnostic;
use crate::source::Span;

/// The kinds of statements that the splitter tells apart.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) enum Class {
    Set,
    Parameter,
    Variable,
    Equation,
    Acronym,
    File,
    Model,
    Table,
    Alias,
    /// A directive left by the preprocessor.
    Directive,
    /// An assignment, an equation, or what cannot be told.
    Algebra,
    /// Any other keyword.
    #[default]
    Other,
}

impl Class {
    /// Its data are numbers.
    pub(crate) fn has_values(self) -> bool {
        matches!(self, Class::Parameter | Class::Variable | Class::Equation)
    }

    /// Statements with names, texts and data.
    pub(crate) fn declares(self) -> bool {
        !matches!(
            self,
            Class::Alias | Class::Directive | Class::Algebra | Class::Other
        )
    }
}

/// A word that always begins a statement.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Word {
    /// `set`, `parameter` … never inside a block.
    Declaration,
    /// `loop`, `if` …: a block follows.
    Control,
    /// `endloop` … under `$onEnd`.
    EndControl,
    /// `else`, `elseif`.
    Inner,
    /// `until`, which ends a `repeat` under `$onEnd`.
    Until,
    /// `display`, `solve` …
    Action,
}

impl Word {
    /// Words that do not end a statement at the outermost level.
    pub(crate) fn inside_blocks_only(self) -> bool {
        matches!(self, Word::EndControl | Word::Inner | Word::Until)
    }
}

/// Blanks, line ends and the marks that old files end with.
pub(crate) fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | b'\r' | b'\n' | 0x0c | 0x0b | 0x1a | 0x1e)
}

/// The first byte of a name.
pub(crate) fn is_letter(b: u8) -> bool {
    b.is_ascii_alphabetic() || b == b'_'
}

/// The end of the word that begins at `i`.
pub(crate) fn word_end(bytes: &[u8], i: usize) -> usize {
    let mut end = i;
    while end < bytes.len() && (bytes[end].is_ascii_alphanumeric() || bytes[end] == b'_') {
        end += 1;
    }
    end
}

/// The first byte from `i` on that is no blank.
pub(crate) fn behind_blanks(bytes: &[u8], mut i: usize) -> usize {
    while i < bytes.len() && is_blank(bytes[i]) {
        i += 1;
    }
    i
}

/// The word in lower case, if it is short enough to be a keyword.
fn lower(word: &str, buffer: &mut [u8; 20]) -> Option<usize> {
    let b = word.as_bytes();
    if b.len() > buffer.len() || b.len() < 2 {
        return None;
    }
    for (to, from) in buffer.iter_mut().zip(b) {
        *to = from.to_ascii_lowercase();
    }
    Some(b.len())
}

fn kind(word: &[u8]) -> Option<(Word, Class)> {
    use Class as C;
    use Word as W;
    Some(match word {
        b"set" | b"sets" => (W::Declaration, C::Set),
        b"parameter" | b"parameters" | b"scalar" | b"scalars" => (W::Declaration, C::Parameter),
        b"variable" | b"variables" => (W::Declaration, C::Variable),
        b"equation" | b"equations" => (W::Declaration, C::Equation),
        b"acronym" | b"acronyms" => (W::Declaration, C::Acronym),
        b"file" | b"files" | b"function" | b"functions" => (W::Declaration, C::File),
        b"model" | b"models" => (W::Declaration, C::Model),
        b"table" | b"tables" => (W::Declaration, C::Table),
        b"alias" | b"aliases" => (W::Declaration, C::Alias),
        b"loop" | b"while" | b"for" | b"if" | b"repeat" => (W::Control, C::Other),
        b"endloop" | b"endwhile" | b"endfor" | b"endif" => (W::EndControl, C::Other),
        b"else" | b"elseif" => (W::Inner, C::Other),
        b"until" => (W::Until, C::Other),
        b"display" | b"abort" | b"option" | b"options" | b"solve" | b"put" | b"putclose"
        | b"puttl" | b"puthd" | b"putpage" | b"putclear" | b"execute" | b"executetool"
        | b"execute_unload" | b"execute_load" | b"execute_unloaddi" | b"execute_loaddc"
        | b"execute_loadpoint" | b"put_utility" | b"put_utilities" => (W::Action, C::Other),
        _ => return None,
    })
}

/// Kinds of variables, which need the word `variable` behind them here.
fn is_variable_kind(word: &[u8]) -> bool {
    matches!(
        word,
        b"free"
            | b"positive"
            | b"nonnegative"
            | b"negative"
            | b"binary"
            | b"integer"
            | b"semicont"
            | b"semiint"
            | b"sos1"
            | b"sos2"
    )
}

/// `file.nd`: the word means the file that `put` names last.
fn has_attribute(text: &str, end: usize) -> bool {
    text[end..].trim_start().starts_with('.')
}

/// Whether a word that [`kind`] knows is a name here: `file.nd = 3`, and `function` where no list like
/// `f /stolib.dnormal/` follows.
fn is_name(word: &[u8], text: &str, end: usize) -> bool {
    if word == b"file" {
        return has_attribute(text, end);
    }
    let list = || text[end..].split(';').next()?.split_once('/');
    let library = |(_, t): (&str, &str)| {
        let name = t.trim_start().get(..7);
        name.is_some_and(|n| n.eq_ignore_ascii_case("stolib."))
    };
    matches!(word, b"function" | b"functions") && !list().is_some_and(library)
}

/// The word after the blanks behind `end`.
fn next_word(text: &str, end: usize) -> &str {
    let i = behind_blanks(text.as_bytes(), end);
    &text[i..word_end(text.as_bytes(), i)]
}

/// Whether the word at `at..end` always begins a statement, and which kind.
pub(crate) fn statement_word(text: &str, at: usize, end: usize) -> Option<Word> {
    // Labels of a table begin most lines, and mostly with a number behind them.
    let numbered = text.as_bytes()[at..end]
        .last()
        .is_some_and(u8::is_ascii_digit);
    if numbered && !text[at..].starts_with(['s', 'S']) {
        return None;
    }
    let mut buffer = [0; 20];
    let n = lower(&text[at..end], &mut buffer)?;
    let word = &buffer[..n];
    if is_name(word, text, end) {
        return None;
    }
    if let Some((kind, _)) = kind(word) {
        return Some(kind);
    }
    let next = |wanted: &[&str]| {
        let next = next_word(text, end);
        wanted.iter().any(|w| next.eq_ignore_ascii_case(w))
    };
    let declares = is_variable_kind(word) && next(&["variable", "variables"])
        || word == b"singleton" && next(&["set", "sets"]);
    declares.then_some(Word::Declaration)
}

/// Whether a line of a table that begins with this word is the next statement: a label may be spelled
/// like a keyword, but then a number follows.
pub(crate) fn begins_statement_in_table(text: &str, at: usize, end: usize) -> bool {
    let Some(word) = statement_word(text, at, end) else {
        return false;
    };
    if word.inside_blocks_only() {
        return false;
    }
    // `set  3 4` is a row.
    let rest = &text[end..];
    let line = rest.lines().next().unwrap_or("").trim_start();
    !line.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '#'))
}

/// The class of the statement that begins at `at`, and the end of its keyword.
pub(crate) fn classify(text: &str, at: usize) -> (Class, usize) {
    let (class, end) = first_class(text, at);
    // `set table`, `variable table`
    if matches!(class, Class::Set | Class::Parameter | Class::Variable) {
        let next = next_word(text, end);
        if next.eq_ignore_ascii_case("table") || next.eq_ignore_ascii_case("tables") {
            let start = next.as_ptr() as usize - text.as_ptr() as usize;
            return (Class::Table, start + next.len());
        }
    }
    (class, end)
}

fn first_class(text: &str, at: usize) -> (Class, usize) {
    let bytes = text.as_bytes();
    let end = word_end(bytes, at);
    let mut buffer = [0; 20];
    let Some(n) = lower(&text[at..end], &mut buffer) else {
        return (Class::Algebra, end);
    };
    let word = &buffer[..n];
    if is_name(word, text, end) {
        return (Class::Algebra, end);
    }
    if let Some((_, class)) = kind(word) {
        return (class, end);
    }
    let second_end = |class| (class, word_end(bytes, behind_blanks(bytes, end)));
    match statement_word(text, at, end) {
        Some(Word::Declaration) if word == b"singleton" => return second_end(Class::Set),
        Some(Word::Declaration) => return second_end(Class::Variable),
        _ => {}
    }
    let begins: [&[u8]; 3] = [b"execute", b"put", b"embeddedcode"];
    let other = matches!(
        word,
        b"figure" | b"draw" | b"break" | b"continue" | b"endembeddedcode"
    ) || begins.iter().any(|b| word.starts_with(b));
    (if other { Class::Other } else { Class::Algebra }, end)
}

/// `figure`, whose block stands in braces.
pub(crate) fn is_figure(word: &str) -> bool {
    word.eq_ignore_ascii_case("figure")
}

/// Words with a meaning of their own in expressions, lists and declarations. (Those that begin statements never
/// come as names.)
pub(crate) fn is_reserved(name: &str) -> bool {
    const WORDS: [&str; 14] = [
        "all", "card", "eps", "inf", "na", "no", "not", "ord", "prod", "smax", "smin", "sum",
        "system", "yes",
    ];
    let name = name.to_ascii_lowercase();
    WORDS.contains(&name.as_str()) || is_variable_kind(name.as_bytes())
}

/// A word of the language stands where a name is declared.
pub(crate) fn reserved(word: &str, span: Span) -> Diagnostic {
    Diagnostic::error("E0205", span)
        .says(format!(
            "`{word}` is a word of the language and cannot be a name"
        ))
        .help("choose another name; as a label it can stand in quotes")
}
