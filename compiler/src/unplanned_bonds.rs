//! What hardware does whose faces always attract: blocks dock where nobody expects them, and what
//! is let go is pushed away.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::{Cancellation, Cancelled, Symbols};
use stochc_ir::table::RoleId;
use stochc_ir::{Cell, Face, listed};

use crate::diagnostic::{Code, Diagnostic, report};
use crate::layout::Layout;
use crate::order::Order;
use crate::plan::{EventId, EventKind, ProgramPlan};

/// Faces that a message names.
const NAMED: usize = 3;

/// Tells of the phase in which most faces are exposed, and of blocks that are pushed into others.
///
/// A face is exposed if its block is anchored, the cell before it is empty, and nothing is expected
/// there. A phase waits longest, as far as the order goes, for the last of its captures: what is
/// exposed then is counted, with everything else of the phase done.
///
/// # Errors
///
/// [`Cancelled`] if nobody waits for it.
pub fn check(
    plan: &ProgramPlan,
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
    let mut structure = StructureModules::of_seeds(plan);
    // The first of the phases with the most.
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

/// For every phase, the capture that comes last in an order of the program; `None`: it has none.
fn last_captures(plan: &ProgramPlan, order: &Order) -> Vec<Option<EventId>> {
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
    plan: &'a ProgramPlan,
    layout: &'a Layout,
    last: &'a [Option<EventId>],
}

impl UnplannedBondAnalysis<'_> {
    /// Brings all of a phase about but its last capture, and counts the exposed faces; 0 if the
    /// phase has no captures to wait for.
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
            // Some have gone again by the end of the phase.
            if id != last && cell.is_some_and(|cell| filled.contains(&cell)) {
                self.settle(id, structure);
            }
        }
        // What is attached by hand is not waited for.
        if self.plan.phases[number].planted {
            return 0;
        }
        let waits = |(cell, on): (Cell, Face)| {
            !structure.blocks.contains_key(&cell)
                && (cell.across(on.opposite())).is_some_and(|at| structure.blocks.contains_key(&at))
        };
        // The face that waits is expected to be docked on.
        let face = self.layout.parents[last.0 as usize].map(|on| on.face);
        let awaited = self.layout.cells[last.0 as usize]
            .zip(face)
            .is_some_and(waits);
        structure.exposed - usize::from(awaited)
    }

    /// Brings the last capture of a phase about.
    fn end(&self, number: usize, structure: &mut StructureModules) {
        let last = self.last[number];
        let cell = last.and_then(|id| self.layout.cells[id.0 as usize]);
        if let (Some(last), Some(cell)) = (last, cell)
            && self.layout.changes[number].1.contains(&cell)
        {
            self.settle(last, structure);
        }
    }

    /// Adds the block of a capture.
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

    /// Tells of blocks that are let go towards another block, or towards the ground.
    fn blocked(
        &self,
        number: usize,
        structure: &StructureModules,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        let emptied: FxHashSet<Cell> = self.layout.changes[number].0.iter().copied().collect();
        for id in self.plan.events_of(&self.plan.phases[number]) {
            let event = self.plan.event(id);
            let (EventKind::Release, Some(cell), Some(on)) = (
                event.kind,
                self.layout.cells[id.0 as usize],
                self.layout.parents[id.0 as usize],
            ) else {
                continue;
            };
            let Some(before) = cell.across(on.face).filter(|before| before.z >= 1) else {
                continue;
            };
            let Some(&(role, _)) = structure.blocks.get(&before) else {
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

    fn exposed_faces(&self, number: usize, exposed: usize, symbols: &Symbols) -> Diagnostic {
        let mut structure = StructureModules::of_seeds(self.plan);
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

/// Returns the side of a block in words.
fn side(face: Face) -> String {
    match face {
        Face::Up => "on top".to_owned(),
        Face::Down => "at the bottom".to_owned(),
        face => format!("to the {face}"),
    }
}

/// Returns a direction in words.
fn towards(face: Face) -> String {
    match face {
        Face::Up => "upwards".to_owned(),
        Face::Down => "downwards".to_owned(),
        face => format!("to the {face}"),
    }
}

/// The modules of a structure, and how many of their faces are exposed.
struct StructureModules {
    /// Who is where, and by which of its faces it is anchored.
    blocks: FxHashMap<Cell, (RoleId, Option<Face>)>,
    exposed: usize,
}

impl StructureModules {
    /// Blocks of the plate without a name are no modules: nothing docks on them.
    fn of_seeds(plan: &ProgramPlan) -> StructureModules {
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

    /// Faces of neighbours that look at a cell, their anchors aside.
    fn facing(&self, cell: Cell) -> usize {
        let looks = |face: &Face| {
            let neighbour = cell
                .across(*face)
                .and_then(|cell| Some((cell, self.blocks.get(&cell)?)));
            neighbour.is_some_and(|(at, &(_, anchor))| bonds(at, anchor, face.opposite()))
        };
        Face::ALL.iter().filter(|face| looks(face)).count()
    }

    /// Exposed faces of the block in a cell.
    fn exposed_of(&self, cell: Cell) -> usize {
        let Some(&(_, anchor)) = self.blocks.get(&cell) else {
            return 0;
        };
        let exposed = |face: &Face| bonds(cell, anchor, *face) && self.is_open(cell, *face);
        Face::ALL.iter().filter(|face| exposed(face)).count()
    }

    /// Whether a block can come before a face.
    fn is_open(&self, cell: Cell, face: Face) -> bool {
        let before = cell.across(face);
        before.is_some_and(|cell| cell.z >= 1 && !self.blocks.contains_key(&cell))
    }

    /// Every exposed face.
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

/// Whether a block in a cell, anchored by one of its faces, has another one free; of the plate only upper
/// faces show.
fn bonds(cell: Cell, anchor: Option<Face>, face: Face) -> bool {
    Some(face) != anchor && (cell.z >= 1 || face == Face::Up)
}
