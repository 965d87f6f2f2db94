//! Option `--plate`.
use stochc_ir::table::Plate;

use super::pair::pair;

/// Plate, and its blocks that may capture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeedPlate {
    /// Size and position of the plate.
    pub plate: Plate,
    /// Cells (x, y) of the blocks that may capture. `None` means all blocks of the plate.
    pub seeds: Option<Vec<(i32, i32)>>,
}

impl SeedPlate {
    /// Parses a plate, such as `3 x 3`, `3x3` or `3 x 3 at (1, 1) (2, 0)`.
    pub fn parse(text: &str) -> Result<SeedPlate, String> {
        let malformed = || {
            "give its size, and seeds if not all may capture: `3 x 3`, `3 x 3 at (1, 1) (2, 0)`"
                .to_owned()
        };
        let (size, seeds) = match text.split_once("at") {
            Some((size, seeds)) => (size, Some(seeds)),
            None => (text, None),
        };
        let (width, depth) = size.split_once('x').ok_or_else(malformed)?;
        let edge = |text: &str| {
            let edge = text.trim().parse().map_err(|_| malformed())?;
            if (1..=Plate::LONGEST).contains(&edge) {
                Ok(edge)
            } else {
                Err(format!(
                    "an edge of the plate has 1 to {} blocks",
                    Plate::LONGEST
                ))
            }
        };
        let plate = Plate {
            width: edge(width)?,
            depth: edge(depth)?,
        };
        let place = |text: &str| {
            let place = text.trim().trim_start_matches(',').trim();
            pair(place.strip_prefix('(')?)
        };
        let places = |text: &str| {
            let text = text.trim().strip_suffix(')').ok_or_else(malformed)?;
            let places: Option<Vec<(u32, u32)>> = text.split(')').map(place).collect();
            let places = places.ok_or_else(malformed)?;
            match places
                .iter()
                .find(|&&(x, y)| x >= plate.width || y >= plate.depth)
            {
                Some((x, y)) => Err(format!("({x}, {y}) is outside the plate")),
                None => Ok(places
                    .into_iter()
                    .map(|(x, y)| (x as i32, y as i32))
                    .collect()),
            }
        };
        let seeds = seeds.map(places).transpose()?;
        Ok(SeedPlate { plate, seeds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plates_are_read() {
        let plate = |width, depth, seeds: Option<&[(i32, i32)]>| {
            Ok(SeedPlate {
                plate: Plate { width, depth },
                seeds: seeds.map(<[_]>::to_vec),
            })
        };
        assert_eq!(SeedPlate::parse("3 x 4"), plate(3, 4, None));
        assert_eq!(SeedPlate::parse("3x4"), plate(3, 4, None));
        let seeds = Some(&[(1, 1), (2, 0)][..]);
        assert_eq!(
            SeedPlate::parse("3 x 3 at (1, 1) (2, 0)"),
            plate(3, 3, seeds)
        );
        assert_eq!(SeedPlate::parse("3 x 3 at (1,1),(2,0)"), plate(3, 3, seeds));
        for malformed in [
            "",
            "3",
            "0 x 3",
            "3 x 3 at",
            "3 x 3 at 1, 1",
            "3 x 3 at (3, 0)",
            "200000 x 1",
        ] {
            assert!(SeedPlate::parse(malformed).is_err(), "{malformed}");
        }
    }
}
