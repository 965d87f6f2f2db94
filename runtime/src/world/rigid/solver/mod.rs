//! Contact solver: sequential impulses.
//!
//! Rigid contacts are solved twice. The first pass finds velocities, with restitution and Coulomb
//! friction. The second corrects overlaps by a displacement that does not change velocities.
//! Compliant contacts are springs and dampers, integrated implicitly. Most bodies have only one
//! contact. Such contacts are solved in parallel, all others in sequence, by the same arithmetic.
//!
//! # Source
//!
//! E. Catto, Iterative Dynamics with Temporal Coherence (2005).
mod centre_of_pressure;
mod contact_law;
mod contact_list;
mod contact_solver;
mod parallel;
mod sequential;
mod solver_bodies;

pub(super) use contact_law::Law;
pub(super) use contact_solver::Solver;
