//! The functions that may stand in an equation, with their names.

use super::named::functions;

const MANY: usize = usize::MAX;

functions! {
    /// Functions that may stand in an equation with a variable argument; those from `Abs` on have kinks or jumps.
    #[derive(Hash)]
    pub enum Function {
        Exp "exp", 1, 1;
        Log "log", 1, 1;
        Log2 "log2", 1, 1;
        Log10 "log10", 1, 1;
        Sqrt "sqrt", 1, 1;
        Sqr "sqr", 1, 1;
        Power "power", 2, 2;
        CvPower "cvpower", 2, 2;
        VcPower "vcpower", 2, 2;
        RPower "rpower", 2, 2;
        SignPower "signpower", 2, 2;
        Sin "sin", 1, 1;
        Cos "cos", 1, 1;
        Tan "tan", 1, 1;
        ArcSin "arcsin", 1, 1;
        ArcCos "arccos", 1, 1;
        ArcTan "arctan", 1, 1;
        ArcTan2 "arctan2", 2, 2;
        Sinh "sinh", 1, 1;
        Cosh "cosh", 1, 1;
        Tanh "tanh", 1, 1;
        ErrorF "errorf", 1, 1;
        Gamma "gamma", 1, 1;
        LogGamma "loggamma", 1, 1;
        Beta "beta", 2, 2;
        LogBeta "logbeta", 2, 2;
        BetaReg "betareg", 3, 3;
        GammaReg "gammareg", 2, 2;
        Binomial "binomial", 2, 2;
        Centropy "centropy", 2, 3;
        Entropy "entropy", 1, 1;
        Sigmoid "sigmoid", 1, 1;
        Logit "logit", 1, 1;
        Poly "poly", 2, MANY;
        SlExp "slexp", 1, 2;
        SlLog10 "sllog10", 1, 2;
        SlRec "slrec", 1, 2;
        SqExp "sqexp", 1, 2;
        SqLog10 "sqlog10", 1, 2;
        SqRec "sqrec", 1, 2;
        NcpCm "ncpcm", 3, 3;
        NcpF "ncpf", 2, 3;
        NcpVuSin "ncpvusin", 2, 3;
        NcpVuPow "ncpvupow", 2, 3;
        EDist "edist", 1, MANY;
        Div "div", 2, 2;
        Div0 "div0", 2, 2;
        LseMax "lsemax", 1, MANY;
        LseMin "lsemin", 1, MANY;
        LseMaxSc "lsemaxsc", 2, MANY;
        LseMinSc "lseminsc", 2, MANY;
        Abs "abs", 1, 1;
        Sign "sign", 1, 1;
        Min "min", 1, MANY;
        Max "max", 1, MANY;
        Floor "floor", 1, 1;
        Ceil "ceil", 1, 1;
        Round "round", 1, 2;
        Trunc "trunc", 1, 1;
        Frac "frac", 1, 1;
        Mod "mod", 2, 2;
        IfThen "ifthen", 3, 3;
        BoolAnd "bool_and", 2, 2;
        BoolOr "bool_or", 2, 2;
        BoolNot "bool_not", 1, 1;
        BoolXor "bool_xor", 2, 2;
        BoolEqv "bool_eqv", 2, 2;
        BoolImp "bool_imp", 2, 2;
        RelEq "rel_eq", 2, 2;
        RelNe "rel_ne", 2, 2;
        RelLt "rel_lt", 2, 2;
        RelLe "rel_le", 2, 2;
        RelGt "rel_gt", 2, 2;
        RelGe "rel_ge", 2, 2;
    }
}

impl Function {
    /// Whether the function has kinks or jumps (model type dnlp).
    pub fn is_nonsmooth(self) -> bool {
        self as usize >= Self::Abs as usize
    }
}
