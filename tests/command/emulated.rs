//! Firmware on emulated processors, with one process per block.
use std::process::Command;

use crate::skipped::skipped;

/// Runs the firmware on a processor. Returns `None` if one of the programs, listed with their
/// packages, is not installed.
fn events(processor: &str, programs: &[(&str, &str)]) -> Option<String> {
    for (package, program) in programs {
        if Command::new(program).arg("--version").output().is_err() {
            skipped(package, program);
            return None;
        }
    }
    let output = Command::new("firmware/emulated/run")
        .args([env!("CARGO_BIN_EXE_stochc"), processor])
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Checks the numbers of events, and the memory: the largest stack is that of the plate.
fn check(shown: &str, largest_stack: u32) {
    println!("{shown}");
    let count = |word: &str| shown.lines().filter(|line| line.contains(word)).count();
    assert_eq!(
        (count(" docks "), count(" releases "), count(" reports")),
        (15, 5, 9)
    );
    let last = shown.lines().last().unwrap();
    let depth = last.split_whitespace().rev().nth(2).unwrap();
    assert!(depth.parse::<u32>().unwrap() <= largest_stack, "{last}");
}

#[test]
fn blocks_on_an_atmega328p_do_what_was_simulated() {
    let programs = [
        ("python3", "python3"),
        ("gcc-avr", "avr-gcc"),
        ("simavr", "simavr"),
    ];
    if let Some(shown) = events("avr", &programs) {
        check(&shown, 100);
    }
}

#[test]
fn blocks_on_a_cortex_m0_do_what_was_simulated() {
    let programs = [
        ("python3", "python3"),
        ("gcc-arm-none-eabi", "arm-none-eabi-gcc"),
        ("qemu-system-arm", "qemu-system-arm"),
    ];
    if let Some(shown) = events("arm", &programs) {
        check(&shown, 256);
    }
}
