//! Option `--offset`.
use stochc_ir::table::Plate;

use super::pair::pair;

/// Displacement of a shape on the plate \[cells\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset {
    /// Displacement to the east. Negative values point west.
    pub east: i32,
    /// Displacement to the north. Negative values point south.
    pub north: i32,
}

impl Offset {
    /// Parses an offset, such as `2, 1` or `(2, 1)`.
    pub fn parse(text: &str) -> Result<Offset, String> {
        let text = text.trim();
        let inside = text
            .strip_prefix('(')
            .and_then(|text| text.strip_suffix(')'));
        let is_on_plate = |cells: i32| cells.unsigned_abs() < Plate::LONGEST;
        pair(inside.unwrap_or(text))
            .filter(|&(east, north)| is_on_plate(east) && is_on_plate(north))
            .map(|(east, north)| Offset { east, north })
            .ok_or_else(|| {
                format!(
                    "give the cells to the east and to the north, whole numbers below {}: `2, 1`",
                    Plate::LONGEST
                )
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_are_read() {
        let offset = |east, north| Ok(Offset { east, north });
        assert_eq!(Offset::parse("2, 1"), offset(2, 1));
        assert_eq!(Offset::parse("(-2,0)"), offset(-2, 0));
        for malformed in [
            "",
            "2",
            "2, 1, 0",
            "(2, 1",
            "2; 1",
            "0.5, 1",
            "100000, 0",
            "0, -2147483648",
        ] {
            assert!(Offset::parse(malformed).is_err(), "{malformed}");
        }
    }
}
