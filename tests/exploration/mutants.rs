//! Tables with a mistake are found out.
use std::collections::BTreeMap;

use stochc::compiler::diagnostic::Code;
use stochc::ir::table::{Action, Condition, LooseDuty, News, Tables};
use stochc::protocol::explore::{
    Exploration, ExplorationBounds, ExplorationReport, Faults, ProgramGoals, Property,
};

use crate::programs::{BUSY, tables, tables_of};

fn duties(tables: &Tables) -> Vec<LooseDuty> {
    (tables.duties())
        .map(|duty| {
            let rules = duty.rules().map(|rule| (rule.when.to_vec(), rule.then));
            (duty.role, duty.phase, duty.trigger, rules.collect())
        })
        .collect()
}

fn assemble(tables: &Tables, duties: Vec<LooseDuty>) -> Tables {
    Tables::assemble(
        tables.assembly.clone(),
        tables.faces,
        tables.plate.clone(),
        tables.phases.clone(),
        tables.roles.clone(),
        duties,
    )
}

/// Explores tables that are meant to do what others do, in full and reduced.
fn explore_twice(mutant: &Tables, original: &Tables) -> [ExplorationReport; 2] {
    let (expected, bounds) = (ProgramGoals::new(original), ExplorationBounds::default());
    let faults = Faults::default();
    [true, false].map(|reduce| {
        let mut exploration = Exploration::new(mutant, &expected, bounds, faults);
        exploration.reduce = reduce;
        exploration.run()
    })
}

/// Every program that comes from another by one mistake, with what the mistake is.
fn mutants(tables: &Tables) -> Vec<(String, Tables)> {
    let all = duties(tables);
    let mut mutants = Vec::new();
    for (i, (role, _, _, rules)) in all.iter().enumerate() {
        let name = tables.name(*role);
        for (k, (when, then)) in rules.iter().enumerate() {
            let mut less = all.clone();
            less[i].3.remove(k);
            mutants.push((format!("{name} without {then:?}"), assemble(tables, less)));
            for (c, condition) in when.iter().enumerate() {
                let mut rash = all.clone();
                rash[i].3[k].0.remove(c);
                let mistake = format!("{name} does {then:?} without {condition:?}");
                mutants.push((mistake, assemble(tables, rash)));
            }
            if *then == Action::Report {
                let mut twice = all.clone();
                twice[i].3.push((when.clone(), Action::Report));
                mutants.push((format!("{name} reports twice"), assemble(tables, twice)));
            } else {
                let mut early = all.clone();
                early[i].3.insert(0, (Vec::new(), Action::Report));
                mutants.push((format!("{name} reports early"), assemble(tables, early)));
            }
        }
    }
    for (i, phase) in tables.phases.iter().enumerate() {
        let mut fewer = assemble(tables, all.clone());
        fewer.phases[i].reports -= 1;
        mutants.push((format!("{} ends one report early", phase.name), fewer));
        let mut more = assemble(tables, all.clone());
        more.phases[i].reports += 1;
        mutants.push((format!("{} waits for one more", phase.name), more));
    }
    mutants
}

#[test]
fn every_mistake_that_matters_is_found_with_and_without_the_reduction() {
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
fn what_is_found_is_told_in_the_programs_own_names() {
    let [original] = &tables_of("examples/five_tower.sa")[..] else {
        panic!("one assembly");
    };
    // F reports as soon as it is anchored, although it still captures J.
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
            when.retain(|condition| !matches!(condition, Condition::Heard(News::Released(_))));
        }
    }
    let [reduced, full] = explore_twice(&assemble(&original, rash), &original);
    for report in [reduced, full] {
        let violation = report.violation().unwrap();
        let both = [Property::OneHolder, Property::Order];
        assert!(both.contains(&violation.property), "{violation}");
    }
}

/// What is forgotten altogether is not seen in the tables themselves: they are held against the graph.
#[test]
fn no_mistake_of_the_compiler_reaches_a_user() {
    let mut checked = stochc::check("examples/five_tower_reconfigured.sa");
    assert!(!checked.has_errors());
    let right = checked.programs[0].tables.clone().unwrap();
    let mut count = 0;
    for (mistake, mutant) in mutants(&right) {
        let [report, _] = explore_twice(&mutant, &right);
        let Some(found) = report.violation() else {
            continue;
        };
        // Who reports is read off the tables, and the phase may end as it should all the same.
        if found.property == Property::ReportsOnce {
            continue;
        }
        checked.diagnostics.clear();
        checked.programs[0].tables = Some(mutant);
        stochc::model_check::try_out(&mut checked);
        let [diagnostic] = &checked.diagnostics[..] else {
            panic!("{mistake}: {:?}", checked.diagnostics);
        };
        assert_eq!(diagnostic.code, Code::InternalError, "{mistake}");
        assert!(checked.programs[0].tables.is_none(), "{mistake}");
        let steps = diagnostic.help.as_ref().unwrap().lines().count() - 1;
        assert!(steps <= found.trace.len(), "{mistake}: {diagnostic:#?}");
        count += 1;
    }
    assert!(count > 40, "{count}");
}
