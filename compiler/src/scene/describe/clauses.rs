//! The clauses of a scene, each as it is written and what it does.
use super::super::groups::rms_of_range;
use super::super::{
    Agitation, Anchor, Arrangement, Bond, Contact, ContactLaw, Drag, Enclosure, Measure, Messages,
    Reach, Scene,
};
use super::value::{Kind, Values};
use super::write::{self, write};
use super::{Law, Term};

impl Values {
    pub fn tick(&self, scene: &Scene) -> Term {
        Term {
            clause: "tick",
            text: format!("tick {}", write(scene.tick, &write::TIME)),
            laws: vec![Law {
                meaning: "the clock: kicks fall, messages travel and times are told once a tick",
                equation: None,
                values: vec![self.of(Kind::Time, "τ", "tick", scene.tick)],
            }],
        }
    }

    pub fn block(&self, scene: &Scene) -> Term {
        let block = &scene.block;
        let inertia = block.mass * block.side * block.side / 6.0;
        Term {
            clause: "block",
            text: format!(
                "block cube {{ side {}  mass {}  faces {} }}",
                write(block.side, &write::LENGTH),
                write(block.mass, &write::MASS),
                block.faces
            ),
            laws: vec![Law {
                meaning: "the blocks are cubes, their mass spread evenly",
                equation: Some("I = m a² / 6 about every axis"),
                values: vec![
                    self.of(Kind::Length, "a", "side", block.side),
                    self.of(Kind::Mass, "m", "mass", block.mass),
                    self.of(Kind::Inertia, "I", "moment of inertia", inertia),
                    self.of(
                        Kind::Number,
                        "",
                        "faces magnetized at a time",
                        f64::from(block.faces),
                    ),
                ],
            }],
        }
    }

    pub fn free(&self, scene: &Scene) -> Term {
        let Arrangement::Uniform = scene.free.arrangement;
        Term {
            clause: "free",
            text: format!("free {} uniform", scene.free.count),
            laws: vec![Law {
                meaning: "at the beginning blocks are at rest on a cubic lattice in the enclosure",
                equation: None,
                values: vec![self.of(
                    Kind::Number,
                    "N",
                    "free blocks",
                    f64::from(scene.free.count),
                )],
            }],
        }
    }

    pub fn messages(&self, messages: &Messages) -> Term {
        let mut text = format!("messages {{ hop {} ticks", messages.hop);
        let mut laws = vec![Law {
            meaning: "a message needs this long from a block to its parent or child",
            equation: None,
            values: vec![self.of(Kind::Ticks, "h", "hop", f64::from(messages.hop))],
        }];
        if let Some(loss) = messages.loss {
            text.push_str(&format!("  loss {}", write(loss, &write::NUMBER)));
            laws.push(Law {
            meaning: "a hop may be lost, and so may its acknowledgement; without one the sender \
                      sends again",
            equation: Some("a hop arrives with probability 1 - p; again after 2 h + 1 ticks"),
            values: vec![self.of(Kind::Number, "p", "loss", loss)],
        });
        }
        text.push_str(" }");
        Term {
            clause: "messages",
            text,
            laws,
        }
    }

    pub fn drag(&self, drag: &Drag) -> Term {
        Term {
            clause: "drag",
            text: format!("drag {{ rate {} }}", write(drag.rate, &write::RATE)),
            laws: vec![Law {
                meaning: "slows the centre of every free block",
                equation: Some("v' = -γ v, by v *= exp(-γ dt) in each step"),
                values: vec![self.of(Kind::Rate, "γ", "rate", drag.rate)],
            }],
        }
    }
    pub fn enclosure(&self, enclosure: &Enclosure) -> Term {
        let Enclosure::Hemisphere { radius, wall } = *enclosure;
        Term {
            clause: "enclosure",
            text: format!(
                "enclosure hemisphere {{ radius {}  wall {} }}",
                write(radius, &write::LENGTH),
                write(wall, &write::STIFFNESS)
            ),
            laws: vec![Law {
                meaning: "an elastic shell over the floor z = 0, felt by the centre of a block",
                equation: Some("outside R, m v' = -k (|x| - R) x / |x|"),
                values: vec![
                    self.of(Kind::Length, "R", "radius", radius),
                    self.of(Kind::Stiffness, "k", "wall", wall),
                ],
            }],
        }
    }

    pub fn agitation(&self, agitation: &Agitation) -> Term {
        let Agitation::Kicks { speed: (low, high) } = *agitation;
        let range = if low == high {
            write(low, &write::SPEED)
        } else {
            // A zero has the unit of what it goes up to.
            let unit = if low == 0.0 {
                &write::NUMBER
            } else {
                &write::SPEED
            };
            format!("{} .. {}", write(low, unit), write(high, &write::SPEED))
        };
        Term {
            clause: "agitation",
            text: format!("agitation kicks {{ speed {range} }}"),
            laws: vec![Law {
                meaning: "an impulse through the centre of every free block, once a tick",
                equation: Some(
                    "v += s n, s uniform in [u, w], n isotropic; j² = (u² + u w + w²) / 3",
                ),
                values: vec![
                    self.of(Kind::Speed, "u", "least change of speed", low),
                    self.of(Kind::Speed, "w", "most change of speed", high),
                    self.of(
                        Kind::Speed,
                        "j",
                        "rms change of speed",
                        rms_of_range(low, high),
                    ),
                ],
            }],
        }
    }

    pub fn contact(&self, contact: &Contact) -> Term {
        let friction = self.of(Kind::Number, "μ", "friction", contact.friction);
        let (fields, law) = match contact.law {
            ContactLaw::Rigid { restitution } => (
                format!("restitution {}", write(restitution, &write::NUMBER)),
                Law {
                    meaning: "blocks, structure and floor do not overlap; they collide, and rub",
                    equation: Some(
                        "along the normal u -> -e u; across it at most μ times that impulse",
                    ),
                    values: vec![
                        self.of(Kind::Number, "e", "restitution", restitution),
                        friction,
                    ],
                },
            ),
            ContactLaw::Compliant { stiffness, damping } => (
                format!(
                    "stiffness {}  damping {}",
                    write(stiffness, &write::STIFFNESS),
                    write(damping, &write::DAMPING)
                ),
                Law {
                    meaning: "blocks, structure and floor repel where they overlap by a depth d, \
                              and rub",
                    equation: Some(
                        "f = max(0, k d + c d') along the normal, shared in proportion to depth; \
                         across it at most μ f",
                    ),
                    values: vec![
                        self.of(Kind::Stiffness, "k", "stiffness", stiffness),
                        self.of(Kind::Damping, "c", "damping", damping),
                        friction,
                    ],
                },
            ),
        };
        let friction = write(contact.friction, &write::NUMBER);
        Term {
            clause: "contact",
            text: format!("contact {{ {fields}  friction {friction} }}"),
            laws: vec![law],
        }
    }

    pub fn bond(&self, bond: &Bond) -> Term {
        let Bond::Attract {
            pull,
            align,
            anchor,
        } = bond;
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
        let (measure, law) = self.anchor(anchor);
        text.push_str(&format!(
            "  anchor {measure} {} tilt {} }}",
            write(anchor.within, &write::LENGTH),
            write(anchor.tilt, &write::ANGLE)
        ));
        laws.push(law);
        Term {
            clause: "bond",
            text,
            laws,
        }
    }

    fn anchor(&self, anchor: &Anchor) -> (&'static str, Law) {
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
        (measure, law)
    }
}
