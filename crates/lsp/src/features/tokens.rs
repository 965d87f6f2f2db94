//! Semantic tokens: the kind of each name.
use stochc_compiler::FileId;
use stochc_compiler::names::NameKind;

use crate::workspace::analysis::Analysis;

pub const TYPES: [&str; 4] = ["type", "function", "parameter", "variable"];

pub const MODIFIERS: [&str; 2] = ["declaration", "readonly"];

/// Returns the names of the program's own file, five numbers each, as the protocol encodes them.
pub fn tokens(analysis: &Analysis) -> Vec<u32> {
    let lines = analysis.lines(FileId(0));
    let mut data = Vec::new();
    let (mut line, mut character) = (0, 0);
    let mut free = 0;
    for name in analysis.names.all() {
        let span = name.location.span;
        // A name in a pattern may be several definitions.
        if name.location.file != FileId(0) || span.start < free || span.is_empty() {
            continue;
        }
        free = span.end;
        let (kind, is_constant) = match analysis.names.kind(name.definition) {
            NameKind::Shape | NameKind::Scene | NameKind::Assembly => (0, false),
            NameKind::Aggregate | NameKind::Phase => (0, false),
            NameKind::Pattern => (1, false),
            NameKind::Parameter => (2, false),
            NameKind::Block | NameKind::Instance => (3, false),
            NameKind::Number | NameKind::Counter => (3, true),
        };
        let range = lines.range(span);
        let start = range.start;
        // The name was deleted or divided after the check.
        if range.end.line != start.line || range.end == start {
            continue;
        }
        if start.line > line {
            character = 0;
        }
        let length = range.end.character - start.character;
        let modifiers = u32::from(name.declares) + 2 * u32::from(is_constant);
        let position = [start.line - line, start.character - character];
        data.extend(position);
        data.extend([length, kind, modifiers]);
        (line, character) = (start.line, start.character);
    }
    data
}
