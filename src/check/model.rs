//! The `solve` statement: which equations, paired with what, of which class.

use super::node::*;
use super::symbols::{DomainPosition, Symbol, SymbolKind, Symbols};
use super::{Checked, Compiler, Failed};
use crate::diag::{Diagnostic, nearest};
use crate::model::instance::Function;
use crate::model::problem_type::{Discrete, ProblemType};
use crate::source::{Known, Span};
use crate::syntax::ast::{Ident, ModelItem, Solve, VariableKind};

/// What the list of a model names.
#[derive(Default)]
pub struct Listed {
    /// Its equations.
    pub rows: Vec<ModelRow>,
    /// Declared, not defined so far: a later item may take them out.
    undefined: Vec<(SymbolId, Span)>,
    /// Sets that limit variables.
    limits: Vec<(SymbolId, SymbolId)>,
    /// Something is not known.
    failed: bool,
}

impl Listed {
    /// Adds what items name, in their order; `find` gives the symbol of a name.
    pub fn collect(
        &mut self,
        items: &[ModelItem],
        symbols: &Symbols,
        find: &dyn Fn(&Ident) -> Option<SymbolId>,
        depth: usize,
    ) {
        let one = std::slice::from_ref;
        for item in items.iter().filter(|_| depth <= 50) {
            let names = match item {
                ModelItem::Add(name) | ModelItem::Remove(name) | ModelItem::Limit(name, _) => {
                    one(name)
                }
                ModelItem::Pair { rows, .. } => rows,
                // Declarations have put the equations in its place.
                ModelItem::All(_) => &[],
            };
            for name in names {
                let Some(id) = find(name) else {
                    self.failed = true;
                    continue;
                };
                let add = |to: &mut Self| match &symbols.get(id).kind {
                    SymbolKind::Model(m) => {
                        let inner = m.items.as_deref().unwrap_or(&[]);
                        to.collect(inner, symbols, find, depth + 1);
                    }
                    _ => to.add_row(symbols, id, None, name.span),
                };
                match item {
                    ModelItem::Limit(_, sets) => {
                        let sets = sets.iter().filter_map(find);
                        self.limits.extend(sets.map(|set| (id, set)));
                    }
                    ModelItem::Pair { column, .. } => match find(column) {
                        None => self.failed = true,
                        pair => self.add_row(symbols, id, pair, name.span.to(column.span)),
                    },
                    ModelItem::Remove(_) => {
                        let mut gone = Self::default();
                        add(&mut gone);
                        let there = |d| gone.rows.iter().any(|g| g.definition == d);
                        self.rows.retain(|r| !there(r.definition));
                        let there = |s| gone.undefined.iter().any(|g| g.0 == s);
                        self.undefined.retain(|u| !there(u.0));
                        self.failed |= gone.failed;
                    }
                    _ => add(self),
                }
            }
        }
    }

    /// Adds an equation; a pair of one that is there already becomes its.
    fn add_row(&mut self, symbols: &Symbols, e: SymbolId, pair: Option<SymbolId>, span: Span) {
        let SymbolKind::Equation(defined) = symbols.get(e).kind else {
            return;
        };
        let Some(definition) = defined else {
            return self.undefined.push((e, span));
        };
        let of_it = |r: &&mut ModelRow| r.definition == definition;
        let mut there = self.rows.iter_mut().filter(of_it);
        match there.find(|r| r.pair.is_none() || pair.is_none() || r.pair == pair) {
            Some(r) => r.pair = r.pair.or(pair),
            None => self.rows.push(ModelRow {
                definition,
                pair,
                span,
            }),
        }
    }
}

