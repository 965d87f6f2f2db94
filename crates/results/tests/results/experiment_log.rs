//! Tests logs of experiments: logs of simulated runs give the same records, and wrong logs are
//! rejected with their line.
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use proptest::prelude::*;
use stochc_ir::Face;
use stochc_ir::record::{Limit, Outcome, RunRecord};
use stochc_results::{EnsembleProgram, ExperimentLog, LogError};
use stochc_runtime::{Model, Settings};

use crate::logs::{Detail, csv, is_loggable, json_lines, without_physics};

/// Returns the programs of a text. Imports are read from the folder `examples`.
fn programs(text: &str) -> Vec<EnsembleProgram> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut reader = |path: &str| match path {
        "log.sa" => Ok(text.as_bytes().to_vec()),
        path => fs::read(folder.join(path)),
    };
    let checked = stochc_compiler::check("log.sa", &mut reader, Default::default());
    assert!(!checked.has_errors(), "{text}");
    let executables = checked.programs.into_iter();
    let executables = executables.map(|program| program.into_executable().unwrap());
    executables
        .map(|it| EnsembleProgram::new(&it.tables.assembly.clone(), Vec::new(), it))
        .collect()
}

/// Returns the runs of a log.
fn read_log(bytes: &[u8], program: &EnsembleProgram) -> Result<Vec<RunRecord>, LogError> {
    let log = ExperimentLog::new(bytes, program)?;
    let manifest = log.manifest()?;
    let records: Vec<RunRecord> = log.records()?.collect::<Result<_, _>>()?;
    assert_eq!(records.len() as u64, manifest.runs);
    Ok(records)
}

/// Returns the program of a file in the folder `examples`.
pub fn example(file: &str) -> EnsembleProgram {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    program(&fs::read_to_string(path.join(file)).unwrap())
}

fn program(text: &str) -> EnsembleProgram {
    programs(text).remove(0)
}

/// Returns runs of a program, or nothing if its model does not support it.
fn runs(program: &EnsembleProgram, settings: &Settings, runs: u64) -> Vec<RunRecord> {
    let mut watch = |_, _| ControlFlow::Continue(());
    let run = |run| program.run(settings, 1, run, &mut watch).ok();
    let mut records: Vec<RunRecord> = (0..runs).map_while(run).collect();
    records.retain(is_loggable);
    records
}

/// Checks that the log of some runs gives the same records.
#[track_caller]
fn assert_same(program: &EnsembleProgram, records: &[RunRecord], detail: Detail) {
    if records.is_empty() {
        return;
    }
    let expected: Vec<RunRecord> = records.iter().map(without_physics).collect();
    for log in [
        csv(records, program, detail),
        json_lines(records, program, detail),
    ] {
        let read = read_log(log.as_bytes(), program);
        let read = read.unwrap_or_else(|error| panic!("{}: {error}\n{log}", program.name));
        let found: Vec<RunRecord> = read.iter().map(without_physics).collect();
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found, expected, "{}\n{log}", program.name);
        }
        assert_eq!(found.len(), expected.len());
    }
}

#[test]
fn logs_of_all_examples_give_the_same_records() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut tested = 0;
    for file in fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "sa") {
            continue;
        }
        for program in programs(&fs::read_to_string(path).unwrap()) {
            if program.tables().aggregate.is_some() || program.captures() > 400 {
                continue;
            }
            for model in [Model::Shuffle, Model::Rate] {
                for max_ticks in [None, Some(40), Some(3000)] {
                    let settings = Settings {
                        max_ticks: max_ticks.or(Some(400_000)),
                        ..Settings::new(model, 1)
                    };
                    let records = runs(&program, &settings, 4);
                    assert_same(&program, &records, Detail::All);
                    tested += records.len();
                    if program.scene.messages.is_none()
                        && records.iter().all(|it| it.aborts.is_empty())
                    {
                        assert_same(&program, &records, Detail::Events);
                    }
                }
            }
        }
    }
    assert!(tested > 150, "{tested}");
}

/// Program with slow and lost messages, a pre-attached block, times, and retries.
const TIMED: &str = "scene slow from hemisphere { messages { hop 3 ticks  loss 0.2 } }
assembly timed in slow {
    seed plate 3 x 1 { A at (0, 0)  B at (2, 0)  A.up -> S }
    phase grow { S.up -> C  B.up -> D.up -> E  C.up -> G }
    phase swap { release E after 40 ticks  D.east -> H after release E }
    phase settle { wait 30 ticks }
    phase last timeout 23 ticks { C.east -> X.east -> Y.east -> Z } on timeout {
        release last  wait 5 ticks  retry 3
    }
}";

