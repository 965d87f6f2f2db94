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

/// Lets timeouts pass during captures and messages.
fn shorten(tables: &mut Tables, timeout: u64) {
    for phase in &mut tables.phases {
        if let Some(recovery) = &mut phase.recovery {
            phase.timeout = Some(timeout);
            recovery.pause = recovery.pause.min(20);
        }
    }
}

#[test]
fn every_example_is_built_in_the_same_order_of_events() {
    let mut host = Host::new();
    let mut built = 0;
    let mut retried = 0;
    for (path, mut tables) in examples() {
        shorten(&mut tables, 60);
        let image = Image::new(&tables);
        let is_unsupported = matches!(image, Err(Unsupported::Aggregate | Unsupported::Time(_)));
        if is_unsupported || tables.captures() > LARGEST {
            continue;
        }
        for (loss, noise) in [(0, 0), (10, 0), (10, 50)] {
            for seed in 0..3 {
                let channel = Channel { loss, noise, seed };
                let result = run(&tables, &mut host, channel);
                match result {
                    Ok(retries) => retried += retries,
                    Err(error) => panic!("{path} {}: {channel:?}: {error}", tables.assembly),
                }
            }
        }
        built += 1;
    }
    assert!(
        built > 5 && retried > 9,
        "{built} examples, {retried} retries"
    );
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
        timeout in prop::sample::select(vec![3, 20, 60, 200]),
        seed: u64,
    ) {
        thread_local! {
            static HOST: std::cell::RefCell<Host> = std::cell::RefCell::new(Host::new());
        }
        let declared = declare_with(reuse, choices, faces).without_times();
        let mut tables = declared.tables();
        shorten(&mut tables, timeout);
        let channel = Channel { loss, noise, seed };
        let result = HOST.with_borrow_mut(|host| run(&tables, host, channel));
        prop_assert!(result.is_ok(), "{:?} {}", result, declared.text);
    }
}
