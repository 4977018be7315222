//! `bmod kkt`: the optimality conditions of a smooth model, with its indices.

use super::args::DeriveArgs;
use super::derive::{Derived, finish, studied};
use crate::check::functions::{is_nonsmooth, name_of};
use crate::check::node::{AggregateOp, EquationDef, Node, NodeKind};
use crate::check::visit::Visitor;
use crate::diag::Diagnostic;
use crate::formulation::derive::{Derivation, Primal};
use crate::formulation::math::{Math, name};
use crate::formulation::page::{Block, Formula, Setter, formulas};
use crate::formulation::tree::{Expr, sum, sum_over, times};
use crate::formulation::{Formulation, check, kkt};
use crate::run::{Machine, Studied};
use crate::source::Span;

/// Carries out `bmod kkt`; its exit status.
pub fn kkt(a: &DeriveArgs) -> u8 {
    studied(&a.model, &a.solve, &a.chosen, &mut |m, primal, studied| {
        let (symbols, store) = (&m.symbols, &m.store);
        let f = kkt::kkt(symbols, store, &primal, false)
            .map_err(|r| refusal(m, &primal, &studied, r))?;
        let mut page = Vec::new();
        let mut s = Setter::new(symbols, store, &f);
        page.push(Block::Heading(format!("Lagrangian of {}", primal.name)));
        if let Some(l) = lagrangian(m, &primal) {
            let mut own = Setter::new(symbols, store, &l.1);
            let formula = Math::Row(vec![
                Math::Name(name("L")),
                Math::Operator("="),
                own.expr(&l.0),
            ]);
            page.push(Block::Formulas(vec![Formula {
                name: String::new(),
                math: formula,
                runs: None,
                words: String::new(),
            }]));
        }
        page.push(Block::Heading(
            "Optimality conditions (Karush, Kuhn, Tucker)".into(),
        ));
        page.extend(formulas(&mut s, symbols, &f));
        // What is written is what was generated.
        let mut checked =
            (a.check || a.as_model.is_some()).then(|| check::checked_kkt(symbols, store, &primal));
        let f = match &mut checked {
            Some(Ok((written, _))) => written.clone(),
            _ => f.clone(),
        };
        let check = checked.map(|c| c.map(|c| c.1)).filter(|_| a.check);
        let derived = Derived {
            page,
            title: format!("The optimality conditions of {}", primal.name),
            formulation: f,
            check,
            compared: "stationarity and rows against the automatic derivatives, at points drawn at random",
        };
        Ok(finish(a, m, &derived, &primal))
    })
}

/// The Lagrangian, and the formulation whose names it uses.
fn lagrangian(m: &Machine, primal: &Primal) -> Option<(Expr, Formulation)> {
    let mut d = Derivation::new(&m.symbols, &m.store, primal, String::new(), "nlp").ok()?;
    d.multipliers_of_rows(false);
    let function = match (&d.eliminated, primal.objective) {
        (Some(o), _) => o.function.clone(),
        (None, Some((_, z))) => {
            Expr::Variable(crate::formulation::tree::Variable::Own(z), Vec::new())
        }
        _ => return None,
    };
    let mut terms = vec![(false, function)];
    for (k, e) in primal.equations.iter().enumerate() {
        let Some(y) = d.multiplier_of(k) else {
            continue;
        };
        let g = sum(vec![(false, e.left.clone()), (true, e.right.clone())]);
        terms.push((true, sum_over(e.binder.clone(), times(y, g))));
    }
    Some((sum(terms), d.out))
}

/// Why there are no conditions, with the place.
fn refusal(
    m: &Machine,
    primal: &Primal,
    studied: &Studied,
    (equation, why): kkt::Refusal,
) -> Diagnostic {
    let Some(k) = equation else {
        return Diagnostic::execution(
            "E0432",
            studied.span,
            format!("the optimality conditions cannot be derived: {why}"),
        )
        .label("of this solve")
        .help("they belong to a model with an objective, solved `using nlp`, `qcp` or `lp`");
    };
    let symbol = primal.equations[k].symbol;
    let def = m.equations.iter().find(|d| d.symbol == symbol);
    let place = def.and_then(kink).or(def.map(|d| d.span));
    let name = &m.symbols.get(symbol).name;
    Diagnostic::execution(
        "E0432",
        place.unwrap_or(studied.span),
        format!("the optimality conditions cannot be derived: in `{name}`, {why}"),
    )
    .label("here")
    .other(studied.span, "at this solve")
    .help("reformulate it with additional variables and inequalities")
}

/// The first place in an equation that is not smooth.
fn kink(e: &EquationDef) -> Option<Span> {
    struct Kinks(Option<Span>);
    impl<'a> Visitor<'a> for Kinks {
        fn node(&mut self, n: &'a Node) {
            let kink = match &n.kind {
                NodeKind::Call(f, _) => {
                    is_nonsmooth(*f) || matches!(name_of(*f), "gamma" | "loggamma")
                }
                NodeKind::Aggregate(op, ..) => matches!(op, AggregateOp::Smin | AggregateOp::Smax),
                _ => false,
            };
            if self.0.is_none() && n.has_var && kink {
                self.0 = Some(n.span);
            }
            n.walk(self);
        }
    }
    let mut kinks = Kinks(None);
    kinks.node(&e.left);
    kinks.node(&e.right);
    kinks.0
}
