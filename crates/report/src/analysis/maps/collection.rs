//! Maps of a program from its recorded runs.
use std::collections::BTreeMap;
use std::io;
use std::io::Read;

use stochc_experiments::resampling::{Ratio, Replicates, weights};
use stochc_ir::Cell;
use stochc_results::JournalError;
use stochc_results::recording::RecordingError;

use super::places::{HALF_SLICE, LocatedCapture, MapPlaces, REACH, SlicePlace};
use super::slice::{FaceEntries, Maps, Slice, SliceMap};
use super::tally::Tally;
use crate::analysis::reported_program::{Input, ReportedProgram};

/// Function that opens the recording of a run, or returns `None` if there is none. Its arguments
/// are the index of the folder, the index of the program, and the number of the run.
pub type RecordingReader<'a> = dyn Fn(usize, usize, u64) -> Option<io::Result<Box<dyn Read>>> + 'a;

/// Returns the maps of a program. Returns `None` if its blocks do not move or it has no captures.
///
/// # Errors
///
/// If the runs of the folder cannot be read again.
pub(crate) fn maps(
    subject: &ReportedProgram,
    input: &Input,
    recordings: &RecordingReader,
) -> Result<Option<Maps>, JournalError> {
    let model = subject.manifest.settings_of(subject.program).model;
    if !model.has_places() || subject.program.captures() == 0 {
        return Ok(None);
    }
    let mut first = None;
    let mut maps = Maps::default();
    let mut before: [Tally<SlicePlace>; 3] = std::array::from_fn(|_| Tally::new());
    let mut occupation = Tally::new();
    let mut faces: BTreeMap<LocatedCapture, (Replicates, Replicates)> = BTreeMap::new();
    for (program, run) in input.finished.keys() {
        if program != subject.number {
            continue;
        }
        let Some(file) = recordings(subject.folder, program, run) else {
            continue;
        };
        let Some(known) = input.finished.get(program, run)? else {
            continue;
        };
        let place = first.get_or_insert_with(|| MapPlaces::new(subject));
        // A run counts only after its recording was read to the end.
        match file
            .map_err(RecordingError::from)
            .and_then(|file| place.read(subject, &known, file))
        {
            Ok(counts) => {
                let weights = weights(subject.manifest.seed, run);
                maps.runs += 1;
                for (tally, counts) in before.iter_mut().zip(counts.before) {
                    tally.add(counts, &weights);
                }
                occupation.add(counts.occupation, &weights);
                for (capture, (entries, ticks)) in counts.faces {
                    let (all, waited) = faces.entry(capture).or_default();
                    all.add(entries, &weights);
                    waited.add(ticks, &weights);
                }
            }
            Err(error) => maps.left_out.push((run, error.to_string())),
        }
    }
    let Some(place) = first.filter(|_| maps.runs > 0) else {
        return Ok(Some(maps));
    };
    let around = ((-REACH, REACH), (-REACH, REACH));
    for tally in &before {
        let slices = [Slice::Horizontal(0), Slice::Vertical(0)];
        maps.before.push(std::array::from_fn(|i| SliceMap {
            slice: slices[i],
            ends: around,
            places: every(around, |x, y| tally.ratio((i, x, y), 2.0 * HALF_SLICE)),
            structure: vec![(0, 0)],
        }));
    }
    maps.occupation = Some(std::array::from_fn(|i| SliceMap {
        slice: place.slices[i],
        ends: place.ends[i],
        places: every(place.ends[i], |x, y| occupation.ratio((i, x, y), 1.0)),
        structure: place.structure(i),
    }));
    let mut cells: BTreeMap<Cell, (Replicates, Replicates)> = BTreeMap::new();
    for ((parent, face, child), (entries, ticks)) in &faces {
        let Some((cell, text)) = place.captures.get(&(*parent, *face, *child)) else {
            continue;
        };
        let (all, waited) = cells.entry(*cell).or_default();
        all.join(entries);
        waited.join(ticks);
        if let Some(rate) = entries.over(ticks, 1.0) {
            let (text, cell) = (text.clone(), *cell);
            maps.faces.push(FaceEntries { text, cell, rate });
        }
    }
    if !maps.faces.is_empty() {
        maps.entries = Some(std::array::from_fn(|i| {
            let here = cells.iter().filter_map(|(cell, (entries, ticks))| {
                Some((place.slices[i].place(*cell)?, entries.over(ticks, 1.0)?))
            });
            SliceMap {
                slice: place.slices[i],
                ends: place.ends[i],
                places: here.collect(),
                structure: place.structure(i),
            }
        }));
    }
    Ok(Some(maps))
}

/// Returns the values of all cells in a rectangle. Cells without a known value are absent.
fn every(
    ((west, east), (low, high)): ((i32, i32), (i32, i32)),
    known: impl Fn(i32, i32) -> Option<Ratio>,
) -> BTreeMap<(i32, i32), Ratio> {
    let places = (west..=east).flat_map(|x| (low..=high).map(move |y| (x, y)));
    places
        .filter_map(|(x, y)| Some(((x, y), known(x, y)?)))
        .collect()
}
