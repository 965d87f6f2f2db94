//! `stochc check --physics`: the physics of scenes.
use std::fmt::Write as _;

use serde_json::{Value as Json, json};
use stochc_compiler::diagnostic::Code;
use stochc_compiler::{Checked, PhaseLoad};
use stochc_ir::scene::bond_load::{BondLoad, BreakingBonds};
use stochc_ir::scene::describe::{AbsentTerm, DescribedTerm, DescribedValue, absent, terms};
use stochc_ir::scene::dimensionless::{
    AdvisedRange, BlockUnits, DimensionlessNumber, Speed, SpeedFrom, dimensionless_numbers, speed,
};
use stochc_ir::scene::warnings::{SceneWarning, SceneWarningKind, short, structure_group};
use stochc_ir::scene::{ContactLaw, Scene, Substeps};
use stochc_ir::table::Tables;
use stochc_runtime::{StepError, step_errors};
use stochc_text::{aligned, visible};

use crate::command::terminal::{WIDTH, wrapped};

/// Scene that assemblies of a file use, with the data that `--physics` lists.
pub struct InForce<'a> {
    file: &'a str,
    scene: &'a Scene,
    /// Names of the assemblies that use this scene.
    assemblies: Vec<&'a str>,
    terms: Vec<DescribedTerm>,
    absent: Vec<AbsentTerm>,
    speed: Speed,
    numbers: Vec<DimensionlessNumber>,
    /// Smallest density of free blocks at the heights of the assemblies' captures.
    at_structure: Option<DimensionlessNumber>,
    /// Default number of substeps of the scene.
    steps: Substeps,
    /// Warnings about the scene, with its default substeps.
    warnings: Vec<SceneWarning>,
    step_errors: Vec<StepError>,
    /// Largest load of a bond at the end of each phase. Empty if bonds do not break.
    bond_loads: Vec<LargestLoad<'a>>,
}

/// Largest load of a bond at the end of a phase, with names.
struct LargestLoad<'a> {
    assembly: &'a str,
    phase: &'a str,
    /// Block whose bond to its parent has the load.
    block: String,
    load: BondLoad,
}

/// Returns the scenes that the assemblies of a file use, without duplicates, in the order of the
/// assemblies.
pub fn scenes<'a>(file: &'a str, checked: &'a Checked) -> Vec<InForce<'a>> {
    let mut out: Vec<InForce> = Vec::new();
    for program in &checked.programs {
        let Some(scene) = &program.scene else {
            continue;
        };
        let name = program.plan.name.as_str();
        let steps = Substeps::DEFAULT.in_scene(scene);
        let number = out.iter().position(|it| it.scene == scene);
        let number = number.unwrap_or_else(|| {
            out.push(InForce {
                file,
                scene,
                assemblies: Vec::new(),
                terms: terms(scene),
                absent: absent(scene),
                speed: speed(scene),
                numbers: dimensionless_numbers(scene, steps),
                at_structure: None,
                steps,
                warnings: Vec::new(),
                step_errors: step_errors(scene, steps),
                bond_loads: Vec::new(),
            });
            out.len() - 1
        });
        let layers = program.tables.as_ref().and_then(Tables::capture_layers);
        let density = layers.and_then(|layers| structure_group(scene, &layers));
        out[number].add(name, &program.scene_warnings, density);
        let load = |it: &PhaseLoad| LargestLoad {
            assembly: name,
            phase: &program.plan.phases[it.phase].name,
            block: {
                let role = program.plan.event(it.capture).role;
                program.plan.roles.name(role, &checked.symbols)
            },
            load: it.load,
        };
        (out[number].bond_loads).extend(program.bond_loads.iter().map(load));
    }
    out
}

