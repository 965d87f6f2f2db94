//! Cells and slices that the maps of a program show.
use std::collections::BTreeMap;
use std::io::{BufReader, Read};

use stochc_ir::Cell;
use stochc_ir::graph::EventAction;
use stochc_ir::record::RunRecord;
use stochc_ir::table::Tables;
use stochc_results::Finished;
use stochc_results::recording::{Places, RecordingError, each_places};

use super::slice::Slice;
use super::structure_membership::{AGES, PlaceQuery, StructureMembership, queries};
use super::tally::Counts;
use crate::analysis::reported_program::ReportedProgram;

/// Largest distance of the shown positions from the target cell \[block lengths\].
pub(crate) const REACH: i32 = 8;

/// Margin around the structure in a map \[block lengths\].
const MARGIN: i32 = 3;

/// Largest width of a map \[block lengths\].
const WIDEST: i32 = 40;

/// Half the thickness of a slice \[block lengths\]. Maps show the positions of blocks in a slice
/// before their captures.
pub(super) const HALF_SLICE: f64 = 1.0;

/// Largest number of captures of a program. Larger programs get no map of their faces.
const MAX_CAPTURES: usize = 2000;

/// Cell in a slice: index of the slice, then the two coordinates of the cell.
pub(super) type SlicePlace = (usize, i32, i32);

/// Key of a capture: role of the parent, index of its face, and role of the child.
pub(super) type LocatedCapture = (u32, usize, u32);

/// Counts of one run for all maps.
pub(super) struct RunCounts {
    pub(super) before: [Counts<SlicePlace>; 3],
    pub(super) occupation: Counts<SlicePlace>,
    /// Number of entries and number of waiting ticks for each face.
    pub(super) faces: BTreeMap<LocatedCapture, (f64, f64)>,
}

/// Cells and slices that the maps of a program show.
pub(super) struct MapPlaces {
    /// Horizontal plane and vertical plane, each through as many captured cells as possible.
    pub(super) slices: [Slice; 2],
    pub(super) ends: [((i32, i32), (i32, i32)); 2],
    /// Cells of the plate and of all captures.
    pub(super) cells: Vec<Cell>,
    /// Cell and text of each capture. The keys are parent, face and child.
    pub(super) captures: BTreeMap<LocatedCapture, (Cell, String)>,
    /// Offset that converts world coordinates to the coordinates of cells.
    corner: [f64; 3],
}

impl MapPlaces {
    pub(super) fn new(subject: &ReportedProgram) -> MapPlaces {
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
            // Of equally frequent coordinates, take the lowest.
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

    /// Returns the coordinates of the structure's cells in a slice.
    pub(super) fn structure(&self, slice: usize) -> Vec<(i32, i32)> {
        let cells = self.cells.iter();
        let mut places: Vec<_> = cells
            .filter_map(|&cell| self.slices[slice].place(cell))
            .collect();
        places.sort_unstable();
        places.dedup();
        places
    }

    /// Reads the recording of a run and returns its counts.
    pub(super) fn read(
        &self,
        subject: &ReportedProgram,
        known: &Finished,
        file: Box<dyn Read>,
    ) -> Result<RunCounts, RecordingError> {
        let record = &known.record;
        let held = StructureMembership::from_record(record);
        let mut queries = queries(record, &held);
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
            while let Some(it) = queries.pop_if(|it| it.tick <= tick) {
                self.look(places, &it, &mut counts.before);
            }
        })?;
        if outline.is_of(subject.manifest, Some(known), subject.number, record.run) {
            Ok(counts)
        } else {
            Err(RecordingError::Corrupted(
                "it is the recording of another run",
            ))
        }
    }

    pub(super) fn faces(&self, record: &RunRecord) -> BTreeMap<LocatedCapture, (f64, f64)> {
        let mut faces: BTreeMap<LocatedCapture, (f64, f64)> = BTreeMap::new();
        if self.captures.is_empty() {
            return faces;
        }
        let bonds = record.all_bonds().map(|it| {
            let capture = (it.parent.0, it.face as usize, it.child.0);
            (capture, it.entries, it.docked.saturating_sub(it.magnetized))
        });
        let waiting = record.all_waiting().map(|(it, end)| {
            let capture = (it.parent.0, it.face as usize, it.child.0);
            (capture, it.entries, end.saturating_sub(it.magnetized))
        });
        for (capture, entries, ticks) in bonds.chain(waiting) {
            let (all, waited) = faces.entry(capture).or_default();
            *all += f64::from(entries);
            *waited += ticks as f64;
        }
        faces
    }

    /// Counts the cells of free blocks, each with the weight `ticks`.
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
            let cell = self.cell(places.pose(body));
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

    /// Returns a position in the coordinates of cells, without rounding.
    fn lattice(&self, place: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| place[i] + self.corner[i])
    }

    pub(super) fn cell(&self, place: [f64; 3]) -> Cell {
        let [x, y, z] = self.lattice(place).map(|at| at.round() as i32);
        Cell::new(x, y, z)
    }

    /// Counts the position of the queried block, relative to the cell of its later capture. Ignores
    /// a position that was recorded too late after the queried tick.
    fn look(&self, places: &Places, queries: &PlaceQuery, before: &mut [Counts<SlicePlace>; 3]) {
        // Positions are recorded at intervals, so this position can be late.
        let late = places.tick() - queries.tick;
        if late > AGES[queries.age] / 10 || queries.body as usize >= places.bodies() {
            return;
        }
        let at = self.lattice(places.pose(queries.body as usize));
        let to = [queries.cell.x, queries.cell.y, queries.cell.z];
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| at[i] - f64::from(to[i]));
        let counts = &mut before[queries.age];
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

/// Returns the cells of the plate, or none if it is large.
fn plate(tables: &Tables) -> Vec<Cell> {
    /// Largest width of a plate that is drawn as cells. A larger plate counts as part of the floor.
    const MAX: u32 = 64;
    let (width, depth) = (tables.plate.width.min(MAX), tables.plate.depth.min(MAX));
    let cells = (0..width).flat_map(|x| (0..depth).map(move |y| (x, y)));
    cells
        .map(|(x, y)| Cell::new(x as i32, y as i32, 0))
        .collect()
}
