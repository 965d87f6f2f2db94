//! Tests a real editor as client. `neovim.lua` drives the client of Neovim and checks the answers.
use std::process::{Command, Stdio};

use crate::skipped::skipped;

#[test]
fn neovim_is_served() {
    let version = Command::new("nvim")
        .arg("--version")
        .stdin(Stdio::null())
        .output();
    let Ok(version) = version else {
        return skipped("neovim", "nvim");
    };
    let version = String::from_utf8_lossy(&version.stdout);
    println!("{}", version.lines().next().unwrap_or_default());

    let folder = tempfile::tempdir().unwrap();
    let program = folder.path().join("tower.sa");
    std::fs::copy("tests/command/lsp/neovim.sa", &program).unwrap();
    let log = folder.path().join("log");
    let editor = Command::new("nvim")
        .args(["--headless", "-u", "NONE", "-i", "NONE", "-n"])
        .args(["-c", "luafile tests/command/lsp/neovim.lua"])
        .arg(&program)
        .env("STOCHC", env!("CARGO_BIN_EXE_stochc"))
        .env("STOCHC_LOG", &log)
        .env("XDG_CACHE_HOME", folder.path())
        .env("XDG_STATE_HOME", folder.path())
        .env("XDG_DATA_HOME", folder.path())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let log = std::fs::read_to_string(&log).unwrap_or_default();
    let outcome = String::from_utf8_lossy(&editor.stderr);
    assert!(editor.status.success(), "{log}\n{outcome}");
    let done: Vec<&str> = log.lines().collect();
    let expected = [
        "ok attach",
        "ok diagnostics",
        "ok diagnostics as typed",
        "ok hover",
        "ok definition",
        "ok references",
        "ok symbols",
        "ok rename",
        "ok rename refused",
        "ok format",
        "ok shutdown",
    ];
    assert_eq!(done, expected, "{outcome}");
}
