//! What one run leaves behind.
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::table::{PhaseId, RoleId};
use crate::{Cell, Face};

/// Everything that is kept of one run: a pure function of (tables, scene, settings, seed, run).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// The number of the run in its ensemble, from 0.
    pub run: u64,
    /// How it ended.
    pub outcome: Outcome,
    /// Ticks until it ended.
    pub ticks: u64,
    /// Ticks that each phase took, for the phases that were completed: 0 for one that is planted. Of an
    /// aggregate, those until the first bond, and then from each size to the next.
    pub phase_ticks: Vec<u64>,
    /// Different bodies that were captured at least once; of an aggregate, blocks of the largest group.
    pub blocks_used: u32,
    /// Hops of messages from a block to its parent or child.
    pub hops: u64,
    /// Blocks that docked where nobody expected them, and were rejected at once; 0 where faces have to
    /// be switched on to capture.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub unplanned: u64,
    /// Every capture, in the order of docking.
    pub bonds: Vec<BondRecord>,
    /// The waits that were under way when it ended, by their beginning: faces that were magnetized and
    /// had captured nothing. Nobody knows how long they would have been: they are censored.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waiting: Vec<WaitRecord>,
    /// Every release, in its order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub releases: Vec<ReleaseRecord>,
    /// Each of the [`unplanned`](RunRecord::unplanned) bonds, in the order of docking.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unplanned_bonds: Vec<UnplannedRecord>,
}

impl RunRecord {
    /// A run that has captured nothing.
    pub const fn without_bonds(run: u64, outcome: Outcome, ticks: u64) -> RunRecord {
        RunRecord {
            run,
            outcome,
            ticks,
            phase_ticks: Vec::new(),
            blocks_used: 0,
            hops: 0,
            unplanned: 0,
            bonds: Vec::new(),
            waiting: Vec::new(),
            releases: Vec::new(),
            unplanned_bonds: Vec::new(),
        }
    }
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a reference"
)]
fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Outcome {
    /// Every phase reported complete.
    Completed,
    /// A phase reached its timeout, or the run its limit of ticks: the time is censored.
    TimedOut {
        /// The phase that did not end.
        phase: PhaseId,
        /// What stopped it.
        by: Limit,
    },
    /// The physics broke down; the time means nothing.
    Failed {
        /// In which phase.
        phase: PhaseId,
        /// What broke, with the block.
        reason: String,
    },
}

/// What stops a run before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// The timeout that the program gives the phase.
    Timeout,
    /// The limit of ticks of the whole run, `Settings::max_ticks`.
    MaxTicks,
}

impl Limit {
    /// What stops a run at this tick; `is_late`: its phase has used up its time.
    pub fn reached(is_late: bool, tick: u64, max_ticks: Option<u64>) -> Option<Limit> {
        if is_late {
            return Some(Limit::Timeout);
        }
        max_ticks
            .is_some_and(|limit| tick >= limit)
            .then_some(Limit::MaxTicks)
    }
}

/// One capture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BondRecord {
    /// In which phase.
    pub phase: PhaseId,
    /// The role that magnetized a face.
    pub parent: RoleId,
    /// Which, in the structure's frame.
    pub face: Face,
    /// The role that was given.
    pub child: RoleId,
    /// Where the child sits.
    pub cell: Cell,
    /// Tick at which the face was magnetized.
    pub magnetized: u64,
    /// Tick of the docking; the wait is `docked - magnetized`.
    pub docked: u64,
    /// Times that a free block came into the reach of the pull, re-entries included.
    pub entries: u32,
    /// Ticks from the captured block's last entry to its docking.
    pub docking: u64,
    /// Which body was captured: the number of a free block, from 0.
    pub body: u32,
    /// Where it came from.
    pub origin: Origin,
}

/// A capture that had not happened when the run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WaitRecord {
    /// In which phase.
    pub phase: PhaseId,
    /// The role that magnetized a face.
    pub parent: RoleId,
    /// Which, in the structure's frame.
    pub face: Face,
    /// The role that the captured block would have been given.
    pub child: RoleId,
    /// Where it would have sat.
    pub cell: Cell,
    /// Tick at which the face was magnetized; the censored wait is from there to the end of the run.
    pub magnetized: u64,
    /// Times that a free block came into the reach of the pull, re-entries included.
    pub entries: u32,
}

/// A block was let go.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReleaseRecord {
    /// In which phase.
    pub phase: PhaseId,
    /// The role that let it go.
    pub parent: RoleId,
    /// The role that it had.
    pub child: RoleId,
    /// When.
    pub tick: u64,
    /// Which body it is: the number of a free block, from 0.
    pub body: u32,
}

/// A block docked where nobody expected it, and was rejected at once.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnplannedRecord {
    /// In which phase.
    pub phase: PhaseId,
    /// The role of the block on which it docked.
    pub parent: RoleId,
    /// On which of its faces, in the structure's frame.
    pub face: Face,
    /// When.
    pub tick: u64,
    /// Which body it is: the number of a free block, from 0.
    pub body: u32,
}

/// Where a captured block came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// It had never been captured.
    Free,
    /// It was part of the structure before.
    Released {
        /// The role it had last.
        role: RoleId,
        /// The tick of its release.
        tick: u64,
    },
}

/// With a name for its kind, which only formats for humans can look at before they read the rest.
#[derive(Serialize)]
#[serde(remote = "Origin", rename_all = "snake_case", tag = "kind")]
enum NamedOrigin {
    Free,
    Released { role: RoleId, tick: u64 },
}

/// The same as it is read: field by field, since whoever reads the kind first has to keep the others meanwhile.
#[derive(Deserialize)]
struct OriginFields {
    kind: OriginKind,
    role: Option<RoleId>,
    tick: Option<u64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum OriginKind {
    Free,
    Released,
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Origin")]
enum NumberedOrigin {
    Free,
    Released { role: RoleId, tick: u64 },
}

impl Serialize for Origin {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        if to.is_human_readable() {
            NamedOrigin::serialize(self, to)
        } else {
            NumberedOrigin::serialize(self, to)
        }
    }
}

impl<'de> Deserialize<'de> for Origin {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Origin, D::Error> {
        if from.is_human_readable() {
            let OriginFields { kind, role, tick } = OriginFields::deserialize(from)?;
            let missing = <D::Error as serde::de::Error>::missing_field;
            Ok(match kind {
                OriginKind::Free => Origin::Free,
                OriginKind::Released => Origin::Released {
                    role: role.ok_or_else(|| missing("role"))?,
                    tick: tick.ok_or_else(|| missing("tick"))?,
                },
            })
        } else {
            NumberedOrigin::deserialize(from)
        }
    }
}
