//! Record of one run.
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::table::{PhaseId, RoleId};
use crate::{Cell, Face};

/// Record of one run. It depends only on (tables, scene, settings, seed, run).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    /// Number of the run in its ensemble, from 0.
    pub run: u64,
    /// Outcome of the run.
    pub outcome: Outcome,
    /// Duration of the run \[ticks\].
    pub ticks: u64,
    /// Duration of each completed phase \[ticks\]. 0 for a pre-attached phase. For an aggregate,
    /// the time to the first bond, then the time from each size to the next.
    pub phase_ticks: Vec<u64>,
    /// Number of distinct blocks captured. For an aggregate, the size of the largest group.
    pub blocks_used: u32,
    /// Number of message hops between parents and children.
    pub hops: u64,
    /// Number of captures at faces that expected none, which were rejected at once. 0 if faces must
    /// be switched on to capture.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub unplanned: u64,
    /// Captures in order.
    pub bonds: Vec<BondRecord>,
    /// Faces that were open at the end, sorted by the start of their waiting times. These times are
    /// right-censored.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waiting: Vec<WaitRecord>,
    /// Releases in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub releases: Vec<ReleaseRecord>,
    /// Captures counted by [`unplanned`](RunRecord::unplanned), in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unplanned_bonds: Vec<UnplannedRecord>,
    /// Aborted attempts at phases, in order. Their captures, waits and releases are not in the other
    /// lists.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub aborts: Vec<AbortRecord>,
    /// Captures that a hardware fault of the scene prevented, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<FaultRecord>,
}

impl RunRecord {
    /// Returns a record without captures.
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
            aborts: Vec::new(),
            faults: Vec::new(),
        }
    }

    /// Returns the number of captures that a kind of fault prevented.
    pub fn faults_of(&self, kind: FaultKind) -> usize {
        self.faults.iter().filter(|it| it.kind == kind).count()
    }

    /// Returns the number of times that a phase was begun again.
    pub fn retries(&self, phase: PhaseId) -> u64 {
        let retried = |abort: &&AbortRecord| abort.phase == phase && abort.retried.is_some();
        self.aborts.iter().filter(retried).count() as u64
    }

    /// Returns the tick of the last retry of a phase. Returns `None` if it was not retried.
    pub fn last_retry(&self, phase: PhaseId) -> Option<u64> {
        let aborts = self.aborts.iter().rev();
        aborts
            .filter(|it| it.phase == phase)
            .find_map(|it| it.retried)
    }

    /// Returns all captures in order, including those of aborted attempts.
    pub fn all_bonds(&self) -> impl Iterator<Item = &BondRecord> {
        in_order(
            &self.bonds,
            &self.aborts,
            |abort| &abort.bonds,
            |bond| bond.docked,
        )
    }

    /// Returns all releases in order, including those of aborted attempts.
    pub fn all_releases(&self) -> impl Iterator<Item = &ReleaseRecord> {
        in_order(
            &self.releases,
            &self.aborts,
            |abort| &abort.releases,
            |it| it.tick,
        )
    }

    /// Returns all waiting times without a capture, each with the tick of its end.
    pub fn all_waiting(&self) -> impl Iterator<Item = (&WaitRecord, u64)> {
        let aborted = self.aborts.iter();
        let aborted = aborted.flat_map(|it| it.waiting.iter().map(|wait| (wait, it.tick)));
        aborted.chain(self.waiting.iter().map(|wait| (wait, self.ticks)))
    }
}

/// Returns the items of a run and of its aborted attempts in the order of their ticks.
fn in_order<'a, T>(
    items: &'a [T],
    aborts: &'a [AbortRecord],
    of: impl Fn(&'a AbortRecord) -> &'a Vec<T>,
    tick: impl Fn(&T) -> u64,
) -> impl Iterator<Item = &'a T> {
    let mut all: Vec<&T> = items.iter().chain(aborts.iter().flat_map(of)).collect();
    if !aborts.is_empty() {
        all.sort_by_key(|item| tick(item));
    }
    all.into_iter()
}

/// Attempt at a phase that reached its timeout. All its captures were released, children first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AbortRecord {
    /// Phase of the attempt.
    pub phase: PhaseId,
    /// Start of the attempt \[ticks\].
    pub began: u64,
    /// Tick of the timeout.
    pub tick: u64,
    /// Start of the next attempt \[ticks\]. `None` if the run ended before.
    pub retried: Option<u64>,
    /// Captures in order.
    pub bonds: Vec<BondRecord>,
    /// Faces that were open at the timeout. Their waiting times are right-censored.
    pub waiting: Vec<WaitRecord>,
    /// Releases in order.
    pub releases: Vec<ReleaseRecord>,
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a reference"
)]
fn is_zero(number: &u64) -> bool {
    *number == 0
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde asks for a reference"
)]
const fn is_false(value: &bool) -> bool {
    !*value
}

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Outcome {
    /// Every phase was reported complete.
    Completed,
    /// A phase reached its timeout, or the run reached its tick limit. The time is right-censored.
    TimedOut {
        /// Phase that did not end.
        phase: PhaseId,
        /// Limit that was reached.
        by: Limit,
    },
    /// The computation failed, or the structure broke.
    Failed {
        /// Phase of the failure.
        phase: PhaseId,
        /// Description of the failure, with the block.
        reason: String,
        /// Whether the structure broke, so that it never completes. Otherwise, the computation
        /// failed, and the time is meaningless.
        #[serde(default, skip_serializing_if = "is_false")]
        is_broken: bool,
    },
}

