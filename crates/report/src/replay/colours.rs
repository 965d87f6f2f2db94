//! Palette of the page.
use stochc_text::palette::{self, DARK, LIGHT, PHASES, Theme};

/// Returns `const PALETTE = ...;` with [`palette::json`].
pub(super) fn script() -> String {
    format!("const PALETTE = {};\n", palette::json())
}

/// Returns custom properties of the page: `--free`, `--lit`, `--group-0` to `--group-4` and others
/// for each theme, and `--phase-0` to `--phase-7`.
pub(crate) fn style() -> String {
    let properties = |theme: &Theme| -> String {
        let each = theme
            .named()
            .map(|(name, colour)| format!("--{name}:{colour};"));
        let groups = (0..)
            .zip(theme.groups)
            .map(|(n, colour)| format!("--group-{n}:{colour};"));
        each.into_iter().chain(groups).collect()
    };
    let phases: String = (0..)
        .zip(PHASES)
        .map(|(n, colour)| format!("--phase-{n}:{colour};"))
        .collect();
    let (dark, light) = (properties(&DARK), properties(&LIGHT));
    format!(
        ":root{{{phases}{light}}}\n\
         @media (prefers-color-scheme:dark){{:root:not([data-theme]){{{dark}}}}}\n\
         :root[data-theme='dark']{{{dark}}}\n"
    )
}
