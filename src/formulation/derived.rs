//! The dual and the optimality conditions of a solve: the page, the model, the comparison; or a refusal with its place.

use super::bounds;
use super::check::{self, Comparison};
use super::derive::{Derivation, Primal};
use super::math::{Math, name};
use super::page::{Block, Formula, Page, Setter, formulas};
use super::tree::{Expr, Variable, sum, sum_over};
use super::{Formulation, Scope, dual, kkt, side, text};
use crate::check::node::{AggregateOp, EquationDef, Node, NodeKind, SymbolId};
use crate::check::visit::Visitor;
use crate::diag::Diagnostic;
use crate::model::problem_type::ProblemType;
use crate::run::{Machine, Studied};
use crate::solve::ModelStatus;
use crate::solve::nlp::convex::{Shape, shape};
use crate::source::Span;

/// What is derived from a model.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// The dual of a linear or convex quadratic program.
    Dual,
    /// The optimality conditions of a smooth program.
    Kkt,
}

/// What a derivation came to.
pub struct Derived {
    /// Its title.
    pub title: String,
    /// The page that is shown.
    pub page: Page,
    /// What is written as a model; its multipliers are GAMS's marginals.
    pub formulation: Formulation,
    /// What the comparison found.
    pub check: Option<Comparison>,
    /// What is compared, in words.
    compared: &'static str,
}

impl Kind {
    /// Derives; `check` compares, `write`: the formulation is to be written as a model.
    ///
    /// # Errors
    /// A refusal with its place.
    pub fn derive(
        self,
        m: &Machine,
        primal: &Primal,
        studied: &Studied,
        check: bool,
        write: bool,
    ) -> Result<Derived, Box<Diagnostic>> {
        match self {
            Kind::Dual => linear_dual(m, primal, studied, check),
            Kind::Kkt => conditions(m, primal, studied, check, write),
        }
    }
}

impl Derived {
    /// What is to be said beside the page: what was derived by instance, and what the comparison found.
    pub fn remarks(&self) -> Vec<String> {
        let mut out = Vec::new();
        if !self.formulation.by_instance.is_empty() {
            out.push(format!(
                "Derived by instance, not in symbols: {}.",
                self.formulation.by_instance.join("; ")
            ));
        }
        out.extend(self.check.as_ref().map(|c| match c.passed() {
            _ if c.impossible.is_some() => format!(
                "The check could not be made: {}.",
                c.impossible.as_deref().unwrap_or_default()
            ),
            true => format!(
                "Checked: {}: {} entries and {} numbers are equal (largest relative difference {:.0e}).",
                self.compared, c.entries, c.numbers, c.largest
            ),
            false => {
                let s = if c.count == 1 { "" } else { "s" };
                let all = c.differences.join("\n  ");
                format!("The check failed: {} difference{s}.\n  {all}", c.count)
            }
        }));
        out
    }

    /// Whether a comparison found something.
    pub fn failed(&self) -> bool {
        self.check.as_ref().is_some_and(|c| !c.passed())
    }

    /// The model as a text that solves itself; `include`: the user's text in place of the data. `file`: where it comes
    /// from.
    pub fn model(&self, m: &Machine, primal: &Primal, file: &str, include: Option<&str>) -> String {
        let head = format!(
            "$title {}\n* Derived by bmod from the model {} of {file}.\n\n",
            self.title, primal.name
        );
        let f = &self.formulation;
        text::model(Scope::of(m), f, include, &head, true, None)
    }

    /// That a model which includes the text is another one, where the text goes on and changes its data.
    pub fn changed_later(&self, m: &Machine, studied: &Studied) -> Option<String> {
        let at_end = |t| studied.at_end(t);
        let changed = text::changed(Scope::of(m), &self.formulation, &at_end);
        let (names, last) = (changed.join(", "), changed.last()?);
        let verb = if *last == names { "has" } else { "have" };
        Some(format!(
            "{names} {verb} other values at the end of the text than at the solve: the model that includes the text is \
             derived from those of the end. Without `--include` it has those of the solve."
        ))
    }
}

fn not_generated(why: &str) -> Comparison {
    Comparison::impossible(&format!("the derived model could not be generated: {why}"))
}

