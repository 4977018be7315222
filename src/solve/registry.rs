//! The backends that are in this build, in order of preference. To add one: a folder with a type that implements
//! [`Backend`], and a line here.

use super::backend::Backend;
#[cfg(feature = "highs")]
use super::highs;
use super::{lp, mcp, mip, mpec, nlp};
use crate::model::option::OptionTable;
use crate::model::problem_type::ProblemType;

/// All of them.
pub static BACKENDS: &[&dyn Backend] = &[
    &lp::Clarabel,
    &lp::SimplexAlone,
    #[cfg(feature = "pounce")]
    &nlp::Nonlinear(&nlp::pounce::Pounce),
    #[cfg(feature = "ipopt")]
    &nlp::Nonlinear(&nlp::ipopt::Ipopt),
    &super::complementarity::Bmcp,
    &mpec::Bmpec,
    #[cfg(feature = "highs")]
    &highs::Highs,
    &mip::Bmip,
    #[cfg(feature = "highs")]
    &highs::Continuous,
];

/// The option tables of all backends, and of what they share.
pub static OPTION_TABLES: &[&OptionTable] = &[
    &lp::OPTIONS,
    &nlp::SHARED_OPTIONS,
    #[cfg(feature = "ipopt")]
    &nlp::IPOPT_OPTIONS,
    #[cfg(feature = "pounce")]
    &nlp::POUNCE_OPTIONS,
    &mcp::OPTIONS,
    &mpec::OPTIONS,
    &mip::OPTIONS,
    #[cfg(feature = "highs")]
    &highs::OPTIONS,
    &super::strategy::OPTIONS,
];

/// The tables of what may run for a problem type, for its option file: names that it may have (`path` for
/// `path.opt`), and what may stand in it.
pub fn option_file(
    using: ProblemType,
    choice: Option<&str>,
) -> (&'static [&'static str], Vec<&'static OptionTable>) {
    let linear = [&lp::OPTIONS];
    let nonlinear = || {
        let mut tables: Vec<&OptionTable> = OPTION_TABLES.to_vec();
        tables.retain(|t| t.backend != mcp::OPTIONS.backend);
        tables
    };
    match (using, choice) {
        (ProblemType::Mcp | ProblemType::Cns, None | Some("path" | "bmcp")) => {
            (&["path"], vec![&mcp::OPTIONS])
        }
        (ProblemType::Mcp | ProblemType::Cns, _) => (&[], Vec::new()),
        (_, Some("clarabel")) => (&["clarabel"], linear.to_vec()),
        (_, None | Some("pounce")) => (&["pounce", "ipopt"], nonlinear()),
        (_, Some("ipopt" | "ipopth")) => (&["ipopt"], nonlinear()),
        _ => (&[], Vec::new()),
    }
}
