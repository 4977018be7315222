//! A model as it was written, as formulas.

use super::bounds;
use super::derive::{Primal, domain_of};
use super::lower::{Equation, Lowering};
use super::page::{Block, Page, Setter, formulas, legend};
use super::tree::*;
use super::{Formulation, Row, Scope};
use crate::check::model::Listed;
use crate::check::node::{Code, CodeKind, ModelRow, SolveCode, SymbolId};
use crate::check::symbols::{SymbolKind, Symbols};
use crate::check::visit::each_statement;
use crate::diag::nearest;
use crate::run::{Machine, Studied};
use crate::source::Span;

/// What a model consists of, with its objective if some solve says one.
pub struct Chosen {
    /// The model.
    pub model: SymbolId,
    /// Its equations and pairs.
    pub rows: Vec<ModelRow>,
    /// Direction and objective variable.
    pub objective: Option<(Sense, SymbolId)>,
    /// Problem type, if it is solved.
    pub using: Option<String>,
    /// The place of the solve.
    pub solve: Option<Span>,
}

impl Chosen {
    /// The model of a solve.
    pub fn of(s: &Studied) -> Self {
        Self::new(&s.code, s.span)
    }

    fn new(s: &SolveCode, span: Span) -> Self {
        Self {
            model: s.model,
            rows: s.equations.clone(),
            objective: s.objective,
            using: Some(s.using.to_string()),
            solve: Some(span),
        }
    }
}

/// The model of this name, or the one that is solved last; `Err` says why there is none.
pub fn choose(m: &Machine, code: &[Code], name: Option<&str>) -> Result<Chosen, String> {
    let symbols = &m.symbols;
    let mut solves: Vec<(&SolveCode, Span)> = Vec::new();
    each_statement(code, &mut |c, _| {
        if let CodeKind::Solve(s) = &c.kind {
            solves.push((s, c.span));
        }
    });
    if let Some(name) = name {
        let is_model = |s: &SymbolId| matches!(symbols.get(*s).kind, SymbolKind::Model(_));
        let Some(model) = symbols.find(name).filter(is_model) else {
            return Err(unknown(symbols, name));
        };
        solves.retain(|s| s.0.model == model);
        if solves.is_empty() {
            let SymbolKind::Model(info) = &symbols.get(model).kind else {
                return Err(unknown(symbols, name));
            };
            let mut listed = Listed::default();
            let items = info.items.as_deref().unwrap_or(&[]);
            listed.collect(items, symbols, &|id| symbols.find(&id.name), 0);
            return Ok(Chosen {
                model,
                rows: listed.rows,
                objective: None,
                using: None,
                solve: None,
            });
        }
    }
    if let Some((s, span)) = solves.last() {
        return Ok(Chosen::new(s, *span));
    }
    match models(symbols).as_slice() {
        [] => Err("the text has no model".into()),
        [one] => choose(m, code, Some(one)),
        many => Err(format!(
            "no model is solved; say which with `--model`: {}",
            many.join(", ")
        )),
    }
}

fn models(symbols: &Symbols) -> Vec<&str> {
    let is_model = |kind: &SymbolKind| matches!(kind, SymbolKind::Model(_));
    let models = symbols.iter().filter(|(_, s)| is_model(&s.kind));
    models.map(|(_, s)| &*s.name).collect()
}

/// There is no model of this name; the nearest is shown.
pub fn unknown(symbols: &Symbols, name: &str) -> String {
    let names = models(symbols);
    match nearest(name, names.iter().copied()) {
        Some(n) => format!("there is no model `{name}`; did you mean `{n}`?"),
        None if names.is_empty() => format!("there is no model `{name}`: the text has none"),
        None => format!(
            "there is no model `{name}`; there are: {}",
            names.join(", ")
        ),
    }
}

/// The model as formulas.
pub fn formulation(m: &Machine, chosen: &Chosen) -> Formulation {
    let symbols = &m.symbols;
    let owner = |t| m.table_owner(t);
    let mut lowering = Lowering::new(symbols, &owner);
    let lowered: Vec<Equation> = chosen
        .rows
        .iter()
        .map(|r| lowering.equation(&m.equations[r.definition]))
        .collect();
    let mut own: Vec<SymbolId> = Vec::new();
    for e in &lowered {
        e.left.own_variables(&mut own);
        e.right.own_variables(&mut own);
    }
    own.sort_unstable();
    let rows = lowered.iter().zip(&chosen.rows).map(|(e, r)| {
        let domain = domain_of(symbols, e.symbol);
        e.row(symbols, domain, r.pair.map(Variable::Own))
    });
    let rows: Vec<Row> = rows.collect();
    let objective = chosen
        .objective
        .map(|(sense, z)| (sense, Expr::Variable(Variable::Own(z), Vec::new())));
    Formulation {
        name: symbols.get(chosen.model).name.to_string(),
        using: chosen.using.clone().unwrap_or_default(),
        objective,
        own,
        rows,
        indices: lowering.indices,
        ..Formulation::default()
    }
}

/// The page: legend, objective, rows, bounds; with an instance its numbers.
pub fn page(
    m: &Machine,
    code: &[Code],
    chosen: &Chosen,
    numbers: Option<&Primal>,
) -> (Page, Formulation) {
    let symbols = &m.symbols;
    let mut f = formulation(m, chosen);
    let bounds = bounds::assigned(m, code, &mut f, chosen.solve);
    let in_bounds = bounds.iter().flat_map(bounds::Assigned::expressions);
    let mut out = legend(symbols, &f, in_bounds);
    out.push(Block::Heading(heading(&f)));
    let mut s = Setter::new(Scope::of(m), &f);
    out.extend(formulas(&mut s, &f));
    let known = bounds::known(&mut s, &f, &bounds, f.using.starts_with('r'));
    out.extend(bounds::with(known, false));
    if let Some(p) = numbers {
        let cones = p.cones();
        out.extend(cones.map(|c| Block::Words(format!("convex: {c}"))));
        super::numbers::add(&mut out, m, &p.generated);
    }
    (out, f)
}

fn heading(f: &Formulation) -> String {
    match f.using.is_empty() {
        true => format!("Model {}", f.name),
        false => format!("Model {} ({})", f.name, f.using),
    }
}
