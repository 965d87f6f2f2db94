//! Sets of roles.
use stochc_ir::table::RoleId;

/// Set of roles, one bit each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RoleSet(Vec<u64>);

impl RoleSet {
    /// Returns the empty set of `count` roles.
    pub fn none(count: usize) -> RoleSet {
        RoleSet(vec![0; count.div_ceil(64)])
    }

    /// Adds a role. Returns whether it is new.
    pub fn insert(&mut self, role: RoleId) -> bool {
        let (word, bit) = (role.0 as usize / 64, 1 << (role.0 % 64));
        let new = self.0[word] & bit == 0;
        self.0[word] |= bit;
        new
    }

    pub fn contains(&self, role: RoleId) -> bool {
        self.0[role.0 as usize / 64] & (1 << (role.0 % 64)) != 0
    }

    pub fn extend_with(&mut self, roles: impl IntoIterator<Item = RoleId>) {
        for role in roles {
            self.insert(role);
        }
    }

    /// Returns whether two sets have a role in common.
    pub fn meets(&self, other: &RoleSet) -> bool {
        self.0.iter().zip(&other.0).any(|(a, b)| a & b != 0)
    }
}
