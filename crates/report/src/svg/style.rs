//! Styles of shapes by class, for light and dark themes and for paper.
//!
//! The same rules give the stylesheet of SVG and the styles of PDF.
use std::fmt::Write as _;
use std::sync::LazyLock;

use stochc_text::palette::{DARK, LIGHT, PHASES, Rgb, Theme};

use super::Medium;

/// Number of colours for distinguishing compared items.
const COLOURS: usize = 6;

/// Dash pattern for each colour of compared items, so that they differ not only by colour.
const DASHES: [&str; COLOURS] = ["", "7 3", "2 3", "9 3 2 3", "4 4", "1 4"];

/// Returns the dash pattern of compared item `i`. Items with the same colour have different
/// patterns.
pub(crate) fn dashes(i: usize) -> &'static str {
    DASHES[(i + i / COLOURS) % COLOURS]
}

/// Colour, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Paint {
    Colour(Rgb),
    Nothing,
}

/// Properties of a style. `None` if a property is not set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Style {
    pub fill: Option<Paint>,
    pub stroke: Option<Paint>,
    /// Width of lines, in units of the drawing.
    pub width: Option<f64>,
    pub opacity: Option<f64>,
    pub fill_opacity: Option<f64>,
    pub stroke_opacity: Option<f64>,
}

impl Style {
    /// Style with the initial values of all properties.
    const INITIAL: Style = Style {
        fill: Some(Paint::Colour(Rgb(0, 0, 0))),
        stroke: Some(Paint::Nothing),
        width: Some(1.0),
        opacity: Some(1.0),
        fill_opacity: Some(1.0),
        stroke_opacity: Some(1.0),
    };

    fn fill(paint: Rgb) -> Style {
        Style {
            fill: Some(Paint::Colour(paint)),
            ..Style::default()
        }
    }

    fn stroke(paint: Rgb) -> Style {
        Style {
            stroke: Some(Paint::Colour(paint)),
            ..Style::default()
        }
    }

    fn both(paint: Rgb) -> Style {
        Style::fill(paint).then(Style::stroke(paint))
    }

    /// Returns a style for a line of this width.
    pub fn line(width: f64) -> Style {
        Style {
            width: Some(width),
            ..Style::default()
        }
    }

    /// Returns the style with another opacity, from 0 to 1.
    pub fn faint(self, opacity: f64) -> Style {
        Style {
            opacity: Some(opacity),
            ..self
        }
    }

    /// Returns a style for a filled area without an outline.
    pub fn area(paint: Rgb) -> Style {
        Style {
            stroke: Some(Paint::Nothing),
            ..Style::fill(paint)
        }
    }

    /// Returns the combination of two styles. The properties of `later` take precedence.
    pub fn then(self, later: Style) -> Style {
        Style {
            fill: later.fill.or(self.fill),
            stroke: later.stroke.or(self.stroke),
            width: later.width.or(self.width),
            opacity: later.opacity.or(self.opacity),
            fill_opacity: later.fill_opacity.or(self.fill_opacity),
            stroke_opacity: later.stroke_opacity.or(self.stroke_opacity),
        }
    }

    /// Returns the name and value of each property that is set, as in SVG.
    fn properties(&self) -> impl Iterator<Item = (&'static str, String)> {
        let paint = |paint: Option<Paint>| {
            paint.map(|paint| match paint {
                Paint::Colour(colour) => colour.to_string(),
                Paint::Nothing => "none".to_owned(),
            })
        };
        let number = |number: Option<f64>| number.map(|number| number.to_string());
        let all = [
            ("fill", paint(self.fill)),
            ("stroke", paint(self.stroke)),
            ("stroke-width", number(self.width)),
            ("opacity", number(self.opacity)),
            ("fill-opacity", number(self.fill_opacity)),
            ("stroke-opacity", number(self.stroke_opacity)),
        ];
        (all.into_iter()).filter_map(|(name, value)| Some((name, value?)))
    }

    /// Returns the style as declarations of a stylesheet.
    fn css(&self) -> String {
        let declarations = self
            .properties()
            .map(|(name, value)| format!("{name}:{value}"));
        declarations.collect::<Vec<_>>().join(";")
    }

    /// Returns the style as attributes of an SVG element, each after a space.
    pub fn attributes(&self) -> String {
        let attributes = self
            .properties()
            .map(|(name, value)| format!(" {name}=\"{value}\""));
        attributes.collect()
    }
}

type StyleRule = (String, Style);

