//! Rate law: waiting times from the surroundings of an open face.
use serde::{Deserialize, Serialize};
use stochc_ir::Face;

use crate::geometry::rivals::Rivals;
use crate::waits::wait::Wait;

/// Surroundings that determine a waiting time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// Direction of the face.
    pub direction: Face,
    /// Fraction of the sphere of reach that is not obstructed.
    pub open: f64,
    /// Density of free blocks at the cell's height, relative to their mean.
    pub density: f64,
    /// Fraction of the initial free blocks that are still free.
    pub free: f64,
    /// Whether a block or the ground is next to the open cell, perpendicular to the face's normal.
    pub adjacent: bool,
    /// Whether a block or the ground is next to the capturing block, perpendicular to the face's
    /// normal.
    pub adjacent_parent: bool,
    /// Whether no block is next to the open cell, but a block is across one of the cell's edges.
    /// Only directions perpendicular to the face's normal count.
    pub corner: bool,
    /// Whether no block is next to the capturing block, but a block is across one of the capturing
    /// block's edges. Only directions perpendicular to the face's normal count.
    pub corner_parent: bool,
    /// Whether the nearest block or ground is two cells away from the capturing block. Only
    /// directions perpendicular to the face's normal count.
    pub near_parent: bool,
    /// Whether the open cell is a gap. In a gap, a block is opposite to the face, and no block is
    /// next to the cell.
    pub ahead: bool,
    /// Open faces nearby.
    pub rivals: Rivals,
    /// Whether the face has been open since the first tick, when the free blocks were at rest.
    pub cold: bool,
}

impl Surroundings {
    /// Returns the number of the kind of surroundings. A kind is an orientation (up, sideways,
    /// down) with the conditions of the rate law. The density and the number of free blocks do not
    /// count.
    pub fn kind(&self) -> u16 {
        let orientation = match self.direction {
            Face::Up => 1,
            Face::Down => 2,
            _ => 0,
        };
        let conditions = [
            self.adjacent,
            self.adjacent_parent,
            self.corner,
            self.corner_parent,
            self.near_parent,
            self.ahead,
            self.rivals.adjacent > 0,
            self.rivals.across > 0,
            self.rivals.around > 0,
        ];
        let bit = |kind, is| kind << 1 | u16::from(is);
        conditions.into_iter().fold(orientation, bit)
    }
}

/// Factor of the rate for a [kind](Surroundings::kind) of surroundings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KindFactor {
    /// Kind of surroundings.
    pub kind: u16,
    /// Factor of the rate law's rate.
    pub factor: f64,
}

impl KindFactor {
    /// Returns the factor for surroundings, or 1 if their kind is not listed. `kinds` is in order.
    pub fn find(kinds: &[KindFactor], of: &Surroundings) -> f64 {
        let kind = of.kind();
        let found = kinds.binary_search_by_key(&kind, |it| it.kind);
        found.map_or(1.0, |found| kinds[found].factor)
    }
}

/// Parameters of the rate law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Parameters(pub [f64; Parameters::COUNT]);

/// Parameter of the rate law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Name.
    pub name: &'static str,
    /// Meaning.
    pub meaning: &'static str,
}

impl Parameters {
    /// Number of parameters: [`Parameters::RATE`] for the rate, and the others for the docking
    /// time.
    pub const COUNT: usize = 19;

    /// Number of parameters of the rate.
    pub const RATE: usize = 13;

    /// Descriptions in order.
    pub const ALL: [Parameter; Parameters::COUNT] = [
        Parameter {
            name: "rate",
            meaning: "logarithm of the rate of a face without any obstruction, per tick",
        },
        Parameter {
            name: "reach",
            meaning: "exponent of the part of the sphere of reach that is open",
        },
        Parameter {
            name: "density",
            meaning: "exponent of the density of the free gas",
        },
        Parameter {
            name: "adjacent",
            meaning: "logarithm of the rate's factor if a block is next to the cell",
        },
        Parameter {
            name: "adjacent-parent",
            meaning: "logarithm of the rate's factor if a block is next to the parent",
        },
        Parameter {
            name: "corner",
            meaning: "logarithm of the rate's factor if a block is across an edge of the cell, and none next to it",
        },
        Parameter {
            name: "corner-parent",
            meaning: "logarithm of the rate's factor if a block is across an edge of the parent, and none next to it",
        },
        Parameter {
            name: "rival",
            meaning: "logarithm of the rate's factor next to a cell that is open as well",
        },
        Parameter {
            name: "rival-across",
            meaning: "logarithm of the rate's factor for each cell across an edge that is open as well",
        },
        Parameter {
            name: "rival-around",
            meaning: "logarithm of the rate's factor for each other face nearby that is open as well, and does not face away",
        },
        Parameter {
            name: "ahead",
            meaning: "logarithm of the rate's factor if a block is ahead of the cell, and none next to it",
        },
        Parameter {
            name: "near-parent",
            meaning: "logarithm of the rate's factor if a block is two cells from the parent, and none next to it or across an edge of it",
        },
        Parameter {
            name: "depletion",
            meaning: "by how much the exponent of the part of the blocks that is still free is above 1",
        },
        Parameter {
            name: "docking",
            meaning: "logarithm of the mean docking time, in ticks",
        },
        Parameter {
            name: "docking-adjacent",
            meaning: "logarithm of its factor if a block is next to the cell",
        },
        Parameter {
            name: "docking-adjacent-parent",
            meaning: "logarithm of its factor if a block is next to the parent",
        },
        Parameter {
            name: "docking-corner-parent",
            meaning: "logarithm of its factor if a block is across an edge of the parent, and none next to it",
        },
        Parameter {
            name: "docking-rival",
            meaning: "logarithm of its factor next to a cell that is open as well",
        },
        Parameter {
            name: "docking-cold",
            meaning: "logarithm of its factor for faces open since the first tick",
        },
    ];

