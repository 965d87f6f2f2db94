//! Compares claimed shapes with structures.
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::{Expr, ExprKind, Shape, Subscript};
use stochc_grammar::{Cancellation, Cancelled, Symbol, Symbols};
use stochc_ir::{Cell, CellBounds};

use crate::diagnostic::layer_picture::layer_picture;
use crate::diagnostic::{Code, Diagnostic, Severity, is_full, report, suggestion};
use crate::expand::Shapes;
use crate::expanded::{ExpandedProgram, ShapeClaim};
use crate::names::Names;
use crate::shapes::layout::Layout;
use crate::{FileId, SourceLocation};

/// Largest number of cells of one shape. Also the largest number of blocks of all claimed shapes
/// together.
pub(crate) const MAX_CELLS: usize = 5_000_000;

/// Largest number of cells that are compared to describe differences.
const MAX_COMPARED: usize = 20_000_000;

/// Compares the claimed shapes of phases with their structures.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn check(
    plan: &ExpandedProgram,
    layout: &Layout,
    shapes: &Shapes<'_>,
    names: &Names,
    symbols: &Symbols,
    cancellation: Cancellation<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<(), Cancelled> {
    let mut comparison = Comparison::default();
    for (phase, (emptied, filled)) in plan.phases.iter().zip(&layout.changes) {
        let built = &mut comparison.built;
        emptied.iter().for_each(|&cell| built.remove(cell));
        filled.iter().for_each(|&cell| built.insert(cell));
        for &claim in &phase.claims {
            let (name, location) = (claim.shape, claim.location);
            cancellation.check()?;
            let word = symbols.word(name);
            let definition = names.definition(location.file, location.span);
            let Some(&(file, shape)) = definition.and_then(|it| shapes.get(&it)) else {
                let known = shapes.values();
                let known = known.map(|(_, known)| symbols.word(known.name.symbol));
                let diagnostic =
                    Diagnostic::about(Code::UnknownName, "cannot find shape `{}`", &[word])
                        .label(location, "no shape has this name")
                        .suggest(location, suggestion(diagnostics, word, known), || {
                            format!("declare it: `shape {word} {{ layer 1 {{ # }} }}`")
                        });
                report(diagnostics, diagnostic);
                continue;
            };
            let declared = SourceLocation {
                file,
                span: shape.name.span,
            };
            let is_known = comparison.claimed.contains_key(&name);
            if !is_known && !comparison.read(name, (file, shape), location, diagnostics) {
                continue;
            }
            if is_full(diagnostics, Severity::Error) {
                continue;
            }
            if let Some((title, help)) = comparison.difference(claim, word) {
                let diagnostic = Diagnostic::new(Code::ShapeMismatch, title)
                    .label(location, "claimed by this phase")
                    .label(declared, "declared here")
                    .help(help);
                report(diagnostics, diagnostic);
            }
        }
    }
    Ok(())
}

#[derive(Default)]
struct Comparison {
    built: BuiltCells,
    /// Claimed shapes. `None` for a shape that cannot be read.
    claimed: FxHashMap<Symbol, Option<ClaimedShape>>,
    /// Total number of blocks of the shapes read so far.
    blocks: usize,
    /// Results by shape, kind of claim and fingerprint: a title and a help, or `None` if the claim
    /// is true.
    results: FxHashMap<(Symbol, bool, u64), Option<(String, String)>>,
    /// Number of compared cells.
    compared: usize,
}

struct ClaimedShape {
    /// Sorted cells, each once.
    cells: Vec<Cell>,
    fingerprint: u64,
}

impl Comparison {
    /// Reads a shape at its first claim. Returns whether it can be compared.
    fn read(
        &mut self,
        name: Symbol,
        (file, shape): (FileId, &Shape),
        claim: SourceLocation,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> bool {
        let mut claimed = cells(shape, file, diagnostics).map(ClaimedShape::new);
        self.blocks += claimed.as_ref().map_or(0, |claimed| claimed.cells.len());
        if self.blocks > MAX_CELLS && claimed.is_some() {
            claimed = None;
            let title = "the claimed shapes have more than 5,000,000 blocks together";
            let diagnostic = Diagnostic::new(Code::ExpansionLimit, title)
                .label(claim, "the limit is reached with this claim")
                .help("claim fewer shapes, or smaller ones");
            report(diagnostics, diagnostic);
        }
        let is_read = claimed.is_some();
        self.claimed.insert(name, claimed);
        is_read
    }

    /// Returns the title and the help of the error for a false claim. Returns `None` if the claim
    /// is true.
    fn difference(&mut self, claim: ShapeClaim, word: &str) -> Option<(String, String)> {
        let claimed = self.claimed.get(&claim.shape)?.as_ref()?;
        let at_least = claim.at_least;
        let now = (claim.shape, at_least, self.built.fingerprint);
        if let Some(known) = self.results.get(&now) {
            return known.clone();
        }
        let result = match claimed.is_built(&self.built, at_least) {
            true => None,
            false if self.compared > MAX_COMPARED => Some((
                format!("the phase does not build shape `{word}`"),
                "fix the other claims first: the difference was not computed".to_owned(),
            )),
            false => {
                self.compared += claimed.cells.len() + self.built.cells.len();
                Some(difference(
                    word,
                    &claimed.cells,
                    &self.built.cells,
                    at_least,
                ))
            }
        };
        self.results.insert(now, result.clone());
        result
    }
}

impl ClaimedShape {
    fn new(mut cells: Vec<Cell>) -> ClaimedShape {
        cells.sort_unstable();
        cells.dedup();
        let fingerprint = cells.iter().map(|&cell| hash(cell));
        ClaimedShape {
            fingerprint: fingerprint.fold(0, u64::wrapping_add),
            cells,
        }
    }

