//! Positions of blocks over all runs of a program: before their capture, close to the structure,
//! and at open faces.
//!
//! All values are ratios of sums over runs in cells of the lattice. Their intervals come from a
//! bootstrap over runs.
mod structure_membership;
mod tally;

use std::collections::BTreeMap;
use std::io::{self, BufReader, Read};

use stochc_experiments::resampling::{Ratio, Replicates, weights};
use stochc_ir::Cell;
use stochc_ir::graph::EventAction;
use stochc_ir::record::RunRecord;
use stochc_ir::table::Tables;
use stochc_results::recording::{Places, RecordingError, each_places};
use stochc_results::{Finished, JournalError};
use stochc_runtime::Model;

use self::structure_membership::{PlaceQuery, StructureMembership, wanted};
use self::tally::{Counts, Tally};
use super::reported_program::{Input, ReportedProgram};

/// Times before the capture for the position of a block \[ticks\].
pub(crate) const AGES: [u64; 3] = [50, 200, 1000];

/// Largest distance of the shown positions from the target cell \[side\].
pub(crate) const REACH: i32 = 8;

/// Margin around a structure, and largest shown width \[side\].
const MARGIN: i32 = 3;
const WIDEST: i32 = 40;

/// Half the thickness of a slice through the positions before a capture \[side\].
const HALF_SLICE: f64 = 1.0;

/// Largest number of captures for a map of the faces.
const MAX_CAPTURES: usize = 2000;

/// Reader of the recording of a run. Arguments: index of the folder, index of the program, number
/// of the run. Returns `None` if there is no recording.
pub type RecordingReader<'a> = dyn Fn(usize, usize, u64) -> Option<io::Result<Box<dyn Read>>> + 'a;

/// Plane of a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slice {
    /// Horizontal plane at a height.
    Horizontal(i32),
    /// Vertical plane from west to east, at a north coordinate.
    Vertical(i32),
}

impl Slice {
    /// Returns the name of the second axis.
    pub fn up(self) -> &'static str {
        match self {
            Slice::Horizontal(_) => "north",
            Slice::Vertical(_) => "up",
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Slice::Horizontal(_) => "horizontal",
            Slice::Vertical(_) => "vertical",
        }
    }

    /// Returns the coordinate of the plane in cells.
    pub fn at(self) -> i32 {
        match self {
            Slice::Horizontal(at) | Slice::Vertical(at) => at,
        }
    }

    /// Returns the coordinates of a cell in the plane. Returns `None` if the cell is outside the
    /// plane.
    fn place(self, cell: Cell) -> Option<(i32, i32)> {
        match self {
            Slice::Horizontal(z) => (cell.z == z).then_some((cell.x, cell.y)),
            Slice::Vertical(y) => (cell.y == y).then_some((cell.x, cell.z)),
        }
    }
}

/// A slice through a counted quantity.
#[derive(Clone, Debug)]
pub(crate) struct SliceMap {
    pub slice: Slice,
    /// First and last coordinates of both axes.
    pub ends: ((i32, i32), (i32, i32)),
    /// Estimate for each cell of the map. Absent cells are unknown.
    pub places: BTreeMap<(i32, i32), Ratio>,
    /// Places of the structure in the plane.
    pub structure: Vec<(i32, i32)>,
}

/// The face of a capture, and the rate of blocks that enter its capture range.
#[derive(Clone, Debug)]
pub(crate) struct FaceEntries {
    pub text: String,
    pub cell: Cell,
    /// Entries per tick of waiting.
    pub rate: Ratio,
}

/// Maps of a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Maps {
    /// Number of recordings used.
    pub runs: usize,
    /// Runs with unusable recordings, with reasons.
    pub left_out: Vec<(u64, String)>,
    /// For each of [`AGES`], the share of the captured blocks per volume of a cell.
    pub before: Vec<[SliceMap; 2]>,
    /// Mean number of free blocks in each cell.
    pub occupation: Option<[SliceMap; 2]>,
    /// Entries per tick of waiting.
    pub entries: Option<[SliceMap; 2]>,
    pub faces: Vec<FaceEntries>,
}

/// A cell in a slice: index of the slice, then its two coordinates.
type SlicePlace = (usize, i32, i32);

/// A capture: parent, face and child as in the record.
type LocatedCapture = (u32, usize, u32);

