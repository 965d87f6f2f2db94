//! All combinations of the values of several axes.
use stochc_ir::scene::Scene;
use stochc_ir::scene::scalars::find;
use stochc_ir::scene::schema::SchemaNumber;

use super::Axis;
use crate::Varied;

/// Programs that an ensemble may have by sweeping.
pub const MOST_POINTS: usize = 400;

/// The points of a scene, the last axis first to change; each has a value for every axis.
///
/// # Errors
/// In words, when the scene has no such number or may not have such a value, and when there are more
/// than [`MOST_POINTS`].
pub fn points(axes: &[Axis], scene: &Scene) -> Result<Vec<Vec<Varied>>, String> {
    let mut all: Vec<Vec<Varied>> = vec![Vec::new()];
    let mut seen: Vec<&str> = Vec::new();
    for axis in axes {
        let scalar = number(scene, &axis.name)?;
        if seen.contains(&scalar.name()) {
            return Err(format!("`{}` is swept twice", scalar.name()));
        }
        seen.push(scalar.name());
        let values = axis.values(scalar)?;
        let count = all.len().saturating_mul(values.len());
        if count > MOST_POINTS {
            return Err(format!(
                "these are {count} points or more, and {MOST_POINTS} is the most; ask for fewer values"
            ));
        }
        let longer = |point: Vec<Varied>| {
            let with = |value: &Varied| [&point[..], std::slice::from_ref(value)].concat();
            values.iter().map(with).collect::<Vec<_>>()
        };
        all = all.into_iter().flat_map(longer).collect();
    }
    Ok(all)
}

/// The number of a scene that has this name.
///
/// # Errors
/// In words, with the names that it has.
pub(crate) fn number(scene: &Scene, name: &str) -> Result<&'static SchemaNumber, String> {
    find(scene, name).map_err(|error| match error.has() {
        [] => error.to_string(),
        has => format!("{error} (it has {})", has.join(", ")),
    })
}

#[cfg(test)]
mod tests {
    use stochc_compiler::scene::built_in;

    use super::*;

    fn of(axes: &[&str]) -> Result<Vec<String>, String> {
        let axes: Vec<Axis> = axes.iter().map(|axis| Axis::parse(axis).unwrap()).collect();
        let points = points(&axes, &built_in("hemisphere").unwrap())?;
        let text = |point: Vec<Varied>| {
            let values: Vec<_> = point.iter().map(Varied::text).collect();
            values.join(" ")
        };
        Ok(points.into_iter().map(text).collect())
    }

    #[test]
    fn every_value_meets_every_other() {
        assert_eq!(
            of(&["free=50,60", "agitation=1..2 m/s/2"]).unwrap(),
            [
                "free=50 agitation.speed=1 m/s",
                "free=50 agitation.speed=2 m/s",
                "free=60 agitation.speed=1 m/s",
                "free=60 agitation.speed=2 m/s"
            ]
        );
    }

    #[test]
    fn too_many_points_and_names_twice_are_refused() {
        assert!(of(&["free=1..400/400"]).is_ok());
        let told = of(&["free=1..400/400", "tick=1,2 ms"]).unwrap_err();
        assert!(told.contains("800 points"), "{told}");
        let told = of(&["agitation=1 m/s", "agitation.speed=2 m/s"]).unwrap_err();
        assert_eq!(told, "`agitation.speed` is swept twice");
        let told = of(&["gravitty=1"]).unwrap_err();
        assert!(told.contains("it has tick, block.side"), "{told}");
    }
}
