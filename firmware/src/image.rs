//! Program image: the bytes that the interpreter reads.
use stochc_ir::table::{Action, Phase, Rule, Tables};
use thiserror::Error;

use crate::encode::Encoder;
use crate::nodes::Nodes;
use crate::sizes::Sizes;

/// Version of the format of an image.
const FORMAT: u8 = 3;
/// Length of the header before the table of phases \[bytes\].
const HEADER: usize = 10;
/// Length of the record of a phase \[bytes\].
const PHASE: usize = 18;
/// Longest time \[ticks\]. A block stores the time and 1 in four bytes.
const MAX_TIME: u64 = 4_294_967_294;

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
    /// A time is too long.
    #[error("phase `{0}` has a time above 4,294,967,294 ticks, which firmware does not support")]
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
        let is_long = |rule: Rule<'_>| matches!(rule.then, Action::AskReleaseLater(u32::MAX));
        let mut duties = tables.duties();
        if let Some(duty) = duties.find(|duty| duty.rules().any(is_long)) {
            let phase = &tables.phases[duty.phase.0 as usize];
            return Err(Unsupported::Time(phase.name.clone()));
        }
        let (phases, roles) = (tables.phases.len(), tables.roles.len());
        let phase_count = u8::try_from(phases).map_err(|_| Unsupported::Phases(phases))?;
        if roles >= 1 << 14 {
            return Err(Unsupported::Roles(roles));
        }
        let seeds = tables.seeds().count();
        let nodes = Nodes::new(tables);
        let mut bytes = vec![0, 0, FORMAT, phase_count];
        push_word(&mut bytes, roles);
        push_word(&mut bytes, seeds);
        push_word(&mut bytes, HEADER + phases * PHASE);
        debug_assert_eq!(bytes.len(), HEADER);
        for (number, phase) in (0..).zip(&tables.phases) {
            let reports = reports(phase, nodes.pre_attached(number));
            let reports = u16::try_from(reports).map_err(|_| Unsupported::Reports {
                phase: phase.name.clone(),
                count: reports,
            })?;
            bytes.extend(reports.to_le_bytes());
            push_times(&mut bytes, phase)?;
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

/// Writes the times of a phase, and how it is retried. Zeros state that it has no timeout or retry.
fn push_times(bytes: &mut Vec<u8>, phase: &Phase) -> Result<(), Unsupported> {
    let recovery = phase.recovery;
    let reports = recovery.map_or(0, |it| it.reports);
    let reports = u16::try_from(reports).map_err(|_| Unsupported::Reports {
        phase: phase.name.clone(),
        count: reports,
    })?;
    // Programs have at most 1,000 retries.
    let retries = recovery.map_or(0, |it| u16::try_from(it.retries).unwrap_or(u16::MAX));
    bytes.extend(retries.to_le_bytes());
    bytes.extend(reports.to_le_bytes());
    let pause = recovery.map_or(0, |it| it.pause);
    for time in [phase.timeout.unwrap_or(0), pause, phase.wait] {
        if time > MAX_TIME {
            return Err(Unsupported::Time(phase.name.clone()));
        }
        bytes.extend((time as u32).to_le_bytes());
    }
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
