//! `bmod list` solves nothing. What depends on a solve that was left out is followed, so that nobody takes what is listed behind
//! it for what a run generates, and no loop waits for an answer.

use super::{Generated, Machine};
use crate::check::node::{Code, CodeKind, Node, NodeKind, SymbolId, TableId, Target};
use crate::check::symbols::{Symbols, attribute};
use crate::check::visit::{Reading, Visitor};
use crate::diag::Diagnostic;
use crate::model::language::LANGUAGE;
use crate::source::Span;
use rustc_hash::FxHashSet;

/// What a run would have from its solves.
#[derive(Default)]
pub(super) struct Unsolved {
    models: FxHashSet<SymbolId>,
    /// Levels and marginals, and what was computed from them.
    tables: FxHashSet<TableId>,
    /// A run may leave the loop here.
    undecided: bool,
}

/// Looks for something that depends on a solve.
struct Reads<'a>(&'a Unsolved, &'a Symbols, bool);

impl Visitor<'_> for Reads<'_> {
    fn node(&mut self, n: &Node) {
        self.2 |= match &n.kind {
            NodeKind::ObjectAttribute(m, a) => {
                self.0.models.contains(m) && LANGUAGE.rows.iter().all(|row| row.name != *a)
            }
            NodeKind::Derived(_, s, _) => self.0.tables.contains(&self.1.get(*s).table),
            _ => false,
        };
        n.walk(self);
    }

    fn table(&mut self, t: TableId, _: Reading) {
        self.2 |= self.0.tables.contains(&t);
    }
}

impl Machine<'_> {
    fn depends(&self, visit: impl FnOnce(&mut Reads)) -> bool {
        let mut reads = Reads(&self.unsolved, &self.symbols, false);
        if !self.unsolved.models.is_empty() {
            visit(&mut reads);
        }
        reads.2
    }

    fn warn_unsolved(&self, span: Span) {
        Diagnostic::warning("E0434", span)
            .says("this depends on what a solve gives, and `bmod list` solves nothing")
            .label("a run may go on otherwise here")
            .help("`bmod run` solves; what is listed behind this place may be something else there")
            .note(self);
    }

    /// Before a statement: whether its way or its data depend on a solve.
    pub(super) fn follow_unsolved(&mut self, c: &Code) {
        let conditions: Vec<&Node> = match &c.kind {
            CodeKind::Assign(a) => {
                let depends = self.depends(|r| {
                    r.domain(&a.domain);
                    a.key.walk(r);
                    r.node(&a.value);
                });
                let tables = &mut self.unsolved.tables;
                match a.target {
                    Target::Table(t) | Target::Set(t) | Target::Singleton(t) if depends => {
                        tables.insert(t);
                    }
                    Target::Fix(s) if depends => {
                        let t = self.symbols.get(s).table;
                        tables.extend([attribute::L, attribute::LO, attribute::UP].map(|o| t + o));
                    }
                    _ => {}
                }
                return;
            }
            CodeKind::If(arms, _) => arms.iter().map(|(condition, _)| condition).collect(),
            CodeKind::For(f) => vec![&f.from, &f.to],
            CodeKind::Loop(d, anew, _) => {
                if self.depends(|r| r.domain(d)) {
                    self.warn_unsolved(c.span);
                }
                anew.iter().collect()
            }
            _ => return,
        };
        for condition in conditions {
            self.unsolved.undecided |= self.waits(condition);
        }
    }

    /// Whether a condition depends on a solve; it is said.
    pub(super) fn waits(&self, condition: &Node) -> bool {
        let waits = self.depends(|r| r.guard(condition));
        if waits {
            self.warn_unsolved(condition.span);
        }
        waits
    }

    /// Whether in this turn of a loop something was met that a run decides by a solve.
    pub(super) fn take_undecided(&mut self) -> bool {
        std::mem::take(&mut self.unsolved.undecided)
    }

    /// Back in the loop around.
    pub(super) fn leave_undecided(&mut self, outer: bool) {
        self.unsolved.undecided |= outer;
    }

    /// A solve is left out.
    pub(super) fn leave_unsolved(&mut self, model: SymbolId, g: &Generated, span: Span) {
        let blocks = |list: &crate::model::origin::Blocks| -> Vec<SymbolId> {
            list.list.iter().map(|b| b.symbol).collect()
        };
        let (columns, rows) = (blocks(&g.origin.columns), blocks(&g.origin.rows));
        let first = |s: &SymbolId| self.symbols.get(*s).table;
        let bounds = columns
            .iter()
            .flat_map(|s| [first(s) + attribute::LO, first(s) + attribute::UP]);
        let bounded = bounds
            .into_iter()
            .any(|t| self.unsolved.tables.contains(&t));
        let depends = self.depends(|r| {
            for e in self.equations.iter().filter(|e| rows.contains(&e.symbol)) {
                r.domain(&e.domain);
                r.node(&e.left);
                r.node(&e.right);
            }
        });
        if depends || bounded {
            self.warn_unsolved(span);
        }
        let answers: Vec<TableId> = columns.iter().chain(&rows).map(first).collect();
        let answers = answers
            .into_iter()
            .flat_map(|t| [t + attribute::L, t + attribute::M]);
        self.unsolved.tables.extend(answers);
        self.unsolved.models.insert(model);
    }
}
