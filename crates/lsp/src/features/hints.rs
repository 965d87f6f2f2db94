//! Inlay hints: the cell and the expected waiting time of each captured block.
use std::collections::BTreeMap;
use std::ops::Range;

use serde_json::{Value, json};
use stochc_compiler::FileId;
use stochc_compiler::expanded::{EventId, EventKind};
use stochc_ir::Face;
use stochc_text::number;

use crate::workspace::analysis::Analysis;

/// Returns the cells of blocks that are captured in a range of bytes, with their mean waiting times
/// if they are known. A capture that stands for several blocks has no hint.
pub fn hints(analysis: &Analysis, within: &Range<usize>) -> Vec<Value> {
    let sources = &analysis.checked.sources;
    let lines = analysis.lines(FileId(0));
    let mut found: BTreeMap<usize, Option<(usize, EventId)>> = BTreeMap::new();
    for (number, program) in analysis.checked.programs.iter().enumerate() {
        for (id, event) in (0..).map(EventId).zip(&program.plan.events) {
            let location = event.location;
            let end = location.span.end as usize;
            let is_capture = matches!(event.kind, EventKind::Capture { .. });
            if !is_capture || location.file != FileId(0) || !within.contains(&end) {
                continue;
            }
            if !analysis.is_unchanged(location) {
                continue;
            }
            let text = sources.text(location);
            let face = text
                .rsplit_once('.')
                .filter(|(_, word)| Face::from_word(word).is_some());
            let name_end = end - face.map_or(0, |(_, word)| word.len() + 1);
            found
                .entry(name_end)
                .and_modify(|capture| *capture = None)
                .or_insert(Some((number, id)));
        }
    }
    let mut waits: BTreeMap<usize, BTreeMap<EventId, f64>> = BTreeMap::new();
    let hints = found.into_iter().filter_map(|(at, capture)| {
        let (program, event) = capture?;
        let cells = &analysis.checked.programs[program].layout.cells;
        let mut label = cells.get(event.0 as usize)?.as_ref()?.to_string();
        if let Some(cost) = analysis.cost(program) {
            let captures = cost.captures.iter().map(|it| (it.event, it.wait));
            let waits = (waits.entry(program)).or_insert_with(|| captures.collect());
            if let Some(wait) = waits.get(&event) {
                let (bound, wait) = (cost.lower_bound.prefix(), number(wait.round()));
                label.push_str(&format!(", {bound}{wait} ticks"));
            }
        }
        Some(json!({ "position": lines.position(at), "label": label, "paddingLeft": true }))
    });
    hints.collect()
}