#[test]
fn logs_contain_times_retries_and_slow_messages() {
    let program = program(TIMED);
    let records = runs(&program, &Settings::new(Model::Shuffle, 1), 60);
    assert_same(&program, &records, Detail::All);
    let some = |is: fn(&RunRecord) -> bool| records.iter().any(is);
    assert!(some(|it| it.outcome == Outcome::Completed));
    assert!(some(|it| it
        .aborts
        .iter()
        .any(|abort| abort.retried.is_some())));
    assert!(some(
        |it| it.aborts.len() == 3 && it.outcome != Outcome::Completed
    ));
}

/// Tower whose phases and blocks have short names.
const TOWER: &str = "assembly tower {
    seed plate 2 x 1 { A at (0, 0)  B at (1, 0) }
    phase feet { A.up -> C }
    phase tops { B.up -> D  C.up -> E.up -> F after D }
}";

/// Log of a complete run of [`TOWER`].
const LOG: &str = "run,seconds,event,block,by
0,1,captured,C,A.up
0,2.5,captured,D,B.up
0,3,captured,E,C.up
0,4,captured,F,E.up
0,4,end,,
";

fn read(log: &str) -> Result<Vec<RunRecord>, String> {
    let read = read_log(log.as_bytes(), &program(TOWER));
    read.map_err(|error| error.to_string())
}

#[test]
fn logs_may_contain_the_numbers_of_the_firmware() {
    let program = example("five_tower_retried.sa");
    let settings = Settings::new(Model::Shuffle, 1);
    let records = runs(&program, &settings, 5);
    let tables = program.tables();
    let role = |name: &str| tables.roles.iter().position(|role| role.name == name);
    let phase = |name: &str| tables.phases.iter().position(|phase| phase.name == name);
    let numbered = |text: &str| {
        if let Some((block, face)) = text.rsplit_once('.') {
            let face = Face::from_word(face).unwrap() as u8;
            return format!("{}.{face}", role(block).unwrap());
        }
        let number = role(text).or_else(|| phase(text));
        number.map_or(String::new(), |it| it.to_string())
    };
    let mut log = String::new();
    for line in json_lines(&records, &program, Detail::All).lines() {
        let mut row: serde_json::Value = serde_json::from_str(line).unwrap();
        for key in ["block", "by"] {
            row[key] = numbered(row[key].as_str().unwrap()).into();
        }
        log += &format!("{row}\n");
    }
    let read = read_log(log.as_bytes(), &program).unwrap();
    let [found, expected] = [&read, &records].map(|it| it.iter().map(without_physics));
    assert!(found.eq(expected), "{log}");
    let row = "run,ticks,event,block,by\n0,1,captured,99,A.up\n";
    let error = read_log(row.as_bytes(), &program).unwrap_err().to_string();
    assert!(error.contains("no block `99`"), "{error}");
}

#[test]
fn a_run_without_its_end_is_censored_at_its_last_row() {
    let whole = read(LOG).unwrap();
    assert_eq!(whole[0].outcome, Outcome::Completed);
    let cut: String = LOG.split_inclusive('\n').take(3).collect();
    let cut = read(&cut).unwrap().remove(0);
    let censored = |outcome: &Outcome| match outcome {
        Outcome::TimedOut {
            phase,
            by: Limit::MaxTicks,
        } => Some(phase.0),
        _ => None,
    };
    let tick = program(TOWER).scene.tick;
    assert_eq!(
        (censored(&cut.outcome), cut.ticks),
        (Some(1), (2.5 / tick).round() as u64)
    );
    assert_eq!(cut.waiting.len(), 1);
    // A row `end` may state a later time.
    let later = read("run,seconds,event,block,by\n0,1,captured,C,A.up\n0,600,end,,\n");
    let later = later.unwrap().remove(0);
    assert_eq!(
        (censored(&later.outcome), later.ticks),
        (Some(1), (600.0 / tick).round() as u64)
    );
}

#[test]
fn times_count_from_a_first_row_of_a_phase() {
    let log = "run,seconds,event,block,by
0,1700000000.5,phase,feet,
0,1700000002.5,captured,C,A.up
";
    let record = read(log).unwrap().remove(0);
    let two_seconds = (2.0 / program(TOWER).scene.tick).round() as u64;
    assert_eq!(record.bonds[0].docked, two_seconds);
}

