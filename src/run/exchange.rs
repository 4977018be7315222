//! Data exchange in the run: `execute_unload`, `execute_load` and `execute_loadpoint`, with open formats
//! (`$load` and `$unload` act while the text is read: [`crate::check::exchange`]).

use super::Machine;
use crate::check::exchange::{Request, Wanted, file_to_load, load, no_file, unload, wanted};
use crate::check::node::SymbolId;
use crate::model::origin::Origin;
use crate::source::Span;
use crate::syntax::ast::Exchange;

/// Files that `put_utility` named for the next unload and load without a name.
#[derive(Clone, Debug, Default)]
pub struct ExchangeState {
    pub(super) unload_to: Option<String>,
    pub(super) load_from: Option<String>,
}

impl Machine<'_> {
    /// A statement.
    pub(super) fn exchange(&mut self, x: &Exchange, span: Span) {
        let items = match wanted(&self.symbols, &x.items) {
            Ok(items) => items,
            Err(d) => return self.note(*d),
        };
        let unloads = x.keyword.name.contains("unload");
        let (named, example) = match unloads {
            true => (&self.transfer.unload_to, "execute_unload 'results.json';"),
            false => (&self.transfer.load_from, "execute_load 'data.csv', p;"),
        };
        let named = named.clone().map(|f| (f.into(), span));
        let Some((file, at)) = x.file.as_ref().or(named.as_ref()) else {
            return self.note(*no_file(span, example));
        };
        if unloads {
            return self.unload(file, &items, *at);
        }
        self.load(&Request {
            file: &file_to_load(&self.map, file),
            at: *at,
            items: &items,
            point: x.keyword.name.contains("point"),
            span,
        });
    }

    fn load(&mut self, request: &Request<'_>) {
        let mut symbols = std::mem::take(&mut self.symbols);
        let mut store = std::mem::take(&mut self.store);
        let mut read = |name: &str, at| self.read_file(name, at);
        let done = load(&mut symbols, &mut store, request, &mut read);
        (self.symbols, self.store) = (symbols, store);
        if let Err(d) = done {
            self.note(*d);
        }
    }

    /// `savepoint`: levels and marginals of a model are written after its solve, for `execute_loadpoint`.
    pub(super) fn save_point(
        &mut self,
        model: SymbolId,
        savepoint: f64,
        origin: &Origin,
        span: Span,
    ) {
        let mut name = format!("{}_p", self.symbols.get(model).name);
        match savepoint {
            1.0 => {}
            2.0 => name.push_str(&(self.report.solves.len() + 1).to_string()),
            _ => return,
        }
        let blocks = origin.columns.list.iter().chain(&origin.rows.list);
        let items: Vec<Wanted> = blocks
            .map(|b| Wanted {
                symbol: b.symbol,
                name: self.symbols.get(b.symbol).name.to_string(),
                span,
            })
            .collect();
        self.unload(&format!("{name}.gdx"), &items, span);
    }

    fn unload(&mut self, file: &str, items: &[Wanted], span: Span) {
        let (files, warning) = match unload(&self.symbols, &mut self.store, file, items, span) {
            Ok(done) => done,
            Err(d) => return self.note(*d),
        };
        warning.into_iter().for_each(|d| self.note(d));
        for (name, text) in files {
            let written = self.write_file(&name, text.as_bytes(), span);
            // It may be loaded again.
            self.map.remember(&name, text);
            if !written {
                return;
            }
        }
    }
}
