//! The clauses of what is around the blocks: `fluid`, `flow` and `agitation`.
use stochc_grammar::tree::Name;
use stochc_ir::scene::units::Dimension;
use stochc_ir::scene::{Agitation, Flow, Fluid, Jets, Stir, Strength, Turbulence};

use super::{Draft, Reader};
use crate::finding::{Code, Finding, tell};

impl Reader<'_, '_> {
    /// `{ density 920 kg/m^3  viscosity 60 mPa s }`, one of them at least
    pub(super) fn fluid(&mut self, clause: Name) -> Option<Fluid> {
        let before = self.findings.len();
        let (mut density, mut viscosity) = (None, None);
        self.fields(
            clause,
            &["density", "viscosity"],
            &[],
            |r, field| match field {
                "density" => density = r.positive(Dimension::DENSITY),
                _ => viscosity = r.positive(Dimension::VISCOSITY),
            },
        );
        if density.is_none() && viscosity.is_none() {
            if self.findings.len() == before {
                let finding = self.without(clause, "viscosity");
                tell(
                    self.findings,
                    finding.help("add it, or `density`: a fluid with neither does nothing"),
                );
            }
            return None;
        }
        Some(Fluid { density, viscosity })
    }

    /// `stir { radius 8.5cm  rate 0.455 rev/s  force 0.795 N  follow 30% }`, or
    /// `jets { count 5  flow 94.5 L/min  nozzle 2cm }`
    pub(super) fn flow(&mut self, clause: Name) -> Option<Flow> {
        if self.kind_of_clause(&["stir", "jets"], "flow")? == "jets" {
            let (mut count, mut flow, mut nozzle) = (None, None, None);
            let all = ["count", "flow", "nozzle"];
            self.fields(clause, &all, &all, |r, field| match field {
                "count" => count = r.count(1, 64),
                "flow" => flow = r.positive(Dimension::FLOW),
                _ => nozzle = r.positive(Dimension::LENGTH),
            });
            return Some(Flow::Jets(Jets {
                count: count? as u8,
                flow: flow?,
                nozzle: nozzle?,
            }));
        }
        let (mut radius, mut rate, mut force, mut follow) = (None, None, None, None);
        let all = ["radius", "rate", "force", "follow"];
        let needed = ["radius", "rate", "follow"];
        self.fields(clause, &all, &needed, |r, field| match field {
            "radius" => radius = r.positive(Dimension::LENGTH),
            "rate" => rate = r.between(Dimension::RATE, 0.0, f64::MAX),
            "force" => force = r.positive(Dimension::FORCE),
            _ => follow = r.between(Dimension::NUMBER, 0.0, 1.0),
        });
        Some(Flow::Stir(Stir {
            radius: radius?,
            rate: rate?,
            force,
            follow: follow?,
        }))
    }

    /// `kicks { ... }`, `turbulence { ... }` or `brownian { ... }`
    pub(super) fn agitation(&mut self, clause: Name) -> Option<Agitation> {
        match self.kind_of_clause(&["kicks", "turbulence", "brownian"], "agitation")? {
            "kicks" => {
                let mut speed = None;
                self.fields(clause, &["speed"], &["speed"], |r, _| {
                    speed = r.range(Dimension::SPEED);
                });
                speed.map(|speed| Agitation::Kicks { speed })
            }
            "brownian" => {
                let mut temperature = None;
                self.fields(clause, &["temperature"], &["temperature"], |r, _| {
                    temperature = r.positive(Dimension::TEMPERATURE);
                });
                temperature.map(|temperature| Agitation::Brownian { temperature })
            }
            _ => self.turbulence(clause),
        }
    }

