//! Kinds of warnings about scenes.

/// Kind of warning about a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SceneWarningKind {
    /// Weight or lift keeps free blocks away from the structure.
    BuoyantBlocks,
    /// No agitation moves the free blocks.
    NoAgitation,
    /// The time step does not resolve the motion.
    CoarseStep,
    /// Contacts or the wall are so soft that blocks penetrate too far.
    SoftContact,
    /// A fluid without a density has too little drag at the speed of the blocks.
    StokesDrag,
}
