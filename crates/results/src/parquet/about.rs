//! Metadata of Parquet files about their ensemble, as pairs of keys and values.
use serde_json::json;

use crate::{EnsembleProgram, Manifest};

/// Returns the metadata of all tables of an ensemble.
pub(super) fn about(manifest: &Manifest) -> Vec<(&'static str, String)> {
    let programs: Vec<_> = manifest.programs.iter().map(program).collect();
    let mut about = vec![
        ("stochc.version", manifest.stochc.clone()),
        ("stochc.ensemble", manifest.identity()),
        ("stochc.model", manifest.settings.model.name().to_owned()),
        ("stochc.substeps", manifest.settings.steps().to_string()),
        ("stochc.settings", json!(manifest.settings).to_string()),
        ("stochc.seed", manifest.seed.to_string()),
        ("stochc.runs", manifest.runs.to_string()),
        ("stochc.programs", json!(programs).to_string()),
    ];
    if let Some(limit) = manifest.settings.max_ticks {
        about.push(("stochc.max_ticks", limit.to_string()));
    }
    // A property is stored once if all programs share it, otherwise per program.
    let mut shared = |key, of: fn(&EnsembleProgram) -> f64| {
        let mut values = manifest.programs.iter().map(of);
        if let Some(first) = values.next()
            && values.all(|value| value == first)
        {
            about.push((key, first.to_string()));
        }
    };
    shared("stochc.tick_s", |program| program.scene.tick);
    shared("stochc.side_m", |program| program.scene.block.side);
    about
}

fn program(program: &EnsembleProgram) -> serde_json::Value {
    let phases = (program.phases().iter())
        .map(|phase| json!({ "name": phase.name, "pre_attached": phase.pre_attached }));
    let phases: Vec<_> = phases.collect();
    let mut about = json!({
        "name": program.name,
        "assembly": program.assembly(),
        "scene": program.scene.name,
        "tick_s": program.scene.tick,
        "side_m": program.scene.block.side,
        "varied": program.varied,
        "phases": phases,
        "roles": program.roles().iter().map(|role| &role.name).collect::<Vec<_>>(),
    });
    if !program.chosen.is_empty() {
        about["chosen"] = json!(program.chosen);
    }
    about
}
