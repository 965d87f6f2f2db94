//! Reads and validates recordings.
use std::io::Read;

use serde::Deserializer as _;
use serde::de::{Error as _, SeqAccess, Visitor};
use serde_json::value::RawValue;
use stochc_files::budget::{self, RECORDING_EVENT, RECORDING_PART, RECORDING_WHOLE};
use stochc_ir::record::RunRecord;
use stochc_ir::table::Tables;
use stochc_runtime::observe::{EventRows, TimedEvent};

use super::chunk::PoseChunk;
use super::format::{
    DONE, EVENTS, POSES, RecordingError, RecordingHeader, inflate, read_header, read_section,
};
use crate::records::RecordValidator;
use crate::{Finished, Manifest};

/// Header of a recording, and the record of its run.
#[derive(Clone, Debug)]
pub struct Outline {
    header: RecordingHeader,
    record: RunRecord,
}

/// Recording in memory: events, and positions in chunks.
#[derive(Clone, Debug)]
pub struct Recording {
    outline: Outline,
    chunks: Vec<PoseChunk>,
    events: Vec<TimedEvent>,
}

/// Item of a recording that is being read.
enum Content {
    Places(PoseChunk),
    Event(TimedEvent),
}

/// Positions of all blocks at a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Tick of the positions.
    pub tick: u64,
    /// Position of each block: x, y, z \[block lengths\], and the quaternion x, y, z, w from block
    /// to structure axes.
    pub poses: Vec<[f64; 7]>,
}

impl Outline {
    /// Reads and validates a recording of a program with these `tables`, part by part.
    ///
    /// # Errors
    ///
    /// If the recording is invalid, of another version, truncated or corrupted.
    pub fn read(from: impl Read, tables: &Tables) -> Result<Outline, RecordingError> {
        walk(from, tables, &mut |_, _| Ok(()))
    }

    /// Returns the record of the run.
    pub fn record(&self) -> &RunRecord {
        &self.record
    }

    /// Returns whether this recording is of run `run` of `program` in an ensemble. `known` is the
    /// stored record of this run. If `known` is `None`, any valid record is accepted.
    pub fn is_of(
        &self,
        manifest: &Manifest,
        known: Option<&Finished>,
        program: usize,
        run: u64,
    ) -> bool {
        self.header.ensemble == manifest.identity()
            && (self.header.program, self.header.run) == (program, run)
            && match known {
                Some(known) => known.record == self.record,
                None => {
                    let validator = RecordValidator::new(manifest);
                    validator.inconsistency(program, &self.record).is_none()
                }
            }
    }
}

/// Positions of all blocks at a tick, borrowed from a recording.
#[derive(Clone, Copy, Debug)]
pub struct Places<'a> {
    chunk: &'a PoseChunk,
    frame: usize,
    bodies: usize,
}

impl Places<'_> {
    /// Returns the tick of the positions.
    pub fn tick(&self) -> u64 {
        self.chunk.ticks[self.frame]
    }

    /// Returns the number of blocks that were free at the start. They are numbered from 0.
    pub fn bodies(&self) -> usize {
        self.bodies
    }

    /// Returns x, y and z of a block from the centre of the plate's upper side \[block lengths\].
    pub fn pose(&self, body: usize) -> [f64; 3] {
        let [x, y, z, ..] = self.chunk.pose(body, self.frame, self.bodies);
        [x, y, z]
    }
}

