//! `stochc check --scene`: the physics that is in force.
use std::fmt::Write as _;

use serde_json::{Value as Json, json};
use stochc_compiler::Checked;
use stochc_compiler::scene::describe::{Absent, Term, Value, absent, terms};
use stochc_compiler::scene::groups::{BlockUnits, Group, Speed, SpeedFrom, groups, speed};
use stochc_compiler::scene::{ContactLaw, Scene};
use stochc_runtime::SUBSTEPS;

/// A scene that assemblies of a file run in, and all that is said of it.
pub struct InForce<'a> {
    file: &'a str,
    scene: &'a Scene,
    /// The names of those assemblies.
    assemblies: Vec<&'a str>,
    terms: Vec<Term>,
    absent: Vec<Absent>,
    speed: Speed,
    groups: Vec<Group>,
}

/// The scenes of a file's assemblies, each once, in the order of the assemblies.
pub fn scenes<'a>(file: &'a str, checked: &'a Checked) -> Vec<InForce<'a>> {
    let mut out: Vec<InForce> = Vec::new();
    for program in &checked.programs {
        let Some(scene) = &program.scene else {
            continue;
        };
        let name = program.plan.name.as_str();
        match out.iter_mut().find(|it| it.scene == scene) {
            Some(known) => known.assemblies.push(name),
            None => out.push(InForce {
                file,
                scene,
                assemblies: vec![name],
                terms: terms(scene),
                absent: absent(scene),
                speed: speed(scene),
                groups: groups(scene),
            }),
        }
    }
    out
}

