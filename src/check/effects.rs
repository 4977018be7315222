//! What statements change, and whether an expression reads it: a loop's condition on what its body changes
//! is asked anew at every turn.

use super::node::*;
use super::symbols::{Symbols, attribute};
use super::visit::{Reading, Visitor};
use rustc_hash::FxHashSet;

/// What a piece of code changes.
#[derive(Default, Debug)]
pub(super) struct Effects {
    tables: FxHashSet<TableId>,
    /// Solves, loads: levels, marginals and attributes of models may change, and any data.
    everything: bool,
    /// Attributes of models and files.
    objects: bool,
}

impl Effects {
    /// The effects of statements.
    pub(super) fn of(code: &[Code], symbols: &Symbols) -> Self {
        let mut e = Self::default();
        code.iter().for_each(|c| {
            Changes {
                effects: &mut e,
                symbols,
            }
            .code(c)
        });
        e
    }

    /// Whether the value of an expression may change with them.
    pub(super) fn touch(&self, n: &Node) -> bool {
        let mut reads = Reads {
            effects: self,
            touched: false,
        };
        reads.node(n);
        reads.touched
    }
}

/// Collects what statements change.
struct Changes<'e> {
    effects: &'e mut Effects,
    symbols: &'e Symbols,
}

impl Visitor<'_> for Changes<'_> {
    fn node(&mut self, _: &Node) {}

    fn code(&mut self, c: &Code) {
        let first = |s: SymbolId| self.symbols.get(s).table;
        let e = &mut *self.effects;
        match &c.kind {
            CodeKind::Assign(a) => match a.target {
                Target::Table(t) | Target::Set(t) | Target::Singleton(t) => {
                    e.tables.insert(t);
                }
                Target::Fix(s) => {
                    let t = first(s);
                    e.tables
                        .extend([attribute::L, attribute::LO, attribute::UP].map(|o| t + o));
                }
                Target::Object(..) => e.objects = true,
                Target::Seed | Target::Errors | Target::MostErrors | Target::Ignored => {}
            },
            CodeKind::For(f) => {
                e.tables.insert(f.variable);
            }
            CodeKind::Clear(s, _) => {
                let t = first(*s);
                e.tables.extend(t..t + attribute::COUNT);
            }
            CodeKind::Match(target, _)
            | CodeKind::Permute(target, _)
            | CodeKind::Shuffle(target, _)
            | CodeKind::Project { target, .. } => {
                e.tables.insert(first(*target));
            }
            CodeKind::Solve(_) | CodeKind::Exchange(_) => e.everything = true,
            CodeKind::Loop(..)
            | CodeKind::While(..)
            | CodeKind::Repeat(..)
            | CodeKind::If(..)
            | CodeKind::Break(..)
            | CodeKind::Continue
            | CodeKind::Display(..)
            | CodeKind::Abort(..)
            | CodeKind::Option(..)
            | CodeKind::Format(..)
            | CodeKind::Put(..)
            | CodeKind::Draw(..) => {}
        }
        c.walk(self);
    }
}

/// Looks for something that was changed.
struct Reads<'e> {
    effects: &'e Effects,
    touched: bool,
}

impl Visitor<'_> for Reads<'_> {
    fn node(&mut self, n: &Node) {
        let e = self.effects;
        self.touched |= match &n.kind {
            NodeKind::Var(..) => e.everything,
            NodeKind::Derived(..) => e.everything || !e.tables.is_empty(),
            NodeKind::ObjectAttribute(..) => e.everything || e.objects,
            // Random numbers, the clock, the number of errors.
            NodeKind::DataCall(..) => true,
            _ => false,
        };
        n.walk(self);
    }

    fn table(&mut self, t: TableId, _: Reading) {
        self.touched |= self.effects.everything || self.effects.tables.contains(&t);
    }
}
