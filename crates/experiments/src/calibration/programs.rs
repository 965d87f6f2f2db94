//! Programs whose runs are observed for a calibration.
use stochc_ir::scene::Scene;

/// Programs for scenes whose terms are all part of the rate law, as name and source.
///
/// In each program, a structure grows. Observing single blocks next to a fixed structure would give
/// errors of 5 to 10 %.
pub const PROGRAMS: [(&str, &str); 25] = [
    ("towers", include_str!("programs/towers.sa")),
    ("wall", include_str!("programs/wall.sa")),
    ("corner", include_str!("programs/corner.sa")),
    ("slot", include_str!("programs/slot.sa")),
    ("arms", include_str!("programs/arms.sa")),
    ("floor", include_str!("programs/floor.sa")),
    ("pairs", include_str!("programs/pairs.sa")),
    ("spread", include_str!("programs/spread.sa")),
    ("drop", include_str!("programs/drop.sa")),
    ("lift", include_str!("programs/lift.sa")),
    ("pile", include_str!("programs/pile.sa")),
    ("stagger", include_str!("programs/stagger.sa")),
    ("quincunx", include_str!("programs/quincunx.sa")),
    ("gap", include_str!("programs/gap.sa")),
    ("solid", include_str!("programs/solid.sa")),
    ("late", include_str!("programs/late.sa")),
    ("alone", include_str!("programs/alone.sa")),
    ("apart", include_str!("programs/apart.sa")),
    ("row", include_str!("programs/row.sa")),
    ("hook", include_str!("programs/hook.sa")),
    ("crossbar", include_str!("programs/crossbar.sa")),
    ("winding", include_str!("programs/winding.sa")),
    ("posts", include_str!("programs/posts.sa")),
    ("sheet", include_str!("programs/sheet.sa")),
    ("fin", include_str!("programs/fin.sa")),
];

/// Small programs for other scenes in space. Their structures fit into small tanks and need few
/// free blocks.
const SMALL: [(&str, &str); 16] = [
    ("lone", include_str!("programs/small/lone.sa")),
    ("post", include_str!("programs/small/post.sa")),
    ("side", include_str!("programs/small/side.sa")),
    ("apart", include_str!("programs/small/apart.sa")),
    ("neighbours", include_str!("programs/small/neighbours.sa")),
    ("beside", include_str!("programs/small/beside.sa")),
    ("column", include_str!("programs/small/column.sa")),
    ("arm", include_str!("programs/small/arm.sa")),
    ("middle", include_str!("programs/small/middle.sa")),
    ("step", include_str!("programs/small/step.sa")),
    ("star", include_str!("programs/small/star.sa")),
    ("turns", include_str!("programs/small/turns.sa")),
    ("moved", include_str!("programs/small/moved.sa")),
    ("aside", include_str!("programs/small/aside.sa")),
    ("posts", include_str!("programs/small/posts.sa")),
    ("zigzag", include_str!("programs/small/zigzag.sa")),
];

/// Returns the source of a planar program, with a planar scene.
macro_rules! planar {
    ($name:literal) => {
        concat!(
            include_str!("programs/planar/scene.sa"),
            include_str!(concat!("programs/planar/", $name, ".sa"))
        )
    };
}

/// Programs for planar worlds.
const PLANAR: [(&str, &str); 15] = [
    ("line", planar!("line")),
    ("sideways", planar!("sideways")),
    ("apart", planar!("apart")),
    ("ell", planar!("ell")),
    ("tee", planar!("tee")),
    ("bar", planar!("bar")),
    ("cross", planar!("cross")),
    ("turns", planar!("turns")),
    ("beside", planar!("beside")),
    ("pair", planar!("pair")),
    ("wide", planar!("wide")),
    ("square", planar!("square")),
    ("moved", planar!("moved")),
    ("stairs", planar!("stairs")),
    ("again", planar!("again")),
];

/// Returns the programs for a scene, as name and source.
pub fn programs(scene: &Scene) -> &'static [(&'static str, &'static str)] {
    match scene.uncalibrated_term() {
        None => &PROGRAMS,
        Some(_) if scene.planar.is_some() => &PLANAR,
        Some(_) => &SMALL,
    }
}
