//! Generation: text to instance, without a solve. `cargo bench --bench generation`
//!
//! The texts are in `benches/models/`; sizes grow, so that growth with the nonzeros can be seen.

use std::path::Path;

use bmod::cli::host::{Output, SystemHost};
use bmod::run::{ListOptions, Options};
use bmod::session;
use bmod::source::PreprocessOptions;

fn main() {
    divan::main();
}

/// Generates a model; nonzeros of the instance.
fn generate(file: &str, defines: &[(&str, String)]) -> usize {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("benches/models")
        .join(file);
    let folders = [Path::new(env!("CARGO_MANIFEST_DIR")).to_path_buf()];
    let mut host = SystemHost::new(&path, None, &folders, Output::Quiet);
    let options = Options {
        quiet: true,
        collect: false,
        list: Some(ListOptions {
            limit: 0,
            only: Vec::new(),
        }),
        ..Options::default()
    };
    let preprocess = PreprocessOptions {
        defines: defines
            .iter()
            .map(|(k, v)| ((*k).to_string(), v.clone()))
            .collect(),
        slash_comments: true,
        ..PreprocessOptions::default()
    };
    let done = session::run(
        &mut host,
        &path.to_string_lossy(),
        preprocess,
        options,
        false,
        &mut |_| {},
    );
    done.report
        .solves
        .last()
        .expect("the model is generated")
        .nonzeros
}

/// A wall of n courses of n blocks, contacts found in the language.
#[divan::bench(args = [25, 50, 100], sample_count = 5)]
fn wall(n: usize) -> usize {
    generate(
        "wall.blk",
        &[("courses", n.to_string()), ("blocks", n.to_string())],
    )
}

/// Transportation with n × n arcs.
#[divan::bench(args = [250, 500, 1000], sample_count = 5)]
fn transport(n: usize) -> usize {
    generate("transport.blk", &[("n", n.to_string())])
}

/// The join of three sparse maps, in five wordings of the same rows.
#[divan::bench(args = ["maps", "condition", "backwards", "body", "nested"], sample_count = 5)]
fn ijklm(form: &str) -> usize {
    generate("ijklm.blk", &[("form", form.to_string())])
}

/// The same growing.
#[divan::bench(args = [48, 68, 96], sample_count = 5)]
fn ijklm_grows(n: usize) -> usize {
    generate("ijklm.blk", &[("n", n.to_string())])
}

/// Indices renamed and reordered.
#[divan::bench(sample_count = 5)]
fn ijklm_renamed() -> usize {
    generate("ijklm_renamed.blk", &[("n", "96".to_string())])
}
