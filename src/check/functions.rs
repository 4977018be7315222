//! Names of functions, attributes and options.

use super::node::{DataFunction, Derived};
use super::symbols::attribute;
use crate::model::instance::Function;
use crate::model::problem_type::ProblemType;

/// What a function name stands for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Callee {
    /// `ord`
    Ord,
    /// `card`
    Card,
    /// `sameas`, `diag`
    SameAs,
    /// May stand in an equation with a variable.
    Math(Function),
    /// Of data only.
    Data(DataFunction),
    /// `stolib.cdfnormal` and, of the density, `stolib.pdfnormal`: value, mean, standard deviation.
    NormalCurve {
        /// The density.
        density: bool,
    },
}

/// Functions of sets: name, meaning, least and greatest number of arguments.
const OF_SETS: [(&str, Callee, usize, usize); 4] = [
    ("ord", Callee::Ord, 1, 2),
    ("card", Callee::Card, 1, 1),
    ("sameas", Callee::SameAs, 2, 2),
    ("diag", Callee::SameAs, 2, 2),
];

/// The normal curve in the library `stolib`; what else it has are functions of data with another name.
const NORMAL_CURVE: [(&str, bool); 2] = [("stolib.cdfnormal", false), ("stolib.pdfnormal", true)];

const LIBRARY: &str = "stolib.";

/// The functions that can be named by `function f /stolib.dnormal/`, without the library.
pub fn names_in_library() -> Vec<&'static str> {
    let curve = NORMAL_CURVE.iter().map(|f| f.0);
    let all = curve.chain(names_of_data());
    let mut all: Vec<_> = all.filter_map(|n| n.strip_prefix(LIBRARY)).collect();
    all.sort_unstable();
    all
}

/// `stolib.dnormal`, in lower case.
pub fn of_library(path: &str) -> Option<(Callee, usize, usize)> {
    if let Some(&(_, density)) = NORMAL_CURVE.iter().find(|f| f.0 == path) {
        return Some((Callee::NormalCurve { density }, 3, 3));
    }
    path.starts_with(LIBRARY).then(|| callee(path)).flatten()
}

fn names_of_data() -> impl Iterator<Item = &'static str> {
    DataFunction::ALL.iter().flat_map(|f| f.names()).copied()
}

/// The function of this name, with least and greatest number of arguments.
pub fn callee(name: &str) -> Option<(Callee, usize, usize)> {
    if let Some(f) = Function::named(name) {
        let (least, most) = f.arity();
        let least = match f {
            Function::Poly => 4,
            Function::Min | Function::Max => 2,
            _ => least,
        };
        return Some((Callee::Math(f), least, most));
    }
    if let Some(f) = DataFunction::named(name) {
        let (least, most) = f.arity();
        return Some((Callee::Data(f), least, most));
    }
    let row = OF_SETS.iter().find(|f| f.0.eq_ignore_ascii_case(name));
    row.map(|f| (f.1, f.2, f.3))
}

/// All function names.
pub fn names() -> impl Iterator<Item = &'static str> {
    let math = Function::ALL.iter().map(|f| f.name());
    let of_data = names_of_data().filter(|name| !name.starts_with(LIBRARY));
    OF_SETS.iter().map(|f| f.0).chain(math).chain(of_data)
}

/// Whether the first argument is a constant of the formula (`cvpower(a,x)`, scale of `lsemaxsc`).
pub fn first_argument_must_be_data(f: Function) -> bool {
    matches!(
        f,
        Function::CvPower | Function::LseMaxSc | Function::LseMinSc
    )
}

/// An attribute of variables and equations.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum RecordAttribute {
    /// Stored in the table with this offset.
    Stored(u32),
    /// Computed.
    Derived(Derived),
    /// `.fx`
    Fix,
}

/// Attributes of variables and equations that are not computed: name, as `display` shows it, meaning.
const RECORD_ATTRIBUTES: [(&str, &str, RecordAttribute); 8] = {
    use RecordAttribute::{Fix, Stored};
    [
        ("l", "L", Stored(attribute::L)),
        ("m", "M", Stored(attribute::M)),
        ("lo", "Lo", Stored(attribute::LO)),
        ("up", "Up", Stored(attribute::UP)),
        ("scale", "Scale", Stored(attribute::SCALE)),
        ("prior", "Prior", Stored(attribute::PRIOR)),
        ("stage", "Stage", Stored(attribute::STAGE)),
        ("fx", "Fx", Fix),
    ]
};