fn linear_dual(
    m: &Machine,
    primal: &Primal,
    studied: &Studied,
    check: bool,
) -> Result<Derived, Box<Diagnostic>> {
    refuse_dual(m, primal, studied)?;
    let failed = |why: String| {
        let message = format!("the dual cannot be derived: {why}");
        of_solve("E0431", studied, message)
    };
    let scope = Scope::of(m);
    let shown = dual::dual(scope, primal, true).map_err(failed)?;
    let formulation = dual::dual(scope, primal, false).map_err(failed)?;
    let d = Derivation::new(scope, primal, String::new(), "lp").map_err(|e| failed(e.1))?;
    let mut own = side::own(&d);
    let assigned = bounds::assigned(m, &m.code, &mut own, Some(studied.span));
    let mut page = side::page(scope, &own, &assigned, &shown);
    match no_optimum(studied) {
        None => page.extend(side::slackness(scope, primal, shown.flipped)),
        words => page.extend(words),
    }
    Ok(Derived {
        title: format!("The dual of {}", primal.name),
        page,
        formulation,
        check: check.then(|| match check::checked_dual(scope, primal) {
            Ok((_, c)) => c,
            Err(why) => not_generated(&why),
        }),
        compared: match primal.generated.instance.is_linear() {
            true => {
                "the dual's matrix and the transposed matrix of the primal, right-hand sides and bounds included"
            }
            false => {
                "the dual's matrix and the transposed matrix of the primal's tangents, right-hand sides and bounds \
                 included, at points drawn at random"
            }
        },
    })
}

/// A refusal whose place is the solve.
pub(super) fn of_solve(
    code: &'static str,
    studied: &Studied,
    message: impl Into<String>,
) -> Diagnostic {
    Diagnostic::execution(code, studied.span)
        .says(message)
        .label("of this solve")
}

/// Whether a model has a dual of this kind at all.
fn refuse_dual(m: &Machine, primal: &Primal, studied: &Studied) -> Result<(), Box<Diagnostic>> {
    let instance = &primal.generated.instance;
    let no = |message: String| of_solve("E0431", studied, message);
    if primal.objective.is_none() {
        let message = format!(
            "the model `{}` has no objective, and so no dual",
            primal.name
        );
        let help = "a dual belongs to a linear program, solved `using lp`";
        return Err(no(message).help(help).into());
    }
    refuse_discrete(m, primal, no)?;
    let (row, what) = match shape(instance) {
        Shape::Linear | Shape::ConvexQuadratic { .. } => return Ok(()),
        Shape::Quadratic(row) => (row, "quadratic and not convex"),
        Shape::Nonlinear(row) => (Some(row), "neither linear nor quadratic"),
    };
    let what = match primal.cones() {
        Some(_) => "convex by its cones only",
        None => what,
    };
    let row = row.map(|i| primal.generated.origin.rows.of(i as u32).symbol);
    let why = match row {
        Some(e) => format!("`{}` is {what}", m.symbols.get(e).name),
        None => format!("its objective is {what}"),
    };
    let message =
        format!("the dual of a linear or convex quadratic program is asked for, and {why}");
    let refusal = match row.and_then(|e| definition(m, e)) {
        Some(d) => Diagnostic::execution("E0431", d.span)
            .says(message)
            .label("this equation")
            .other(studied.span, "at this solve"),
        None => no(message),
    };
    let help = "`bmod kkt` derives the optimality conditions of a nonlinear program";
    Err(refusal.help(help).into())
}

/// A record that is a discrete choice, and its symbol, where the solve leaves one.
pub fn discrete(m: &Machine, primal: &Primal) -> Option<(SymbolId, String)> {
    let columns = &primal.generated.instance.columns;
    let j = columns
        .first_undecided()
        .filter(|_| !primal.using.starts_with('r'))?;
    let b = primal.generated.origin.columns.of(j as u32);
    Some((b.symbol, m.record_name(b.symbol, b.key(j as u32))))
}

/// Where a model that has discrete choices leaves what only one without them has.
pub fn of_relaxation(primal: &Primal) -> String {
    let using = ProblemType::named(&primal.using).unwrap_or(ProblemType::Mip);
    let relaxation = using.relaxation();
    format!("its relaxation has them: `solve … using {relaxation}`")
}

/// A model with discrete variables has neither a linear dual nor optimality conditions; its relaxation has.
fn refuse_discrete(
    m: &Machine,
    primal: &Primal,
    no: impl Fn(String) -> Diagnostic,
) -> Result<(), Box<Diagnostic>> {
    let Some((symbol, name)) = discrete(m, primal) else {
        return Ok(());
    };
    let message = format!(
        "a model with discrete variables has no dual and no optimality conditions of this kind, and {name} is discrete"
    );
    let declared = m.symbols.get(symbol).declared;
    Err(no(message)
        .other(declared, "declared here")
        .help(of_relaxation(primal))
        .into())
}

