//! Tests the page as a reader sees it.
use std::collections::HashSet;

use stochc_report::ensemble_report::{Figures, ReportError, ReportLocation, report};

use crate::reading::parsed;
use crate::sample::{five, report_of};

/// Returns the text of a page without styles, figures and source texts. Each paragraph and table
/// row is one line.
fn text(page: &str) -> String {
    let document = parsed(page);
    let mut out = String::new();
    let body = document
        .descendants()
        .find(|node| node.has_tag_name("main"));
    for node in body.unwrap().descendants() {
        let name = node.tag_name().name();
        let within = |names: &[&str]| {
            let mut above = node.ancestors().skip(1);
            above.any(|above| names.contains(&above.tag_name().name()))
        };
        let texts = [
            "h1",
            "h2",
            "h3",
            "h4",
            "p",
            "li",
            "tr",
            "pre",
            "figcaption",
            "summary",
        ];
        if !texts.contains(&name) || within(&["details", "svg", "li", "nav"]) {
            continue;
        }
        let cells = node.descendants().filter(|node| node.is_text());
        let cells: Vec<&str> = (cells.filter_map(|node| node.text()))
            .filter(|text| name != "tr" || !text.trim().is_empty())
            .collect();
        let separator = if name == "tr" { " | " } else { "" };
        let line = cells.join(separator);
        out += &format!("{name}: {}\n", line.trim());
    }
    out
}

/// Compares the page and figures of five runs with snapshots. One of the runs was stopped.
#[test]
fn a_small_ensemble_makes_this_page() {
    let report = report_of(&[five(0.2)]);
    let identity = five(0.2).manifest.identity();
    insta::assert_snapshot!(text(&report.page).replace(&identity, "IDENTITY"));
    let names: Vec<&str> = report.files.iter().map(|(name, _)| name.as_str()).collect();
    insta::assert_snapshot!(names.join("\n"));
}

#[test]
fn two_ensembles_are_compared_on_this_page() {
    let mut inputs = [0.1, 0.2].map(five);
    inputs[1].manifest.seed += 1;
    let report = report_of(&inputs);
    let text = text(&report.page);
    let (compared, _) = text.split_once("h2: pair (").unwrap();
    insta::assert_snapshot!(compared);
}

#[test]
fn every_picture_is_well_formed_and_described() {
    let report = report_of(&[0.1, 0.2].map(five));
    let mut pictures = 0;
    for (name, content) in &report.files {
        if !name.ends_with(".svg") {
            continue;
        }
        let content = std::str::from_utf8(content).unwrap();
        pictures += 1;
        let document = parsed(content);
        let root = document.root_element();
        assert_eq!(
            root.tag_name().namespace(),
            Some("http://www.w3.org/2000/svg"),
            "{name}"
        );
        let child = |tag: &str| {
            let child = root.children().find(|node| node.tag_name().name() == tag);
            child.and_then(|node| node.text()).unwrap().to_owned()
        };
        assert!(
            child("title").len() > 10 && child("desc").len() > 40,
            "{name}"
        );
        for number in ["NaN", "inf"] {
            assert!(!content.contains(number), "{name}: {number}");
        }
        // The page contains the elements that label its drawings.
        let labels = root.attribute("aria-labelledby").unwrap().split(' ');
        for label in labels {
            assert!(
                root.descendants()
                    .any(|node| node.attribute("id") == Some(label))
            );
        }
    }
    // The figures are the curves and the means, two of the sweep, and three for each of the two
    // programs.
    assert_eq!(
        pictures,
        4 + 2 * 3,
        "{:?}",
        report.files.iter().map(|f| &f.0).collect::<Vec<_>>()
    );
}

#[test]
fn the_waits_have_a_mark_for_every_capture() {
    let report = report_of(&[five(0.2)]);
    let picture = crate::sample::file(&report, "waits-1.svg");
    let document = parsed(picture);
    let steps = document
        .descendants()
        .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "circle")));
    let steps: Vec<_> = steps
        .filter_map(|node| node.children().find_map(|child| child.text()))
        .collect();
    let captures: Vec<&str> = steps
        .iter()
        .filter_map(|steps| steps.split(':').next())
        .collect();
    assert_eq!(
        captures,
        ["A.up -> C", "C.up -> E", "B.up -> D", "M.up -> F"]
    );
    assert!(steps[3].contains("≥ 166 ± "), "{steps:?}");
}

