//! Parser generated from the grammar.
#![allow(missing_docs, reason = "pest derives an undocumented enum of rules")]

/// The parser that pest generates.
#[derive(pest_derive::Parser)]
#[grammar = "sa.pest"]
pub(crate) struct SaParser;
