//! Tables as text, for a terminal or a paper.
mod captures;
mod claims;
mod comparison;
mod estimate;
mod fit;
mod optimum;
mod published;
mod rates;
mod remaining;
mod sweep;
pub(crate) mod trade;

pub use captures::captures_to_text;
pub use claims::{ReportedClaim, claims_by_program, claims_to_text};
pub use comparison::{comparison_to_text, pairs_to_text};
pub use estimate::{estimates_to_text, left_out, lower_bound};
pub use fit::fit_to_text;
pub(crate) use optimum::estimate_to_text;
pub use optimum::optima_to_text;
pub use published::{published_comparison, published_sweep};
pub use rates::{KNOWN_BIAS, first_guess, lower_bounds, rates_to_text};
pub use remaining::remaining_to_text;
pub use sweep::sweep_to_text;
pub use trade::trade_to_text;
