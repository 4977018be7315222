//! What statements change, and whether an expression reads it: a loop's condition on what its body changes
//! is asked anew at every turn.

use super::node::*;
use super::symbols::{Symbols, attribute};
use rustc_hash::FxHashSet;

/// What a piece of code changes.
#[derive(Default, Debug)]
pub struct Effects {
    tables: FxHashSet<TableId>,
    /// Solves, loads: levels, marginals and attributes of models may change, and any data.
    everything: bool,
    /// Attributes of models and files.
    objects: bool,
}

impl Effects {
    /// The effects of statements.
    pub fn of(code: &[Code], symbols: &Symbols) -> Self {
        let mut e = Self::default();
        e.add(code, symbols);
        e
    }

    fn add(&mut self, code: &[Code], symbols: &Symbols) {
        let first = |s: SymbolId| symbols.get(s).table;
        for c in code {
            match &c.kind {
                CodeKind::Assign { target, .. } => match *target {
                    Target::Table(t) | Target::Set(t) | Target::Singleton(t) => {
                        self.tables.insert(t);
                    }
                    Target::Fix(s) => {
                        let t = first(s);
                        self.tables
                            .extend([attribute::L, attribute::LO, attribute::UP].map(|o| t + o));
                    }
                    Target::Object(..) => self.objects = true,
                    Target::Seed | Target::Errors | Target::MostErrors | Target::Ignored => {}
                },
                CodeKind::Loop(_, b) | CodeKind::While(_, b) | CodeKind::Repeat(b, _) => {
                    self.add(b, symbols);
                }
                CodeKind::For { table, body, .. } => {
                    self.tables.insert(*table);
                    self.add(body, symbols);
                }
                CodeKind::If(arms, otherwise) => {
                    arms.iter().for_each(|(_, b)| self.add(b, symbols));
                    self.add(otherwise, symbols);
                }
                CodeKind::Clear(s, _) => {
                    let t = first(*s);
                    self.tables.extend(t..t + attribute::COUNT);
                }
                CodeKind::Match(target, _) | CodeKind::Project { target, .. } => {
                    self.tables.insert(first(*target));
                }
                CodeKind::Solve(_) | CodeKind::Exchange(_) => self.everything = true,
                _ => {}
            }
        }
    }

    /// Whether the value of an expression may change with them.
    pub fn touch(&self, n: &Node) -> bool {
        match &n.kind {
            NodeKind::Data(t, k) | NodeKind::ElementText(t, k) => self.table(*t) || self.key(k),
            NodeKind::Var(..) => self.everything,
            NodeKind::Derived(_, _, k) => self.everything || !self.tables.is_empty() || self.key(k),
            NodeKind::Ord(t, p) | NodeKind::LabelAttribute(_, t, p) => {
                self.table(*t) || self.part(p)
            }
            NodeKind::Card(t) => self.table(*t),
            NodeKind::SameAs(a, b) => self.part(a) || self.part(b),
            NodeKind::LabelText(p) => self.part(p),
            NodeKind::Negate(a) | NodeKind::Not(a) => self.touch(a),
            NodeKind::Sum(t) | NodeKind::Product(t) => t.iter().any(|(_, x)| self.touch(x)),
            NodeKind::Binary(_, a, b) | NodeKind::Dollar(a, b) => self.touch(a) || self.touch(b),
            NodeKind::Call(_, a) => a.iter().any(|x| self.touch(x)),
            // Random numbers, the clock, the number of errors.
            NodeKind::DataCall(..) => true,
            NodeKind::Aggregate(_, d, b) => {
                self.touch(b)
                    || d.conditions.iter().any(|x| self.touch(x))
                    || d.members
                        .iter()
                        .any(|m| self.table(m.table) || self.key(&m.key))
            }
            NodeKind::ObjectAttribute(..) => self.everything || self.objects,
            NodeKind::Const(_) | NodeKind::Text(_) | NodeKind::SymbolText(_) => false,
            NodeKind::RecordName(_, k) => self.key(k),
            NodeKind::OfText(t, n) => self.touch(t) || n.as_ref().is_some_and(|n| self.touch(n)),
        }
    }

    fn table(&self, t: TableId) -> bool {
        self.everything || self.tables.contains(&t)
    }

    fn key(&self, k: &Key) -> bool {
        k.parts.iter().any(|p| self.part(p))
    }

    fn part(&self, p: &Part) -> bool {
        match p {
            Part::Slot(_) | Part::Label(_) => false,
            Part::Lag(l) => self.table(l.set) || self.part(&l.base) || self.touch(&l.offset),
            Part::Singleton(t, _) => self.table(*t),
        }
    }
}
