//! Examples, which programs may import.

macro_rules! examples {
    ($($name:literal)*) => {
        /// Path of each example below `examples/`, and its text.
        pub const EXAMPLES: &[(&str, &str)] = &[
            $(($name, include_str!(concat!("../../../examples/", $name)))),*
        ];
    };
}

examples! {
    "gate.sa"
    "line.sa"
    "open_platform.sa"
    "closed_platform.sa"
    "five_tower.sa"
    "five_tower_reconfigured.sa"
    "experiment_1.sa"
    "experiment_2.sa"
    "experiment_3.sa"
    "suction_growth.sa"
    "microns.sa"
    "lab/bowl.sa"
    "lab/tank.sa"
    "lab/air_table.sa"
    "planned/chair.sa"
    "planned/five_towers.sa"
    "planned/serpentine.sa"
}
