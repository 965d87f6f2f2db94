//! Errors of targets, and help for them.
use std::fmt;

use serde::Serialize;
use stochc_grammar::Cancelled;
use stochc_ir::Cell;
use stochc_text::{counted, listed};

/// Reason why there is no plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", content = "detail", rename_all = "snake_case")]
pub enum TargetError {
    /// The target has no cells.
    Empty,
    /// A coordinate is too large.
    TooFar(Cell),
    /// Cells at or under the level of the plate.
    BelowPlate(Vec<Cell>),
    /// Cells that are not in the layer of a planar world, or that are seeds.
    NotInPlane(Vec<Cell>),
    /// No blocks of the plate are named in a planar world.
    NoSeeds,
    /// Parts connected to no capturing block of the plate.
    Loose(Vec<LoosePart>),
    /// The scene has fewer free blocks than the target has cells.
    TooFewBlocks {
        /// Number of cells of the target.
        needed: usize,
        /// Number of free blocks of the scene.
        free: u32,
    },
    /// No order of captures brings a block to these cells.
    Sealed(Vec<Cell>),
    /// Planning was cancelled.
    Cancelled,
}

/// Part of a target without a capturing neighbour.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LoosePart {
    /// Cells of the part, sorted.
    pub cells: Vec<Cell>,
    /// Smallest set of additional cells that would support the part, assuming the bridges of
    /// earlier parts. `None` if there is none, or the search reached its limit.
    pub bridge: Option<Vec<Cell>>,
    /// Whether the part rests on the plate. In a planar world, the plate is not under the blocks.
    #[serde(skip)]
    pub rests_on_plate: bool,
}

/// Largest number of cells in a list.
const MAX_LISTED: usize = 8;

/// Lists cells: `(0, 0, 1), (1, 0, 1) and 5 more`.
pub fn listed_cells(cells: &[Cell]) -> String {
    let names: Vec<String> = cells.iter().take(MAX_LISTED).map(Cell::to_string).collect();
    listed(&names, cells.len())
}

fn cells(count: usize) -> String {
    counted(count, "cell")
}

/// Lists loose parts, in one sentence.
fn loose(parts: &[LoosePart]) -> String {
    const HOLDER: &str = "attached to no block of the plate that may capture";
    let all: usize = parts.iter().map(|part| part.cells.len()).sum();
    let verb = if all == 1 { "is" } else { "are" };
    if let [part] = parts {
        let names = listed_cells(&part.cells);
        return format!("{} of the target, {names}, {verb} {HOLDER}", cells(all));
    }
    let names: Vec<String> = (parts.iter().take(MAX_LISTED))
        .map(|part| match &part.cells[..] {
            [cell] => cell.to_string(),
            several => format!("{} at {}", cells(several.len()), several[0]),
        })
        .collect();
    let (count, listed) = (parts.len(), listed(&names, parts.len()));
    format!(
        "{count} parts of the target, {} in all, {verb} {HOLDER}: {listed}",
        cells(all)
    )
}

/// Lists the cells that would support loose parts. Returns `None` if none were found.
fn bridges(parts: &[LoosePart]) -> Option<String> {
    let bridges = parts.iter().filter_map(|part| part.bridge.as_ref());
    let found = bridges.clone().count();
    let bridge: Vec<Cell> = bridges.flatten().copied().collect();
    if bridge.is_empty() {
        return None;
    }
    let held = match (parts.len(), parts.len() - found) {
        (1, _) => "it would be held".to_owned(),
        (_, 0) => "all parts would be held".to_owned(),
        (_, others) => format!("all parts except {others} would be held"),
    };
    // The plate supports only parts that rest on it.
    let plate = if parts.iter().any(|it| it.rests_on_plate) {
        "; or let a block of the plate under it capture"
    } else {
        ""
    };
    let more = counted(bridge.len(), "more cell");
    Some(format!(
        "with {more}, {}, {held}{plate}",
        listed_cells(&bridge)
    ))
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
                crate::target::limits::FARTHEST
            ),
            TargetError::BelowPlate(below) => write!(
                f,
                "{} of the target: {}, at or below the plate, which no block can reach",
                cells(below.len()),
                listed_cells(below)
            ),
            TargetError::NotInPlane(taken) => write!(
                f,
                "{} of the target: {}, in no free cell of the planar world",
                cells(taken.len()),
                listed_cells(taken)
            ),
            TargetError::NoSeeds => {
                f.write_str("in a planar world, a plan needs named blocks of the plate")
            }
            TargetError::Loose(parts) => f.write_str(&loose(parts)),
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
    /// Returns help, if any is known.
    pub fn help(&self) -> Option<String> {
        match self {
            TargetError::Empty => {
                Some("it needs a block at least: a `#` in a drawing, a voxel in a model".to_owned())
            }
            TargetError::BelowPlate(_) => {
                Some("layer 1 rests on the plate: move the target up".to_owned())
            }
            TargetError::NotInPlane(_) => Some(
                "a shape in a planar world has only layer 1, without the blocks of the plate"
                    .to_owned(),
            ),
            TargetError::NoSeeds => {
                Some("plan a shape that an assembly claims, or name their positions".to_owned())
            }
            TargetError::Loose(parts) => bridges(parts),
            TargetError::TooFewBlocks { needed, .. } => Some(format!(
                "plan a smaller target, or in a scene with at least {needed} free blocks"
            )),
            TargetError::Sealed(_) => Some("leave a neighbour of each out".to_owned()),
            TargetError::TooFar(_) | TargetError::Cancelled => None,
        }
    }
}
