//! Options, declared as tables: what the language and each backend take, and what it means.
//!
//! The tables are what the checker, the command line, option files, `bmod help options` and `docs/options.md` know about
//! options; a value that has passed [`check`] is one that the backend takes. Those of the language are in [`super::language`].

use super::problem_type::ProblemType;
use crate::diag::nearest;
use std::fmt::Write;

/// The values that an option takes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Kind {
    /// One of these words.
    Words(&'static [&'static str]),
    /// `yes` or `no`; also `on`, `off`, `true`, `false`, 1, 0.
    Switch,
    /// A whole number from the first to the second.
    Whole(f64, f64),
    /// A number from the first to the second.
    Real(f64, f64),
    /// A number between the two.
    Inside(f64, f64),
    /// One of these words, or a number from the first to the second.
    WordsOrReal(&'static [&'static str], f64, f64),
    /// Some of these names, separated by commas.
    Names(&'static [&'static str]),
    /// Any text.
    Text,
    /// A word of these words, which whoever asks looks up.
    Word(&'static str),
}

/// An option.
#[derive(Clone, Debug)]
pub struct OptionRow {
    /// Its name, lower case.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// What holds where it is not set, as it would be written.
    pub default: &'static str,
    /// What it does, in a sentence without full stop.
    pub meaning: &'static str,
}

/// A row of a table.
pub const fn row(
    name: &'static str,
    kind: Kind,
    default: &'static str,
    meaning: &'static str,
) -> OptionRow {
    OptionRow {
        name,
        kind,
        default,
        meaning,
    }
}

/// The options of a backend.
#[derive(Clone, Copy, Debug)]
pub struct OptionTable {
    /// The backend, lower case, as in `bmod help options BACKEND`.
    pub backend: &'static str,
    /// Which models it solves.
    pub title: &'static str,
    /// Its options.
    pub rows: &'static [OptionRow],
    /// Further options that the solver inside knows, if it can tell.
    pub more: Option<fn() -> &'static [OptionRow]>,
    /// Names that the solver of the same kind has in GAMS and that mean nothing here: they are passed over with a
    /// warning.
    pub ignored: &'static [&'static str],
}

impl OptionTable {
    /// All rows.
    pub fn all(&self) -> impl Iterator<Item = &'static OptionRow> {
        let more = self.more.map_or(&[][..], |more| more());
        self.rows.iter().chain(more)
    }

    /// The option of that name, in any case.
    pub fn find(&self, name: &str) -> Option<&'static OptionRow> {
        self.all().find(|r| r.name.eq_ignore_ascii_case(name))
    }

    /// Whether the name is one of [`OptionTable::ignored`].
    pub fn ignores(&self, name: &str) -> bool {
        self.ignored.iter().any(|i| i.eq_ignore_ascii_case(name))
    }
}

/// What is known of the backends where options are checked.
#[derive(Clone, Copy, Debug)]
pub struct Solvers {
    /// Their options, and those that they share.
    pub tables: &'static [&'static OptionTable],
    /// Their names, and what each is chosen for.
    pub names: &'static [(&'static str, Vec<ProblemType>)],
}

impl Solvers {
    /// None at all.
    pub const NONE: Self = Self {
        tables: &[&super::language::LANGUAGE],
        names: &[],
    };
}

impl Default for &Solvers {
    fn default() -> Self {
        &Solvers::NONE
    }
}

/// Why an option is refused.
#[derive(Clone, PartialEq, Debug)]
pub enum Refused {
    /// No table has it; the nearest name.
    Unknown(Option<String>),
    /// The value is not of the kind that it takes; what it takes.
    Value(String),
    /// The number is too small or too large; what it takes.
    Range(String),
    /// There is no such solver: the nearest name, and all of them.
    Solver(Option<String>, String),
    /// The solver does not solve this type.
    Unsuited(ProblemType),
    /// A name in a list is not one of those that it takes; the nearest.
    Name(String, Option<String>),
}

