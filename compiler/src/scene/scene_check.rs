//! Checks whether a scene works for a program.
use std::ops::RangeInclusive;

use stochc_ir::scene::Scene;
use stochc_ir::scene::warnings::{SceneWarning, SceneWarningKind, Stepping, scene_warnings};

use crate::SourceLocation;
use crate::diagnostic::{Code, Diagnostic, report};
use crate::expanded::{EventKind, ExpandedProgram};
use crate::shapes::layout::Layout;

impl From<SceneWarningKind> for Code {
    fn from(kind: SceneWarningKind) -> Code {
        match kind {
            SceneWarningKind::BuoyantBlocks => Code::BuoyantBlocks,
            SceneWarningKind::NoAgitation => Code::NoAgitation,
            SceneWarningKind::CoarseStep => Code::CoarseStep,
            SceneWarningKind::SoftContact => Code::SoftContact,
            SceneWarningKind::StokesDrag => Code::StokesDrag,
        }
    }
}

/// Reports the reasons why a scene does not work, one diagnostic per code, and returns them.
///
/// `location` is the scene's name in the program, or the program's name if it names no scene.
pub fn check(
    scene: &Scene,
    layers: Option<RangeInclusive<i32>>,
    stepping: Stepping,
    location: SourceLocation,
    diagnostics: &mut Vec<Diagnostic>,
) -> Vec<SceneWarning> {
    let found = scene_warnings(scene, stepping, layers);
    for of_kind in found.chunk_by(|one, other| one.kind == other.kind) {
        report(diagnostics, diagnostic(scene, of_kind, location));
    }
    found
}

/// Returns one diagnostic for warnings of one kind.
fn diagnostic(scene: &Scene, warnings: &[SceneWarning], location: SourceLocation) -> Diagnostic {
    let first = &warnings[0];
    let title = format!("in scene `{}`, {}", scene.name, first.effect);
    let mut remedies: Vec<&str> = Vec::new();
    for warning in warnings {
        if !remedies.contains(&warning.remedy.as_str()) {
            remedies.push(&warning.remedy);
        }
    }
    let mut help = remedies.join("; ");
    for warning in &warnings[1..] {
        help.push_str(&format!("\nalso: {}: {}", warning.figure, warning.effect));
    }
    Diagnostic::new(first.kind.into(), title)
        .label(location, first.figure.clone())
        .help(help)
}

/// Returns the lowest and the highest layer of a program's captures. Returns `None` without
/// captures.
pub fn layers(plan: &ExpandedProgram, layout: &Layout) -> Option<RangeInclusive<i32>> {
    let phases = plan.phases.iter().filter(|phase| !phase.pre_attached);
    let events = phases.flat_map(|phase| plan.events_of(phase));
    let captures = events.filter(|&id| matches!(plan.event(id).kind, EventKind::Capture { .. }));
    let heights = captures.filter_map(|id| Some((*layout.cells.get(id.0 as usize)?)?.z));
    heights.fold(None, |layers: Option<RangeInclusive<i32>>, z| {
        let (low, high) = layers.map_or((z, z), RangeInclusive::into_inner);
        Some(low.min(z)..=high.max(z))
    })
}
