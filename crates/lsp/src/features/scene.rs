//! Hover and completion for keywords of scenes.
use serde_json::{Value, json};
use stochc_compiler::scene::WordContext;
use stochc_compiler::{FileId, SourceLocation, Span};
use stochc_grammar::tree::ItemKind;
use stochc_ir::scene::schema::SchemaEntry;

use crate::workspace::analysis::Analysis;

/// Completion kind of keywords in the protocol.
const KEYWORD: u32 = 14;

/// Returns the description of the keyword at a byte, and its range. Returns `None` if no keyword is
/// there.
pub fn hover(analysis: &Analysis, at: usize) -> Option<(String, SourceLocation)> {
    let words = words(analysis, at)?;
    let (entry, outer) = words.path.split_last()?;
    let location = SourceLocation {
        file: FileId(0),
        span: words.word?,
    };
    let outer: Vec<&str> = outer.iter().map(|entry| entry.word).collect();
    let within = match outer[..] {
        [] => "a clause of scenes".to_owned(),
        _ => format!("of `{}`", outer.join(" ")),
    };
    let mut text = format!("**`{}`**, {within}\n\n{}\n", entry.word, entry.described());
    if let Some(absent) = entry.absent.meaning() {
        text.push_str(&format!("\nAbsent: {absent}\n"));
    }
    for equation in entry
        .equations
        .iter()
        .filter_map(|equation| equation.formula)
    {
        text.push_str(&format!("\n```text\n{equation}\n```\n"));
    }
    Some((text, location))
}

/// Returns the keywords allowed at a byte of a scene. Returns `None` outside of scenes.
pub fn completions(analysis: &Analysis, at: usize) -> Option<Vec<Value>> {
    let item = |entry: &SchemaEntry| {
        json!({
            "label": entry.word,
            "kind": KEYWORD,
            "documentation": entry.described(),
        })
    };
    let words = words(analysis, at)?;
    Some(words.next.into_iter().map(item).collect())
}

fn words(analysis: &Analysis, at: usize) -> Option<WordContext> {
    let checked = &analysis.checked;
    let is_in_braces = |name: Span| {
        let text = &checked.sources.file(FileId(0)).text;
        let head = text.get(name.end as usize..at);
        head.is_some_and(|head| head.contains('{'))
    };
    let at = at as u32;
    checked.tree.items.iter().find_map(|item| match &item.kind {
        ItemKind::Scene(scene) if is_in_braces(scene.name.span) && at < item.span.end => {
            Some(WordContext::at(scene, &checked.symbols, at))
        }
        _ => None,
    })
}