/// Calls `each` with the positions at each frame of a recording, in order of time. Only a part of
/// them is in memory. Corruption may be detected only at the end.
///
/// # Errors
///
/// The errors of [`Outline::read`].
pub fn each_places(
    from: impl Read,
    tables: &Tables,
    each: &mut dyn FnMut(&Places<'_>),
) -> Result<Outline, RecordingError> {
    let mut last = None;
    walk(from, tables, &mut |header, content| {
        let Content::Places(chunk) = content else {
            return Ok(());
        };
        if last > chunk.ticks.first().copied() {
            return Err(RecordingError::Corrupted(
                "its places are not in the order of time",
            ));
        }
        last = chunk.ticks.last().copied();
        for frame in 0..chunk.ticks.len() {
            let bodies = header.bodies as usize;
            each(&Places {
                chunk: &chunk,
                frame,
                bodies,
            });
        }
        Ok(())
    })
}

/// Reads a recording and calls `each` with its items in order.
fn walk(
    mut from: impl Read,
    tables: &Tables,
    each: &mut dyn FnMut(&RecordingHeader, Content) -> Result<(), RecordingError>,
) -> Result<Outline, RecordingError> {
    let header = read_header(&mut from)?;
    let seeds = EventRows::new(tables);
    let most = budget::record(tables.captures() as u64);
    // Tick of the last positions, and of the last item of any kind.
    let (mut last, mut latest) = (None, 0);
    loop {
        let Some((tag, payload)) = read_section(&mut from, most.max(RECORDING_PART))? else {
            return Err(RecordingError::CutShort(last));
        };
        match tag {
            POSES => {
                let chunk = PoseChunk::from_bytes(&payload, header.bodies)?;
                last = chunk.ticks.last().copied();
                latest = latest.max(last.unwrap_or(0));
                each(&header, Content::Places(chunk))?;
            }
            EVENTS => {
                const EVENT_LIST: &str = "its events";
                let json = inflate(&payload, RECORDING_PART, EVENT_LIST)?;
                let mut broken = None;
                let mut row = |row: &RawValue| {
                    let event = seeds.event(row)?;
                    latest = latest.max(event.tick);
                    each(&header, Content::Event(event))
                        .map_err(|error| broken = Some(error))
                        .ok()
                };
                let mut rows = serde_json::Deserializer::from_slice(&json);
                let read = rows
                    .deserialize_seq(EventListVisitor(&mut row))
                    .and_then(|()| rows.end());
                match (read, broken) {
                    (Ok(()), _) => {}
                    (Err(_), Some(error)) => return Err(error),
                    (Err(_), None) => return Err(RecordingError::Corrupted(EVENT_LIST)),
                }
            }
            DONE => {
                const RECORD: &str = "its record";
                let json = inflate(&payload, most, RECORD)?;
                let record: RunRecord =
                    serde_json::from_slice(&json).map_err(|_| RecordingError::Corrupted(RECORD))?;
                if latest > record.ticks {
                    return Err(RecordingError::Corrupted("something happens after its end"));
                }
                if from.read(&mut [0])? > 0 {
                    return Err(RecordingError::Corrupted("something follows its end"));
                }
                return Ok(Outline { header, record });
            }
            _ => return Err(RecordingError::Corrupted("a part of an unknown kind")),
        }
    }
}

/// Visitor that processes the elements of a list one by one. The closure returns `None` for an
/// invalid element.
struct EventListVisitor<'a>(&'a mut dyn FnMut(&RawValue) -> Option<()>);

impl<'de> Visitor<'de> for EventListVisitor<'_> {
    type Value = ();

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a list of events")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut rows: A) -> Result<(), A::Error> {
        while let Some(row) = rows.next_element::<&RawValue>()? {
            if row.get().len() > RECORDING_EVENT || (self.0)(row).is_none() {
                return Err(A::Error::custom("no event"));
            }
        }
        Ok(())
    }
}

impl Recording {
    /// Reads a recording of a program with these `tables` into memory.
    ///
    /// # Errors
    ///
    /// The errors of [`Outline::read`]. Also if the recording is too large.
    pub fn read(from: impl Read, tables: &Tables) -> Result<Recording, RecordingError> {
        let (mut chunks, mut events, mut size) = (Vec::new(), Vec::new(), 0);
        let outline = walk(from, tables, &mut |_, content| {
            size += match &content {
                Content::Places(chunk) => chunk.numbers.len() * 2 + chunk.ticks.len() * 8,
                Content::Event(_) => size_of::<TimedEvent>(),
            } as u64;
            match content {
                _ if size > RECORDING_WHOLE => return Err(RecordingError::TooLarge),
                Content::Places(chunk) => chunks.push(chunk),
                Content::Event(event) => events.push(event),
            }
            Ok(())
        })?;
        Ok(Recording {
            outline,
            chunks,
            events,
        })
    }

    /// Returns the header of the recording.
    pub fn header(&self) -> &RecordingHeader {
        &self.outline.header
    }

    /// Returns all events in order.
    pub fn events(&self) -> &[TimedEvent] {
        &self.events
    }

    /// Returns the record of the run.
    pub fn record(&self) -> &RunRecord {
        &self.outline.record
    }

    /// Returns all frames in order of time.
    pub fn frames(&self) -> impl Iterator<Item = Frame> + '_ {
        let bodies = self.header().bodies as usize;
        self.chunks.iter().flat_map(move |chunk| {
            chunk
                .ticks
                .iter()
                .enumerate()
                .map(move |(frame, &tick)| Frame {
                    tick,
                    poses: (0..bodies)
                        .map(|body| chunk.pose(body, frame, bodies))
                        .collect(),
                })
        })
    }
}
