//! Tests names that contain markup, formulas or control characters.
use std::sync::Arc;

use stochc_files::address::address;
use stochc_ir::record::{Limit, Outcome};
use stochc_ir::table::{PhaseId, RoleId};

use crate::reading::parsed;
use crate::sample::{five, report_of};

const NAMES: [&str; 7] = [
    "</script><script>alert(1)</script>",
    "\"onload=\"alert(1)",
    "a & b &amp; <b>'c'</b>",
    "gpj.\u{202e}exe\u{2066}\u{200f}",
    "\u{1b}[31m\0\u{7}]]>--><!--",
    "<meta http-equiv=\"refresh\" content=\"0;url=//x\"/><base href=\"//x\"/><form action=\"//x\">",
    "=HYPERLINK(\"//x\")",
];

#[test]
fn hostile_names_are_shown_as_text() {
    for name in NAMES {
        let mut inputs = [0.1, 0.2].map(five);
        for input in &mut inputs {
            input.path = format!("results/{name}");
            let manifest = &mut input.manifest;
            manifest.stochc = name.into();
            let program = &mut manifest.programs[0];
            program.name = name.into();
            program.scene.name = name.into();
            let tables = &mut Arc::make_mut(&mut program.compiled).tables;
            tables.phases[0].name = name.into();
            tables.roles.iter_mut().for_each(|role| role.name += name);
            program.sources[0].path = name.into();
            program.sources[0].text.push_str(name);
        }
        let report = report_of(&inputs);
        let document = parsed(&report.page);
        let tags: Vec<&str> = document
            .descendants()
            .map(|node| node.tag_name().name())
            .collect();
        assert!(!tags.contains(&"script") && !tags.contains(&"b"), "{name}");
        for node in document.descendants() {
            let handler = |name: &str| name.starts_with("on") || name == "style";
            assert!(!node.attributes().any(|attribute| handler(attribute.name())));
        }
        let invisible = |text: &str| {
            let bad =
                |c: char| c.is_control() && c != '\n' || "\u{202e}\u{2066}\u{200f}".contains(c);
            text.contains(bad)
        };
        assert!(!invisible(&report.page), "{name:?}");
        // The content policy is the only instruction to the browser, so the page loads or redirects
        // nothing by itself.
        let instructions = document
            .descendants()
            .filter_map(|node| node.attribute("http-equiv"));
        assert_eq!(
            instructions.collect::<Vec<_>>(),
            ["Content-Security-Policy"]
        );
        let elsewhere = ["form", "base", "iframe", "object", "embed", "link", "img"];
        assert!(!tags.iter().any(|tag| elsewhere.contains(tag)), "{tags:?}");
        for (file, content) in &report.files {
            if file.ends_with(".svg") {
                let content = std::str::from_utf8(content).unwrap();
                parsed(content);
                assert!(
                    !content.contains("<script") && !invisible(content),
                    "{file}"
                );
            }
        }
        // The whole name is still readable on the page.
        let visible = document.descendants().filter_map(|node| node.text());
        let visible: String = visible.collect();
        let plain = name.split(['\u{202e}', '\u{1b}']).next().unwrap();
        assert!(visible.contains(&format!("results/{plain}")), "{name:?}");
    }
}

/// Checks that a comma, a quote or a line break in a name does not shift columns of the data.
#[test]
fn data_files_quote_special_characters() {
    let mut input = five(0.2);
    input.manifest.programs[0].name = "a,\"b\"\nc".into();
    let report = report_of(&[input]);
    let means = crate::sample::file(&report, "means.csv");
    let (_, rows) = means.split_once("\r\n").unwrap();
    assert!(rows.starts_with("\"a,\"\"b\"\"\nc\",,4,1,260,"), "{rows}");
}

#[test]
fn addresses_are_unchanged() {
    assert_eq!(address("a b#c?d%e/f-1.svg"), "a%20b%23c%3Fd%25e/f-1.svg");
    assert_eq!(address("javascript:x"), "javascript%3Ax");
}

/// Checks that a page is drawn even if an edited journal contains impossible values.
#[test]
fn impossible_records_do_not_panic() {
    let mut input = five(0.2);
    let roles = input.manifest.programs[0].roles().len() as u32;
    let mut finished = input.finished.to_vec().unwrap();
    for (i, done) in finished.iter_mut().enumerate() {
        let record = &mut done.record;
        match i {
            0 => record.ticks = u64::MAX,
            1 => record.phase_ticks = vec![u64::MAX; 5],
            2 => record.bonds[0].parent = RoleId(roles),
            3 => {
                let (phase, by) = (PhaseId(77), Limit::Timeout);
                record.outcome = Outcome::TimedOut { phase, by };
                record.waiting[0].magnetized = u64::MAX;
                record.releases[0].child = RoleId(roles);
            }
            _ => {
                record.bonds[1].phase = PhaseId(u32::MAX);
                record.bonds[2].magnetized = u64::MAX;
                record.bonds[2].docking = u64::MAX;
                record.phase_ticks.clear();
            }
        }
    }
    input.finished = finished.into();
    for sources in [true, false] {
        if !sources {
            // A program that was compiled elsewhere has no sources.
            input.manifest.programs[0].sources.clear();
        }
        let report = report_of(std::slice::from_ref(&input));
        parsed(&report.page);
        for (name, content) in &report.files {
            if name.ends_with(".svg") {
                let content = std::str::from_utf8(content).unwrap();
                parsed(content);
                assert!(
                    !content.contains("NaN") && !content.contains("inf"),
                    "{name}"
                );
            }
        }
    }
}

/// Checks that formulas are written as text, so that a spreadsheet does not execute them.
#[test]
fn data_files_contain_no_formula() {
    for name in ["=1+1", "@sum(a)", "+a", "-a"] {
        let mut inputs = [0.1, 0.2].map(five);
        for input in &mut inputs {
            let program = &mut input.manifest.programs[0];
            program.name = name.into();
            let tables = &mut Arc::make_mut(&mut program.compiled).tables;
            tables.phases[0].name = name.into();
            tables
                .roles
                .iter_mut()
                .for_each(|role| role.name = name.into());
        }
        let report = report_of(&inputs);
        let data = (report.files.iter()).filter(|(file, _)| file.ends_with(".csv"));
        let mut cells = 0;
        for (file, text) in data {
            let mut reader = csv::ReaderBuilder::new()
                .has_headers(false)
                .from_reader(&text[..]);
            for row in reader.records().map(Result::unwrap) {
                for cell in &row {
                    let is_number = cell.parse::<f64>().is_ok();
                    let is_text = !cell.starts_with(['=', '+', '-', '@']);
                    assert!(is_number || is_text, "{file}: {cell}");
                    cells += usize::from(cell.starts_with(&format!("'{name}")));
                }
            }
        }
        assert!(cells > 0, "{name}");
    }
}
