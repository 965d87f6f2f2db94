//! Section about the origin of the results, with commands to repeat them and reading instructions.
use stochc_files::shell;
use stochc_ir::scene::describe;
use stochc_results::{ChosenSetting, EnsembleProgram, Manifest};
use stochc_runtime::{Model, Precision, Settings};
use stochc_text::number;

use super::Parts;
use super::common::{lines, link};
use crate::ensemble_report::data;
use crate::ensemble_report::html::{Html, HtmlCell, code, command, name};
use crate::svg::Drawing;

/// Adds the origin section with the commands to repeat the ensemble.
pub(super) fn origin(parts: &Parts, out: &mut Html) {
    out.heading(2, "origin", "Programs and settings");
    for (folder, input) in parts.inputs.iter().enumerate() {
        let manifest = &input.manifest;
        out.raw(&format!("<h3>{}</h3>\n", name(&input.path)));
        let limit = manifest
            .settings
            .max_ticks
            .map_or("none".to_owned(), |n| number(n as f64));
        let settings: Vec<_> = (further(&manifest.settings).into_iter())
            .map(|(option, value)| format!("{option} = {value}"))
            .collect();
        let rows: Vec<Vec<HtmlCell>> = [
            ("version", format!("stochc {}", manifest.stochc)),
            ("model", manifest.settings.model.name().to_owned()),
            ("time step", taken_steps(manifest)),
            ("settings", settings.join(", ")),
            ("seed", manifest.seed.to_string()),
            ("runs of each program", number(manifest.runs as f64)),
            ("limit of ticks", limit),
            ("identity (SHA-256)", manifest.identity()),
        ]
        .into_iter()
        .filter(|(_, value)| !value.is_empty())
        .map(|(what, value)| vec![HtmlCell::Plain(what.into()), HtmlCell::Marked(name(&value))])
        .collect();
        out.table("The ensemble", &["", "value"], &rows);
        let is_measured = manifest.uses(Model::Measured);
        if !is_measured {
            out.paragraph("Repeat the same runs, bit for bit:");
            out.raw(&command(&format!(
                "stochc repeat {} --out AGAIN",
                shell::file(&input.path)
            )));
        }
        if let Some(line) = simulate(manifest).filter(|_| !is_measured) {
            out.paragraph("Repeat them from the source files, if these are unchanged:");
            out.raw(&command(&line));
        }
        let programs = manifest.programs.iter().enumerate();
        // All points of a sweep share one source text. The table lists their values.
        let first = |(number, _): &(usize, &EnsembleProgram)| {
            first_of_text(&manifest.programs, *number) == *number
        };
        for (number, program) in programs.filter(first) {
            let scene = &program.scene;
            let terms: Vec<String> = (describe::terms(scene).iter())
                .map(|term| term.text.clone())
                .collect();
            out.raw(&format!(
                "<details id=\"{}\"><summary>{}, scene {}: source</summary>\n",
                text_id(folder, number),
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

/// Returns the HTML identifier of a program's source text.
pub(super) fn text_id(folder: usize, program: usize) -> String {
    format!("text-{}-{}", folder + 1, program + 1)
}

/// Returns the index of the first program with the same source text.
pub(super) fn first_of_text(programs: &[EnsembleProgram], number: usize) -> usize {
    let program = &programs[number];
    let is_same =
        |it: &EnsembleProgram| it.assembly() == program.assembly() && it.sources == program.sources;
    if !program.is_point() {
        number
    } else {
        programs.iter().position(is_same).unwrap_or(number)
    }
}

/// Returns the number of substeps per tick. Returns `None` if blocks do not move.
fn steps(settings: &Settings) -> Option<String> {
    (settings.model.has_places()).then(|| settings.steps().to_string())
}

/// Returns the substeps that the programs take in their scenes. Empty if blocks do not move.
fn taken_steps(manifest: &Manifest) -> String {
    let mut all: Vec<String> = Vec::new();
    for program in &manifest.programs {
        let settings = manifest.settings_of(program);
        let steps = settings.steps_in(&program.scene).in_words();
        if settings.model.has_places() && !all.contains(&steps) {
            all.push(steps);
        }
    }
    all.join("; ")
}

/// Returns settings as names and values of `simulate` options. Contains the solver iterations, the
/// precision if not the default, and the reduction. Empty if blocks do not move.
fn further(settings: &Settings) -> Vec<(&'static str, String)> {
    if !settings.model.has_places() {
        return Vec::new();
    }
    let mut further = vec![("solver-iterations", settings.iterations().to_string())];
    if settings.precision != Precision::default() {
        further.push(("precision", settings.precision.name().to_owned()));
    }
    if let Some(reduction) = settings.reduction {
        further.push(("without", reduction.name().to_owned()));
    }
    further
}

/// Returns the command line that makes an ensemble. Returns `None` if the sweep lacks a combination
/// of settings: no command line makes such a sweep.
pub(super) fn simulate(manifest: &Manifest) -> Option<String> {
    let axes = manifest.axes();
    let chosen = setting_axes(manifest)?;
    let is_sweep = !(axes.is_empty() && chosen.is_empty());
    let command = if is_sweep { "sweep" } else { "simulate" };
    let mut words = vec![format!("stochc {command}")];
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
        words.push(format!("--{name} {}", shell::visible(value)));
    };
    let settings = &manifest.settings;
    let mut given = vec![("model", settings.model.name().to_owned())];
    given.extend(steps(settings).map(|steps| ("substeps", steps)));
    given.extend(further(settings));
    for (name, value) in given {
        if !chosen.iter().any(|(varied, _)| *varied == name) {
            option(name, &value);
        }
    }
    option("runs", &manifest.runs.to_string());
    option("seed", &manifest.seed.to_string());
    if let Some(limit) = settings.max_ticks {
        option("max-ticks", &limit.to_string());
    }
    for (number, axis) in axes.iter().enumerate() {
        let mut values: Vec<String> = Vec::new();
        for varied in manifest
            .programs
            .iter()
            .filter_map(|it| it.varied.get(number))
        {
            let value = varied.given.to_string();
            if !values.contains(&value) {
                values.push(value);
            }
        }
        let text = format!("{}={} {}", axis.name, values.join(","), axis.unit);
        words.push(format!("--vary {}", shell::visible(text.trim_end())));
    }
    let vary = |(of, values): (&str, Vec<&str>)| format!("--vary {of}={}", values.join(","));
    words.extend(chosen.into_iter().map(vary));
    words.push("--out AGAIN".into());
    Some(words.join(" "))
}

/// Returns the settings that a sweep varies, each with its values. Returns `None` if the sweep
/// lacks a combination of these values.
fn setting_axes(manifest: &stochc_results::Manifest) -> Option<Vec<(&str, Vec<&str>)>> {
    let mut points: Vec<&[ChosenSetting]> = Vec::new();
    for program in &manifest.programs {
        if !points.contains(&&program.chosen[..]) {
            points.push(&program.chosen);
        }
    }
    let mut axes: Vec<(&str, Vec<&str>)> = Vec::new();
    for chosen in points.iter().copied().flatten() {
        match axes.iter_mut().find(|(of, _)| *of == chosen.name()) {
            None => axes.push((chosen.name(), vec![chosen.value()])),
            Some((_, values)) if values.contains(&chosen.value()) => {}
            Some((_, values)) => values.push(chosen.value()),
        }
    }
    let count: usize = axes.iter().map(|(_, values)| values.len()).product();
    let is_whole = points.len() == count && points.iter().all(|it| it.len() == axes.len());
    is_whole.then_some(axes)
}

pub(super) fn methods(parts: &Parts, out: &mut Html, drawings: &[Drawing]) {
    out.heading(2, "methods", "Definitions and data");
    out.list(
        "ul",
        &[
            "<strong>Times</strong> are scene times, in ticks or seconds, not CPU times. A capture has \
             a <em>waiting time</em>: from the tick at which its face is switched on to the docking. \
             Blocks enter the reach of the face (<em>entries</em>) and may leave again. The \
             <em>docking</em> time starts at the last entry."
                .to_owned(),
            "<strong>Censored</strong> runs were stopped at <code>--max-ticks</code>, or they were measured and are in \
             progress or stopped. Their completion times are longer, but unknown. Runs that <strong>timed out</strong> never complete. The curves account for both \
             (Kaplan-Meier estimate; intervals by Greenwood's formula for log(−log S)). In both cases, means are \
             lower bounds: areas under the curves up to the last observed time."
                .to_owned(),
            "The <strong>critical path</strong> of a run is found backwards from its last event: each event \
             leads to the event that it waited for last. <em>Share of time</em> is the time that a capture spent on \
             the critical paths of all runs, divided by the time of all runs."
                .to_owned(),
            "<strong>Tests</strong>: a paired t-test compares programs with the same seed, and Welch's t-test all others. \
             Longer times count as the last tick that both programs reached. p (Holm) is corrected for \
             all pairs."
                .to_owned(),
            "Formulas with their sources, and the columns of the data files: \
             <code>docs/guides/report.md</code> of stochc."
                .to_owned(),
        ],
    );
    let folder = &parts.surroundings.folder;
    let mut names: Vec<String> = drawings
        .iter()
        .flat_map(|it| parts.surroundings.figures.names(it))
        .collect();
    let tables = data::tables(
        parts.subjects,
        !parts.pairwise_tests.is_empty(),
        !parts.sweeps.is_empty(),
        parts.maps,
    );
    names.extend(tables.into_iter().map(|table| table.name().to_owned()));
    let links: Vec<String> = names.iter().map(|file| link(folder, file)).collect();
    out.paragraph(&format!(
        "The folder {} contains the figures and their data: {}.",
        code(folder),
        links.join(", ")
    ));
}
