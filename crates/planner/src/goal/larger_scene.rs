//! A scene with more blocks than another, and with room for them at the same density.
use stochc_compiler::scene::{DEFAULT, is_built_in};
use stochc_ir::Cell;
use stochc_ir::scene::describe::terms;
use stochc_ir::scene::room::NoRoom;
use stochc_ir::scene::{Arrangement, Enclosure, Scene};
use stochc_ir::table::Plate;

use super::Goal;

/// A scene that was derived from another.
#[derive(Clone, Debug, PartialEq)]
pub struct LargerScene {
    /// Its name.
    pub name: String,
    /// The name of the scene that it is based on.
    pub base: String,
    /// The number of free blocks of that.
    pub base_free: u32,
    /// The number of its own free blocks.
    pub free: u32,
    /// The radius of its enclosure \[m\], if it has one.
    pub radius: Option<f64>,
    /// Its density of free blocks over that of the other scene.
    pub density: f64,
}

impl Goal {
    /// Builds it in a scene like its own with `free` blocks, at the same density if the shape fits in then.
    ///
    /// # Errors
    /// If the blocks do not have room there.
    pub fn set_free(&mut self, free: u32) -> Result<Option<LargerScene>, NoRoom> {
        let Ok(base) = self.scene() else {
            return Ok(None);
        };
        let mut scene = base.clone();
        scene.free.count = free;
        scale(&mut scene, cube_root(f64::from(free) / count(&base)));
        if let Some(radius) = self.radius_needed(&scene) {
            scale(&mut scene, radius);
        }
        self.derive(&base, scene).map(Some)
    }

    /// Builds it in a scene like the default one with enough blocks and room at the same density, if it names no scene and
    /// the default one is too small. There are twice as many blocks as cells, so that the density halves at most.
    ///
    /// # Errors
    /// If the blocks do not have room there.
    pub fn enlarge_default_scene(&mut self) -> Result<Option<LargerScene>, NoRoom> {
        let mut cells = self.cells.clone();
        cells.sort_unstable();
        cells.dedup();
        let needed = cells.len();
        let base = match self.scene() {
            Ok(base) if self.scene.is_none() => base,
            _ => return Ok(None),
        };
        let mut factor: f64 = 1.0;
        if needed > base.free.count as usize {
            factor = cube_root(2.0 * needed as f64 / count(&base));
        }
        let mut scene = base.clone();
        scale(&mut scene, factor);
        factor *= self.radius_needed(&scene).unwrap_or(1.0);
        if factor == 1.0 {
            return Ok(None);
        }
        let mut scene = base.clone();
        scale(&mut scene, factor);
        let count = (count(&base) * factor.powi(3)).round();
        // A target with more cells is refused in any case.
        scene.free.count = count.min(f64::from(u32::MAX)) as u32;
        self.derive(&base, scene).map(Some)
    }

    /// Writes a scene down, and builds the goal in it.
    fn derive(&mut self, base: &Scene, mut scene: Scene) -> Result<LargerScene, NoRoom> {
        let plate = self.plate.clone().unwrap_or_else(|| self.smallest_plate());
        scene.has_room(&plate)?;
        let from = self.scene.clone().unwrap_or_else(|| DEFAULT.to_owned());
        let plain = format!("{from}_{}", scene.free.count);
        let others = (2..).map(|number| format!("{plain}_{number}"));
        let is_taken =
            |name: &String| is_built_in(name) || self.scenes.declare(name) || *name == self.name;
        let mut names = std::iter::once(plain.clone()).chain(others);
        let name = names.find(|name| !is_taken(name)).unwrap_or(plain);
        scene.name.clone_from(&name);
        let radius = |scene: &Scene| scene.enclosure.as_ref().map(Enclosure::radius);
        let grown = radius(&scene).zip(radius(base));
        let grown = grown.map_or(1.0, |(radius, base)| (radius / base).powi(3));
        let larger = LargerScene {
            density: count(&scene) / count(base) / grown,
            radius: radius(&scene),
            base: from,
            base_free: base.free.count,
            free: scene.free.count,
            name,
        };
        let text = declaration(&larger, &scene);
        self.scenes.add(&larger.name, &larger.base, text);
        self.scene = Some(larger.name.clone());
        Ok(larger)
    }

