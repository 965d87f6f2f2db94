//! Observer that writes a recording during a run.
use std::io::{self, BufWriter, Read, Write};

use stochc_files::atomic::Draft;
use stochc_files::budget::RECORDING_PART;
use stochc_ir::record::RunRecord;
use stochc_ir::state::{StateError, StateReader, StateWriter};
use stochc_ir::table::Tables;
use stochc_runtime::observe::{EventRows, ObservedEvent, Observer};
use stochc_runtime::world::SpatialWorld;
use stochc_runtime::world::view::pose;

use super::chunk::{NUMBERS, PoseChunk, unpacked};
use super::format::{DONE, EVENTS, POSES, RecordingHeader, deflate, write_header, write_section};

/// Largest number of values per chunk, about 2 MB.
const ENOUGH: usize = 1 << 19;
/// Smallest number of ticks per chunk. Fewer ticks compress badly.
const FEWEST_TICKS: usize = 16;
/// Largest number of ticks per chunk.
const MAX_TICKS: usize = 512;

/// Largest number of events per section. An event has less than 128 bytes, which keeps a section
/// within its size limit.
const MAX_EVENTS: usize = 1 << 20;

/// Output of a recording.
pub trait Output: Write {
    /// Returns the number of bytes written so far, and a reader of these bytes.
    ///
    /// # Errors
    ///
    /// Errors of the file system. Also if the output cannot be read.
    fn written(&self) -> io::Result<(u64, Box<dyn Read>)> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Removes all bytes of the output.
    ///
    /// # Errors
    ///
    /// The errors of [`Output::written`].
    fn rewind(&mut self) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }
}

impl Output for Draft {
    fn written(&self) -> io::Result<(u64, Box<dyn Read>)> {
        let file = Draft::written(self)?;
        Ok((file.metadata()?.len(), Box::new(file)))
    }

    fn rewind(&mut self) -> io::Result<()> {
        Draft::rewind(self)
    }
}

/// Anonymous file, for runs without checkpoints.
impl Output for BufWriter<std::fs::File> {}

/// Observer that records a run.
pub struct Recorder<W: Output> {
    out: W,
    every: u64,
    bodies: usize,
    seeds: EventRows,
    ticks: Vec<u64>,
    poses: Vec<f32>,
    rows: Vec<serde_json::Value>,
    /// First error of writing. `None` if there was none.
    broken: Option<io::Error>,
}

impl<W: Output> Recorder<W> {
    /// Begins a recording. [`Recorder::finish`] ends it.
    ///
    /// # Errors
    ///
    /// Errors of `out`.
    pub fn new(mut out: W, header: &RecordingHeader, tables: &Tables) -> io::Result<Recorder<W>> {
        write_header(&mut out, header)?;
        out.flush()?;
        Ok(Recorder {
            out,
            every: header.every.max(1).into(),
            bodies: header.bodies as usize,
            seeds: EventRows::new(tables),
            ticks: Vec::new(),
            poses: Vec::new(),
            rows: Vec::new(),
            broken: None,
        })
    }

    /// Writes the data not yet written, and the record of the run.
    ///
    /// # Errors
    ///
    /// The first error of `out` since the beginning.
    pub fn finish(mut self, record: &RunRecord) -> io::Result<W> {
        if let Some(error) = self.broken {
            return Err(error);
        }
        self.write_chunk()?;
        let json = serde_json::to_vec(record)?;
        write_section(&mut self.out, DONE, &deflate(&json)?)?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn is_full(&self) -> bool {
        let ticks = self.ticks.len();
        let next = unpacked(self.bodies as u32, ticks as u32 + 1);
        ticks >= MAX_TICKS
            || (self.poses.len() >= ENOUGH && ticks >= FEWEST_TICKS)
            || next > RECORDING_PART
            || self.rows.len() >= MAX_EVENTS
    }

    /// Writes the collected events, then the positions at the same ticks.
    fn write_chunk(&mut self) -> io::Result<()> {
        if !self.rows.is_empty() {
            let json = serde_json::to_vec(&self.rows)?;
            write_section(&mut self.out, EVENTS, &deflate(&json)?)?;
            self.rows.clear();
        }
        if !self.ticks.is_empty() {
            let ticks = std::mem::take(&mut self.ticks);
            let chunk = PoseChunk::quantize(ticks, &self.poses, self.bodies);
            write_section(&mut self.out, POSES, &chunk.to_bytes()?)?;
            self.poses.clear();
        }
        // Readers of the unfinished file can then see the chunk.
        self.out.flush()
    }
}

impl<W: Output> Observer for Recorder<W> {
    fn look(&mut self, arena: &impl SpatialWorld, events: &[ObservedEvent]) {
        if self.broken.is_some() {
            return;
        }
        let tick = arena.tick();
        self.rows
            .extend(events.iter().map(|event| self.seeds.row(tick, event)));
        // Displays interpolate linearly between frames. Notable events therefore need a frame at
        // their tick.
        let is_notable = events.iter().any(|event| {
            matches!(
                event,
                ObservedEvent::Captured { .. }
                    | ObservedEvent::Unplanned { .. }
                    | ObservedEvent::Released { .. }
                    | ObservedEvent::Reported { .. }
            )
        });
        if !is_notable && !tick.is_multiple_of(self.every) {
            return;
        }
        self.ticks.push(tick);
        self.poses.reserve(self.bodies * NUMBERS);
        for id in 0..self.bodies as u32 {
            self.poses.extend(pose(arena, id));
        }
        if self.is_full()
            && let Err(error) = self.write_chunk()
        {
            self.broken = Some(error);
        }
    }

    fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
        // After an error, writing stops, also in a resumed run.
        to.put(&(self.every, self.broken.is_some()))?;
        if self.broken.is_some() {
            return Ok(());
        }
        to.put(&self.ticks)?;
        to.put(&self.poses)?;
        to.put(&serde_json::to_string(&self.rows).map_err(io::Error::from)?)?;
        let (length, written) = self.out.written()?;
        to.copy(length, written)
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        let (every, is_broken): (u64, bool) = from.take()?;
        if self.every != every {
            return Err(io::Error::other("its recording is of other ticks").into());
        }
        if is_broken {
            self.broken = Some(io::Error::other(
                "it could not be kept before the run was stopped",
            ));
            return Ok(());
        }
        self.ticks = from.take()?;
        self.poses = from.take()?;
        let rows: String = from.take()?;
        self.rows = serde_json::from_str(&rows).map_err(io::Error::from)?;
        self.out.rewind()?;
        from.copy(&mut self.out)?;
        Ok(self.out.flush()?)
    }
}
