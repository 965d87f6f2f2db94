//! Data of a replay page, apart from the recording.
use serde_json::{Value, json};
use stochc_ir::emit::{graph_json, shell_json, table_json};
use stochc_results::{EnsembleProgram, Manifest};
use stochc_text::visible;

use super::program_text::{EventLocation, program_text};

/// Returns the JSON data of a replay page: `{ program, file, seed, model, stochc, scene, shell,
/// tables, graph, text, tour, guided }`. `scene` is the scene as in the manifest. `shell` is the
/// enclosure as in [`shell_json`]. `tables` and `graph` are as in `compile --format json`. `text`
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
    let shell = shell_json(&program.scene, &tables.plate);
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
        "shell": shell,
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
