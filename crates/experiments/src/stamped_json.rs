//! JSON documents about an ensemble.
use serde::Serialize;
use serde_json::json;
use stochc_results::Manifest;

/// Version of the format of `sweep.json` and `trade.json`.
const FORMAT: u32 = 1;

/// Returns a JSON document with `content` and three more fields: format, version of stochc and
/// identity of the ensemble.
pub(crate) fn stamped_json(content: &impl Serialize, manifest: &Manifest) -> String {
    let mut value = json!(content);
    value["format"] = FORMAT.into();
    value["stochc"] = json!(manifest.stochc);
    value["ensemble"] = manifest.identity().into();
    format!("{value:#}\n")
}
