//! Colours as classes, for light and for dark.
use std::fmt::Write as _;
use std::sync::LazyLock;

use stochc_ir::palette::{DARK, LIGHT, PHASES, Theme};

/// Colours of things that are compared.
const COLOURS: usize = 6;

/// Dashes of their lines, so that colour is never the only difference.
pub(crate) const DASHES: [&str; COLOURS] = ["", "7 3", "2 3", "9 3 2 3", "4 4", "1 4"];

const LIGHT_GREYS: &str = "\
.dim{fill:#5c5c5c}.axis{stroke:#666}.grid{stroke:#e2e2de}.grey{fill:#d0d0ca}";
const DARK_GREYS: &str = "\
.dim{fill:#a9adb4}.axis{stroke:#a0a4ab}.grid{stroke:#2c3038}.grey{fill:#3a3f48}";

/// What a picture needs to be shown alone: `s0` to `s5` are what is compared, `p0` to `p7` phases.
pub(crate) static STYLE: LazyLock<String> = LazyLock::new(|| {
    let phases = (0..)
        .zip(PHASES)
        .fold(String::new(), |mut all, (n, colour)| {
            let _ = write!(all, ".p{n}{{fill:{colour};stroke:{colour}}}");
            all
        });
    format!(
        "{LIGHT_GREYS}{phases}{}\
         .faint{{stroke:none;opacity:.45}}.halo{{stroke-width:3;paint-order:stroke}}.bar{{stroke:none}}\
         .curve,.casing{{fill:none;stroke-width:1.8}}.casing{{stroke-width:3.6}}.rim{{stroke-width:.8}}.band{{stroke:none;opacity:.16}}.word{{stroke:none}}\
         @media screen and (prefers-color-scheme:dark){{{DARK_GREYS}{}\
         .curve{{fill:none}}.bar,.band,.word,.faint{{stroke:none}}}}",
        themed(&LIGHT),
        themed(&DARK)
    )
});

fn themed(theme: &Theme) -> String {
    let Theme {
        paper,
        ink,
        rest,
        hot,
        ..
    } = theme;
    let mut all = format!(
        ".paper{{fill:{paper}}}.ink{{fill:{ink}}}.mark,.casing{{stroke:{ink}}}.reference{{fill:{ink};stroke:{ink}}}.rim{{stroke:{ink}}}.halo,.hatch{{stroke:{paper}}}\
         .rest{{fill:{rest};stroke:{rest}}}.hot{{fill:{hot};stroke:{hot}}}"
    );
    for (n, colour) in (0..).zip(theme.series) {
        let _ = write!(all, ".s{n}{{fill:{colour};stroke:{colour}}}");
    }
    all
}

/// What the curves of a figure are of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Colours {
    /// What is compared: readable on paper.
    Compared,
    /// Phases, which are the same on light and dark, and have a darker or lighter line around them.
    Phases,
}

impl Colours {
    /// The class of number `i`.
    pub fn class(self, i: usize) -> &'static str {
        match self {
            Colours::Compared => class(i),
            Colours::Phases => phase(i),
        }
    }
}

/// The class of number `i` of what is compared.
pub(crate) fn class(i: usize) -> &'static str {
    ["s0", "s1", "s2", "s3", "s4", "s5"][i % COLOURS]
}

/// The class of the phase of number `i`.
pub(crate) fn phase(i: usize) -> &'static str {
    ["p0", "p1", "p2", "p3", "p4", "p5", "p6", "p7"][i % PHASES.len()]
}
