//! Report on ensembles: an HTML page, and a folder of figures and tables.
//!
//! `analysis` aggregates the inputs. [`figures`](crate::figures) and `data.rs` present the results,
//! and `page/` builds the page. All these modules are pure functions of the inputs.
//! `docs/guides/report.md` explains each figure.
mod data;
mod html;
mod location;
pub(crate) mod narrative;
mod page;
mod report;

pub use crate::analysis::maps::RecordingReader;
pub use crate::analysis::reported_program::{Input, ReportError};
pub use crate::figures::{FigureFormat, Figures};
pub use crate::svg::Medium;
pub use data::CRITICAL_PATHS;
pub use location::{MARK, ReportLocation};
pub use report::{Report, report};