#[test]
fn wrong_rows_are_rejected_with_their_line() {
    let replaced = |line: usize, row: &str| {
        let mut lines: Vec<&str> = LOG.lines().collect();
        lines[line - 1] = row;
        read(&lines.join("\n")).unwrap_err()
    };
    let mut errors = String::new();
    for (line, row) in [
        (1, "run,seconds,event,block"),
        (1, "run,seconds,event,block,by,colour"),
        (1, "run,seconds,event,block,by,x"),
        (2, "0,1,captured,C"),
        (2, "x,1,captured,C,A.up"),
        (2, "1,1,captured,C,A.up"),
        (2, "0,-1,captured,C,A.up"),
        (2, "0,NaN,captured,C,A.up"),
        (2, "0,1,capture,C,A.up"),
        (2, "0,1,captured,X,A.up"),
        (2, "0,1,captured,C,A"),
        (2, "0,1,captured,C,A.east"),
        (2, "0,1,captured,,A.up"),
        (2, "0,1,captured,C,"),
        (2, "0,1,captured,D,B.up"),
        (2, "0,1,released,C,"),
        (2, "0,1,phase,tops,"),
        (2, "0,1,timeout,tops,"),
        (2, "0,1,timeout,feet,"),
        (2, "0,1,timeout,,"),
        (2, "0,1,phase,topz,"),
        (3, "0,0.5,captured,D,B.up"),
        (3, "0,2,captured,C,A.up"),
        (3, "0,2,captured,F,E.up"),
        (3, "2,2,captured,C,A.up"),
        (5, "0,3.5,end,,"),
    ] {
        errors += &format!("{row}\n    {}\n", replaced(line, row));
    }
    for log in [
        "",
        "run,ticks,event,block,by\n",
        "run,event,block,by\n",
        "run,ticks,event,block,by\n0,12.4,end,,\n",
        "run,ticks,event,block,by\n0,1,end,,\n1,1,end,,\n0,2,end,,\n",
        "[{\"run\":0}]",
        "{\"run\":0}",
        "{\"run\":0,\n",
        "{\"colour\":0}",
        "{\"run\":0,\"seconds\":1,\"ticks\":1}",
    ] {
        errors += &format!("{log:?}\n    {}\n", read(log).unwrap_err());
    }
    insta::assert_snapshot!(errors);
}

#[test]
fn programs_without_names_or_phases_have_no_log() {
    let seeds = program("assembly seeds { seed plate 1 x 1 { A at (0, 0)  A.up -> B } }");
    let error = read_log(LOG.as_bytes(), &seeds).unwrap_err().to_string();
    assert!(error.contains("`seeds` has no phase"), "{error}");
    let group = program("aggregate pair in magnet_tank to 2");
    let error = read_log(LOG.as_bytes(), &group).unwrap_err().to_string();
    assert!(error.contains("`pair` is an aggregate"), "{error}");
}

#[test]
fn numbers_of_blocks_are_checked() {
    let with = |body: &str| {
        let log = format!(
            "run,ticks,event,block,by,body\n0,10,captured,C,A.up,7\n0,20,captured,D,B.up,{body}\n"
        );
        read(&log)
    };
    assert_eq!(with("8").unwrap()[0].bonds[1].body, 8);
    assert_eq!(with("").unwrap()[0].bonds[1].body, 0);
    let refused = ["7", "300"].map(|body| with(body).unwrap_err());
    assert_eq!(
        refused,
        [
            "line 3: block 7 is attached already; log its release first, or leave out the column `body`",
            "line 3: block 300 does not exist: the scene has blocks 0 to 299",
        ]
    );
}

proptest! {
    /// Random bytes and changed logs never cause a panic.
    #[test]
    fn random_logs_are_rejected_or_read(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        at in any::<prop::sample::Index>(),
        length in 0..20_usize,
        is_json in any::<bool>(),
    ) {
        let tower = program(TOWER);
        let _ = read_log(&bytes, &tower);
        let log = if is_json {
            let records = read_log(LOG.as_bytes(), &tower).unwrap();
            json_lines(&records, &tower, Detail::All)
        } else {
            LOG.to_owned()
        };
        let mut changed = log.into_bytes();
        let at = at.index(changed.len());
        let end = (at + length).min(changed.len());
        changed.splice(at..end, bytes.iter().copied().take(length));
        let _ = read_log(&changed, &tower);
    }
}
