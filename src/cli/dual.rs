//! `bmod dual`: the dual of a linear model, with its indices.

use super::args::DeriveArgs;
use super::derive::{Derived, finish, studied};
use crate::diag::Diagnostic;
use crate::formulation::derive::{Derivation, Primal};
use crate::formulation::{check, dual, side};
use crate::run::{Machine, Studied};

/// Carries out `bmod dual`; its exit status.
pub fn dual(a: &DeriveArgs) -> u8 {
    studied(&a.model, &a.solve, &a.chosen, &mut |m, primal, studied| {
        refuse(m, &primal, &studied)?;
        let failed = |why: String| {
            Diagnostic::execution(
                "E0431",
                studied.span,
                format!("the dual cannot be derived: {why}"),
            )
            .label("of this solve")
        };
        let (symbols, store) = (&m.symbols, &m.store);
        let shown = dual::dual(symbols, store, &primal, true).map_err(failed)?;
        let formulation = dual::dual(symbols, store, &primal, false).map_err(failed)?;
        let d = Derivation::new(symbols, store, &primal, String::new(), "lp")
            .map_err(|e| failed(e.1))?;
        let mut page = side::page(symbols, store, &side::own(&d), &shown);
        page.extend(side::slackness(symbols, store, &primal, shown.flipped));
        let check = a
            .check
            .then(|| check::checked_dual(symbols, store, &primal).map(|c| c.1));
        let derived = Derived {
            page,
            title: format!("The dual of {}", primal.name),
            formulation,
            check,
            compared: "the dual's matrix and the transposed matrix of the primal, right-hand sides and bounds included",
        };
        Ok(finish(a, m, &derived, &primal))
    })
}

/// Whether a model has a dual of this kind at all.
fn refuse(m: &Machine, primal: &Primal, studied: &Studied) -> Result<(), Box<Diagnostic>> {
    let instance = &primal.generated.instance;
    let no = |message: String| {
        Diagnostic::execution("E0431", studied.span, message).label("of this solve")
    };
    if primal.objective.is_none() {
        let message = format!(
            "the model `{}` has no objective, and so no dual",
            primal.name
        );
        let help = "a dual belongs to a linear program, solved `using lp`";
        return Err(no(message).help(help).into());
    }
    let relaxed = primal.using.starts_with('r');
    if let Some(j) = instance.columns.first_undecided().filter(|_| !relaxed) {
        let b = primal.generated.origin.columns.of(j as u32);
        let name = m.record_name(b.symbol, b.key(j as u32));
        let declared = m.symbols.get(b.symbol).declared;
        let message =
            format!("a model with discrete variables has no linear dual, and {name} is discrete");
        return Err(no(message)
            .other(declared, "declared here")
            .help("the relaxation has one: `solve … using rmip`")
            .into());
    }
    if !instance.is_linear() {
        let row = instance
            .nonlinear_rows()
            .iter()
            .position(|n| *n)
            .unwrap_or(0);
        let e = primal.generated.origin.rows.of(row as u32).symbol;
        let span = m
            .equations
            .iter()
            .find(|d| d.symbol == e)
            .map_or(studied.span, |d| d.span);
        let name = &m.symbols.get(e).name;
        return Err(Diagnostic::execution(
            "E0431",
            span,
            format!("the dual of a linear program is asked for, and `{name}` is not linear"),
        )
        .label("this equation")
        .other(studied.span, "at this solve")
        .help("`bmod kkt` derives the optimality conditions of a nonlinear program")
        .into());
    }
    Ok(())
}
