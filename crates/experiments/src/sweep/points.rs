//! Points of a sweep: combinations of the values of its axes.
#[cfg(test)]
use stochc_ir::scene::{Scene, scalars::find, schema::SchemaNumber};

use super::axis::Axis;
use super::error::{MAX_POINTS, RangeError};
use super::parameter::Parameter;
use stochc_results::{ChosenSetting, EnsembleProgram, Varied};

/// Point of a sweep, with one value for each axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Values of the parameters of the program and scene.
    pub varied: Vec<Varied>,
    /// Values of the settings.
    pub chosen: Vec<ChosenSetting>,
}

impl Point {
    fn with_number(&self, value: &Varied) -> Point {
        let mut point = self.clone();
        point.varied.push(value.clone());
        point
    }

    fn with_setting(&self, value: &ChosenSetting) -> Point {
        let mut point = self.clone();
        point.chosen.push(value.clone());
        point
    }
}

/// Returns all combinations of the axes' values for a program. The last axis changes fastest.
///
/// # Errors
///
/// If the program and its scene do not have a parameter, `--set` gives it a single value, a value is
/// not allowed, or there are more than [`MAX_POINTS`] points.
pub fn points(axes: &[Axis], program: &EnsembleProgram) -> Result<Vec<Point>, RangeError> {
    let mut all = vec![Point::default()];
    let mut seen: Vec<&str> = Vec::new();
    for axis in axes {
        let longer: Vec<Point> = if let Some(chosen) = axis.settings() {
            first_time(&mut seen, &axis.name)?;
            few(all.len(), chosen.len())?;
            let with = |point: &Point| chosen.iter().map(|it| point.with_setting(it)).collect();
            all.iter().flat_map::<Vec<Point>, _>(with).collect()
        } else {
            let parameter = Parameter::find(program, &axis.name)?;
            let name = parameter.name();
            first_time(&mut seen, name)?;
            if program.set.iter().any(|it| it.name == name) {
                return Err(RangeError::AxisIsSet(name.to_owned()));
            }
            let values = axis.values(parameter)?;
            few(all.len(), values.len())?;
            let with = |point: &Point| values.iter().map(|it| point.with_number(it)).collect();
            all.iter().flat_map::<Vec<Point>, _>(with).collect()
        };
        all = longer;
    }
    Ok(all)
}

/// Adds the name of an axis to `seen`.
///
/// # Errors
///
/// If an earlier axis has the same name.
fn first_time<'a>(seen: &mut Vec<&'a str>, name: &'a str) -> Result<(), RangeError> {
    if seen.contains(&name) {
        return Err(RangeError::AxisTwice(name.to_owned()));
    }
    seen.push(name);
    Ok(())
}

/// Checks that `points` multiplied by `values` is within the limit of points.
fn few(points: usize, values: usize) -> Result<(), RangeError> {
    let count = points.saturating_mul(values);
    if count <= MAX_POINTS {
        Ok(())
    } else {
        Err(RangeError::Points(count))
    }
}

/// Returns the scene parameter with a name.
///
/// # Errors
///
/// If the scene has no such parameter.
#[cfg(test)]
pub(crate) fn number(scene: &Scene, name: &str) -> Result<&'static SchemaNumber, RangeError> {
    find(scene, name).map_err(|error| RangeError::Parameter { error })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn combined(axes: &[&str]) -> Result<Vec<String>, RangeError> {
        let axes: Vec<Axis> = axes.iter().map(|axis| Axis::parse(axis).unwrap()).collect();
        let text = "assembly tower(height = 2) { seed plate 1 x 1 { M at (0, 0) } phase p { M.up ->> A[1..height] } }";
        let mut checked = stochc_compiler::check_text("tower.sa", text);
        let executable = checked.programs.remove(0).into_executable().unwrap();
        let mut program = EnsembleProgram::new("tower", Vec::new(), executable);
        program.parameters.insert("height".to_owned(), 2);
        let points = points(&axes, &program)?;
        let text = |point: Point| {
            let numbers = point.varied.iter().map(Varied::text);
            let settings = point.chosen.iter().map(ChosenSetting::text);
            numbers.chain(settings).collect::<Vec<_>>().join(" ")
        };
        Ok(points.into_iter().map(text).collect())
    }

    #[test]
    fn every_value_is_combined_with_every_other() {
        assert_eq!(
            combined(&["free=50,60", "agitation=1..2 m/s/2"]).unwrap(),
            [
                "free=50 agitation.speed=1 m/s",
                "free=50 agitation.speed=2 m/s",
                "free=60 agitation.speed=1 m/s",
                "free=60 agitation.speed=2 m/s"
            ]
        );
        assert_eq!(
            combined(&["substeps=1,2", "free=50,60"]).unwrap(),
            [
                "free=50 substeps=1",
                "free=60 substeps=1",
                "free=50 substeps=2",
                "free=60 substeps=2"
            ]
        );
        assert_eq!(
            combined(&["height=2..4/3"]).unwrap(),
            ["height=2", "height=3", "height=4"]
        );
        let message = combined(&["model=rigid", "model=rate"])
            .unwrap_err()
            .to_string();
        assert_eq!(message, "`model` is swept twice");
    }

    #[test]
    fn too_many_points_and_names_twice_are_refused() {
        assert!(combined(&["free=1..400/400"]).is_ok());
        let message = combined(&["free=1..400/400", "tick=1,2 ms"])
            .unwrap_err()
            .to_string();
        assert!(message.contains("800 or more points"), "{message}");
        let message = combined(&["agitation=1 m/s", "agitation.speed=2 m/s"])
            .unwrap_err()
            .to_string();
        assert_eq!(message, "`agitation.speed` is swept twice");
        let message = combined(&["hight=1,2"]).unwrap_err().to_string();
        assert_eq!(
            message,
            "`tower` has no parameter `hight`; did you mean `height`?"
        );
        let message = combined(&["height=2,2.5"]).unwrap_err().to_string();
        assert_eq!(
            message,
            "`height` is a parameter of a program and requires a whole number, not 2.5"
        );
        let message = combined(&["gravitty=1"]).unwrap_err().to_string();
        assert!(message.contains("it has tick, block.side"), "{message}");
    }
}
