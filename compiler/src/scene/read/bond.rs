//! The clause `bond`, of three kinds.
use stochc_grammar::tree::Name;
use stochc_ir::scene::units::Dimension;
use stochc_ir::scene::{Anchor, Bond, Magnets, Measure, Pump, Reach};

use super::{Reader, span};
use crate::finding::Code;

impl Reader<'_, '_> {
    /// `attract { ... }`, `reject { ... }` or `suction { ... }`
    pub(super) fn bond(&mut self, clause: Name) -> Option<Bond> {
        match self.kind_of_clause(&["attract", "reject", "suction"], "bond")? {
            "reject" => self.reject(clause),
            "suction" => self.suction(clause),
            _ => self.attract(clause),
        }
    }

    /// `{ pull 7.5 N within 20cm  align 0.375 N within 10cm  anchor centres 1mm tilt 26 deg }`
    fn attract(&mut self, clause: Name) -> Option<Bond> {
        let (mut pull, mut align, mut anchor) = (None, None, None);
        let all = ["pull", "align", "anchor"];
        self.fields(clause, &all, &["pull", "anchor"], |r, field| match field {
            "pull" => pull = r.reach(),
            "align" => align = r.reach(),
            _ => anchor = r.anchor(),
        });
        Some(Bond::Attract {
            pull: pull?,
            align,
            anchor: anchor?,
        })
    }

    /// `{ hold 5 N  depth 1cm  within 10cm  impulse 0.1 N s  anchor centres 3mm tilt 20 deg }`
    fn reject(&mut self, clause: Name) -> Option<Bond> {
        let (mut hold, mut depth, mut within, mut impulse, mut anchor) =
            (None, None, None, None, None);
        let all = ["hold", "depth", "within", "impulse", "anchor"];
        self.fields(clause, &all, &all, |r, field| match field {
            "hold" => hold = r.positive(Dimension::FORCE),
            "depth" => depth = r.positive(Dimension::LENGTH),
            "within" => within = r.positive(Dimension::LENGTH),
            "impulse" => impulse = r.between(Dimension::IMPULSE, 0.0, f64::MAX),
            _ => anchor = r.anchor(),
        });
        Some(Bond::Reject {
            magnets: Magnets {
                hold: hold?,
                depth: depth?,
                within: within?,
            },
            anchor: anchor?,
            impulse: impulse?,
        })
    }

    /// `{ head 2 kPa  supply 2 kPa s/L  valve 1 kPa s/L  passage 1 kPa s/L  seal 1cm  anchor ... }`
    fn suction(&mut self, clause: Name) -> Option<Bond> {
        let (mut head, mut supply, mut valve, mut passage, mut seal, mut anchor) =
            (None, None, None, None, None, None);
        let all = ["head", "supply", "valve", "passage", "seal", "anchor"];
        self.fields(clause, &all, &all, |r, field| match field {
            "head" => head = r.positive(Dimension::PRESSURE),
            "supply" => supply = r.between(Dimension::RESISTANCE, 0.0, f64::MAX),
            "valve" => valve = r.positive(Dimension::RESISTANCE),
            "passage" => passage = r.between(Dimension::RESISTANCE, 0.0, f64::MAX),
            "seal" => seal = r.positive(Dimension::LENGTH),
            _ => anchor = r.anchor(),
        });
        Some(Bond::Suction {
            pump: Pump {
                head: head?,
                supply: supply?,
                valve: valve?,
                passage: passage?,
            },
            seal: seal?,
            anchor: anchor?,
        })
    }

    /// `centres 1mm tilt 26 deg`
    fn anchor(&mut self) -> Option<Anchor> {
        let word = self.head(
            &["centres", "gap"],
            "measure of the anchoring distance",
            &[],
        )?;
        let measure = match self.word_of(word) {
            "gap" => Measure::Gap,
            _ => Measure::Centres,
        };
        let within = self.positive(Dimension::LENGTH);
        let tilt = if self.next_is("tilt") {
            self.between(Dimension::NUMBER, 1e-6, std::f64::consts::FRAC_PI_2)
        } else {
            Some(std::f64::consts::FRAC_PI_4)
        };
        (within.zip(tilt)).map(|(within, tilt)| Anchor {
            measure,
            within,
            tilt,
        })
    }

    /// `15 N within 20cm`
    fn reach(&mut self) -> Option<Reach> {
        let force = self.between(Dimension::FORCE, 0.0, f64::MAX);
        if !self.next_is("within") {
            let here = self.terms.peek().map_or(self.place, |term| span(term));
            self.tell(
                Code::MissingTerm,
                "a force without its reach".to_owned(),
                here,
                "`within` and a length belong here",
                "write how far it reaches, such as `15 N within 20cm`".to_owned(),
            );
            return None;
        }
        let within = self.positive(Dimension::LENGTH);
        Some(Reach {
            force: force?,
            within: within?,
        })
    }
}
