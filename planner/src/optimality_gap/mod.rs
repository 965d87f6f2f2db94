//! How far plans of small shapes are off the best there are.
mod adaptive;
mod programs;

use stochc_compiler::scene::built_in;
use stochc_ir::scene::Scene;
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};

use crate::makespan::Samples;
use crate::scheduling::value;
use crate::search::{
    FoundSchedule, OTHER_CHANCES, OTHER_RUNS, branch_and_bound, heuristic, search,
};
use crate::sites::Sites;
use crate::{Hardware, PlanSearch, RateLaw, Target};
use adaptive::{ExactTimes, MOST_ADAPTIVE};
use programs::FixedProgram;

/// States that are looked at, in all trees of captures, to say what no program can be faster than: each site is absent, open or there.
const MOST_STATES: usize = 2_000_000;

/// How far the search that tries is off the best of all schedules.
#[derive(Clone, Copy, Debug)]
struct ScheduleGap {
    /// How long the schedule takes that it finds \[ticks\].
    heuristic: f64,
    /// How long the best one takes that is known \[ticks\].
    best: f64,
    /// Whether all schedules have been looked at.
    is_finished: bool,
}

/// How far a plan is off the best program and the best policies, if waits are exponential. All are mean times \[ticks\].
#[derive(Clone, Copy, Debug)]
struct AdaptiveGap {
    /// Of the plan.
    planned: f64,
    /// Of the best program that was found.
    program: f64,
    /// Less than of any program; `None`: there are too many trees of captures to say.
    fixed: Option<f64>,
    /// Of the best policy that sees every docking.
    policy: f64,
    /// Of the best policy that does, and need not keep ways in open.
    heedless: f64,
}

/// A shape of so many cells that hang together, from a number.
fn shape(count: usize, number: u32) -> Vec<Cell> {
    let mut state = number.wrapping_mul(2_654_435_761) | 1;
    let mut draw = |most: usize| {
        // Xorshift.
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state as usize % most
    };
    let mut cells = vec![Cell::new(1, 1, 1)];
    while cells.len() < count {
        let from = cells[draw(cells.len())];
        let next = from.across(Face::ALL[draw(6)]).unwrap();
        if next.z >= 1 && !cells.contains(&next) {
            cells.push(next);
        }
    }
    cells
}

fn scene() -> Scene {
    built_in("hemisphere").unwrap()
}

