//! Names of indices: as the user wrote them, other aliases of the same set where one is taken, new ones where none is left.

use super::tree::{IndexId, Indices};
use crate::check::node::SymbolId;
use crate::check::symbols::{SymbolKind, Symbols, UNIVERSE};
use rustc_hash::FxHashSet;

/// Gives names to indices, scope by scope.
pub struct Names<'a> {
    symbols: &'a Symbols,
    indices: &'a Indices,
    scope: Vec<(IndexId, String)>,
    taken: FxHashSet<String>,
    /// New aliases: the set and the name.
    pub aliases: Vec<(SymbolId, String)>,
    /// Sets and aliases of the user that are used as names.
    pub used: Vec<SymbolId>,
}

impl<'a> Names<'a> {
    /// `taken`: names in lower case that no alias may have.
    pub fn new(symbols: &'a Symbols, indices: &'a Indices, taken: FxHashSet<String>) -> Self {
        Self {
            symbols,
            indices,
            scope: Vec::new(),
            taken,
            aliases: Vec::new(),
            used: Vec::new(),
        }
    }

    /// Puts indices into the scope; returns how many there were.
    pub fn enter(&mut self, indices: &[IndexId]) -> usize {
        let before = self.scope.len();
        for &k in indices {
            let name = self.choose(k);
            self.scope.push((k, name));
        }
        before
    }

    /// Leaves a scope.
    pub fn leave(&mut self, before: usize) {
        self.scope.truncate(before);
    }

    /// The name of an index.
    pub fn of(&self, k: IndexId) -> &str {
        let found = self.scope.iter().rev().find(|(i, _)| *i == k);
        found.map_or("?", |(_, n)| n)
    }

    /// The set that an index runs over.
    pub fn set(&self, k: IndexId) -> SymbolId {
        self.indices.set[k]
    }

    fn choose(&mut self, k: IndexId) -> String {
        let set = self.indices.set[k];
        let root = self.symbols.root(set);
        let free = |name: &str| !self.scope.iter().any(|(_, n)| n.eq_ignore_ascii_case(name));
        let mut own: Vec<SymbolId> = Vec::new();
        if set != UNIVERSE {
            own.push(set);
            if self.symbols.get(root).dim() == 1 {
                own.push(root);
            }
        }
        let aliases = self
            .symbols
            .iter()
            .filter(|(_, s)| matches!(s.kind, SymbolKind::Alias(r) if r == root));
        own.extend(aliases.map(|(i, _)| i));
        if let Some(&s) = own.iter().find(|&&s| free(&self.symbols.get(s).name)) {
            if !self.used.contains(&s) {
                self.used.push(s);
            }
            return self.symbols.get(s).name.to_string();
        }
        let made = self.aliases.iter().find(|(s, n)| *s == root && free(n));
        if let Some((_, n)) = made {
            return n.clone();
        }
        let base = match root {
            UNIVERSE => "any".to_string(),
            _ => self.symbols.get(set).name.to_string(),
        };
        let mut n = 2;
        let mut name = format!("{base}{n}");
        while !self.taken.insert(name.to_lowercase()) {
            n += 1;
            name = format!("{base}{n}");
        }
        self.aliases.push((root, name.clone()));
        name
    }
}
