//! What accuracy costs: programs at many settings, each held against a converged reference.
//!
//! [`Plan`] says which run comes next, [`Trade`] what came of them. Neither knows a clock or a
//! thread; [`measure`] brings them.
mod advice;
mod choose;
mod clock;
mod ladder;
mod measure;
mod picture;
mod plan;
mod progress;
mod ranking;
mod refine;
mod report;
mod sample;
mod table;

pub use advice::percent;
pub use choose::{Choice, choose, note};
pub use ladder::{FINEST, base, ladder};
pub use measure::{Setup, measure};
pub use picture::svg;
pub use plan::{Extent, Job, Next, Outcome, PILOT, Plan};
pub use ranking::{Ranked, Verdict, rank};
pub use refine::{CLOSE, Convergence, Doubling, convergence};
pub use report::{Cell, FORMAT, Means, Program, Reference, Rung, Trade, known};
pub use sample::{End, Measured, Sample};
