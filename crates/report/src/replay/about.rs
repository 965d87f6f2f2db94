//! Data of a replay page, apart from the recording.
use serde_json::{Value, json};
use stochc_ir::emit::{graph_json, table_json};
use stochc_results::{EnsembleProgram, Manifest};
use stochc_text::visible;

use super::program_text::{EventLocation, program_text};

/// Returns the JSON data of a replay page: `{ program, file, seed, model, stochc, scene, radius,
/// lift, tables, graph, text, tour, guided }`. `scene` is the scene as in the manifest. `radius` is
/// the radius of the enclosure \[block lengths\], or null without an enclosure. `lift` is the
/// height of the enclosure's centre. `tables` and `graph` are as in `compile --format json`. `text`
/// is the source, split at the `statements`. `tour` is the [`tour`](super::tour()) of the run.
/// `guided` states whether the page begins with the tour.
pub fn about(
    manifest: &Manifest,
    program: &EnsembleProgram,
    statements: &[EventLocation],
    tour: Value,
    guided: bool,
) -> Value {
    let tables = program.tables();
    let scene = json!(program.scene);
    let side = program.scene.block.side;
    let enclosure = program.scene.enclosure.as_ref();
    let radius = enclosure.map(|enclosure| enclosure.radius() / side);
    let lift = enclosure.map_or(0.0, |it| it.centre_height(&tables.plate, side) / side);
    let file = program.sources.first().map_or("", |source| &source.path);
    let settings = manifest.settings_of(program);
    let substeps = settings.steps_in(&program.scene).in_words();
    let mut about = json!({
        "program": program.name,
        "file": file,
        "seed": manifest.seed.to_string(),
        "model": format!("{}, {substeps}", settings.model.name()),
        "stochc": manifest.stochc,
        "scene": scene,
        "radius": radius,
        "lift": lift,
        "tables": table_json(tables),
        "graph": graph_json(&program.compiled.graph, tables),
        "text": program_text(&program.sources, statements),
        "tour": tour,
        "guided": guided,
    });
    spell_out(&mut about);
    about
}

/// Replaces invisible characters in every text of a JSON value. Equal names stay equal.
fn spell_out(value: &mut Value) {
    match value {
        Value::String(text) => *text = visible(text),
        Value::Array(values) => values.iter_mut().for_each(spell_out),
        Value::Object(fields) => fields.values_mut().for_each(spell_out),
        _ => {}
    }
}
