//! A block in the units of its side and its mass.

/// One over the moment of inertia, about any axis through the centre.
pub(crate) const INVERSE_INERTIA: f64 = 6.0;