/// A shape on a plate, and how it is looked at.
fn posed<T>(
    scene: &Scene,
    cells: Vec<Cell>,
    rounds: u64,
    of: impl Fn(&Sites<'_>, Hardware, &RateLaw<'_>, PlanSearch<'_>) -> T,
) -> T {
    let plate = Plate { width: 3, depth: 3 };
    let target = Target::new(cells, plate, None, scene.free.count).unwrap();
    let how = PlanSearch {
        rounds,
        ..PlanSearch::default()
    };
    let waits = RateLaw::of(scene, &[]);
    of(&Sites::of(&target), Hardware::of(scene), &waits, how)
}

/// Compares the search that tries with the best of all schedules.
fn gap_of(scene: &Scene, cells: Vec<Cell>, rounds: u64) -> ScheduleGap {
    posed(scene, cells, rounds, |sites, hardware, waits, how| {
        // By the chances by which the better one is chosen.
        let samples = Samples::new(sites.len(), OTHER_RUNS, how.seed ^ OTHER_CHANCES);
        let value = |found: &FoundSchedule| {
            let job = found.job(sites, hardware, waits);
            value(&job, &samples, &found.schedule, how.objective)
        };
        let mut found = heuristic(sites, hardware, waits, how).unwrap();
        let heuristic = value(&found);
        let is_finished = branch_and_bound(sites, hardware, waits, how, &mut found).unwrap();
        ScheduleGap {
            heuristic,
            best: value(&found),
            is_finished,
        }
    })
}

/// Compares a plan with the best program and the best policies.
fn adaptive_gap_of(scene: &Scene, cells: Vec<Cell>, rounds: u64) -> AdaptiveGap {
    assert!(cells.len() <= MOST_ADAPTIVE);
    posed(scene, cells, rounds, |sites, hardware, waits, how| {
        let found = search(sites, hardware, waits, how).unwrap();
        let job = found.job(sites, hardware, waits);
        let mut heedless = ExactTimes::new(&job, false);
        // Where a plan has narrow ways, others may as well.
        let mut times = ExactTimes::new(&job, found.disassembly.narrow_count() == 0);
        let planned = FixedProgram::of(&times, &found.schedule);
        AdaptiveGap {
            planned: times.of(&planned),
            program: times.best_program(&found.schedule, how.seed),
            fixed: times.best_fixed(MOST_STATES / 3usize.pow(sites.len() as u32)),
            policy: times.best(),
            heedless: heedless.best(),
        }
    })
}

#[test]
fn whoever_may_do_more_is_no_slower() {
    let scene = scene();
    for number in 0..8 {
        let gap = adaptive_gap_of(&scene, shape(5, number), 100);
        let fixed = gap.fixed.expect("there are few trees of five cells");
        let times = [gap.heedless, gap.policy, fixed, gap.program, gap.planned];
        assert!(
            times.windows(2).all(|two| two[0] <= two[1] * (1.0 + 1e-9)),
            "{number}: {gap:?}"
        );
        assert!(gap.heedless > 0.5 * gap.planned, "{number}: {gap:?}");
    }
}

#[test]
fn all_schedules_of_small_shapes_are_looked_at() {
    let scene = scene();
    for number in 0..12 {
        let ScheduleGap {
            heuristic,
            best,
            is_finished,
        } = gap_of(&scene, shape(5, number), 400);
        assert!(is_finished, "{number}");
        assert!(best <= heuristic, "{number}: {best} {heuristic}");
    }
}

/// Shapes by which the search was not chosen.
const OTHERS: u32 = 5000;

/// The numbers of docs/planner.md.
#[test]
#[ignore = "takes minutes"]
fn gaps() {
    let scene = scene();
    for (cells, shapes) in [(6, 60), (7, 40), (8, 20)] {
        let found: Vec<ScheduleGap> = (0..shapes)
            .map(|number| gap_of(&scene, shape(cells, OTHERS + number), 3000))
            .collect();
        let finished: Vec<f64> = (found.iter().filter(|gap| gap.is_finished))
            .map(|gap| gap.heuristic / gap.best - 1.0)
            .collect();
        println!(
            "{cells} cells: of {shapes} shapes {} finished; by trying {:.2} % over the best on average, {:.2} % at most",
            finished.len(),
            100.0 * finished.iter().sum::<f64>() / finished.len().max(1) as f64,
            100.0 * finished.iter().copied().fold(0.0, f64::max),
        );
    }
    for (cells, shapes) in [(6, 40), (7, 40), (8, 20), (9, 12), (10, 8)] {
        let found: Vec<AdaptiveGap> = (0..shapes)
            .map(|number| adaptive_gap_of(&scene, shape(cells, OTHERS + number), 3000))
            .collect();
        println!("{cells} cells, {shapes} shapes, on average and at most:");
        let told = |what: &str, over: &dyn Fn(&AdaptiveGap) -> Option<f64>| {
            let over: Vec<f64> = found.iter().filter_map(over).collect();
            println!(
                "  {what}: {:.1} %, {:.1} % ({})",
                100.0 * over.iter().sum::<f64>() / over.len() as f64,
                100.0 * over.iter().copied().fold(0.0, f64::max),
                over.len()
            );
        };
        told("keeping ways over none", &|it| {
            Some(it.policy / it.heedless - 1.0)
        });
        told("decided beforehand, over a policy", &|it| {
            Some(it.fixed? / it.policy - 1.0)
        });
        told("the best program over that", &|it| {
            Some(it.program / it.fixed? - 1.0)
        });
        told("plans over the best program", &|it| {
            Some(it.planned / it.program - 1.0)
        });
        told("plans over the best policy", &|it| {
            Some(it.planned / it.policy - 1.0)
        });
    }
}
