//! Names of functions, attributes and options.

use super::node::{DataFunction, Derived, LabelAttribute};
use super::symbols::attribute;
use crate::model::instance::Function;

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

/// How many of [`FUNCTIONS`] are about sets: the first.
const OF_SETS: usize = 4;

/// Name, meaning, least and greatest number of arguments of those that take no variables.
const FUNCTIONS: &[(&str, Callee, usize, usize)] = {
    use Callee::{Card, Data, Ord, SameAs};
    use DataFunction as D;
    &[
        ("ord", Ord, 1, 2),
        ("card", Card, 1, 1),
        ("sameas", SameAs, 2, 2),
        ("diag", SameAs, 2, 2),
        ("uniform", Data(D::Uniform), 2, 2),
        ("uniformint", Data(D::UniformInt), 2, 2),
        ("normal", Data(D::Normal), 2, 2),
        ("randbinomial", Data(D::RandBinomial), 2, 2),
        ("randlinear", Data(D::RandLinear), 3, 3),
        ("randtriangle", Data(D::RandTriangle), 3, 3),
        ("fact", Data(D::Fact), 1, 1),
        ("mapval", Data(D::Mapval), 1, 1),
        ("pi", Data(D::Pi), 0, 0),
        ("execseed", Data(D::ExecSeed), 0, 0),
        ("jnow", Data(D::JNow), 0, 0),
        ("jstart", Data(D::JStart), 0, 0),
        ("jdate", Data(D::JDate), 3, 3),
        ("jtime", Data(D::JTime), 3, 3),
        ("gyear", Data(D::GYear), 1, 1),
        ("gmonth", Data(D::GMonth), 1, 1),
        ("gday", Data(D::GDay), 1, 1),
        ("ghour", Data(D::GHour), 1, 1),
        ("gminute", Data(D::GMinute), 1, 1),
        ("gsecond", Data(D::GSecond), 1, 1),
        ("gmillisec", Data(D::GMillisec), 1, 1),
        ("gdow", Data(D::GDow), 1, 1),
        ("gleap", Data(D::GLeap), 1, 1),
        ("timeelapsed", Data(D::TimeElapsed), 0, 0),
        ("timeexec", Data(D::TimeElapsed), 0, 0),
        ("timecomp", Data(D::Zero), 0, 0),
        ("timestart", Data(D::Zero), 0, 0),
        ("timeclose", Data(D::Zero), 0, 0),
        ("heapsize", Data(D::Zero), 0, 0),
        ("heapfree", Data(D::Zero), 0, 0),
        ("heaplimit", Data(D::Zero), 0, 0),
        ("execerror", Data(D::ExecError), 0, 0),
        ("maxexecerror", Data(D::MaxExecError), 0, 0),
        ("errorlevel", Data(D::ErrorLevel), 0, 0),
        ("numcores", Data(D::One), 0, 0),
        ("mathlastrc", Data(D::Zero), 0, 0),
        ("mathlastec", Data(D::Zero), 0, 0),
        ("mathoval", Data(D::Zero), 0, 0),
        ("platformcode", Data(D::One), 0, 0),
        ("licenselevel", Data(D::One), 0, 0),
        ("licensestatus", Data(D::Zero), 0, 0),
        ("gamsrelease", Data(D::GamsRelease), 0, 0),
        ("gamsversion", Data(D::GamsVersion), 0, 0),
        ("handlecollect", Data(D::HandleCollect), 1, 1),
        ("handledelete", Data(D::HandleDelete), 1, 1),
        ("handlestatus", Data(D::HandleStatus), 1, 1),
        ("readycollect", Data(D::ReadyCollect), 1, 2),
        ("handlesubmit", Data(D::HandleSubmit), 1, 1),
        ("sleep", Data(D::Sleep), 1, 1),
    ]
};

/// The functions of the library `stolib` that can be named by `function f /stolib.dnormal/`.
pub const STOLIB: &[(&str, Callee, usize, usize)] = {
    use Callee::{Data, NormalCurve};
    use DataFunction as D;
    &[
        ("cdfnormal", NormalCurve { density: false }, 3, 3),
        ("dbinomial", Data(D::RandBinomial), 2, 2),
        ("dexponential", Data(D::RandExponential), 1, 1),
        ("dnormal", Data(D::Normal), 2, 2),
        ("dpoisson", Data(D::RandPoisson), 1, 1),
        ("dtriangular", Data(D::RandTriangle), 3, 3),
        ("duniform", Data(D::Uniform), 2, 2),
        ("duniformint", Data(D::UniformInt), 2, 2),
        ("pdfnormal", NormalCurve { density: true }, 3, 3),
        ("setseed", Data(D::SetSeed), 1, 1),
    ]
};

/// `stolib.dnormal`, in lower case.
pub fn of_library(path: &str) -> Option<(Callee, usize, usize)> {
    let name = path.strip_prefix("stolib.")?;
    let row = STOLIB.iter().find(|f| f.0 == name);
    row.map(|f| (f.1, f.2, f.3))
}

