//! Section about completion: curves, means and differences.
use stochc_experiments::{PairwiseResult, PairwiseTest, Time};
use stochc_text::number;

use super::Parts;
use super::common::{figures, show, tick};
use super::parts::ROWS;
use crate::analysis::reported_program::{FailedRun, ReportedProgram};
use crate::ensemble_report::html::{Html, HtmlCell, code, name};
use crate::ensemble_report::narrative::tick_of;
use crate::figures as picture;
use crate::figures::SurvivalCurve;
use crate::svg::{Colours, Drawing, PlotAxis};
use crate::text::{method, probability};

pub(super) fn completion(parts: &Parts, out: &mut Html, drawings: &mut Vec<Drawing>) {
    out.heading(2, "completion", "Completion time");
    let unit = parts.clock.unit();
    let curves: Vec<SurvivalCurve> = (parts.detailed())
        .map(|(_, subject)| SurvivalCurve {
            name: subject.label.clone(),
            times: subject.times_by(parts.clock),
        })
        .collect();
    let axis = match tick(parts) {
        Some(tick) => PlotAxis::new("time", &tick.unit()),
        None => PlotAxis::new("time", unit),
    };
    let incomplete = picture::incomplete();
    let title = "Share of incomplete runs over time";
    let figure = |medium| {
        picture::survival(
            medium,
            "survival",
            title,
            &curves,
            (&axis, &incomplete),
            Colours::Compared,
        )
    };
    let caption = "The curves are Kaplan-Meier estimates. Bands are pointwise 95 % confidence intervals, drawn for up to four \
                   curves. <code>|</code> marks a run that timed out or was censored. <em>At risk</em> is the number of \
                   runs under observation, including runs that timed out.";
    show(parts, out, drawings, figure, caption, &["survival.csv"]);
    let times: Vec<(&str, Time)> = (parts.detailed())
        .filter_map(|(_, subject)| Some((subject.label.as_str(), parts.time(subject)?)))
        .collect();
    if times.len() > 1 {
        let caption = "Dots are means. Lines are their 95 % confidence intervals. ≥ marks lower bounds, because some runs \
                       timed out or were censored.";
        let figure = |medium| picture::means(medium, &times, unit);
        show(parts, out, drawings, figure, caption, &["means.csv"]);
    }
    let rows: Vec<Vec<HtmlCell>> = (parts.subjects.iter())
        .map(|subject| {
            let counts = subject.outcomes;
            let time = parts.time(subject);
            let mut row = vec![HtmlCell::Marked(name(&subject.label))];
            let counts = [
                counts.completed,
                counts.timed_out,
                counts.censored,
                counts.failed(),
            ];
            row.extend(counts.map(|n| HtmlCell::Number(n.to_string())));
            row.extend(figures(time.as_ref(), tick(parts)));
            row
        })
        .collect();
    let header = [
        "program",
        "completed",
        "timed out",
        "censored",
        "failed",
        "mean",
        "median",
        "SD",
        "CV",
        "min",
        "max",
    ];
    let seconds = match tick(parts) {
        Some(_) => ", and below in seconds",
        None => "",
    };
    let caption = format!(
        "Completion times in {unit}{seconds} (± is the 95 % confidence interval of the mean)"
    );
    out.table(&caption, &header, &rows);
    for subject in parts.subjects {
        failures(parts, subject, out);
    }
}

/// Adds a list of the runs whose physics failed.
fn failures(parts: &Parts, subject: &ReportedProgram, out: &mut Html) {
    let n = subject.outcomes.failed();
    if n == 0 {
        return;
    }
    let label = name(&subject.label);
    out.paragraph(&format!(
        "{n} runs of {label} failed. Broken structures never complete. No figure includes the other failed runs:"
    ));
    let item = |failed: &FailedRun| {
        let replay = (parts.surroundings.replay)(subject.folder, subject.number, failed.run);
        format!(
            "run {} in phase {}, at tick {}: {}",
            failed.run,
            code(subject.program.phase(failed.phase)),
            tick_of(replay.as_deref(), failed.tick),
            name(&failed.reason)
        )
    };
    let mut items: Vec<String> = subject.failures.iter().map(item).collect();
    if n > items.len() {
        items.push(format!("{} more", n - items.len()));
    }
    out.list("ul", &items);
}

pub(super) fn differences(parts: &Parts, out: &mut Html) {
    if parts.pairwise_tests.is_empty() {
        return;
    }
    out.heading(2, "differences", "Differences");
    let mut rows: Vec<&PairwiseTest> = parts.pairwise_tests.iter().collect();
    let p = |contrast: &PairwiseTest| match contrast.verdict {
        PairwiseResult::Known(ref found) => found.p,
        _ => 2.0,
    };
    if rows.len() > ROWS {
        rows.sort_by(|a, b| p(a).total_cmp(&p(b)));
        rows.truncate(ROWS);
        out.note(&format!(
            "The table shows the {ROWS} of {} pairs with the smallest p.",
            parts.pairwise_tests.len()
        ));
    }
    let row = |contrast: &&PairwiseTest| {
        let label = |i: usize| name(&parts.subjects[i].label);
        let pair = format!("{} − {}", label(contrast.first), label(contrast.second));
        let mut cells = vec![HtmlCell::Marked(pair)];
        let none = || HtmlCell::Number("–".into());
        match &contrast.verdict {
            PairwiseResult::Same => {
                cells.extend([none(), none(), none()]);
                cells.push(HtmlCell::Plain("the same runs".into()));
            }
            PairwiseResult::Repeated => {
                cells.extend([none(), none(), none()]);
                cells.push(HtmlCell::Plain("the runs of another pair".into()));
            }
            PairwiseResult::Equal => {
                cells.extend([none(), none(), none()]);
                cells.push(HtmlCell::Plain("equal times in every run".into()));
            }
            PairwiseResult::Unknown => {
                cells.extend([none(), none(), none()]);
                cells.push(HtmlCell::Plain("too few runs, or no spread".into()));
            }
            PairwiseResult::Known(found) => {
                let [difference, half] = [found.difference, found.half_width].map(number);
                cells.push(HtmlCell::Number(format!("{difference} ± {half}")));
                cells.push(HtmlCell::Number(probability(found.p)));
                cells.push(HtmlCell::Number(probability(found.p_holm)));
                cells.push(HtmlCell::Plain(method(found, parts.clock.unit())));
            }
        }
        cells
    };
    let rows: Vec<_> = rows.iter().map(row).collect();
    let caption = format!(
        "Mean of the first program minus mean of the second, in {} (± is the 95 % confidence interval)",
        parts.clock.unit()
    );
    out.table(
        &caption,
        &["pair", "difference", "p", "p (Holm)", "test"],
        &rows,
    );
    out.note(
        "p is the probability that chance alone makes a difference of this size or larger. p (Holm) is \
         corrected for the number of tested pairs. Differences with p (Holm) below 0.05 are called \
         significant. If programs have the same seed, runs with the same number have the same random impulses. Such \
         programs are compared run by run.",
    );
}