impl Compiler {
    pub(super) fn solve(&mut self, s: &Solve, span: Span) -> Checked<CodeKind> {
        let model = self.lookup_model(&s.model)?;
        let symbol = self.symbols.get(model).clone();
        let SymbolKind::Model(info) = &symbol.kind else {
            let (name, kind) = (&symbol.name, symbol.a_kind());
            return Diagnostic::error("E0350", s.model.span)
                .says(format!("`{name}` is {kind}, not a model"))
                .label("a model is expected")
                .other(symbol.declared, "declared here")
                .help("declare one: `model m / all /;`")
                .fail(self);
        };
        let Some(using) = ProblemType::named(&s.using.name) else {
            return self.no_problem_type(&s.using);
        };
        let mut listed = Listed::default();
        let find = |id: &Ident| self.named(id).filter(|s| !self.is_torn(*s));
        let items = info.items.as_deref().unwrap_or(&[]);
        listed.collect(items, &self.symbols, &find, 0);
        if listed.failed {
            return Err(Failed);
        }
        self.not_defined(&listed.undefined)?;
        let Listed {
            mut rows, limits, ..
        } = listed;
        rows.sort_by_key(|r| self.equations[r.definition].symbol);
        // Its list, or a declaration of equations, was wrong: that was said.
        if rows.is_empty() && (info.items.is_none() && self.errors() > 0 || self.lacks_something())
        {
            return Err(Failed);
        }
        if rows.is_empty() {
            return Diagnostic::error("E0353", s.model.span)
                .says(format!("the model `{}` has no equations", symbol.name))
                .label("nothing to solve")
                .other(symbol.declared, "declared here")
                .help("list equations in it: `model m / all /;`")
                .fail(self);
        }
        let has_objective = using.has_objective();
        let objective = match &s.objective {
            Some((sense, name)) if has_objective => Some((*sense, self.objective(name, &rows)?)),
            Some((_, name)) => {
                return Diagnostic::error("E0354", name.span)
                    .says(format!("a model of type `{using}` has no objective"))
                    .label("not expected here")
                    .help(format!("write `solve {} using {using};`", symbol.name))
                    .fail(self);
            }
            None if has_objective => {
                return Diagnostic::error("E0355", span)
                    .says(format!("a model of type `{using}` needs an objective variable"))
                    .label("no `minimizing` or `maximizing`")
                    .help(format!("write `solve {} using {using} minimizing z;` with a free scalar variable `z`", symbol.name))
                    .fail(self);
            }
            None => None,
        };
        let mut failed = false;
        for r in &rows {
            failed |= self.check_class(r.definition, using, s.using.span).is_err();
        }
        failed |= self.check_discrete(&rows, using, s.using.span).is_err();
        failed |= self.check_loops(&rows, s.model.span).is_err();
        let whole = !rows
            .iter()
            .any(|r| self.lost.definitions.contains(&r.definition));
        if using.has_pairs() && whole {
            failed |= self.check_pairs(&rows, using).is_err();
        }
        if failed {
            return Err(Failed);
        }
        self.solved(&rows);
        let scenario = match &s.scenario {
            Some(name) => Some(self.dictionary(name)?),
            None => None,
        };
        for r in &rows {
            for (symbol, at) in std::mem::take(&mut self.without_data[r.definition]) {
                self.used(symbol, at);
            }
        }
        Ok(CodeKind::Solve(Box::new(SolveCode {
            model,
            equations: rows,
            limits,
            using,
            objective,
            scenario,
        })))
    }

    fn lookup_model(&mut self, name: &Ident) -> Checked<SymbolId> {
        let all = name.name.eq_ignore_ascii_case("all");
        let is_model = |(_, s): (SymbolId, &Symbol)| matches!(s.kind, SymbolKind::Model(_));
        if !all && self.named(name).is_none() && !self.symbols.iter().any(is_model) {
            let d = Diagnostic::error("E0301", name.span)
                .says(format!("the model `{}` is not declared", name.name))
                .label("unknown model")
                .help(format!("declare it before: `model {} / all /;`", name.name));
            return self.unknown(name, d);
        }
        if !all {
            return self.lookup(name);
        }
        Diagnostic::error("E0350", name.span)
            .says("`all` stands in the list of a model")
            .label("a model is expected")
            .help("write `model m / all /; solve m using lp minimizing z;`")
            .fail(self)
    }

