//! Inlay hints: the cell of each captured block.
use std::collections::BTreeMap;
use std::ops::Range;

use serde_json::{Value, json};
use stochc_compiler::FileId;
use stochc_compiler::plan::EventKind;
use stochc_ir::{Cell, Face};

use crate::workspace::analysis::Analysis;

/// Returns the cells of blocks that are captured in a range of bytes. A capture that stands for
/// several blocks has no hint.
pub fn hints(analysis: &Analysis, within: &Range<usize>) -> Vec<Value> {
    let sources = &analysis.checked.sources;
    let mut cells: BTreeMap<usize, Option<Cell>> = BTreeMap::new();
    for program in &analysis.checked.programs {
        for (event, cell) in program.plan.events.iter().zip(&program.layout.cells) {
            let location = event.location;
            let end = location.span.end as usize;
            let is_capture = matches!(event.kind, EventKind::Capture { .. });
            if !is_capture || location.file != FileId(0) || !within.contains(&end) {
                continue;
            }
            let text = sources.text(location);
            let face = text
                .rsplit_once('.')
                .filter(|(_, word)| Face::from_word(word).is_some());
            let name_end = end - face.map_or(0, |(_, word)| word.len() + 1);
            cells
                .entry(name_end)
                .and_modify(|cell| *cell = None)
                .or_insert(*cell);
        }
    }
    let lines = analysis.lines(FileId(0));
    let hints = cells.into_iter().filter_map(|(at, cell)| {
        let label = cell?.to_string();
        Some(json!({ "position": lines.position(at), "label": label, "paddingLeft": true }))
    });
    hints.collect()
}
