//! A scene term by term: what is in force and what is not.
mod bond;
mod clauses;
mod medium;
mod value;
mod write;

use serde::Serialize;

pub use self::value::Value;
use self::value::Values;
use super::groups::BlockUnits;
use super::{Bond, Scene};

/// A term that a scene has.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Term {
    /// Its clause: `drag`.
    pub clause: &'static str,
    /// The clause as it can be written in a scene, with all its fields.
    pub text: String,
    /// What it makes a runtime compute, at least one.
    pub laws: Vec<Law>,
}

/// One thing that a term does.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Law {
    /// In words.
    pub meaning: &'static str,
    /// In the symbols of the values, in plain text; `None`: there is nothing to compute.
    pub equation: Option<&'static str>,
    /// The values in it.
    pub values: Vec<Value>,
}

/// A term that a scene does not have, and that is not computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Absent {
    /// What would stand in the scene.
    pub clause: &'static str,
    /// What that means, as a clause.
    pub meaning: &'static str,
}

/// The terms of a scene, in the order of the reference.
pub fn terms(scene: &Scene) -> Vec<Term> {
    let values = Values(BlockUnits::of(scene));
    let mut out = vec![values.tick(scene), values.block(scene), values.free(scene)];
    out.extend(scene.enclosure.iter().map(|it| values.enclosure(it)));
    out.extend(scene.gravity.iter().map(|&it| values.gravity(it, scene)));
    out.extend(scene.fluid.iter().map(|it| values.fluid(it)));
    out.extend(scene.flow.iter().map(|it| values.flow(it)));
    out.extend((scene.agitation.iter()).map(|it| values.agitation(it, scene)));
    out.extend(scene.drag.iter().map(|it| values.drag(it)));
    out.extend(scene.contact.iter().map(|it| values.contact(it)));
    out.extend(scene.bond.iter().map(|it| values.bond(it)));
    out.extend(scene.messages.iter().map(|it| values.messages(it)));
    out
}

/// The terms that a scene could have and does not.
pub fn absent(scene: &Scene) -> Vec<Absent> {
    let align = match &scene.bond {
        Some(Bond::Attract { align, .. }) => align.is_some(),
        _ => true,
    };
    let loss = (scene.messages.as_ref()).is_none_or(|messages| messages.loss.is_some());
    let all = [
        (
            scene.enclosure.is_some(),
            "enclosure",
            "nothing keeps the blocks together",
        ),
        (
            scene.gravity.is_some(),
            "gravity",
            "blocks neither sink nor rise",
        ),
        (
            scene.fluid.is_some(),
            "fluid",
            "blocks float in nothing that could take them along",
        ),
        (
            scene.flow.is_some() || scene.fluid.is_none(),
            "flow",
            "the fluid is at rest on the average",
        ),
        (
            scene.agitation.is_some(),
            "agitation",
            "nothing moves the blocks by chance",
        ),
        (
            scene.drag.is_some() || scene.fluid.is_some(),
            "drag",
            "between collisions blocks keep their speed",
        ),
        (
            scene.contact.is_some(),
            "contact",
            "blocks pass through each other and the floor",
        ),
        (scene.bond.is_some(), "bond", "nothing is ever captured"),
        (
            align,
            "bond attract { align }",
            "only the pull turns a block towards a magnetized face",
        ),
        (
            scene.messages.is_some(),
            "messages",
            "a message arrives in the tick in which it is sent",
        ),
        (loss, "messages { loss }", "no message is lost"),
    ];
    all.into_iter()
        .filter(|&(is_there, ..)| !is_there)
        .map(|(_, clause, meaning)| Absent { clause, meaning })
        .collect()
}
