//! The interpreters and the control do the same.
use proptest::prelude::*;
use stochc_compiler::check;
use stochc_firmware::{Image, Unsupported};
use stochc_ir::table::Tables;

use crate::driver::run;
use crate::host::{Channel, Host, ROOT};
use crate::random::{Reuse, declare_with};

/// Largest number of captures of an example in this test.
const LARGEST: usize = 400;

fn examples() -> Vec<(String, Tables)> {
    let mut examples = Vec::new();
    let mut folders = vec![format!("{ROOT}/../examples")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path().display().to_string();
            if std::fs::metadata(&path).unwrap().is_dir() {
                folders.push(path);
            } else if path.ends_with(".sa") {
                let checked = check(
                    &path,
                    &mut |path: &str| std::fs::read(path),
                    Default::default(),
                );
                let programs = checked.programs.into_iter();
                let tables = programs.filter_map(|program| program.tables);
                examples.extend(tables.map(|tables| (path.clone(), tables)));
            }
        }
    }
    examples.sort_by(|a, b| a.0.cmp(&b.0));
    examples
}

/// Lets times pass during captures and messages. `all` are the phases without retries, too.
fn shorten(tables: &mut Tables, timeout: u64, all: bool) {
    for phase in &mut tables.phases {
        phase.wait = phase.wait.min(50);
        if phase.recovery.is_some() || all {
            phase.timeout = Some(timeout).filter(|_| !phase.pre_attached);
        }
        if let Some(recovery) = &mut phase.recovery {
            recovery.pause = recovery.pause.min(20);
        }
    }
}

#[test]
fn every_example_is_built_in_the_same_order_of_events() {
    let mut host = Host::new();
    let mut built = 0;
    let (mut retried, mut delayed, mut timed_out) = (0, 0, 0);
    for (path, tables) in examples() {
        let image = Image::new(&tables);
        if matches!(image, Err(Unsupported::Aggregate)) || tables.captures() > LARGEST {
            continue;
        }
        for (loss, noise) in [(0, 0), (10, 0), (10, 50)] {
            for (seed, (timeout, all)) in (0..).zip([(60, false), (4000, false), (60, true)]) {
                let mut tables = tables.clone();
                shorten(&mut tables, timeout, all);
                let channel = Channel { loss, noise, seed };
                match run(&tables, &mut host, channel) {
                    Ok(outcome) => {
                        retried += outcome.retries;
                        delayed += outcome.delayed;
                        timed_out += usize::from(outcome.timed_out);
                    }
                    Err(error) => panic!("{path} {}: {channel:?}: {error}", tables.assembly),
                }
            }
        }
        built += 1;
    }
    println!("{built} examples: {retried} retries, {delayed} delays, {timed_out} timeouts");
    assert!(built > 5 && retried > 9 && delayed > 5 && timed_out > 9);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn random_programs_are_built_in_the_same_order_of_events(
        choices in prop::collection::vec(any::<u32>(), 0..160),
        reuse in prop::sample::select(vec![Reuse::Later, Reuse::AtOnce]),
        faces in 1u8..=5,
        loss in prop::sample::select(vec![0, 5, 30]),
        noise in prop::sample::select(vec![0, 100]),
        timeout in prop::sample::select(vec![3, 20, 60, 200, 2000]),
        all in prop::bool::weighted(0.25),
        seed: u64,
    ) {
        thread_local! {
            static HOST: std::cell::RefCell<Host> = std::cell::RefCell::new(Host::new());
        }
        let declared = declare_with(reuse, choices, faces);
        let mut tables = declared.tables();
        shorten(&mut tables, timeout, all);
        let channel = Channel { loss, noise, seed };
        let result = HOST.with_borrow_mut(|host| run(&tables, host, channel));
        prop_assert!(result.is_ok(), "{:?} {}", result, declared.text);
    }
}
