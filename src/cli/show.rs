//! `bmod show`: a model as formulas. Nothing is run.

use super::args::{EXECUTION, ShowArgs};
use super::commands::{compiled, name};
use super::derive::{format, tell};
use crate::formulation::{page, show};
use crate::run::{Machine, Options};

/// Carries out `bmod show`; its exit status.
pub fn show(a: &ShowArgs) -> u8 {
    compiled(&a.model, &mut |program, host| {
        let (m, code) = Machine::new(program, host, Options::default());
        let chosen = match show::choose(&m, &code, a.name.as_deref()) {
            Ok(c) => c,
            Err(why) => {
                eprintln!("bmod: {}: {why}", name(&a.model));
                return EXECUTION;
            }
        };
        let (page, _) = show::page(&m, &code, &chosen);
        let title = m.symbols.get(chosen.model).name.to_string();
        tell(&page::write(&page, format(a.format), &title));
        0
    })
}