impl<'a> InForce<'a> {
    /// Adds an assembly that uses the scene. `warnings` are about the heights of the assembly's
    /// captures. `density` is the lowest density of free blocks at these heights.
    fn add(
        &mut self,
        assembly: &'a str,
        warnings: &[SceneWarning],
        density: Option<DimensionlessNumber>,
    ) {
        self.assemblies.push(assembly);
        let known = self.at_structure.into_iter().chain(density);
        self.at_structure = known.min_by(|a, b| a.value.total_cmp(&b.value));
        for warning in warnings {
            let is_same =
                |known: &SceneWarning| (known.kind, known.symbol) == (warning.kind, warning.symbol);
            if !self.warnings.iter().any(is_same) {
                self.warnings.push(warning.clone());
            }
        }
    }

    /// Returns whether a dimensionless number is outside of its limit with the default substeps.
    fn is_exceeded(&self, group: &DimensionlessNumber) -> bool {
        group.is_exceeded(group.steps_of(self.steps))
            || group.disappoints().is_some()
            || group.is_unusual()
    }

    fn numbers(&self) -> impl Iterator<Item = &DimensionlessNumber> {
        self.numbers.iter().chain(&self.at_structure)
    }

    /// Returns the listing of `--physics` as one JSON object: `{ file, scene, assemblies, terms,
    /// absent, speed, groups, steps, warnings, bond_loads, step_errors }`.
    pub fn json(&self) -> Json {
        let units = BlockUnits::from_scene(self.scene);
        let warning = |warning: &SceneWarning| {
            json!({
                "code": Code::from(warning.kind),
                "symbol": warning.symbol,
                "figure": warning.figure,
                "effect": warning.effect,
                "remedy": warning.remedy,
            })
        };
        let group = |group: &DimensionlessNumber| {
            json!({
                "symbol": group.symbol,
                "meaning": group.meaning,
                "value": group.value,
                "least": least(group),
                "most": most(group),
                "taken": group.steps_of(self.steps),
                "exceeded": self.is_exceeded(group),
                "substeps": group.substeps(),
            })
        };
        let bond_load = |it: &LargestLoad| {
            json!({
                "assembly": it.assembly,
                "phase": it.phase,
                "block": it.block,
                "blocks": it.load.blocks,
                "force": it.load.force,
                "torque": it.load.torque,
                "share": it.load.share,
            })
        };
        let step_error = |error: &StepError| {
            json!({
                "figure": error.figure,
                "unit": error.unit,
                "substeps": error.steps,
                "taken": error.taken,
                "resolved": error.resolved,
            })
        };
        json!({
            "file": self.file,
            "scene": self.scene.name,
            "assemblies": self.assemblies,
            "terms": self.terms,
            "absent": self.absent,
            "speed": {
                "from": self.speed.from,
                "si": self.speed.rms,
                "block": self.speed.rms.map(|rms| units.speed(rms)),
            },
            "groups": self.numbers().map(group).collect::<Vec<_>>(),
            "steps": {
                "taken": self.steps.to_string(),
                "needed": self.needed(),
                "resolved": self.are_steps_short(),
            },
            "warnings": self.warnings.iter().map(warning).collect::<Vec<_>>(),
            "bond_loads": self.bond_loads.iter().map(bond_load).collect::<Vec<_>>(),
            "step_errors": self.step_errors.iter().map(step_error).collect::<Vec<_>>(),
        })
    }

    /// Returns the listing of `--physics` as text.
    pub fn text(&self) -> String {
        let mut out = format!(
            "{}: scene {}, of {}\n\n  in force, with the values in SI units and in block units\n",
            visible(self.file),
            self.scene.name,
            self.assemblies.join(", ")
        );
        self.list_terms(&mut out);
        if !self.absent.is_empty() {
            out.push_str("\n  absent, and not computed\n");
            let row = |it: &AbsentTerm| [it.clause.clone(), it.meaning.to_owned()];
            let rows: Vec<_> = self.absent.iter().map(row).collect();
            for line in aligned(&rows) {
                let _ = writeln!(out, "    {line}");
            }
        }
        let _ = write!(
            out,
            "\n  expected speed of a free block, rms\n    {}\n",
            self.expected()
        );
        self.list_numbers(&mut out);
        self.list_step_errors(&mut out);
        self.list_bond_loads(&mut out);
        out.push('\n');
        let _ = writeln!(out, "  {}", self.verdict());
        for warning in &self.warnings {
            let SceneWarning { figure, effect, .. } = warning;
            let code = Code::from(warning.kind);
            out.push_str(&wrapped(&format!("warning[{code}]: {figure}"), "  ", WIDTH));
            let advice = format!("{effect}; {}", warning.remedy);
            out.push_str(&wrapped(&advice, "    ", WIDTH));
        }
        if self.needed() > 1 && matches!(self.contact(), Some(ContactLaw::Rigid { .. })) {
            out.push_str("  With rigid contacts, calibrate the scene again for other substeps.\n");
        }
        out
    }

