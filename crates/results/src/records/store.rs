//! Finished runs of an ensemble in order, without keeping all of them in memory.
use std::borrow::Cow;
use std::io::{self, BufReader, Seek as _, SeekFrom};
use std::sync::{Arc, Mutex, MutexGuard};

use stochc_files::File;

use crate::journal::JournalError;
use crate::journal::read_at;
use crate::records::Finished;
use crate::records::LineLocation;

/// Finished runs, sorted by program and number, without duplicates.
///
/// Runs of a folder remain in its files. Only their positions are in memory, 24 bytes each.
#[derive(Clone, Debug)]
pub struct Records(Arc<Store>);

#[derive(Debug)]
enum Store {
    Memory(Vec<Finished>),
    Lines(Lines),
}

/// Runs that are stored as lines of files.
#[derive(Debug)]
struct Lines {
    /// Positions of the lines, sorted.
    locations: Vec<LineLocation>,
    files: Mutex<Vec<BufReader<File>>>,
    /// Exclusive upper limit on the length of a line \[bytes\].
    most: u64,
}

impl Default for Records {
    fn default() -> Records {
        Vec::new().into()
    }
}

/// Sorts the runs, which must be unique.
impl From<Vec<Finished>> for Records {
    fn from(mut finished: Vec<Finished>) -> Records {
        finished.sort_by_key(|done| (done.program, done.record.run));
        Records(Arc::new(Store::Memory(finished)))
    }
}

impl Records {
    /// Returns the runs whose lines are at `locations` in `files`. The locations may be in any order.
    /// Each line has fewer than `most` bytes.
    pub(crate) fn at(mut locations: Vec<LineLocation>, files: Vec<File>, most: u64) -> Records {
        /// Size of a read buffer \[bytes\]. A small buffer suffices, because lines of consecutive
        /// runs are usually close together.
        const BUFFER: usize = 1 << 14;
        locations.sort_unstable();
        locations.dedup_by_key(|location| location.key());
        let files = files.into_iter();
        let files = files.map(|file| BufReader::with_capacity(BUFFER, file));
        Records(Arc::new(Store::Lines(Lines {
            locations,
            files: Mutex::new(files.collect()),
            most,
        })))
    }

    /// Returns the number of runs.
    pub fn len(&self) -> usize {
        match &*self.0 {
            Store::Memory(finished) => finished.len(),
            Store::Lines(lines) => lines.locations.len(),
        }
    }

    /// Returns whether there are no runs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the program index and the number of each run.
    pub fn keys(&self) -> impl Iterator<Item = (usize, u64)> {
        let (finished, locations): (&[Finished], &[LineLocation]) = match &*self.0 {
            Store::Memory(finished) => (finished, &[]),
            Store::Lines(lines) => (&[], &lines.locations),
        };
        let finished = finished.iter().map(|it| (it.program, it.record.run));
        finished.chain(locations.iter().map(LineLocation::key))
    }

    /// Returns whether a run is present.
    pub fn contains(&self, program: usize, run: u64) -> bool {
        self.index_of(program, run).is_some()
    }

    /// Returns a run if it is present.
    ///
    /// # Errors
    ///
    /// If the files of its folder cannot be read.
    pub fn get(&self, program: usize, run: u64) -> Result<Option<Finished>, JournalError> {
        let Some(number) = self.index_of(program, run) else {
            return Ok(None);
        };
        match &*self.0 {
            Store::Memory(finished) => Ok(Some(finished[number].clone())),
            Store::Lines(lines) => lines.reader().read(lines.locations[number]).map(Some),
        }
    }

    /// Calls `show` with each run in order.
    ///
    /// # Errors
    ///
    /// If the files of their folder cannot be read.
    pub fn each(&self, mut show: impl FnMut(&Finished)) -> Result<(), JournalError> {
        self.try_each(|finished| {
            show(finished);
            Ok(())
        })
    }

    /// Calls `show` with each run until the first error.
    ///
    /// # Errors
    ///
    /// The errors of [`Records::each`] and of `show`.
    pub fn try_each<E: From<JournalError>>(
        &self,
        mut show: impl FnMut(&Finished) -> Result<(), E>,
    ) -> Result<(), E> {
        self.try_take_each(|finished| show(&finished))
    }

