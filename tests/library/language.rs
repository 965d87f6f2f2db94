//! Tests the language reference. Its examples must be valid programs, and its tables must agree
//! with the schema of scenes.
use stochc::compiler::scene::BUILT_IN;
use stochc::compiler::{Checked, Limits, check};
use stochc::diagnostics::{Format, show};
use stochc::ir::scene::scalars;
use stochc::ir::scene::schema::CLAUSES;

const REFERENCE: &str = include_str!("../../docs/reference/language.md");
const SCENES: &str = include_str!("../../docs/reference/scene-parameters.md");
const MODEL: &str = include_str!("../../docs/concepts/physical-model.md");
const README: &str = include_str!("../../README.md");

#[test]
fn every_example_of_the_reference_is_valid() {
    let programs = programs(REFERENCE);
    assert!(programs.len() >= 15, "{} examples", programs.len());
    for (line, program) in programs {
        no_diagnostics(&format!("docs/reference/language.md:{line}"), program);
    }
}

#[test]
fn every_example_of_the_readme_is_valid() {
    for (line, program) in programs(README) {
        no_diagnostics(&format!("README.md:{line}"), program);
    }
}

#[test]
fn every_published_system_is_valid() {
    let folder = std::fs::read_dir("examples/published").unwrap();
    let paths: Vec<_> = folder.map(|entry| entry.unwrap().path()).collect();
    assert!(paths.len() >= 6, "{} programs", paths.len());
    for path in paths {
        let program = std::fs::read_to_string(&path).unwrap();
        no_diagnostics(path.to_str().unwrap(), &program);
        let laid_out = stochc_grammar::format(&program);
        assert_eq!(laid_out.as_deref(), Ok(&*program), "{}", path.display());
    }
}

#[test]
fn the_reference_shows_the_built_in_scenes() {
    for (name, text) in BUILT_IN {
        let scene = text.find("scene ").map(|at| text[at..].trim_end());
        assert!(
            scene.is_some_and(|scene| SCENES.contains(scene)),
            "docs/reference/scene-parameters.md shows another scene `{name}`"
        );
    }
}

/// Checks the table of scenes. `STOCHC_WRITE_DOCS=1` updates it instead.
#[test]
fn the_table_of_scenes_matches_the_schema() {
    let mut table =
        "| clause and fields | value and meaning | absent |\n|---|---|---|\n".to_owned();
    for clause in &CLAUSES {
        clause.rows(0, &mut table);
    }
    crate::pages::assert_table("docs/reference/scene-parameters.md", &table);
}

/// Checks the table of scene parameters for sweeps. `STOCHC_WRITE_DOCS=1` updates it instead.
#[test]
fn the_table_of_sweepable_parameters_matches_the_schema() {
    let mut table = "| name | short | values |\n|---|---|---|\n".to_owned();
    for number in scalars::all() {
        let (name, short) = number.names.split_first().expect("each has a name");
        let short: Vec<_> = short.iter().map(|short| format!("`{short}`")).collect();
        let short = short.join(", ");
        let range = number.range.rule();
        table += &format!("| `{name}` | {short} | {range} |\n");
    }
    crate::pages::assert_table("docs/reference/scene-parameters.md", &table);
}

/// Checks that each clause of the schema has an equation on the page about the model.
#[test]
fn every_scene_parameter_has_an_equation() {
    let table = MODEL.split_once("| clause | equation").expect("the table");
    let table = table.1.split_once("\n\n").expect("the end of the text").0;
    let clauses: Vec<Vec<&str>> = (table.lines())
        .filter_map(|line| line.split(" | ").next())
        .map(|clause| {
            clause
                .split(|sign: char| !sign.is_alphanumeric() && sign != '_')
                .collect()
        })
        .collect();
    // These parameters have no equation: the tick, a property of the hardware, a value that is only
    // reported, and the other end of a range.
    let others = ["tick", "block.faces", "flow.force", "agitation.speed.low"];
    let missing: Vec<_> = scalars::all()
        .map(|number| number.names[0])
        .filter(|name| {
            // The page may have a separate row for a clause of a bond.
            let words = name.strip_prefix("bond.").unwrap_or(name);
            let has_all = |clause: &Vec<&str>| words.split('.').all(|word| clause.contains(&word));
            !clauses.iter().any(has_all)
        })
        .collect();
    assert_eq!(
        missing, others,
        "numbers without a row in docs/concepts/physical-model.md"
    );
}

#[test]
fn few_examples_cannot_be_checked_alone() {
    let excerpts = REFERENCE.matches("```sa,fragment").count();
    assert!(excerpts <= 1, "{excerpts} excerpts that no test checks");
}

#[test]
fn every_example_is_formatted() {
    for (page, text) in [
        ("docs/reference/language.md", REFERENCE),
        ("README.md", README),
    ] {
        let fragments = programs_behind("\n```sa,fragment\n", text);
        for (line, program) in programs(text).into_iter().chain(fragments) {
            let laid_out = stochc_grammar::format(program);
            assert_eq!(laid_out.as_deref(), Ok(program), "{page}:{line}");
        }
    }
}

/// Returns the programs on a page, each with the number of its first line. They are in fenced
/// blocks of the language `sa`.
fn programs(page: &str) -> Vec<(usize, &str)> {
    programs_behind("\n```sa\n", page)
}

fn programs_behind<'a>(fence: &str, page: &'a str) -> Vec<(usize, &'a str)> {
    let fences = page.match_indices(fence);
    fences
        .filter_map(|(at, _)| {
            let start = at + fence.len();
            let (program, _) = page[start..].split_once("```")?;
            Some((page[..start].lines().count() + 1, program))
        })
        .collect()
}

/// Checks that a program has no diagnostics, not even warnings, because readers copy examples.
fn no_diagnostics(name: &str, program: &str) {
    let mut reader = |_: &str| Ok(program.as_bytes().to_vec());
    let checked: Checked = check(name, &mut reader, Limits::default());
    let diagnostics = show(&checked, Format::Short, false, 100);
    let diagnostics: Vec<&str> = (diagnostics.lines())
        .filter(|line| !line.contains("warning[tight-approach]"))
        .filter(|line| !line.contains("warning[crowded-captures]"))
        .collect();
    assert!(diagnostics.is_empty(), "{diagnostics:#?}");
}
