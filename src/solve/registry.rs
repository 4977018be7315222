//! The backends that are in this build, in order of preference. To add one: a folder with a type that implements
//! [`Backend`], and a line here; its names, options and option files are those of its [`About`].

use super::backend::{About, Backend, Task, is_called};
#[cfg(feature = "highs")]
use super::highs;
use super::{lp, mip, mpec, nlp};
use crate::model::language::LANGUAGE;
use crate::model::option::{OptionTable, Solvers};
use crate::model::problem_type::ProblemType;
use std::sync::LazyLock;

/// All of them.
pub static BACKENDS: &[&dyn Backend] = &[
    &lp::Clarabel,
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

/// The options of the language, of all backends, and those that backends share.
pub static OPTION_TABLES: LazyLock<Vec<&'static OptionTable>> = LazyLock::new(|| {
    let mut tables = vec![&LANGUAGE];
    let own = BACKENDS.iter().map(|b| b.about().options);
    for table in own.chain(SHARED) {
        if tables.iter().all(|t| t.backend != table.backend) {
            tables.push(table);
        }
    }
    tables
});

/// Options that several backends take.
const SHARED: [&OptionTable; 2] = [&nlp::SHARED_OPTIONS, &super::strategy::OPTIONS];

/// What checks options: tables, and the names of solvers with the problem types that each may be chosen for.
pub static SOLVERS: LazyLock<Solvers> = LazyLock::new(|| Solvers {
    tables: &OPTION_TABLES,
    names: &NAMES,
});

static NAMES: LazyLock<Vec<(&'static str, Vec<ProblemType>)>> = LazyLock::new(|| {
    let mut names = Vec::new();
    for About {
        name,
        aliases,
        supports,
        ..
    } in BACKENDS.iter().map(|b| b.about())
    {
        let mut types = supports.types.to_vec();
        if supports.pairs && types.contains(&ProblemType::Mcp) {
            types.extend([ProblemType::Lp, ProblemType::Rmip]); // by `bridge::kkt`
        }
        names.extend(
            [&name]
                .into_iter()
                .chain(aliases)
                .map(|n| (*n, types.clone())),
        );
    }
    names
});

/// The option files of whoever may solve a task or what it is led back to (`path` for `path.opt`), and the tables of
/// what may stand in them.
pub fn option_file(task: &Task) -> (Vec<&'static str>, Vec<&'static OptionTable>) {
    let able = || BACKENDS.iter().filter(|b| b.takes(task));
    let named = |b: &&&dyn Backend| task.choice.is_some_and(|name| is_called(**b, name));
    let any = able().any(|b| named(&b));
    let chosen = able().filter(|b| match any {
        true => named(b),
        false => !b.about().supports.only_by_name,
    });
    let inside = || {
        let all = BACKENDS.iter().map(|b| b.about());
        all.filter(|a| a.supports.types.contains(&task.using))
    };
    let nonlinear = task.has_pairs() || !task.instance.is_linear();
    let within = inside().filter(|a| nonlinear && !a.supports.linear);
    let chosen = chosen.map(|b| b.about()).chain(within);
    let mut files: Vec<&str> = Vec::new();
    for file in chosen.flat_map(|a| a.option_files) {
        if !files.contains(file) {
            files.push(file);
        }
    }
    (files, inside().map(|a| a.options).chain(SHARED).collect())
}
