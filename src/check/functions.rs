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
}

const MANY: usize = usize::MAX;

/// Name, meaning, least and greatest number of arguments.
const FUNCTIONS: &[(&str, Callee, usize, usize)] = {
    use Callee::{Card, Data, Math, Ord, SameAs};
    use DataFunction as D;
    use Function as F;
    &[
        ("ord", Ord, 1, 2),
        ("card", Card, 1, 1),
        ("sameas", SameAs, 2, 2),
        ("diag", SameAs, 2, 2),
        ("exp", Math(F::Exp), 1, 1),
        ("log", Math(F::Log), 1, 1),
        ("log2", Math(F::Log2), 1, 1),
        ("log10", Math(F::Log10), 1, 1),
        ("sqrt", Math(F::Sqrt), 1, 1),
        ("sqr", Math(F::Sqr), 1, 1),
        ("power", Math(F::Power), 2, 2),
        ("cvpower", Math(F::CvPower), 2, 2),
        ("vcpower", Math(F::VcPower), 2, 2),
        ("rpower", Math(F::RPower), 2, 2),
        ("signpower", Math(F::SignPower), 2, 2),
        ("sin", Math(F::Sin), 1, 1),
        ("cos", Math(F::Cos), 1, 1),
        ("tan", Math(F::Tan), 1, 1),
        ("arcsin", Math(F::ArcSin), 1, 1),
        ("arccos", Math(F::ArcCos), 1, 1),
        ("arctan", Math(F::ArcTan), 1, 1),
        ("arctan2", Math(F::ArcTan2), 2, 2),
        ("sinh", Math(F::Sinh), 1, 1),
        ("cosh", Math(F::Cosh), 1, 1),
        ("tanh", Math(F::Tanh), 1, 1),
        ("errorf", Math(F::ErrorF), 1, 1),
        ("gamma", Math(F::Gamma), 1, 1),
        ("loggamma", Math(F::LogGamma), 1, 1),
        ("beta", Math(F::Beta), 2, 2),
        ("logbeta", Math(F::LogBeta), 2, 2),
        ("betareg", Math(F::BetaReg), 3, 3),
        ("gammareg", Math(F::GammaReg), 2, 2),
        ("binomial", Math(F::Binomial), 2, 2),
        ("centropy", Math(F::Centropy), 2, 3),
        ("entropy", Math(F::Entropy), 1, 1),
        ("sigmoid", Math(F::Sigmoid), 1, 1),
        ("logit", Math(F::Logit), 1, 1),
        ("poly", Math(F::Poly), 4, MANY),
        ("slexp", Math(F::SlExp), 1, 2),
        ("sllog10", Math(F::SlLog10), 1, 2),
        ("slrec", Math(F::SlRec), 1, 2),
        ("sqexp", Math(F::SqExp), 1, 2),
        ("sqlog10", Math(F::SqLog10), 1, 2),
        ("sqrec", Math(F::SqRec), 1, 2),
        ("ncpcm", Math(F::NcpCm), 3, 3),
        ("ncpf", Math(F::NcpF), 2, 3),
        ("ncpvusin", Math(F::NcpVuSin), 2, 3),
        ("ncpvupow", Math(F::NcpVuPow), 2, 3),
        ("edist", Math(F::EDist), 1, MANY),
        ("div", Math(F::Div), 2, 2),
        ("div0", Math(F::Div0), 2, 2),
        ("lsemax", Math(F::LseMax), 1, MANY),
        ("lsemin", Math(F::LseMin), 1, MANY),
        ("lsemaxsc", Math(F::LseMaxSc), 2, MANY),
        ("lseminsc", Math(F::LseMinSc), 2, MANY),
        ("abs", Math(F::Abs), 1, 1),
        ("sign", Math(F::Sign), 1, 1),
        ("min", Math(F::Min), 2, MANY),
        ("max", Math(F::Max), 2, MANY),
        ("floor", Math(F::Floor), 1, 1),
        ("ceil", Math(F::Ceil), 1, 1),
        ("round", Math(F::Round), 1, 2),
        ("trunc", Math(F::Trunc), 1, 1),
        ("frac", Math(F::Frac), 1, 1),
        ("mod", Math(F::Mod), 2, 2),
        ("ifthen", Math(F::IfThen), 3, 3),
        ("bool_and", Math(F::BoolAnd), 2, 2),
        ("bool_or", Math(F::BoolOr), 2, 2),
        ("bool_not", Math(F::BoolNot), 1, 1),
        ("bool_xor", Math(F::BoolXor), 2, 2),
        ("bool_eqv", Math(F::BoolEqv), 2, 2),
        ("bool_imp", Math(F::BoolImp), 2, 2),
        ("rel_eq", Math(F::RelEq), 2, 2),
        ("rel_ne", Math(F::RelNe), 2, 2),
        ("rel_lt", Math(F::RelLt), 2, 2),
        ("rel_le", Math(F::RelLe), 2, 2),
        ("rel_gt", Math(F::RelGt), 2, 2),
        ("rel_ge", Math(F::RelGe), 2, 2),
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
        ("handlecollect", Data(D::Zero), 1, 1),
        ("handledelete", Data(D::Zero), 1, 1),
        ("handlestatus", Data(D::Zero), 1, 1),
        ("handlesubmit", Data(D::Zero), 1, 1),
        ("sleep", Data(D::Sleep), 1, 1),
    ]
};

