//! Data given from outside the text ([`Input`]): a symbol takes them where it is declared, and what data
//! statements say about it is passed over.

use super::node::SymbolId;
use super::symbols::{DomainPosition, SymbolKind, UNIVERSE};
use super::{Compiler, Failed};
use crate::data::input::{Input, InputData};
use crate::data::table::Table;
use crate::data::universe::Label;
use crate::diag::{Diagnostic, nearest};
use crate::source::Span;
use rustc_hash::{FxHashMap, FxHashSet};

/// Data from outside while the text is read.
#[derive(Debug, Default)]
pub(super) struct Inputs {
    /// What no declaration has taken yet, in the order given.
    waiting: Vec<Input>,
    /// Symbols that took theirs.
    taken: FxHashSet<SymbolId>,
}

impl Inputs {
    pub(super) fn new(waiting: Vec<Input>) -> Self {
        Self {
            waiting,
            taken: FxHashSet::default(),
        }
    }

    /// Whether a symbol has data from outside.
    pub(super) fn has(&self, s: SymbolId) -> bool {
        self.taken.contains(&s)
    }
}

impl Compiler {
    /// Gives a symbol that was just declared its data from outside. True if it has some: the text's own are
    /// passed over then.
    pub(super) fn take_input(&mut self, s: SymbolId, defines: &[bool], span: Span) -> bool {
        if self.inputs.has(s) {
            return true;
        }
        let name = &self.symbols.get(s).name;
        let named = |i: &Input| i.name.eq_ignore_ascii_case(name);
        let Some(at) = self.inputs.waiting.iter().position(named) else {
            return false;
        };
        let mut input = self.inputs.waiting.remove(at);
        // What was given last counts.
        while let Some(at) = self.inputs.waiting.iter().position(named) {
            input = self.inputs.waiting.remove(at);
        }
        self.inputs.taken.insert(s);
        let symbol = self.symbols.get_mut(s);
        symbol.has_data = true;
        let open = std::mem::take(&mut symbol.open);
        if let (true, Some(key)) = (open, input.data.first()) {
            self.set_dimension(s, key.len());
        }
        let _ = self.fill_from_input(s, &input, defines, span);
        true
    }

    fn fill_from_input(
        &mut self,
        s: SymbolId,
        input: &Input,
        defines: &[bool],
        span: Span,
    ) -> Result<(), Failed> {
        let symbol = self.symbols.get(s).clone();
        let wrong_kind = match (&symbol.kind, &input.data) {
            (SymbolKind::Set { .. }, InputData::Values(_)) => Some("numbers"),
            (SymbolKind::Parameter { .. }, InputData::Members(_)) => Some("members"),
            _ => None,
        };
        if let Some(what) = wrong_kind {
            let (kind, name) = (symbol.kind_name(), &symbol.name);
            return self.fail(
                Diagnostic::error(
                    "E0376",
                    span,
                    format!("`{name}` is a {kind}; {what} were given for it"),
                )
                .label("declared here")
                .help("give members to sets, and numbers to parameters"),
            );
        }
        let dim = symbol.dim();
        let mut keys: Vec<Label> = Vec::new();
        for (n, key) in input.data.keys().enumerate() {
            if key.len() != dim {
                return self.fail(
                    Diagnostic::error(
                        "E0377",
                        span,
                        format!(
                            "`{}` has {dim} index position{}; {} given for it has {}",
                            symbol.name,
                            if dim == 1 { "" } else { "s" },
                            record(&symbol.name, key, n),
                            key.len()
                        ),
                    )
                    .label("declared here"),
                );
            }
            for (p, text) in key.iter().enumerate() {
                let label = self.store.universe.intern(text);
                if let Some(DomainPosition::Set(d)) = symbol.domain.get(p) {
                    let d = self.symbols.root(*d);
                    self.check_member(&symbol.name, key, p, d, label, defines, span)?;
                }
                keys.push(label);
            }
        }
        let values = match &input.data {
            InputData::Members(list) => vec![1.0; list.len()],
            InputData::Values(list) => list.iter().map(|r| r.1).collect(),
        };
        if let SymbolKind::Set { singleton: true } = symbol.kind
            && values.len() > 1
        {
            return self.fail(
                Diagnostic::error(
                    "E0377",
                    span,
                    format!(
                        "`{}` is a singleton; {} members were given",
                        symbol.name,
                        values.len()
                    ),
                )
                .label("declared here"),
            );
        }
        let table = self.store.table_mut(symbol.table);
        *table = Table::new(dim, table.default_value());
        if dim == 0 {
            table.set(&[], values.last().copied().unwrap_or(0.0));
            return Ok(());
        }
        for (key, &v) in keys.chunks_exact(dim).zip(&values) {
            table.set(key, v);
        }
        table.tidy();
        if let InputData::Members(list) = &input.data {
            let labels = keys.chunks_exact(dim);
            let texts = labels.zip(list).filter(|(_, r)| !r.1.is_empty());
            let texts: FxHashMap<_, _> = texts
                .map(|(k, r)| (k.into(), r.1.as_str().into()))
                .collect();
            self.store.texts.insert(symbol.table, texts);
            let ordered = dim > 1 || keys.is_sorted();
            self.symbols.get_mut(s).unordered = !ordered;
        }
        self.store.refresh_universe();
        Ok(())
    }

