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
    let lock = std::fs::read_to_string("Cargo.lock").unwrap();
    let mut packages = lock.split("\n[[package]]\n");
    packages.next();
    for package in packages {
        let field = |name: &str| {
            let lines = package.lines();
            let mut values = lines.filter_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
            values.next().map(|value| value.trim_matches('"'))
        };
        let name = field("name").unwrap();
        match field("source") {
            None => assert!(name.starts_with("stochc"), "{name}"),
            Some(source) => {
                assert_eq!(source, REGISTRY, "{name}");
                assert_eq!(field("checksum").map(str::len), Some(64), "{name}");
            }
        }
    }
}
