//! Compares uncalibrated estimates with calibrated rates. `stochc calibrate` wrote the files of
//! `data/` for scenes that differ from the default scene in one parameter.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]

use std::fs;

use stochc_estimate::{GUESS_ERROR, Neighbourhood, Rates};
use stochc_ir::{Cell, Face};

/// Scenes that were used to choose the constants of the theory.
const SEEN: [&str; 7] = [
    "half", "double", "calm", "weak", "strong", "lively", "small",
];

/// Returns the mean waiting times of the faces that `stochc calibrate` shows.
fn waits(rates: &Rates) -> [f64; 5] {
    let tower = |x: i32, top: i32, cell: Cell| (cell.x, cell.y) == (x, 0) && cell.z <= top;
    let wait = |x: i32, z: i32, direction: Face, is_full: &dyn Fn(Cell) -> bool| {
        let seen = rates.surroundings(
            Cell::new(x, 0, z),
            direction,
            Neighbourhood::new(Cell::new(x, 0, z), is_full),
            |_| None,
        );
        rates.wait(&seen).mean()
    };
    [
        wait(0, 1, Face::Up, &|_| false),
        wait(0, 5, Face::Up, &|cell| tower(0, 4, cell)),
        wait(1, 4, Face::East, &|cell| tower(0, 4, cell)),
        wait(0, 3, Face::Up, &|cell| {
            tower(0, 2, cell) || tower(1, 4, cell)
        }),
        wait(0, 3, Face::Up, &|cell| {
            tower(0, 2, cell) || tower(1, 4, cell) || tower(-1, 4, cell)
        }),
    ]
}

#[test]
fn uncalibrated_estimates_have_the_stated_error() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data");
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let mut all = Vec::new();
    for name in &names {
        let text = fs::read_to_string(format!("{folder}/{name}")).unwrap();
        let measured = Rates::from_text(&text).unwrap();
        let guess = Rates::first_guess(&measured.scene).unwrap();
        assert!(guess.is_guess() && !measured.is_guess());
        assert_eq!(Rates::from_text(&guess.to_text()).unwrap(), guess);
        // The error is unknown for more distant scenes.
        let mut other = measured.scene.clone();
        other.drag = None;
        assert_eq!(Rates::first_guess(&other), None);
        let pairs = waits(&guess).into_iter().zip(waits(&measured));
        let off: Vec<f64> = pairs
            .map(|(guess, measured)| (guess / measured).ln())
            .collect();
        let stem = name.trim_end_matches(".rates");
        let kind = if SEEN.contains(&stem) {
            "seen"
        } else {
            "not seen"
        };
        let shown: Vec<String> = off.iter().map(|off| format!("{:.2}", off.exp())).collect();
        println!("{stem:8} {kind:8} {}", shown.join("  "));
        all.push((kind, off));
    }
    for kind in ["seen", "not seen"] {
        let off: Vec<f64> = (all.iter().filter(|it| it.0 == kind))
            .flat_map(|it| it.1.clone())
            .collect();
        let rms = (off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64)
            .sqrt()
            .exp();
        let worst = off
            .iter()
            .fold(0.0, |most: f64, off| most.max(off.abs()))
            .exp();
        println!("{kind}: a factor of {rms:.2} as a root mean square, {worst:.2} at most");
        assert!(
            rms < GUESS_ERROR.0 && worst < GUESS_ERROR.1,
            "{kind}: {rms} {worst}"
        );
    }
}