    /// Checks a label against the set of its position, or adds it to a set that the data define (`p(i<)`).
    #[allow(clippy::too_many_arguments)]
    fn check_member(
        &mut self,
        name: &str,
        key: &[String],
        position: usize,
        set: SymbolId,
        label: Label,
        defines: &[bool],
        span: Span,
    ) -> Result<(), Failed> {
        if set == UNIVERSE {
            return Ok(());
        }
        let domain = self.symbols.get(set);
        let table = &mut self.store.tables[domain.table as usize];
        if table.find(&[label]).is_some() {
            return Ok(());
        }
        if defines.get(position) == Some(&true) && !self.inputs.has(set) {
            table.set(&[label], 1.0);
            table.tidy();
            self.symbols.get_mut(set).has_data = true;
            return Ok(());
        }
        let members = table.all_keys().iter().take(10_000);
        let members = members.map(|&l| self.store.universe.name(l));
        let near = nearest(&key[position], members).map(str::to_string);
        let (set_name, declared) = (domain.name.clone(), domain.declared);
        let d = Diagnostic::error(
            "E0377",
            span,
            format!(
                "{} was given from outside, but `{}` is not a member of `{set_name}`",
                record(name, key, 0),
                key[position]
            ),
        )
        .label("declared here")
        .other(declared, format!("`{set_name}` is declared here"));
        self.fail(match near {
            Some(near) => d.help(format!("did you mean `{near}`?")),
            None => d.help(format!(
                "give `{set_name}` this member too, or leave the record out"
            )),
        })
    }

    /// An error for each piece of data that no symbol has taken.
    pub(super) fn unused_inputs(&mut self) {
        for input in std::mem::take(&mut self.inputs.waiting) {
            let name = &input.name;
            let d = match self.symbols.find(name) {
                Some(s) => {
                    let symbol = self.symbols.get(s);
                    let kind = symbol.kind_name();
                    let message = format!("data were given for `{name}`, which is a {kind}");
                    Diagnostic::error("E0376", symbol.declared, message)
                        .label("declared here")
                        .help("data from outside are for sets and parameters")
                }
                None => {
                    let message =
                        format!("data were given for `{name}`, which the model does not declare");
                    let d = Diagnostic::error("E0376", Span::default(), message);
                    let takes = |k: &SymbolKind| {
                        matches!(k, SymbolKind::Set { .. } | SymbolKind::Parameter { .. })
                    };
                    let known = self.symbols.iter().skip(1).filter(|(_, s)| takes(&s.kind));
                    match nearest(name, known.map(|(_, s)| &*s.name)) {
                        Some(near) => d.help(format!("did you mean `{near}`?")),
                        None => d.help(format!("declare it: `parameter {name};`")),
                    }
                }
            };
            self.report(d);
        }
    }
}

/// `d('a','b')` as a message names it.
fn record(name: &str, key: &[String], number: usize) -> String {
    if key.is_empty() {
        return format!("record {}", number + 1);
    }
    let labels: Vec<String> = key.iter().map(|l| format!("'{l}'")).collect();
    format!("`{name}({})`", labels.join(","))
}
