//! Frames of instances: mirrored, turned and moved patterns.
use stochc_ir::Face;

/// Frame of an instance. Maps faces and positions of a pattern to the assembly: first the mirror,
/// then the turn, then the move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// Whether east and west are exchanged.
    pub is_mirrored: bool,
    /// Number of quarter turns, from 0 to 3. One quarter turn maps east to north.
    pub quarters: u8,
    /// Number of blocks to the east and to the north.
    pub offset: (i64, i64),
}

impl Frame {
    /// Returns a face of the pattern as a face of the assembly.
    pub fn face(self, face: Face) -> Face {
        let face = match face {
            Face::East | Face::West if self.is_mirrored => face.opposite(),
            _ => face,
        };
        face.turned(self.quarters).unwrap_or(face)
    }

    /// Returns a position of the pattern as a position on the plate. A position that does not fit
    /// in 64 bits becomes the nearest one that does.
    pub fn position(self, (x, y): (i64, i64)) -> (i64, i64) {
        let x = if self.is_mirrored {
            x.saturating_neg()
        } else {
            x
        };
        let (x, y) = match self.quarters {
            0 => (x, y),
            1 => (y.saturating_neg(), x),
            2 => (x.saturating_neg(), y.saturating_neg()),
            _ => (y, x.saturating_neg()),
        };
        let (east, north) = self.offset;
        (x.saturating_add(east), y.saturating_add(north))
    }

    /// Returns the frame of an instance inside a pattern whose own frame is `outer`.
    #[must_use]
    pub fn within(self, outer: Frame) -> Frame {
        let quarters = if outer.is_mirrored {
            4 - self.quarters
        } else {
            self.quarters
        };
        Frame {
            is_mirrored: self.is_mirrored != outer.is_mirrored,
            quarters: (quarters + outer.quarters) % 4,
            offset: outer.position(self.offset),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames() -> impl Iterator<Item = Frame> {
        [false, true].into_iter().flat_map(|is_mirrored| {
            (0..4).map(move |quarters| Frame {
                is_mirrored,
                quarters,
                offset: (5, -2),
            })
        })
    }

    #[test]
    fn a_frame_inside_a_frame_maps_like_both_in_turn() {
        for outer in frames() {
            for inner in frames() {
                let both = inner.within(outer);
                for position in [(0, 0), (1, 0), (0, 1), (3, -7)] {
                    let expected = outer.position(inner.position(position));
                    assert_eq!(both.position(position), expected, "{inner:?} in {outer:?}");
                }
                for face in Face::ALL {
                    assert_eq!(both.face(face), outer.face(inner.face(face)));
                }
            }
        }
    }

    #[test]
    fn faces_and_positions_map_alike() {
        for frame in frames() {
            for face in Face::SIDES {
                let [x, y, _] = face.normal().map(i64::from);
                let [east, north, _] = frame.face(face).normal().map(i64::from);
                let expected = (frame.offset.0 + east, frame.offset.1 + north);
                assert_eq!(frame.position((x, y)), expected, "{frame:?}");
            }
        }
    }

    #[test]
    fn a_quarter_turn_goes_from_east_to_north() {
        let frame = Frame {
            quarters: 1,
            ..Frame::default()
        };
        assert_eq!(frame.face(Face::East), Face::North);
        assert_eq!(frame.face(Face::Up), Face::Up);
        assert_eq!(frame.position((2, 1)), (-1, 2));
    }
}
