//! Computes the cells of all blocks.
use rustc_hash::FxHashMap;
use stochc_grammar::{Cancellation, Cancelled, Symbols};
use stochc_ir::table::RoleId;
use stochc_ir::{Cell, Face};

use crate::blocks::liveness::{Holder, Liveness};
use crate::diagnostic::{Code, Diagnostic, Fix, named, report, row_hint};
use crate::expanded::{EventId, EventKind, ExpandedProgram};
use crate::{SourceLocation, Sources};

/// Cells and bonds of a program's blocks.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Cell of each event's block. `None` if unknown.
    pub cells: Vec<Option<Cell>>,
    /// Bond of each event's block to its parent. `None` for seeds, and for events with errors.
    pub parents: Vec<Option<Attachment>>,
    /// Pairs of a release that empties a cell and a capture of the same phase that fills it.
    pub vacated: Vec<(EventId, EventId)>,
    /// For each phase, the cells above the plate that it empties, and the cells that it fills. A
    /// cell can be in both lists.
    pub changes: Vec<(Vec<Cell>, Vec<Cell>)>,
    /// Number of blocks above the plate at the end of each phase.
    pub sizes: Vec<u32>,
    /// Pairs of a child's release and the later release of its parent.
    pub emptied: Vec<(EventId, EventId)>,
}

/// Bond of a block to its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Name of the parent.
    pub parent: RoleId,
    /// Face of the parent, in the frame of the structure.
    pub face: Face,
    /// Capture that made the bond.
    pub capture: EventId,
}

#[derive(Clone, Copy)]
struct AnchoredPosition {
    cell: Cell,
    /// Bond to the parent. `None` for blocks of the plate.
    on: Option<Attachment>,
}

/// Computes the cells. Reports captures that cannot dock.
///
/// `planar` is the name of the scene if its world is planar.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn lay_out(
    plan: &mut ExpandedProgram,
    liveness: &Liveness,
    planar: Option<&str>,
    symbols: &Symbols,
    sources: &Sources,
    cancellation: Cancellation<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Layout, Cancelled> {
    let count = plan.events.len();
    let mut seats: Vec<Option<AnchoredPosition>> = vec![None; plan.roles.count()];
    let mut taken: FxHashMap<Cell, RoleId> = FxHashMap::default();
    for seed in &plan.seeds {
        let seat = AnchoredPosition {
            cell: seed.cell,
            on: None,
        };
        if let Some(first) = taken.insert(seed.cell, seed.role) {
            let first = plan.seeds[first.0 as usize];
            diagnostics.push(
                Diagnostic::new(
                    Code::OccupiedCell,
                    format!("two seeds at ({}, {})", seed.cell.x, seed.cell.y),
                )
                .label(seed.location, "second seed")
                .label(first.location, "first seed")
                .help("move one of them to a free position of the plate"),
            );
        }
        seats[seed.role.0 as usize] = Some(seat);
    }
    let layout = Layout {
        cells: vec![None; count],
        parents: vec![None; count],
        vacated: Vec::new(),
        changes: Vec::new(),
        sizes: Vec::new(),
        emptied: Vec::new(),
    };
    let mut builder = LayoutBuilder {
        plan,
        liveness,
        planar,
        symbols,
        sources,
        cancellation,
        diagnostics,
        layout,
        seats,
        taken,
    };
    for phase in 0..builder.plan.phases.len() {
        builder.phase(phase)?;
    }
    Ok(builder.layout)
}

struct LayoutBuilder<'a> {
    plan: &'a mut ExpandedProgram,
    liveness: &'a Liveness,
    planar: Option<&'a str>,
    symbols: &'a Symbols,
    sources: &'a Sources,
    cancellation: Cancellation<'a>,
    diagnostics: &'a mut Vec<Diagnostic>,
    layout: Layout,
    /// For each role, the cell and the parent of its block if the block is attached when the phase
    /// starts.
    seats: Vec<Option<AnchoredPosition>>,
    /// Block in each cell when the phase starts.
    taken: FxHashMap<Cell, RoleId>,
}