/// What is said where the solve found no optimum: its levels and marginals satisfy nothing that is derived here.
fn no_optimum(studied: &Studied) -> Option<Block> {
    use ModelStatus::{LocallyOptimal, Optimal, Solved};
    let status = studied.answer.as_ref().map(|(_, a)| a.status);
    if let None | Some(Optimal | LocallyOptimal | Solved) = status {
        return None;
    }
    let name = status.map_or(String::new(), |s| s.name().to_lowercase());
    let words = format!("The solve ended with: {name}. Its levels and marginals are no optimum.");
    Some(Block::Words(words))
}

fn definition<'a>(m: &'a Machine, e: SymbolId) -> Option<&'a EquationDef> {
    m.equations.iter().find(|d| d.symbol == e)
}

fn conditions(
    m: &Machine,
    primal: &Primal,
    studied: &Studied,
    check: bool,
    write: bool,
) -> Result<Derived, Box<Diagnostic>> {
    let scope = Scope::of(m);
    refuse_discrete(m, primal, |message| of_solve("E0432", studied, message))?;
    let mut f =
        kkt::kkt(scope, primal, false, true).map_err(|r| refuse_kkt(m, primal, studied, r))?;
    let mut page = vec![Block::Heading(format!("Lagrangian of {}", primal.name))];
    if let Some(l) = lagrangian(m, primal) {
        let mut own = Setter::new(scope, &l.1);
        let math = Math::Row(vec![
            Math::Name(name("L")),
            Math::Operator("="),
            own.expr(&l.0),
        ]);
        page.push(Block::Formulas(vec![Formula::of(math)]));
    }
    page.push(Block::Heading(
        "Optimality conditions (Karush, Kuhn, Tucker)".into(),
    ));
    let assigned = bounds::assigned(m, &m.code, &mut f, Some(studied.span));
    let mut s = Setter::new(scope, &f);
    page.extend(formulas(&mut s, &f));
    let known = bounds::known(&mut s, &f, &assigned, true);
    page.extend(bounds::with(known, !f.multipliers.is_empty()));
    page.extend(f.notes.iter().cloned().map(Block::Words));
    page.extend(no_optimum(studied));
    // What is written is what was generated.
    let (formulation, check) = match check || write {
        false => (f, None),
        true => match check::checked_kkt(scope, primal) {
            Ok((written, c)) => (written, check.then_some(c)),
            Err(why) => (f, check.then(|| not_generated(&why))),
        },
    };
    Ok(Derived {
        title: format!("The optimality conditions of {}", primal.name),
        page,
        formulation,
        check,
        compared: "stationarity and rows against the automatic derivatives, at points drawn at random",
    })
}

/// The Lagrangian, and the formulation whose names it uses.
fn lagrangian(m: &Machine, primal: &Primal) -> Option<(Expr, Formulation)> {
    let mut d = Derivation::new(Scope::of(m), primal, String::new(), "nlp").ok()?;
    d.multipliers_of_rows(true);
    let function = match (&d.eliminated, primal.objective) {
        (Some(o), _) => o.function.clone(),
        (None, Some((_, z))) => Expr::Variable(Variable::Own(z), Vec::new()),
        _ => return None,
    };
    let mut terms = vec![(false, function)];
    for (k, e) in primal.equations.iter().enumerate() {
        let Some(y) = d.multiplier_of(k) else {
            continue;
        };
        let g = e.left.clone() - e.right.clone();
        terms.push((true, sum_over(e.binder.clone(), y * g)));
    }
    Some((sum(terms), d.out))
}

/// Why there are no conditions, with the place.
fn refuse_kkt(
    m: &Machine,
    primal: &Primal,
    studied: &Studied,
    (equation, why): kkt::Refusal,
) -> Diagnostic {
    let Some(k) = equation else {
        let message = format!("the optimality conditions cannot be derived: {why}");
        return of_solve("E0432", studied, message)
            .help("they belong to a model with an objective, solved `using nlp`, `qcp` or `lp`");
    };
    let symbol = primal.equations[k].symbol;
    let def = definition(m, symbol);
    let place = def.and_then(kink).or(def.map(|d| d.span));
    let name = &m.symbols.get(symbol).name;
    Diagnostic::execution("E0432", place.unwrap_or(studied.span))
        .says(format!(
            "the optimality conditions cannot be derived: in `{name}`, {why}"
        ))
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
                    f.is_nonsmooth() || matches!(f.name(), "gamma" | "loggamma")
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
