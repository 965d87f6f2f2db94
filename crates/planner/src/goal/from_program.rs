//! Goals from the shapes of a program.
use std::sync::OnceLock;

use stochc_compiler::diagnostic::Diagnostic;
use stochc_compiler::expanded::{ExpandedProgram, ExpandedSeed};
use stochc_compiler::scene::DEFAULT;
use stochc_compiler::{Checked, DeclaredShape, DeclaredShapes, Program, shape_cells};
use stochc_grammar::tree::{Item, Tree};
use stochc_grammar::{Symbols, print};

use super::definition::Goal;
use super::existing_structure::Repair;
use super::no_goal::NoGoal;
use super::scenes::WrittenScenes;

impl Goal {
    /// Returns a shape of a correct program as a goal. Plate, seeds and scene come from the
    /// assembly that claims the shape, or from the only assembly. Without a name, takes the only
    /// shape or the one claimed last.
    ///
    /// # Errors
    ///
    /// If there is no such shape.
    pub fn from_program(checked: &Checked, name: Option<&str>) -> Result<Goal, NoGoal> {
        let symbols = &checked.symbols;
        let claims = |plan: &ExpandedProgram| -> Vec<&str> {
            let claims = plan.phases.iter().flat_map(|phase| &phase.claims);
            let names = claims.map(|claim| symbols.word(claim.shape));
            // The declared names live as long as the file.
            names.collect()
        };
        let declared = DeclaredShapes::new(checked);
        let known: Vec<&str> = (declared.all().iter())
            .map(|it| symbols.word(it.shape.name.symbol))
            .collect();
        let listed = || {
            known
                .iter()
                .map(|name| format!("`{name}`"))
                .collect::<Vec<_>>()
                .join(", ")
        };
        let programs = || {
            checked
                .programs
                .iter()
                .filter(|program| program.plan.aggregate.is_none())
        };
        let claiming = |requested: &str| {
            programs().find(|program| {
                let claims = claims(&program.plan);
                claims.contains(&requested)
                    && declared.seen_from(&program.plan, requested).is_some()
            })
        };
        let all_claimed = programs().flat_map(|program| {
            let names = claims(&program.plan).into_iter();
            names.map(move |name| (program, name))
        });
        let last_claimed = all_claimed.last();
        let (requested, claiming) = match (name, &known[..]) {
            (Some(name), _) => (name, claiming(name)),
            (None, []) => return Err(NoGoal::NoShape),
            (None, [only]) => (*only, claiming(only)),
            (None, _) => {
                let (program, name) = last_claimed.ok_or_else(|| NoGoal::Ambiguous(listed()))?;
                let seen = declared.seen_from(&program.plan, name);
                let is_local = seen.is_some_and(|it| it.is_local);
                (
                    name,
                    if is_local {
                        Some(program)
                    } else {
                        claiming(name)
                    },
                )
            }
        };
        let of_claim = claiming.and_then(|program| declared.seen_from(&program.plan, requested));
        let first =
            || (declared.all().iter()).find(|it| symbols.word(it.shape.name.symbol) == requested);
        let found = of_claim.or_else(first);
        let found = found.ok_or_else(|| match known.len() {
            0 => NoGoal::NoSuchShape(requested.to_owned()),
            _ => NoGoal::OtherShapes {
                name: requested.to_owned(),
                others: listed(),
            },
        })?;
        let only = || programs().next().filter(|_| programs().count() == 1);
        Goal::from_shape(checked, found, claiming.or_else(only))
    }

    /// Returns a shape with the plate, the seeds and the scene of an assembly.
    pub(super) fn from_shape(
        checked: &Checked,
        declared: &DeclaredShape<'_>,
        assembly: Option<&Program>,
    ) -> Result<Goal, NoGoal> {
        let DeclaredShape {
            file, item, shape, ..
        } = declared;
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        let cells = shape_cells(shape, *file, &mut diagnostics);
        let cells = cells.ok_or_else(|| match diagnostics.first() {
            Some(diagnostic) => NoGoal::Wrong(match diagnostic.labels.first() {
                Some(label) => format!("{}: {}", diagnostic.message(), label.text),
                None => diagnostic.message(),
            }),
            None => NoGoal::NoCells,
        })?;
        let symbols = &checked.symbols;
        Ok(Goal {
            name: symbols.word(shape.name.symbol).to_owned(),
            cells,
            plate: assembly.map(|program| program.plan.plate.clone()),
            seeds: assembly.and_then(|program| seats(&program.plan)),
            scene: assembly.and_then(scene_of),
            assembly: None,
            shape: Some(printed(item, symbols)),
            scenes: WrittenScenes::new(checked),
            repair: Repair::default(),
            compiled: OnceLock::new(),
        })
    }
}

fn printed(item: &Item, symbols: &Symbols) -> String {
    let items = vec![item.clone()];
    print(&Tree { items }, symbols)
}

/// Returns the name of a program's scene. Returns `None` for the default scene.
pub(super) fn scene_of(program: &Program) -> Option<String> {
    let name = program.scene.as_ref().map(|scene| scene.name.clone());
    name.filter(|name| name != DEFAULT)
}

/// Returns the positions of the plate's named blocks. Returns `None` if none has a name.
pub(super) fn seats(plan: &ExpandedProgram) -> Option<Vec<(i32, i32)>> {
    let place = |seed: &ExpandedSeed| (seed.cell.x, seed.cell.y);
    (!plan.seeds.is_empty()).then(|| plan.seeds.iter().map(place).collect())
}
