//! Section that summarizes the page in a few sentences.
use stochc_experiments::statistics::{Observation, Status};
use stochc_text::whole_percent;

use super::Parts;
use super::common::{bound, mean, sentence, tick};
use super::warnings::warnings;
use crate::analysis::waits::ReportedCapture;
use crate::ensemble_report::html::{Html, code, name};

pub(super) fn in_short(parts: &Parts, out: &mut Html) {
    let unit = parts.clock.unit();
    let mut items = Vec::new();
    for (number, subject) in parts.detailed() {
        let waits = &parts.waits[number];
        let counts = subject.outcomes;
        let mut item = format!(
            "<strong>{}</strong>: {} of {} runs completed",
            name(&subject.label),
            counts.completed,
            subject.manifest.runs
        );
        for (n, what) in [
            (counts.timed_out, "timed out"),
            (counts.censored, "censored"),
            (counts.failed(), "failed"),
        ] {
            if n > 0 {
                item += &format!(", {n} {what}");
            }
        }
        // If all runs timed out, they never complete, and the mean is meaningless.
        let may_complete = |it: &Observation| it.status != Status::Competing;
        let is_any = subject.times().iter().any(may_complete);
        if let Some(time) = parts.time(subject).filter(|_| is_any) {
            let seconds = tick(parts).map(|tick| {
                let seconds = tick.interval(time.mean, time.half_width);
                format!(" ({}{seconds})", bound(&time))
            });
            let seconds = seconds.unwrap_or_default();
            item += &format!(", in {} {unit}{seconds} on average", mean(&time));
        }
        item += ". ";
        let share = |wait: &&ReportedCapture| wait.share.unwrap_or(0.0);
        let most = waits.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
        if let Some(wait) = most.filter(|wait| share(wait) > 0.0) {
            item += &format!(
                "The bottleneck is {}: it takes {} of the time.",
                code(&wait.text),
                whole_percent(share(&wait))
            );
        }
        items.push(item);
    }
    // If there are many pairs, a table replaces the sentences.
    for contrast in parts
        .pairwise_tests
        .iter()
        .filter(|_| parts.pairwise_tests.len() <= 3)
    {
        items.push(sentence(parts, contrast));
    }
    let left_out = parts.subjects.len() - parts.detailed().count();
    if left_out > 0 {
        items.push(format!(
            "{left_out} points of sweeps are summarized in the section <a href=\"#sweeps\">Sweeps</a>."
        ));
    }
    out.list("ul", &items);
    let is_running = parts.surroundings.reload.is_some();
    for input in parts.inputs {
        for warning in warnings(input, is_running) {
            out.raw(&format!("<p class=\"warn\">{warning}</p>\n"));
        }
    }
    let mut sections = vec![("completion", "Completion time".to_owned())];
    if !parts.pairwise_tests.is_empty() {
        sections.push(("differences", "Differences".into()));
    }
    if !parts.sweeps.is_empty() {
        sections.push(("sweeps", "Sweeps".into()));
    }
    let ids: Vec<(String, String)> = (parts.detailed())
        .map(|(number, subject)| (format!("program-{}", number + 1), subject.label.clone()))
        .collect();
    sections.extend(ids.iter().map(|(id, label)| (id.as_str(), label.clone())));
    sections.push(("origin", "Programs and settings".into()));
    sections.push(("methods", "Definitions and data".into()));
    let links: Vec<String> = (sections.iter())
        .map(|(id, text)| format!("<a href=\"#{id}\">{}</a>", name(text)))
        .collect();
    out.raw("<nav aria-label=\"Sections\">\n");
    out.list("ul", &links);
    out.raw("</nav>\n");
}
