//! Memory of a block.

/// Numbers that bound the memory of a block and of the plate.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sizes {
    /// Largest number of observations of a block in a phase.
    pub observations: usize,
    /// Largest number of rules of a block in a phase.
    pub rules: usize,
    /// Largest number of notifications that wait at a block for future descendants.
    pub waiting: usize,
    /// Largest number of notifications that wait at a seed for future descendants.
    pub plate_waiting: usize,
    /// Number of seeds.
    pub seeds: usize,
    /// Part of the image that does not belong to a role \[bytes\].
    pub index: usize,
    /// Names of the roles with the largest records, with the sizes \[bytes\].
    pub largest: Vec<(String, usize)>,
}

impl Sizes {
    /// Upper bound of the interpreter's size in flash \[bytes\].
    pub const INTERPRETER: usize = 4096;

    /// Returns the size of a block's state \[bytes\].
    pub fn ram(&self) -> usize {
        const FACE: usize = 20;
        const MESSAGE: usize = 4;
        let fixed = 2 + 2 + 2 + 1 + 1 + 6 + 1 + 1 + 4 + 2 + 2 * MESSAGE + 6 * FACE;
        let bits = |count: usize| count.max(1).div_ceil(8);
        let size =
            fixed + self.waiting.max(1) * MESSAGE + bits(self.observations) + bits(self.rules);
        // Processors of 16 and 32 bits align the faces and the state.
        (size + 1).next_multiple_of(4)
    }
}