/// Attributes as other languages call them: kind of the symbol (empty: variables and equations), names there, the name here.
#[rustfmt::skip]
const ELSEWHERE: &[(&str, &[&str], &str)] = &[
    ("", &["max", "upper", "ub", "upperbound", "upbnd"], "up"),
    ("", &["min", "lower", "lb", "low", "lowerbound", "lobnd"], "lo"),
    ("", &["fix", "fixed", "setvalue"], "fx"),
    ("", &["value", "level", "val", "x", "sol", "solution", "initial", "init", "start", "starting_point"], "l"),
    ("", &["dual", "price", "pi", "shadow", "shadowprice", "marginal", "multiplier", "lambda", "rc", "dj", "reducedcost"], "m"),
    ("", &["s", "sl", "surplus"], "slack"),
    ("model", &["status", "termination_status", "stat"], "modelStat"),
    ("model", &["obj", "objective", "value", "objectivevalue", "z"], "objVal"),
    ("model", &["time", "cpu", "runtime", "solvetime"], "resUsd"),
    ("model", &["iterations", "iter", "iters"], "iterUsd"),
    ("model", &["gap"], "optCR"),
    ("model", &["nodes"], "nodUsd"),
    ("model", &["timelimit"], "resLim"),
];

/// The attribute that is meant by another language's name for it.
pub fn meant_attribute(name: &str, kind: &str) -> Option<&'static str> {
    let of = if kind == "model" { kind } else { "" };
    let named = |row: &&(&str, &[&str], &str)| {
        row.0 == of && row.1.iter().any(|n| n.eq_ignore_ascii_case(name))
    };
    ELSEWHERE.iter().find(named).map(|row| row.2)
}

/// The attribute with this name, and as `display` shows it.
fn attribute_row(name: &str) -> Option<(&'static str, RecordAttribute)> {
    let row = RECORD_ATTRIBUTES
        .iter()
        .find(|a| a.0.eq_ignore_ascii_case(name));
    let derived = || Derived::named(name).map(|d| (d.name(), RecordAttribute::Derived(d)));
    row.map(|a| (a.1, a.2)).or_else(derived)
}

/// The attribute with this name.
pub fn record_attribute(name: &str) -> Option<RecordAttribute> {
    attribute_row(name).map(|a| a.1)
}

/// The attribute with this name as `display` shows it.
pub fn display_attribute(name: &str) -> Option<&'static str> {
    let shown = attribute_row(name).filter(|a| a.1 != RecordAttribute::Fix);
    shown.map(|a| a.0)
}

/// Offset of the table of a stored attribute, by its name.
pub fn stored_attribute(name: &str) -> Option<u32> {
    match record_attribute(name)? {
        RecordAttribute::Stored(offset) => Some(offset),
        _ => None,
    }
}

/// The name of a stored attribute, by the offset of its table.
pub fn attribute_word(offset: u32) -> &'static str {
    let is = |a: &&(&str, &str, RecordAttribute)| a.2 == RecordAttribute::Stored(offset);
    RECORD_ATTRIBUTES.iter().find(is).map_or("", |a| a.0)
}

/// Attributes of models, lower case.
#[rustfmt::skip]
pub const MODEL_ATTRIBUTES: &[&str] = &[
    "modelstat", "solvestat", "objval", "objest", "iterusd", "resusd", "numequ", "numvar", "numnz", "numnlnz",
    "numnlins", "numinfes", "suminfes", "tmodstat", "tsolstat", "maxinfes", "meaninfes", "numdepnd",
    "numdvar", "numnopt", "numredef", "domusd", "line", "number", "marginals", "limrow", "limcol", "optfile",
    "holdfixed", "iterlim", "reslim", "scaleopt", "optcr", "optca", "tolinfeas", "tolinfrep", "linkused",
    "domlim", "bratio", "nodlim", "workspace", "workfactor", "cheat", "cutoff", "tryint", "prioropt",
    "sysout", "solprint", "solveopt", "solvelink", "savepoint", "threads", "dictfile", "dictmap", "etsolve",
    "etsolver", "resgen", "resin", "resderiv", "resout", "rngbndmax", "rngbndmin", "rngmatmax",
    "rngmatmin", "rngrhsmax", "rngrhsmin", "nodusd", "procused", "rocp", "tolproj", "forcework", "defpoint",
    "integer1", "integer2", "integer3", "integer4", "integer5", "real1", "real2", "real3", "real4", "real5",
    "handle", "mcprholdfx", "pricesolve", "ts", "tn", "fdopt", "fddelta", "hessscale", "clearmodel",
    "justscrdir", "trylinear", "reform", "sumdom", "numunbnd", "requestmarginals", "etalg",
    "numvarproj", "rescalc", "robj", "sysident", "sysver",
];

/// Attributes of files, lower case.
pub const FILE_ATTRIBUTES: &[&str] = &[
    "ap", "bm", "case", "cc", "cr", "errors", "hdcc", "hdcr", "hdll", "lcase", "lj", "ll", "lm",
    "lp", "lw", "nd", "nj", "nr", "nw", "nz", "pc", "pdir", "print", "ps", "pw", "sj", "sw", "tf",
    "tj", "tlcc", "tlcr", "tlll", "tm", "tw", "ws", "ts", "tn", "recurse", "title1", "date",
    "time",
];

/// Words that `option` takes a solver for: the problem types, and `emp`.
pub fn problem_types() -> impl Iterator<Item = &'static str> {
    ProblemType::ALL.iter().map(|t| t.name()).chain(["emp"])
}
