//! Reading recordings.
use std::io::Read;

use stochc_ir::record::RunRecord;
use stochc_ir::table::Tables;

use super::chunk::Chunk;
use super::events::{Happening, Seeds};
use crate::{Finished, Manifest};

use super::format::{
    DONE, EVENTS, Header, POSES, RecordingError, inflate, read_header, read_section,
};

/// More bytes of events than this are not read at once.
const LARGEST: u64 = 1 << 30;

/// A whole recording: its events, and its places in chunks.
#[derive(Clone, Debug)]
pub struct Recording {
    header: Header,
    version: u32,
    chunks: Vec<Chunk>,
    events: Vec<Happening>,
    record: RunRecord,
}

/// Where all blocks were at a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// When.
    pub tick: u64,
    /// For each block x, y, z \[side\] and the quaternion x, y, z, w, which takes its own
    /// directions to the structure's.
    pub places: Vec<[f64; 7]>,
}

impl Recording {
    /// Reads all of a recording of a program with these `tables`.
    ///
    /// # Errors
    /// When it is none, of another version, cut short or damaged.
    pub fn read(mut from: impl Read, tables: &Tables) -> Result<Recording, RecordingError> {
        let (header, version) = read_header(&mut from)?;
        let seeds = Seeds::of(tables);
        let (mut chunks, mut events): (Vec<Chunk>, Vec<Happening>) = (Vec::new(), Vec::new());
        loop {
            let Some((tag, payload)) = read_section(&mut from, version)? else {
                let last = chunks.last().and_then(|chunk| chunk.ticks.last());
                return Err(RecordingError::CutShort(last.copied()));
            };
            match tag {
                POSES => chunks.push(Chunk::from_bytes(&payload, header.bodies)?),
                EVENTS => {
                    let damaged = || RecordingError::Damaged("its events");
                    let json = inflate(&payload, LARGEST).ok_or_else(damaged)?;
                    let rows: Vec<serde_json::Value> =
                        serde_json::from_slice(&json).map_err(|_| damaged())?;
                    for row in &rows {
                        events.push(seeds.event(row).ok_or_else(damaged)?);
                    }
                }
                DONE => {
                    let damaged = || RecordingError::Damaged("its record");
                    let json = inflate(&payload, LARGEST).ok_or_else(damaged)?;
                    let record: RunRecord = serde_json::from_slice(&json).map_err(|_| damaged())?;
                    let ticks = chunks.iter().flat_map(|chunk| chunk.ticks.iter().copied());
                    let mut ticks = ticks.chain(events.iter().map(|event| event.tick));
                    if ticks.any(|tick| tick > record.ticks) {
                        return Err(RecordingError::Damaged("something happens after its end"));
                    }
                    if version > 1 && from.read(&mut [0])? > 0 {
                        return Err(RecordingError::Damaged("something follows its end"));
                    }
                    return Ok(Recording {
                        header,
                        version,
                        chunks,
                        events,
                        record,
                    });
                }
                _ => return Err(RecordingError::Damaged("a part of an unknown kind")),
            }
        }
    }

    /// What it is of.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The version of its format.
    pub fn version(&self) -> u32 {
        self.version
    }

    /// Whether it is that of a run of an ensemble, of which these runs are finished.
    pub fn is_of(
        &self,
        manifest: &Manifest,
        finished: &[Finished],
        program: usize,
        run: u64,
    ) -> bool {
        let known = (finished.iter()).find(|it| it.program == program && it.record.run == run);
        self.header.ensemble == manifest.identity()
            && (self.header.program, self.header.run) == (program, run)
            && known.is_none_or(|known| known.record == self.record)
    }

    /// All that happened, in its order.
    pub fn events(&self) -> &[Happening] {
        &self.events
    }

    /// The record of the run.
    pub fn record(&self) -> &RunRecord {
        &self.record
    }

    /// All places that were kept, in the order of time.
    pub fn frames(&self) -> impl Iterator<Item = Frame> + '_ {
        let bodies = self.header.bodies as usize;
        self.chunks.iter().flat_map(move |chunk| {
            chunk
                .ticks
                .iter()
                .enumerate()
                .map(move |(frame, &tick)| Frame {
                    tick,
                    places: (0..bodies)
                        .map(|body| chunk.place(body, frame, bodies))
                        .collect(),
                })
        })
    }
}
