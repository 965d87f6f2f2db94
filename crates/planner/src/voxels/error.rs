//! Why a file of voxels cannot be read.
use stochc_ir::{counted, listed};
use thiserror::Error;

use crate::limits::{FARTHEST, MAX_CELLS, MAX_VOXEL_PARTS};

/// Why a file holds no target.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum UnreadableVoxels {
    /// It is not a file of MagicaVoxel.
    #[error("it does not begin as a `.vox` file does")]
    NotVox,
    /// It ends too soon.
    #[error("it is cut off")]
    CutOff,
    /// Nothing in it is a model.
    #[error("it holds no model")]
    NoModel,
    /// A model comes before its size.
    #[error("model {model} has no size")]
    NoSize {
        /// The number of the model, from 0.
        model: u32,
    },
    /// There are several models, and no scene places them.
    #[error("it holds {}: choose one with `--model`", several(.models))]
    SeveralModels {
        /// The numbers of those that have voxels, with how many.
        models: Vec<(u32, usize)>,
    },
    /// It does not have a model of this number.
    #[error("it has no model {model}: its {} are numbered from 0", counted(*.count, "model"))]
    UnknownModel {
        /// The number that was asked for.
        model: u32,
        /// How many there are.
        count: usize,
    },
    /// The scene shows a model nowhere.
    #[error("its scene does not show model {model}: it is hidden or not placed")]
    UnplacedModel {
        /// The number that was asked for.
        model: u32,
    },
    /// A shape shows one model after the other.
    #[error("node {node} is an animation of models {}: choose one with `--model`", numbers(.models))]
    Animation {
        /// The shape.
        node: u32,
        /// The numbers of its models.
        models: Vec<u32>,
    },
    /// A transform changes with time.
    #[error("node {node} moves: its keyframes differ, and only models at rest are planned")]
    Moves {
        /// The transform.
        node: u32,
    },
    /// Two nodes have one number.
    #[error("it has two nodes {node}")]
    DuplicateNode {
        /// The number.
        node: u32,
    },
    /// A node that is referred to is not there.
    #[error("node {from} refers to node {to}, which is missing")]
    MissingNode {
        /// Refers to it.
        from: u32,
        /// Is missing.
        to: u32,
    },
    /// A model that is referred to is not there.
    #[error("node {node} refers to model {model}, which is missing")]
    MissingModel {
        /// Refers to it.
        node: u32,
        /// Is missing.
        model: u32,
    },
    /// The scene is no tree.
    #[error("node {node} has two parents, or is part of a cycle")]
    NotATree {
        /// One such node.
        node: u32,
    },
    /// A rotation is none.
    #[error("node {node}: `{text}` is not a rotation")]
    Rotation {
        /// The transform.
        node: u32,
        /// As it is written.
        text: String,
    },
    /// A translation is none.
    #[error("node {node}: `{text}` is not a translation")]
    Translation {
        /// The transform.
        node: u32,
        /// As it is written.
        text: String,
    },
    /// It has too many nodes and models.
    #[error("it has more than {MAX_VOXEL_PARTS} models, nodes and layers")]
    TooManyParts,
    /// Voxels are placed too far away to be counted with.
    #[error("node {node} lies too far away: coordinates go to {FARTHEST}")]
    TooFar {
        /// The shape.
        node: u32,
    },
    /// There are too many.
    #[error("a target has at most {MAX_CELLS} cells")]
    TooLarge,
    /// A row has another character than those of blocks and of none.
    #[error("line {line}: {character:?} is neither `#`, a block, nor `.`, none")]
    Character {
        /// Its line, from 1.
        line: usize,
        /// The character.
        character: char,
    },
}

/// Numbers that are listed, at most.
const LISTED: usize = 8;

fn several(models: &[(u32, usize)]) -> String {
    let told = models.iter().take(LISTED);
    let told: Vec<String> = told
        .map(|(model, voxels)| format!("{model} ({})", counted(*voxels, "voxel")))
        .collect();
    let listed = listed(&told, models.len());
    format!("{} and no scene: {listed}", counted(models.len(), "model"))
}

fn numbers(models: &[u32]) -> String {
    let told: Vec<String> = models.iter().take(LISTED).map(u32::to_string).collect();
    listed(&told, models.len())
}
