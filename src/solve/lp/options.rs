//! Options of the linear programming backend.

use crate::model::option::{Kind, OptionTable, row};

/// What `lp`, `rmip` and the linear programs inside other methods take.
#[rustfmt::skip]
pub const OPTIONS: OptionTable = OptionTable {
    backend: "clarabel",
    title: "lp, rmip and linear models of other types: an interior-point method with crossover, and the simplex method",
    rows: &[
        row("method", Kind::Words(&["auto", "interior", "crossover", "simplex"]), "auto", "`auto` tries the simplex method first and takes `crossover` where that takes long; `interior` ends with the interior point; `crossover` goes from there to a vertex; `simplex` is the simplex method alone"),
        row("tolerance", Kind::Inside(0.0, 1.0), "1e-10", "with `method=interior`: relative residuals and gap at which the interior point ends"),
        row("lp_accuracy", Kind::WordsOrReal(&["fast", "standard", "high"], 1e-16, 1.0), "standard", "`fast` (1e-8): an interior point, or a vertex to 1e-9; `standard`: a vertex whose bounds and signs hold to 1e-13; `high`: as near to rounding as the basis allows; a number above 1e-9 is `fast`, below 1e-12 `high`"),
    ],
    more: None,
    ignored: &[],
};