    fn no_problem_type<T>(&mut self, name: &Ident) -> Checked<T> {
        if name.name.eq_ignore_ascii_case("emp") {
            return Diagnostic::error("E0352", name.span)
                .says("`emp` is not there")
                .label("not supported")
                .help("state the optimality conditions as an `mcp`")
                .fail(self);
        }
        let names: Vec<&str> = ProblemType::ALL.iter().map(|t| t.name()).collect();
        let near = match name.name.to_lowercase().as_str() {
            "qp" | "quadratic" | "socp" | "qcqp" => "qcp",
            "milp" | "ip" | "ilp" | "bip" | "integer" => "mip",
            "miqp" | "miqcqp" => "miqcp",
            "nonlinear" | "convex" => "nlp",
            "lcp" | "ncp" | "vi" => "mcp",
            lower => nearest(lower, names.iter().copied()).unwrap_or("lp"),
        };
        let there_are = names.join(", ");
        Diagnostic::error("E0351", name.span)
            .says(format!("there is no problem type `{}`", name.name))
            .label("unknown problem type")
            .help(format!("did you mean `{near}`? there are: {there_are}"))
            .fail(self)
    }

    /// After a solve, levels and marginals are there: of the equations and of what stands in them.
    fn solved(&mut self, rows: &[ModelRow]) {
        let symbols = &mut self.symbols;
        for r in rows {
            let e = &self.equations[r.definition];
            let named = [e.symbol].into_iter().chain(r.pair);
            named.for_each(|s| symbols.get_mut(s).assigned = true);
            for side in [&e.left, &e.right] {
                side.each(|n| {
                    if let NodeKind::Var(v, _) = n.kind {
                        symbols.get_mut(v).assigned = true;
                    }
                });
            }
        }
    }

    /// The set behind `scenario`; the parameters it names get values in the solve.
    fn dictionary(&mut self, name: &Ident) -> Checked<SymbolId> {
        let s = self.lookup_set(name)?;
        if self.symbols.get(s).dim() != 3 {
            return self.wrong_dimension(s, name.span, 3);
        }
        let table = self.symbols.rooted(s).table;
        self.store.table_mut(table).tidy();
        let spelled = |l| self.store.universe.name(l).to_lowercase();
        let rows = self.store.table(table).iter();
        let rows: Vec<(String, String)> =
            rows.map(|(k, _)| (spelled(k[1]), spelled(k[2]))).collect();
        for (role, n) in rows {
            if let Some(s) = self.symbols.find(&n) {
                if matches!(role.as_str(), "param" | "lower" | "upper" | "fixed") {
                    self.used(s, name.span);
                }
                let root = self.symbols.root(s);
                self.symbols.get_mut(root).assigned = true;
            }
        }
        Ok(s)
    }

    /// Refuses equations that no `..` defines and that nothing takes out of the model.
    fn not_defined(&mut self, undefined: &[(SymbolId, Span)]) -> Checked<()> {
        for &(e, at) in undefined {
            let symbol = self.symbols.get(e);
            let (name, declared) = (&symbol.name, symbol.declared);
            if self.is_lost(name) || self.lacks_equations() {
                continue;
            }
            let help =
                format!("define it: `{name}.. left =e= right;`, or take it out of the model");
            Diagnostic::error("E0356", at)
                .says(format!(
                    "the equation `{name}` is in the model but is not defined"
                ))
                .label("in this model")
                .other(declared, "declared here, and defined nowhere")
                .help(help)
                .report(self);
        }
        undefined.is_empty().then_some(()).ok_or(Failed)
    }