/// Returns the style rules of a theme, in ascending precedence.
fn rules(theme: &Theme) -> Vec<StyleRule> {
    let is_light = theme.paper.luminance() > 0.5;
    let [dim, axis, grid, grey] = if is_light {
        [
            Rgb(0x5c, 0x5c, 0x5c),
            Rgb(0x66, 0x66, 0x66),
            Rgb(0xe2, 0xe2, 0xde),
            Rgb(0xd0, 0xd0, 0xca),
        ]
    } else {
        [
            Rgb(0xa9, 0xad, 0xb4),
            Rgb(0xa0, 0xa4, 0xab),
            Rgb(0x2c, 0x30, 0x38),
            Rgb(0x3a, 0x3f, 0x48),
        ]
    };
    let (ink, paper) = (theme.ink, theme.paper);
    let greys = [
        ("dim", Style::fill(dim)),
        ("axis", Style::stroke(axis)),
        ("grid", Style::stroke(grid)),
        ("grey", Style::fill(grey)),
    ];
    let phases = (0..).zip(PHASES);
    let phases = phases.map(|(n, colour)| (format!("p{n}"), Style::both(colour)));
    let themed = [
        ("paper", Style::fill(paper)),
        ("ink", Style::fill(ink)),
        ("mark", Style::stroke(ink)),
        ("casing", Style::stroke(ink)),
        ("reference", Style::both(ink)),
        ("rim", Style::stroke(ink)),
        ("halo", Style::stroke(paper)),
        ("hatch", Style::stroke(paper)),
        ("rest", Style::both(theme.rest)),
        ("hot", Style::both(theme.hot)),
    ];
    let series = (0..).zip(theme.series);
    let series = series.map(|(n, colour)| (format!("s{n}"), Style::both(colour)));
    let without = Style {
        stroke: Some(Paint::Nothing),
        ..Style::default()
    };
    let open = Style {
        fill: Some(Paint::Nothing),
        ..Style::default()
    };
    let shapes = [
        ("faint", without.faint(0.45)),
        ("halo", Style::line(3.0)),
        ("bar", without),
        ("curve", open.then(Style::line(1.8))),
        ("casing", open.then(Style::line(3.6))),
        ("rim", Style::line(0.8)),
        ("band", without.faint(0.16)),
        ("word", without),
        ("outline", Style::line(0.6)),
    ];
    let named = |rules: Vec<(&str, Style)>| -> Vec<StyleRule> {
        let rules = rules.into_iter();
        rules
            .map(|(name, style)| (name.to_owned(), style))
            .collect()
    };
    let mut all = named(greys.into());
    all.extend(phases);
    all.extend(named(themed.into()));
    all.extend(series);
    all.extend(named(shapes.into()));
    all
}

const PAPER: Theme = Theme {
    paper: Rgb(0xff, 0xff, 0xff),
    ..LIGHT
};

static LIGHT_RULES: LazyLock<Vec<StyleRule>> = LazyLock::new(|| rules(&LIGHT));
static PAPER_RULES: LazyLock<Vec<StyleRule>> = LazyLock::new(|| rules(&PAPER));

/// Returns the style of a shape with these classes on white paper. All its properties are set.
pub(crate) fn on_paper(classes: &str) -> Style {
    let own = |rule: &&StyleRule| classes.split_whitespace().any(|class| class == rule.0);
    let rules = PAPER_RULES.iter().filter(own);
    rules.fold(Style::INITIAL, |style, (_, rule)| style.then(*rule))
}

fn css(rules: &[StyleRule]) -> String {
    rules.iter().fold(String::new(), |mut all, (class, style)| {
        let order = if class == "halo" {
            ";paint-order:stroke"
        } else {
            ""
        };
        // Writing to a string cannot fail.
        let _ = write!(all, ".{class}{{{}{order}}}", style.css());
        all
    })
}

/// Stylesheet of drawings on a screen. The classes `s0` to `s5` are for compared items, `p0` to
/// `p7` for phases.
pub(crate) static STYLE: LazyLock<String> = LazyLock::new(|| {
    format!(
        "{}@media screen and (prefers-color-scheme:dark){{{}}}",
        css(&LIGHT_RULES),
        css(&rules(&DARK))
    )
});

/// Returns the stylesheet for a drawing in its own file.
pub(crate) fn stylesheet(medium: Medium) -> String {
    match medium {
        Medium::Screen => STYLE.clone(),
        Medium::Print(_) => css(&PAPER_RULES),
    }
}

/// Kind of items that the colours of a figure distinguish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Colours {
    /// Compared items, such as programs. Their colours are readable on paper.
    Compared,
    /// Phases. Their colours are the same in both themes, with a darker or lighter outline.
    Phases,
}

impl Colours {
    /// Returns the style class of item `i`.
    pub fn class(self, i: usize) -> &'static str {
        match self {
            Colours::Compared => class(i),
            Colours::Phases => phase(i),
        }
    }
}

/// Returns the style class of compared item `i`.
pub(crate) fn class(i: usize) -> &'static str {
    ["s0", "s1", "s2", "s3", "s4", "s5"][i % COLOURS]
}

fn phase(i: usize) -> &'static str {
    ["p0", "p1", "p2", "p3", "p4", "p5", "p6", "p7"][i % PHASES.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_one_colour_have_different_dashes() {
        let lines = (0..COLOURS * COLOURS).map(|i| (class(i), dashes(i)));
        let mut seen = std::collections::BTreeSet::new();
        assert!(lines.into_iter().all(|line| seen.insert(line)));
    }

    #[test]
    fn a_later_rule_wins_in_any_order_of_classes() {
        for classes in ["bar s0", "s0 bar"] {
            let style = on_paper(classes);
            assert_eq!(style.fill, Some(Paint::Colour(LIGHT.series[0])));
            assert_eq!(style.stroke, Some(Paint::Nothing));
        }
        assert_eq!(on_paper("rim p1").stroke, Some(Paint::Colour(LIGHT.ink)));
        assert_eq!(on_paper("nothing of the kind"), Style::INITIAL);
    }
}
