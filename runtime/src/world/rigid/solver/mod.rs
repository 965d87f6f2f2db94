//! Contact solver: sequential impulses.
//!
//! Rigid contacts are solved twice. The first pass finds velocities, with restitution and Coulomb
//! friction. The second corrects the overlap of the time step by a displacement that leaves no
//! velocity. Compliant contacts are springs and dampers, integrated implicitly. Most bodies touch
//! one thing only: their contacts are solved in parallel, all others in sequence, by the same
//! arithmetic.
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