    /// Returns whether the structure occupies the cells of the shape. It may occupy further cells
    /// only with `at_least`.
    fn is_built(&self, built: &BuiltCells, at_least: bool) -> bool {
        let may_be_equal =
            self.fingerprint == built.fingerprint && self.cells.len() == built.cells.len();
        (at_least || may_be_equal) && self.cells.iter().all(|cell| built.cells.contains(cell))
    }
}

/// Cells of the structure at the end of a phase.
#[derive(Default)]
struct BuiltCells {
    cells: FxHashSet<Cell>,
    /// Sum of the hashes of all cells, modulo 2^64. It does not depend on their order.
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

/// Returns the cells of a shape, unsorted. Returns `None` if it cannot be read, which is reported.
pub fn cells(shape: &Shape, file: FileId, diagnostics: &mut Vec<Diagnostic>) -> Option<Vec<Cell>> {
    let malformed = |span, title: &str, text: &str| {
        Diagnostic::new(Code::ShapeMalformed, title).label(SourceLocation { file, span }, text)
    };
    let mut number = |expr: &Expr| {
        let value = constant(expr).and_then(|value| i32::try_from(value).ok());
        if value.is_none() {
            diagnostics.push(malformed(
                expr.span,
                "a position in a shape must be a plain number",
                "this is a name, or does not fit in 32 bits",
            ));
        }
        value
    };
    let (x, y) = match &shape.at {
        Some((x, y)) => (number(x)?, number(y)?),
        None => (0, 0),
    };
    let mut cells = Vec::new();
    // Empty cells count as well, because each is visited.
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
                malformed(
                    layer.span,
                    "the layers of a shape start at 1",
                    "this height is below 1, or the range is empty",
                )
                .help("write `layer 1` for the lowest layer, or `layer 1..2` for two equal layers"),
            );
            return None;
        }
        let rows = layer.rows.len();
        let count: usize = layer.rows.iter().map(|row| row.cells.len()).sum();
        let levels = (high - low) as usize + 1;
        area = area.saturating_add(count.saturating_mul(levels));
        if area > MAX_CELLS {
            diagnostics.push(malformed(
                layer.span,
                "a shape has more than 5,000,000 cells",
                "the limit is reached in this layer",
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
                "a shape reaches beyond 32-bit coordinates",
                "the limit is reached in this layer",
            ));
            return None;
        }
        let blocks = layer.rows.iter().flat_map(|row| &row.cells);
        cells.reserve_exact(blocks.filter(|block| **block).count() * levels);
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

/// Returns the value of an expression without names. Shapes are outside of loops and patterns, so
/// their numbers have no names. Returns `None` for any other expression.
fn constant(expr: &Expr) -> Option<i64> {
    match &expr.kind {
        ExprKind::Int(value) => Some(*value),
        ExprKind::Name(_) | ExprKind::Face(_) => None,
        ExprKind::Negate(inner) => constant(inner)?.checked_neg(),
        ExprKind::Call(function, arguments) => {
            let values: Option<Vec<i64>> = arguments.iter().map(constant).collect();
            function.apply(&values?)
        }
        // A shape has no conditions.
        ExprKind::Not(_) => None,
        ExprKind::Binary(operator, sides) => {
            operator.apply(constant(&sides.0)?, constant(&sides.1)?)
        }
    }
}

/// Returns the title and the help of the error for a shape and a structure that differ. The cells
/// of the shape are sorted. With `at_least`, only missing blocks count.
fn difference(
    word: &str,
    claimed: &[Cell],
    built: &FxHashSet<Cell>,
    at_least: bool,
) -> (String, String) {
    let absent = |cell: &&Cell| !built.contains(cell);
    let missing: Vec<Cell> = claimed.iter().filter(absent).copied().collect();
    let unclaimed = |cell: &&Cell| !at_least && claimed.binary_search(cell).is_err();
    let mut extra: Vec<Cell> = built.iter().filter(unclaimed).copied().collect();
    extra.sort_unstable();
    let count = |cells: &[Cell], what: &str| match cells.len() {
        0 => None,
        1 => Some(format!("1 block {what}")),
        n => Some(format!("{n} blocks {what}")),
    };
    let parts: Vec<String> = [count(&missing, "missing"), count(&extra, "too many")]
        .into_iter()
        .flatten()
        .collect();
    let title = format!(
        "the phase does not build shape `{word}`: {}",
        parts.join(", ")
    );
    (title, picture(&missing, &extra, claimed, built))
}

/// Draws the lowest layer that differs. Describes it in words if it is too wide.
fn picture(missing: &[Cell], extra: &[Cell], claimed: &[Cell], built: &FxHashSet<Cell>) -> String {
    const WIDEST: u32 = 30;
    let wrong = || missing.iter().chain(extra);
    let layer = wrong().map(|cell| cell.z).min().unwrap_or(1);
    let here = || claimed.iter().chain(built).filter(|cell| cell.z == layer);
    let bounds = CellBounds::enclosing(here().copied());
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
        let is_claimed = claimed.binary_search(&cell).is_ok();
        match (is_claimed, built.contains(&cell)) {
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
