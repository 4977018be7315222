//! The proof that a derivation is right: the derived model is generated, and its matrix compared entry by entry with that
//! of the primal.

mod slopes;
mod transposed;

use super::derive::Primal;
use super::tree::Variable;
use super::{Formulation, Scope, dual, kkt, text};
use crate::check::node::SymbolId;
use crate::data::universe::{Label, Universe};
use crate::diag::Severity;
use crate::host::{Found, Host, HostError};
use crate::model::origin::{Block, Blocks};
use crate::run::{Generated, Machine, Options, StudyChoice};
use crate::session;
use crate::source::PreprocessOptions;
use rustc_hash::FxHashMap;
use std::path::{Path, PathBuf};

/// How far two numbers may be apart, relative to the larger.
pub const TOLERANCE: f64 = 1e-10;

/// What a comparison found.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    /// Entries that were compared.
    pub entries: usize,
    /// Right sides, costs and bounds that were compared.
    pub numbers: usize,
    /// What differs, in words; the first few.
    pub differences: Vec<String>,
    /// How much differs.
    pub count: usize,
    /// The largest relative difference.
    pub largest: f64,
    /// Why nothing could be compared.
    pub impossible: Option<String>,
}

impl Comparison {
    /// Whether all is equal.
    pub fn passed(&self) -> bool {
        self.count == 0 && self.impossible.is_none()
    }

    /// There is nothing to compare, and why.
    pub fn impossible(why: &str) -> Self {
        Self {
            impossible: Some(why.to_string()),
            ..Self::default()
        }
    }

    /// Notes a difference.
    pub fn differ(&mut self, what: String) {
        self.count += 1;
        if self.differences.len() < 5 {
            self.differences.push(what);
        }
    }

    /// Compares two numbers.
    pub fn number(&mut self, a: f64, b: f64, what: &dyn Fn() -> String) {
        self.numbers += 1;
        if a == b {
            return;
        }
        let off = (a - b).abs() / a.abs().max(b.abs()).max(1.0);
        self.largest = self.largest.max(off);
        if off > TOLERANCE || off.is_nan() {
            self.differ(format!("{}: {a} and {b}", what()));
        }
    }
}

/// A text that is the only file there is.
struct Text<'a> {
    text: &'a str,
}

impl Host for Text<'_> {
    fn read(&mut self, path: &str, _: Option<&Path>) -> Found<String> {
        match path {
            "derived.blk" => Ok((path.into(), self.text.to_string())),
            _ => Err(HostError::NotFound),
        }
    }
    fn exists(&mut self, _: &str, _: Option<&Path>) -> bool {
        false
    }
    fn write(&mut self, path: &str, _: &[u8]) -> Result<PathBuf, HostError> {
        Err(HostError::Outside(path.into()))
    }
}

/// The instance of a derived model, by the names of its symbols and the labels of the model it comes from.
struct Instance {
    generated: Generated,
    /// Symbols with rows or columns, by name in lower case.
    symbols: FxHashMap<String, SymbolId>,
    /// By label of the model it comes from: the same label here.
    labels: Vec<Option<Label>>,
}

impl Instance {
    fn new(m: &Machine, generated: Generated, universe: &Universe) -> Self {
        let o = &generated.origin;
        let blocks = o.rows.list.iter().chain(&o.columns.list);
        let symbols = blocks.map(|b| (m.symbols.get(b.symbol).name.to_lowercase(), b.symbol));
        let labels = 0..universe.len() as Label;
        let labels = labels.map(|l| m.store.universe.get(universe.name(l)));
        Self {
            symbols: symbols.collect(),
            labels: labels.collect(),
            generated,
        }
    }

