//! Checks that the scene has enough blocks and space.
use stochc_grammar::{Cancellation, Cancelled};
use stochc_ir::scene::room::NoRoom;
use stochc_ir::scene::{BondKind, Enclosure, Extent, Scene};
use stochc_text::{counted, series};

use crate::blocks::block_demand::first_beyond;
use crate::dependencies::graph::DependencyGraph;
use crate::dependencies::order::Order;
use crate::diagnostic::{Code, Diagnostic};
use crate::expanded::{EventKind, ExpandedProgram};
use crate::shapes::layout::Layout;

/// Checks that the blocks of an aggregate can bond to each other, and that the scene has enough of
/// them.
pub fn check_aggregate(plan: &ExpandedProgram, scene: &Scene, diagnostics: &mut Vec<Diagnostic>) {
    if !BondKind::from_scene(scene).is_passive() {
        let (state, what) = match &scene.bond {
            Some(bond) => (
                format!("has `bond {}`", bond.kind().name()),
                "free blocks do not attract",
            ),
            None => ("has no `bond`".to_owned(), "nothing bonds"),
        };
        diagnostics.push(
            Diagnostic::new(
                Code::CannotAggregate,
                format!(
                    "aggregate `{}` cannot form: free blocks do not bond in scene `{}`",
                    plan.name, scene.name
                ),
            )
            .label(plan.location, format!("the scene {state}: {what}"))
            .help(format!(
                "use a scene with `bond reject`: `aggregate {} in magnet_tank`",
                plan.name
            )),
        );
    }
    let free = scene.free.count;
    if let (Some(size), Some(phase)) = (
        plan.aggregate.filter(|size| *size > free),
        plan.phases.first(),
    ) {
        diagnostics.push(
            Diagnostic::new(
                Code::TooFewBlocks,
                format!(
                    "aggregate `{}` needs {}, but scene `{}` has {free}",
                    plan.name,
                    counted(size as usize, "free block"),
                    scene.name
                ),
            )
            .label(phase.location, "this size can never be reached")
            .help(format!(
                "write `free {size} uniform` in the scene, or choose a smaller size"
            )),
        );
    }
}

/// Checks that the free blocks have enough space at the start. Models without physics do not need
/// this.
pub fn check_room(plan: &ExpandedProgram, scene: &Scene, diagnostics: &mut Vec<Diagnostic>) {
    let seeds: Vec<_> = plan.seeds.iter().map(|seed| seed.cell).collect();
    let Err(error) = scene.has_room(&plan.plate, &seeds) else {
        return;
    };
    let help = match error {
        NoRoom::DoesNotFit { .. } => {
            let lengths = scene.enclosure.iter().flat_map(Enclosure::lengths);
            let names: Vec<String> = lengths.map(|(name, _)| format!("`{name}`")).collect();
            let names = series(&names, "or");
            format!("write fewer `free` blocks, or a larger {names} of the enclosure")
        }
        NoRoom::OnRing { .. } => {
            "write fewer `free` blocks, or another radius of the circle".to_owned()
        }
        NoRoom::NoEnclosure { .. } => "add an `enclosure` to the scene".to_owned(),
    };
    diagnostics.push(
        Diagnostic::new(Code::TooManyBlocks, error.to_string())
            .label(
                plan.location,
                format!("scene `{}` cannot be simulated with physics", scene.name),
            )
            .help(help),
    );
}

/// Compares a program with its scene.
///
/// `order` contains a possible order of the events, and the dependencies that hold in every order.
/// `None` if the dependencies have a cycle.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn check(
    plan: &ExpandedProgram,
    layout: &Layout,
    order: Option<(&Order, &DependencyGraph)>,
    scene: &Scene,
    cancellation: Cancellation<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<(), Cancelled> {
    let free = scene.free.count;
    let largest = (layout.sizes.iter().zip(&plan.phases)).max_by_key(|(size, _)| **size);
    let needed = match (largest, order) {
        (Some((&size, phase)), _) if size > free => Some((
            size,
            phase.location,
            format!("{} attached at the end of this phase", are(size)),
            "build a smaller structure",
        )),
        (_, Some((order, certain))) => {
            let found = first_beyond(plan, layout, certain, order, free, cancellation)?;
            found.map(|(event, size)| {
                let event = plan.event(event);
                let when = match event.kind {
                    EventKind::Capture { .. } => "after this capture",
                    EventKind::Release => "before this release",
                };
                let label = format!("at least {} attached {when}", are(size));
                let location = event.location;
                (size, location, label, "release blocks earlier")
            })
        }
        _ => None,
    };
    if let Some((size, location, label, or)) = needed {
        let needed = counted(size as usize, "free block");
        diagnostics.push(
            Diagnostic::new(
                Code::TooFewBlocks,
                format!(
                    "`{}` needs {needed} at once, but scene `{}` has {free}",
                    plan.name, scene.name
                ),
            )
            .label(location, label)
            .help(format!("write `free {size} uniform` in the scene, or {or}")),
        );
    }
    check_terms(plan, layout, scene, diagnostics);
    Ok(())
}

