//! Data exchange in the run: `execute_unload`, `execute_load` and `execute_loadpoint`
//! (`$load` and `$unload` act while the text is read: [`crate::check::exchange`]).

use super::Machine;
use crate::check::exchange::{Part, Request, Wanted, load, no_file, unload, wanted};
use crate::check::node::SymbolId;
use crate::diag::Diagnostic;
use crate::model::origin::Origin;
use crate::source::{Outcome, Span};
use crate::syntax::ast::Exchange;

/// Files that `put_utility` named for the next unload and load without a name.
#[derive(Clone, Debug, Default)]
pub(super) struct ExchangeState {
    pub(super) unload_to: Option<String>,
    pub(super) load_from: Option<String>,
}

impl Machine<'_> {
    /// A statement.
    pub(super) fn exchange(&mut self, x: &Exchange, span: Span) {
        if x.keyword.name.eq_ignore_ascii_case("execute_loadhandle") {
            let models = x
                .items
                .iter()
                .filter_map(|i| self.symbols.find(&i.name.name));
            return models
                .collect::<Vec<_>>()
                .into_iter()
                .for_each(|m| self.load_handle(m));
        }
        let items = match wanted(&self.symbols, &x.items) {
            Ok(items) => items,
            Err(d) => return d.note(self),
        };
        let unloads = x.keyword.name.contains("unload");
        let (named, example) = match unloads {
            true => (&self.transfer.unload_to, "execute_unload 'results.gdx';"),
            false => (&self.transfer.load_from, "execute_load 'data.gdx', p;"),
        };
        let named = named.clone().map(|f| (f.into(), span));
        let Some((file, at)) = x.file.as_ref().or(named.as_ref()) else {
            return no_file(span, example).note(self);
        };
        if unloads {
            return self.unload(file, &items, *at);
        }
        self.load(&Request {
            file,
            at: *at,
            items: &items,
            point: x.keyword.name.contains("point"),
            strict: x.keyword.name.ends_with("dc"),
            merge: false,
            reading: false,
            span,
        });
    }

    fn load(&mut self, request: &Request<'_>) {
        match self.take_in(request) {
            Ok(warnings) => warnings.into_iter().for_each(|d| d.note(self)),
            Err(d) => {
                // As in GAMS what fits is there behind the error.
                if request.strict && d.code == "E0479" {
                    let strict = false;
                    let _ = self.take_in(&Request { strict, ..*request });
                }
                d.note(self);
            }
        }
    }

    fn take_in(&mut self, request: &Request<'_>) -> Outcome<Vec<Diagnostic>> {
        let mut symbols = std::mem::take(&mut self.symbols);
        let mut store = std::mem::take(&mut self.store);
        let mut read = |name: &str, at| self.read_bytes(name, at);
        let done = load(&mut symbols, &mut store, request, &mut read);
        (self.symbols, self.store) = (symbols, store);
        done
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
            2.0 => name.push_str(&(self.report().solves.len() + 1).to_string()),
            _ => return,
        }
        let blocks = origin.columns.list.iter().chain(&origin.rows.list);
        let items: Vec<Wanted> = blocks
            .map(|b| Wanted {
                symbol: b.symbol,
                name: self.symbols.get(b.symbol).name.to_string(),
                span,
                part: Part::Whole,
                into: None,
            })
            .collect();
        self.unload(&format!("{name}.gdx"), &items, span);
    }

    fn unload(&mut self, file: &str, items: &[Wanted], span: Span) {
        let equations = std::sync::Arc::clone(&self.equations);
        let done = unload(
            &self.symbols,
            &mut self.store,
            &equations,
            file,
            items,
            span,
        );
        let files = match done {
            Ok(files) => files,
            Err(d) => return d.note(self),
        };
        for (name, bytes) in files {
            let written = self.write_file(&name, &bytes, span);
            // It may be loaded again.
            self.map.remember(&name, bytes, span);
            if !written {
                return;
            }
        }
    }
}