impl LayoutBuilder<'_> {
    fn phase(&mut self, number: usize) -> Result<(), Cancelled> {
        let events: Vec<EventId> = self.plan.events_of(&self.plan.phases[number]).collect();
        // Releases of this phase by block.
        let mut leaving: FxHashMap<Holder, EventId> = FxHashMap::default();
        for &id in &events {
            let event = self.plan.event(id);
            if event.valid && event.kind == EventKind::Release {
                leaving.insert(self.liveness.actor(self.plan, id), id);
            }
        }
        let arrivals = self.captures(&events, &leaving)?;
        for &id in &events {
            let event = *self.plan.event(id);
            if event.valid && event.kind == EventKind::Release {
                let context = self.liveness.contexts[id.0 as usize];
                let (cell, on) = match context.anchored_by {
                    Some(capture) => {
                        let i = capture.0 as usize;
                        (self.layout.cells[i], self.layout.parents[i])
                    }
                    None => {
                        let seat = self.seats[event.role.0 as usize];
                        (seat.map(|seat| seat.cell), seat.and_then(|seat| seat.on))
                    }
                };
                self.layout.cells[id.0 as usize] = cell;
                self.layout.parents[id.0 as usize] = on;
            }
        }
        self.adrift(&events, &leaving, &arrivals)?;
        self.settle(&events, &leaving);
        Ok(())
    }

    /// Computes the cells of the captures of a phase. If several captures fill one cell, the first
    /// one is kept.
    fn captures(
        &mut self,
        events: &[EventId],
        leaving: &FxHashMap<Holder, EventId>,
    ) -> Result<FxHashMap<Cell, EventId>, Cancelled> {
        let mut arrivals: FxHashMap<Cell, EventId> = FxHashMap::default();
        // Captures whose parent has no cell yet.
        let mut waiting: FxHashMap<EventId, Vec<EventId>> = FxHashMap::default();
        let mut ready: Vec<EventId> = Vec::new();
        for &id in events {
            let event = self.plan.event(id);
            if !event.valid || event.kind == EventKind::Release {
                continue;
            }
            match self.liveness.contexts[id.0 as usize].anchored_by {
                Some(parent) if self.layout.cells[parent.0 as usize].is_none() => {
                    waiting.entry(parent).or_default().push(id);
                }
                _ => ready.push(id),
            }
            while let Some(id) = ready.pop() {
                self.cancellation.check()?;
                self.place(id, leaving, &mut arrivals);
                if let Some(children) = waiting.remove(&id) {
                    ready.extend(children.into_iter().rev());
                }
            }
        }
        Ok(arrivals)
    }

    /// Computes the cell of one capture.
    fn place(
        &mut self,
        id: EventId,
        leaving: &FxHashMap<Holder, EventId>,
        arrivals: &mut FxHashMap<Cell, EventId>,
    ) {
        let event = *self.plan.event(id);
        let EventKind::Capture { parent, face } = event.kind else {
            return;
        };
        let base = match self.liveness.contexts[id.0 as usize].anchored_by {
            Some(capture) => {
                let i = capture.0 as usize;
                self.layout.cells[i].map(|cell| AnchoredPosition {
                    cell,
                    on: self.layout.parents[i],
                })
            }
            None => self.seats[parent.0 as usize],
        };
        let Some(base) = base else { return };
        let on = Attachment {
            parent,
            face,
            capture: id,
        };
        self.layout.parents[id.0 as usize] = Some(on);
        if !self.is_free_face(id, base, face) {
            return;
        }
        let Some(cell) = base.cell.across(face) else {
            return;
        };
        // A block in the ground has been reported. Its children need no message.
        self.layout.cells[id.0 as usize] = Some(cell);
        if cell.z < 1 {
            let name = self.plan.roles.name(event.role, self.symbols);
            self.reject(
                id,
                Diagnostic::about(
                    Code::BelowPlate,
                    "`{}` would be inside the ground",
                    &[&name],
                )
                .label(event.location, format!("it takes cell {cell}"))
                .help("capture it higher: the plate is layer z = 0, and blocks start at z = 1"),
            );
            return;
        }
        if let Some(&there) = self.taken.get(&cell) {
            match leaving.get(&Holder::existing(there)) {
                Some(&release) => self.layout.vacated.push((release, id)),
                None if self.plan.is_uncertain(there) => {
                    self.plan.events[id.0 as usize].valid = false;
                    return;
                }
                None => {
                    let location = match self.seats[there.0 as usize].and_then(|seat| seat.on) {
                        Some(on) => self.plan.event(on.capture).location,
                        None => event.location,
                    };
                    let diagnostic = self.occupied(id, cell, there, location);
                    self.reject(id, diagnostic);
                    return;
                }
            }
        }
        if let Some(&first) = arrivals.get(&cell) {
            let first = *self.plan.event(first);
            let diagnostic = if first.location == event.location {
                self.occupied_again(id, cell, first.role)
            } else {
                self.occupied(id, cell, first.role, first.location)
            };
            self.reject(id, diagnostic);
            return;
        }
        arrivals.insert(cell, id);
    }

    fn is_free_face(&mut self, id: EventId, base: AnchoredPosition, face: Face) -> bool {
        let event = *self.plan.event(id);
        let EventKind::Capture { parent, .. } = event.kind else {
            return true;
        };
        let name = self.plan.roles.name(parent, self.symbols);
        if let (Some(scene), Face::Up | Face::Down) = (self.planar, face) {
            let site = format!("{name}.{face}");
            let title = "`{}` points out of the plane of scene `{}`";
            self.reject(
                id,
                Diagnostic::about(Code::OutOfPlane, title, &[&site, scene])
                    .label(event.location, "blocks move only in the plane")
                    .help(format!(
                        "use `{name}.north`, `{name}.east`, `{name}.south` or `{name}.west`, or a scene without `world planar`"
                    )),
            );
            return false;
        }
        match base.on {
            None if face != Face::Up && self.planar.is_none() => {
                self.reject(
                    id,
                    Diagnostic::about(
                        Code::EmbeddedFace,
                        "`{}` is inside the plate",
                        &[&format!("{name}.{face}")],
                    )
                    .label(event.location, "no block can reach this face")
                    .help(format!("seeds capture with `up` only: `{name}.up`"))
                    .fix_if(self.other_face(
                        event.location,
                        &name,
                        face,
                        Face::Up,
                    )),
                );
                false
            }
            Some(on) if on.face.opposite() == face => {
                let capture = self.plan.event(on.capture).location;
                let parent = self.plan.roles.name(on.parent, self.symbols);
                self.reject(
                    id,
                    Diagnostic::about(
                        Code::AnchoringFace,
                        "`{}` is already attached to `{}`",
                        &[&format!("{name}.{face}"), &parent],
                    )
                    .label(event.location, "used here")
                    .label(capture, "attached here")
                    .help(format!("use another face, such as `{name}.{}`", on.face))
                    .fix_if(self.other_face(
                        event.location,
                        &name,
                        face,
                        on.face,
                    )),
                );
                false
            }
            _ => true,
        }
    }

    /// Returns a fix that replaces the face in a capture. Returns `None` if the source differs
    /// there.
    fn other_face(
        &self,
        capture: SourceLocation,
        name: &str,
        face: Face,
        other: Face,
    ) -> Option<Fix> {
        let location = named(self.sources, capture, &format!("{name}.{face}"))?;
        let text = format!("{name}.{other}");
        Some(Fix::replace(location, &text, format!("write `{text}`")).unsafe_if(true))
    }

    /// Returns the error for two captures that fill the same cell.
    fn occupied(
        &self,
        id: EventId,
        cell: Cell,
        first: RoleId,
        location: SourceLocation,
    ) -> Diagnostic {
        let event = self.plan.event(id);
        let name = self.plan.roles.name(event.role, self.symbols);
        let first = self.plan.roles.name(first, self.symbols);
        let cell = cell.to_string();
        let format = "`{}` and `{}` both take cell {}";
        Diagnostic::about(Code::OccupiedCell, format, &[&first, &name, &cell])
            .label(event.location, format!("`{name}` would be here too"))
            .label(location, format!("`{first}` is here"))
            .help(format!(
                "capture `{name}` through another face, or release `{first}` in an earlier phase"
            ))
    }

    /// Returns the error for one statement that captures two blocks into the same cell.
    fn occupied_again(&self, id: EventId, cell: Cell, first: RoleId) -> Diagnostic {
        let event = self.plan.event(id);
        let name = self.plan.roles.name(event.role, self.symbols);
        let first = self.plan.roles.name(first, self.symbols);
        let cell = cell.to_string();
        let format = "`{}` and `{}` both take cell {}";
        let diagnostic = Diagnostic::about(Code::OccupiedCell, format, &[&first, &name, &cell])
            .label(event.location, "this statement captures both");
        match row_hint(self.sources, event.location) {
            Some((row, fix)) => {
                let help = format!("write a row of blocks instead of the loop: `{row}`");
                diagnostic.help(help).fix(fix)
            }
            None => diagnostic.help("capture each block through a face of its own"),
        }
    }

    fn reject(&mut self, id: EventId, diagnostic: Diagnostic) {
        self.plan.events[id.0 as usize].valid = false;
        report(self.diagnostics, diagnostic);
    }

    /// Reports releases that leave a child without a parent. Also records which child must be
    /// released before its parent.
    fn adrift(
        &mut self,
        events: &[EventId],
        leaving: &FxHashMap<Holder, EventId>,
        arrivals: &FxHashMap<Cell, EventId>,
    ) -> Result<(), Cancelled> {
        for &id in events {
            self.cancellation.check()?;
            let event = *self.plan.event(id);
            let Some(cell) = self.layout.cells[id.0 as usize] else {
                continue;
            };
            if !event.valid || event.kind != EventKind::Release {
                continue;
            }
            let parent = self.liveness.actor(self.plan, id);
            for face in Face::ALL {
                let Some(neighbour) = cell.across(face) else {
                    continue;
                };
                for (child, capture) in self.children(parent, neighbour, arrivals) {
                    if let Some(&release) = leaving.get(&child) {
                        self.layout.emptied.push((release, id));
                        continue;
                    }
                    if self.plan.is_uncertain(child.role) {
                        self.plan.events[id.0 as usize].valid = false;
                        continue;
                    }
                    let name = self.plan.roles.name(event.role, self.symbols);
                    let is_reused = leaving.contains_key(&Holder::existing(child.role));
                    let is_new = child.since.is_some();
                    let child = self.plan.roles.name(child.role, self.symbols);
                    let help = match (is_new, is_reused) {
                        (false, _) => {
                            format!("release `{child}` too, in this phase or earlier")
                        }
                        (true, false) => format!("release `{child}` too, in this phase"),
                        (true, true) => format!(
                            "release `{name}` in a later phase, together with the new `{child}`: this phase releases an \
                             earlier `{child}`"
                        ),
                    };
                    let location = self.plan.event(capture).location;
                    let written = named(self.sources, event.location, &name);
                    let written = written.filter(|&it| it == event.location && !is_reused);
                    let both = format!("{child}, {name}");
                    let fix = written.map(|location| {
                        Fix::replace(location, &both, format!("release `{child}` too"))
                            .unsafe_if(true)
                    });
                    self.reject(
                        id,
                        Diagnostic::about(
                            Code::Adrift,
                            "releasing `{}` would set `{}` adrift",
                            &[&name, &child],
                        )
                        .label(event.location, format!("`{name}` is released"))
                        .label(location, format!("`{child}` is attached to `{name}`"))
                        .help(help)
                        .fix_if(fix),
                    );
                }
            }
        }
        Ok(())
    }

    /// Returns the blocks attached to `parent` in a cell during the phase, with their captures. A
    /// cell can have two: the block at the start of the phase, and its replacement.
    fn children(
        &self,
        parent: Holder,
        cell: Cell,
        arrivals: &FxHashMap<Cell, EventId>,
    ) -> impl Iterator<Item = (Holder, EventId)> + use<> {
        let there = self.taken.get(&cell).filter(|_| parent.since.is_none());
        let there = there.and_then(|&child| {
            let on = self.seats[child.0 as usize].and_then(|seat| seat.on)?;
            (on.parent == parent.role).then_some((Holder::existing(child), on.capture))
        });
        let arrives = arrivals.get(&cell).and_then(|&capture| {
            let child = Holder::captured(self.plan.event(capture).role, capture);
            (self.liveness.actor(self.plan, capture) == parent).then_some((child, capture))
        });
        there.into_iter().chain(arrives)
    }

    /// Updates the structure at the end of the phase.
    fn settle(&mut self, events: &[EventId], leaving: &FxHashMap<Holder, EventId>) {
        let (mut emptied, mut filled) = (Vec::new(), Vec::new());
        for &id in events {
            let event = *self.plan.event(id);
            if event.valid
                && event.kind == EventKind::Release
                && self.liveness.contexts[id.0 as usize].anchored_by.is_none()
                && let Some(seat) = self.seats[event.role.0 as usize].take()
            {
                self.taken.remove(&seat.cell);
                emptied.push(seat.cell);
            }
        }
        for &id in events {
            let event = *self.plan.event(id);
            let i = id.0 as usize;
            let (Some(cell), EventKind::Capture { .. }) = (self.layout.cells[i], event.kind) else {
                continue;
            };
            let is_brief = leaving.contains_key(&Holder::captured(event.role, id));
            if event.valid && !is_brief {
                self.taken.insert(cell, event.role);
                filled.push(cell);
                self.seats[event.role.0 as usize] = Some(AnchoredPosition {
                    cell,
                    on: self.layout.parents[i],
                });
            }
        }
        self.layout
            .sizes
            .push((self.taken.len() - self.plan.seeds.len().min(self.taken.len())) as u32);
        self.layout.changes.push((emptied, filled));
    }
}
