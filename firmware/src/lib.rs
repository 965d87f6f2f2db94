//! Firmware for the blocks: the event tables of a program as constants, and their interpreter in C.
//!
//! [`Image`] is the program as bytes, in the format that `block.c` reads. [`files`] returns all
//! files of the firmware.
mod encode;
mod files;
mod image;
mod nodes;
mod sizes;

pub use files::{MARK, files};
pub use image::{Image, Unsupported};
pub use sizes::Sizes;
