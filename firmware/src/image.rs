//! Program image: the bytes that the interpreter reads.
use stochc_ir::table::{Action, Phase, Rule, Tables};
use thiserror::Error;

use crate::encode::Encoder;
use crate::nodes::Nodes;
use crate::sizes::Sizes;

/// Version of the format of an image, without and with retries.
const FORMATS: [u8; 2] = [1, 2];
/// Length of the header before the table of phases \[bytes\].
const HEADER: usize = 10;
/// Length of the record of a phase \[bytes\], by format.
const PHASES: [usize; 2] = [2, 14];

/// A program in the format of the interpreter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// All bytes of the program.
    pub bytes: Vec<u8>,
    /// Numbers that bound the memory of a block.
    pub sizes: Sizes,
}

/// Reason why a program has no firmware.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Unsupported {
    /// The program is an aggregate.
    #[error("the blocks of an aggregate have no rules, so they need no firmware")]
    Aggregate,
    /// The timeout of a phase or its pause before a retry is too long.
    #[error(
        "phase `{0}` has a timeout or a pause before a retry above 4,294,967,295 ticks, which firmware does not support"
    )]
    Recovery(String),
    /// A phase contains a time.
    #[error("phase `{0}` waits for a time, which firmware does not support yet")]
    Time(String),
    /// The program has too many phases.
    #[error("the program has {0} phases, and firmware supports 255")]
    Phases(usize),
    /// The program has too many roles.
    #[error("the program has {0} names of blocks, and firmware supports 16,383")]
    Roles(usize),
    /// A block has too many rules in a phase.
    #[error("block `{role}` has {count} rules in phase `{phase}`, and firmware supports 255")]
    Rules {
        /// Name of the block.
        role: String,
        /// Name of the phase.
        phase: String,
        /// Number of rules.
        count: usize,
    },
    /// A block has too many observations in a phase.
    #[error("block `{role}` observes {count} events in phase `{phase}`, and firmware supports 127")]
    Observations {
        /// Name of the block.
        role: String,
        /// Name of the phase.
        phase: String,
        /// Number of observations.
        count: usize,
    },
    /// The program is too large.
    #[error("the program takes {0} bytes, and firmware supports 65,535")]
    Bytes(usize),
    /// A phase needs too many reports.
    #[error("phase `{phase}` needs {count} reports, and firmware supports 65,535")]
    Reports {
        /// Name of the phase.
        phase: String,
        /// Number of reports.
        count: u32,
    },
}

impl Image {
    /// Encodes tables.
    ///
    /// # Errors
    ///
    /// If the program exceeds a limit of the interpreter, or has no rules.
    pub fn new(tables: &Tables) -> Result<Image, Unsupported> {
        if tables.aggregate.is_some() {
            return Err(Unsupported::Aggregate);
        }
        if let Some(phase) = timed_phase(tables) {
            return Err(Unsupported::Time(phase.name.clone()));
        }
        let (phases, roles) = (tables.phases.len(), tables.roles.len());
        let phase_count = u8::try_from(phases).map_err(|_| Unsupported::Phases(phases))?;
        if roles >= 1 << 14 {
            return Err(Unsupported::Roles(roles));
        }
        let seeds = tables.seeds().count();
        let nodes = Nodes::new(tables);
        let has_retries = tables.phases.iter().any(|it| it.recovery.is_some());
        let format = usize::from(has_retries);
        let mut bytes = vec![0, 0, FORMATS[format], phase_count];
        push_word(&mut bytes, roles);
        push_word(&mut bytes, seeds);
        push_word(&mut bytes, HEADER + phases * PHASES[format]);
        debug_assert_eq!(bytes.len(), HEADER);
        for (number, phase) in (0..).zip(&tables.phases) {
            let reports = reports(phase, nodes.pre_attached(number));
            let reports = u16::try_from(reports).map_err(|_| Unsupported::Reports {
                phase: phase.name.clone(),
                count: reports,
            })?;
            bytes.extend(reports.to_le_bytes());
            if has_retries {
                push_recovery(&mut bytes, phase)?;
            }
        }
        let mut encoder = Encoder::new(tables, &nodes);
        let mut at = bytes.len() + 2 * roles;
        let mut records = Vec::new();
        let mut largest = Vec::new();
        for role in 0..roles {
            push_word(&mut bytes, at + records.len());
            let start = records.len();
            encoder.role(role as u32, &mut records)?;
            largest.push((records.len() - start, role));
        }
        at = bytes.len();
        bytes.extend(records);
        if bytes.len() > usize::from(u16::MAX) {
            return Err(Unsupported::Bytes(bytes.len()));
        }
        let identity = crc16(&bytes[2..]);
        bytes[..2].copy_from_slice(&identity.to_le_bytes());
        largest.sort_by_key(|&(size, role)| (std::cmp::Reverse(size), role));
        let name = |&(size, role): &(usize, usize)| (tables.roles[role].name.clone(), size);
        let sizes = Sizes {
            seeds,
            index: at,
            largest: largest.iter().take(3).map(name).collect(),
            ..encoder.sizes()
        };
        Ok(Image { bytes, sizes })
    }

    /// Returns the number that identifies the program in every frame.
    pub fn identity(&self) -> u16 {
        u16::from_le_bytes([self.bytes[0], self.bytes[1]])
    }
}

/// Returns the number of reports that end a phase. Every pre-attached block makes an additional
/// report, because the plate waits for them.
fn reports(phase: &Phase, pre_attached: usize) -> u32 {
    phase.reports + pre_attached as u32
}

/// Writes how a phase is retried. Zeros state that it is not.
fn push_recovery(bytes: &mut Vec<u8>, phase: &Phase) -> Result<(), Unsupported> {
    let timeout = phase.timeout.unwrap_or_default();
    let (retries, reports, timeout, pause) = match phase.recovery {
        Some(it) => (it.retries, it.reports, timeout, it.pause),
        None => (0, 0, 0, 0),
    };
    let ticks = |ticks| u32::try_from(ticks).map_err(|_| Unsupported::Recovery(phase.name.clone()));
    let reports = u16::try_from(reports).map_err(|_| Unsupported::Reports {
        phase: phase.name.clone(),
        count: reports,
    })?;
    // Programs have at most 1,000 retries.
    bytes.extend(u16::try_from(retries).unwrap_or(u16::MAX).to_le_bytes());
    bytes.extend(reports.to_le_bytes());
    bytes.extend(ticks(timeout)?.to_le_bytes());
    bytes.extend(ticks(pause)?.to_le_bytes());
    Ok(())
}

fn push_word(bytes: &mut Vec<u8>, value: usize) {
    bytes.extend((value as u16).to_le_bytes());
}

/// Returns the CRC-16/CCITT-FALSE checksum.
fn crc16(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0xFFFF, |sum, &byte| {
        (0..8).fold(sum ^ (u16::from(byte) << 8), |sum: u16, _| {
            if sum & 0x8000 == 0 {
                sum << 1
            } else {
                (sum << 1) ^ 0x1021
            }
        })
    })
}

/// Returns a phase with `wait`, or with a delayed release.
fn timed_phase(tables: &Tables) -> Option<&Phase> {
    let is_late = |rule: Rule<'_>| matches!(rule.then, Action::AskReleaseLater(_));
    let mut duties = tables.duties();
    let late = duties.find(|duty| duty.rules().any(is_late));
    let late = late.map(|duty| &tables.phases[duty.phase.0 as usize]);
    late.or_else(|| tables.phases.iter().find(|phase| phase.wait > 0))
}