impl Refused {
    /// The problem in a sentence without full stop, and how to fix it.
    pub fn words(&self, name: &str, value: &str) -> (String, Option<String>) {
        match self {
            Self::Unknown(near) => (
                format!("there is no option `{name}`"),
                near.as_ref().map(|n| format!("did you mean `{n}`?")),
            ),
            Self::Value(takes) | Self::Range(takes) => (
                format!("the option `{name}` takes {takes}, not `{value}`"),
                None,
            ),
            Self::Solver(near, all) => (
                format!("there is no solver `{value}`"),
                Some(match near {
                    Some(n) => format!("did you mean `{n}`?"),
                    None => format!("there are: {all}"),
                }),
            ),
            Self::Unsuited(using) => (
                format!("the solver `{value}` does not solve {}", using.name()),
                None,
            ),
            Self::Name(unknown, near) => (
                format!("the option `{name}` takes names from its list, not `{unknown}`"),
                near.as_ref().map(|n| format!("did you mean `{n}`?")),
            ),
        }
    }
}

/// Whether an option counts, if it is not refused.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Accepted {
    /// A backend takes it.
    Taken,
    /// It means nothing here.
    Ignored,
}

/// Looks an option up. A name that several tables have must have a value that all of them take.
pub fn check(tables: &[&OptionTable], name: &str, value: &str) -> Result<Accepted, Refused> {
    let rows: Vec<&OptionRow> = tables.iter().filter_map(|t| t.find(name)).collect();
    if rows.is_empty() {
        if tables.iter().any(|t| t.ignores(name)) {
            return Ok(Accepted::Ignored);
        }
        let known = tables.iter().flat_map(|t| t.all()).map(|r| r.name);
        return Err(Refused::Unknown(nearest(name, known).map(str::to_string)));
    }
    match rows.iter().find(|r| !r.kind.takes(value)).map(|r| r.kind) {
        Some(Kind::Names(names)) => {
            let all = value.split(',').map(str::trim);
            let unknown = all.into_iter().find(|n| !is_one_of(n, names)).unwrap_or("");
            let near = nearest(unknown, names.iter().copied()).map(str::to_string);
            Err(Refused::Name(unknown.to_string(), near))
        }
        Some(kind) => Err(match kind.has_range_for(value) {
            true => Refused::Range(kind.words()),
            false => Refused::Value(kind.words()),
        }),
        None => Ok(Accepted::Taken),
    }
}

fn is_one_of(word: &str, words: &[&str]) -> bool {
    words.iter().any(|w| w.eq_ignore_ascii_case(word))
}

/// A switch's value; None if it is none.
pub fn switch(value: &str) -> Option<bool> {
    match value.to_lowercase().as_str() {
        "yes" | "on" | "true" | "1" => Some(true),
        "no" | "off" | "false" | "0" => Some(false),
        _ => None,
    }
}

impl Kind {
    /// Whether a value is one of this kind.
    pub fn takes(&self, value: &str) -> bool {
        let word = |words: &[&str]| is_one_of(value, words);
        let number = value.parse::<f64>().ok().filter(|v| !v.is_nan());
        let within = |low: f64, high: f64| number.is_some_and(|v| (low..=high).contains(&v));
        match *self {
            Self::Words(words) => word(words),
            Self::Switch => switch(value).is_some(),
            Self::Whole(low, high) => {
                within(low, high) && number.is_some_and(|v| v.is_infinite() || v.fract() == 0.0)
            }
            Self::Real(low, high) => within(low, high),
            Self::Inside(low, high) => number.is_some_and(|v| low < v && v < high),
            Self::WordsOrReal(words, low, high) => word(words) || within(low, high),
            Self::Names(names) => value.split(',').all(|v| is_one_of(v.trim(), names)),
            Self::Text | Self::Word(_) => true,
        }
    }

    /// Whether a value is a number of this kind, were it not for the range.
    fn has_range_for(&self, value: &str) -> bool {
        let number = value.parse::<f64>().ok().filter(|v| !v.is_nan());
        match self {
            Self::Whole(..) => number.is_some_and(|v| v.fract() == 0.0),
            Self::Real(..) | Self::Inside(..) | Self::WordsOrReal(..) => number.is_some(),
            _ => false,
        }
    }

