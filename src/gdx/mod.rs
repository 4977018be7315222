//! GDX, the binary data files of GAMS: symbols with their sparse records.
//!
//! Reads versions 5 to 7, compressed or not; writes version 7. Knows nothing of the rest of bmod.
//! Source of the format: files that GAMS 54.6 wrote, and GAMS's own open-source library (MIT).
//!
//! A file is a header, the records of each symbol (`_DATA_`), and an index: symbols (`_SYMB_`), set texts
//! (`_SETT_`), labels (`_UEL_`), acronyms (`_ACRO_`), names of relaxed domains (`_DOMS_`). A record is
//! coded by what differs from the one before it.
//!
//! Invariant: bytes that are no GDX file, or a damaged one, give an [`Error`]; memory is bounded by what the
//! bytes decode to, never by a count that stands in the file.

mod read;
mod stream;
mod write;

pub use read::File;
pub use write::{Contents, write};

/// Most index positions of a symbol.
pub const MAX_DIMENSION: usize = 20;

/// The index begins with this number.
const INDEX_MARK: i32 = 19_510_624;

/// Acronyms are coded as multiples of this number.
const ACRONYM_UNIT: f64 = 1e301;

/// Numbers from here on mean something else in GAMS.
const TOO_LARGE: f64 = 1e300;

/// Longest label in bytes.
pub const MAX_LABEL: usize = 63;

/// What is wrong with a file, or with data that a file cannot hold, in words.
pub type Error = String;

type Result<T> = std::result::Result<T, Error>;

fn fail<T>(message: impl Into<String>) -> Result<T> {
    Err(message.into())
}

/// What a symbol is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A set; a singleton has at most one element.
    Set {
        /// Whether it is a singleton.
        singleton: bool,
    },
    /// A parameter.
    Parameter,
    /// A variable, and its type as GAMS numbers it: 1 binary, 2 integer, 3 positive, 4 negative, 5 free, 6 and 7 special
    /// ordered sets, 8 semicontinuous, 9 semi-integer.
    Variable(i32),
    /// An equation, and its type as GAMS numbers it: 53 `=e=`, 54 `=g=`, 55 `=l=`, 56 `=n=`, 57 `=x=`, 58 `=c=`, 59 `=b=`.
    Equation(i32),
    /// Another name of a set: the number of that symbol in the file, none for the set of all labels.
    Alias(Option<usize>),
}

impl Kind {
    /// `set`, `parameter` …
    pub fn name(self) -> &'static str {
        match self {
            Kind::Set { singleton: true } => "singleton set",
            Kind::Set { .. } => "set",
            Kind::Parameter => "parameter",
            Kind::Variable(_) => "variable",
            Kind::Equation(_) => "equation",
            Kind::Alias(_) => "alias",
        }
    }

    /// Values of a record: level, marginal, lower and upper bound, scale for variables and equations, one for parameters,
    /// none for sets.
    pub fn width(self) -> usize {
        match self {
            Kind::Set { .. } | Kind::Alias(_) => 0,
            Kind::Parameter => 1,
            Kind::Variable(_) | Kind::Equation(_) => 5,
        }
    }

    /// The values of a record that is not stored.
    pub fn defaults(self) -> &'static [Value] {
        const ZERO: Value = Value::Number(0.0);
        const ONE: Value = Value::Number(1.0);
        const UP: Value = Value::Number(f64::INFINITY);
        const DOWN: Value = Value::Number(f64::NEG_INFINITY);
        match self {
            Kind::Set { .. } | Kind::Alias(_) => &[],
            Kind::Parameter => &[ZERO],
            Kind::Variable(1) => &[ZERO, ZERO, ZERO, ONE, ONE],
            Kind::Variable(4) => &[ZERO, ZERO, DOWN, ZERO, ONE],
            Kind::Variable(0 | 5) | Kind::Equation(56) => &[ZERO, ZERO, DOWN, UP, ONE],
            Kind::Variable(8 | 9) => &[ZERO, ZERO, ONE, UP, ONE],
            Kind::Variable(_) | Kind::Equation(54 | 57 | 58) => &[ZERO, ZERO, ZERO, UP, ONE],
            Kind::Equation(55) => &[ZERO, ZERO, DOWN, ZERO, ONE],
            Kind::Equation(_) => &[ZERO, ZERO, ZERO, ZERO, ONE],
        }
    }
}

/// An index position of a symbol.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Domain {
    /// `*`: any label.
    Universe,
    /// A set or alias of the file, by its number; every label is a member of it.
    Set(usize),
    /// The name of a set that need not be in the file and says nothing of the labels.
    Relaxed(String),
}

/// A symbol without its records.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Name, as spelled.
    pub name: String,
    /// Explanatory text.
    pub text: String,
    /// What it is.
    pub kind: Kind,
    /// Index positions.
    pub domain: Vec<Domain>,
}

/// A value of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number, or an infinity.
    Number(f64),
    /// `undf`.
    Undefined,
    /// `na`.
    NotAvailable,
    /// `eps`.
    Eps,
    /// An acronym, by its number in the file.
    Acronym(u32),
}

/// The records of a symbol, in order of their labels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Records {
    /// How many.
    pub len: usize,
    /// Numbers of labels: as many per record as the symbol has index positions.
    pub keys: Vec<u32>,
    /// [`Kind::width`] values per record.
    pub values: Vec<Value>,
    /// Sets: the text of each element, by its number in the file; 0 for none.
    pub texts: Vec<u32>,
}
