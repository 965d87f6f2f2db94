//! Palette of the page.
use serde_json::{Value, json};
use stochc_text::palette::{DARK, LIGHT, PHASES, Rgb, Theme};

/// Returns the named colours of a theme in the arena.
fn named(theme: &Theme) -> [(&'static str, Rgb); 11] {
    [
        ("background", theme.background),
        ("ground", theme.ground),
        ("rings", theme.rings),
        ("shell", theme.shell),
        ("seed", theme.seed),
        ("plate", theme.plate),
        ("free", theme.free),
        ("lit", theme.lit),
        ("mark", theme.mark),
        ("ink", theme.ink),
        ("halo", theme.halo),
    ]
}

/// Returns `const PALETTE = { phases: [{ colour, ink }], dark: { background, ..., groups: [...] },
/// light: { ... } };`
pub(super) fn script() -> String {
    let theme = |theme: &Theme| {
        let colours =
            named(theme).map(|(name, colour)| (name.to_owned(), json!(colour.to_string())));
        let groups = theme.groups.map(|colour| colour.to_string());
        let groups = ("groups".to_owned(), json!(groups));
        Value::Object(colours.into_iter().chain([groups]).collect())
    };
    let phases = PHASES
        .map(|colour| json!({ "colour": colour.to_string(), "ink": colour.ink().to_string() }));
    let palette = json!({ "phases": phases, "dark": theme(&DARK), "light": theme(&LIGHT) });
    format!("const PALETTE = {palette};\n")
}

/// Returns custom properties of the page: `--free`, `--lit`, `--group-0` to `--group-4` and others
/// for each theme, and `--phase-0` to `--phase-7`.
pub(crate) fn style() -> String {
    let properties = |theme: &Theme| -> String {
        let each = named(theme).map(|(name, colour)| format!("--{name}:{colour};"));
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
