//! A run as it stands, in the numbers of a recording.
use serde_json::{Value, json};
use stochc_ir::table::Tables;
use stochc_runtime::view::{ArenaView, RunView};

use super::chunk::PoseChunk;
use super::events::Seeds;

/// A single place of every block, rounded as in a recording, and what the structure does there.
#[derive(Clone, Debug, PartialEq)]
pub struct RunFrame {
    /// Coordinate of the number 0, by axis \[side\].
    pub corner: [f64; 3],
    /// Of a coordinate \[side\].
    pub step: f64,
    /// Seven numbers x blocks, the block fastest.
    pub numbers: Vec<u16>,
    /// Rows `[block, role, cell, phase]` of free blocks that are part of the structure.
    pub held: Value,
    /// Rows `[of, face]` of faces that are on and hold nothing; `of` as in the events of a recording.
    pub active: Value,
    /// Rows `[block, of, face]` of blocks in the reach of these faces.
    pub in_reach: Value,
    /// Rows `[block, block]` of free blocks that are bonded to each other.
    pub bonds: Value,
}

impl RunFrame {
    /// The frame of a run with these tables; `None`: nothing in it has a place.
    pub fn of(view: &RunView, tables: &Tables) -> Option<RunFrame> {
        let ArenaView {
            poses,
            active,
            in_reach,
            bonds,
        } = view.arena.as_ref()?;
        let seeds = Seeds::of(tables);
        let chunk = PoseChunk::quantize(vec![view.tick], poses.as_flattened(), poses.len());
        let held = view.held.iter();
        let active = active.iter();
        let in_reach = in_reach.iter();
        Some(RunFrame {
            corner: chunk.corner,
            step: chunk.step,
            numbers: chunk.numbers,
            held: held
                .map(|it| json!([it.body, it.role, it.cell, it.phase]))
                .collect(),
            active: active
                .map(|&(of, face)| json!([seeds.number(of), face]))
                .collect(),
            bonds: bonds.iter().map(|pair| json!(pair)).collect(),
            in_reach: in_reach
                .map(|&(body, of, face)| json!([body, seeds.number(of), face]))
                .collect(),
        })
    }
}
