//! Checks that mistakes in tables are detected.
use std::collections::BTreeMap;

use stochc_control::explore::Property;

use crate::mutations::{assemble, duties, explore_twice, mutants};
use crate::programs::{BUSY, tables, tables_of};
use stochc_ir::table::{Action, Condition, Notification};

#[test]
fn every_relevant_mutant_is_found() {
    let mut found: BTreeMap<Property, u32> = BTreeMap::new();
    let mut harmless: Vec<String> = Vec::new();
    let mut programs = tables_of("examples/five_tower_reconfigured.sa");
    programs.extend(tables_of("tests/fixtures/tower.sa"));
    programs.push(tables(BUSY));
    let (mut full_states, mut reduced_states) = (0, 0);
    for original in &programs {
        for (mistake, mutant) in mutants(original) {
            let [reduced, full] = explore_twice(&mutant, original);
            full_states += full.states;
            reduced_states += reduced.states;
            match (full.violation(), reduced.violation()) {
                (Some(violation), Some(_)) => *found.entry(violation.property).or_default() += 1,
                (None, None) => harmless.push(format!("{}: {mistake}", original.assembly)),
                (full, reduced) => panic!("{mistake}: {full:#?} in full, reduced {reduced:#?}"),
            }
        }
    }
    println!("{found:?}; {full_states} states in full, {reduced_states} reduced");
    for property in [
        Property::Order,
        Property::NoEarlyEnd,
        Property::NoHang,
        Property::ReportsOnce,
        Property::Faces,
    ] {
        assert!(found.contains_key(&property), "{property:?} of {found:?}");
    }
    insta::assert_snapshot!(harmless.join("\n"));
}

#[test]
fn violations_use_the_names_of_the_program() {
    let [original] = &tables_of("examples/five_tower.sa")[..] else {
        panic!("one assembly");
    };
    // F reports as soon as it is anchored, although it still has to capture J.
    let mut rash = duties(original);
    let f = rash
        .iter_mut()
        .find(|duty| original.name(duty.0) == "F")
        .unwrap();
    f.3.insert(0, (Vec::new(), Action::Report));
    let [reduced, _] = explore_twice(&assemble(original, rash), original);
    insta::assert_snapshot!(reduced.violation().unwrap());
}

#[test]
fn a_release_that_sets_a_block_adrift_is_found() {
    let original = tables(
        "assembly pair {
            seed plate 1 x 1 { M at (0, 0) }
            phase grow { M.up -> A.up -> B }
            phase shrink { release A, B }
        }",
    );
    let mut rash = duties(&original);
    for (_, _, _, rules) in &mut rash {
        for (when, then) in rules {
            if *then == Action::AskRelease {
                when.clear();
            }
        }
    }
    let [reduced, full] = explore_twice(&assemble(&original, rash), &original);
    for report in [reduced, full] {
        let violation = report.violation().unwrap();
        let both = [Property::NoneAdrift, Property::Order];
        assert!(both.contains(&violation.property), "{violation}");
    }
}

#[test]
fn a_second_block_of_one_name_is_found() {
    let original = tables(
        "assembly again {
            seed plate 2 x 1 { M at (0, 0)  N at (1, 0) }
            phase grow { M.up -> A }
            phase over { release A  N.up -> A }
        }",
    );
    let mut rash = duties(&original);
    for (_, _, _, rules) in &mut rash {
        for (when, _) in rules {
            when.retain(|condition| {
                !matches!(condition, Condition::Notified(Notification::Released(_)))
            });
        }
    }
    let [reduced, full] = explore_twice(&assemble(&original, rash), &original);
    for report in [reduced, full] {
        let violation = report.violation().unwrap();
        let both = [Property::OneHolder, Property::Order];
        assert!(both.contains(&violation.property), "{violation}");
    }
}
