//! Derives a scene with more free blocks and enough space for them at the same density.
use stochc_compiler::scene::{DEFAULT, is_built_in};
use stochc_ir::Cell;
use stochc_ir::scene::describe::terms;
use stochc_ir::scene::room::NoRoom;
use stochc_ir::scene::{Arrangement, Enclosure, Scene};
use stochc_ir::table::Plate;

use super::Goal;

/// A scene derived from another.
#[derive(Clone, Debug, PartialEq)]
pub struct LargerScene {
    /// Name of the derived scene.
    pub name: String,
    /// Name of the base scene.
    pub base: String,
    /// Number of free blocks of the base scene.
    pub base_free: u32,
    /// Number of free blocks of the derived scene.
    pub free: u32,
    /// Names and lengths of the enclosure \[m\]. Empty without an enclosure.
    pub lengths: Vec<(&'static str, f64)>,
    /// Density of free blocks relative to the base scene.
    pub density: f64,
}

impl Goal {
    /// Changes the scene to one with `free` blocks. The density stays the same unless the shape
    /// needs more space.
    ///
    /// # Errors
    /// If the blocks do not fit into the enclosure.
    pub fn set_free(&mut self, free: u32) -> Result<Option<LargerScene>, NoRoom> {
        let Ok(base) = self.scene() else {
            return Ok(None);
        };
        let mut scene = base.clone();
        scene.free.count = free;
        let ratio = f64::from(free) / count(&base);
        let is_planar = base.planar.is_some();
        let factor = if is_planar {
            ratio.sqrt()
        } else {
            cube_root(ratio)
        };
        scale(&mut scene, factor);
        if let Some(factor) = self.factor_needed(&scene) {
            scale(&mut scene, factor);
        }
        self.derive(&base, scene).map(Some)
    }

    /// Enlarges the default scene if the goal names no scene and the default one is too small. Uses
    /// two free blocks per cell, so that captures at most halve the density.
    ///
    /// # Errors
    /// If the blocks do not fit into the enclosure.
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
        factor *= self.factor_needed(&scene).unwrap_or(1.0);
        if factor == 1.0 {
            return Ok(None);
        }
        let mut scene = base.clone();
        scale(&mut scene, factor);
        let count = (count(&base) * factor.powi(3)).round();
        // Targets with more cells are rejected later.
        scene.free.count = count.min(f64::from(u32::MAX)) as u32;
        self.derive(&base, scene).map(Some)
    }

    /// Declares a derived scene and selects it for the goal.
    fn derive(&mut self, base: &Scene, mut scene: Scene) -> Result<LargerScene, NoRoom> {
        let plate = self.plate.clone().unwrap_or_else(|| self.smallest_plate());
        scene.has_room(&plate, &[])?;
        let from = self.scene.clone().unwrap_or_else(|| DEFAULT.to_owned());
        let plain = format!("{from}_{}", scene.free.count);
        let others = (2..).map(|number| format!("{plain}_{number}"));
        let is_taken =
            |name: &String| is_built_in(name) || self.scenes.declare(name) || *name == self.name;
        let mut names = std::iter::once(plain.clone()).chain(others);
        let name = names.find(|name| !is_taken(name)).unwrap_or(plain);
        scene.name.clone_from(&name);
        let volume = |scene: &Scene| scene.enclosure.as_ref().map(Enclosure::volume);
        let grown = volume(&scene).zip(volume(base));
        let grown = grown.map_or(1.0, |(volume, base)| volume / base);
        let enclosure = scene.enclosure.as_ref();
        let larger = LargerScene {
            density: count(&scene) / count(base) / grown,
            lengths: enclosure.map(Enclosure::lengths).unwrap_or_default(),
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

    /// Returns the factor that enlarges the enclosure so that the shape fits with a margin of a
    /// tenth. Returns `None` if the shape already fits.
    fn factor_needed(&self, scene: &Scene) -> Option<f64> {
        let plate = self.plate.clone().unwrap_or_else(|| self.smallest_plate());
        let first = scene.enclosure.as_ref()?.radius();
        let mut scene = scene.clone();
        // If no size is large enough, the check of the program reports it.
        for _ in 0..100 {
            let (enclosure, side) = (scene.enclosure.as_ref()?, scene.block.side);
            let factor = part_reached(enclosure, &self.cells, &plate, side);
            if factor <= 1.0 {
                let radius = enclosure.radius();
                return Some(radius / first).filter(|factor| *factor > 1.0);
            }
            scale(&mut scene, 1.1 * factor);
        }
        None
    }
}

/// Returns the largest distance that the shape reaches, divided by the limit of the enclosure.
fn part_reached(enclosure: &Enclosure, cells: &[Cell], plate: &Plate, side: f64) -> f64 {
    let parts = cells
        .iter()
        .flat_map(|cell| enclosure.extents(*cell, plate, side))
        .map(|extent| extent.reached / extent.limit);
    parts.fold(0.0, f64::max)
}

/// Returns the number of free blocks of a scene. Returns 1 instead of 0, because the result is a
/// divisor.
fn count(scene: &Scene) -> f64 {
    f64::from(scene.free.count.max(1))
}

fn cube_root(value: f64) -> f64 {
    libm::cbrt(value)
}

/// Multiplies the size of the enclosure, and of a circle of free blocks, by a factor. Rounds
/// lengths up to four digits.
fn scale(scene: &mut Scene, factor: f64) {
    if factor == 1.0 {
        return;
    }
    let lengths = scene.enclosure.iter_mut().flat_map(Enclosure::lengths_mut);
    for (_, length) in lengths {
        *length = rounded_up(*length * factor);
    }
    if let Arrangement::Ring { radius } = &mut scene.free.arrangement {
        *radius = rounded_up(*radius * factor);
    }
}

/// Returns the smallest number with four digits that is not below `value`.
fn rounded_up(value: f64) -> f64 {
    let exponent = libm::log10(value).floor() as i32 - 3;
    let digits = (value / libm::exp10(f64::from(exponent))).ceil();
    // Parsing the decimal text gives the nearest number.
    format!("{digits}e{exponent}").parse().unwrap_or(value)
}

/// Returns the declaration of a scene, with only the clauses that differ from its base.
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
    /// Returns a phrase that compares the density with the density of the base scene.
    fn density_in_words(&self) -> String {
        match self.lengths.first() {
            None => String::new(),
            Some(_) if (0.98..1.02).contains(&self.density) => {
                " and room for them at the same density".to_owned()
            }
            Some(_) => format!(" at {:.2} times its density", self.density),
        }
    }

    /// Returns a sentence that describes the scene.
    pub fn in_words(&self) -> String {
        let LargerScene {
            name,
            base,
            base_free,
            free,
            lengths,
            ..
        } = self;
        let lengths = lengths.iter();
        let lengths: String = lengths
            .map(|(name, length)| format!(", {name} {length} m"))
            .collect();
        format!(
            "planned in `{name}`: `{base}` with {free} free blocks instead of {base_free}{}{lengths}",
            self.density_in_words()
        )
    }
}
