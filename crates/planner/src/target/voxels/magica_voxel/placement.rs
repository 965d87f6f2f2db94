//! Quarter turns, reflections and translations of voxels.

/// Placement of a node. Lengths are in half voxels, so that centres are integers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placement {
    /// Signed permutation matrix: column and sign of each row's only entry.
    rows: [(usize, i64); 3],
    shift: [i64; 3],
}

impl Placement {
    pub const IDENTITY: Placement = Placement {
        rows: [(0, 1), (1, 1), (2, 1)],
        shift: [0; 3],
    };

    /// Reads a rotation and a translation from text.
    ///
    /// # Errors
    ///
    /// The invalid text.
    pub fn read<'a>(
        rotation: Option<&'a [u8]>,
        translation: Option<&'a [u8]>,
    ) -> Result<Placement, Malformed<'a>> {
        let mut placement = Placement::IDENTITY;
        if let Some(text) = rotation {
            placement.rows = rows(text).ok_or(Malformed::Rotation(text))?;
        }
        if let Some(text) = translation {
            placement.shift = shift(text).ok_or(Malformed::Translation(text))?;
        }
        Ok(placement)
    }

    /// Transforms a point \[half voxels\].
    pub fn apply(&self, point: [i64; 3]) -> [i64; 3] {
        std::array::from_fn(|axis| {
            let (from, sign) = self.rows[axis];
            sign * point[from] + self.shift[axis]
        })
    }

    /// Returns the composition with the placement `inner` of a child node.
    pub fn around(&self, inner: &Placement) -> Placement {
        Placement {
            rows: self.rows.map(|(axis, sign)| {
                let (from, inner) = inner.rows[axis];
                (from, sign * inner)
            }),
            shift: self.apply(inner.shift),
        }
    }
}

/// Invalid text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Malformed<'a> {
    Rotation(&'a [u8]),
    Translation(&'a [u8]),
}

/// Reads the rows of a rotation.
///
/// # Source
///
/// MagicaVoxel's file format. Bits 0 and 1 are the column of the first row's entry, and bits 2 and
/// 3 that of the second row. Bits 4 to 6 mark negative rows.
fn rows(text: &[u8]) -> Option<[(usize, i64); 3]> {
    let byte: u8 = std::str::from_utf8(text).ok()?.trim().parse().ok()?;
    let (first, second) = (usize::from(byte & 3), usize::from(byte >> 2 & 3));
    if byte > 127 || first == 3 || second == 3 || first == second {
        return None;
    }
    let sign = |row: u8| 1 - 2 * i64::from(byte >> (4 + row) & 1);
    Some([
        (first, sign(0)),
        (second, sign(1)),
        (3 - first - second, sign(2)),
    ])
}

fn shift(text: &[u8]) -> Option<[i64; 3]> {
    let mut numbers = std::str::from_utf8(text).ok()?.split_ascii_whitespace();
    let mut next = || Some(2 * i64::from(numbers.next()?.parse::<i32>().ok()?));
    let shift = [next()?, next()?, next()?];
    numbers.next().is_none().then_some(shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rotation(text: &str) -> Option<Placement> {
        Placement::read(Some(text.as_bytes()), None).ok()
    }

    /// Example from the format's description.
    #[test]
    fn rows_match_the_matrix() {
        let byte = (1 << 0) | (2 << 2) | (1 << 5) | (1 << 6);
        let placement = rotation(&byte.to_string()).unwrap();
        assert_eq!(placement.apply([1, 2, 3]), [2, -3, -1]);
        for wrong in ["", "3", "0", "5", "12", "132", "-4", "4 4", "x"] {
            assert_eq!(rotation(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn placements_are_composed() {
        let all: Vec<Placement> = (0..128_u8)
            .filter_map(|byte| rotation(&byte.to_string()))
            .collect();
        assert_eq!(all.len(), 48);
        let shifted = |placement: &Placement| Placement {
            shift: [2, -4, 6],
            ..*placement
        };
        for outer in all.iter().map(shifted) {
            for inner in all.iter().map(shifted) {
                let point = [1, 20, -300];
                let both = outer.around(&inner).apply(point);
                assert_eq!(both, outer.apply(inner.apply(point)));
            }
        }
    }

    #[test]
    fn translations_are_three_numbers() {
        let read = |text: &'static str| Placement::read(None, Some(text.as_bytes()));
        assert_eq!(read("1 -2 3").unwrap().apply([0; 3]), [2, -4, 6]);
        for wrong in ["", "1 2", "1 2 3 4", "1,2,3", "9999999999 0 0"] {
            let expected = Err(Malformed::Translation(wrong.as_bytes()));
            assert_eq!(read(wrong), expected);
        }
    }
}
