//! How far plans of small shapes are off the best there are.
use stochc::ir::scene::Scene;
use stochc::ir::table::Plate;
use stochc::ir::{Cell, Face};
use stochc::planner::{
    AdaptiveGap, Hardware, PlanSearch, RateLaw, ScheduleGap, Target, adaptive_gap, gap,
};
use stochc::planning::Goal;

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
    Goal::of_cells("any", Vec::new()).scene().unwrap()
}

/// A shape on a plate, and how it is looked at.
fn posed<T>(
    scene: &Scene,
    cells: Vec<Cell>,
    rounds: u64,
    of: impl Fn(&Target, Hardware, &RateLaw<'_>, PlanSearch<'_>) -> T,
) -> T {
    let plate = Plate { width: 3, depth: 3 };
    let target = Target::new(cells, plate, None, scene.free.count).unwrap();
    let search = PlanSearch {
        rounds,
        ..PlanSearch::default()
    };
    of(
        &target,
        Hardware::of(scene),
        &RateLaw::of(scene, &[]),
        search,
    )
}

fn gap_of(scene: &Scene, cells: Vec<Cell>, rounds: u64) -> ScheduleGap {
    let found = posed(scene, cells, rounds, gap);
    found.unwrap().expect("the shape is small")
}

fn adaptive_gap_of(scene: &Scene, cells: Vec<Cell>, rounds: u64) -> AdaptiveGap {
    let found = posed(scene, cells, rounds, adaptive_gap);
    found.unwrap().expect("the shape is small")
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
