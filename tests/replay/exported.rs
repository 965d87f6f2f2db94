//! Tests exports of trajectories for other applications.
use std::collections::BTreeMap;
use std::path::PathBuf;

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::{Field, RowAccessor as _};
use serde_json::Value;
use stochc::results::recording::Frame;
use stochc::runtime::observe::ObservedEvent;

use crate::folder::{PROGRAM, Results, stochc};

fn export(results: &Results, options: &str, name: &str) -> PathBuf {
    let file = results.path().join(name);
    let line = format!("export --run 0 {options} --out");
    let outcome = stochc(&line, &[&file, &results.path()]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(outcome.out, format!("{}\n", file.display()));
    file
}

/// Returns the recorded positions at every `every`th tick, by tick.
fn recorded(results: &Results, every: u64) -> BTreeMap<u64, Frame> {
    let frames = results.recording(0).frames().collect::<Vec<_>>();
    let frames = frames.into_iter().filter(|frame| frame.tick % every == 0);
    frames.map(|frame| (frame.tick, frame)).collect()
}

/// Rounding error of a recorded coordinate: half a step, in an arena of 50 block lengths.
const ROUNDED: f64 = 1.0 / 1024.0;

#[test]
fn a_table_has_every_block_at_every_tick() {
    let results = Results::from_records(PROGRAM, "--record 0");
    let file = export(&results, "--format parquet --every 40", "ways.parquet");
    let recording = results.recording(0);
    let frames = recorded(&results, 40);
    let reader = SerializedFileReader::new(std::fs::File::open(file).unwrap()).unwrap();
    let metadata = reader.metadata().file_metadata();
    let keys = metadata.key_value_metadata().unwrap();
    let value = |key: &str| {
        keys.iter()
            .find(|pair| pair.key == key)
            .unwrap()
            .value
            .clone()
            .unwrap()
    };
    assert_eq!(
        (value("run"), value("side_m"), value("tick_s")),
        ("0".into(), "0.2".into(), "0.02".into())
    );
    let bodies = recording.header().bodies as usize;
    assert_eq!(metadata.num_rows() as usize, frames.len() * bodies);
    let roles = results.tables().roles;
    for (at, row) in reader.get_row_iter(None).unwrap().enumerate() {
        let row = row.unwrap();
        let (tick, body) = (row.get_long(0).unwrap(), row.get_int(1).unwrap());
        assert_eq!(
            (tick, body),
            (40 * (at / bodies) as i64, (at % bodies) as i32)
        );
        let place = frames[&(tick as u64)].poses[body as usize];
        for (axis, stored) in place[..3].iter().enumerate() {
            let number = f64::from(row.get_float(2 + axis).unwrap());
            assert!((number - stored).abs() <= ROUNDED, "{number} at {tick}");
        }
        let part = |i: usize| f64::from(row.get_float(5 + i).unwrap());
        let product: f64 = (0..4).map(|i| part(i) * place[3 + i]).sum();
        assert!(product.abs() > 1.0 - 1e-6, "{product} at {tick}");
        // The identity follows from the last event of the block.
        let last = (recording.events().iter().rev())
            .filter(|happening| happening.tick <= tick as u64)
            .find_map(|happening| match happening.event {
                ObservedEvent::Captured { body: id, role, .. } if id as i32 == body => {
                    Some(Some(role))
                }
                ObservedEvent::Released { body: id, .. } if id as i32 == body => Some(None),
                _ => None,
            })
            .flatten();
        let name = match row.get_column_iter().last().unwrap().1 {
            Field::Null => None,
            Field::Str(name) => Some(name.as_str()),
            other => panic!("{other:?}"),
        };
        assert_eq!(name, last.map(|role| roles[role.0 as usize].name.as_str()));
    }
}

/// Binary glTF file.
struct Glb {
    json: Value,
    bytes: Vec<u8>,
}

impl Glb {
    fn read(file: &std::path::Path) -> Glb {
        let all = std::fs::read(file).unwrap();
        let number = |at: usize| u32::from_le_bytes(all[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(
            (&all[..4], number(4), number(8)),
            (&b"glTF"[..], 2, all.len())
        );
        let json = number(12);
        assert_eq!((json % 4, &all[16..20]), (0, &b"JSON"[..]));
        let rest = 20 + json;
        assert_eq!(
            (number(rest) % 4, &all[rest + 4..rest + 8]),
            (0, &b"BIN\0"[..])
        );
        assert_eq!(rest + 8 + number(rest), all.len());
        Glb {
            json: serde_json::from_slice(&all[20..rest]).unwrap(),
            bytes: all[rest + 8..].to_vec(),
        }
    }

    /// Returns the numbers of an accessor. Panics if they are not within the file.
    fn numbers(&self, accessor: &Value) -> Vec<f64> {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let get = |of: &Value, name: &str| of[name].as_u64().unwrap() as usize;
        let bytes = &self.bytes[get(view, "byteOffset")..][..get(view, "byteLength")];
        let parts = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            _ => 4,
        };
        let numbers: Vec<f64> = match accessor["componentType"].as_u64().unwrap() {
            5126 => (bytes.chunks_exact(4))
                .map(|bytes| f64::from(f32::from_le_bytes(bytes.try_into().unwrap())))
                .collect(),
            _ => (bytes.chunks_exact(2))
                .map(|bytes| f64::from(i16::from_le_bytes(bytes.try_into().unwrap())) / 32767.0)
                .collect(),
        };
        assert_eq!(numbers.len(), parts * get(accessor, "count"));
        numbers
    }
}

#[test]
fn an_animation_moves_every_block_as_in_the_run() {
    let results = Results::from_records(PROGRAM, "--record 0 --record-every 40");
    let glb = Glb::read(&export(&results, "--format gltf --every 40", "ways.glb"));
    let recording = results.recording(0);
    // Both contain every 40th tick, and all ticks that change the structure.
    let frames: BTreeMap<u64, Frame> =
        (recording.frames().map(|frame| (frame.tick, frame))).collect();
    let nodes = glb.json["nodes"].as_array().unwrap();
    let bodies = recording.header().bodies as usize;
    // The nodes are the plate, the blocks, and the root that turns all of them upright.
    assert_eq!(nodes.len(), 9 + bodies + 1);
    assert_eq!(
        nodes[9 + bodies]["children"].as_array().unwrap().len(),
        9 + bodies
    );
    let animation = &glb.json["animations"][0];
    let channels = animation["channels"].as_array().unwrap();
    assert_eq!(channels.len(), 2 * bodies);
    let mut seconds = Vec::new();
    for channel in channels {
        let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        if seconds.is_empty() {
            seconds = glb.numbers(&sampler["input"]);
            assert!(seconds.windows(2).all(|pair| pair[0] < pair[1]));
        }
        let numbers = glb.numbers(&sampler["output"]);
        let body = channel["target"]["node"].as_u64().unwrap() as usize - 9;
        let path = channel["target"]["path"].as_str().unwrap();
        for (i, second) in seconds.iter().enumerate() {
            let tick = (second / 0.02).round() as u64;
            let place = frames[&tick].poses[body];
            if path == "translation" {
                for axis in 0..3 {
                    assert!((numbers[3 * i + axis] - place[axis]).abs() <= ROUNDED);
                }
            } else {
                let product: f64 = (0..4)
                    .map(|part| numbers[4 * i + part] * place[3 + part])
                    .sum();
                assert!(product.abs() > 1.0 - 1e-4, "{product}");
            }
        }
    }
    // Each tick with a capture has a keyframe.
    for bond in &recording.record().bonds {
        let second = bond.docked as f64 * 0.02;
        assert!(
            seconds.iter().any(|shown| (shown - second).abs() < 1e-4),
            "{second}"
        );
    }
    // A captured block has the name of its role and the colour of its phase.
    let last = recording.record().bonds.last().unwrap();
    let node = &nodes[9 + last.body as usize];
    let name = &results.tables().roles[last.child.0 as usize].name;
    assert_eq!(node["name"], format!("block {}, {name}", last.body));
    assert_eq!(node["mesh"], last.phase.0);
}

#[test]
fn impossible_exports_are_reported() {
    let results = Results::from_records("tests/fixtures/dense.sa", "");
    for form in ["parquet", "gltf"] {
        let line = format!("export --run 0 --format {form} --out /nowhere/at/all");
        let outcome = stochc(&line, &[&results.path()]);
        assert_eq!(
            (outcome.status, outcome.out.as_str()),
            (2, ""),
            "{}",
            outcome.err
        );
        assert!(
            outcome.err.contains("cannot write `/nowhere/at/all`"),
            "{}",
            outcome.err
        );
    }
    let outcome = stochc("export --run 0", &[&results.path()]);
    assert_eq!(outcome.status, 2, "a form has to be chosen");
}
