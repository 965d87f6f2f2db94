//! What ensembles found, in the forms that people and other programs read.
//!
//! [`tables`] are text for a terminal, [`figures`] pictures, [`ensemble_report`] a page on ensembles, [`replay`] one that
//! shows a run again, and [`export`] files for other programs. All are functions of manifests, records and recordings, and write
//! nothing by themselves.
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
