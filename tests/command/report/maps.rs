//! Tests that maps over runs equal independent sums over the recordings.
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use stochc::report::figures::Medium;
use stochc::results::recording::{Recording, path as recording_path};
use stochc::results::{Finished, Folder, Records};

use crate::layout::check;
use crate::reading::{fields, parsed};
use crate::stochc::{path, stochc_with};

const RUNS: u64 = 3;

/// Simulates a small tower. `more` may add options such as `--record`. Returns the results folder.
fn simulated(folder: &Path, more: &[&str]) -> String {
    let out = path(folder, "out");
    let simulate = "simulate --quiet --runs 3 --seed 4 tests/fixtures/tower.sa";
    let outcome = stochc_with(simulate, &[&["--out", &out], more].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    out
}

fn page(out: &str) -> String {
    let outcome = stochc_with("report", &[out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    fs::read_to_string(path(out.as_ref(), "report.html")).unwrap()
}

fn table(out: &str, name: &str) -> Vec<BTreeMap<String, String>> {
    let file = Path::new(out).join("report-figures").join(name);
    fields(&fs::read_to_string(file).unwrap())
}

fn finished(records: &Records, run: u64) -> Finished {
    records.get(0, run).unwrap().unwrap()
}

#[test]
fn maps_are_sums_over_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), &["--record", "all"]);
    let page = page(&out);
    parsed(&page);
    assert!(
        page.contains("These maps use 3 runs with a recording."),
        "{page}"
    );
    for figure in ["before-1.svg", "near-1.svg"] {
        let svg = fs::read_to_string(Path::new(&out).join("report-figures").join(figure)).unwrap();
        check(figure, &svg, Medium::Screen);
    }
    let contents = Folder::read(Path::new(&out)).unwrap();
    let tables = contents.manifest.programs[0].tables();
    let corner = [tables.plate.width, tables.plate.depth].map(|n| (f64::from(n) - 1.0) / 2.0);
    let found = table(&out, "maps.csv");
    let layer: i32 = (found.iter())
        .find(|row| row["map"] == "free" && row["slice"] == "horizontal")
        .map(|row| row["at"].parse().unwrap())
        .unwrap();
    let (mut captures, mut before) = (0, BTreeMap::new());
    let (mut ticks, mut free) = (0, BTreeMap::new());
    for run in 0..RUNS {
        let record = finished(&contents.finished, run).record;
        let file = File::open(recording_path(Path::new(&out), 0, run)).unwrap();
        let recording = Recording::read(BufReader::new(file), tables).unwrap();
        let frames: Vec<_> = recording.frames().collect();
        let cell = |place: [f64; 7]| [place[0] + corner[0], place[1] + corner[1], place[2] + 0.5];
        for bond in record.bonds.iter().filter(|bond| bond.docked >= 200) {
            let frame = frames
                .iter()
                .find(|frame| frame.tick >= bond.docked - 200)
                .unwrap();
            let at = cell(frame.poses[bond.body as usize]);
            captures += 1;
            if (at[2] - f64::from(bond.cell.z)).abs() <= 1.0 {
                let east = (at[0] - f64::from(bond.cell.x)).round() as i32;
                let north = (at[1] - f64::from(bond.cell.y)).round() as i32;
                *before.entry((east, north)).or_insert(0) += 1;
            }
        }
        let mut last = 0;
        for frame in &frames {
            ticks += frame.tick - last;
            for (body, place) in frame.poses.iter().enumerate() {
                // In this program, no block is released.
                let held = |bond: &&stochc::ir::record::BondRecord| {
                    bond.body as usize == body && bond.docked <= frame.tick
                };
                let at = cell(*place).map(|x| x.round() as i32);
                if at[2] == layer && !record.bonds.iter().any(|bond| held(&bond)) {
                    *free.entry((at[0], at[1])).or_insert(0) += frame.tick - last;
                }
            }
            last = frame.tick;
        }
    }
    assert!(captures > 0 && !free.is_empty());
    let (mut seen, mut places) = (0, 0);
    for row in &found {
        let number = |name: &str| row[name].parse::<f64>().unwrap();
        let place = (number("east") as i32, number("up") as i32);
        let expected = match (&*row["map"], &*row["slice"]) {
            ("before 200", "horizontal") => {
                let count = before.get(&place).copied().unwrap_or(0);
                seen += count;
                f64::from(count) / f64::from(captures) / 2.0
            }
            ("free", "horizontal") => free.get(&place).copied().unwrap_or(0) as f64 / ticks as f64,
            _ => continue,
        };
        places += 1;
        assert!(
            (number("value") - expected).abs() < 1e-9,
            "{row:?}: {expected}"
        );
        assert!(
            number("low") <= number("high") && number("low") >= 0.0,
            "{row:?}"
        );
    }
    assert!(
        seen > 0 && places > 17 * 17,
        "{seen} of {captures}, {places}"
    );
    // The expected rates are entries divided by ticks of waiting, for each face.
    let mut faces = BTreeMap::new();
    for run in 0..RUNS {
        for bond in finished(&contents.finished, run).record.bonds {
            let (entries, ticks) = faces.entry(bond.child).or_insert((0.0, 0.0));
            *entries += f64::from(bond.entries);
            *ticks += (bond.docked - bond.magnetized) as f64;
        }
    }
    let rows = table(&out, "faces.csv");
    assert_eq!(rows.len(), faces.len());
    for (row, (entries, ticks)) in rows.iter().zip(faces.into_values()) {
        let rate: f64 = row["entries"].parse().unwrap();
        assert!((rate - entries / ticks).abs() < 1e-12, "{row:?}");
    }
}

#[test]
fn a_folder_without_recordings_names_the_command() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), &[]);
    let page = page(&out);
    assert!(page.contains("There are no maps, because no run has a readable recording"));
    assert!(page.contains("--record all --out AGAIN"), "{page}");
    assert!(!Path::new(&out).join("report-figures/maps.csv").exists());
}

#[test]
fn a_corrupted_recording_is_reported_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let out = simulated(folder.path(), &["--record", "all"]);
    let [first, second, third] = [0, 1, 2].map(|run| recording_path(Path::new(&out), 0, run));
    let mut bytes = fs::read(&first).unwrap();
    // The corrupted byte is in the record of the run, after all positions.
    let last = bytes.len() - 20;
    bytes[last] ^= 1;
    fs::write(&first, &bytes).unwrap();
    fs::copy(&third, &second).unwrap();
    let two_left_out = page(&out);
    assert!(two_left_out.contains("These maps use 1 run with a recording."));
    assert!(two_left_out.contains("The recording of run 0 is left out:"));
    let another = "it is damaged: it is the recording of another run";
    assert!(two_left_out.contains(another), "{two_left_out}");
    // A single run gives no confidence interval.
    let rows = table(&out, "maps.csv");
    assert!(rows.iter().all(|row| row["low"].is_empty()));
    fs::remove_file(&first).unwrap();
    fs::remove_file(&second).unwrap();
    page(&out);
    assert_eq!(
        table(&out, "maps.csv"),
        rows,
        "nothing of the others has come in"
    );
}
