//! Open documents and the programs they belong to.
pub(crate) mod analysis;
pub(crate) mod documents;
pub(crate) mod position;
pub(crate) mod programs;
pub(crate) mod reads;
pub(crate) mod uri;