    /// Calibrated parameters of the built-in scene `hemisphere`. They are the starting point for
    /// other scenes.
    pub const TYPICAL: Parameters = Parameters([
        -5.6, 0.86, 1.0, 0.50, 0.18, 0.39, 0.27, -0.11, -0.27, -0.28, 0.6, 0.27, 0.0, 5.17, -0.26,
        -0.81, -0.50, -0.45, 1.40,
    ]);

    /// Prior standard deviations between scenes.
    ///
    /// Rate and docking time vary with the scene. The effects of geometry vary little. The effect
    /// of adjacent faces depends on the difficulty of captures. If captures are difficult, two
    /// pulls capture more blocks than one pull. In gaps, blocks jam in some scenes and settle
    /// faster in others.
    pub const SPREAD: [f64; Parameters::COUNT] = [
        5.0, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 1.0, 0.5, 0.5, 3.0, 0.3, 1.0, 5.0, 0.3, 0.3, 0.3, 0.3,
        0.5,
    ];

    /// Returns the features for the logarithms of rate and docking time, without the factor of the
    /// free blocks.
    pub fn features(
        of: &Surroundings,
    ) -> (
        [f64; Parameters::RATE],
        [f64; Parameters::COUNT - Parameters::RATE],
    ) {
        let indicator = |is: bool| f64::from(u8::from(is));
        let (adjacent, parent) = (indicator(of.adjacent), indicator(of.adjacent_parent));
        let corner_parent = indicator(of.corner_parent);
        let rival = indicator(of.rivals.adjacent > 0);
        (
            [
                1.0,
                libm::log(of.open + MIN_OPEN),
                libm::log(of.density.max(MIN_DENSITY)),
                adjacent,
                parent,
                indicator(of.corner),
                corner_parent,
                rival,
                f64::from(of.rivals.across),
                f64::from(of.rivals.around) / 2.0,
                indicator(of.ahead),
                indicator(of.near_parent),
                libm::log(of.free.max(MIN_FREE)),
            ],
            [
                1.0,
                adjacent,
                parent,
                corner_parent,
                rival,
                indicator(of.cold),
            ],
        )
    }

    /// Returns the factor of all rates for a fraction `part` of free blocks. A larger fraction
    /// never gives a smaller factor.
    pub fn of_free(&self, part: f64) -> f64 {
        let part = part.max(0.0);
        match self.0[DEPLETION] {
            0.0 => part,
            beyond => part * libm::pow(part.max(MIN_FREE), beyond.max(-1.0)),
        }
    }

    /// Returns the waiting time of a face with these surroundings.
    pub fn wait(&self, of: &Surroundings) -> Wait {
        let (rate, docking) = Parameters::features(&Surroundings { free: 1.0, ..*of });
        let sum = |parameters: &[f64], features: &[f64]| -> f64 {
            parameters.iter().zip(features).map(|(a, b)| a * b).sum()
        };
        let (of_rate, of_docking) = self.0.split_at(Parameters::RATE);
        Wait {
            rate: self.of_free(of.free) * libm::exp(sum(of_rate, &rate)),
            docking: libm::exp(sum(of_docking, &docking)),
        }
    }
}

/// Index of the parameter `depletion`. It belongs to the fraction of free blocks.
const DEPLETION: usize = 12;

/// Lower limit of the fraction of free blocks in the power law. Smaller fractions count as this
/// fraction.
const MIN_FREE: f64 = 1e-3;

/// Term that is added to the open fraction, so that a face in a pit still captures sometimes.
const MIN_OPEN: f64 = 0.02;

/// Smallest relative density in the rate law.
const MIN_DENSITY: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Neighbourhood, around};
    use stochc_ir::{Cell, Face};

    #[test]
    fn rates_grow_with_the_number_of_free_blocks() {
        let at = |free| Surroundings {
            free,
            ..around(Cell::new(0, 0, 5), Face::Up, Neighbourhood::EMPTY, |_| None)
        };
        for (beyond, of_half) in [(-5.0, 1.0), (-0.5, 0.5_f64.sqrt()), (0.0, 0.5), (1.0, 0.25)] {
            let mut parameters = Parameters::TYPICAL;
            parameters.0[DEPLETION] = beyond;
            let rate = |part: f64| parameters.wait(&at(part)).rate;
            for part in [0.0, 1e-6, 0.1, 0.5, 1.0, 1.2] {
                let expected = parameters.of_free(part) * rate(1.0);
                assert!((rate(part) - expected).abs() <= 1e-12 * expected, "{part}");
            }
            assert!(
                (parameters.of_free(0.5) - of_half).abs() < 1e-12,
                "{beyond}"
            );
            let parts = (0..1000).map(|part| f64::from(part) / 1000.0);
            for part in parts {
                let more = parameters.of_free(part + 1e-3);
                assert!(parameters.of_free(part) <= more * (1.0 + 1e-12), "{part}");
            }
            assert_eq!(parameters.of_free(0.0), 0.0);
        }
    }
}
