//! Tests the page of a report that the command writes.
use crate::reading::parsed;
use crate::stochc::{path, stochc_with};

/// Checks that the command line accepts the commands on the page.
#[test]
fn the_commands_on_the_page_work() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "it's out");
    let again = path(folder.path(), "again");
    let simulate =
        "simulate --quiet --model shuffle --runs 3 --max-ticks 50 tests/fixtures/tower.sa";
    assert_eq!(stochc_with(simulate, &["--out", &out]).status, 0);
    let outcome = stochc_with("report", &[&out]);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let page = std::fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    let document = parsed(&page);
    let commands: Vec<String> = (document.descendants())
        .filter(|node| node.attribute("class") == Some("command"))
        .map(|node| {
            node.descendants()
                .filter_map(|node| node.text())
                .next()
                .unwrap()
                .to_owned()
        })
        .collect();
    let mut simulated = 0;
    for command in commands {
        let arguments = command.strip_prefix("stochc ").unwrap();
        if arguments.starts_with("replay '") {
            continue;
        }
        simulated += 1;
        let target = format!("{again}-{simulated}");
        let line = arguments.replace("AGAIN", &target);
        let shell = format!("{} --quiet {line}", env!("CARGO_BIN_EXE_stochc"));
        let status = std::process::Command::new("sh")
            .args(["-c", &shell])
            .stdout(std::process::Stdio::null())
            .status();
        assert!(status.unwrap().success(), "{shell}");
        for table in ["runs.parquet", "bonds.parquet"] {
            let of = |folder: &str| std::fs::read(path(folder.as_ref(), table)).unwrap();
            assert!(of(&target) == of(&out), "{command}");
        }
    }
    assert_eq!(simulated, 2);
}

/// Checks that thirteen waits of one tick each are described in one sentence.
#[test]
fn equal_waits_in_a_row_are_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --quiet --model shuffle --runs 2 examples/line.sa";
    assert_eq!(stochc_with(simulate, &["--out", &out]).status, 0);
    assert_eq!(stochc_with("report", &[&out]).status, 0);
    let page = std::fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    let expected = "<ol>\n<li>13 waits of at most 1 tick (20.0 ms) followed one after the other. Together they took 13 ticks \
                (260 ms), from tick 0 to 13.</li>\n</ol>";
    assert!(page.contains(expected), "{page}");
    assert!(page.contains("It has no physics, so its times have no meaning"));
}
