//! Widths of formatted lines.

/// Largest width of a line \[columns\], unless a single word is longer.
pub(crate) const WIDTH: usize = 100;

/// Width of one level of indentation.
pub(crate) const INDENT: usize = 4;
