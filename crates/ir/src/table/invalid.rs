//! Errors of event tables from a file.
use stochc_text::counted;
use thiserror::Error;

use super::RoleId;
use crate::Cell;

/// Reason why event tables are invalid.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum InvalidTables {
    /// The number of faces of a block is out of range.
    #[error("a block has no {0} faces")]
    Faces(u8),
    /// The plate is too large.
    #[error("a plate of {width} x {depth} blocks is too large")]
    PlateSize {
        /// Blocks from west to east.
        width: u32,
        /// Blocks from south to north.
        depth: u32,
    },
    /// A seed comes after another role.
    #[error("seeds come first among the roles")]
    SeedOrder,
    /// A seed has a cell outside of the plate.
    #[error("a seed is not on the plate")]
    SeedCell,
    /// The number of phases of an aggregate is wrong.
    #[error("an aggregate of {0} blocks has a phase for each size")]
    AggregatePhases(u32),
    /// An aggregate has roles or duties.
    #[error("the blocks of an aggregate have nothing to do")]
    AggregateDuties,
    /// A phase other than the first has pre-attached blocks.
    #[error("only the first phase can be pre-attached")]
    LatePreAttached,
    /// Two roles have the same name.
    #[error("`tables.roles[{second}].name` is that of `tables.roles[{first}]`")]
    RoleName {
        /// Index of the first role.
        first: usize,
        /// Index of the second role.
        second: usize,
    },
    /// Duties are not sorted.
    #[error("the duties are not sorted, or one comes twice")]
    DutyOrder,
    /// The number of reports that a phase expects differs from the number that its blocks make.
    #[error("`tables.phases[{phase}].reports` is {expected}, and its blocks make {made}")]
    Reports {
        /// Index of the phase.
        phase: usize,
        /// Number of expected reports.
        expected: u32,
        /// Number of reports that the blocks make.
        made: u64,
    },
    /// A timeout is zero.
    #[error("`tables.phases[{0}].timeout` is 0: it is at least 1, or null")]
    Timeout(usize),
    /// A phase cannot be retried as its table states.
    #[error("`tables.phases[{0}].recovery` does not fit the phase")]
    Recovery(usize),
    /// A phase with this index does not exist.
    #[error("there is no phase {0}")]
    UnknownPhase(u32),
    /// A role with this index does not exist.
    #[error("there is no role {}", .0.0)]
    UnknownRole(RoleId),
    /// A block is captured in the role of a seed.
    #[error("`tables.roles[{0}].seed` is a cell, and a block is captured in that role")]
    CapturedSeed(usize),
    /// A cell is beyond the limit.
    #[error("{0} is too far away")]
    FarCell(Cell),
    /// The scene has another kind of bond than the tables.
    #[error("`tables.bond` is `{tables}`, and the law of `scene.bond` is `{scene}`")]
    Bond {
        /// Kind of bond in the tables.
        tables: &'static str,
        /// Kind of bond in the scene.
        scene: &'static str,
    },
    /// The scene has another number of faces than the tables.
    #[error("`tables.faces` is {tables}, which is {scene} by `scene.block.faces` and `scene.bond`")]
    SceneFaces {
        /// Number of faces in the tables.
        tables: u8,
        /// Number of faces in the scene.
        scene: u8,
    },
    /// A block captures out of the plane of the scene.
    #[error("a block captures with `up` or `down`, and the world of the scene is planar")]
    OutOfPlane,
    /// The scene has too few free blocks.
    #[error(
        "`scene.free.count` is {free}, and the structure needs {} at once",
        counted(*needed as usize, "block")
    )]
    FreeBlocks {
        /// Number of free blocks.
        free: u64,
        /// Number of needed blocks.
        needed: u64,
    },
}
