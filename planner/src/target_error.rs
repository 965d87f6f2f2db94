//! Why a target cannot be built, and what would help.
use std::fmt;

use stochc_grammar::Cancelled;
use stochc_ir::{Cell, counted, listed};

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TargetError {
    /// There is nothing to build.
    Empty,
    /// A cell is too far away to be counted with.
    TooFar(Cell),
    /// Cells at or under the level of the plate.
    BelowPlate(Vec<Cell>),
    /// Parts that hang together with no block of the plate that may capture.
    Loose(Vec<LoosePart>),
    /// The scene has fewer free blocks than the target has cells.
    TooFewBlocks {
        /// Cells of the target.
        needed: usize,
        /// Free blocks of the scene.
        free: u32,
    },
    /// No order of captures brings a block to these cells.
    Sealed(Vec<Cell>),
    /// Nobody waits for it any more.
    Cancelled,
}

/// A part of a target that hangs in the air.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoosePart {
    /// Its cells, sorted.
    pub cells: Vec<Cell>,
    /// The fewest further cells that would hold it; `None`: not looked for, or too many.
    pub bridge: Option<Vec<Cell>>,
}

impl LoosePart {
    /// Whether a block of the plate could hold it.
    pub fn rests_on_plate(&self) -> bool {
        self.cells.iter().any(|cell| cell.z == 1)
    }
}

/// Cells that are told of, at most.
const MOST_TOLD: usize = 8;

/// `(0, 0, 1), (1, 0, 1) and 5 more`
pub(crate) fn listed_cells(cells: &[Cell]) -> String {
    let told: Vec<String> = cells.iter().take(MOST_TOLD).map(Cell::to_string).collect();
    listed(&told, cells.len())
}

fn cells(count: usize) -> String {
    counted(count, "cell")
}

impl From<Cancelled> for TargetError {
    fn from(_: Cancelled) -> TargetError {
        TargetError::Cancelled
    }
}

impl std::error::Error for TargetError {}

impl fmt::Display for TargetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TargetError::Empty => f.write_str("the target has no cells"),
            TargetError::TooFar(cell) => write!(
                f,
                "the cell {cell} is too far away: coordinates go to {}",
                crate::limits::FARTHEST
            ),
            TargetError::BelowPlate(below) => write!(
                f,
                "{} of the target: {}, at or below the plate, where no block can come",
                cells(below.len()),
                listed_cells(below)
            ),
            TargetError::Loose(parts) => {
                let first = parts.first().map_or(&[][..], |part| &part.cells);
                match parts.len() {
                    1 => write!(f, "{} of the target: ", cells(first.len()))?,
                    n => write!(
                        f,
                        "{n} parts of the target, the first of {}: ",
                        cells(first.len())
                    )?,
                }
                write!(
                    f,
                    "{}, {} together with no block of the plate that may capture",
                    listed_cells(first),
                    if parts.len() == 1 && first.len() == 1 {
                        "hangs"
                    } else {
                        "hang"
                    }
                )
            }
            TargetError::TooFewBlocks { needed, free } => write!(
                f,
                "the target has {}, and the scene {}",
                cells(*needed),
                counted(*free as usize, "free block")
            ),
            TargetError::Sealed(sealed) => write!(
                f,
                "no order of captures brings a block to {}: {}",
                cells(sealed.len()),
                listed_cells(sealed)
            ),
            TargetError::Cancelled => f.write_str("stopped before there was a plan"),
        }
    }
}

impl TargetError {
    /// What to do about it, if anything is known.
    pub fn help(&self) -> Option<String> {
        match self {
            TargetError::Empty => {
                Some("it needs a block at least: a `#` in a drawing, a voxel in a model".to_owned())
            }
            TargetError::BelowPlate(_) => {
                Some("layer 1 rests on the plate: move the target up".to_owned())
            }
            TargetError::Loose(parts) => {
                let part = parts.first()?;
                let bridge = part.bridge.as_ref().filter(|bridge| !bridge.is_empty())?;
                // The plate holds nothing but what rests on it.
                Some(format!(
                    "with {} more, {}, the first part would be held{}",
                    cells(bridge.len()),
                    listed_cells(bridge),
                    match part.rests_on_plate() {
                        true => "; or let a block of the plate under it capture",
                        false => "",
                    }
                ))
            }
            TargetError::TooFewBlocks { needed, .. } => Some(format!(
                "plan a smaller target, or in a scene with `free {needed} uniform` or more"
            )),
            TargetError::Sealed(_) => Some("leave a neighbour of each out".to_owned()),
            TargetError::TooFar(_) | TargetError::Cancelled => None,
        }
    }
}
