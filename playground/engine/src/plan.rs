//! Planned programs for shapes that the page's user draws or drops.
use serde::Deserialize;
use serde_json::{Value, json};
use stochc_ir::Cell;
use stochc_planner::{Goal, PlanSearch, Unplanned, layers, magica_voxel};

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

/// Returns `{ layers }`, the shape as layers of text: rows from north to south, lowest layer first.
pub fn read(drawing: Drawing) -> Result<Value, String> {
    let cells = cells(drawing)?;
    let most = |axis: fn(&Cell) -> i32| cells.iter().map(axis).max().unwrap_or(0);
    let (width, depth) = (most(|cell| cell.x), most(|cell| cell.y));
    let row = |y: i32, z: i32| -> String {
        (0..=width)
            .map(|x| {
                if cells.contains(&Cell::new(x, y, z)) {
                    '#'
                } else {
                    '.'
                }
            })
            .collect()
    };
    let layer = |z| (0..=depth).rev().map(|y| row(y, z)).collect::<Vec<_>>();
    let layers: Vec<_> = (1..=most(|cell| cell.z)).map(layer).collect();
    Ok(json!({ "layers": layers }))
}

/// Returns `{ text, mean, notes }`: the planned program, its estimated completion time \[ticks\], and
/// notes about changes of the scene.
pub fn plan(drawing: Drawing) -> Result<Value, String> {
    let cells = cells(drawing)?;
    let search = PlanSearch {
        rounds: (CELLS_PER_SECOND / cells.len().max(1)).clamp(1, 1000) as u64,
        ..PlanSearch::default()
    };
    let mut goal = Goal::from_cells("drawing", cells);
    let mut notes = Vec::new();
    match goal.enlarge_default_scene() {
        Ok(larger) => notes.extend(larger.map(|larger| larger.in_words())),
        Err(reason) => return Err(reason.to_string()),
    }
    let planned = goal
        .plan(&[], search)
        .map_err(|unplanned| match unplanned {
            Unplanned::Refused(error) => match error.help() {
                Some(help) => format!("{error}: {help}"),
                None => error.to_string(),
            },
            Unplanned::Wrong(_) => "the shape cannot be built in the default scene".to_owned(),
        })?;
    Ok(json!({ "text": planned.text, "mean": planned.plan.estimate.mean, "notes": notes }))
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
