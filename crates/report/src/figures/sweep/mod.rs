//! Figures of a sweep.
mod frame;
mod heat;
mod pictures;
mod share;
mod times;

pub use pictures::pictures;
