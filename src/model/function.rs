//! The functions that may stand in an equation, with their names.

use Function as F;

/// Functions that may stand in an equation with a variable argument.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[allow(missing_docs)]
pub enum Function {
    Exp,
    Log,
    Log2,
    Log10,
    Sqrt,
    Sqr,
    Power,
    CvPower,
    VcPower,
    RPower,
    SignPower,
    Sin,
    Cos,
    Tan,
    ArcSin,
    ArcCos,
    ArcTan,
    ArcTan2,
    Sinh,
    Cosh,
    Tanh,
    ErrorF,
    Gamma,
    LogGamma,
    Beta,
    LogBeta,
    BetaReg,
    GammaReg,
    Binomial,
    Centropy,
    Entropy,
    Sigmoid,
    Logit,
    Poly,
    SlExp,
    SlLog10,
    SlRec,
    SqExp,
    SqLog10,
    SqRec,
    NcpCm,
    NcpF,
    NcpVuSin,
    NcpVuPow,
    EDist,
    Div,
    Div0,
    LseMax,
    LseMin,
    LseMaxSc,
    LseMinSc,
    Abs,
    Sign,
    Min,
    Max,
    Floor,
    Ceil,
    Round,
    Trunc,
    Frac,
    Mod,
    IfThen,
    BoolAnd,
    BoolOr,
    BoolNot,
    BoolXor,
    BoolEqv,
    BoolImp,
    RelEq,
    RelNe,
    RelLt,
    RelLe,
    RelGt,
    RelGe,
}

const MANY: usize = usize::MAX;

/// Function, name as written in a model, smallest and largest number of arguments; in the order of the variants.
const FUNCTIONS: &[(Function, &str, usize, usize)] = &[
    (F::Exp, "exp", 1, 1),
    (F::Log, "log", 1, 1),
    (F::Log2, "log2", 1, 1),
    (F::Log10, "log10", 1, 1),
    (F::Sqrt, "sqrt", 1, 1),
    (F::Sqr, "sqr", 1, 1),
    (F::Power, "power", 2, 2),
    (F::CvPower, "cvpower", 2, 2),
    (F::VcPower, "vcpower", 2, 2),
    (F::RPower, "rpower", 2, 2),
    (F::SignPower, "signpower", 2, 2),
    (F::Sin, "sin", 1, 1),
    (F::Cos, "cos", 1, 1),
    (F::Tan, "tan", 1, 1),
    (F::ArcSin, "arcsin", 1, 1),
    (F::ArcCos, "arccos", 1, 1),
    (F::ArcTan, "arctan", 1, 1),
    (F::ArcTan2, "arctan2", 2, 2),
    (F::Sinh, "sinh", 1, 1),
    (F::Cosh, "cosh", 1, 1),
    (F::Tanh, "tanh", 1, 1),
    (F::ErrorF, "errorf", 1, 1),
    (F::Gamma, "gamma", 1, 1),
    (F::LogGamma, "loggamma", 1, 1),
    (F::Beta, "beta", 2, 2),
    (F::LogBeta, "logbeta", 2, 2),
    (F::BetaReg, "betareg", 3, 3),
    (F::GammaReg, "gammareg", 2, 2),
    (F::Binomial, "binomial", 2, 2),
    (F::Centropy, "centropy", 2, 3),
    (F::Entropy, "entropy", 1, 1),
    (F::Sigmoid, "sigmoid", 1, 1),
    (F::Logit, "logit", 1, 1),
    (F::Poly, "poly", 2, MANY),
    (F::SlExp, "slexp", 1, 2),
    (F::SlLog10, "sllog10", 1, 2),
    (F::SlRec, "slrec", 1, 2),
    (F::SqExp, "sqexp", 1, 2),
    (F::SqLog10, "sqlog10", 1, 2),
    (F::SqRec, "sqrec", 1, 2),
    (F::NcpCm, "ncpcm", 3, 3),
    (F::NcpF, "ncpf", 2, 3),
    (F::NcpVuSin, "ncpvusin", 2, 3),
    (F::NcpVuPow, "ncpvupow", 2, 3),
    (F::EDist, "edist", 1, MANY),
    (F::Div, "div", 2, 2),
    (F::Div0, "div0", 2, 2),
    (F::LseMax, "lsemax", 1, MANY),
    (F::LseMin, "lsemin", 1, MANY),
    (F::LseMaxSc, "lsemaxsc", 2, MANY),
    (F::LseMinSc, "lseminsc", 2, MANY),
    (F::Abs, "abs", 1, 1),
    (F::Sign, "sign", 1, 1),
    (F::Min, "min", 1, MANY),
    (F::Max, "max", 1, MANY),
    (F::Floor, "floor", 1, 1),
    (F::Ceil, "ceil", 1, 1),
    (F::Round, "round", 1, 2),
    (F::Trunc, "trunc", 1, 1),
    (F::Frac, "frac", 1, 1),
    (F::Mod, "mod", 2, 2),
    (F::IfThen, "ifthen", 3, 3),
    (F::BoolAnd, "bool_and", 2, 2),
    (F::BoolOr, "bool_or", 2, 2),
    (F::BoolNot, "bool_not", 1, 1),
    (F::BoolXor, "bool_xor", 2, 2),
    (F::BoolEqv, "bool_eqv", 2, 2),
    (F::BoolImp, "bool_imp", 2, 2),
    (F::RelEq, "rel_eq", 2, 2),
    (F::RelNe, "rel_ne", 2, 2),
    (F::RelLt, "rel_lt", 2, 2),
    (F::RelLe, "rel_le", 2, 2),
    (F::RelGt, "rel_gt", 2, 2),
    (F::RelGe, "rel_ge", 2, 2),
];

impl Function {
    /// All functions.
    pub fn all() -> impl Iterator<Item = Self> {
        FUNCTIONS.iter().map(|f| f.0)
    }

    /// The function of this name (lower case).
    pub fn named(name: &str) -> Option<Self> {
        FUNCTIONS.iter().find(|f| f.1 == name).map(|f| f.0)
    }

    /// The name as written in a model.
    pub fn name(self) -> &'static str {
        FUNCTIONS[self as usize].1
    }

    /// Smallest and largest number of arguments.
    pub fn arity(self) -> (usize, usize) {
        let (_, _, least, most) = FUNCTIONS[self as usize];
        (least, most)
    }

    /// Whether the function has kinks or jumps (model type dnlp): those from `Abs` on.
    pub fn is_nonsmooth(self) -> bool {
        self as usize >= F::Abs as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_variants() {
        for (k, f) in Function::all().enumerate() {
            assert_eq!(f as usize, k);
            assert_eq!(f.name().replace('_', ""), format!("{f:?}").to_lowercase());
        }
    }
}
