//! External forces on single blocks: gravity, and a fluid with drag, flow, turbulence and heat. In
//! double precision, and shared by all worlds of rigid blocks.
//!
//! With viscous drag of rate γ, the mean effect of a constant force over a step dt is scaled by φ =
//! (1 - exp(-γ dt)) / (γ dt). Velocities are then step averages. Terminal velocity and diffusion
//! are therefore exact for steps of any length.
mod brownian;
mod drag;
mod forces;
mod local_flow;
mod mean_flow;
mod turbulence;

pub(crate) use drag::{Response, mean as response};
pub(crate) use forces::{ExternalForces, Sink};
