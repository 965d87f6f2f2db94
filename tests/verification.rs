//! What the check proves of small programs, against their tables executed in every order.
//!
//! The page of the results is written anew with `STOCHC_WRITE_DOCS=1 cargo test --test verification`.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;

use stochc::compiler::finding::{Code, Finding};
use stochc::compiler::table::Tables;
use stochc::compiler::{Cell, Checked, Face, Limits, check};
use stochc::runtime::explore::{Bounds, Expected, Exploration, Faults, Property, Report, Verdict};

const PAGE: &str = "docs/verification.md";

const HEAD: &str = "\
# Proof and execution, side by side

Small programs, one idea each, in [tests/verification](../tests/verification). For each of them the compiler says what it has
proved ([proofs.md](proofs.md)); and the event tables are executed in every order of captures and of message hops
([protocol.md](protocol.md)), in a world where a block comes to a cell only if a chain of empty cells leads there from outside. The
two share no code but the tables. They have to agree on every program: what is right ends in every order, with the
declared structure and each report told once; what is wrong can wait for ever.

*Steps* are the different steps from state to state, up to orders that make no difference. This page is written by
`STOCHC_WRITE_DOCS=1 cargo test --test verification`; the test compares it, and fails where the two disagree.

";

struct Case {
    name: String,
    idea: String,
    checked: Checked,
}

fn cases() -> Vec<Case> {
    let mut paths: Vec<PathBuf> = std::fs::read_dir("tests/verification")
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
    fn errors(&self) -> Vec<&Finding> {
        (self.checked.findings.iter())
            .filter(|finding| finding.is_error())
            .collect()
    }

    fn tables(&self) -> &Tables {
        let program = &self.checked.programs[0];
        (program.tables.as_ref().or(program.stuck.as_ref()))
            .unwrap_or_else(|| panic!("{}: {:#?}", self.name, self.checked.findings))
    }

    fn execute(&self) -> Report {
        let tables = self.tables();
        let expected = Expected::of(tables);
        let mut exploration =
            Exploration::new(tables, &expected, Bounds::default(), Faults::default());
        exploration.reach = Some(&is_open);
        exploration.run()
    }
}

/// Whether a chain of empty cells leads from outside to a cell: all of them, one by one.
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
    let mut page = HEAD.to_owned();
    page.push_str("| program | idea | `stochc check` | executed in every order | steps |\n");
    page.push_str("|---|---|---|---|---|\n");
    let cases = cases();
    let (mut right, mut wrong) = (0, 0);
    for case in &cases {
        let errors = case.errors();
        let report = case.execute();
        let said = match errors.first() {
            None => {
                right += 1;
                assert!(report.holds(), "{}: {report:#?}", case.name);
                "ends, as declared".to_owned()
            }
            Some(_) => {
                wrong += 1;
                let Verdict::Violated(violation) = &report.verdict else {
                    panic!("{}: {errors:#?}\n{report:#?}", case.name);
                };
                assert_eq!(violation.property, Property::NoHang, "{}", case.name);
                format!("can wait for ever: {}", violation.what)
            }
        };
        let mut titles: Vec<String> = errors
            .iter()
            .map(|error| format!("**{}**: {}", error.code, error.title))
            .collect();
        if titles.is_empty() {
            titles.push("right".to_owned());
        }
        let is_tight = |finding: &Finding| finding.code == Code::TightApproach;
        if case.checked.findings.iter().any(is_tight) {
            titles.push("`tight-approach`".to_owned());
        }
        let number = case.name.split('_').next().unwrap();
        let _ = writeln!(
            page,
            "| [{number}](../tests/verification/{}) | {} | {} | {said} | {} |",
            case.name,
            case.idea,
            titles.join("; "),
            report.transitions,
        );
    }
    assert!(right >= 20 && wrong >= 12, "{right} right, {wrong} wrong");
    let _ = writeln!(
        page,
        "\n{} programs: {right} are right and end in every order, {wrong} are wrong and can wait for ever.",
        cases.len(),
    );
    if std::env::var_os("STOCHC_WRITE_DOCS").is_some() {
        std::fs::write(PAGE, &page).unwrap();
    }
    let written = std::fs::read_to_string(PAGE).unwrap();
    assert_eq!(written, page, "write it anew with STOCHC_WRITE_DOCS=1");
}

/// An execution that could not fail would prove nothing.
#[test]
fn execution_without_walls_does_not_see_what_the_check_sees() {
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
        let expected = Expected::of(tables);
        let exploration = Exploration::new(tables, &expected, Bounds::default(), Faults::default());
        // Only the protocol: it does its part, and cannot know that no block will come.
        assert!(exploration.run().holds(), "{}", case.name);
    }
}
