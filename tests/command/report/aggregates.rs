//! Tests reports on aggregates, which have no captures.
use std::fs;
use std::path::Path;

use crate::reading::{fields, parsed};
use crate::stochc::{path, stochc_with};

#[test]
fn a_report_of_an_aggregate_has_no_empty_sections() {
    let folder = tempfile::tempdir().unwrap();
    let program = path(folder.path(), "three.sa");
    let text = "scene three from magnet_tank { free 3 ring 20cm }\naggregate trio in three to 3 timeout 317 s\n";
    fs::write(&program, text).unwrap();
    let out = path(folder.path(), "out");
    let outcome = stochc_with("simulate --quiet --runs 2", &[&program, "--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(stochc_with("report --quiet", &[&out]).status, 0);
    let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    let document = parsed(&page);
    let headings: Vec<String> = (document.descendants())
        .filter(|node| node.has_tag_name("h3") && node.attribute("id").is_some())
        .map(|node| {
            node.descendants()
                .filter(|it| it.is_text())
                .filter_map(|it| it.text())
                .collect()
        })
        .collect();
    assert_eq!(headings, ["Growth of the largest group", "Single runs"]);
    for body in document
        .descendants()
        .filter(|node| node.has_tag_name("tbody"))
    {
        assert!(body.children().any(|row| row.has_tag_name("tr")));
    }
    let figures = Path::new(&out).join("report-figures");
    let mut names: Vec<String> = fs::read_dir(&figures)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    assert_eq!(
        names,
        [
            "means.csv",
            "sizes-1.svg",
            "sizes.csv",
            "survival.csv",
            "survival.svg"
        ]
    );
    // Reaching the last size completes the aggregate.
    let rows = |name: &str| fields(&fs::read_to_string(figures.join(name)).unwrap());
    let ticks = |name: &str, column: &str, value: &str| -> Vec<String> {
        let rows = rows(name).into_iter();
        let rows = rows.filter(|row| row[column] == value);
        rows.map(|row| row["ticks"].clone()).collect()
    };
    let last = ticks("sizes.csv", "size", "3");
    assert!(!last.is_empty());
    assert_eq!(last, ticks("survival.csv", "phase", ""));
    assert_ne!(last, ticks("sizes.csv", "size", "2"));
}
