//! Measures the cost of one block in one tick. Arguments: `MODEL BLOCKS TICKS [SUBSTEPS [SCENE]]`.
use stochc_compiler::scene::built_in;
use stochc_ir::scene::Enclosure;
use stochc_ir::table::Plate;
use stochc_runtime::world::SpatialWorld;
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::{Model, Precision, Settings};

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize| args.get(i).and_then(|word| word.parse::<u32>().ok());
    let (Some(model), Some(count), Some(ticks)) = (args.first(), number(1), number(2)) else {
        eprintln!("speed rigid|double|rapier BLOCKS TICKS [SUBSTEPS [SCENE]]");
        return;
    };
    let substeps = number(3).unwrap_or(1);
    let scene = args.get(4).map_or("hemisphere_2005", String::as_str);
    let time = match model.as_str() {
        "rapier" => time::<RapierWorld>,
        _ => time::<RigidWorld>,
    };
    let settings = Settings {
        precision: if model == "double" {
            Precision::Double
        } else {
            Precision::Single
        },
        ..Settings::new(Model::Rapier, substeps)
    };
    let (ns, rms) = time(scene, count, ticks, &settings);
    println!(
        "{model} {count} blocks, {substeps} steps a tick: {ns:.1} ns per block and tick, rms speed {rms:.4}"
    );
}

#[expect(clippy::disallowed_methods, reason = "it measures time")]
fn time<W: SpatialWorld>(scene: &str, count: u32, ticks: u32, settings: &Settings) -> (f64, f64) {
    let mut scene = built_in(scene).expect("a built-in scene");
    let grow = (f64::from(count) / 300.0).cbrt();
    scene.free.count = count;
    if let Some(Enclosure::Hemisphere { radius, .. }) = &mut scene.enclosure {
        *radius *= grow;
    }
    let plate = Plate { width: 3, depth: 3 };
    let mut world = W::new(&scene, &plate, settings, 1, 0).expect("fits");
    let mut none = Vec::new();
    for _ in 0..ticks.min(500) {
        world.step(&mut none).expect("a valid scene");
    }
    let start = std::time::Instant::now();
    for _ in 0..ticks {
        world.step(&mut none).expect("a valid scene");
    }
    let ns = start.elapsed().as_secs_f64() * 1e9 / (f64::from(ticks) * f64::from(count));
    let squares = (0..count).map(|i| world.state(i).velocity.norm_squared());
    (ns, (squares.sum::<f64>() / f64::from(count)).sqrt())
}
