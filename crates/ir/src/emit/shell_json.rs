//! Enclosures as JSON.
use serde_json::{Value, json};

use crate::scene::{Enclosure, Scene};
use crate::table::plate::Plate;

/// Returns the surface of the enclosure in block lengths, for drawings. Null without an enclosure.
///
/// `{ kind, radius, lift }` for a `ball`, whose centre is at the height `lift`, `{ kind, length,
/// width, height }` for a `box`, and `{ kind, radius, height }` for a `cylinder`. A `disc`
/// is a `cylinder`, and a `rectangle` is a `box`, higher than the blocks.
pub fn shell_json(scene: &Scene, plate: &Plate) -> Value {
    let side = scene.block.side;
    let Some(enclosure) = &scene.enclosure else {
        return Value::Null;
    };
    let (kind, lift) = match enclosure {
        Enclosure::Hemisphere { .. } | Enclosure::Sphere { .. } => {
            ("ball", Some(enclosure.centre_height(plate, side) / side))
        }
        Enclosure::Box { .. } | Enclosure::Rectangle { .. } => ("box", None),
        Enclosure::Cylinder { .. } | Enclosure::Disc { .. } => ("cylinder", None),
    };
    let mut shell = json!({ "kind": kind });
    for (name, length) in enclosure.lengths() {
        shell[name] = json!(length / side);
    }
    if enclosure.is_flat() {
        shell["height"] = json!(1.5);
    }
    if let Some(lift) = lift {
        shell["lift"] = json!(lift);
    }
    shell
}