    /// Returns whether the default substeps are short enough to resolve the motion.
    fn are_steps_short(&self) -> bool {
        let is_of_steps = |it: &SceneWarning| it.kind == SceneWarningKind::CoarseStep;
        !self.warnings.iter().any(is_of_steps)
    }

    /// Returns the sentence that states whether the time step is small enough.
    fn verdict(&self) -> String {
        let taken = self.steps.in_words();
        if !self.are_steps_short() {
            format!("The time step is too long ({taken}).")
        } else if self.needed() == 1 && self.steps.longest() > 1 {
            format!(
                "The time step is small enough ({taken}).\n  One substep per tick would be enough."
            )
        } else {
            format!("The time step is small enough ({taken}).")
        }
    }

    fn list_terms(&self, out: &mut String) {
        let laws = self.terms.iter().flat_map(|term| &term.laws);
        let row = |value: &DescribedValue| {
            [
                value.symbol.to_owned(),
                value.name.to_owned(),
                in_unit(value.si, value.unit),
                in_unit(value.block, value.block_unit),
            ]
        };
        let rows: Vec<_> = laws.flat_map(|law| &law.values).map(row).collect();
        let mut lines = aligned(&rows).into_iter();
        for term in &self.terms {
            let _ = writeln!(out, "    {}", term.text);
            for law in &term.laws {
                let _ = writeln!(out, "      {}", law.meaning);
                if let Some(equation) = law.equation {
                    let _ = writeln!(out, "      {equation}");
                }
                for (line, value) in lines.by_ref().take(law.values.len()).zip(&law.values) {
                    let _ = writeln!(out, "        {line}");
                    if let Some(source) = value.default {
                        let _ = writeln!(out, "          default: {source}");
                    }
                }
            }
        }
    }

    fn list_numbers(&self, out: &mut String) {
        let row = |group: &DimensionlessNumber| {
            let limit = (most(group).map(|most| format!("at most {}", short(most))))
                .or(least(group).map(|least| format!("at least {}", short(least))));
            let mark = match (self.is_exceeded(group), least(group)) {
                (false, _) => "",
                (true, None) => "exceeded",
                (true, Some(_)) => "too small",
            };
            [
                group.symbol.to_owned(),
                short(group.value),
                limit.unwrap_or_default(),
                mark.to_owned(),
            ]
        };
        let head = ["", "value", "limit, about", ""].map(str::to_owned);
        let rows: Vec<_> = std::iter::once(head)
            .chain(self.numbers().map(row))
            .collect();
        let mut lines = aligned(&rows).into_iter();
        let _ = writeln!(
            out,
            "\n  dimensionless numbers, with limits for {}\n    {}",
            self.steps.in_words(),
            lines.next().unwrap_or_default()
        );
        for (group, line) in self.numbers().zip(lines) {
            let _ = writeln!(out, "    {line}");
            out.push_str(&wrapped(group.meaning, "      ", WIDTH));
        }
    }

    fn list_step_errors(&self, out: &mut String) {
        if self.step_errors.is_empty() {
            return;
        }
        out.push_str(
            "\n  error of the time step, in experiments with the constants of this scene\n",
        );
        let head = ["", "substeps", "value", "resolved", "error"].map(str::to_owned);
        let row = |error: &StepError| {
            [
                error.figure.to_owned(),
                error.steps.to_string(),
                in_unit(error.taken, error.unit),
                in_unit(error.resolved, error.unit),
                format!("{:+.1} %", error.relative() * 100.0),
            ]
        };
        let rows: Vec<_> = std::iter::once(head)
            .chain(self.step_errors.iter().map(row))
            .collect();
        for line in aligned(&rows) {
            let _ = writeln!(out, "    {line}");
        }
    }