/// The function of this name (lower case), with least and greatest number of arguments.
pub fn callee(name: &str) -> Option<(Callee, usize, usize)> {
    FUNCTIONS
        .iter()
        .find(|f| f.0 == name)
        .map(|f| (f.1, f.2, f.3))
}

/// All function names.
pub fn names() -> impl Iterator<Item = &'static str> {
    FUNCTIONS.iter().map(|f| f.0)
}

/// The name of a function.
pub fn name_of(f: Function) -> &'static str {
    FUNCTIONS
        .iter()
        .find(|x| x.1 == Callee::Math(f))
        .map_or("function", |x| x.0)
}

/// Whether the first argument is a constant of the formula (`cvpower(a,x)`, scale of `lsemaxsc`).
pub fn first_argument_must_be_data(f: Function) -> bool {
    matches!(
        f,
        Function::CvPower | Function::LseMaxSc | Function::LseMinSc
    )
}

/// Whether a function of variables needs a `dnlp` model.
pub fn is_nonsmooth(f: Function) -> bool {
    use Function as F;
    matches!(
        f,
        F::Abs
            | F::Sign
            | F::Min
            | F::Max
            | F::Floor
            | F::Ceil
            | F::Round
            | F::Trunc
            | F::Frac
            | F::Mod
            | F::IfThen
            | F::BoolAnd
            | F::BoolOr
            | F::BoolNot
            | F::BoolXor
            | F::BoolEqv
            | F::BoolImp
            | F::RelEq
            | F::RelNe
            | F::RelLt
            | F::RelLe
            | F::RelGt
            | F::RelGe
    )
}

/// An attribute of variables and equations.
pub enum RecordAttribute {
    /// Stored in the table with this offset.
    Stored(u32),
    /// Computed.
    Derived(Derived),
    /// `.fx`
    Fix,
}

/// The attribute with this name.
pub fn record_attribute(name: &str) -> Option<RecordAttribute> {
    use RecordAttribute::{Derived as D, Fix, Stored};
    Some(match name.to_lowercase().as_str() {
        "l" => Stored(attribute::L),
        "m" => Stored(attribute::M),
        "lo" => Stored(attribute::LO),
        "up" => Stored(attribute::UP),
        "scale" => Stored(attribute::SCALE),
        "prior" => Stored(attribute::PRIOR),
        "stage" => Stored(attribute::STAGE),
        "fx" => Fix,
        "slack" => D(Derived::Slack),
        "slacklo" => D(Derived::SlackLo),
        "slackup" => D(Derived::SlackUp),
        "infeas" => D(Derived::Infeas),
        "range" => D(Derived::Range),
        "rangelo" => D(Derived::RangeLo),
        "rangeup" => D(Derived::RangeUp),
        "pricelo" => D(Derived::PriceLo),
        "priceup" => D(Derived::PriceUp),
        _ => return None,
    })
}

/// The attribute of a set element with this lower-case name.
pub fn label_attribute(name: &str) -> Option<LabelAttribute> {
    use LabelAttribute as A;
    Some(match name {
        "val" => A::Val,
        "pos" => A::Pos,
        "ord" => A::Ord,
        "off" => A::Off,
        "rev" => A::Rev,
        "uel" => A::Uel,
        "len" => A::Len,
        "tlen" => A::TextLen,
        "tval" => A::TextVal,
        "first" => A::First,
        "last" => A::Last,
        _ => return None,
    })
}

