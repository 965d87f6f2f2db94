//! Groups: free blocks that are bonded to each other and move as one body.
//!
//! A group is a tree of bonds. Its blocks have fixed places in the group's frame. Forces first act
//! on each block separately. Then the group takes the rigid motion with the same momentum and
//! angular momentum. The load of a bond is the force that it must transmit for this motion.
mod block_groups;
mod bond_load;
mod group;
mod rigid_motion;

pub(crate) use block_groups::BlockGroups;
pub(crate) use rigid_motion::lost;

#[cfg(test)]
mod tests;
