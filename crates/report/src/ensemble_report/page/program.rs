//! Section about one program: its phases, captures, origins of blocks, and single runs.
use std::fmt::Write as _;

use stochc_experiments::Time;
use stochc_experiments::statistics::Observation;
use stochc_files::shell;
use stochc_runtime::Model;
use stochc_text::{escaped, number, percent};

use super::Parts;
use super::common::{coefficient, figure, figures, mean_cell, show};
use super::maps::maps;
use super::origin::{first_of_text, text_id};
use super::parts::ROWS;
use crate::analysis::reported_program::ReportedProgram;
use crate::analysis::slow_runs::SlowRuns;
use crate::analysis::waits::{ReportedCapture, phase_waits};
use crate::ensemble_report::CRITICAL_PATHS;
use crate::ensemble_report::html::{Html, HtmlCell, code, command, name};
use crate::ensemble_report::narrative::{
    NarrativeContext, heading, lead, narrative, sizes as sizes_of,
};
use crate::figures as picture;
use crate::figures::SurvivalCurve;
use crate::svg::{Colours, Drawing, PlotAxis};

/// Converts times in ticks to the unit of the program's figures.
fn on_axis(subject: &ReportedProgram, mut times: Vec<Observation>) -> Vec<Observation> {
    let placed = times.iter_mut();
    placed.for_each(|it| it.time = subject.on_axis(it.time));
    times
}

pub(super) fn program(parts: &Parts, index: usize, out: &mut Html, drawings: &mut Vec<Drawing>) {
    let (subject, waits) = (&parts.subjects[index], &parts.waits[index]);
    let n = index + 1;
    out.heading(2, &format!("program-{n}"), &name(&subject.label));
    if subject.outcomes.finished() == 0 {
        out.paragraph("No run of this program is finished.");
        return;
    }
    out.paragraph(&text_link(parts, subject));
    if subject.is_aggregate() {
        sizes(parts, n, subject, out, drawings);
        runs(parts, n, subject, out);
        return;
    }
    phases(parts, n, subject, out, drawings);
    out.heading(3, &format!("waits-of-{n}"), "Waiting times of captures");
    let figure = |medium| picture::waits(medium, n, subject, waits);
    let caption = "A waiting time lasts from the tick at which a face is switched on to the docking of a block. Dots \
                   are means. Thick lines are their 95 % confidence intervals, and thin lines contain the middle 80 %. \
                   ≥ marks lower bounds. Captures are in the order of the dependency graph. A hook \
                   marks a capture that needs the one above. Bars show the share of the completion \
                   time in which the run waited only for this capture.";
    show(
        parts,
        out,
        drawings,
        figure,
        caption,
        &["waits.csv", CRITICAL_PATHS],
    );
    captures(subject, waits, out);
    origins(parts, index, out, drawings);
    maps(parts, index, out, drawings);
    runs(parts, n, subject, out);
}

/// Adds the figure of the growth of an aggregate's largest group.
fn sizes(
    parts: &Parts,
    n: usize,
    subject: &ReportedProgram,
    out: &mut Html,
    drawings: &mut Vec<Drawing>,
) {
    out.heading(3, &format!("sizes-of-{n}"), "Growth of the largest group");
    let phases = subject.program.phases();
    let curves: Vec<SurvivalCurve> = (phases.iter().enumerate())
        .map(|(number, phase)| SurvivalCurve {
            name: format!("{} blocks", phase.name),
            times: on_axis(subject, subject.size_times(number)),
        })
        .collect();
    let title = format!("{}: runs without a group of each size", subject.label);
    let axis = subject.time_axis("time");
    let without = PlotAxis::new("runs without a group of this size", "%");
    let file = format!("sizes-{n}");
    let figure = |medium| {
        picture::survival(
            medium,
            &file,
            &title,
            &curves,
            (&axis, &without),
            Colours::Phases,
        )
    };
    let caption = "Time from the start of a run to its first group of each size.";
    show(parts, out, drawings, figure, caption, &["sizes.csv"]);
    let rows = curves.iter().enumerate().map(|(number, curve)| {
        let observed = subject.size_times(number);
        let time = Time::new(&observed);
        let mut row = vec![HtmlCell::Marked(name(&curve.name))];
        let count = |completed: bool| {
            let times = observed.iter();
            let count = times
                .filter(|time| time.is_completed() == completed)
                .count();
            HtmlCell::Number(count.to_string())
        };
        row.extend([count(true), count(false)]);
        row.extend(figures(time.as_ref(), Some(subject.tick())));
        row
    });
    let rows: Vec<_> = rows.take(ROWS).collect();
    let header = [
        "a group of",
        "reached",
        "incomplete",
        "mean",
        "median",
        "SD",
        "CV",
        "min",
        "max",
    ];
    let caption = "Times from the start of a run in ticks, with seconds below";
    out.table(caption, &header, &rows);
}

