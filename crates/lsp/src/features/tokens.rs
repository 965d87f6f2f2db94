//! Semantic tokens: the kind of each name.
use std::ops::Range;

use gen_lsp_types::SemanticToken;
use stochc_compiler::FileId;
use stochc_compiler::names::NameKind;

use crate::workspace::analysis::Analysis;

pub const TYPES: [&str; 4] = ["type", "function", "parameter", "variable"];

pub const MODIFIERS: [&str; 2] = ["declaration", "readonly"];

/// Returns the names in a range of bytes of the program's own file.
pub fn tokens(analysis: &Analysis, within: &Range<usize>) -> Vec<SemanticToken> {
    let lines = analysis.lines(FileId(0));
    let mut data = Vec::new();
    let (mut line, mut character) = (0, 0);
    let mut free = 0;
    let names = analysis.names.all();
    let first = names.partition_point(|name| {
        name.location.file == FileId(0) && (name.location.span.end as usize) < within.start
    });
    for name in &names[first..] {
        let span = name.location.span;
        if name.location.file != FileId(0) || span.start as usize >= within.end {
            break;
        }
        // A name in a pattern may be several definitions.
        if span.start < free || span.is_empty() {
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
        data.push(SemanticToken {
            delta_line: start.line - line,
            delta_start: start.character - character,
            length: range.end.character - start.character,
            token_type: kind,
            token_modifiers_bitset: u32::from(name.declares) + 2 * u32::from(is_constant),
        });
        (line, character) = (start.line, start.character);
    }
    data
}
