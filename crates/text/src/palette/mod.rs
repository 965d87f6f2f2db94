//! Colours of all output: replays, reports, structures and scenes for other programs.
//!
//! Colours with different meanings differ by at least [`MIN`], with normal vision and with each
//! kind of colour blindness. Tests check every such pair.
#[cfg(test)]
mod distance;
mod sequential;

use std::fmt::{self, Display, Formatter};

pub use sequential::sequential;

/// Red, green and blue of sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rgb(pub u8, pub u8, pub u8);

impl Display for Rgb {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        write!(out, "#{:02x}{:02x}{:02x}", self.0, self.1, self.2)
    }
}

impl Rgb {
    /// Returns the linear light intensities, from 0 to 1.
    pub fn linear(self) -> [f64; 3] {
        [self.0, self.1, self.2].map(|part| match f64::from(part) / 255.0 {
            low if low <= 0.040_45 => low / 12.92,
            high => ((high + 0.055) / 1.055).powf(2.4),
        })
    }

    /// Returns the relative luminance of WCAG, from 0 to 1.
    pub fn luminance(self) -> f64 {
        let [red, green, blue] = self.linear();
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    /// Returns the WCAG contrast with another colour, from 1 to 21.
    pub fn contrast(self, other: Rgb) -> f64 {
        let (a, b) = (self.luminance() + 0.05, other.luminance() + 0.05);
        a.max(b) / a.min(b)
    }

    /// Scales each component to darken the colour.
    #[must_use]
    pub fn shaded(self, factor: f64) -> Rgb {
        let part = |part: u8| (f64::from(part) * factor).round() as u8;
        Rgb(part(self.0), part(self.1), part(self.2))
    }

    /// Returns the more readable text colour on this background: nearly black, or white.
    pub fn ink(self) -> Rgb {
        let inks = [Rgb(0x10, 0x14, 0x18), Rgb(0xff, 0xff, 0xff)];
        let [dark, light] = inks.map(|ink| self.contrast(ink));
        inks[usize::from(light > dark)]
    }
}

/// Smallest distinguishable difference (CIEDE2000).
pub const MIN: f64 = 10.0;

/// Colours of the phases. After the last colour, the first one follows again. Equal in all themes.
pub const PHASES: [Rgb; 8] = [
    Rgb(0xfa, 0xcf, 0x2f),
    Rgb(0x33, 0x62, 0x9d),
    Rgb(0x18, 0xbb, 0x93),
    Rgb(0x9b, 0x66, 0xeb),
    Rgb(0xc5, 0x7e, 0x69),
    Rgb(0xd5, 0x94, 0xf5),
    Rgb(0x92, 0x48, 0x47),
    Rgb(0x28, 0xfa, 0x9b),
];

/// Returns the colour of a phase, by its number from 0.
pub fn phase(number: usize) -> Rgb {
    PHASES[number % PHASES.len()]
}

/// Colours of a theme.
#[derive(Clone, Copy, Debug)]
pub struct Theme {
    /// Background of 3D views.
    pub background: Rgb,
    /// Ground of 3D views.
    pub ground: Rgb,
    /// Colour of the rings on the ground.
    pub rings: Rgb,
    /// Colour of the lines of the shell.
    pub shell: Rgb,
    /// Colour of named blocks of the plate.
    pub seed: Rgb,
    /// Colour of other blocks of the plate.
    pub plate: Rgb,
    /// Colour of free blocks.
    pub free: Rgb,
    /// Colours of free blocks in groups, from small to large groups.
    pub groups: [Rgb; 5],
    /// Colour of open faces, attracted blocks, and released blocks.
    pub lit: Rgb,
    /// Colour of the edges of the selected block.
    pub mark: Rgb,
    /// Colour of text.
    pub ink: Rgb,
    /// Colour of the outline of text.
    pub halo: Rgb,
    /// Background of figures.
    pub paper: Rgb,
    /// Colours of curves, bars and discs of compared items.
    pub series: [Rgb; 6],
    /// Colour of highlights in figures.
    pub hot: Rgb,
    /// Colour of background elements in figures.
    pub rest: Rgb,
}

impl Theme {
    /// Returns the colours of 3D views, with the names that pages use.
    pub fn named(&self) -> [(&'static str, Rgb); 11] {
        [
            ("background", self.background),
            ("ground", self.ground),
            ("rings", self.rings),
            ("shell", self.shell),
            ("seed", self.seed),
            ("plate", self.plate),
            ("free", self.free),
            ("lit", self.lit),
            ("mark", self.mark),
            ("ink", self.ink),
            ("halo", self.halo),
        ]
    }

    fn json(&self) -> String {
        let named = self.named();
        let named = named.map(|(name, colour)| format!("\"{name}\":\"{colour}\""));
        let groups = self.groups.map(|colour| format!("\"{colour}\""));
        format!("{{\"groups\":[{}],{}}}", groups.join(","), named.join(","))
    }
}

/// Returns the palette of 3D views as JSON: `{ phases: [{ colour, ink }], dark: { background, ...,
/// groups: [...] }, light: { ... } }`.
pub fn json() -> String {
    let phases =
        PHASES.map(|colour| format!("{{\"colour\":\"{colour}\",\"ink\":\"{}\"}}", colour.ink()));
    let (phases, dark, light) = (phases.join(","), DARK.json(), LIGHT.json());
    format!("{{\"phases\":[{phases}],\"dark\":{dark},\"light\":{light}}}")
}

/// Dark theme.
pub const DARK: Theme = Theme {
    background: Rgb(0x12, 0x16, 0x1c),
    ground: Rgb(0x1d, 0x24, 0x2d),
    rings: Rgb(0x3a, 0x46, 0x54),
    shell: Rgb(0x55, 0x65, 0x7a),
    seed: Rgb(0xaa, 0xb4, 0xc0),
    plate: Rgb(0x4a, 0x55, 0x63),
    free: Rgb(0x87, 0x94, 0xa6),
    groups: [
        Rgb(0x00, 0x42, 0x32),
        Rgb(0x00, 0x75, 0x57),
        Rgb(0x00, 0xa9, 0x7d),
        Rgb(0x77, 0xd6, 0xae),
        Rgb(0xca, 0xff, 0xe4),
    ],
    lit: Rgb(0xff, 0x5a, 0x36),
    mark: Rgb(0xff, 0xff, 0xff),
    ink: Rgb(0xff, 0xff, 0xff),
    halo: Rgb(0x0b, 0x0e, 0x12),
    paper: Rgb(0x15, 0x17, 0x1c),
    series: [
        Rgb(0x3e, 0xe7, 0xfa),
        Rgb(0xfa, 0x15, 0x8d),
        Rgb(0x3a, 0xa9, 0xb6),
        Rgb(0xa9, 0x67, 0xfa),
        Rgb(0xd0, 0xfa, 0xb2),
        Rgb(0x8e, 0x8c, 0x05),
    ],
    hot: Rgb(0xe5, 0x95, 0x84),
    rest: Rgb(0x76, 0x7b, 0x84),
};

/// Light theme, also for print.
pub const LIGHT: Theme = Theme {
    background: Rgb(0xf4, 0xf5, 0xf7),
    ground: Rgb(0xe3, 0xe6, 0xea),
    rings: Rgb(0xc2, 0xc8, 0xd0),
    shell: Rgb(0xa4, 0xad, 0xb9),
    seed: Rgb(0x6c, 0x76, 0x83),
    plate: Rgb(0xb4, 0xbc, 0xc6),
    free: Rgb(0x87, 0x92, 0xa6),
    groups: [
        Rgb(0xf6, 0xb2, 0xf9),
        Rgb(0xcc, 0x82, 0xe1),
        Rgb(0xa1, 0x52, 0xcb),
        Rgb(0x6e, 0x34, 0x9f),
        Rgb(0x3f, 0x1a, 0x6d),
    ],
    lit: Rgb(0xe0, 0x30, 0x1e),
    mark: Rgb(0x00, 0x00, 0x00),
    ink: Rgb(0x14, 0x18, 0x1d),
    halo: Rgb(0xff, 0xff, 0xff),
    paper: Rgb(0xfc, 0xfc, 0xfa),
    series: [
        Rgb(0x20, 0x6b, 0xf2),
        Rgb(0xc8, 0x0d, 0x05),
        Rgb(0x17, 0x78, 0x65),
        Rgb(0x77, 0x0e, 0x5b),
        Rgb(0xcd, 0x36, 0x69),
        Rgb(0x3e, 0x31, 0xb7),
    ],
    hot: Rgb(0x81, 0x06, 0x15),
    rest: Rgb(0x9a, 0x9a, 0x96),
};