/// The function of this name (lower case), with least and greatest number of arguments.
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
    let row = FUNCTIONS.iter().find(|f| f.0 == name);
    row.map(|f| (f.1, f.2, f.3))
}

/// All function names.
pub fn names() -> impl Iterator<Item = &'static str> {
    let (of_sets, of_data) = FUNCTIONS.split_at(OF_SETS);
    let math = Function::all().map(Function::name);
    let of_sets = of_sets.iter().map(|f| f.0);
    of_sets.chain(math).chain(of_data.iter().map(|f| f.0))
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

/// Attributes of variables and equations: name, and as `display` shows it.
const RECORD_ATTRIBUTES: &[(&str, &str, RecordAttribute)] = {
    use RecordAttribute::{Derived as D, Fix, Stored};
    &[
        ("l", "L", Stored(attribute::L)),
        ("m", "M", Stored(attribute::M)),
        ("lo", "Lo", Stored(attribute::LO)),
        ("up", "Up", Stored(attribute::UP)),
        ("scale", "Scale", Stored(attribute::SCALE)),
        ("prior", "Prior", Stored(attribute::PRIOR)),
        ("stage", "Stage", Stored(attribute::STAGE)),
        ("fx", "Fx", Fix),
        ("slack", "Slack", D(Derived::Slack)),
        ("slacklo", "SlackLo", D(Derived::SlackLo)),
        ("slackup", "SlackUp", D(Derived::SlackUp)),
        ("infeas", "Infeas", D(Derived::Infeas)),
        ("range", "Range", D(Derived::Range)),
        ("rangelo", "RangeLo", D(Derived::RangeLo)),
        ("rangeup", "RangeUp", D(Derived::RangeUp)),
        ("pricelo", "PriceLo", D(Derived::PriceLo)),
        ("priceup", "PriceUp", D(Derived::PriceUp)),
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

/// Name, name in displays, and meaning of the attribute with this name.
fn attribute_row(name: &str) -> Option<&'static (&'static str, &'static str, RecordAttribute)> {
    let mut rows = RECORD_ATTRIBUTES.iter();
    rows.find(|a| a.0.eq_ignore_ascii_case(name))
}

/// The attribute with this name.
pub fn record_attribute(name: &str) -> Option<RecordAttribute> {
    attribute_row(name).map(|a| a.2)
}

/// The attribute with this name as `display` shows it.
pub fn display_attribute(name: &str) -> Option<&'static str> {
    let shown = attribute_row(name).filter(|a| a.2 != RecordAttribute::Fix);
    shown.map(|a| a.1)
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

/// Attributes of set elements.
const LABEL_ATTRIBUTES: &[(&str, LabelAttribute)] = &[
    ("val", LabelAttribute::Val),
    ("pos", LabelAttribute::Pos),
    ("ord", LabelAttribute::Ord),
    ("off", LabelAttribute::Off),
    ("rev", LabelAttribute::Rev),
    ("uel", LabelAttribute::Uel),
    ("len", LabelAttribute::Len),
    ("tlen", LabelAttribute::TextLen),
    ("tval", LabelAttribute::TextVal),
    ("first", LabelAttribute::First),
    ("last", LabelAttribute::Last),
];

/// The attribute of a set element with this lower-case name.
pub fn label_attribute(name: &str) -> Option<LabelAttribute> {
    let row = LABEL_ATTRIBUTES.iter().find(|a| a.0 == name);
    row.map(|a| a.1)
}

/// The name of an attribute of set elements.
pub fn label_word(attribute: LabelAttribute) -> &'static str {
    let row = LABEL_ATTRIBUTES.iter().find(|a| a.1 == attribute);
    row.map_or("", |a| a.0)
}

/// The name of a function of data.
pub fn data_word(f: DataFunction) -> &'static str {
    let row = FUNCTIONS.iter().find(|row| row.1 == Callee::Data(f));
    row.map_or("", |row| row.0)
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
    "etsolver", "resgen", "resin", "resderiv", "resout", "resderiv", "rngbndmax", "rngbndmin", "rngmatmax",
    "rngmatmin", "rngrhsmax", "rngrhsmin", "nodusd", "procused", "rocp", "tolproj", "forcework", "defpoint",
    "integer1", "integer2", "integer3", "integer4", "integer5", "real1", "real2", "real3", "real4", "real5",
    "handle", "mcprholdfx", "pricesolve", "ts", "tn", "fdopt", "fddelta", "hessscale", "clearmodel",
    "justscrdir", "trylinear", "tryInt", "reform", "sumdom", "numunbnd", "requestmarginals", "etalg",
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
pub const PROBLEM_TYPES: &[&str] = &[
    "lp", "rmip", "mip", "nlp", "dnlp", "rminlp", "minlp", "qcp", "rmiqcp", "miqcp", "cns", "mcp",
    "mpec", "rmpec", "emp",
];