impl InForce<'_> {
    /// The listing as one JSON object: `{ file, scene, assemblies, terms, absent, speed, groups, warnings }`.
    pub fn json(&self) -> Json {
        let units = BlockUnits::of(self.scene);
        let group = |group: &Group| {
            json!({
                "symbol": group.symbol,
                "meaning": group.meaning,
                "value": group.value,
                "most": group.limit.map(|limit| limit.most),
                "exceeded": group.is_exceeded(),
                "substeps": group.substeps(),
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
            "groups": self.groups.iter().map(group).collect::<Vec<_>>(),
            "warnings": self.warnings().map(|warning| warning.join(": ")).collect::<Vec<_>>(),
        })
    }

    /// The listing to read.
    pub fn text(&self) -> String {
        let mut out = format!(
            "{}: scene {}, of {}\n\n  in force, with the values in SI units and in block units\n",
            self.file,
            self.scene.name,
            self.assemblies.join(", ")
        );
        self.list_terms(&mut out);
        if !self.absent.is_empty() {
            out.push_str("\n  absent, and not computed\n");
            let width = width(self.absent.iter().map(|it| it.clause));
            for Absent { clause, meaning } in &self.absent {
                let _ = writeln!(out, "    {clause:width$}  {meaning}");
            }
        }
        let _ = write!(
            out,
            "\n  expected speed of a free block, rms\n    {}\n",
            self.expected()
        );
        self.list_groups(&mut out);
        out.push('\n');
        let warnings: Vec<_> = self.warnings().collect();
        for [what, beyond] in &warnings {
            let _ = writeln!(out, "  warning: {what}\n           {beyond}");
        }
        if warnings.is_empty() {
            let _ = writeln!(
                out,
                "  {} short enough for all of these.",
                match self.needed() {
                    1 => "One step a tick is".to_owned(),
                    needed => format!(
                        "{needed} steps a tick are needed, and the {SUBSTEPS} that `simulate` takes are"
                    ),
                }
            );
        }
        if self.needed() > 1 && matches!(self.contact(), Some(ContactLaw::Rigid { .. })) {
            out.push_str(
                "  With rigid contacts, a scene with other substeps is another scene: what was calibrated \
                 has to be calibrated anew.\n",
            );
        }
        out
    }

    fn list_terms(&self, out: &mut String) {
        let values = || (self.terms.iter().flat_map(|term| &term.laws)).flat_map(|law| &law.values);
        let symbol = width(values().map(|value| value.symbol));
        let name = width(values().map(|value| value.name));
        let si = width(values().map(si_of));
        for term in &self.terms {
            let _ = writeln!(out, "    {}", term.text);
            for law in &term.laws {
                let _ = writeln!(out, "      {}", law.meaning);
                if let Some(equation) = law.equation {
                    let _ = writeln!(out, "      {equation}");
                }
                for value in &law.values {
                    let line = format!(
                        "        {:symbol$}  {:name$}  {:si$}  {}",
                        value.symbol,
                        value.name,
                        si_of(value),
                        in_unit(value.block, value.block_unit),
                    );
                    let _ = writeln!(out, "{}", line.trim_end());
                }
            }
        }
    }

    fn list_groups(&self, out: &mut String) {
        let symbol = width(self.groups.iter().map(|group| group.symbol));
        let meaning = width(self.groups.iter().map(|group| group.meaning));
        let _ = writeln!(
            out,
            "\n  {:w$}  value      at most, about",
            "groups",
            w = symbol + meaning + 4
        );
        for group in &self.groups {
            let most = (group.limit).map_or(String::new(), |limit| short(limit.most));
            let line = format!(
                "    {:symbol$}  {:meaning$}  {:9}  {most}",
                group.symbol,
                group.meaning,
                short(group.value),
            );
            let _ = writeln!(out, "{}", line.trim_end());
        }
    }

    fn expected(&self) -> String {
        let from = match self.speed.from {
            SpeedFrom::Rest => "nothing moves the blocks by chance",
            SpeedFrom::Drag => "kicks against drag, exact",
            SpeedFrom::Collisions if self.scene.drag.is_some() => {
                "kicks against drag and inelastic collisions, an estimate (docs/model.md)"
            }
            SpeedFrom::Collisions => {
                "kicks against inelastic collisions, an estimate (docs/model.md)"
            }
            SpeedFrom::Eddies => "eddies that take the blocks along, at most",
            SpeedFrom::Heat => "the heat of the fluid, as the mean of a tick, exact",
            SpeedFrom::Nothing => {
                "it never stops growing: nothing takes energy away from the blocks"
            }
        };
        let Some(rms) = self.speed.rms else {
            return format!("v: {from}");
        };
        let block = BlockUnits::of(self.scene).speed(rms);
        format!(
            "v = {}, {}: {from}",
            in_unit(rms, "m/s"),
            in_unit(block, "a/τ")
        )
    }

    /// The fewest steps a tick that resolve all that any number of them does.
    fn needed(&self) -> u32 {
        let needed = self.groups.iter().filter_map(Group::substeps);
        needed.max().unwrap_or(1)
    }

    fn contact(&self) -> Option<&ContactLaw> {
        self.scene.contact.as_ref().map(|contact| &contact.law)
    }

    /// What the steps that are taken unasked do not resolve, and what comes of that.
    fn warnings(&self) -> impl Iterator<Item = [String; 2]> {
        /// As many as `simulate` takes.
        const MOST: u32 = 1000;
        (self.groups.iter())
            .filter(|group| group.is_exceeded())
            .filter_map(|group| {
                let limit = group.limit?;
                let cure = match group.substeps() {
                    Some(substeps) if substeps <= SUBSTEPS => return None,
                    Some(substeps) if substeps <= MOST => {
                        format!("`--substeps {substeps}` resolves it")
                    }
                    _ => "no number of substeps that is allowed resolves it".to_owned(),
                };
                let what = format!(
                    "{} is {}, more than {}; {cure}",
                    group.symbol,
                    short(group.value),
                    short(limit.most)
                );
                Some([what, limit.beyond.to_owned()])
            })
    }
}

fn si_of(value: &Value) -> String {
    in_unit(value.si, value.unit)
}

fn in_unit(value: f64, unit: &str) -> String {
    format!("{} {unit}", short(value)).trim_end().to_owned()
}

/// A number to four digits.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) || !rounded.is_finite() {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

/// The characters of the longest.
fn width<T: AsRef<str>>(texts: impl Iterator<Item = T>) -> usize {
    texts
        .map(|text| text.as_ref().chars().count())
        .max()
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_have_four_digits() {
        for (value, text) in [
            (0.0, "0"),
            (1.0 / 3.0, "0.3333"),
            (5.999_999_999, "6"),
            (10_000_000.0, "1e7"),
            (123_456.0, "123500"),
            (0.000_012_345_6, "1.235e-5"),
            (-2.0, "-2"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
