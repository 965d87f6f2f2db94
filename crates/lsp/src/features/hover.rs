//! Hover texts in Markdown.
use std::fmt::Write as _;

use stochc_compiler::expanded::{EventId, EventKind, ExpandedPhase};
use stochc_compiler::names::{NameKind, Occurrence};
use stochc_compiler::order::Order;
use stochc_compiler::source_map::{Ancestry, Located, blocks_at};
use stochc_compiler::{Cancellation, Cancelled, FileId, Limits, Program, SourceLocation};
use stochc_estimate::{Cost, GUESS_ERROR, LowerBoundReasons, Rates};
use stochc_grammar::tree::{Item, Tree};
use stochc_ir::emit::duties_text;
use stochc_ir::table::RoleId;
use stochc_text::counted;

use super::scene;
use crate::workspace::analysis::Analysis;

/// Largest number of blocks that a hover text describes in full.
const MAX_DESCRIBED: usize = 3;

/// Largest number of blocks that a hover text lists.
const MAX_LISTED: usize = 12;

/// Returns the hover text of the name at a byte, and its range.
///
/// # Errors
///
/// [`Cancelled`] if the request is cancelled.
pub fn hover(
    analysis: &Analysis,
    at: usize,
    cancellation: Cancellation<'_>,
) -> Result<Option<(String, SourceLocation)>, Cancelled> {
    let Some(name) = analysis.name_at(at) else {
        return Ok(scene::hover(analysis, at));
    };
    let kind = analysis.names.kind(name.definition);
    // A parameter may refer to a block.
    if matches!(kind, NameKind::Block | NameKind::Parameter) {
        let place = (FileId(0), at as u32);
        let located = blocks_at(&analysis.checked, place, Limits::EDITOR, cancellation)?;
        if !located.is_empty() {
            let blocks = located.iter().map(|located| blocks(analysis, located));
            let text = blocks.collect::<Vec<_>>().join("\n---\n");
            return Ok(Some((text, name.location)));
        }
    }
    let mut text = declaration(analysis, name, kind);
    if kind == NameKind::Phase {
        text.push_str(&phases(analysis, name.location));
    }
    Ok(Some((text, name.location)))
}

fn blocks(analysis: &Analysis, located: &Located) -> String {
    let program = &analysis.checked.programs[located.program];
    let ancestry = Ancestry::new(program);
    let cost = analysis.cost(located.program);
    let roles = &located.roles;
    let mut text = String::new();
    for &role in roles.iter().take(MAX_DESCRIBED) {
        text.push_str(&block(analysis, program, &ancestry, cost, role));
        if let Some(tables) = &program.tables {
            let duties = duties_text(tables, role);
            if !duties.is_empty() {
                let _ = writeln!(text, "```text\n{}```", unindented(&duties));
            }
        }
    }
    let listed = roles.iter().skip(MAX_DESCRIBED).take(MAX_LISTED);
    for &role in listed {
        text.push_str(&block(analysis, program, &ancestry, cost, role));
    }
    let rest = roles.len().saturating_sub(MAX_DESCRIBED + MAX_LISTED);
    if rest > 0 {
        let _ = writeln!(text, "\nand more blocks of this name");
    }
    text
}

/// Removes the four leading spaces of each line. They would begin a code block inside a code block.
fn unindented(duties: &str) -> String {
    let lines = duties.lines();
    lines
        .map(|line| format!("{}\n", line.strip_prefix("    ").unwrap_or(line)))
        .collect()
}

/// Describes a block and its capture.
fn block(
    analysis: &Analysis,
    program: &Program,
    ancestry: &Ancestry<'_>,
    cost: Option<&Cost>,
    role: RoleId,
) -> String {
    let (plan, symbols) = (&program.plan, &analysis.checked.symbols);
    let name = |role| plan.roles.name(role, symbols);
    let mut text = format!("**`{}`**, block of `{}`\n", name(role), plan.name);
    if let Some(seed) = plan.seeds.iter().find(|seed| seed.role == role) {
        let _ = writeln!(text, "- seed of the plate at {}, depth 0", seed.cell);
    }
    for &capture in ancestry.captures(role) {
        let EventKind::Capture { parent, face } = plan.event(capture).kind else {
            continue;
        };
        let cell = program
            .layout
            .cells
            .get(capture.0 as usize)
            .copied()
            .flatten();
        let cell = cell.map_or_else(String::new, |cell| format!(" at {cell}"));
        let depth = ancestry.depth(capture);
        let depth = depth.map_or_else(String::new, |depth| format!(", depth {depth}"));
        let parent = name(parent);
        let how = match phase_of(program, capture) {
            Some(phase) if phase.pre_attached => format!("pre-attached to `{parent}.{face}`"),
            _ => {
                let phase = phase_name(program, capture);
                format!("captured in phase `{phase}` by `{parent}.{face}`")
            }
        };
        let mut costs = cost.iter().flat_map(|cost| &cost.captures);
        let wait = costs.find(|it| it.event == capture);
        let wait = wait.map_or_else(String::new, |it| {
            let by = by(program);
            let bound = cost.map(|cost| cost.lower_bound).unwrap_or_default();
            let at_least = bound.prefix();
            format!(
                ", waits {at_least}{:.0} ticks on average, by {by}{}",
                it.wait,
                because(bound)
            )
        });
        let _ = writeln!(text, "- {how}{cell}{depth}{wait}");
    }
    let releases =
        plan.events.iter().enumerate().filter(|(_, event)| {
            event.role == role && event.valid && event.kind == EventKind::Release
        });
    for (number, _) in releases.take(MAX_LISTED) {
        let phase = phase_name(program, EventId(number as u32));
        let _ = writeln!(text, "- released in phase `{phase}`");
    }
    text.push('\n');
    text
}

