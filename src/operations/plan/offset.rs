//! `--offset`.
use stochc_ir::table::Plate;

/// How far a shape is moved on the plate, in cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset {
    /// To the east; to the west if negative.
    pub east: i32,
    /// To the north; to the south if negative.
    pub north: i32,
}

impl Offset {
    /// Reads `2, 1` or `(2, 1)`.
    pub fn parse(text: &str) -> Result<Offset, String> {
        let text = text.trim();
        let inside = text
            .strip_prefix('(')
            .and_then(|text| text.strip_suffix(')'));
        let (east, north) = inside
            .unwrap_or(text)
            .split_once(',')
            .ok_or_else(|| "give the cells to the east and to the north: `2, 1`".to_owned())?;
        let along = |text: &str| {
            let cells: Option<i32> = text.trim().parse().ok();
            let is_on_plate = |cells: &i32| cells.unsigned_abs() < Plate::LONGEST;
            cells.filter(is_on_plate).ok_or_else(|| {
                format!(
                    "a shape is moved by a whole number of cells, fewer than {}: `2, 1`",
                    Plate::LONGEST
                )
            })
        };
        Ok(Offset {
            east: along(east)?,
            north: along(north)?,
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