    /// The rows or columns of a name.
    fn block<'a>(&self, blocks: &'a Blocks, name: &str) -> Option<&'a Block> {
        blocks.symbol(*self.symbols.get(&name.to_lowercase())?)
    }

    /// The rows of a name.
    fn rows(&self, name: &str) -> Option<&Block> {
        self.block(&self.generated.origin.rows, name)
    }

    /// The columns of a name.
    fn columns(&self, name: &str) -> Option<&Block> {
        self.block(&self.generated.origin.columns, name)
    }

    /// The row or column of a block with a key of the model that this comes from.
    fn find(&self, block: &Block, key: &[Label]) -> Option<usize> {
        let own: Option<Vec<Label>> = key.iter().map(|l| self.labels[*l as usize]).collect();
        block.find(&own?).map(|i| i as usize)
    }

    /// The name of the block of a row or column.
    fn name(&self, blocks: &Blocks, i: usize) -> &str {
        let symbol = blocks.of(i as u32).symbol;
        let name = self.symbols.iter().find(|s| *s.1 == symbol);
        name.map_or("", |s| s.0)
    }
}

/// Generates a derived model: its text is read, its data are handed over; the first complaint where it cannot be.
fn generated(scope: Scope, f: &Formulation) -> Result<Instance, String> {
    let mut inputs = Vec::new();
    let text = text::model(scope, f, None, "", true, Some(&mut inputs));
    let mut host = Text { text: &text };
    let options = Options {
        quiet: true,
        collect: false,
        study: Some(StudyChoice {
            generate_only: true,
            ..StudyChoice::default()
        }),
        ..Options::default()
    };
    let preprocess = PreprocessOptions {
        slash_comments: true,
        inputs,
        ..PreprocessOptions::default()
    };
    let mut found = None;
    let finished = session::run(
        &mut host,
        "derived.blk",
        preprocess,
        options,
        false,
        &mut |m| {
            if let Some((_, Some(g))) = m.take_study() {
                found = Some(Instance::new(m, g, &scope.store.universe));
            }
        },
    );
    found.ok_or_else(|| {
        let first = finished
            .diagnostics
            .iter()
            .find(|d| d.severity != Severity::Warning);
        let place = |d: &crate::diag::Diagnostic| {
            let line = finished.map.line(d.span);
            let text = text.lines().nth(line.saturating_sub(1)).unwrap_or_default();
            format!("{} (line {line}: {})", d.message, text.trim())
        };
        first.map_or_else(|| "nothing is solved".to_string(), place)
    })
}

/// The row that defined the objective, where the derivation eliminated it.
fn eliminated(primal: &Primal, f: &Formulation, z: Option<usize>) -> Option<usize> {
    let z = z?;
    let symbol = primal.generated.origin.columns.of(z as u32).symbol;
    let stays = f.rows.iter().any(|r| r.pair == Some(Variable::Own(symbol)));
    if stays {
        return None;
    }
    let p = &primal.generated.instance;
    (0..p.row_count()).find(|&i| p.matrix.row(i).any(|(j, v)| j == z && v != 0.0))
}

/// The dual of a model as it is written, and the comparison of its matrix with the model's. `Err` says why there is none.
pub fn checked_dual(scope: Scope, primal: &Primal) -> Result<(Formulation, Comparison), String> {
    let f = dual::dual(scope, primal, false)?;
    let d = generated(scope, &f)?;
    let c = transposed::dual(scope, primal, &f, &d);
    Ok((f, c))
}

/// The optimality conditions of a model as they are written, and the comparison of their rows with automatic derivatives at
/// points drawn at random. `Err` says why there are none.
pub fn checked_kkt(scope: Scope, primal: &Primal) -> Result<(Formulation, Comparison), String> {
    let derived = |keep| -> Result<(Formulation, Instance), String> {
        let f = kkt::kkt(scope, primal, keep, false).map_err(|(_, why)| why)?;
        generated(scope, &f).map(|d| (f, d))
    };
    let (f, d) = derived(false).or_else(|why| derived(true).map_err(|_| why))?;
    let c = slopes::kkt(scope, primal, &f, &d, POINTS);
    Ok((f, c))
}

/// Points at which optimality conditions, and duals of quadratic programs, are compared.
pub const POINTS: usize = 3;