    /// `{ speed 4 cm/s  length 8cm  time 0.5 s  vertical 50% }`, or `intensity 20%` instead of a speed
    fn turbulence(&mut self, clause: Name) -> Option<Agitation> {
        let (mut speed, mut intensity, mut length, mut time, mut vertical) =
            (None, None, None, None, None);
        let all = ["speed", "intensity", "length", "time", "vertical"];
        let before = self.findings.len();
        self.fields(clause, &all, &["length"], |r, field| {
            let place = r.place;
            match field {
                "speed" => speed = Some((place, r.positive(Dimension::SPEED))),
                "intensity" => {
                    intensity = Some((place, r.between(Dimension::NUMBER, 0.0, f64::MAX)));
                }
                "length" => length = r.positive(Dimension::LENGTH),
                "time" => time = r.positive(Dimension::TIME),
                _ => vertical = r.between(Dimension::NUMBER, 0.01, 100.0),
            }
        });
        let strength = match (speed, intensity) {
            (Some((speed, _)), Some((intensity, _))) => {
                let title = "turbulence with a speed and an intensity";
                let finding = Finding::new(Code::ConflictingTerms, title)
                    .label(self.site(intensity), "a part of the speed of the flow")
                    .label(self.site(speed), "a speed of its own")
                    .help("remove one of the two");
                tell(self.findings, finding);
                return None;
            }
            (Some((_, speed)), None) => Strength::Speed(speed?),
            (None, Some((_, intensity))) => Strength::Intensity(intensity?),
            (None, None) => {
                if self.findings.len() == before {
                    let finding = self.without(clause, "speed");
                    let help = "add it, or `intensity` as a part of the speed of a `flow`";
                    tell(self.findings, finding.help(help));
                }
                return None;
            }
        };
        Some(Agitation::Turbulence(Turbulence {
            strength,
            length: length?,
            time,
            vertical: vertical.unwrap_or(1.0),
        }))
    }