/// Returns the reasons why a time is a lower bound, in brackets. Empty if it is an estimate.
fn because(bound: LowerBoundReasons) -> String {
    if bound.is_empty() {
        String::new()
    } else {
        format!(" ({})", bound.text())
    }
}

/// Returns the basis of the times in words.
fn by(program: &Program) -> String {
    let is_known = (program.scene.as_ref()).is_some_and(|it| Rates::built_in(it).is_some());
    if is_known {
        "rates".to_owned()
    } else {
        let (usual, most) = GUESS_ERROR;
        format!(
            "an uncalibrated estimate of rates (off by a factor of {usual}, at most {most} in tests)"
        )
    }
}

fn phase_name(program: &Program, event: EventId) -> &str {
    phase_of(program, event).map_or("?", |phase| &phase.name)
}

fn phase_of(program: &Program, event: EventId) -> Option<&ExpandedPhase> {
    let number = program.plan.phase_of(event)?;
    program.plan.phases.get(number)
}

fn declaration(analysis: &Analysis, name: &Occurrence, kind: NameKind) -> String {
    let names = &analysis.names;
    let word = analysis.checked.symbols.word(names.word(name.definition));
    let mut text = format!("**`{word}`**, {}\n", kind.noun());
    let Some(location) = (names.occurrences_of(name.definition))
        .find(|occurrence| occurrence.declares)
        .map(|occurrence| occurrence.location)
    else {
        let scene = stochc_compiler::scene::BUILT_IN
            .iter()
            .find(|(known, _)| *known == word);
        if let (NameKind::Scene, Some((_, built_in))) = (kind, scene) {
            let _ = writeln!(text, "\nbuilt in:\n```sa\n{}\n```", built_in.trim_end());
        }
        return text;
    };
    let source = &analysis.checked.sources.file(location.file).text;
    let start = source[..location.span.start as usize]
        .rfind('\n')
        .map_or(0, |at| at + 1);
    let line = source[start..].lines().next().unwrap_or_default().trim();
    let line: String = line.chars().take(200).collect();
    let _ = writeln!(text, "```sa\n{line}\n```");
    let tree = analysis
        .checked
        .trees()
        .find(|(file, _)| *file == location.file);
    for line in tree
        .iter()
        .flat_map(|(_, tree)| docs(tree, location.span.start))
    {
        let _ = writeln!(text, "{line}");
    }
    text
}

/// Returns the documentation of the innermost item around a byte.
fn docs(tree: &Tree, at: u32) -> &[String] {
    let mut items: &[Item] = &tree.items;
    let mut docs: &[String] = &[];
    let around = |item: &&Item| (item.span.start..=item.span.end).contains(&at);
    while let Some(item) = items.iter().find(around) {
        docs = item.docs.0.as_ref().map_or(&[], |lines| lines.as_slice());
        items = item.body();
    }
    docs
}

/// Describes the phases that are declared at a location. A declaration in a loop has several
/// phases.
fn phases(analysis: &Analysis, location: SourceLocation) -> String {
    let mut text = String::new();
    for (index, program) in analysis.checked.programs.iter().enumerate() {
        let phases = program.plan.phases.iter().enumerate();
        let named = phases.filter(|(_, phase)| {
            phase.location.file == location.file && phase.location.span.start == location.span.start
        });
        let named: Vec<_> = named.take(MAX_LISTED).collect();
        let cost = (!named.is_empty()).then(|| analysis.cost(index)).flatten();
        for (number, phase) in named {
            let measured = measure(program, number, phase);
            let _ = write!(text, "- `{}`: {measured}", phase.name);
            if let Some(cost) = cost.filter(|_| !phase.pre_attached)
                && let Some(times) = cost.phases[number].times
            {
                let (by, bound) = (by(program), cost.lower_bound);
                let takes = times.in_words(bound);
                let _ = write!(text, "; by {by} {takes}{}", because(bound));
            }
            text.push('\n');
        }
    }
    text
}

fn measure(program: &Program, number: usize, phase: &ExpandedPhase) -> String {
    let events = program.plan.events_of(phase);
    let is_capture =
        |id: &EventId| matches!(program.plan.event(*id).kind, EventKind::Capture { .. });
    let all = phase.events.len();
    let captures = events.filter(is_capture).count();
    let mut text = counted(captures, "capture");
    if all > captures {
        let _ = write!(text, ", {}", counted(all - captures, "release"));
    }
    if let Some(chain) = program
        .order
        .as_ref()
        .and_then(|order| order.chains.get(number))
    {
        let length = Order::length(&program.plan, chain);
        let _ = write!(text, ", longest serial chain {length}");
    }
    if let Some(phase) = program
        .tables
        .as_ref()
        .and_then(|tables| tables.phases.get(number))
    {
        let _ = write!(
            text,
            ", ends after {}",
            counted(phase.reports as usize, "report")
        );
    }
    text
}
