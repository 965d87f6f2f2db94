//! Reports of tests that need a program that is not installed.
use std::io::Write as _;

/// Environment variable with the path of a file. It lists skipped tests for `tests/run`.
const RECORD: &str = "STOCHC_SKIPPED";

/// Reports that a part of the current test is skipped, because the program `command` of the package
/// `package` is missing.
///
/// # Panics
/// Panics if the variable `STOCHC_REQUIRE_` with the package's name, up to a dash, is set. Then the
/// package must be installed.
#[track_caller]
pub fn skipped(package: &str, command: &str) {
    let name = package.split('-').next().unwrap_or(package);
    let required = format!("STOCHC_REQUIRE_{}", name.to_uppercase());
    assert!(
        std::env::var_os(&required).is_none(),
        "`{command}` cannot be run, and {required} is set"
    );
    // The thread has the name of the test, unless all tests run in the main thread.
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
    // Direct output to standard error is not captured by the test harness.
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
