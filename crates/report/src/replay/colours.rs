//! Colours of the replay page.
use stochc_text::palette::{self, DARK, LIGHT, PHASES, Theme};

/// Returns the JavaScript line `const PALETTE = ...;` with [`palette::json`].
pub(super) fn script() -> String {
    format!("const PALETTE = {};\n", palette::json())
}

/// Returns CSS custom properties for the page. Each theme has `--free`, `--lit`, `--group-0` to
/// `--group-4` and others. `--phase-0` to `--phase-7` are common.
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