    /// Whether what moves the fluid has a fluid to move.
    pub(super) fn medium(&mut self, draft: &Draft, seen: &[Name]) {
        let viscosity = draft.fluid.as_ref().and_then(|fluid| fluid.viscosity);
        let symbols = self.symbols;
        let said =
            |clause: &str| (seen.iter().find(|name| symbols.word(name.symbol) == clause)).copied();
        let (fluid, flow) = (
            (said("fluid"), draft.fluid.is_none()),
            (said("flow"), draft.flow.is_none()),
        );
        // A clause that is there but wrong has been told of.
        let lacks = |(said, none): (Option<Name>, bool)| none && said.is_none();
        let mut wrong: Vec<(&str, &str, &str, &str)> = Vec::new();
        match &draft.agitation {
            Some(Agitation::Brownian { .. }) if viscosity.is_none() && (lacks(fluid) || draft.fluid.is_some()) => {
                wrong.push((
                    "agitation",
                    "Brownian motion without a viscous fluid",
                    "the molecules of what?",
                    "add `fluid { viscosity 1 mPa s }`, whose drag the fluctuations balance",
                ));
            }
            Some(Agitation::Turbulence(_)) if lacks(fluid) => wrong.push((
                "agitation",
                "turbulence without a fluid",
                "moves nothing",
                "add `fluid { density 1000 kg/m^3  viscosity 1 mPa s }`, which takes the blocks along",
            )),
            Some(Agitation::Turbulence(Turbulence { strength: Strength::Intensity(_), .. })) if lacks(flow) => {
                wrong.push((
                    "agitation",
                    "an intensity of turbulence without a flow",
                    "a part of which speed?",
                    "add a `flow`, or say `speed` instead of `intensity`",
                ));
            }
            _ => {}
        }
        if draft.flow.is_some() && lacks(fluid) {
            wrong.push((
                "flow",
                "a flow without a fluid",
                "moves nothing",
                "add `fluid { density 1000 kg/m^3  viscosity 1 mPa s }`, which takes the blocks along",
            ));
        }
        for (clause, title, label, help) in wrong {
            let span = said(clause).map_or(self.place, |name| name.span);
            self.tell(
                Code::MissingTerm,
                title.to_owned(),
                span,
                label,
                help.to_owned(),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;
    use stochc_ir::scene::Scene;

    /// A scene from `hemisphere` with these clauses, and what is told of it.
    fn scene(clauses: &str) -> (Option<Scene>, Vec<(Code, String)>) {
        let (scene, findings) = sample::scene(clauses);
        let told = findings.into_iter();
        (scene, told.map(|it| (it.code, it.title)).collect())
    }

    #[test]
    fn a_stirred_tank_is_read_in_units_of_the_laboratory() {
        let (scene, found) = scene(
            "gravity 9.81 m/s^2  fluid { density 0.92 g/cm^3  viscosity 60 mPa s }
             flow stir { radius 8.5cm  rate 0.455 rev/s  force 0.795 N  follow 20% }
             agitation turbulence { intensity 3%  length 16cm  vertical 50% }",
        );
        assert_eq!(found, []);
        let scene = scene.unwrap();
        let (fluid, flow) = (scene.fluid.unwrap(), scene.flow.unwrap());
        assert!((fluid.density.unwrap() - 920.0).abs() < 1e-9);
        assert_eq!(fluid.viscosity, Some(0.06));
        let Flow::Stir(stir) = &flow else {
            panic!("it is stirred");
        };
        // The paper's power at its lowest rate.
        assert!((stir.power().unwrap() - 0.193).abs() < 5e-4);
        let Some(Agitation::Turbulence(turbulence)) = &scene.agitation else {
            panic!("it is turbulent");
        };
        assert!((turbulence.speed(Some(&flow)) - 0.03 * stir.speed()).abs() < 1e-12);
        assert_eq!((turbulence.time, turbulence.vertical), (None, 0.5));
    }

    #[test]
    fn jets_have_the_speed_of_their_flow() {
        let (scene, found) = scene(
            "fluid { density 920 kg/m^3 }  flow jets { count 5  flow 94.5 L/min  nozzle 2cm }",
        );
        assert_eq!(found, []);
        let speed = scene.unwrap().flow.unwrap().speed();
        let exact = 94.5e-3 / 60.0 / 5.0 / (std::f64::consts::PI * 1e-4);
        assert!((speed / exact - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_has_nothing_to_move_is_told_once() {
        let missing = |clauses: &str, title: &str| {
            let (scene, found) = scene(clauses);
            assert_eq!(scene, None, "{clauses}");
            assert_eq!(found, [(Code::MissingTerm, title.to_owned())], "{clauses}");
        };
        missing(
            "agitation brownian { temperature 3 K }",
            "Brownian motion without a viscous fluid",
        );
        missing(
            "fluid { density 1 kg/m^3 }  agitation brownian { temperature 3 K }",
            "Brownian motion without a viscous fluid",
        );
        missing("fluid { }", "`fluid` without `viscosity`");
        missing(
            "flow jets { count 1  flow 1 L/min  nozzle 1cm }",
            "a flow without a fluid",
        );
        missing(
            "agitation turbulence { speed 1 m/s  length 1 m }",
            "turbulence without a fluid",
        );
        missing(
            "fluid { viscosity 1 Pa s }  agitation turbulence { intensity 10%  length 1 m }",
            "an intensity of turbulence without a flow",
        );
        missing(
            "fluid { viscosity 1 Pa s }  agitation turbulence { length 1 m }",
            "`agitation` without `speed`",
        );
    }

    #[test]
    fn an_unknown_kind_is_told_once_with_what_is_known() {
        for (clause, title) in [
            (
                "bond sucktion { head 1 Pa }",
                "expected a bond, found `sucktion`",
            ),
            (
                "flow river { speed 1 m/s }",
                "expected a flow, found `river`",
            ),
            (
                "agitation quakes { }",
                "expected an agitation, found `quakes`",
            ),
        ] {
            let (scene, found) = scene(clause);
            assert_eq!(scene, None);
            assert_eq!(found, [(Code::UnknownTerm, title.to_owned())]);
        }
    }
}
