//! Surroundings of open faces.
pub(crate) mod accessibility;
pub(crate) mod gap;
pub(crate) mod interaction;
pub(crate) mod neighbourhood;
pub(crate) mod rivals;
pub(crate) mod surroundings;
