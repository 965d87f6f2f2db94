//! Answers to requests, one feature per module.
pub(crate) mod actions;
pub(crate) mod completion;
pub(crate) mod definition;
pub(crate) mod diagnostics;
pub(crate) mod folding;
pub(crate) mod formatting;
pub(crate) mod hints;
pub(crate) mod hover;
pub(crate) mod lenses;
pub(crate) mod rename;
pub(crate) mod scene;
pub(crate) mod symbols;
pub(crate) mod tokens;