#[test]
fn the_page_is_complete_and_loads_nothing() {
    let report = report_of(&[0.1, 0.2].map(five));
    let document = parsed(&report.page);
    let mut ids = HashSet::new();
    for node in document.descendants() {
        if let Some(id) = node.attribute("id") {
            assert!(ids.insert(id), "`{id}` twice");
        }
    }
    for node in document.descendants() {
        let name = node.tag_name().name();
        assert!(!["script", "img", "link", "iframe", "object"].contains(&name));
        assert!(node.attribute("src").is_none());
        if let Some(address) = node.attribute("href") {
            match address.strip_prefix('#') {
                Some(id) => assert!(ids.contains(id), "{address}"),
                None => {
                    let file = address.strip_prefix("report-figures/").unwrap();
                    assert!(
                        report.files.iter().any(|(name, _)| name == file),
                        "{address}"
                    );
                }
            }
        }
        for of in ["aria-labelledby"] {
            let labels = node.attribute(of).unwrap_or_default();
            for label in labels.split_whitespace() {
                assert!(ids.contains(label), "{label}");
            }
        }
        // Each figure has a title and a table, for readers who cannot see it.
        if name == "figure" {
            assert!(
                node.descendants()
                    .any(|child| child.tag_name().name() == "figcaption")
            );
        }
    }
}

/// Checks that sentences about a run link to its ticks if it has a replay.
#[test]
fn sentences_link_to_their_ticks() {
    let input = five(0.2);
    let surroundings = ReportLocation {
        reload: None,
        folder: "report-figures",
        figures: &Figures::default(),
        replay: &|_, _, run| Some(format!("replay-{run}.html")),
        recordings: &|_, _, _| None,
    };
    let report = report(&[input], &surroundings, &mut Vec::new()).unwrap();
    let document = parsed(&report.page);
    let headings = document
        .descendants()
        .filter(|node| node.has_tag_name("h4"));
    let mut ends = 0;
    for heading in headings {
        let link = heading.descendants().find(|node| node.has_tag_name("a"));
        let link = link.unwrap();
        let tick = link.text().unwrap().replace(',', "");
        let address = link.attribute("href").unwrap();
        assert!(
            address.ends_with(&format!(".html#tick={tick}")),
            "{address}"
        );
        ends += 1;
    }
    assert_eq!(ends, 3);
    let items = document.descendants().filter(|node| {
        node.has_tag_name("li")
            && node
                .parent_element()
                .is_some_and(|it| it.has_tag_name("ol"))
    });
    let mut sentences = 0;
    for sentence in items {
        let words: String = sentence
            .descendants()
            .filter_map(|node| node.text())
            .collect();
        let links = sentence.descendants().filter(|node| node.has_tag_name("a"));
        for link in links {
            let (_, tick) = link
                .attribute("href")
                .unwrap()
                .split_once(".html#tick=")
                .unwrap();
            assert_eq!(link.text().unwrap().replace(',', ""), tick, "{words}");
            sentences += 1;
        }
        let is_linked = sentence.descendants().any(|node| node.has_tag_name("a"));
        assert_eq!(words.contains("tick "), is_linked, "{words}");
    }
    assert!(sentences >= 3, "{sentences}");
}

/// Checks the numbers below the axis: runs that are neither complete nor stopped.
#[test]
fn curves_show_the_number_of_runs_at_risk() {
    let input = five(0.2);
    let mut ends = Vec::new();
    let each = input.finished.try_each(|done| {
        ends.push(done.record.ticks);
        Ok::<_, ReportError>(())
    });
    each.unwrap();
    let report = report_of(&[input]);
    let document = parsed(crate::sample::file(&report, "survival.svg"));
    let texts: Vec<&str> = (document.descendants())
        .filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")))
        .filter_map(|node| node.text())
        .collect();
    let at = texts.iter().position(|text| *text == "at risk").unwrap();
    let shown: Vec<usize> = (texts[at + 1..].iter())
        .map_while(|text| text.parse().ok())
        .collect();
    // The labels of the axis come first among the texts.
    let marks: Vec<f64> = (texts.iter())
        .map_while(|text| text.replace(',', "").parse().ok())
        .collect();
    let expected: Vec<usize> = (marks.iter())
        .map(|mark| ends.iter().filter(|end| **end as f64 >= *mark).count())
        .collect();
    assert_eq!(shown, expected, "{texts:?}");
    assert_eq!((marks[0], shown[0]), (0.0, 5));
}
