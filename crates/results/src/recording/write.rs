//! Recording, while a run goes.
use std::io::{self, BufWriter, Read, Write};

use stochc_files::atomic::Draft;
use stochc_files::budget::RECORDING_PART;
use stochc_ir::record::RunRecord;
use stochc_ir::state::{StateError, StateReader, StateWriter};
use stochc_ir::table::Tables;
use stochc_runtime::observe::{ObservedEvent, Observer};
use stochc_runtime::world::Arena;
use stochc_runtime::world::view::pose;

use super::chunk::{NUMBERS, PoseChunk, unpacked};
use super::events::Seeds;
use super::format::{DONE, EVENTS, POSES, RecordingHeader, deflate, write_header, write_section};

/// Numbers to collect before they are written: some 2 MB.
const ENOUGH: usize = 1 << 19;
/// With very many blocks more is collected, because a chunk of few ticks compresses badly.
const FEWEST_TICKS: usize = 16;
/// With very few blocks less.
const MAX_TICKS: usize = 512;

/// Events of a part, so that it keeps to its budget: none has 128 bytes.
const MAX_EVENTS: usize = 1 << 20;

/// Where a recording goes.
pub trait Output: Write {
    /// How many bytes it has, and those.
    ///
    /// # Errors
    /// Those of the file system, and where it cannot be read again.
    fn written(&self) -> io::Result<(u64, Box<dyn Read>)> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Makes it empty.
    ///
    /// # Errors
    /// As of [`Output::written`].
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

/// A file without a name, of a run that is made without a stop.
impl Output for BufWriter<std::fs::File> {}

/// Records the run that it observes.
pub struct Recorder<W: Output> {
    out: W,
    every: u64,
    bodies: usize,
    seeds: Seeds,
    ticks: Vec<u64>,
    places: Vec<f32>,
    rows: Vec<serde_json::Value>,
    /// The first reason why nothing can be written any more.
    broken: Option<io::Error>,
}

impl<W: Output> Recorder<W> {
    /// Begins a recording; [`Recorder::finish`] ends it.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn new(mut out: W, header: &RecordingHeader, tables: &Tables) -> io::Result<Recorder<W>> {
        write_header(&mut out, header)?;
        out.flush()?;
        Ok(Recorder {
            out,
            every: header.every.max(1).into(),
            bodies: header.bodies as usize,
            seeds: Seeds::new(tables),
            ticks: Vec::new(),
            places: Vec::new(),
            rows: Vec::new(),
            broken: None,
        })
    }

    /// Writes what is left, and the record of the run.
    ///
    /// # Errors
    /// The first that `out` had since the beginning.
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
            || (self.places.len() >= ENOUGH && ticks >= FEWEST_TICKS)
            || next > RECORDING_PART
            || self.rows.len() >= MAX_EVENTS
    }

    /// The events come before the places of the same ticks.
    fn write_chunk(&mut self) -> io::Result<()> {
        if !self.rows.is_empty() {
            let json = serde_json::to_vec(&self.rows)?;
            write_section(&mut self.out, EVENTS, &deflate(&json)?)?;
            self.rows.clear();
        }
        if !self.ticks.is_empty() {
            let ticks = std::mem::take(&mut self.ticks);
            let chunk = PoseChunk::quantize(ticks, &self.places, self.bodies);
            write_section(&mut self.out, POSES, &chunk.to_bytes()?)?;
            self.places.clear();
        }
        // For it to be read again.
        self.out.flush()
    }
}

impl<W: Output> Observer for Recorder<W> {
    fn look(&mut self, arena: &impl Arena, events: &[ObservedEvent]) {
        if self.broken.is_some() {
            return;
        }
        let tick = arena.tick();
        self.rows
            .extend(events.iter().map(|event| self.seeds.row(tick, event)));
        // Between two places blocks are shown on a straight line; nothing of note is in between.
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
        self.places.reserve(self.bodies * NUMBERS);
        for id in 0..self.bodies as u32 {
            self.places.extend(pose(arena, id));
        }
        if self.is_full()
            && let Err(error) = self.write_chunk()
        {
            self.broken = Some(error);
        }
    }

    fn save(&self, to: &mut StateWriter<'_>) -> Result<(), StateError> {
        // Where it is broken, nothing more is written.
        to.put(&(self.every, self.broken.is_some()))?;
        if self.broken.is_some() {
            return Ok(());
        }
        to.put(&self.ticks)?;
        to.put(&self.places)?;
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
        self.places = from.take()?;
        let rows: String = from.take()?;
        self.rows = serde_json::from_str(&rows).map_err(io::Error::from)?;
        self.out.rewind()?;
        from.copy(&mut self.out)?;
        Ok(self.out.flush()?)
    }
}
