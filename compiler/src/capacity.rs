//! Whether the scene has the blocks and the room.
use stochc_grammar::{Cancellation, Cancelled};
use stochc_ir::counted;
use stochc_ir::scene::room::NoRoom;
use stochc_ir::scene::{BondKind, Enclosure, Scene};

use crate::block_demand::first_beyond;
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::DependencyGraph;
use crate::layout::Layout;
use crate::order::Order;
use crate::plan::{EventKind, ProgramPlan};

/// Compares an aggregate with its scene: blocks have to bond to each other unasked, and there have to be enough.
pub fn check_aggregate(plan: &ProgramPlan, scene: &Scene, diagnostics: &mut Vec<Diagnostic>) {
    if !BondKind::from_scene(scene).is_passive() {
        let (said, what) = match &scene.bond {
            Some(bond) => (
                format!("has `bond {}`", bond.kind().name()),
                "not free ones",
            ),
            None => ("has no `bond`".to_owned(), "nothing bonds"),
        };
        diagnostics.push(
            Diagnostic::new(
                Code::CannotAggregate,
                format!(
                    "free blocks do not bond to each other in the scene `{}`",
                    scene.name
                ),
            )
            .label(plan.location, format!("the scene {said}: {what}"))
            .help(
                "name a scene with `bond reject`, where every face always attracts, such as \
                 `in magnet_tank`",
            ),
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
                    "the aggregate needs {}, the scene has {free}",
                    counted(size as usize, "free block")
                ),
            )
            .label(
                phase.location,
                format!("more than the {free} of `{}`", scene.name),
            )
            .help(format!(
                "a scene with `free {size}` or more, or a smaller aggregate"
            )),
        );
    }
}

/// Whether the free blocks of the scene have room at the beginning, which models without physics do not need.
pub fn check_room(plan: &ProgramPlan, scene: &Scene, diagnostics: &mut Vec<Diagnostic>) {
    let Err(error) = scene.has_room(&plan.plate) else {
        return;
    };
    let help = match error {
        NoRoom::DoesNotFit { .. } => "a scene with fewer blocks, or a larger radius",
        NoRoom::OnRing { .. } => "a scene with fewer blocks, or another radius of the circle",
        NoRoom::NoEnclosure { .. } => "a scene with an `enclosure`",
    };
    diagnostics.push(
        Diagnostic::new(Code::TooManyBlocks, error.to_string())
            .label(
                plan.location,
                format!(
                    "in the scene `{}`, which cannot be simulated with physics",
                    scene.name
                ),
            )
            .help(help),
    );
}

/// Compares a program with its scene; `order`: an order of it, with what surely comes before what, if it has one.
///
/// # Errors
///
/// [`Cancelled`] if nobody waits for it.
pub fn check(
    plan: &ProgramPlan,
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
            format!("anchored at the end of this phase: {size}"),
            "a smaller structure",
        )),
        (_, Some((order, certain))) => {
            let found = first_beyond(plan, layout, certain, order, free, cancellation)?;
            found.map(|(event, size)| {
                let event = plan.event(event);
                let when = match event.kind {
                    EventKind::Capture { .. } => "once this block docks",
                    EventKind::Release => "before this block may be let go",
                };
                let label = format!("anchored {when}: at least {size}");
                let location = event.location;
                (size, location, label, "releases that come sooner")
            })
        }
        _ => None,
    };
    if let Some((size, location, label, or)) = needed {
        let needed = counted(size as usize, "free block");
        diagnostics.push(
            Diagnostic::new(
                Code::TooFewBlocks,
                format!("the structure needs {needed} at once, the scene has {free}"),
            )
            .label(location, label)
            .help(format!(
                "a scene with `free {size} uniform` or more, or {or}"
            )),
        );
    }
    check_terms(plan, layout, scene, diagnostics);
    Ok(())
}

/// Whether the scene can bond blocks, and has the structure inside of its enclosure.
fn check_terms(
    plan: &ProgramPlan,
    layout: &Layout,
    scene: &Scene,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let captures =
        |event: &&crate::plan::PlanEvent| matches!(event.kind, EventKind::Capture { .. });
    if let (None, Some(first)) = (&scene.bond, plan.events.iter().find(captures)) {
        let title = format!("the scene `{}` has no `bond`", scene.name);
        diagnostics.push(
            Diagnostic::new(Code::MissingTerm, title)
                .label(first.location, "nothing can be captured in it")
                .help("add a clause such as `bond attract { pull 15 N within 20cm  anchor centres 1mm }`"),
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
    let radius = enclosure.radius();
    let outside = plan
        .events
        .iter()
        .zip(&layout.cells)
        .find_map(|(event, cell)| {
            let cell = (*cell)
                .filter(|_| event.sound && matches!(event.kind, EventKind::Capture { .. }))?;
            let distance = enclosure.distance_to(cell, &plan.plate, side);
            (distance > radius).then_some((event, cell, distance))
        });
    if let Some((event, cell, distance)) = outside {
        let (reached, limit) = distinct(distance, radius);
        diagnostics.push(
            Diagnostic::new(
                Code::OutsideEnclosure,
                "the structure grows out of the enclosure",
            )
            .label(
                event.location,
                format!(
                    "the block at {cell} reaches {reached} m from the centre, beyond {limit} m"
                ),
            )
            .help("a scene with a larger radius, or a smaller structure"),
        );
    }
}

/// Returns two numbers with as many digits as it takes to see which is larger.
fn distinct(one: f64, other: f64) -> (String, String) {
    let written = |digits: usize| (format!("{one:.digits$}"), format!("{other:.digits$}"));
    let differ = |(one, other): &(String, String)| one != other;
    let mut pairs = (2..17).map(written);
    pairs.find(differ).unwrap_or_else(|| written(17))
}

/// Compares the plate with the enclosure around it.
fn plate_outside(plan: &ProgramPlan, enclosure: &Enclosure, side: f64) -> Option<Diagnostic> {
    let (width, depth) = (plan.plate.width, plan.plate.depth);
    let corner = f64::from(width).hypot(f64::from(depth)) / 2.0 * side;
    let radius = enclosure.radius();
    (corner > radius).then(|| {
        let title = "the plate is larger than the enclosure";
        let (corner, radius) = distinct(corner, radius);
        let label = format!(
            "the corners of its {width} x {depth} plate are {corner} m from the centre, beyond {radius} m"
        );
        Diagnostic::new(Code::OutsideEnclosure, title)
            .label(plan.location, label)
            .help("a scene with a larger radius, or a smaller plate")
    })
}
