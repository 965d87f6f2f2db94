//! The clause `bond`, of each kind.
use super::super::{Anchor, Bond, Magnets, Measure, Pump, Reach};
use super::value::{Kind, Values};
use super::write::{self, write};
use super::{Law, Term};

impl Values {
    pub fn bond(&self, bond: &Bond) -> Term {
        match bond {
            Bond::Attract {
                pull,
                align,
                anchor,
            } => self.attract(pull, align.as_ref(), anchor),
            Bond::Reject {
                magnets,
                anchor,
                impulse,
            } => self.reject(magnets, anchor, *impulse),
            Bond::Suction { pump, seal, anchor } => self.suction(pump, *seal, anchor),
        }
    }

    fn attract(&self, pull: &Reach, align: Option<&Reach>, anchor: &Anchor) -> Term {
        let reach = |reach: &Reach| {
            let (force, within) = (
                write(reach.force, &write::FORCE),
                write(reach.within, &write::LENGTH),
            );
            format!("{force} within {within}")
        };
        let mut text = format!("bond attract {{ pull {}", reach(pull));
        let mut laws = vec![Law {
            meaning: "pulls the nearest face of every free block in reach of a magnetized face",
            equation: Some("|f| = F on the centre of that face, towards the magnetized one's"),
            values: vec![
                self.of(Kind::Force, "F", "pull", pull.force),
                self.of(Kind::Length, "r", "its reach", pull.within),
            ],
        }];
        if let Some(align) = align {
            text.push_str(&format!("  align {}", reach(align)));
            laws.push(Law {
                meaning: "turns that face, once closer, into the nearest quarter turn",
                equation: Some("|f| = f on each of its four corners, towards its counterpart"),
                values: vec![
                    self.of(Kind::Force, "f", "align", align.force),
                    self.of(Kind::Length, "q", "its reach", align.within),
                ],
            });
        }
        let (anchor, law) = self.anchor(anchor);
        text.push_str(&format!("  {anchor} }}"));
        laws.push(law);
        Term {
            clause: "bond",
            text,
            laws,
        }
    }

    fn reject(&self, magnets: &Magnets, anchor: &Anchor, impulse: f64) -> Term {
        let (written, law) = self.anchor(anchor);
        Term {
            clause: "bond",
            text: format!(
                "bond reject {{ hold {}  depth {}  within {}  impulse {}  {written} }}",
                write(magnets.hold, &write::FORCE),
                write(magnets.depth, &write::LENGTH),
                write(magnets.within, &write::LENGTH),
                write(impulse, &write::IMPULSE)
            ),
            laws: vec![
                Law {
                    meaning: "faces always attract each other, by four pairs of dipoles at half of the \
                              way from the middle to the corners",
                    equation: Some(
                        "f = F / 4 (1 + d / δ)⁻⁴ between two of a pair at the distance d",
                    ),
                    values: vec![
                        self.of(Kind::Force, "F", "hold", magnets.hold),
                        self.of(Kind::Length, "δ", "depth", magnets.depth),
                        self.of(Kind::Length, "r", "reach", magnets.within),
                    ],
                },
                law,
                Law {
                    meaning: "a block that is rejected leaves along the normal of the face",
                    equation: Some("v = J / m"),
                    values: vec![self.of(Kind::Impulse, "J", "impulse", impulse)],
                },
            ],
        }
    }

    fn suction(&self, pump: &Pump, seal: f64, anchor: &Anchor) -> Term {
        let (written, law) = self.anchor(anchor);
        let resistance = |value| write(value, &write::RESISTANCE);
        Term {
            clause: "bond",
            text: format!(
                "bond suction {{ head {}  supply {}  valve {}  passage {}  seal {}  {written} }}",
                write(pump.head, &write::PRESSURE),
                resistance(pump.supply),
                resistance(pump.valve),
                resistance(pump.passage),
                write(seal, &write::LENGTH)
            ),
            laws: vec![
                Law {
                    meaning: "open faces share the pump through the tree of blocks; every flow is laminar",
                    equation: Some("Δp = R Q on each way, flows into a chamber sum to none"),
                    values: vec![
                        self.of(Kind::Pressure, "H", "head", pump.head),
                        self.of(Kind::Resistance, "R_s", "supply", pump.supply),
                        self.of(Kind::Resistance, "R_v", "valve", pump.valve),
                        self.of(Kind::Resistance, "R_p", "passage", pump.passage),
                    ],
                },
                Law {
                    meaning: "an open face is a sink before a wall, whose flow takes blocks along",
                    equation: Some("u = Q / (2 π d²) towards the face"),
                    values: vec![],
                },
                Law {
                    meaning: "a block that is close feels the pressure drop on its face",
                    equation: Some(
                        "within s, |f| = Δp a², half on the centre, the rest on the corners",
                    ),
                    values: vec![self.of(Kind::Length, "s", "seal", seal)],
                },
                law,
            ],
        }
    }

    /// As it is written, and what it does.
    fn anchor(&self, anchor: &Anchor) -> (String, Law) {
        let (measure, equation) = match anchor.measure {
            Measure::Centres => (
                "centres",
                "centres of the two faces < d, normals < α from opposite",
            ),
            Measure::Gap => (
                "gap",
                "gap along the normal < d, aside < a / 2, normals < α from opposite",
            ),
        };
        let law = Law {
            meaning: "then the block is anchored, snaps onto the lattice and is fixed",
            equation: Some(equation),
            values: vec![
                self.of(Kind::Length, "d", "anchoring distance", anchor.within),
                self.of(Kind::Angle, "α", "tilt", anchor.tilt),
            ],
        };
        let text = format!(
            "anchor {measure} {} tilt {}",
            write(anchor.within, &write::LENGTH),
            write(anchor.tilt, &write::ANGLE)
        );
        (text, law)
    }
}
