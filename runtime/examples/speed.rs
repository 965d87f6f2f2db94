//! Cost of one block in one tick: `cargo run --release -p stochc-runtime --example speed -- MODEL BLOCKS TICKS`.
use stochc_compiler::scene::{Enclosure, built_in};
use stochc_compiler::table::Plate;
use stochc_runtime::world::Arena;
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::{Model, Precision, Settings};

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let count = args[2].parse().expect("a number of blocks");
    let ticks = args[3].parse().expect("a number of ticks");
    let (ns, rms) = match args[1].as_str() {
        "rapier" => time::<RapierWorld>(count, ticks, Precision::Single),
        "double" => time::<RigidWorld>(count, ticks, Precision::Double),
        _ => time::<RigidWorld>(count, ticks, Precision::Single),
    };
    println!(
        "{} {count} blocks: {ns:.1} ns per block and tick, rms speed {rms:.4}",
        args[1]
    );
}

#[expect(clippy::disallowed_methods, reason = "it measures time")]
fn time<W: Arena>(count: u32, ticks: u64, precision: Precision) -> (f64, f64) {
    let mut scene =
        built_in(std::env::var("SCENE").as_deref().unwrap_or("hemisphere")).expect("built in");
    let grow = (f64::from(count) / 300.0).cbrt();
    scene.free.count = count;
    if let Some(Enclosure::Hemisphere { radius, .. }) = &mut scene.enclosure {
        *radius *= grow;
    }
    let settings = Settings {
        precision,
        substeps: std::env::var("SUB").map_or(1, |s| s.parse().unwrap()),
        ..Settings::of(Model::Rigid, 1)
    };
    let mut world = W::new(&scene, &Plate { width: 3, depth: 3 }, &settings, 1, 0).expect("fits");
    let mut none = Vec::new();
    for _ in 0..500 {
        world.step(&mut none).expect("sound");
    }
    let start = std::time::Instant::now();
    for _ in 0..ticks {
        world.step(&mut none).expect("sound");
    }
    let ns = start.elapsed().as_secs_f64() * 1e9 / (ticks * u64::from(count)) as f64;
    let squares = (0..count).map(|i| world.state(i).velocity.norm_squared());
    (ns, (squares.sum::<f64>() / f64::from(count)).sqrt())
}
