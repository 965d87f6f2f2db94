//! The finished runs of an ensemble, in order, without all of them in memory.
use std::borrow::Cow;
use std::io::{self, BufReader, Seek as _, SeekFrom};
use std::sync::{Arc, Mutex, MutexGuard};

use stochc_files::File;

use crate::journal::JournalError;
use crate::journal::read_at;
use crate::records::Finished;
use crate::records::LineLocation;

/// Finished runs, sorted by program and run, each once; to be gone through as often as need be.
///
/// Those of a folder stay in its files: 24 bytes of memory are kept for each, which say where it is.
#[derive(Clone, Debug)]
pub struct Records(Arc<Store>);

#[derive(Debug)]
enum Store {
    Memory(Vec<Finished>),
    Lines(Lines),
}

/// Lines of files.
#[derive(Debug)]
struct Lines {
    /// Sorted.
    places: Vec<LineLocation>,
    files: Mutex<Vec<BufReader<File>>>,
    /// Bytes of a line, fewer than which it has.
    most: u64,
}

impl Default for Records {
    fn default() -> Records {
        Vec::new().into()
    }
}

/// Runs in any order, each once.
impl From<Vec<Finished>> for Records {
    fn from(mut finished: Vec<Finished>) -> Records {
        finished.sort_by_key(|done| (done.program, done.record.run));
        Records(Arc::new(Store::Memory(finished)))
    }
}