/// Returns the start of a sentence: `1 block is` or `3 blocks are`.
fn are(size: u32) -> String {
    let verb = if size == 1 { "is" } else { "are" };
    format!("{} {verb}", counted(size as usize, "block"))
}

/// Checks that the scene can bond blocks, and that its enclosure contains the structure.
fn check_terms(
    plan: &ExpandedProgram,
    layout: &Layout,
    scene: &Scene,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let captures =
        |event: &&crate::expanded::ExpandedEvent| matches!(event.kind, EventKind::Capture { .. });
    if let (None, Some(first)) = (&scene.bond, plan.events.iter().find(captures)) {
        let title = format!("scene `{}` has no `bond`", scene.name);
        diagnostics.push(
            Diagnostic::new(Code::MissingTerm, title)
                .label(first.location, "no block can be captured")
                .help("add it to the scene: `bond attract { pull 15 N within 20cm  anchor centres 1mm }`"),
        );
    }
    let Some(enclosure) = &scene.enclosure else {
        return;
    };
    let side = scene.block.side;
    if let Some(diagnostic) = plate_outside(plan, enclosure, side) {
        diagnostics.push(diagnostic);
        return;
    }
    let outside = plan
        .events
        .iter()
        .zip(&layout.cells)
        .find_map(|(event, cell)| {
            let cell = (*cell)
                .filter(|_| event.valid && matches!(event.kind, EventKind::Capture { .. }))?;
            let mut extents = enclosure.extents(cell, &plan.plate, side).into_iter();
            let extent = extents.find(Extent::is_outside)?;
            Some((event, cell, extent))
        });
    if let Some((event, cell, extent)) = outside {
        let dimension = extent.dimension;
        diagnostics.push(
            Diagnostic::new(
                Code::OutsideEnclosure,
                format!(
                    "`{}` leaves the enclosure of scene `{}`",
                    plan.name, scene.name
                ),
            )
            .label(
                event.location,
                format!("the block at {cell} reaches {}", compared(&extent)),
            )
            .help(format!(
                "write a larger `{dimension}` in the scene, or build a smaller structure"
            )),
        );
    }
}

/// Returns how far a structure reaches and how far it may reach, as the end of a sentence.
fn compared(extent: &Extent) -> String {
    let (reached, limit) = distinct(extent.reached, extent.limit);
    let Extent {
        origin, limited_by, ..
    } = extent;
    format!("{reached} m {origin}, {limited_by} is {limit} m")
}

/// Returns two numbers with enough digits to distinguish them.
fn distinct(one: f64, other: f64) -> (String, String) {
    let written = |digits: usize| (format!("{one:.digits$}"), format!("{other:.digits$}"));
    let differ = |(one, other): &(String, String)| one != other;
    let mut pairs = (2..17).map(written);
    pairs.find(differ).unwrap_or_else(|| written(17))
}

/// Checks that the plate lies within the enclosure. Returns a diagnostic if it does not.
fn plate_outside(plan: &ExpandedProgram, enclosure: &Enclosure, side: f64) -> Option<Diagnostic> {
    let (width, depth) = (plan.plate.width, plan.plate.depth);
    let extents = enclosure.plate_extents(f64::from(width), f64::from(depth), side);
    let extent = extents.into_iter().find(Extent::is_outside)?;
    let dimension = extent.dimension;
    let title = format!("the plate of `{}` is larger than the enclosure", plan.name);
    let label = format!(
        "the corners of the {width} x {depth} plate are {}",
        compared(&extent)
    );
    let help = format!("write a larger `{dimension}` in the scene, or a smaller plate");
    let diagnostic = Diagnostic::new(Code::OutsideEnclosure, title);
    Some(diagnostic.label(plan.location, label).help(help))
}
