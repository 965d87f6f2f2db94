//! Tests the sources and licences of dependencies against `deny.toml`, without the program
//! `cargo-deny`.
use std::process::Command;

use serde_json::Value;

const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// Returns the licences that `deny.toml` allows.
fn allowed() -> Vec<String> {
    let text = std::fs::read_to_string("deny.toml").unwrap();
    let (_, list) = text.split_once("\nallow = [").unwrap();
    let (list, _) = list.split_once(']').unwrap();
    let licences = list.split('"').skip(1).step_by(2);
    licences.map(str::to_owned).collect()
}

/// Returns whether a licence expression (SPDX) is satisfied by the allowed licences.
fn is_allowed(expression: &str, allowed: &[String]) -> bool {
    let any = |text: &str| {
        let mut parts = text.split(" OR ").flat_map(|part| part.split('/'));
        parts.any(|part| {
            allowed
                .iter()
                .any(|it| it == part.trim_matches(['(', ')', ' ']))
        })
    };
    let parts: Vec<&str> = expression.split(" AND ").collect();
    // No expression of our dependencies has more than one pair of parentheses.
    assert!(expression.matches('(').count() <= 1, "{expression}");
    parts.into_iter().all(any)
}

#[test]
fn license_expressions_are_evaluated() {
    let allowed = ["MIT", "Zlib"].map(str::to_owned);
    for (expression, expected) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("GPL-3.0 OR MIT", true),
        ("Apache-2.0/MIT", true),
        ("Apache-2.0 / MIT", true),
        ("(Apache-2.0 OR MIT) AND Zlib", true),
        ("(Apache-2.0 OR MIT) AND GPL-3.0", false),
        ("MIT WITH something", false),
        ("", false),
    ] {
        assert_eq!(is_allowed(expression, &allowed), expected, "{expression}");
    }
}

#[test]
fn dependencies_have_allowed_sources_and_licences() {
    let cargo = std::env::var("CARGO").unwrap_or("cargo".to_owned());
    let output = Command::new(cargo)
        .args(["metadata", "--format-version", "1", "--locked", "--offline"])
        .output()
        .unwrap();
    let failed = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() && failed.contains("offline") {
        // Crates for other platforms may be missing on this machine.
        return assert_sources();
    }
    assert!(output.status.success(), "{failed}");
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let allowed = allowed();
    let packages = metadata["packages"].as_array().unwrap();
    let mut foreign = 0;
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let licence = package["license"].as_str().unwrap_or_default();
        assert!(is_allowed(licence, &allowed), "{name}: {licence}");
        foreign += usize::from(!package["source"].is_null());
    }
    assert!(foreign > 100, "{foreign}");
    assert_sources();
}

/// Checks every package in the lock file. It must be in this workspace, or be from the registry and
/// have a checksum.
fn assert_sources() {
    for package in locked("Cargo.lock") {
        let name = field(&package, "name").unwrap();
        match field(&package, "source") {
            None => assert!(name.starts_with("stochc"), "{name}"),
            Some(source) => {
                assert_eq!(source, REGISTRY, "{name}");
                let checksum = field(&package, "checksum");
                assert_eq!(checksum.map(str::len), Some(64), "{name}");
            }
        }
    }
}

/// Returns the text of each package in a lock file.
fn locked(path: &str) -> Vec<String> {
    let lock = std::fs::read_to_string(path).unwrap();
    let packages = lock.split("\n[[package]]\n").skip(1);
    packages.map(str::to_owned).collect()
}

/// Returns the value of a field of a locked package.
fn field<'a>(package: &'a str, name: &str) -> Option<&'a str> {
    let lines = package.lines();
    let mut values = lines.filter_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
    values.next().map(|value| value.trim_matches('"'))
}

/// Returns the names of the dependencies that a lock file must list for each package of a
/// workspace. Only the lock file of the workspace itself lists dependencies of tests and optional
/// dependencies.
fn declared(manifest: &str, is_own: bool) -> Vec<(String, Vec<String>)> {
    let cargo = std::env::var("CARGO").unwrap_or("cargo".to_owned());
    let output = Command::new(cargo)
        .args([
            "metadata",
            "--format-version",
            "1",
            "--no-deps",
            "--offline",
        ])
        .args(["--manifest-path", manifest])
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap().iter();
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    packages
        .map(|package| {
            let all = package["dependencies"].as_array().unwrap().iter();
            let is_needed = |of: &&Value| is_own || of["kind"] != "dev" && of["optional"] == false;
            let needed = all.filter(is_needed).map(|of| text(&of["name"]));
            (text(&package["name"]), needed.collect())
        })
        .collect()
}

/// Checks that the lock files of the other workspaces list all dependencies of our crates. A lock
/// file that does not is out of date, and `cargo build --locked` rejects it.
#[test]
fn lock_files_of_other_workspaces_are_current() {
    let ours = declared("Cargo.toml", false);
    for folder in ["editors/test", "fuzz", "lab"] {
        let own = declared(&format!("{folder}/Cargo.toml"), true);
        let mut found = 0;
        for package in locked(&format!("{folder}/Cargo.lock")) {
            let name = field(&package, "name").unwrap();
            let mut known = own.iter().chain(&ours);
            let Some((_, needed)) = known.find(|(of, _)| of == name) else {
                continue;
            };
            found += 1;
            for dependency in needed {
                let is_listed = package.contains(&format!("\n \"{dependency}\""))
                    || package.contains(&format!("\n \"{dependency} "));
                assert!(
                    is_listed,
                    "{folder}/Cargo.lock does not list `{dependency}` for `{name}`; \
                     run `cargo update -w --manifest-path {folder}/Cargo.toml`"
                );
            }
        }
        assert!(found > 0, "{folder}");
    }
}
