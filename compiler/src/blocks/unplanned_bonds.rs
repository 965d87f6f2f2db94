//! Warnings for hardware whose faces always attract: unplanned bonds, and releases near other
//! blocks.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::{Cancellation, Cancelled, Symbols};
use stochc_ir::table::RoleId;
use stochc_ir::{Cell, Face};
use stochc_text::listed;

use crate::dependencies::order::Order;
use crate::diagnostic::{Code, Diagnostic, report};
use crate::expanded::{EventId, EventKind, ExpandedProgram};
use crate::shapes::layout::Layout;

/// Largest number of faces that a message names.
const NAMED: usize = 3;

/// Warns of the phase with the most exposed faces, and of releases near other blocks.
///
/// A face is exposed if its block is attached, the cell in front of it is empty, and no capture is
/// expected there. Exposed faces are counted while the last capture of the phase waits, after all
/// other events of the phase.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn check(
    plan: &ExpandedProgram,
    layout: &Layout,
    order: &Order,
    symbols: &Symbols,
    cancellation: Cancellation<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<(), Cancelled> {
    let last = last_captures(plan, order);
    let survey = UnplannedBondAnalysis {
        plan,
        layout,
        last: &last,
    };
    let mut structure = StructureModules::from_seeds(plan);
    // Phase with the most exposed faces, the first one of several.
    let mut worst: Option<(usize, usize)> = None;
    for number in 0..plan.phases.len() {
        cancellation.check()?;
        survey.blocked(number, &structure, symbols, diagnostics);
        let exposed = survey.before_last(number, &mut structure);
        if exposed > worst.map_or(0, |(_, most)| most) {
            worst = Some((number, exposed));
        }
        survey.end(number, &mut structure);
    }
    if let Some((number, exposed)) = worst {
        diagnostics.push(survey.exposed_faces(number, exposed, symbols));
    }
    Ok(())
}

/// For each phase, returns its last capture in this order. `None` for phases without captures.
fn last_captures(plan: &ExpandedProgram, order: &Order) -> Vec<Option<EventId>> {
    let mut place = vec![usize::MAX; plan.events.len()];
    for (i, id) in order.events.iter().enumerate() {
        place[id.0 as usize] = i;
    }
    let captures = |id: &EventId| matches!(plan.event(*id).kind, EventKind::Capture { .. });
    (plan.phases.iter())
        .map(|phase| {
            let captures = plan.events_of(phase).filter(captures);
            captures.max_by_key(|id| place[id.0 as usize])
        })
        .collect()
}

struct UnplannedBondAnalysis<'a> {
    plan: &'a ExpandedProgram,
    layout: &'a Layout,
    last: &'a [Option<EventId>],
}

