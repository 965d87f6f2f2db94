//! Checks arbitrary bytes. The check must end with valid diagnostics. A program without errors must
//! have tables, and its cost estimate must not fail.
use stochc_compiler::diagnostic::Renderer;
use stochc_compiler::{Limits, check};
use stochc_estimate::Rates;

/// Small limits on the size of programs, for short executions.
const LIMITS: Limits = Limits {
    events: 500,
    steps: 5_000,
    search: 2_000,
    further: None,
};

/// Checks an input. Panics if the result is wrong.
pub fn read(bytes: &[u8]) {
    let mut reader = |path: &str| match path {
        "fuzz.sa" => Ok(bytes.to_vec()),
        _ => Err(std::io::Error::other("there is only one file")),
    };
    let checked = check("fuzz.sa", &mut reader, LIMITS);
    let renderer = Renderer::new(false, 100);
    for diagnostic in &checked.diagnostics {
        for label in &diagnostic.labels {
            let text = &checked.sources.file(label.location.file).text;
            let span = label.location.span;
            assert!(text.get(span.start as usize..span.end as usize).is_some());
        }
    }
    for diagnostic in checked.diagnostics.iter().take(5) {
        let shown = renderer.render(diagnostic, &checked.sources);
        assert!(!shown.contains(|c: char| c.is_control() && c != '\n'));
    }
    for program in &checked.programs {
        if program.plan.events.len() <= 40 {
            let rates = program.scene.as_ref().and_then(Rates::built_in);
            let _ = program.estimate(rates);
        }
        if !checked.has_errors() {
            assert!(program.tables.is_some());
        }
    }
}
