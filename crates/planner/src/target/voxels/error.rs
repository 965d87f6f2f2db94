//! Errors of voxel files.
use stochc_text::{counted, listed};
use thiserror::Error;

use crate::target::limits::{FARTHEST, MAX_CELLS, MAX_VOXEL_PARTS};

/// Reason why a file contains no valid target.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum UnreadableVoxels {
    /// The file is not a MagicaVoxel file.
    #[error("it does not begin as a `.vox` file does")]
    NotVox,
    /// The file is truncated.
    #[error("it is cut off")]
    CutOff,
    /// The file contains no model.
    #[error("it holds no model")]
    NoModel,
    /// A model comes before its size.
    #[error("model {model} has no size")]
    NoSize {
        /// Number of the model, from 0.
        model: u32,
    },
    /// There are several models, and no scene that places them.
    #[error("it holds {}: choose one with `--model`", several(.models))]
    SeveralModels {
        /// Numbers and voxel counts of the models with voxels.
        models: Vec<(u32, usize)>,
    },
    /// The file does not have a model of this number.
    #[error("it has no model {model}: its {} are numbered from 0", counted(*.count, "model"))]
    UnknownModel {
        /// Requested number.
        model: u32,
        /// Number of models.
        count: usize,
    },
    /// The scene does not show the model.
    #[error("its scene does not show model {model}: it is hidden or not placed")]
    UnplacedModel {
        /// Requested number.
        model: u32,
    },
    /// A shape is an animation of several models.
    #[error("node {node} is an animation of models {}: choose one with `--model`", numbers(.models))]
    Animation {
        /// Number of the shape.
        node: u32,
        /// Numbers of its models.
        models: Vec<u32>,
    },
    /// A transform is animated.
    #[error("node {node} moves: its keyframes differ, and only models at rest are planned")]
    Moves {
        /// Number of the transform.
        node: u32,
    },
    /// Two nodes have the same number.
    #[error("it has two nodes {node}")]
    DuplicateNode {
        /// The number.
        node: u32,
    },
    /// A referenced node is missing.
    #[error("node {from} refers to node {to}, which is missing")]
    MissingNode {
        /// Number of the referring node.
        from: u32,
        /// Number of the missing node.
        to: u32,
    },
    /// A referenced model is missing.
    #[error("node {node} refers to model {model}, which is missing")]
    MissingModel {
        /// Number of the referring node.
        node: u32,
        /// Number of the missing model.
        model: u32,
    },
    /// The scene is not a tree.
    #[error("node {node} has two parents, or is part of a cycle")]
    NotATree {
        /// Number of a node concerned.
        node: u32,
    },
    /// A rotation is invalid.
    #[error("node {node}: `{text}` is not a rotation")]
    Rotation {
        /// Number of the transform.
        node: u32,
        /// Text in the file.
        text: String,
    },
    /// A translation is invalid.
    #[error("node {node}: `{text}` is not a translation")]
    Translation {
        /// Number of the transform.
        node: u32,
        /// Text in the file.
        text: String,
    },
    /// The file has too many nodes and models.
    #[error("it has more than {MAX_VOXEL_PARTS} models, nodes and layers")]
    TooManyParts,
    /// Voxels are too far from the origin.
    #[error("node {node} lies too far away: coordinates go to {FARTHEST}")]
    TooFar {
        /// Number of the shape.
        node: u32,
    },
    /// There are too many cells.
    #[error("a target has at most {MAX_CELLS} cells")]
    TooLarge,
    /// A row contains an invalid character.
    #[error("line {line}: {character:?} is neither `#`, a block, nor `.`, none")]
    Character {
        /// Line, from 1.
        line: usize,
        /// The character.
        character: char,
    },
}

/// Largest number of list entries.
const LISTED: usize = 8;

fn several(models: &[(u32, usize)]) -> String {
    let names = models.iter().take(LISTED);
    let names: Vec<String> = names
        .map(|(model, voxels)| format!("{model} ({})", counted(*voxels, "voxel")))
        .collect();
    let listed = listed(&names, models.len());
    format!("{} and no scene: {listed}", counted(models.len(), "model"))
}

fn numbers(models: &[u32]) -> String {
    let names: Vec<String> = models.iter().take(LISTED).map(u32::to_string).collect();
    listed(&names, models.len())
}
