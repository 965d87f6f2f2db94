//! What becomes of a test that asks for a program which is not installed.
use std::io::Write as _;

/// Names the file in which `tests/run` counts what was skipped.
const RECORD: &str = "STOCHC_SKIPPED";

/// Tells that the test that runs now is skipped, wholly or in part, because `command` of the package `package` cannot be
/// run. Panics if `STOCHC_REQUIRE_` and the package's name, up to a dash, is set: where it is installed, nothing is to be skipped.
#[track_caller]
pub fn skipped(package: &str, command: &str) {
    let name = package.split('-').next().unwrap_or(package);
    let required = format!("STOCHC_REQUIRE_{}", name.to_uppercase());
    assert!(
        std::env::var_os(&required).is_none(),
        "`{command}` cannot be run, and {required} is set"
    );
    // A test has a thread of its name, unless all of them run in the first one.
    let here = std::thread::current();
    let place = std::panic::Location::caller();
    let test = match here.name() {
        Some(name) if name != "main" => name.to_owned(),
        _ => format!("{}:{}", place.file(), place.line()),
    };
    let remedy = match package {
        "axe" => "npm install axe-core, and its axe.min.js as STOCHC_AXE".to_owned(),
        _ => format!("apt-get install {package}"),
    };
    let note = format!("skipped {test}: `{command}` cannot be run ({remedy})\n");
    // Past the test's own capture, so that it is seen.
    let _ = std::io::stderr().write_all(note.as_bytes());
    if let Some(record) = std::env::var_os(RECORD) {
        let mut options = std::fs::OpenOptions::new();
        let file = options.append(true).create(true);
        let mut file = file
            .open(record)
            .expect("the record of skipped tests opens");
        file.write_all(format!("{test}\n").as_bytes())
            .expect("the record of skipped tests is written");
    }
}
