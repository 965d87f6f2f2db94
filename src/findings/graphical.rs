//! Findings drawn over the text.
use stochc_compiler::Checked;
use stochc_compiler::finding::Renderer;

/// Findings that are drawn at most; the rest are counted.
const MOST_DRAWN: usize = 50;

pub fn show(checked: &Checked, colour: bool, width: usize) -> String {
    let renderer = Renderer::new(colour, width);
    let mut out = String::new();
    for finding in checked.findings.iter().take(MOST_DRAWN) {
        out.push_str(&renderer.render(finding, &checked.sources));
        out.push('\n');
    }
    let rest = checked.findings.len().saturating_sub(MOST_DRAWN);
    if rest > 0 {
        out.push_str(&format!(
            "{rest} more findings; `--format short` shows all of them\n\n"
        ));
    }
    out
}