impl Records {
    /// The runs at places in any order, in files whose lines have fewer bytes than `most`.
    pub(crate) fn at(mut places: Vec<LineLocation>, files: Vec<File>, most: u64) -> Records {
        /// Bytes that are read at once: runs that finished one after the other are seldom far apart.
        const PIECE: usize = 1 << 14;
        places.sort_unstable();
        places.dedup_by_key(|place| place.key());
        let files = files.into_iter();
        let files = files.map(|file| BufReader::with_capacity(PIECE, file));
        Records(Arc::new(Store::Lines(Lines {
            places,
            files: Mutex::new(files.collect()),
            most,
        })))
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match &*self.0 {
            Store::Memory(finished) => finished.len(),
            Store::Lines(lines) => lines.places.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The program and the number of each.
    pub fn keys(&self) -> impl Iterator<Item = (usize, u64)> {
        let (finished, places): (&[Finished], &[LineLocation]) = match &*self.0 {
            Store::Memory(finished) => (finished, &[]),
            Store::Lines(lines) => (&[], &lines.places),
        };
        let finished = finished.iter().map(|it| (it.program, it.record.run));
        finished.chain(places.iter().map(LineLocation::key))
    }

    /// Whether a run is among them.
    pub fn contains(&self, program: usize, run: u64) -> bool {
        self.place(program, run).is_some()
    }

    /// A run, if it is there.
    ///
    /// # Errors
    /// Where the files of its folder cannot be read again.
    pub fn get(&self, program: usize, run: u64) -> Result<Option<Finished>, JournalError> {
        let Some(number) = self.place(program, run) else {
            return Ok(None);
        };
        match &*self.0 {
            Store::Memory(finished) => Ok(Some(finished[number].clone())),
            Store::Lines(lines) => lines.reader().read(lines.places[number]).map(Some),
        }
    }

    /// Shows each of them, in their order.
    ///
    /// # Errors
    /// Where the files of their folder cannot be read again.
    pub fn each(&self, mut show: impl FnMut(&Finished)) -> Result<(), JournalError> {
        self.try_each(|finished| {
            show(finished);
            Ok(())
        })
    }

    /// As [`Records::each`], until the first error.
    ///
    /// # Errors
    /// Those, and the ones of `show`.
    pub fn try_each<E: From<JournalError>>(
        &self,
        mut show: impl FnMut(&Finished) -> Result<(), E>,
    ) -> Result<(), E> {
        self.try_take_each(|finished| show(&finished))
    }

    /// As [`Records::try_each`], where those that are read anew may be kept.
    pub(crate) fn try_take_each<E: From<JournalError>>(
        &self,
        mut take: impl FnMut(Cow<Finished>) -> Result<(), E>,
    ) -> Result<(), E> {
        match &*self.0 {
            Store::Memory(finished) => finished.iter().map(Cow::Borrowed).try_for_each(take),
            Store::Lines(lines) => {
                let mut reader = lines.reader();
                (lines.places.iter()).try_for_each(|&place| take(Cow::Owned(reader.read(place)?)))
            }
        }
    }

    /// Shows those of these programs and numbers that are there, until the first error.
    ///
    /// # Errors
    /// Those of [`Records::try_each`].
    pub fn try_each_of<E: From<JournalError>>(
        &self,
        keys: impl Iterator<Item = (usize, u64)>,
        mut show: impl FnMut(&Finished) -> Result<(), E>,
    ) -> Result<(), E> {
        let mut numbers = keys.filter_map(|(program, run)| self.place(program, run));
        match &*self.0 {
            Store::Memory(finished) => numbers.try_for_each(|number| show(&finished[number])),
            Store::Lines(lines) => {
                let mut reader = lines.reader();
                numbers.try_for_each(|number| show(&reader.read(lines.places[number])?))
            }
        }
    }

    /// These, and those at places in a further file.
    ///
    /// # Errors
    /// Those of the file system.
    pub(crate) fn and(&self, more: &[LineLocation], file: File, most: u64) -> io::Result<Records> {
        let mut files = Vec::new();
        if let Store::Lines(lines) = &*self.0 {
            let open = lines.files.lock().expect("nobody panics while it is held");
            for file in open.iter() {
                files.push(file.get_ref().try_clone()?);
            }
        }
        files.push(file);
        Ok(Records::at([self.places(), more].concat(), files, most))
    }

    /// In how many files they are.
    pub(crate) fn files(&self) -> u32 {
        match &*self.0 {
            Store::Memory(_) => 0,
            Store::Lines(lines) => {
                let files = lines.files.lock().expect("nobody panics while it is held");
                u32::try_from(files.len()).expect("few processes have been killed")
            }
        }
    }

    /// All of them in memory, where they are few.
    ///
    /// # Errors
    /// Those of [`Records::each`].
    pub fn to_vec(&self) -> Result<Vec<Finished>, JournalError> {
        let mut all = Vec::with_capacity(self.len());
        self.each(|finished| all.push(finished.clone()))?;
        Ok(all)
    }

    /// Where they are, if that is in files.
    pub(crate) fn places(&self) -> &[LineLocation] {
        match &*self.0 {
            Store::Memory(_) => &[],
            Store::Lines(lines) => &lines.places,
        }
    }

    fn place(&self, program: usize, run: u64) -> Option<usize> {
        let key = (program, run);
        match &*self.0 {
            Store::Memory(all) => all.binary_search_by_key(&key, |it| (it.program, it.record.run)),
            Store::Lines(lines) => lines.places.binary_search_by_key(&key, LineLocation::key),
        }
        .ok()
    }
}

/// Reads lines anew.
struct LineReader<'a> {
    files: MutexGuard<'a, Vec<BufReader<File>>>,
    /// Where each file stands; `None`: nobody knows.
    at: Vec<Option<u64>>,
    line: Vec<u8>,
    most: u64,
}

impl Lines {
    fn reader(&self) -> LineReader<'_> {
        let files = self.files.lock().expect("nobody panics while it is held");
        LineReader {
            at: vec![None; files.len()],
            files,
            line: Vec::new(),
            most: self.most,
        }
    }
}

impl LineReader<'_> {
    fn read(&mut self, place: LineLocation) -> Result<Finished, JournalError> {
        let number = place.file as usize;
        let (file, at) = (&mut self.files[number], &mut self.at[number]);
        match at.take() {
            // What has been read already is not read again.
            Some(at) => file.seek_relative(place.at.wrapping_sub(at).cast_signed())?,
            None => {
                file.seek(SeekFrom::Start(place.at))?;
            }
        }
        let (finished, bytes) = read_at(file, self.most, &mut self.line)?;
        *at = Some(place.at + bytes);
        if (finished.program, finished.record.run) == place.key() {
            Ok(finished)
        } else {
            Err(JournalError::Changed)
        }
    }
}