impl Outcome {
    /// Returns whether the computation failed, so that the record shows nothing about the program.
    pub const fn is_invalid(&self) -> bool {
        matches!(
            self,
            Outcome::Failed {
                is_broken: false,
                ..
            }
        )
    }

    /// Returns whether the structure broke, so that the run never completes.
    pub const fn is_broken(&self) -> bool {
        matches!(
            self,
            Outcome::Failed {
                is_broken: true,
                ..
            }
        )
    }
}

/// Limit that stops a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// Timeout of the phase in the program.
    Timeout,
    /// Tick limit of the whole run, `Settings::max_ticks`.
    MaxTicks,
}

impl Limit {
    /// Returns the limit that stops a run at this tick. `is_late` states whether the phase has
    /// timed out. Returns `None` if the run continues.
    pub fn reached(is_late: bool, tick: u64, max_ticks: Option<u64>) -> Option<Limit> {
        if is_late {
            return Some(Limit::Timeout);
        }
        max_ticks
            .is_some_and(|limit| tick >= limit)
            .then_some(Limit::MaxTicks)
    }
}

/// Record of a capture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BondRecord {
    /// Phase of the capture.
    pub phase: PhaseId,
    /// Role of the capturing block.
    pub parent: RoleId,
    /// Capturing face, in the structure's frame.
    pub face: Face,
    /// Role of the captured block.
    pub child: RoleId,
    /// Cell of the captured block.
    pub cell: Cell,
    /// Tick when the face was magnetized.
    pub magnetized: u64,
    /// Tick of the capture. The waiting time is `docked - magnetized`.
    pub docked: u64,
    /// Number of entries of free blocks into the reach of the pull, including re-entries.
    pub entries: u32,
    /// Time from the captured block's last entry to its capture \[ticks\].
    pub docking: u64,
    /// Number of the captured block, from 0.
    pub body: u32,
    /// Origin of the captured block.
    pub origin: Origin,
}

/// Waiting time that was in progress when the run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WaitRecord {
    /// Phase of the wait.
    pub phase: PhaseId,
    /// Role of the parent, which has the open face.
    pub parent: RoleId,
    /// Open face, in the structure's frame.
    pub face: Face,
    /// Role of the expected block.
    pub child: RoleId,
    /// Cell of the expected block.
    pub cell: Cell,
    /// Tick when the face was magnetized. The right-censored waiting time lasts from then to the
    /// end of the run.
    pub magnetized: u64,
    /// Number of entries of free blocks into the reach of the pull, including re-entries.
    pub entries: u32,
}

/// Record of a release.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReleaseRecord {
    /// Phase of the release.
    pub phase: PhaseId,
    /// Role of the former parent.
    pub parent: RoleId,
    /// Role of the released block.
    pub child: RoleId,
    /// Tick of the release.
    pub tick: u64,
    /// Number of the released block, from 0.
    pub body: u32,
}

/// Capture at a face that expected none. The block was rejected at once.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct UnplannedRecord {
    /// Phase of the capture.
    pub phase: PhaseId,
    /// Role of the capturing block.
    pub parent: RoleId,
    /// Capturing face, in the structure's frame.
    pub face: Face,
    /// Tick of the capture.
    pub tick: u64,
    /// Number of the captured block, from 0.
    pub body: u32,
}

/// Capture that a hardware fault prevented.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FaultRecord {
    /// Phase of the capture.
    pub phase: PhaseId,
    /// Role that the block would have had.
    pub child: RoleId,
    /// Tick of the capture.
    pub tick: u64,
    /// Number of the block, from 0.
    pub body: u32,
    /// Kind of the fault.
    pub kind: FaultKind,
}

/// Kind of a hardware fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// The block is dead. It stays until its face is switched off.
    Dead,
    /// The latch failed. The block was released at once.
    Latch,
}

/// Origin of a captured block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The block had never been captured.
    Free,
    /// The block was part of the structure before.
    Released {
        /// Last role of the block.
        role: RoleId,
        /// Tick of the block's release.
        tick: u64,
    },
}

/// Serialized form with a tag, for formats such as JSON.
#[derive(Serialize)]
#[serde(remote = "Origin", rename_all = "snake_case", tag = "kind")]
enum NamedOrigin {
    Free,
    Released { role: RoleId, tick: u64 },
}

/// Serialized form that is read field by field. A form with a tag would have to buffer the other
/// fields.
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
