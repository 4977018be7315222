//! The parser that pest makes from `grammar/bmod.pest`.
#![allow(missing_docs)]

#[derive(pest_derive::Parser)]
#[grammar = "../grammar/bmod.pest"]
pub(super) struct Grammar;
