//! Whether free blocks can reach every cell, in every order of the events.
//!
//! **Cells decide.** A drifting cube needs space for its inside. Two empty cells that share only an
//! edge or a corner leave a passage without width. So a block reaches a cell exactly if empty cells
//! lead there from outside, face to face. A chain that is one cell wide leaves a hard cube no
//! clearance, so `clearance.rs` warns.
//!
//! **One order decides for all.** Consider a phase without releases. Its structure only grows, and
//! paths only close. Take a capture `e`. In its worst order, everything that does not wait for `e`
//! has already happened. If the cell of `e` has a path then, it has one in every order. If it has
//! none, let the other events go first. Either they all happen and `e` is stuck, or one of them
//! gets stuck. The phase does not end in either case. So the phase ends in every order exactly if
//! every capture has a path in its own worst order. For phases without releases, the verdict is
//! exact. The events that wait for `e` are its descendants in the dependency graph.
//!
//! **Releases** open paths, but only if they happen. A stuck capture may wait for a block that
//! itself waits for the release. So the proof counts on a release only if nothing can prevent it:
//! all captures that it waits for have been shown to have a path, counting on earlier releases
//! only. This is sound. Suppose that a phase gets stuck although every capture was shown to be
//! safe. Take the stuck capture that was shown first. Its proof counts only on releases that wait
//! for captures shown earlier. Those captures are not stuck, so the releases have happened. So the
//! structure is no larger than assumed, and the capture has a path: a contradiction. The verdict is
//! not exact. It reports captures that could only be stuck together, even if no order leads there.
//! It does not count on a block that is released into the closed cell.
//!
//! **Captures that no order reaches** are reported separately (`reachable.rs`). Some captures are
//! closed by blocks that they wait for. Others wait for such a capture. For all other unsafe
//! captures, a remedy is searched (`repair.rs`), written as an edit (`edit.rs`) and tried
//! (`trial.rs`). It is proposed only if the changed program does not have this error and no new
//! one.
//!
//! **Speed.** A capture has a path if a neighbour that waits for it has one. Most other cells are
//! next to a column that is open to the sky. The remaining cells are searched along the walls
//! (`path_search.rs`). The work is bounded, and undecided cells are reported.
mod analysis;
mod clearance;
mod closable_phase;
mod crowding;
mod descendants;
mod diagnose;
mod edit;
mod effort;
mod graph_paths;
mod known_paths;
mod moving_cube;
mod occupancy;
mod path_search;
mod picture;
mod plane;
mod program;
mod proposal;
mod reachable;
mod repair;
mod sealed;
mod trial;

pub use analysis::check;
pub use plane::Plane;
pub use program::ValidProgram;
pub use proposal::Trial;
