//! Compares the proofs of `check` for small programs with their tables, executed in every order.
//!
//! `STOCHC_WRITE_DOCS=1 cargo test --workspace --test exploration` writes `verdicts.md`.
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;

use stochc_compiler::diagnostic::{Code, Diagnostic};
use stochc_compiler::{Checked, Limits, check};
use stochc_control::explore::{
    Exploration, ExplorationBounds, ExplorationReport, ExplorationVerdict, Faults, ProgramGoals,
    Property,
};
use stochc_ir::table::Tables;
use stochc_ir::{Cell, Face};

const PAGE: &str = "tests/exploration/verdicts.md";

const HEAD: &str = "\
# Proof and execution of programs with one idea

`STOCHC_WRITE_DOCS=1 cargo test --workspace --test exploration` writes this file. docs/validation/proofs-executed.md summarizes it.

A *transition* leads from one state of the execution to the next. Orders with the same states are counted once.

";

struct Case {
    name: String,
    idea: String,
    checked: Checked,
}

fn cases() -> Vec<Case> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir("../../tests/verification")
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    paths.into_iter().map(case).collect()
}

fn case(path: PathBuf) -> Case {
    let text = std::fs::read_to_string(&path).unwrap();
    let idea = text
        .lines()
        .next()
        .unwrap()
        .trim_start_matches("// ")
        .to_owned();
    let name = path.file_name().unwrap().to_str().unwrap().to_owned();
    let mut reader = |_: &str| Ok(text.clone().into_bytes());
    let checked = check(&name, &mut reader, Limits::default());
    Case {
        name,
        idea,
        checked,
    }
}

impl Case {
    fn errors(&self) -> Vec<&Diagnostic> {
        (self.checked.diagnostics.iter())
            .filter(|diagnostic| diagnostic.is_error())
            .collect()
    }

    fn tables(&self) -> &Tables {
        let program = &self.checked.programs[0];
        (program.tables.as_ref().or(program.stuck.as_ref()))
            .unwrap_or_else(|| panic!("{}: {:#?}", self.name, self.checked.diagnostics))
    }

    fn execute(&self) -> ExplorationReport {
        let tables = self.tables();
        let expected = ProgramGoals::new(tables);
        let mut exploration = Exploration::new(
            tables,
            &expected,
            ExplorationBounds::default(),
            Faults::default(),
        );
        exploration.reach = Some(&is_open);
        exploration.run()
    }
}

/// Returns whether a chain of empty cells leads from outside to a cell, by visiting the cells one
/// by one.
fn is_open(full: &BTreeSet<Cell>, target: Cell) -> bool {
    let bound = |axis: fn(&Cell) -> i32| {
        let values = || full.iter().chain([&target]).map(axis);
        (values().min().unwrap() - 1, values().max().unwrap() + 1)
    };
    let (x, y, z) = (
        bound(|cell| cell.x),
        bound(|cell| cell.y),
        bound(|cell| cell.z),
    );
    let mut found = BTreeSet::from([target]);
    let mut open = vec![target];
    while let Some(cell) = open.pop() {
        let is_border = |at: i32, (low, high): (i32, i32)| at == low || at == high;
        if is_border(cell.x, x) || is_border(cell.y, y) || cell.z == z.1 {
            return true;
        }
        for face in Face::ALL {
            let next = cell.across(face).unwrap();
            if next.z >= 1 && !full.contains(&next) && found.insert(next) {
                open.push(next);
            }
        }
    }
    false
}

#[test]
fn proof_and_execution_agree_on_every_program() {
    let (mut right, mut wrong) = (0, 0);
    let mut valid =
        "| program | idea (warnings of `check`) | transitions |\n|---|---|--:|\n".to_owned();
    let mut invalid = "| program | idea | error of `check` | execution | transitions |\n\
                       |---|---|---|---|--:|\n"
        .to_owned();
    let cases = cases();
    for case in &cases {
        let (name, idea) = (case.name.trim_end_matches(".sa"), &case.idea);
        let errors = case.errors();
        let report = case.execute();
        let mut titles: Vec<String> = errors
            .iter()
            .map(|error| format!("**{}**: {}", error.code, error.title))
            .collect();
        for code in [Code::TightApproach, Code::CrowdedCaptures] {
            if (case.checked.diagnostics.iter()).any(|diagnostic| diagnostic.code == code) {
                titles.push(format!("`{code}`"));
            }
        }
        let (titles, transitions) = (titles.join("; "), report.transitions);
        let _ = if errors.is_empty() {
            right += 1;
            assert!(report.holds(), "{}: {report:#?}", case.name);
            let warnings = match &titles[..] {
                "" => String::new(),
                titles => format!(" ({titles})"),
            };
            writeln!(valid, "| `{name}` | {idea}{warnings} | {transitions} |")
        } else {
            wrong += 1;
            let ExplorationVerdict::Violated(violation) = &report.verdict else {
                panic!("{}: {errors:#?}\n{report:#?}", case.name);
            };
            assert_eq!(violation.property, Property::NoHang, "{}", case.name);
            let what = &violation.what;
            writeln!(
                invalid,
                "| `{name}` | {idea} | {titles} | {what} | {transitions} |"
            )
        };
    }
    assert!(right >= 20 && wrong >= 12, "{right} right, {wrong} wrong");
    let page = format!(
        "{HEAD}{right} programs have no error and complete in every order:\n\n{valid}\n\
         {wrong} programs have an error and can wait forever:\n\n{invalid}"
    );
    crate::pages::assert_page(PAGE, &page);
}

