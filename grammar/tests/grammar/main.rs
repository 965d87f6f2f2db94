//! The grammar from outside: parsing, printing and formatting.
mod format;
mod round_trip;
mod trees;
mod windows;