/// Attributes of models, lower case.
pub const MODEL_ATTRIBUTES: &[&str] = &[
    "modelstat",
    "solvestat",
    "objval",
    "objest",
    "iterusd",
    "resusd",
    "numequ",
    "numvar",
    "numnz",
    "numnlnz",
    "numnlins",
    "numinfes",
    "suminfes",
    "tmodstat",
    "tsolstat",
    "maxinfes",
    "meaninfes",
    "numdepnd",
    "numdvar",
    "numnopt",
    "numredef",
    "domusd",
    "line",
    "number",
    "marginals",
    "limrow",
    "limcol",
    "optfile",
    "holdfixed",
    "iterlim",
    "reslim",
    "scaleopt",
    "optcr",
    "optca",
    "tolinfeas",
    "tolinfrep",
    "linkused",
    "domlim",
    "bratio",
    "nodlim",
    "workspace",
    "workfactor",
    "cheat",
    "cutoff",
    "tryint",
    "prioropt",
    "sysout",
    "solprint",
    "solveopt",
    "solvelink",
    "savepoint",
    "threads",
    "dictfile",
    "dictmap",
    "etsolve",
    "etsolver",
    "resgen",
    "resin",
    "resderiv",
    "resout",
    "resderiv",
    "rngbndmax",
    "rngbndmin",
    "rngmatmax",
    "rngmatmin",
    "rngrhsmax",
    "rngrhsmin",
    "nodusd",
    "procused",
    "rocp",
    "tolproj",
    "forcework",
    "defpoint",
    "integer1",
    "integer2",
    "integer3",
    "integer4",
    "integer5",
    "real1",
    "real2",
    "real3",
    "real4",
    "real5",
    "handle",
    "mcprholdfx",
    "pricesolve",
    "ts",
    "tn",
    "fdopt",
    "fddelta",
    "hessscale",
    "clearmodel",
    "justscrdir",
    "trylinear",
    "tryInt",
    "reform",
    "sumdom",
    "numunbnd",
    "requestmarginals",
    "etalg",
    "numvarproj",
    "rescalc",
    "robj",
    "sysident",
    "sysver",
];

/// Attributes of files, lower case.
pub const FILE_ATTRIBUTES: &[&str] = &[
    "ap", "bm", "case", "cc", "cr", "errors", "hdcc", "hdcr", "hdll", "lcase", "lj", "ll", "lm",
    "lp", "lw", "nd", "nj", "nr", "nw", "nz", "pc", "pdir", "print", "ps", "pw", "sj", "sw", "tf",
    "tj", "tlcc", "tlcr", "tlll", "tm", "tw", "ws", "ts", "tn", "recurse", "title1", "date",
    "time",
];

/// Solver names of bmod that an option may give.
pub const OWN_SOLVERS: &[&str] = &[
    "default",
    "clarabel",
    "simplex",
    "pounce",
    "ipopt",
    "bmcp",
    "mcp",
    "bmpec",
    "bmip",
    #[cfg(feature = "highs")]
    "highs",
];

/// Solver names that an option may give: bmod's own, and those of GAMS (for which bmod's own stands in).
pub const SOLVERS: &[&str] = &[
    "clarabel",
    "simplex",
    "bmcp",
    "pounce",
    "ipopt",
    "mcp",
    "default",
    "alphaecp",
    "ampl",
    "antigone",
    "baron",
    "bdmlp",
    "bench",
    "bonmin",
    "cbc",
    "conopt",
    "conopt2",
    "conopt3",
    "conopt4",
    "convert",
    "convertd",
    "copt",
    "couenne",
    "cplex",
    "cplexd",
    "de",
    "decisc",
    "decism",
    "dicopt",
    "examiner",
    "examiner2",
    "gamschk",
    "glpk",
    "gurobi",
    "guss",
    "highs",
    "ipopth",
    "jams",
    "kestrel",
    "knitro",
    "lgo",
    "lindo",
    "lindoglobal",
    "lingo",
    "localsolver",
    "miles",
    "minos",
    "minos5",
    "minos55",
    "mosek",
    "mps2gms",
    "mpsge",
    "msnlp",
    "nlpec",
    "odhcplex",
    "octeract",
    "oqnlp",
    "osicplex",
    "osigurobi",
    "osimosek",
    "osixpress",
    "osl",
    "path",
    "pathc",
    "pathnlp",
    "quadminos",
    "sbb",
    "scensolver",
    "scip",
    "selkie",
    "shot",
    "snopt",
    "soplex",
    "xa",
    "xpress",
    "zoom",
];

/// Words that `option` takes a solver for: the problem types, and `emp`.
pub const PROBLEM_TYPES: &[&str] = &[
    "lp", "rmip", "mip", "nlp", "dnlp", "rminlp", "minlp", "qcp", "rmiqcp", "miqcp", "cns", "mcp",
    "mpec", "rmpec", "emp",
];
