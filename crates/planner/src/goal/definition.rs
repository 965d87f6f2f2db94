//! The structure to build, its plate and its scene.
use std::sync::OnceLock;

use stochc_compiler::scene::{DEFAULT, is_built_in};
use stochc_compiler::{Checked, check_text};
use stochc_ir::Cell;
use stochc_ir::scene::Scene;
use stochc_ir::table::Plate;

use super::existing_structure::Repair;
use super::scenes::WrittenScenes;
use crate::declaration;

/// The shape to build, with its plate and scene.
#[derive(Clone, Debug)]
pub struct Goal {
    /// Name of the shape.
    pub name: String,
    /// Cells of the shape.
    pub cells: Vec<Cell>,
    /// The plate. `None` means the smallest one under all cells of the lowest layer.
    pub plate: Option<Plate>,
    /// Positions (x, y) of the plate's blocks that may capture. `None` means all.
    pub seeds: Option<Vec<(i32, i32)>>,
    /// Name of the scene. `None` means the default scene.
    pub scene: Option<String>,
    /// Name of the assembly. `None` means `build_` and the name of the shape.
    pub assembly: Option<String>,
    /// Source of the shape's declaration. `None` if the shape is not declared.
    pub(super) shape: Option<String>,
    /// Scene declarations of the program that declares the shape.
    pub(super) scenes: WrittenScenes,
    /// Existing blocks to keep, and existing blocks to release.
    pub(super) repair: Repair,
    /// Cache of the compiled scene, with its name.
    pub(super) compiled: OnceLock<(Option<String>, Scene)>,
}

/// Name of programs in diagnostics.
pub(super) const NAME: &str = "planned.sa";

impl Goal {
    /// Creates a goal from cells. The name must be valid in a program.
    pub fn from_cells(name: &str, cells: Vec<Cell>) -> Goal {
        let mut sorted = cells.clone();
        sorted.sort_unstable();
        sorted.dedup();
        Goal {
            name: name.to_owned(),
            shape: declaration(name, &sorted),
            cells,
            plate: None,
            seeds: None,
            scene: None,
            assembly: None,
            scenes: WrittenScenes::default(),
            repair: Repair::default(),
            compiled: OnceLock::new(),
        }
    }

    /// Moves the shape by this number of cells. Returns `None` if coordinates overflow.
    pub fn moved(self, east: i32, north: i32) -> Option<Goal> {
        let moved = |cell: &Cell| {
            let (x, y) = (cell.x.checked_add(east)?, cell.y.checked_add(north)?);
            Some(Cell::new(x, y, cell.z))
        };
        let cells: Vec<Cell> = self.cells.iter().map(moved).collect::<Option<_>>()?;
        Some(Goal {
            plate: self.plate,
            seeds: self.seeds,
            scene: self.scene,
            assembly: self.assembly,
            scenes: self.scenes,
            ..Goal::from_cells(&self.name, cells)
        })
    }

    /// Declares a scene with this source and selects it.
    pub fn declare_scene(&mut self, name: &str, text: &str) {
        self.scene = Some(name.to_owned());
        self.scenes = WrittenScenes::new(&check_text(NAME, text));
        self.compiled = OnceLock::new();
    }

    /// Selects a scene of another program and copies its declaration.
    ///
    /// # Errors
    /// If the program has no such scene, or if it has several scenes and no name is given. The
    /// error lists their names.
    pub fn take_scene(&mut self, from: &Checked, name: Option<&str>) -> Result<(), Vec<String>> {
        let scenes = WrittenScenes::new(from);
        let names: Vec<&str> = scenes.names().collect();
        let chosen = match (name, &names[..]) {
            (Some(name), _) => names.contains(&name).then_some(name),
            (None, [only]) => Some(*only),
            (None, _) => None,
        };
        let Some(chosen) = chosen.map(str::to_owned) else {
            return Err(names.into_iter().map(str::to_owned).collect());
        };
        self.scenes = scenes;
        self.scene = Some(chosen);
        self.compiled = OnceLock::new();
        Ok(())
    }

    /// Returns the names of the scenes that are declared in the program of the shape.
    pub fn declared_scenes(&self) -> impl Iterator<Item = &str> {
        self.scenes.names()
    }

    /// Returns the selected scene.
    ///
    /// # Errors
    /// If the scene does not exist or has errors.
    pub fn scene(&self) -> Result<Scene, Box<Checked>> {
        match self.compiled.get() {
            Some((name, scene)) if *name == self.scene => Ok(scene.clone()),
            _ => {
                let scene = self.compile_scene()?;
                // The cache keeps only the first scene. Another one is compiled each time.
                let _ = self.compiled.set((self.scene.clone(), scene.clone()));
                Ok(scene)
            }
        }
    }

    fn compile_scene(&self) -> Result<Scene, Box<Checked>> {
        let scene = self
            .scene
            .as_ref()
            .map_or(String::new(), |scene| format!(" in {scene}"));
        let text = format!(
            "{}\nassembly probe{scene} {{ seed plate 1 x 1 {{ M at (0, 0) }}\nphase grow {{ M.up -> A }} }}",
            self.scenes.all()
        );
        let mut checked = check_text(NAME, &text);
        let scene = checked
            .programs
            .first_mut()
            .and_then(|program| program.scene.take());
        scene.ok_or_else(|| Box::new(checked))
    }

    /// Returns whether a scene is built in or declared in the program of the shape.
    pub fn knows_scene(&self, name: &str) -> bool {
        is_built_in(name) || self.scenes.declare(name)
    }

    /// Returns the source of the selected scene and its bases.
    pub(super) fn needed_scenes(&self) -> String {
        // A file may declare a scene with the name of the default scene.
        self.scenes
            .needed_for(self.scene.as_deref().unwrap_or(DEFAULT))
    }

    /// Returns the smallest plate under all cells of the lowest layer.
    pub(super) fn smallest_plate(&self) -> Plate {
        let feet = || self.cells.iter().filter(|cell| cell.z == 1);
        let edge = |axis: fn(&Cell) -> i32| {
            let last = feet().map(axis).max().unwrap_or(0);
            (last.max(0) as u32).saturating_add(1).min(Plate::LONGEST)
        };
        Plate {
            width: edge(|cell| cell.x),
            depth: edge(|cell| cell.y),
        }
    }

    pub(super) fn assembly(&self) -> String {
        match &self.assembly {
            Some(name) => name.clone(),
            None => format!("build_{}", self.name),
        }
    }
}
