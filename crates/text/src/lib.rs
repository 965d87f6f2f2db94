//! Text for people: numbers, tables, lists, suggestions, colours, and names from files.
//!
//! ```
//! assert_eq!(stochc_text::counted(2, "entry"), "2 entries");
//! assert_eq!(stochc_text::number(5178.4), "5,178");
//! assert_eq!(stochc_text::escaped("a<b"), "a&lt;b");
//! ```
mod layout;
mod numbers;
pub mod palette;
mod phrases;
pub mod suggest;
mod visible;

pub use layout::{Markup, TextColumn, TextTable, aligned, paragraph, short};
pub use numbers::{
    DurationError, ShareError, Tick, duration, interval, number, percent, percent_number, ranges,
    ratio, seconds, share, whole_percent, words,
};
pub use phrases::{counted, in_backticks, listed, series};
pub use visible::{escaped, is_invisible, visible, visible_lines};
