//! Page as an HTML document.
use stochc_text::escaped;

use super::completion::{completion, differences};
use super::origin::{methods, origin};
use super::parts::Parts;
use super::program::program;
use super::summary::in_short;
use super::sweeps::sweeps;
use super::trades::trades;
use crate::ensemble_report::MARK;
use crate::ensemble_report::html::{Html, name};
use crate::svg::{Drawing, STYLE};

/// Returns the HTML page, and adds its figures to `drawings`.
pub(crate) fn page(parts: &Parts, drawings: &mut Vec<Drawing>) -> String {
    let mut out = Html::default();
    head(parts, &mut out);
    in_short(parts, &mut out);
    completion(parts, &mut out, drawings);
    differences(parts, &mut out);
    sweeps(parts, &mut out, drawings);
    trades(parts, &mut out, drawings);
    for (number, _) in parts.detailed() {
        program(parts, number, &mut out, drawings);
    }
    origin(parts, &mut out);
    methods(parts, &mut out, drawings);
    out.raw("</main>\n</body>\n</html>\n");
    out.finish()
}

fn head(parts: &Parts, out: &mut Html) {
    let names: Vec<&str> = (parts.subjects.iter())
        .map(|subject| subject.label.as_str())
        .collect();
    let title = match names.len() {
        0 => "no programs".to_owned(),
        1..=3 => names.join(", "),
        n => format!("{n} programs"),
    };
    let reload = parts.surroundings.reload.map_or(String::new(), |time| {
        let seconds = time.as_secs_f64().ceil();
        format!("<meta http-equiv=\"refresh\" content=\"{seconds}\"/>\n")
    });
    // The policy forbids scripts and external resources, in case a name is not escaped.
    out.raw(&format!(
        "{MARK}\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n{reload}\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
         style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'\"/>\n\
         <title>Report: {}</title>\n<style>\n{}{}\n</style>\n</head>\n<body>\n<main>\n",
        escaped(&title),
        include_str!("style.css"),
        *STYLE
    ));
    out.heading(1, "top", &format!("Report: {}", name(&title)));
}