    /// Least and greatest number of this kind.
    pub fn range(&self) -> (f64, f64) {
        match *self {
            Self::Whole(low, high)
            | Self::Real(low, high)
            | Self::Inside(low, high)
            | Self::WordsOrReal(_, low, high) => (low, high),
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// What it takes: `a whole number from 0 to 8`.
    pub fn words(&self) -> String {
        let listed = |words: &[&str], last: &str| -> String {
            let all: Vec<String> = words.iter().map(|w| format!("`{w}`")).collect();
            match all.split_last() {
                Some((end, rest)) if !rest.is_empty() => {
                    format!("{}{last}{end}", rest.join(", "))
                }
                _ => all.concat(),
            }
        };
        let plain = |v: f64| match v != 0.0 && !(1e-4..1e7).contains(&v.abs()) {
            true => format!("{v:e}"),
            false => v.to_string(),
        };
        let range = |low: f64, high: f64| match (low.is_finite(), high.is_finite()) {
            (true, true) => format!(" from {} to {}", plain(low), plain(high)),
            (true, false) => format!(" of at least {}", plain(low)),
            (false, true) => format!(" of at most {}", plain(high)),
            (false, false) => String::new(),
        };
        match *self {
            Self::Words(words) => listed(words, " or "),
            Self::Switch => "`yes` or `no`".into(),
            Self::Whole(low, high) => format!("a whole number{}", range(low, high)),
            Self::Real(low, high) => format!("a number{}", range(low, high)),
            Self::Inside(low, high) => match high.is_finite() {
                true => format!("a number between {} and {}", plain(low), plain(high)),
                false => format!("a number above {}", plain(low)),
            },
            Self::WordsOrReal(words, low, high) => {
                format!("{} or a number{}", listed(words, ", "), range(low, high))
            }
            Self::Names(_) => "names separated by commas".into(),
            Self::Text => "a text".into(),
            Self::Word(words) => words.into(),
        }
    }
}

/// The tables as a page in Markdown.
pub fn page(tables: &[&OptionTable]) -> String {
    let mut out = String::new();
    for table in tables {
        let _ = writeln!(out, "## {}\n\n{}\n", table.backend, table.title);
        if !table.rows.is_empty() {
            out.push_str("| option | values | default | meaning |\n| --- | --- | --- | --- |\n");
        }
        for r in table.rows {
            let values = r.kind.words().replace('|', "\\|");
            let _ = writeln!(
                out,
                "| `{}` | {values} | {} | {} |",
                r.name, r.default, r.meaning
            );
        }
        if let Some(more) = table.more {
            let names: Vec<&str> = more().iter().map(|r| r.name).collect();
            let count = names.len();
            let _ = writeln!(
                out,
                "\nFurther {count} options of the solver inside are passed to it: `bmod help options {}` lists them.",
                table.backend
            );
        }
        if !table.ignored.is_empty() {
            let names: Vec<String> = table.ignored.iter().map(|n| format!("`{n}`")).collect();
            let _ = writeln!(
                out,
                "\nThese mean nothing here; they are passed over with a warning: {}.",
                names.join(", ")
            );
        }
        out.push('\n');
    }
    out.truncate(out.trim_end().len());
    out.push('\n');
    out
}

/// The tables for a terminal; `all`: with the further options of the solvers inside.
pub fn text(tables: &[&OptionTable], all: bool) -> String {
    let mut out = String::new();
    for (k, table) in tables.iter().enumerate() {
        let gap = if k > 0 { "\n" } else { "" };
        let _ = writeln!(out, "{gap}{}: {}", table.backend, table.title);
        let more = table.more.filter(|_| all).map_or(&[][..], |more| more());
        for r in table.rows.iter().chain(more) {
            let _ = writeln!(
                out,
                "\n  {} ({}; default {})",
                r.name,
                r.kind.words(),
                r.default
            );
            if !r.meaning.is_empty() {
                let _ = writeln!(out, "      {}", r.meaning);
            }
        }
        if let (Some(more), false) = (table.more, all) {
            let count = more().len();
            let name = table.backend;
            let _ = writeln!(out, "\n  and {count} more: `bmod help options {name}`");
        }
    }
    out
}
