//! Figures of maps: slices with a colour for each cell of the lattice.
use stochc_text::number;
use stochc_text::palette::sequential;

use super::EDGE;
use crate::analysis::maps::SliceMap;
use crate::svg::{Drawing, Medium, PlotAxis, Scale, Style};

/// Slices with a common colour scale, side by side or stacked.
pub(crate) struct MapColumn<'a> {
    pub title: String,
    pub maps: Vec<&'a SliceMap>,
    /// Quantity and unit of the colours.
    pub shows: PlotAxis,
    /// Factor that converts values of the maps to the unit of `shows`.
    pub unit: f64,
}

/// Distance between panels and around them, in units of a drawing.
const GAP: f64 = 22.0;
/// Width of the axis to the left of a panel, in units of a drawing.
const AXIS: f64 = 40.0;
/// Height of the colour scale, in units of a drawing.
const SAMPLE: f64 = 10.0;
/// Number of colours in the colour scale.
const STEPS: usize = 40;

/// Draws maps in columns, with the colour scale of each column below. Returns `None` if all maps
/// are empty.
pub(crate) fn maps(
    medium: Medium,
    name: &str,
    (title, description): (&str, &str),
    columns: &[MapColumn],
) -> Option<Drawing> {
    let most = |column: &MapColumn| {
        let values = column.maps.iter().flat_map(|map| map.places.values());
        values.map(|ratio| ratio.value).fold(0.0, f64::max) * column.unit
    };
    if columns.iter().all(|column| most(column) <= 0.0) {
        return None;
    }
    let mut out = Drawing::new(medium, name, title, description);
    let wide = (medium.width() - EDGE - GAP * columns.len() as f64) / columns.len() as f64;
    let mut end: f64 = 0.0;
    for (i, column) in columns.iter().enumerate() {
        let left = EDGE + (wide + GAP) * i as f64;
        let (from, to) = (left + AXIS, left + wide);
        let mut y = out.paragraph("ink", (left, 18.0), wide, &column.title);
        let most = most(column);
        for map in &column.maps {
            y = panel(&mut out, map, (from, to), (left, y), (most, column.unit));
        }
        y = key(&mut out, (from, to), y - 6.0, most, &column.shows);
        end = end.max(y);
    }
    Some(out.high(end - 8.0))
}

/// Draws one slice. Returns the baseline of the next line of text.
fn panel(
    out: &mut Drawing,
    map: &SliceMap,
    (left, right): (f64, f64),
    (edge, y): (f64, f64),
    (most, unit): (f64, f64),
) -> f64 {
    let ((west, east), (low, high)) = map.ends;
    let side = (right - left) / f64::from(east - west + 1);
    let up = PlotAxis::new(map.slice.up(), "side");
    let top = y + 24.0;
    let bottom = top + side * f64::from(high - low + 1);
    let ends = |from: i32, to: i32| (f64::from(from) - 0.5, f64::from(to) + 0.5);
    let across = Scale::linear(ends(west, east), (left, right));
    let upward = Scale::linear(ends(low, high), (bottom, top));
    let corner =
        |(x, y): (i32, i32)| (across.at(f64::from(x) - 0.5), upward.at(f64::from(y) + 0.5));
    for (position, ratio) in map.places.iter().filter(|(_, ratio)| ratio.value > 0.0) {
        let corner = corner(*position);
        let colour = sequential((unit * ratio.value / most).min(1.0));
        let interval = ratio
            .interval
            .map(|(from, to)| format!(", {} to {}", number(unit * from), number(unit * to)));
        let tooltip = format!(
            "{} east, {} {}: {}{}",
            position.0,
            position.1,
            map.slice.up(),
            number(unit * ratio.value),
            interval.unwrap_or_default()
        );
        out.field("", corner, (side, side), Style::area(colour), &tooltip);
        if !ratio.is_certain() {
            let centre = (corner.0 + side / 2.0, corner.1 + side / 2.0);
            let own = Style::area(colour.ink());
            out.spot(centre, (0.12 * side).clamp(0.6, 1.6), own);
        }
    }
    let is_inside =
        |&&(x, y): &&(i32, i32)| (west..=east).contains(&x) && (low..=high).contains(&y);
    for position in map.structure.iter().filter(is_inside) {
        let (x, y) = corner(*position);
        let corners = [
            (x, y),
            (x + side, y),
            (x + side, y + side),
            (x, y + side),
            (x, y),
        ];
        out.curve("mark outline", &corners, "");
    }
    // Only whole block lengths have ticks.
    let marks: Vec<(f64, String)> = (upward.ticks(5).into_iter())
        .filter(|tick| tick.fract() == 0.0)
        .map(|tick| (upward.at(tick), number(tick)))
        .collect();
    out.marks_upward(&marks, (bottom, top), (edge, left), &up.label());
    let marks: Vec<(f64, String)> = (across.ticks(5).into_iter())
        .filter(|tick| tick.fract() == 0.0)
        .map(|tick| (across.at(tick), number(tick)))
        .collect();
    let label = PlotAxis::new("east", "side").label();
    out.marks_across(&marks, (left, right), bottom, &label)
}

/// Draws the colour scale of a column.
fn key(out: &mut Drawing, (left, right): (f64, f64), y: f64, most: f64, shows: &PlotAxis) -> f64 {
    let step = (right - left) / STEPS as f64;
    for i in 0..STEPS {
        let colour = sequential((i as f64 + 0.5) / STEPS as f64);
        let corner = (left + step * i as f64, y);
        out.field("", corner, (step + 0.3, SAMPLE), Style::area(colour), "");
    }
    let scale = Scale::linear((0.0, most), (left, right));
    let marks: Vec<(f64, String)> = (scale.ticks(3).into_iter())
        .map(|tick| (scale.at(tick), number(tick)))
        .collect();
    out.marks_across(&marks, (left, right), y + SAMPLE, &shows.label())
}
