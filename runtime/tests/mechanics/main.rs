//! Tests motion, collisions, attraction, docking and release of blocks. They are compared with
//! closed forms, conservation laws, finer steps and the other engine.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]
#[macro_use]
#[path = "../scenes/mod.rs"]
mod scenes;
#[path = "../../../tests/pages/mod.rs"]
mod pages;

mod arrivals;
mod bonds;
mod closed_forms;
mod collisions;
mod compliance;
mod conservation;
mod contact_order;
mod enclosures;
mod extremes;
mod fluid;
mod free_pairs;
mod friction;
mod local_steps;
mod magnets;
mod orientation;
mod planar;
mod reductions;
mod rejection;
mod tumbling;
mod weight;
