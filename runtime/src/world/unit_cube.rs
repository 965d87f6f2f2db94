//! Block in units of its length and mass.

/// Inverse moment of inertia about any axis through the centre.
pub(crate) const INVERSE_INERTIA: f64 = 6.0;
