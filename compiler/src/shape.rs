//! Claimed shapes against built ones.
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::{Expr, ExprKind, Shape, Subscript};
use stochc_grammar::{Cancellation, Cancelled, Symbol, Symbols};
use stochc_ir::{Cell, CellBounds};

use crate::diagnostic::{Code, Diagnostic, Severity, is_full, meant, report};
use crate::expand::Shapes;
use crate::layer_picture::layer_picture;
use crate::layout::Layout;
use crate::names::Names;
use crate::plan::ProgramPlan;
use crate::{FileId, SourceLocation};

/// Cells of a shape, at most.
pub(crate) const MOST_CELLS: usize = 50_000_000;

/// Compares what phases claim with what they build.
///
/// # Errors
///
/// [`Cancelled`] if nobody waits for it.
pub fn check(
    plan: &ProgramPlan,
    layout: &Layout,
    (shapes, names): (&Shapes<'_>, &Names),
    symbols: &Symbols,
    cancellation: Cancellation<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<(), Cancelled> {
    // Sorted, or `None` for what is no shape.
    let mut known: FxHashMap<Symbol, Option<Vec<Cell>>> = FxHashMap::default();
    let mut built = BuiltCells::default();
    // A claim of what has been compared already; many phases may claim a large shape.
    let mut compared: FxHashSet<(Symbol, u64)> = FxHashSet::default();
    for (phase, (emptied, filled)) in plan.phases.iter().zip(&layout.changes) {
        emptied.iter().for_each(|&cell| built.remove(cell));
        filled.iter().for_each(|&cell| built.insert(cell));
        for &(name, location) in &phase.claims {
            cancellation.check()?;
            let word = symbols.word(name);
            let definition = names.definition(location.file, location.span);
            let Some(&(file, shape)) = definition.and_then(|it| shapes.get(&it)) else {
                let known = shapes.values();
                let known = known.map(|(_, known)| symbols.word(known.name.symbol));
                let diagnostic =
                    Diagnostic::new(Code::UnknownName, format!("no shape is called `{word}`"))
                        .label(location, "not known here")
                        .suggest(location, meant(diagnostics, word, known), || {
                            format!("declare it: `shape {word} {{ layer 1 {{ # }} }}`")
                        });
                report(diagnostics, diagnostic);
                continue;
            };
            let claimed = known.entry(name).or_insert_with(|| {
                let mut claimed = cells(shape, file, diagnostics)?;
                claimed.sort_unstable();
                claimed.dedup();
                Some(claimed)
            });
            let Some(claimed) = claimed else { continue };
            let now = (name, built.fingerprint);
            let is_built = || claimed.iter().all(|cell| built.cells.contains(cell));
            if compared.contains(&now) || is_full(diagnostics, Severity::Error) {
                continue;
            }
            if claimed.len() == built.cells.len() && is_built() {
                compared.insert(now);
                continue;
            }
            let mut built: Vec<Cell> = built.cells.iter().copied().collect();
            built.sort_unstable();
            let declared = SourceLocation {
                file,
                span: shape.name.span,
            };
            report(
                diagnostics,
                difference(word, location, declared, claimed, &built),
            );
        }
    }
    Ok(())
}

/// What stands.
#[derive(Default)]
struct BuiltCells {
    cells: FxHashSet<Cell>,
    /// The sum of the hashes of all cells, modulo 2^64: the same for the same cells, whatever came before.
    fingerprint: u64,
}

impl BuiltCells {
    fn insert(&mut self, cell: Cell) {
        if self.cells.insert(cell) {
            self.fingerprint = self.fingerprint.wrapping_add(hash(cell));
        }
    }

    fn remove(&mut self, cell: Cell) {
        if self.cells.remove(&cell) {
            self.fingerprint = self.fingerprint.wrapping_sub(hash(cell));
        }
    }
}

fn hash(cell: Cell) -> u64 {
    let mut hasher = DefaultHasher::new();
    cell.hash(&mut hasher);
    hasher.finish()
}

/// The cells of a shape, unsorted; `None` if it cannot be read, which is told.
pub fn cells(shape: &Shape, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> Option<Vec<Cell>> {
    let malformed = |span, text: &str| {
        Diagnostic::new(Code::ShapeMalformed, "the shape cannot be read as cells")
            .label(SourceLocation { file, span }, text)
    };
    let mut number = |expr: &Expr| {
        let value = constant(expr).and_then(|value| i32::try_from(value).ok());
        if value.is_none() {
            diagnostics.push(malformed(
                expr.span,
                "needs a number, not too large, without names",
            ));
        }
        value
    };
    let (x, y) = match &shape.at {
        Some((x, y)) => (number(x)?, number(y)?),
        None => (0, 0),
    };
    let mut cells = Vec::new();
    // Empty ones count as well: each is looked at.
    let mut area = 0usize;
    for layer in &shape.layers {
        let (low, high) = match &layer.heights {
            Subscript::One(height) => {
                let height = number(height)?;
                (height, height)
            }
            Subscript::Range(low, high) => (number(low)?, number(high)?),
        };
        if low < 1 || high < low {
            diagnostics.push(
                malformed(layer.span, "heights are from 1 upwards")
                    .help("layer 1 rests on the plate; `layer 1..2` stands for two equal layers"),
            );
            return None;
        }
        let rows = layer.rows.len();
        let count: usize = layer.rows.iter().map(|row| row.cells.len()).sum();
        let levels = (high - low) as usize + 1;
        area = area.saturating_add(count.saturating_mul(levels));
        if area > MOST_CELLS {
            diagnostics.push(malformed(
                layer.span,
                "a shape has at most 50,000,000 cells",
            ));
            return None;
        }
        // A layer without rows may have any height.
        if count == 0 {
            continue;
        }
        let widest = layer.rows.iter().map(|row| row.cells.len()).max();
        let fits = |from: i32, length: usize| {
            i32::try_from(length).is_ok_and(|length| from.checked_add(length - 1).is_some())
        };
        if !fits(x, widest.unwrap_or(1)) || !fits(y, rows) {
            diagnostics.push(malformed(
                layer.span,
                "it reaches beyond the cells that there are",
            ));
            return None;
        }
        for z in low..=high {
            for (i, row) in layer.rows.iter().enumerate() {
                let north = (rows - 1 - i) as i32;
                let blocks = row.cells.iter().enumerate().filter(|(_, block)| **block);
                for (east, _) in blocks {
                    cells.push(Cell::new(x + east as i32, y + north, z));
                }
            }
        }
    }
    Some(cells)
}

/// Shapes are declared outside of loops and patterns: their numbers are plain.
fn constant(expr: &Expr) -> Option<i64> {
    match &expr.kind {
        ExprKind::Int(value) => Some(*value),
        ExprKind::Name(_) => None,
        ExprKind::Negate(inner) => constant(inner)?.checked_neg(),
        ExprKind::Binary(operator, sides) => operator.of(constant(&sides.0)?, constant(&sides.1)?),
    }
}

/// Both sorted; shows the layers that differ.
fn difference(
    word: &str,
    location: SourceLocation,
    declared: SourceLocation,
    claimed: &[Cell],
    built: &[Cell],
) -> Diagnostic {
    let missing: Vec<Cell> = minus(claimed, built);
    let extra: Vec<Cell> = minus(built, claimed);
    let count = |cells: &[Cell], what: &str| match cells.len() {
        0 => None,
        1 => Some(format!("1 block {what}")),
        n => Some(format!("{n} blocks {what}")),
    };
    let parts: Vec<String> = [count(&missing, "missing"), count(&extra, "too many")]
        .into_iter()
        .flatten()
        .collect();
    Diagnostic::new(
        Code::ShapeMismatch,
        format!("the phase does not build `{word}`: {}", parts.join(", ")),
    )
    .label(location, "claimed here")
    .label(declared, "declared here")
    .help(picture(&missing, &extra, claimed, built))
}

fn minus(left: &[Cell], right: &[Cell]) -> Vec<Cell> {
    let absent = |cell: &&Cell| right.binary_search(cell).is_err();
    left.iter().filter(absent).copied().collect()
}

/// The lowest layer that differs, drawn; and in words if it is too wide.
fn picture(missing: &[Cell], extra: &[Cell], claimed: &[Cell], built: &[Cell]) -> String {
    const WIDEST: u32 = 30;
    let wrong = || missing.iter().chain(extra);
    let layer = wrong().map(|cell| cell.z).min().unwrap_or(1);
    let here = || claimed.iter().chain(built).filter(|cell| cell.z == layer);
    let bounds = CellBounds::of(here().copied());
    let (low, high) = bounds.map_or_else(Default::default, |it| (it.low, it.high));
    let is_wide = |low: i32, high: i32| high.abs_diff(low) > WIDEST;
    if is_wide(low.x, high.x) || is_wide(low.y, high.y) {
        let first = |cells: &[Cell]| {
            let shown: Vec<String> = cells.iter().take(5).map(Cell::to_string).collect();
            let dots = if cells.len() > 5 { ", ..." } else { "" };
            if shown.is_empty() {
                "none".to_owned()
            } else {
                shown.join(", ") + dots
            }
        };
        return format!("missing: {}; too many: {}", first(missing), first(extra));
    }
    let sign = |x, y| {
        let cell = Cell::new(x, y, layer);
        let has = |cells: &[Cell]| cells.binary_search(&cell).is_ok();
        match (has(claimed), has(built)) {
            (true, true) => '#',
            (true, false) => '-',
            (false, true) => '+',
            (false, false) => '.',
        }
    };
    format!(
        "layer {layer}, north at the top: `#` as claimed, `-` missing, `+` too many\n{}",
        layer_picture(low.x..=high.x, low.y..=high.y, sign)
    )
}
