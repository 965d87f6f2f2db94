//! Generates tables with one mistake.
use stochc_control::explore::{
    Exploration, ExplorationBounds, ExplorationReport, Faults, ProgramGoals,
};
use stochc_ir::table::{Action, LooseDuty, Tables};

pub fn duties(tables: &Tables) -> Vec<LooseDuty> {
    (tables.duties())
        .map(|duty| {
            let rules = duty.rules().map(|rule| (rule.when.to_vec(), rule.then));
            (duty.role, duty.phase, duty.trigger, rules.collect())
        })
        .collect()
}

pub fn assemble(tables: &Tables, duties: Vec<LooseDuty>) -> Tables {
    Tables::assemble(
        tables.assembly.clone(),
        tables.faces,
        tables.plate.clone(),
        tables.phases.clone(),
        tables.roles.clone(),
        duties,
    )
}

/// Explores mutated tables with the goals of the original, in full and reduced.
pub fn explore_twice(mutant: &Tables, original: &Tables) -> [ExplorationReport; 2] {
    let (expected, bounds) = (ProgramGoals::new(original), ExplorationBounds::default());
    let faults = Faults::default();
    [true, false].map(|reduce| {
        let mut exploration = Exploration::new(mutant, &expected, bounds, faults);
        exploration.reduce = reduce;
        exploration.run()
    })
}

/// Returns every variant of a program with one mistake, and the description of the mistake.
pub fn mutants(tables: &Tables) -> Vec<(String, Tables)> {
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
