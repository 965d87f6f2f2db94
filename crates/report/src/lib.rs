//! Presentation of the results of ensembles.
//!
//! [`tables`] are text for a terminal, [`figures`] are drawings, [`ensemble_report`] is a page on
//! ensembles, [`replay`] is a page that replays a run, and [`export`] writes files for other
//! programs. All are functions of manifests, records and recordings. They do not write to disk by
//! themselves.
mod analysis;
pub mod ensemble_report;
pub mod estimate;
pub mod export;
pub mod figures;
pub mod presentation;
pub mod replay;
mod svg;
pub mod tables;
mod template;
pub mod text;