/// Checks that the execution can fail. Otherwise its success would prove nothing.
#[test]
fn execution_without_walls_misses_cavities() {
    let sealed: Vec<Case> = (cases().into_iter())
        .filter(|case| {
            case.errors()
                .iter()
                .all(|error| error.code == Code::SealedCavity)
        })
        .filter(|case| !case.errors().is_empty())
        .collect();
    assert!(sealed.len() >= 8);
    for case in sealed {
        let tables = case.tables();
        let expected = ProgramGoals::new(tables);
        let exploration = Exploration::new(
            tables,
            &expected,
            ExplorationBounds::default(),
            Faults::default(),
        );
        // Without walls only the protocol is tested. It cannot detect that a block cannot arrive.
        assert!(exploration.run().holds(), "{}", case.name);
    }
}

/// Returns a random program with few captures in a box of 3 x 3 cells, walls first.
fn random(draw: &mut dyn FnMut(usize) -> usize) -> String {
    let mut text = "assembly random {\n seed plate 3 x 3 {\n".to_owned();
    let mut blocks: Vec<(String, Cell)> = Vec::new();
    for (x, y) in [(1, 0), (0, 1), (1, 1), (2, 1), (1, 2)] {
        let _ = writeln!(text, "  S{x}{y} at ({x}, {y})");
        blocks.push((format!("S{x}{y}"), Cell::new(x, y, 0)));
    }
    text.push_str(" }\n");
    // Some walls already exist, sometimes nearly all, so that few blocks remain for the orders.
    let walls = [3, 7, 8][draw(3)];
    let mut phase = |begin: &str, count: usize, middle: bool| {
        let _ = writeln!(text, " phase {begin} {{");
        let mut events: Vec<String> = Vec::new();
        for _ in 0..count {
            let mut open: Vec<(String, Face, Cell)> = Vec::new();
            for (name, cell) in &blocks {
                for face in Face::ALL {
                    let next = cell.across(face).unwrap();
                    let sides = (next.x - 1).abs() + (next.y - 1).abs();
                    let fits = (1..=2).contains(&next.z) && sides <= 1;
                    let is_seen = cell.z > 0 || face == Face::Up;
                    let is_wall = sides == 1 || next.z == 2;
                    if fits
                        && is_seen
                        && (middle || is_wall)
                        && blocks.iter().all(|(_, at)| *at != next)
                    {
                        open.push((name.clone(), face, next));
                    }
                }
            }
            if open.is_empty() {
                break;
            }
            let (parent, face, cell) = open.swap_remove(draw(open.len()));
            let name = format!("B{}{}{}", cell.x, cell.y, cell.z);
            let after = match events.len() {
                count if count > 0 && draw(3) == 0 => format!(" after {}", events[draw(count)]),
                _ => String::new(),
            };
            let _ = writeln!(text, "  {parent}.{face} -> {name}{after}");
            events.push(name.clone());
            blocks.push((name, cell));
        }
        text.push_str(" }\n");
    };
    phase("walls", walls, false);
    phase("rest", 5, true);
    text.push_str("}\n");
    text
}

/// Checks that a capture is reported as unreachable exactly if its block docks in no order of the
/// tables.
#[test]
fn never_means_in_no_order() {
    let mut draws = 1u64;
    let mut draw = |most: usize| {
        draws = draws
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (draws >> 33) as usize % most.max(1)
    };
    let (mut never, mut at_times, mut programs) = (0, 0, 0);
    while programs < 60 {
        let text = random(&mut draw);
        let mut reader = |_: &str| Ok(text.clone().into_bytes());
        let checked = check("random.sa", &mut reader, Limits::default());
        let sealed: Vec<&Diagnostic> = (checked.diagnostics.iter())
            .filter(|diagnostic| diagnostic.code == Code::SealedCavity)
            .collect();
        if sealed.is_empty()
            || sealed.len() < checked.diagnostics.iter().filter(|f| f.is_error()).count()
        {
            continue;
        }
        programs += 1;
        let program = &checked.programs[0];
        let tables = program.stuck.as_ref().unwrap();
        let expected = ProgramGoals::new(tables);
        // Collects every cell that is full in some order. Each such cell is queried as a target.
        let seen = RefCell::new(BTreeSet::new());
        let reach = |full: &BTreeSet<Cell>, target: Cell| {
            seen.borrow_mut().extend(full.iter().copied());
            let open = is_open(full, target);
            if open {
                seen.borrow_mut().insert(target);
            }
            open
        };
        let mut exploration = Exploration::new(
            tables,
            &expected,
            ExplorationBounds::default(),
            Faults::default(),
        );
        exploration.reach = Some(&reach);
        exploration.reduce = false;
        exploration.hangs_allowed = true;
        let report = exploration.run();
        assert!(report.holds() && report.hangs > 0, "{text}\n{report:#?}");
        for diagnostic in sealed {
            let name = diagnostic.title.split('`').nth(1).unwrap();
            let event = (program.plan.events.iter())
                .position(|event| program.plan.roles.name(event.role, &checked.symbols) == name)
                .unwrap();
            let is_reached = seen
                .borrow()
                .contains(&program.layout.cells[event].unwrap());
            let is_never = diagnostic.title.contains("can never be reached");
            never += usize::from(is_never);
            at_times += usize::from(!is_never);
            assert_eq!(is_never, !is_reached, "{text}\n{}", diagnostic.title);
        }
    }
    println!("in {programs} programs: {never} in no order, {at_times} in some");
    assert!(never >= 20 && at_times >= 20, "{never} {at_times}");
}