impl UnplannedBondAnalysis<'_> {
    /// Applies all events of a phase except the last capture, and returns the number of exposed
    /// faces. Returns 0 if the phase has no captures.
    fn before_last(&self, number: usize, structure: &mut StructureModules) -> usize {
        let (emptied, _) = &self.layout.changes[number];
        for cell in emptied {
            structure.leave(*cell);
        }
        let Some(last) = self.last[number] else {
            return 0;
        };
        let filled: FxHashSet<Cell> = self.layout.changes[number].1.iter().copied().collect();
        for id in self.plan.events_of(&self.plan.phases[number]) {
            let cell = self.layout.cells[id.0 as usize];
            // Some blocks are released before the end of the phase.
            if id != last && cell.is_some_and(|cell| filled.contains(&cell)) {
                self.settle(id, structure);
            }
        }
        // No run waits for pre-attached blocks.
        if self.plan.phases[number].pre_attached {
            return 0;
        }
        let waits = |(cell, on): (Cell, Face)| {
            !structure.blocks.contains_key(&cell)
                && (cell.across(on.opposite())).is_some_and(|at| structure.blocks.contains_key(&at))
        };
        // The open face of the last capture is not counted.
        let face = self.layout.parents[last.0 as usize].map(|on| on.face);
        let awaited = self.layout.cells[last.0 as usize]
            .zip(face)
            .is_some_and(waits);
        structure.exposed - usize::from(awaited)
    }

    /// Applies the last capture of a phase.
    fn end(&self, number: usize, structure: &mut StructureModules) {
        let last = self.last[number];
        let cell = last.and_then(|id| self.layout.cells[id.0 as usize]);
        if let (Some(last), Some(cell)) = (last, cell)
            && self.layout.changes[number].1.contains(&cell)
        {
            self.settle(last, structure);
        }
    }

    /// Adds the block of a capture to the structure.
    fn settle(&self, id: EventId, structure: &mut StructureModules) {
        let event = self.plan.event(id);
        let (Some(cell), Some(on)) = (
            self.layout.cells[id.0 as usize],
            self.layout.parents[id.0 as usize],
        ) else {
            return;
        };
        if matches!(event.kind, EventKind::Capture { .. }) {
            structure.enter(cell, event.role, Some(on.face.opposite()));
        }
    }

    /// Returns the events of a phase that may release a block: releases, and the captures of a
    /// phase that can be retried.
    fn releasing(&self, number: usize) -> impl Iterator<Item = EventId> + '_ {
        let phase = &self.plan.phases[number];
        let is_retried = phase.recovery.is_some();
        (self.plan.events_of(phase))
            .filter(move |id| is_retried || self.plan.event(*id).kind == EventKind::Release)
    }

    /// Reports blocks whose parent pushes them towards another block at their release.
    fn blocked(
        &self,
        number: usize,
        structure: &StructureModules,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let emptied: FxHashSet<Cell> = self.layout.changes[number].0.iter().copied().collect();
        for id in self.releasing(number) {
            let event = self.plan.event(id);
            let (Some(cell), Some(on)) = (
                self.layout.cells[id.0 as usize],
                self.layout.parents[id.0 as usize],
            ) else {
                continue;
            };
            let Some(before) = cell.across(on.face).filter(|before| before.z >= 1) else {
                continue;
            };
            let standing = structure.blocks.get(&before).map(|&(role, _)| role);
            let Some(role) = standing.or_else(|| self.captured_beside(number, event.role, before))
            else {
                continue;
            };
            if emptied.contains(&before) {
                continue;
            }
            let name = self.plan.roles.name(event.role, symbols);
            let there = self.plan.roles.name(role, symbols);
            let format = "`{}` is released towards `{}` and may not leave";
            let diagnostic = Diagnostic::about(Code::BlockedRelease, format, &[&name, &there])
                .label(
                    event.location,
                    format!("its parent pushes it {}", towards(on.face)),
                )
                .label(
                    self.plan.event(on.capture).location,
                    format!("attached {} of its parent", side(on.face)),
                )
                .help(format!(
                    "release `{there}` too, or capture `{name}` through another face"
                ));
            report(diagnostics, diagnostic);
        }
    }

    /// Returns the block that a phase with retries may capture in a cell. Returns `None` if the
    /// block `parent` captures it, because children are released first.
    fn captured_beside(&self, number: usize, parent: RoleId, cell: Cell) -> Option<RoleId> {
        let phase = &self.plan.phases[number];
        phase.recovery?;
        let there = |id: &EventId| self.layout.cells[id.0 as usize] == Some(cell);
        let capture = self.plan.events_of(phase).find(there)?;
        let is_child = self.plan.actor(capture) == parent;
        (!is_child).then(|| self.plan.event(capture).role)
    }

    fn exposed_faces(&self, number: usize, exposed: usize, symbols: &Symbols) -> Diagnostic {
        let mut structure = StructureModules::from_seeds(self.plan);
        for earlier in 0..number {
            self.before_last(earlier, &mut structure);
            self.end(earlier, &mut structure);
        }
        self.before_last(number, &mut structure);
        let awaited = self.last[number].and_then(|id| self.layout.parents[id.0 as usize]);
        let mut faces: Vec<(RoleId, Face)> = structure.faces().collect();
        faces.retain(|face| awaited.is_none_or(|on| *face != (on.parent, on.face)));
        faces.sort_unstable();
        let named: Vec<String> = (faces.iter().take(NAMED))
            .map(|&(role, face)| format!("`{}.{face}`", self.plan.roles.name(role, symbols)))
            .collect();
        let named = listed(&named, faces.len());
        let phase = &self.plan.phases[number];
        let (title, where_) = match exposed {
            1 => (
                "a face attracts blocks that the program does not capture",
                "is exposed",
            ),
            _ => (
                "faces attract blocks that the program does not capture",
                "are exposed",
            ),
        };
        let count = if exposed == 1 {
            String::new()
        } else {
            format!("{exposed} ")
        };
        Diagnostic::new(Code::UnplannedBond, format!("{count}{title}"))
            .label(
                phase.location,
                format!("{named} {where_} while the phase waits for its last block"),
            )
            .help(
                "write `allow unplanned-bond \"reason\"` if the delay by rejected blocks is acceptable, or \
                 build so that fewer faces are exposed",
            )
    }
}

