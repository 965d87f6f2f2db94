//! Waiting times of open faces and their rates.
pub(crate) mod docking_time;
pub(crate) mod first_guess;
pub(crate) mod head_start;
pub(crate) mod held_out;
pub(crate) mod inverse;
pub(crate) mod law;
pub(crate) mod lower_bound;
pub(crate) mod rates;
pub(crate) mod times;
pub(crate) mod wait;
