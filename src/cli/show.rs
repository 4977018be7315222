//! `bmod show`: a model as formulas. Nothing is run, unless its numbers are asked for.

use super::args::{ChosenArgs, EXECUTION, ShowArgs};
use super::commands::{Status, compiled, complain, name};
use super::derive::{format, studied, tell};
use crate::formulation::{page, show};
use crate::run::{Machine, Options};

/// Carries out `bmod show`; its exit status.
pub(super) fn show(a: &ShowArgs) -> Status {
    if a.numbers {
        let chosen = ChosenArgs {
            name: a.name.clone(),
            number: None,
        };
        return studied(&a.model, &a.solve, &chosen, &mut |m, primal, studied| {
            let chosen = show::Chosen::of(&studied);
            let (page, f) = show::page(m, &m.code, &chosen, Some(&primal));
            tell(&page::write(&page, format(a.format), &f.name));
            Ok(0)
        });
    }
    compiled(&a.model, &mut |program, host| {
        let (m, code) = Machine::new(program, host, Options::default());
        let chosen = show::choose(&m, &code, a.name.as_deref())
            .map_err(|why| complain(EXECUTION, format!("{}: {why}", name(&a.model))))?;
        let (page, f) = show::page(&m, &code, &chosen, None);
        tell(&page::write(&page, format(a.format), &f.name));
        Ok(0)
    })
}