fn side(face: Face) -> String {
    match face {
        Face::Up => "on top".to_owned(),
        Face::Down => "at the bottom".to_owned(),
        face => format!("to the {face}"),
    }
}

fn towards(face: Face) -> String {
    match face {
        Face::Up => "upwards".to_owned(),
        Face::Down => "downwards".to_owned(),
        face => format!("to the {face}"),
    }
}

/// Occupied cells of a structure, with the number of exposed faces.
struct StructureModules {
    /// Role of the block in a cell, and the face that attaches it.
    blocks: FxHashMap<Cell, (RoleId, Option<Face>)>,
    exposed: usize,
}

impl StructureModules {
    /// Returns the structure of the named seeds. Other blocks of the plate attract nothing.
    fn from_seeds(plan: &ExpandedProgram) -> StructureModules {
        let mut structure = StructureModules {
            blocks: FxHashMap::default(),
            exposed: 0,
        };
        for seed in &plan.seeds {
            structure.enter(seed.cell, seed.role, None);
        }
        structure
    }

    fn enter(&mut self, cell: Cell, role: RoleId, anchor: Option<Face>) {
        if self.blocks.contains_key(&cell) {
            return;
        }
        self.exposed -= self.facing(cell);
        self.blocks.insert(cell, (role, anchor));
        self.exposed += self.exposed_of(cell);
    }

    fn leave(&mut self, cell: Cell) {
        self.exposed -= self.exposed_of(cell);
        if self.blocks.remove(&cell).is_some() {
            self.exposed += self.facing(cell);
        }
    }

    /// Returns the number of faces in neighbouring cells that point towards a cell and can bond.
    fn facing(&self, cell: Cell) -> usize {
        let looks = |face: &Face| {
            let neighbour = cell
                .across(*face)
                .and_then(|cell| Some((cell, self.blocks.get(&cell)?)));
            neighbour.is_some_and(|(at, &(_, anchor))| bonds(at, anchor, face.opposite()))
        };
        Face::ALL.iter().filter(|face| looks(face)).count()
    }

    /// Returns the number of exposed faces of the block in a cell.
    fn exposed_of(&self, cell: Cell) -> usize {
        let Some(&(_, anchor)) = self.blocks.get(&cell) else {
            return 0;
        };
        let exposed = |face: &Face| bonds(cell, anchor, *face) && self.is_open(cell, *face);
        Face::ALL.iter().filter(|face| exposed(face)).count()
    }

    /// Returns whether a block can dock on a face.
    fn is_open(&self, cell: Cell, face: Face) -> bool {
        let before = cell.across(face);
        before.is_some_and(|cell| cell.z >= 1 && !self.blocks.contains_key(&cell))
    }

    /// Returns every exposed face.
    fn faces(&self) -> impl Iterator<Item = (RoleId, Face)> + '_ {
        self.blocks
            .iter()
            .flat_map(move |(&cell, &(role, anchor))| {
                let faces = Face::ALL.into_iter();
                let exposed = faces
                    .filter(move |&face| bonds(cell, anchor, face) && self.is_open(cell, face));
                exposed.map(move |face| (role, face))
            })
    }
}

/// Returns whether a face of a block can bond. Blocks of the plate have only their upper face.
fn bonds(cell: Cell, anchor: Option<Face>, face: Face) -> bool {
    Some(face) != anchor && (cell.z >= 1 || face == Face::Up)
}