fn text_link(parts: &Parts, subject: &ReportedProgram) -> String {
    let programs = &parts.inputs[subject.folder].manifest.programs;
    let first = first_of_text(programs, subject.number);
    format!(
        "<a href=\"#{}\">Source and scene</a>",
        text_id(subject.folder, first)
    )
}

pub(super) fn phases(
    parts: &Parts,
    n: usize,
    subject: &ReportedProgram,
    out: &mut Html,
    drawings: &mut Vec<Drawing>,
) {
    let phases = subject.program.phases();
    let times = |phase: usize| subject.phase_times(phase);
    out.heading(3, &format!("phases-of-{n}"), "Phases");
    let curves: Vec<SurvivalCurve> = (phases.iter().enumerate())
        .map(|(number, phase)| SurvivalCurve {
            name: phase.name.clone(),
            times: on_axis(subject, times(number)),
        })
        .collect();
    if phases.len() > 1 {
        let title = format!("{}: share of incomplete phases over time", subject.label);
        let axis = subject.time_axis("time since the phase began");
        let incomplete = picture::incomplete();
        let file = format!("phases-{n}");
        let figure = |medium| {
            picture::survival(
                medium,
                &file,
                &title,
                &curves,
                (&axis, &incomplete),
                Colours::Phases,
            )
        };
        let caption = "Times are counted from the start of each phase. Only runs that reached the phase are included.";
        show(parts, out, drawings, figure, caption, &["survival.csv"]);
    }
    let total = subject.decisive.total;
    let rows = phases.iter().enumerate().map(|(number, phase)| {
        let observed = times(number);
        let spent: f64 = observed.iter().map(|time| time.time).sum();
        let time = Time::new(&observed);
        let mut row = vec![HtmlCell::Marked(code(&phase.name))];
        let count = |completed: bool| {
            let count = observed
                .iter()
                .filter(|time| time.is_completed() == completed)
                .count();
            HtmlCell::Number(count.to_string())
        };
        row.extend([count(true), count(false)]);
        row.extend(figures(time.as_ref(), Some(subject.tick())));
        row.push(HtmlCell::Number(percent(spent / total.max(1.0))));
        row
    });
    let rows: Vec<_> = rows.take(ROWS).collect();
    let header = [
        "phase",
        "completed",
        "incomplete",
        "mean",
        "median",
        "SD",
        "CV",
        "min",
        "max",
        "share of time",
    ];
    out.table(
        "Times of the phases in ticks, with seconds below",
        &header,
        &rows,
    );
}

pub(super) fn captures(subject: &ReportedProgram, waits: &[ReportedCapture], out: &mut Html) {
    let mut shown: Vec<&ReportedCapture> = waits.iter().collect();
    if shown.len() > ROWS {
        let share = |wait: &ReportedCapture| wait.share.unwrap_or(0.0);
        shown.sort_by(|a, b| share(b).total_cmp(&share(a)));
        shown.truncate(ROWS);
        out.note(&format!(
            "The table shows the {ROWS} of {} captures with the largest shares.",
            waits.len()
        ));
    }
    let runs = subject.times.len();
    let row = |wait: &&ReportedCapture| {
        let tick = Some(subject.tick());
        vec![
            HtmlCell::Marked(code(&wait.text)),
            HtmlCell::Marked(code(subject.program.phase(wait.phase))),
            mean_cell(wait.time(), tick),
            HtmlCell::Number(coefficient(wait.time())),
            figure(wait.entries(), None),
            figure(wait.docking(), tick),
            HtmlCell::Number(match wait.share {
                Some(_) => format!("{} of {runs}", wait.decided),
                None => "–".into(),
            }),
            HtmlCell::Number(wait.share.map_or("–".into(), percent)),
        ]
    };
    let mut rows: Vec<_> = shown.iter().map(row).collect();
    let mut header = vec![
        "capture",
        "phase",
        "waiting time",
        "CV",
        "entries",
        "docking",
        "on the critical path",
        "share of time",
    ];
    let unknown = || HtmlCell::Number("–".into());
    let waits = phase_waits(subject);
    rows.extend(waits.iter().map(|wait| {
        let phase = subject.program.phase(wait.phase);
        let mut row = vec![
            HtmlCell::Marked(code("wait")),
            HtmlCell::Marked(code(phase)),
        ];
        row.extend(std::iter::repeat_with(unknown).take(4));
        row.push(HtmlCell::Number(format!("{} of {runs}", wait.decided)));
        row.push(HtmlCell::Number(percent(wait.share)));
        row
    }));
    if let Some(slow_runs) = &subject.slow_runs {
        header.extend(["slow runs", "of it docking", "run to watch"]);
        let (of_captures, of_waits) = rows.split_at_mut(shown.len());
        for (row, wait) in of_waits.iter_mut().zip(&waits) {
            row.push(figure(wait.slower, Some(subject.tick())));
            row.extend([unknown(), unknown()]);
        }
        for (row, wait) in of_captures.iter_mut().zip(&shown) {
            row.push(figure(wait.slower, Some(subject.tick())));
            row.push(figure(wait.slower_docking, Some(subject.tick())));
            let run = wait.run_to_watch.map(|run| run.to_string());
            row.push(HtmlCell::Number(run.unwrap_or("–".into())));
        }
        out.note(&slow_runs_note(slow_runs));
    }
    out.table(
        "Mean waiting and docking times of the captures in ticks, with seconds below (± is the 95 % confidence interval)",
        &header,
        &rows,
    );
}