    /// Calls `take` with each run like [`Records::try_each`]. Runs in files are passed as owned
    /// values, runs in memory as references.
    pub(crate) fn try_take_each<E: From<JournalError>>(
        &self,
        mut take: impl FnMut(Cow<Finished>) -> Result<(), E>,
    ) -> Result<(), E> {
        match &*self.0 {
            Store::Memory(finished) => finished.iter().map(Cow::Borrowed).try_for_each(take),
            Store::Lines(lines) => {
                let mut reader = lines.reader();
                (lines.locations.iter())
                    .try_for_each(|&location| take(Cow::Owned(reader.read(location)?)))
            }
        }
    }

    /// Calls `show` with the present runs among these programs and numbers, until the first error.
    ///
    /// # Errors
    ///
    /// The errors of [`Records::try_each`].
    pub fn try_each_of<E: From<JournalError>>(
        &self,
        keys: impl Iterator<Item = (usize, u64)>,
        mut show: impl FnMut(&Finished) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut numbers = keys.filter_map(|(program, run)| self.index_of(program, run));
        match &*self.0 {
            Store::Memory(finished) => numbers.try_for_each(|number| show(&finished[number])),
            Store::Lines(lines) => {
                let mut reader = lines.reader();
                numbers.try_for_each(|number| show(&reader.read(lines.locations[number])?))
            }
        }
    }

    /// Returns these runs together with the runs at the positions `more` in another file.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub(crate) fn and(&self, more: &[LineLocation], file: File, most: u64) -> io::Result<Records> {
        let mut files = Vec::new();
        if let Store::Lines(lines) = &*self.0 {
            let open = lines.files.lock().expect("no panic while it is locked");
            for file in open.iter() {
                files.push(file.get_ref().try_clone()?);
            }
        }
        files.push(file);
        Ok(Records::at([self.locations(), more].concat(), files, most))
    }

    /// Returns the number of files.
    pub(crate) fn files(&self) -> u32 {
        match &*self.0 {
            Store::Memory(_) => 0,
            Store::Lines(lines) => {
                let files = lines.files.lock().expect("no panic while it is locked");
                u32::try_from(files.len()).expect("few processes have been killed")
            }
        }
    }

    /// Returns all runs as a list. Use it only for small ensembles.
    ///
    /// # Errors
    ///
    /// The errors of [`Records::each`].
    pub fn to_vec(&self) -> Result<Vec<Finished>, JournalError> {
        let mut all = Vec::with_capacity(self.len());
        self.each(|finished| all.push(finished.clone()))?;
        Ok(all)
    }

    /// Returns the positions of the runs. Empty if the runs are in memory.
    pub(crate) fn locations(&self) -> &[LineLocation] {
        match &*self.0 {
            Store::Memory(_) => &[],
            Store::Lines(lines) => &lines.locations,
        }
    }

    fn index_of(&self, program: usize, run: u64) -> Option<usize> {
        let key = (program, run);
        match &*self.0 {
            Store::Memory(all) => all.binary_search_by_key(&key, |it| (it.program, it.record.run)),
            Store::Lines(lines) => lines
                .locations
                .binary_search_by_key(&key, LineLocation::key),
        }
        .ok()
    }
}

struct LineReader<'a> {
    files: MutexGuard<'a, Vec<BufReader<File>>>,
    /// For each file, the current reading position. `None` if unknown.
    at: Vec<Option<u64>>,
    line: Vec<u8>,
    most: u64,
}

impl Lines {
    fn reader(&self) -> LineReader<'_> {
        let files = self.files.lock().expect("no panic while it is locked");
        LineReader {
            at: vec![None; files.len()],
            files,
            line: Vec::new(),
            most: self.most,
        }
    }
}

impl LineReader<'_> {
    fn read(&mut self, location: LineLocation) -> Result<Finished, JournalError> {
        let number = location.file as usize;
        let (file, at) = (&mut self.files[number], &mut self.at[number]);
        match at.take() {
            // A relative seek keeps the buffer, so that bytes are not read twice.
            Some(at) => file.seek_relative(location.at.wrapping_sub(at).cast_signed())?,
            None => {
                file.seek(SeekFrom::Start(location.at))?;
            }
        }
        let (finished, bytes) = read_at(file, self.most, &mut self.line)?;
        *at = Some(location.at + bytes);
        if (finished.program, finished.record.run) == location.key() {
            Ok(finished)
        } else {
            Err(JournalError::Changed)
        }
    }
}