    fn objective(&mut self, id: &Ident, rows: &[ModelRow]) -> Checked<SymbolId> {
        let v = self.lookup(id)?;
        let symbol = self.symbols.get(v).clone();
        let (name, declared) = (&symbol.name, symbol.declared);
        let SymbolKind::Variable(kind) = symbol.kind else {
            return Diagnostic::error("E0357", id.span)
                .says(format!("the objective must be a variable; `{name}` is {}", symbol.a_kind()))
                .label("not a variable")
                .other(declared, "declared here")
                .help("declare a free variable and an equation that defines it: `variable z; equation cost; cost.. z =e= …;`")
                .fail(self);
        };
        if symbol.dim() > 0 {
            return Diagnostic::error("E0358", id.span)
                .says(format!(
                    "the objective must be a single number; `{name}` is indexed"
                ))
                .label("indexed")
                .other(declared, "declared with indices here")
                .help("declare a free scalar variable and define it in an equation")
                .fail(self);
        }
        if !matches!(kind, VariableKind::Free | VariableKind::Unstated) {
            return Diagnostic::error("E0359", id.span)
                .says(format!("the objective `{name}` must be a free variable"))
                .label("restricted in sign")
                .other(declared, "declared here")
                .help(format!(
                    "declare it by `free variable {name};`, and bound it by an equation if it must be"
                ))
                .fail(self);
        }
        // An equation that failed to compile may be the one that mentions it.
        if !self.is_mentioned(v, rows) && self.errors() == 0 {
            return Diagnostic::error("E0360", id.span)
                .says(format!(
                    "the objective `{name}` stands in no equation of the model"
                ))
                .label("in no equation")
                .other(declared, "declared here")
                .help(format!(
                    "define it in an equation of the model: `cost.. {name} =e= …;`"
                ))
                .fail(self);
        }
        Ok(v)
    }

    /// Whether a variable stands in one of these equations.
    fn is_mentioned(&self, v: SymbolId, rows: &[ModelRow]) -> bool {
        let mut equations = rows.iter().map(|r| &self.equations[r.definition]);
        equations.any(|e| e.left.mentions(v) || e.right.mentions(v))
    }

