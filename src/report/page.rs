//! The page: sections in the order in which somebody asks.
use stochc_compiler::scene::describe;
use stochc_runtime::Model;
use stochc_runtime::record::Outcome;

use super::contrast::{Clock, Contrast, Method, Verdict};
use super::html::{Cell, Html, code, command, name};
use super::picture::{self, Curve};
use super::shell;
use super::story::{heading, lead, story};
use super::subject::{Input, Subject};
use super::sweep::Sweep;
use super::waits::Wait;
use super::{MARK, Surroundings};
use crate::ensemble::Time;
use crate::figures::{Drawing, STYLE, escaped, number, percent};

/// Below this, a difference is called one.
const SIGNIFICANT: f64 = 0.05;

/// Rows of a table on the page; the data files have all of them.
const ROWS: usize = 60;

/// All that a page is made of.
pub(super) struct Parts<'a> {
    pub inputs: &'a [Input],
    pub subjects: &'a [Subject<'a>],
    pub clock: Clock,
    pub waits: &'a [Vec<Wait>],
    pub contrasts: &'a [Contrast],
    pub sweeps: &'a [Sweep],
    pub surroundings: &'a Surroundings<'a>,
}

/// Writes the page, and leaves its figures in `drawings`.
pub(super) fn page(parts: &Parts, drawings: &mut Vec<Drawing>) -> String {
    let mut out = Html::default();
    head(parts, &mut out);
    in_short(parts, &mut out);
    completion(parts, &mut out, drawings);
    differences(parts, &mut out);
    sweeps(parts, &mut out, drawings);
    for number in 0..parts.subjects.len() {
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
    // Nothing is loaded from anywhere, and nothing in a name could run if it came through.
    out.raw(&format!(
        "{MARK}\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
         style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'\"/>\n\
         <title>Report: {}</title>\n<style>\n{}{STYLE}\n</style>\n</head>\n<body>\n<main>\n",
        escaped(&title),
        include_str!("style.css"),
    ));
    out.heading(1, "top", &format!("Report: {}", name(&title)));
}

fn in_short(parts: &Parts, out: &mut Html) {
    let unit = parts.clock.unit();
    let mut items = Vec::new();
    for (subject, waits) in parts.subjects.iter().zip(parts.waits) {
        let (completed, stopped, failed) = subject.counts();
        let mut item = format!(
            "<strong>{}</strong>: {completed} of {} runs completed",
            name(&subject.label),
            subject.manifest.runs
        );
        for (n, what) in [(stopped, "stopped before"), (failed, "failed")] {
            if n > 0 {
                item += &format!(", {n} {what}");
            }
        }
        if let Some(time) = Time::of(&parts.clock.times(subject)) {
            item += &format!(", in {} {unit} on average", mean(&time));
        }
        item += ". ";
        let share = |wait: &&Wait| wait.share.unwrap_or(0.0);
        let most = waits.iter().max_by(|a, b| share(a).total_cmp(&share(b)));
        if let Some(wait) = most.filter(|wait| share(wait) > 0.0) {
            item += &format!(
                "The capture that decides most of that is {}, with {:.0} % of all time.",
                code(&wait.text),
                100.0 * share(&wait)
            );
        }
        items.push(item);
    }
    // Of many pairs the table tells.
    for contrast in parts
        .contrasts
        .iter()
        .filter(|_| parts.contrasts.len() <= 3)
    {
        items.push(sentence(parts, contrast));
    }
    out.list("ul", &items);
    for input in parts.inputs {
        for warning in warnings(input) {
            out.raw(&format!("<p class=\"warn\">{warning}</p>\n"));
        }
    }
    let mut sections = vec![("completion", "Time to completion".to_owned())];
    if !parts.contrasts.is_empty() {
        sections.push(("differences", "Differences".into()));
    }
    if !parts.sweeps.is_empty() {
        sections.push(("sweeps", "What was varied".into()));
    }
    let ids: Vec<String> = (1..=parts.subjects.len())
        .map(|n| format!("program-{n}"))
        .collect();
    let programs = ids.iter().zip(parts.subjects);
    sections.extend(programs.map(|(id, subject)| (id.as_str(), subject.label.clone())));
    sections.push(("origin", "What was run".into()));
    sections.push(("methods", "How to read this, and data".into()));
    let links: Vec<String> = (sections.iter())
        .map(|(id, text)| format!("<a href=\"#{id}\">{}</a>", name(text)))
        .collect();
    out.raw("<nav aria-label=\"Sections\">\n");
    out.list("ul", &links);
    out.raw("</nav>\n");
}

/// What a reader has to know before believing anything, in HTML.
fn warnings(input: &Input) -> Vec<String> {
    let mut found = Vec::new();
    let manifest = &input.manifest;
    let done = input.finished.len() as u64;
    let path = name(&input.path);
    if done < manifest.total() {
        found.push(format!(
            "{path} is <strong>not finished</strong>: {done} of {} runs are there. Those under way \
             longest are missing, so that times are too short. To go on: {}",
            manifest.total(),
            code(&format!(
                "stochc simulate --manifest {} --out {} --resume",
                shell::file(&inside(&input.path, "manifest.json")),
                shell::file(&input.path)
            ))
        ));
    }
    if manifest.model == Model::Shuffle.name() {
        found.push(format!(
            "{path} was made with the model <code>shuffle</code>, which has no physics: its times \
             mean nothing."
        ));
    }
    if let Some(reduction) = manifest.settings.get("reduction") {
        found.push(format!(
            "{path} was made with the reduced model {}: it leaves out something that the scene has.",
            code(reduction)
        ));
    }
    let version = env!("CARGO_PKG_VERSION");
    if manifest.stochc != version {
        found.push(format!(
            "The runs of {path} were made by stochc {}, and this report by {version}: to make them \
             again exactly takes that version.",
            name(&manifest.stochc)
        ));
    }
    found
}

fn completion(parts: &Parts, out: &mut Html, drawings: &mut Vec<Drawing>) {
    out.heading(2, "completion", "Time to completion");
    let unit = parts.clock.unit();
    let curves: Vec<Curve> = (parts.subjects.iter())
        .map(|subject| Curve {
            name: subject.label.clone(),
            times: parts.clock.times(subject),
        })
        .collect();
    let axis = format!("time [{unit}]");
    let title = "Runs that are not complete yet, over time";
    let figure = picture::survival("survival", title, &curves, &axis);
    let caption = "The estimate of Kaplan and Meier; bands are pointwise 95 % intervals (up to four \
                   curves), <code>|</code> a run that was stopped before it completed.";
    show(parts, out, drawings, figure, caption, &["survival.csv"]);
    let times: Vec<(&str, Time)> = (parts.subjects.iter())
        .filter_map(|subject| {
            let time = Time::of(&parts.clock.times(subject))?;
            Some((subject.label.as_str(), time))
        })
        .collect();
    if times.len() > 1 {
        let caption = "Dots are means, lines their 95 % intervals; ≥ a lower bound, because runs \
                       were stopped before they completed.";
        let figure = picture::means(&times, unit);
        show(parts, out, drawings, figure, caption, &["means.csv"]);
    }
    let rows: Vec<Vec<Cell>> = (parts.subjects.iter())
        .map(|subject| {
            let (completed, stopped, failed) = subject.counts();
            let time = Time::of(&parts.clock.times(subject));
            let mut row = vec![Cell::Marked(name(&subject.label))];
            row.extend([completed, stopped, failed].map(|n| Cell::Number(n.to_string())));
            row.extend(figures(time.as_ref()));
            row
        })
        .collect();
    let header = [
        "program",
        "completed",
        "stopped",
        "failed",
        "mean",
        "median",
        "SD",
        "CV",
        "min",
        "max",
    ];
    let caption = format!("Times to completion in {unit}; ± is half of a 95 % interval");
    out.table(&caption, &header, &rows);
    for subject in parts.subjects {
        failures(subject, out);
    }
}

/// Runs whose physics broke down.
fn failures(subject: &Subject, out: &mut Html) {
    /// Failures that are told.
    const TOLD: usize = 5;
    let failed: Vec<String> = (subject.runs.iter())
        .filter_map(|run| match &run.record.outcome {
            Outcome::Failed { phase, reason } => Some(format!(
                "run {} in phase {}: {}",
                run.record.run,
                code(subject.program.phase(*phase)),
                name(reason)
            )),
            _ => None,
        })
        .collect();
    if failed.is_empty() {
        return;
    }
    let label = name(&subject.label);
    let n = failed.len();
    out.paragraph(&format!(
        "{n} runs of {label} failed, and no figure counts them:"
    ));
    let mut items = failed;
    if items.len() > TOLD {
        let more = format!("{} more", items.len() - TOLD);
        items.truncate(TOLD);
        items.push(more);
    }
    out.list("ul", &items);
}

fn differences(parts: &Parts, out: &mut Html) {
    if parts.contrasts.is_empty() {
        return;
    }
    out.heading(2, "differences", "Differences");
    let mut rows: Vec<&Contrast> = parts.contrasts.iter().collect();
    let p = |contrast: &Contrast| match contrast.verdict {
        Verdict::Known { p, .. } => p,
        _ => 2.0,
    };
    if rows.len() > ROWS {
        rows.sort_by(|a, b| p(a).total_cmp(&p(b)));
        rows.truncate(ROWS);
        out.note(&format!(
            "The {ROWS} of {} pairs with the smallest p.",
            parts.contrasts.len()
        ));
    }
    let row = |contrast: &&Contrast| {
        let label = |i: usize| name(&parts.subjects[i].label);
        let pair = format!("{} − {}", label(contrast.first), label(contrast.second));
        let mut cells = vec![Cell::Marked(pair)];
        let none = || Cell::Number("–".into());
        match &contrast.verdict {
            Verdict::Same => {
                cells.extend([none(), none(), none()]);
                cells.push(Cell::Plain("the same runs".into()));
            }
            Verdict::Unknown => {
                cells.extend([none(), none(), none()]);
                cells.push(Cell::Plain("too few runs, or no spread, to tell".into()));
            }
            Verdict::Known {
                method,
                difference,
                half_width,
                p,
                corrected,
            } => {
                let difference = format!("{} ± {}", number(*difference), number(*half_width));
                cells.push(Cell::Number(difference));
                cells.push(Cell::Number(probability(*p)));
                cells.push(Cell::Number(probability(*corrected)));
                cells.push(Cell::Plain(method_text(*method, parts.clock.unit())));
            }
        }
        cells
    };
    let rows: Vec<_> = rows.iter().map(row).collect();
    let caption = format!(
        "Mean of the first less that of the second, in {}; ± is half of a 95 % interval",
        parts.clock.unit()
    );
    out.table(
        &caption,
        &["pair", "difference", "p", "p (Holm)", "test"],
        &rows,
    );
    out.note(
        "p is the probability of a difference at least this large if there were none; p (Holm) is \
         corrected for the number of pairs in this table. Programs with one seed meet the same \
         kicks in runs of the same number, so that they are compared run by run where all times are \
         known.",
    );
}

fn sweeps(parts: &Parts, out: &mut Html, drawings: &mut Vec<Drawing>) {
    if parts.sweeps.is_empty() {
        return;
    }
    out.heading(2, "sweeps", "What was varied");
    for (i, sweep) in parts.sweeps.iter().enumerate() {
        let figure = picture::sweep(i + 1, sweep, parts.clock.unit());
        let caption = format!(
            "These programs differ in one number of their scenes only, {}. Dots are means, lines \
             their 95 % intervals.",
            code(&sweep.of)
        );
        show(parts, out, drawings, figure, &caption, &["sweeps.csv"]);
        let points = sweep.curves.iter().flat_map(|curve| {
            let points = curve.points.iter();
            points.map(|(value, _, time)| {
                vec![
                    Cell::Marked(name(&curve.name)),
                    Cell::Number(number(*value)),
                    Cell::Number(mean(time)),
                    Cell::Number(format!(
                        "{} of {}",
                        time.completed,
                        time.completed + time.censored
                    )),
                ]
            })
        });
        let rows: Vec<_> = points.collect();
        let caption = format!("Mean time to completion in {}", parts.clock.unit());
        let header = ["program", sweep.of.as_str(), "mean", "completed"];
        out.table(&caption, &header, &rows);
    }
}

fn program(parts: &Parts, index: usize, out: &mut Html, drawings: &mut Vec<Drawing>) {
    let (subject, waits) = (&parts.subjects[index], &parts.waits[index]);
    let n = index + 1;
    out.heading(2, &format!("program-{n}"), &name(&subject.label));
    if subject.runs.is_empty() {
        out.paragraph("No run of it is finished.");
        return;
    }
    if subject.events.tables.is_none() {
        out.raw(
            "<p class=\"warn\">This version of stochc does not compile the program as it was run. \
             What waits for what is therefore unknown, and so is what decided its times.</p>\n",
        );
    }
    phases(parts, n, subject, out, drawings);
    out.heading(
        3,
        &format!("waits-of-{n}"),
        "Which capture is the bottleneck",
    );
    let figure = picture::waits(n, &subject.label, &subject.program.phases, waits);
    let caption = "From the magnetizing of a face to the docking of a block. Dots are means, thick \
                   lines their 95 % intervals, thin lines hold the middle 80 % of the runs; ≥ where \
                   a run was stopped while it waited. Captures stand in the order of the dependency \
                   graph, a hook where one needs the one above. The bars are what counts: a wait \
                   beside a longer one costs nothing.";
    show(
        parts,
        out,
        drawings,
        figure,
        caption,
        &["waits.csv", "chains.csv"],
    );
    captures(subject, waits, out);
    origins(parts, index, out, drawings);
    let figure = picture::entries(n, subject, waits);
    if figure.is_some() {
        out.heading(3, &format!("entries-of-{n}"), "Arriving and docking");
        let caption = "Discs are captures at their means, coloured by phase, and dots single ones; \
                       the six that were waited for longest have names. To the right many blocks \
                       come before one is caught; above, the last one takes long to dock.";
        show(parts, out, drawings, figure, caption, &["waits.csv"]);
    }
    runs(parts, n, subject, out);
}

fn phases(parts: &Parts, n: usize, subject: &Subject, out: &mut Html, drawings: &mut Vec<Drawing>) {
    let phases = &subject.program.phases;
    let times = |phase: usize| subject.phase_times(phase);
    out.heading(3, &format!("phases-of-{n}"), "Phase by phase");
    let curves: Vec<Curve> = (phases.iter().enumerate())
        .map(|(phase, name)| Curve {
            name: name.clone(),
            times: times(phase),
        })
        .collect();
    if phases.len() > 1 {
        let title = format!("{}: phases that are not complete yet", subject.label);
        let axis = "time since the phase began [ticks]";
        let figure = picture::survival(&format!("phases-{n}"), &title, &curves, axis);
        let caption = "Each phase from its own beginning, of the runs that reached it.";
        show(parts, out, drawings, figure, caption, &["survival.csv"]);
    }
    let total: f64 = subject.runs.iter().map(|run| run.record.ticks as f64).sum();
    let rows = phases.iter().enumerate().map(|(phase, phase_name)| {
        let observed = times(phase);
        let spent: f64 = observed.iter().map(|time| time.time).sum();
        let time = Time::of(&observed);
        let mut row = vec![Cell::Marked(code(phase_name))];
        let count = |completed: bool| {
            let count = observed
                .iter()
                .filter(|time| time.completed == completed)
                .count();
            Cell::Number(count.to_string())
        };
        row.extend([count(true), count(false)]);
        row.extend(figures(time.as_ref()));
        row.push(Cell::Number(percent(spent / total.max(1.0))));
        row
    });
    let rows: Vec<_> = rows.take(ROWS).collect();
    let header = [
        "phase",
        "completed",
        "stopped",
        "mean",
        "median",
        "SD",
        "CV",
        "min",
        "max",
        "of all time",
    ];
    out.table("Times of the phases, in ticks", &header, &rows);
}

fn captures(subject: &Subject, waits: &[Wait], out: &mut Html) {
    let mut shown: Vec<&Wait> = waits.iter().collect();
    if shown.len() > ROWS {
        let share = |wait: &Wait| wait.share.unwrap_or(0.0);
        shown.sort_by(|a, b| share(b).total_cmp(&share(a)));
        shown.truncate(ROWS);
        out.note(&format!(
            "The {ROWS} of {} captures that decided most.",
            waits.len()
        ));
    }
    let runs = subject.runs.len();
    let row = |wait: &&Wait| {
        let summary = |value: Option<f64>| Cell::Number(value.map_or("–".into(), number));
        vec![
            Cell::Marked(code(&wait.text)),
            Cell::Marked(code(subject.program.phase(wait.phase))),
            Cell::Number(wait.time.as_ref().map_or("–".into(), mean)),
            Cell::Number(coefficient(wait.time.as_ref())),
            summary(wait.entries.as_ref().map(|entries| entries.mean)),
            summary(wait.docking.as_ref().map(|docking| docking.mean)),
            Cell::Number(match wait.share {
                Some(_) => format!("{} of {runs}", wait.decided),
                None => "–".into(),
            }),
            Cell::Number(wait.share.map_or("–".into(), percent)),
        ]
    };
    let rows: Vec<_> = shown.iter().map(row).collect();
    let header = [
        "capture",
        "phase",
        "wait",
        "CV",
        "entries",
        "docking",
        "runs it decided",
        "of all time",
    ];
    out.table(
        "The captures; waits and docking in ticks, means with half of their 95 % intervals",
        &header,
        &rows,
    );
}

fn origins(parts: &Parts, index: usize, out: &mut Html, drawings: &mut Vec<Drawing>) {
    let (subject, waits) = (&parts.subjects[index], &parts.waits[index]);
    let free: usize = waits.iter().map(|wait| wait.free).sum();
    let each = waits.iter().flat_map(|wait| &wait.released);
    let released: usize = each.map(|(_, n)| n).sum();
    out.heading(
        3,
        &format!("origins-of-{}", index + 1),
        "Where captured blocks came from",
    );
    if released == 0 {
        out.paragraph(&format!(
            "All {} captures took a block that had never been captured.",
            number(free as f64)
        ));
        return;
    }
    let total = free + released;
    out.paragraph(&format!(
        "{} of {} captures ({}) took a block that had been part of the structure before.",
        number(released as f64),
        number(total as f64),
        percent(released as f64 / total as f64)
    ));
    let label = &subject.label;
    let figure = picture::origins(index + 1, label, subject.program, waits);
    let caption = "Captures that ever took a released block, and the role that it had held last.";
    show(parts, out, drawings, figure, caption, &["origins.csv"]);
}

fn runs(parts: &Parts, n: usize, subject: &Subject, out: &mut Html) {
    out.heading(3, &format!("runs-of-{n}"), "What decided single runs");
    out.note(
        "Told from the chain of waits that met end to end: every other wait of the run was over \
         before it mattered. Shares are of the whole run; a captured block had never been captured \
         before unless it is said.",
    );
    let path = &parts.inputs[subject.folder].path;
    for (what, run) in subject.told() {
        let number = run.record.run;
        out.raw(&format!("<h4>{}</h4>\n", heading(subject, what, run)));
        if let Some(lead) = lead(subject, run) {
            out.paragraph(&lead);
        }
        out.list("ol", &story(subject, run));
        let replay = parts.surroundings.replay;
        match replay(subject.folder, subject.number, number) {
            Some(address) => out.paragraph(&format!(
                "<a href=\"{}\">Watch run {number}</a>",
                escaped(&address)
            )),
            None => {
                out.note("To watch it:");
                let mut line = format!("stochc replay {} --run {number}", shell::file(path));
                if subject.manifest.programs.len() > 1 {
                    line += &format!(" --program {}", shell::quoted(&subject.program.name));
                }
                out.raw(&command(&line));
            }
        }
    }
}

/// What was run, and how to run it again.
fn origin(parts: &Parts, out: &mut Html) {
    out.heading(2, "origin", "What was run");
    for input in parts.inputs {
        let manifest = &input.manifest;
        out.raw(&format!("<h3>{}</h3>\n", name(&input.path)));
        let limit = manifest
            .max_ticks
            .map_or("none".to_owned(), |n| number(n as f64));
        let settings = manifest.settings.iter();
        let settings: Vec<_> = settings
            .map(|(key, value)| format!("{key} = {value}"))
            .collect();
        let rows: Vec<Vec<Cell>> = [
            ("made by", format!("stochc {}", manifest.stochc)),
            ("model", manifest.model.clone()),
            ("substeps", manifest.substeps.to_string()),
            ("settings", settings.join(", ")),
            ("seed", manifest.seed.to_string()),
            ("runs of each program", number(manifest.runs as f64)),
            ("limit of ticks", limit),
            ("identity (SHA-256)", manifest.identity()),
        ]
        .into_iter()
        .filter(|(_, value)| !value.is_empty())
        .map(|(what, value)| vec![Cell::Plain(what.into()), Cell::Marked(name(&value))])
        .collect();
        out.table("The ensemble", &["", "value"], &rows);
        out.paragraph("The same runs again, bit for bit:");
        out.raw(&command(&format!(
            "stochc simulate --manifest {} --out AGAIN",
            shell::file(&inside(&input.path, "manifest.json"))
        )));
        out.paragraph("From its files, as they were then:");
        out.raw(&command(&simulate(manifest)));
        for program in &manifest.programs {
            let scene = &program.scene;
            let terms: Vec<String> = (describe::terms(scene).iter())
                .map(|term| term.text.clone())
                .collect();
            out.raw(&format!(
                "<details><summary>{}, in the scene {}: the text</summary>\n",
                name(&program.name),
                name(&scene.name)
            ));
            let scene = format!("scene {} {{\n    {}\n}}", scene.name, terms.join("\n    "));
            out.raw(&format!("<pre><code>{}</code></pre>\n", lines(&scene)));
            for source in &program.sources {
                out.paragraph(&code(&source.path));
                out.raw(&format!(
                    "<pre><code>{}</code></pre>\n",
                    lines(&source.text)
                ));
            }
            out.raw("</details>\n");
        }
    }
}

/// The command line that made an ensemble, as far as its manifest knows it.
fn simulate(manifest: &crate::ensemble::Manifest) -> String {
    let mut words = vec!["stochc simulate".to_owned()];
    let mut files: Vec<&str> = Vec::new();
    for program in &manifest.programs {
        let path = program
            .sources
            .first()
            .map_or("?", |source| source.path.as_str());
        if files.last() != Some(&path) {
            files.push(path);
        }
    }
    words.extend(files.into_iter().map(shell::file));
    let mut option = |name: &str, value: &str| {
        words.push(format!("--{name} {}", shell::quoted(value)));
    };
    option("model", &manifest.model);
    option("substeps", &manifest.substeps.to_string());
    for (name, value) in &manifest.settings {
        // What a manifest calls by another name than the command line.
        let name = match name.as_str() {
            "reduction" => "reduce".to_owned(),
            name => name.replace('_', "-"),
        };
        option(&name, value);
    }
    option("runs", &manifest.runs.to_string());
    option("seed", &manifest.seed.to_string());
    if let Some(limit) = manifest.max_ticks {
        option("max-ticks", &limit.to_string());
    }
    words.push("--out AGAIN".into());
    words.join(" ")
}

fn methods(parts: &Parts, out: &mut Html, drawings: &[Drawing]) {
    out.heading(2, "methods", "How to read this, and data");
    out.list(
        "ul",
        &[
            "<strong>Ticks</strong> are the scene's clock. A face is magnetized, blocks come into \
             the reach of its pull (<em>entries</em>), and one docks; its <em>docking</em> time \
             counts from its last entry."
                .to_owned(),
            "<strong>Stopped</strong> runs are censored: their times are longer than the tick at \
             which they were stopped, and nobody knows by how much. The curves take them into \
             account (Kaplan and Meier; intervals by Greenwood's formula for log(−log S)); means \
             are then those of min(time, horizon), lower bounds."
                .to_owned(),
            "<strong>What decided</strong> a run is found by walking back from its last event to \
             the one that it waited for last, and so on to the beginning. These waits fill the run \
             from end to end; <em>of all time</em> is their part of the time of all runs together."
                .to_owned(),
            "<strong>Tests</strong>: paired t run by run for programs with one seed, Welch's t for \
             others, the log-rank test where times are censored; p (Holm) for all pairs together."
                .to_owned(),
            "Formulas with their sources, and the columns of the data files: \
             <code>docs/report.md</code> of stochc."
                .to_owned(),
        ],
    );
    let folder = &parts.surroundings.folder;
    let mut names: Vec<String> = drawings
        .iter()
        .map(|it| format!("{}.svg", it.name))
        .collect();
    let tables = super::data::names(!parts.contrasts.is_empty(), !parts.sweeps.is_empty());
    names.extend(tables.into_iter().map(str::to_owned));
    let links: Vec<String> = names.iter().map(|file| link(folder, file)).collect();
    out.paragraph(&format!(
        "The figures and their data, in {}: {}.",
        code(folder),
        links.join(", ")
    ));
}

fn link(folder: &str, file: &str) -> String {
    format!(
        "<a href=\"{}/{file}\">{file}</a>",
        escaped(&super::address(folder))
    )
}

/// Puts a figure on the page, with links to its data.
fn show(
    parts: &Parts,
    out: &mut Html,
    drawings: &mut Vec<Drawing>,
    figure: Option<Drawing>,
    caption: &str,
    data: &[&str],
) {
    let Some(figure) = figure else {
        return;
    };
    let folder = parts.surroundings.folder;
    let svg = format!("{}.svg", figure.name);
    let links: Vec<String> = std::iter::once(svg.as_str())
        .chain(data.iter().copied())
        .map(|file| link(folder, file))
        .collect();
    out.raw(&format!(
        "<figure>\n<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"{}\">\n{}</div>\n\
         <figcaption><strong>{}.</strong> {caption} Files: {}.</figcaption>\n</figure>\n",
        escaped(&figure.title),
        figure.inline("figure-"),
        name(&figure.title),
        links.join(", ")
    ));
    drawings.push(figure);
}

fn sentence(parts: &Parts, contrast: &Contrast) -> String {
    let label = |i: usize| name(&parts.subjects[i].label);
    let (first, second) = (label(contrast.first), label(contrast.second));
    match &contrast.verdict {
        Verdict::Same => format!("{first} and {second} are the same runs."),
        Verdict::Unknown => {
            format!("{first} and {second}: too few runs, or no spread, to tell them apart.")
        }
        Verdict::Known {
            difference,
            half_width,
            corrected,
            ..
        } => {
            let p = match probability(*corrected) {
                p if p.starts_with('<') => format!("p {p}"),
                p => format!("p = {p}"),
            };
            let figures = format!(
                "{} ± {} {} ({p})",
                number(difference.abs()),
                number(*half_width),
                parts.clock.unit()
            );
            match (*corrected < SIGNIFICANT, *difference > 0.0) {
                (false, _) => format!(
                    "These runs show no difference between {first} and {second}: {figures}."
                ),
                (true, true) => format!("{first} takes longer than {second} by {figures}."),
                (true, false) => format!("{second} takes longer than {first} by {figures}."),
            }
        }
    }
}

/// Mean, median, SD, CV, and the ends.
fn figures(time: Option<&Time>) -> Vec<Cell> {
    let figure = |of: fn(&Time) -> Option<f64>| {
        let value = time.and_then(of);
        Cell::Number(value.map_or("–".into(), number))
    };
    vec![
        Cell::Number(time.map_or("–".into(), mean)),
        figure(|time| time.median),
        figure(|time| time.sd),
        Cell::Number(coefficient(time)),
        figure(|time| time.min),
        figure(|time| time.max),
    ]
}

fn coefficient(time: Option<&Time>) -> String {
    let cv = time.and_then(|time| time.cv);
    cv.map_or("–".into(), |cv| format!("{cv:.2}"))
}

fn mean(time: &Time) -> String {
    let half = match time.half_width {
        Some(half) => format!(" ± {}", number(half)),
        None => String::new(),
    };
    match time.censored {
        0 => format!("{}{half}", number(time.mean)),
        _ => format!("≥ {}{half}", number(time.mean)),
    }
}

fn probability(p: f64) -> String {
    match p {
        p if p < 1e-4 => "< 0.0001".to_owned(),
        p if p < 0.01 => format!("{p:.4}"),
        p if p < 0.1 => format!("{p:.3}"),
        p => format!("{p:.2}"),
    }
}

fn method_text(method: Method, unit: &str) -> String {
    match method {
        Method::Paired { n } => format!("paired t, {n} pairs"),
        Method::Welch => "Welch's t".to_owned(),
        Method::LogRank { horizon } => {
            format!("log-rank; means to {} {unit}", number(horizon))
        }
    }
}

/// A file inside a folder, as a path to type.
fn inside(folder: &str, file: &str) -> String {
    format!("{}/{file}", folder.trim_end_matches('/'))
}

/// Text of several lines, whose breaks and tabs are kept.
fn lines(text: &str) -> String {
    let lines: Vec<String> = text
        .lines()
        .map(|line| escaped(&line.replace('\t', "    ")))
        .collect();
    lines.join("\n")
}
