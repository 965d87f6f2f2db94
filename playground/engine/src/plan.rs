//! Planned programs for shapes that the page's user draws or drops.
use serde::Deserialize;
use serde_json::{Value, json};
use stochc_ir::Cell;
use stochc_planner::{Goal, LargerScene, PlanSearch, Unplanned, layers, magica_voxel};

/// Largest number of cells. Larger shapes take the page too long.
const MAX_CELLS: usize = 600;

/// Cells that are planned per second, in all tries together.
const CELLS_PER_SECOND: usize = 60_000;

/// Shape to plan.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Drawing {
    /// Layers of text: rows with `#` for a block and `.` for none.
    Layers(String),
    /// Bytes of a MagicaVoxel file.
    Vox(Vec<u8>),
}

/// Returns `{ cells }`, the shape as coordinates `[x, y, z]`. The least x and y are 0, and the least
/// z is 1.
pub fn read(drawing: Drawing) -> Result<Value, String> {
    let cells = cells(drawing)?;
    let cells: Vec<_> = cells.iter().map(|cell| [cell.x, cell.y, cell.z]).collect();
    Ok(json!({ "cells": cells }))
}

/// Returns `{ text, notes }`: the planned program, and sentences about its scene.
pub fn plan(drawing: Drawing) -> Result<Value, String> {
    let cells = cells(drawing)?;
    let search = PlanSearch {
        rounds: (CELLS_PER_SECOND / cells.len().max(1)).clamp(1, 1000) as u64,
        ..PlanSearch::default()
    };
    let mut goal = Goal::from_cells("drawing", cells);
    let larger = goal
        .enlarge_default_scene()
        .map_err(|error| error.to_string())?;
    let notes: Vec<_> = larger.iter().map(LargerScene::in_words).collect();
    let planned = goal
        .plan(&[], search)
        .map_err(|unplanned| match unplanned {
            Unplanned::Refused(error) => match error.help() {
                Some(help) => format!("{error}: {help}"),
                None => error.to_string(),
            },
            Unplanned::Wrong(_) => "the shape cannot be built in the default scene".to_owned(),
        })?;
    Ok(json!({ "text": planned.text, "notes": notes }))
}

fn cells(drawing: Drawing) -> Result<Vec<Cell>, String> {
    let cells = match drawing {
        Drawing::Layers(text) => layers(&text),
        Drawing::Vox(bytes) => magica_voxel(&bytes, None).map(|scene| scene.cells),
    };
    let cells = cells.map_err(|error| error.to_string())?;
    if cells.len() > MAX_CELLS {
        return Err(format!(
            "the shape has {} blocks, and the page plans at most {MAX_CELLS}; use `stochc plan`",
            cells.len()
        ));
    }
    Ok(cells)
}