    /// Returns the factor by which the radius has to grow so that the shape fits in with a tenth to spare.
    /// Returns `None` if it fits in already.
    fn radius_needed(&self, scene: &Scene) -> Option<f64> {
        let plate = self.plate.clone().unwrap_or_else(|| self.smallest_plate());
        let first = scene.enclosure.as_ref()?.radius();
        let mut scene = scene.clone();
        // If no radius is large enough, the check of the program reports it.
        for _ in 0..100 {
            let (enclosure, side) = (scene.enclosure.as_ref()?, scene.block.side);
            let farthest = farthest(enclosure, &self.cells, &plate, side);
            let factor = farthest / enclosure.radius();
            if factor <= 1.0 {
                let radius = enclosure.radius();
                return Some(radius / first).filter(|factor| *factor > 1.0);
            }
            scale(&mut scene, 1.1 * factor);
        }
        None
    }
}

/// Distance from the centre of an enclosure to the farthest point of a shape \[m\].
fn farthest(enclosure: &Enclosure, cells: &[Cell], plate: &Plate, side: f64) -> f64 {
    let distances = cells
        .iter()
        .map(|cell| enclosure.distance_to(*cell, plate, side));
    distances.fold(0.0, f64::max)
}

/// Returns the number of free blocks of a scene, to divide by.
fn count(scene: &Scene) -> f64 {
    f64::from(scene.free.count.max(1))
}

fn cube_root(value: f64) -> f64 {
    libm::cbrt(value)
}

/// Makes the enclosure larger by a factor, and a circle of free blocks with it; lengths are rounded up to four digits.
fn scale(scene: &mut Scene, factor: f64) {
    if factor == 1.0 {
        return;
    }
    if let Some(Enclosure::Hemisphere { radius, .. } | Enclosure::Sphere { radius, .. }) =
        &mut scene.enclosure
    {
        *radius = rounded_up(*radius * factor);
    }
    if let Arrangement::Ring { radius } = &mut scene.free.arrangement {
        *radius = rounded_up(*radius * factor);
    }
}

/// Returns the next number of four digits.
fn rounded_up(value: f64) -> f64 {
    let exponent = libm::log10(value).floor() as i32 - 3;
    let digits = (value / libm::exp10(f64::from(exponent))).ceil();
    // Read back, the text of a decimal number is the nearest one.
    format!("{digits}e{exponent}").parse().unwrap_or(value)
}

/// Returns the text that declares a scene: the clauses that differ from its base.
fn declaration(larger: &LargerScene, scene: &Scene) -> String {
    let terms = terms(scene).into_iter();
    let changed = terms.filter(|term| matches!(term.clause, "free" | "enclosure"));
    let clauses: Vec<String> = changed.map(|term| term.text).collect();
    let LargerScene {
        name, base, free, ..
    } = larger;
    format!(
        "/// `{base}` with {free} free blocks{}.\nscene {name} from {base} {{ {} }}\n",
        larger.density_in_words(),
        clauses.join("\n")
    )
}

impl LargerScene {
    /// Returns a phrase that compares its density with that of its base.
    fn density_in_words(&self) -> String {
        match self.radius {
            None => String::new(),
            Some(_) if (0.98..1.02).contains(&self.density) => {
                " and room for them at the same density".to_owned()
            }
            Some(_) => format!(" at {:.2} times its density", self.density),
        }
    }

    /// Describes it in one sentence.
    pub fn in_words(&self) -> String {
        let LargerScene {
            name,
            base,
            base_free,
            free,
            radius,
            ..
        } = self;
        let radius = radius.map_or(String::new(), |radius| format!(", radius {radius} m"));
        format!(
            "planned in `{name}`: `{base}` with {free} free blocks instead of {base_free}{}{radius}",
            self.density_in_words()
        )
    }
}
