//! Tests the grammar through its interface: parsing, printing and formatting.
mod format;
mod round_trip;
mod trees;
mod windows;