/// Explains the columns about slow runs.
fn slow_runs_note(slow_runs: &SlowRuns) -> String {
    let mut note = format!(
        "<em>Slow runs</em> compares the slowest with the fastest tenth of the runs, {} runs each. It is \
         the difference of the mean times that a run waited only for this capture. <em>Of it docking</em> \
         is the part after the last entry of the captured block. It is large if blocks jam at the face. \
         In the run to watch, the waiting time is longest.",
        slow_runs.runs
    );
    if slow_runs.unplanned != [0; 2] {
        let [slow, fast] =
            (slow_runs.unplanned).map(|it| number(it as f64 / slow_runs.runs as f64));
        let _ = write!(
            note,
            " Slow runs rejected {slow} blocks on average, and fast runs {fast}."
        );
    }
    note
}

pub(super) fn origins(parts: &Parts, index: usize, out: &mut Html, drawings: &mut Vec<Drawing>) {
    let (subject, waits) = (&parts.subjects[index], &parts.waits[index]);
    let free: usize = waits.iter().map(|wait| wait.free()).sum();
    let each = waits.iter().flat_map(|wait| wait.released());
    let released: usize = each.map(|(_, n)| n).sum();
    out.heading(
        3,
        &format!("origins-of-{}", index + 1),
        "Origin of captured blocks",
    );
    if free + released == 0 {
        out.paragraph("There are no captures yet.");
        return;
    }
    if released == 0 {
        out.paragraph(&format!(
            "All {} captures bonded a block that had never been captured.",
            number(free as f64)
        ));
        return;
    }
    let total = free + released;
    out.paragraph(&format!(
        "{} of {} captures ({}) bonded a released block.",
        number(released as f64),
        number(total as f64),
        percent(released as f64 / total as f64)
    ));
    let label = &subject.label;
    let figure = |medium| picture::origins(medium, index + 1, label, subject.program, waits);
    let caption = "Each bar counts captures of released blocks, grouped by the last role of the block in the structure.";
    show(parts, out, drawings, figure, caption, &["origins.csv"]);
}

pub(super) fn runs(parts: &Parts, n: usize, subject: &ReportedProgram, out: &mut Html) {
    let is_aggregate = subject.is_aggregate();
    let title = if is_aggregate {
        "Single runs"
    } else {
        "Critical paths of single runs"
    };
    out.heading(3, &format!("runs-of-{n}"), title);
    let note = "The critical path is the chain of waiting times that decided the completion time. Percentages are \
                shares of the whole run. If a captured block had been released before, the text mentions it.";
    if !is_aggregate {
        out.note(note);
    }
    let path = &parts.inputs[subject.folder].path;
    let is_measured = subject.manifest.uses(Model::Measured);
    for (what, run) in subject.example_runs() {
        let number = run.record.run;
        let replay = parts.surroundings.replay;
        let context = NarrativeContext {
            program: subject.program,
            events: &subject.events,
            replay: replay(subject.folder, subject.number, number),
            is_measured,
        };
        out.raw(&format!("<h4>{}</h4>\n", heading(&context, what, run)));
        if let Some(lead) = lead(&context, run) {
            out.paragraph(&lead);
        }
        let narrative = if is_aggregate {
            sizes_of(&context, run)
        } else {
            narrative(&context, run)
        };
        if !narrative.is_empty() {
            out.list("ol", &narrative);
        }
        match context.replay {
            Some(address) => out.paragraph(&format!(
                "<a href=\"{}\">Watch run {number}</a>",
                escaped(&address)
            )),
            // `stochc replay` needs a simulation.
            None if is_measured => {}
            None => {
                out.note("To watch it:");
                let mut line = format!("stochc replay {} --run {number}", shell::file(path));
                if subject.manifest.programs.len() > 1 {
                    line += &format!(" --program {}", shell::visible(&subject.program.name));
                }
                out.raw(&command(&line));
            }
        }
    }
}