    /// Whether an equation may stand in a model of this type.
    fn check_class(&mut self, definition: usize, using: ProblemType, solve: Span) -> Checked<()> {
        let e = &self.equations[definition];
        let name = self.symbols.get(e.symbol).name.clone();
        let linear_only = using.is_linear();
        let smooth_only = !using.allows_kinks() && !linear_only;
        // GAMS warns of what is not smooth by the type `dnlp`; programs with integers it takes as they are.
        let takes_relations = matches!(
            using,
            ProblemType::Dnlp | ProblemType::Minlp | ProblemType::Rminlp
        );
        let mut found: Option<(Span, String, &'static str, String)> = None;
        let mut look = |n: &Node| {
            if found.is_some() || !n.has_var {
                return;
            }
            let (what, code, help): (String, _, String) = match &n.kind {
                NodeKind::Binary(op, ..) if *op != BinaryOp::Power => {
                    if takes_relations {
                        return;
                    }
                    let help =
                        "use `dnlp`, or a formulation with additional variables and equations";
                    let what = "a relation between variables has no derivative";
                    (what.into(), "E0362", help.into())
                }
                NodeKind::Not(_) if !takes_relations => {
                    let what = "`not` of a variable has no derivative";
                    (what.into(), "E0362", "use `dnlp`".into())
                }
                kind if linear_only && !n.linear && n.children_are_linear() => {
                    let what = match kind {
                        NodeKind::Product(_) => "variables are multiplied or divided here".into(),
                        NodeKind::Binary(..) => "a variable is raised to a power here".into(),
                        NodeKind::Call(f, _) => {
                            format!("`{}` of a variable is not linear", f.name())
                        }
                        _ => "this is not linear in the variables".into(),
                    };
                    let help = match kind {
                        NodeKind::Call(Function::IfThen, a) if !a[0].has_var => "a condition on data stands behind `$`: `x$c + y$(not c)` is linear".into(),
                        NodeKind::Call(f, _) if f.is_nonsmooth() => "solve it `using dnlp`, or write it with inequalities: `y =g= x; y =g= -x` for `y = abs(x)`".into(),
                        _ => format!("solve it `using nlp`, or reformulate the equation `{name}`; a level (`x.l`) is data and may be multiplied"),
                    };
                    (what, "E0361", help)
                }
                NodeKind::Call(f, _) if smooth_only && f.is_nonsmooth() => {
                    let help = "solve it `using dnlp`, or reformulate with additional variables and inequalities";
                    let what = format!("`{}` of a variable is not smooth", f.name());
                    (what, "E0362", help.into())
                }
                NodeKind::Aggregate(AggregateOp::Smin | AggregateOp::Smax, ..) if smooth_only => {
                    let help =
                        "solve it `using dnlp`, or use a variable with one inequality per member";
                    let what = "`smin` and `smax` of variables are not smooth";
                    (what.into(), "E0362", help.into())
                }
                _ => return,
            };
            found = Some((n.span, what, code, help));
        };
        e.left.each(&mut look);
        e.right.each(&mut look);
        let Some((span, what, code, help)) = found else {
            return Ok(());
        };
        let kind = match linear_only {
            true => {
                format!("the equation `{name}` is not linear, but the model is solved as `{using}`")
            }
            false => format!("the equation `{name}` may not stand in a model solved as `{using}`"),
        };
        Diagnostic::error(code, span)
            .says(kind)
            .label(what)
            .other(solve, "solved here")
            .help(help)
            .fail(self)
    }

    /// The sets of the loops around a solve may not run in its equations: in GAMS neither, and whether the
    /// whole set or the loop's element is meant cannot be seen.
    fn check_loops(&mut self, rows: &[ModelRow], solve: Span) -> Checked<()> {
        let looped = self.scope.iter().enumerate();
        let looped = looped.filter(|(at, _)| !self.maps.contains(at));
        let looped: Vec<SymbolId> = looped.map(|(_, (s, _))| *s).collect();
        let found = rows.iter().find_map(|r| {
            let e = &self.equations[r.definition];
            let set = e.running.iter().find(|s| looped.contains(s));
            set.map(|&s| (s, e.symbol, e.span))
        });
        let Some((set, equation, defined)) = found else {
            return Ok(());
        };
        let name = &self.symbols.get(set).name;
        let equation = &self.symbols.get(equation).name;
        let error = Diagnostic::error("E0369", solve)
            .says(format!(
                "`{name}` runs in a loop around this solve and in the equation `{equation}` of the model"
            ))
            .label(format!("solved once for each `{name}`"))
            .other(defined, format!("`{name}` runs here too"))
            .help(format!("loop over an alias: `alias({name},{name}_);` and `loop({name}_, …)`"));
        error.fail(self)
    }

    /// Some types have no discrete variables at all; for the others the solve decides.
    fn check_discrete(
        &mut self,
        rows: &[ModelRow],
        using: ProblemType,
        solve: Span,
    ) -> Checked<()> {
        use VariableKind::{Free, Negative, Positive, Unstated};
        if using.discrete() != Discrete::Forbidden {
            return Ok(());
        }
        let mut discrete = None;
        let equations = rows.iter().map(|r| &self.equations[r.definition]);
        for side in equations.flat_map(|e| [&e.left, &e.right]) {
            side.each(|n| {
                if let NodeKind::Var(v, _) = &n.kind
                    && let SymbolKind::Variable(k) = self.symbols.get(*v).kind
                    && !matches!(k, Unstated | Free | Positive | Negative)
                {
                    discrete.get_or_insert((*v, n.span));
                }
            });
        }
        let Some((v, at)) = discrete else {
            return Ok(());
        };
        let (name, declared) = (&self.symbols.get(v).name, self.symbols.get(v).declared);
        let relaxed = using.relaxation();
        let decides = &relaxed.name()[1..];
        let d = Diagnostic::error("E0363", at)
            .says(format!(
                "`{name}` is a discrete variable, but the model is solved as `{using}`"
            ))
            .label("discrete")
            .other(declared, "declared here")
            .other(solve, "solved here");
        d.help(format!(
            "`solve … using {decides}` decides it; `using {relaxed}` solves the relaxation"
        ))
        .fail(self)
    }

    /// The rules of matching that can be seen in the text.
    fn check_pairs(&mut self, rows: &[ModelRow], using: ProblemType) -> Checked<()> {
        let mut failed = false;
        let paired = || {
            rows.iter()
                .filter_map(|r| Some((r.pair?, r.definition, r.span)))
        };
        for (v, definition, span) in paired() {
            let is_only = paired().filter(|p| p.1 == definition).count() == 1;
            if !self.is_mentioned(v, rows) && is_only {
                let (name, declared) = (&self.symbols.get(v).name, self.symbols.get(v).declared);
                Diagnostic::error("E0368", span)
                    .says(format!(
                        "the variable `{name}` of a pair stands in no equation of the model"
                    ))
                    .label("paired, but in no equation")
                    .other(declared, "declared here")
                    .report(self);
                failed = true;
            }
        }
        for r in rows {
            let e = &self.equations[r.definition];
            let (symbol, relation) = (e.symbol, e.relation);
            let eq = self.symbols.get(symbol).clone();
            let Some(v) = r.pair else {
                if using == ProblemType::Mcp && relation != Relation::Equal {
                    Diagnostic::error("E0364", r.span)
                        .says(format!("the inequality `{}` has no partner", eq.name))
                        .label("unmatched")
                        .other(self.equations[r.definition].span, "defined here")
                        .help(format!("pair it with a variable in the model: `{}.x`; only `=e=` rows may go without (with free variables)", eq.name))
                        .report(self);
                    failed = true;
                }
                continue;
            };
            failed |= self.check_domains(symbol, v, r.span).is_err();
            if let Some(other) = rows
                .iter()
                .find(|o| o.definition == r.definition && o.pair.is_some() && o.pair != r.pair)
                && r.span.lo > other.span.lo
            {
                Diagnostic::error("E0367", r.span)
                    .says(format!("the equation `{}` is paired twice", eq.name))
                    .label("second pair")
                    .other(other.span, "first pair")
                    .help("an equation has one partner: take one of the pairs out")
                    .report(self);
                failed = true;
            }
        }
        if failed { Err(Failed) } else { Ok(()) }
    }

    /// An equation and its partner run over the same indices.
    fn check_domains(&mut self, e: SymbolId, v: SymbolId, at: Span) -> Checked<()> {
        let (eq, var) = (self.symbols.get(e), self.symbols.get(v));
        let (e, n, v, m) = (&eq.name, eq.dim(), &var.name, var.dim());
        let pairs = |(a, b): (&DomainPosition, &DomainPosition)| match (a, b) {
            (DomainPosition::Set(a), DomainPosition::Set(b)) => {
                self.symbols.is_subset(*a, *b) || self.symbols.is_subset(*b, *a)
            }
            _ => true,
        };
        let d = if n != m {
            Diagnostic::error("E0365", at)
                .says(format!(
                    "`{e}` has {n} indices and `{v}` has {m}: they cannot be paired"
                ))
                .label("different dimensions")
        } else if !eq.domain.iter().zip(&var.domain).all(pairs) {
            Diagnostic::error("E0366", at)
                .says(format!(
                    "`{e}` and `{v}` run over different sets, or the same in another order"
                ))
                .label("domains differ")
        } else {
            return Ok(());
        };
        d.other(eq.declared, "the equation")
            .other(var.declared, "the variable")
            .fail(self)
    }
}