/// Counts of one run.
struct RunCounts {
    before: [Counts<SlicePlace>; 3],
    occupation: Counts<SlicePlace>,
    /// Entries and ticks of waiting.
    faces: BTreeMap<LocatedCapture, (f64, f64)>,
}

/// Computes the maps of a program. Returns `None` if its blocks do not move, or it captures none.
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
    let is_still = matches!(model, Model::Shuffle | Model::Rate);
    if is_still || subject.program.captures() == 0 {
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
        // A run counts only after its recording has been read to the end.
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

/// Returns the estimate for each cell of a rectangle.
fn every(
    ((west, east), (low, high)): ((i32, i32), (i32, i32)),
    known: impl Fn(i32, i32) -> Option<Ratio>,
) -> BTreeMap<(i32, i32), Ratio> {
    let places = (west..=east).flat_map(|x| (low..=high).map(move |y| (x, y)));
    places
        .filter_map(|(x, y)| Some(((x, y), known(x, y)?)))
        .collect()
}

/// Geometry of the maps of a program.
struct MapPlaces {
    /// Planes through the cells of most captures.
    slices: [Slice; 2],
    ends: [((i32, i32), (i32, i32)); 2],
    /// Cells of the plate and of captures.
    cells: Vec<Cell>,
    /// Cell and text of each capture, by parent, face and child.
    captures: BTreeMap<LocatedCapture, (Cell, String)>,
    /// Offset from world coordinates to cells.
    corner: [f64; 3],
}

impl MapPlaces {
    fn new(subject: &ReportedProgram) -> MapPlaces {
        let tables = subject.program.tables();
        let events = &subject.program.compiled.graph.events;
        let captured = events.iter().filter_map(|event| match event.action {
            EventAction::Capture {
                parent,
                face,
                child,
            } => Some((
                (parent.0, face as usize, child.0),
                event.action,
                event.cell?,
            )),
            EventAction::Release { .. } => None,
        });
        let captured: Vec<(LocatedCapture, EventAction, Cell)> = captured.collect();
        let named = captured
            .iter()
            .take_while(|_| captured.len() <= MAX_CAPTURES);
        let captures = named.map(|(capture, action, cell)| {
            let text = action.describe(|role| subject.program.role(role).to_owned());
            (*capture, (*cell, text))
        });
        let captures = captures.collect();
        let captured: Vec<Cell> = captured.iter().map(|(.., cell)| *cell).collect();
        let most = |of: fn(&Cell) -> i32| {
            let mut counts: BTreeMap<i32, usize> = BTreeMap::new();
            for cell in &captured {
                *counts.entry(of(cell)).or_default() += 1;
            }
            // The lowest of equally frequent coordinates.
            let most = (counts.into_iter()).max_by_key(|&(at, n)| (n, std::cmp::Reverse(at)));
            most.map_or(0, |(at, _)| at)
        };
        let slices = [
            Slice::Horizontal(most(|cell| cell.z)),
            Slice::Vertical(most(|cell| cell.y)),
        ];
        let mut cells = plate(tables);
        cells.extend(&captured);
        let range = |of: fn(&Cell) -> i32, least: i32| {
            let low = cells.iter().map(of).min().unwrap_or(0) - MARGIN;
            let high = cells.iter().map(of).max().unwrap_or(0) + MARGIN;
            let middle = i32::midpoint(low, high);
            (
                low.max(middle - WIDEST / 2).max(least),
                high.min(middle + WIDEST / 2),
            )
        };
        let (x, y) = (
            range(|cell| cell.x, i32::MIN),
            range(|cell| cell.y, i32::MIN),
        );
        // There are no cells below the ground.
        let z = range(|cell| cell.z, 1);
        let across = |blocks: u32| (f64::from(blocks) - 1.0) / 2.0;
        MapPlaces {
            slices,
            ends: [(x, y), (x, z)],
            cells,
            captures,
            corner: [across(tables.plate.width), across(tables.plate.depth), 0.5],
        }
    }

    /// Returns the places of the structure in a slice.
    fn structure(&self, slice: usize) -> Vec<(i32, i32)> {
        let cells = self.cells.iter();
        let mut places: Vec<_> = cells
            .filter_map(|&cell| self.slices[slice].place(cell))
            .collect();
        places.sort_unstable();
        places.dedup();
        places
    }

    /// Reads the counts of a run from its recording.
    fn read(
        &self,
        subject: &ReportedProgram,
        known: &Finished,
        file: Box<dyn Read>,
    ) -> Result<RunCounts, RecordingError> {
        let record = &known.record;
        let held = StructureMembership::from_record(record);
        let mut wanted = wanted(record, &held);
        let mut counts = RunCounts {
            before: Default::default(),
            occupation: Counts::default(),
            faces: self.faces(record),
        };
        let mut last = 0;
        let tables = subject.program.tables();
        let outline = each_places(BufReader::new(file), tables, &mut |places| {
            let tick = places.tick();
            self.occupy(places, &held, tick - last, &mut counts.occupation);
            last = tick;
            while let Some(it) = wanted.pop_if(|it| it.tick <= tick) {
                self.look(places, &it, &mut counts.before);
            }
        })?;
        if outline.is_of(subject.manifest, Some(known), subject.number, record.run) {
            Ok(counts)
        } else {
            Err(RecordingError::Damaged(
                "it is the recording of another run",
            ))
        }
    }

    fn faces(&self, record: &RunRecord) -> BTreeMap<LocatedCapture, (f64, f64)> {
        let mut faces: BTreeMap<LocatedCapture, (f64, f64)> = BTreeMap::new();
        if self.captures.is_empty() {
            return faces;
        }
        let bonds = record.bonds.iter().map(|it| {
            let capture = (it.parent.0, it.face as usize, it.child.0);
            (capture, it.entries, it.docked.saturating_sub(it.magnetized))
        });
        let waiting = record.waiting.iter().map(|it| {
            let capture = (it.parent.0, it.face as usize, it.child.0);
            (
                capture,
                it.entries,
                record.ticks.saturating_sub(it.magnetized),
            )
        });
        for (capture, entries, ticks) in bonds.chain(waiting) {
            let (all, waited) = faces.entry(capture).or_default();
            *all += f64::from(entries);
            *waited += ticks as f64;
        }
        faces
    }

    /// Adds the cells of free blocks, weighted by a number of ticks.
    fn occupy(
        &self,
        places: &Places,
        held: &StructureMembership,
        ticks: u64,
        counts: &mut Counts<SlicePlace>,
    ) {
        if ticks == 0 {
            return;
        }
        counts.of += ticks as f64;
        for body in 0..places.bodies() {
            if held.is_held(body as u32, places.tick()) {
                continue;
            }
            let cell = self.cell(places.place(body));
            for (i, slice) in self.slices.iter().enumerate() {
                let ((west, east), (low, high)) = self.ends[i];
                if let Some((x, y)) = slice.place(cell)
                    && (west..=east).contains(&x)
                    && (low..=high).contains(&y)
                {
                    counts.add((i, x, y), ticks as f64);
                }
            }
        }
    }

    /// Returns the position of a block in cell coordinates, without rounding.
    fn lattice(&self, place: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| place[i] + self.corner[i])
    }

    fn cell(&self, place: [f64; 3]) -> Cell {
        let [x, y, z] = self.lattice(place).map(|at| at.round() as i32);
        Cell::new(x, y, z)
    }

    /// Adds the position of a block before its capture.
    fn look(&self, places: &Places, wanted: &PlaceQuery, before: &mut [Counts<SlicePlace>; 3]) {
        // With sparse recorded positions, this one can be too late.
        let late = places.tick() - wanted.tick;
        if late > AGES[wanted.age] / 10 || wanted.body as usize >= places.bodies() {
            return;
        }
        let at = self.lattice(places.place(wanted.body as usize));
        let to = [wanted.cell.x, wanted.cell.y, wanted.cell.z];
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| at[i] - f64::from(to[i]));
        let counts = &mut before[wanted.age];
        counts.of += 1.0;
        let mut add = |slice: usize, up: f64, aside: f64| {
            let (x, up) = (x.round() as i32, up.round() as i32);
            let is_shown = [x, up].iter().all(|at| (-REACH..=REACH).contains(at));
            if is_shown && aside.abs() <= HALF_SLICE {
                counts.add((slice, x, up), 1.0);
            }
        };
        add(0, y, z);
        add(1, z, y);
    }
}

/// Returns the cells of the plate.
fn plate(tables: &Tables) -> Vec<Cell> {
    /// A larger plate is drawn as the floor.
    const MAX: u32 = 64;
    let (width, depth) = (tables.plate.width.min(MAX), tables.plate.depth.min(MAX));
    let cells = (0..width).flat_map(|x| (0..depth).map(move |y| (x, y)));
    cells
        .map(|(x, y)| Cell::new(x as i32, y as i32, 0))
        .collect()
}
