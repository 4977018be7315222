//! Every model of the shared collection parses, data and tables included.
//!
//! The collection is not part of the project: it is looked for beside it (`../shared/corpus`) or where
//! `BMOD_SHARED` says. Where it is not there, the test says so and passes.

use std::collections::HashSet;
use std::path::Path;

use crate::common;
use bmod::cli::host::{Output, SystemHost};
use bmod::source::{Known, PreprocessOptions, Span, SymbolKindName};
use bmod::syntax::Parser;
use bmod::syntax::ast::{Stmt, StmtKind, SymbolDecl};
use bmod::syntax::data::{DataKind, DataReader};
use bmod::syntax::table::TableReader;

/// What is declared so far: enough for the `$if declared` of our own models. Sets have some elements.
#[derive(Default)]
struct Declared(HashSet<String>);

impl Declared {
    fn add(&mut self, s: &Stmt) {
        let mut name = |d: &SymbolDecl| {
            self.0.insert(d.name.name.to_lowercase());
        };
        match &s.kind {
            StmtKind::Set(list) => list.iter().for_each(|d| name(&d.symbol)),
            StmtKind::Parameter(list) => list.iter().for_each(|d| name(&d.symbol)),
            StmtKind::Variable(_, list) | StmtKind::Equation(list) => list.iter().for_each(name),
            StmtKind::Table(t) => t.symbols.iter().for_each(name),
            _ => {}
        }
    }
}

impl Known for Declared {
    fn kind(&self, name: &str) -> Option<SymbolKindName> {
        self.is_defined(name).then_some("set")
    }
    fn is_defined(&self, name: &str) -> bool {
        self.0.contains(&name.to_lowercase())
    }
    fn dimension(&self, _: &str) -> Option<usize> {
        None
    }
    fn card(&self, name: &str) -> Option<usize> {
        self.is_defined(name).then_some(6)
    }
    fn scalar_value(&self, _: &str) -> Option<f64> {
        None
    }
}

/// Reads the data of a statement; gives what is wrong with them.
fn read_data(parser: &Parser<'_>, s: &Stmt) -> Vec<String> {
    let mut wrong = Vec::new();
    let mut body = |span: Span, kind| {
        let mut reader = DataReader::new(parser.text(span), span.lo, kind, true);
        while let Some(record) = reader.next() {
            if let Err(d) = record {
                wrong.push(d.message);
            }
        }
    };
    let mut symbols = |list: &[SymbolDecl], kind| {
        list.iter()
            .filter_map(|d| d.data)
            .for_each(|s| body(s, kind));
    };
    match &s.kind {
        StmtKind::Set(list) => list
            .iter()
            .for_each(|d| symbols(std::slice::from_ref(&d.symbol), DataKind::Set)),
        StmtKind::Parameter(list) => list
            .iter()
            .for_each(|d| symbols(std::slice::from_ref(&d.symbol), DataKind::Values)),
        StmtKind::Variable(_, list) | StmtKind::Equation(list) => symbols(list, DataKind::Values),
        StmtKind::Table(t) => {
            for d in &t.symbols {
                let Some(body) = d.data else { continue };
                let dim = d.domain.as_ref().map_or(2, Vec::len);
                let mut reader = TableReader::new(parser.map().expanded(), body, dim, true);
                while let Some(cell) = reader.next() {
                    if let Err(d) = cell {
                        wrong.push(d.message);
                    }
                }
            }
        }
        _ => {}
    }
    wrong
}

/// Parses a file; gives what is wrong with it, and the number of statements.
fn parse(path: &Path, folder: &Path) -> (Vec<String>, usize) {
    let allowed = [folder.to_path_buf()];
    let mut disk = SystemHost::new(path, None, &allowed, Output::Quiet);
    let options = PreprocessOptions {
        defines: Vec::new(),
        slash_comments: path.extension().is_some_and(|e| e == "blk"),
        ..PreprocessOptions::default()
    };
    let mut parser = match Parser::new(&mut disk, &path.to_string_lossy(), options) {
        Ok(p) => p,
        Err(e) => return (vec![e.diagnostic.message], 0),
    };
    let mut wrong = Vec::new();
    let mut statements = 0;
    let mut declared = Declared::default();
    loop {
        match parser.next(&declared) {
            Ok(None) => return (wrong, statements),
            Ok(Some(s)) => {
                statements += 1;
                declared.add(&s);
                wrong.extend(read_data(&parser, &s));
            }
            Err(list) => {
                for d in list {
                    wrong.push(format!(
                        "line {}: {} {}",
                        parser.map().line(d.span),
                        d.code,
                        d.message
                    ));
                }
            }
        }
    }
}

fn all_parse(folder: &Path) -> usize {
    let found = common::files(folder, &["gms", "blk"]);
    let mut failures = Vec::new();
    for path in &found {
        let (wrong, statements) = parse(path, folder);
        if !wrong.is_empty() || statements == 0 {
            failures.push(format!(
                "{}: {}",
                path.display(),
                wrong.first().map_or("no statements", String::as_str)
            ));
        }
    }
    assert!(
        failures.is_empty(),
        "{} of {} files do not parse:\n{}",
        failures.len(),
        found.len(),
        failures.join("\n")
    );
    found.len()
}

#[test]
fn the_shared_collection_parses() {
    let Some(corpus) = common::shared("corpus") else {
        return;
    };
    assert!(all_parse(&corpus) > 0);
}

#[test]
fn our_own_models_parse() {
    assert!(all_parse(&Path::new(env!("CARGO_MANIFEST_DIR")).join("models")) > 0);
}
