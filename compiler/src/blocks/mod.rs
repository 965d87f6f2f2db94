//! Checks of blocks: their number, their lifetimes and unplanned bonds.
pub(crate) mod block_demand;
pub mod bond_loads;
pub(crate) mod capacity;
pub(crate) mod liveness;
pub(crate) mod unplanned_bonds;
pub(crate) mod unused;