    fn list_bond_loads(&self, out: &mut String) {
        let Some(law) = BreakingBonds::from_scene(self.scene) else {
            return;
        };
        out.push_str(
            "\n  largest load of a bond at the end of each phase, and the part of its strength\n",
        );
        let row = |it: &LargestLoad| {
            [
                format!("{}, phase {}", it.assembly, it.phase),
                format!("bond of {}", it.block),
                format!("{} %", short(it.load.share * 100.0)),
                law.describe(&it.load),
            ]
        };
        let rows: Vec<_> = self.bond_loads.iter().map(row).collect();
        for line in aligned(&rows) {
            let _ = writeln!(out, "    {line}");
        }
    }

    fn expected(&self) -> String {
        let from = match self.speed.from {
            SpeedFrom::Rest => "nothing moves the blocks by chance",
            SpeedFrom::Drag if self.scene.fluid.is_some() => {
                "kicks against drag, as the mean of a tick, exact"
            }
            SpeedFrom::Drag => "kicks against drag, exact",
            SpeedFrom::Collisions if self.scene.drag.is_some() => {
                "kicks against drag and inelastic collisions, an estimate (docs/concepts/physical-model.md)"
            }
            SpeedFrom::Collisions => {
                "kicks against inelastic collisions, an estimate (docs/concepts/physical-model.md)"
            }
            SpeedFrom::Wakes => {
                "kicks against wakes, and what else slows blocks, an estimate (docs/concepts/physical-model.md)"
            }
            SpeedFrom::Table => {
                "kicks against friction with the table, and what else slows blocks, an estimate (docs/concepts/physical-model.md)"
            }
            SpeedFrom::Eddies => "eddies that take the blocks along, at most",
            SpeedFrom::Heat if self.scene.drag.is_some() => {
                "the heat of the fluid, as the mean of a tick; less, because `drag` slows blocks as well"
            }
            SpeedFrom::Heat => "the heat of the fluid, as the mean of a tick, exact",
            SpeedFrom::Nothing => {
                "it never stops growing: nothing takes energy away from the blocks"
            }
        };
        let Some(rms) = self.speed.rms else {
            return format!("v: {from}");
        };
        let block = BlockUnits::from_scene(self.scene).speed(rms);
        format!(
            "v = {}, {}: {from}",
            in_unit(rms, "m/s"),
            in_unit(block, "a/τ")
        )
    }

    /// Returns the smallest number of substeps per tick that keeps all dimensionless numbers within
    /// their limits. Ignores limits that no number of substeps can satisfy.
    fn needed(&self) -> u32 {
        let needed = self
            .numbers
            .iter()
            .filter_map(DimensionlessNumber::substeps);
        needed.max().unwrap_or(1)
    }

    fn contact(&self) -> Option<&ContactLaw> {
        self.scene.contact.as_ref().map(|contact| &contact.law)
    }
}

/// Returns the upper limit of a dimensionless number. Returns `None` if it has none.
fn most(group: &DimensionlessNumber) -> Option<f64> {
    let advised = match group.advised {
        Some(AdvisedRange::Most(most)) => Some(most),
        _ => None,
    };
    let expected = group.expected.map(|expected| expected.most);
    group.limit.map(|limit| limit.most).or(expected).or(advised)
}

/// Returns the lower limit of a dimensionless number. Returns `None` if it has none.
fn least(group: &DimensionlessNumber) -> Option<f64> {
    match group.advised {
        Some(AdvisedRange::Least(least)) => Some(least),
        _ => None,
    }
}

fn in_unit(value: f64, unit: &str) -> String {
    format!("{} {unit}", short(value)).trim_end().to_owned()
}
