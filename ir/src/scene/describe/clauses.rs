//! The clauses of a scene, each as it is written and what it does.
use super::super::{Arrangement, Contact, ContactLaw, Enclosure, Messages, Scene};
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
        let mut values = vec![self.of(
            Kind::Number,
            "N",
            "free blocks",
            f64::from(scene.free.count),
        )];
        let (arrangement, meaning) = match scene.free.arrangement {
            Arrangement::Uniform => (
                "uniform".to_owned(),
                "at the beginning blocks are at rest on a cubic lattice in the enclosure",
            ),
            Arrangement::Ring { radius } => {
                values.push(self.of(Kind::Length, "s", "radius of the circle", radius));
                (
                    format!("ring {}", write(radius, &write::LENGTH)),
                    "at the beginning blocks are at rest, evenly on a level circle halfway up",
                )
            }
        };
        Term {
            clause: "free",
            text: format!("free {} {arrangement}", scene.free.count),
            laws: vec![Law {
                meaning,
                equation: None,
                values,
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

    pub fn enclosure(&self, enclosure: &Enclosure) -> Term {
        let (kind, radius, wall, meaning, equation) = match *enclosure {
            Enclosure::Hemisphere { radius, wall } => (
                "hemisphere",
                radius,
                wall,
                "an elastic shell over the floor z = 0, felt by the centre of a block",
                "outside R, m v' = -k (|x| - R) x / |x|",
            ),
            Enclosure::Sphere { radius, wall } => (
                "sphere",
                radius,
                wall,
                "an elastic ball, cut off by the floor z = 0 where the plate just fills the cut; felt by \
                 the ball in a block",
                "y = x - c; beyond R, m v' = -k (|y| + a / 2 - R) y / |y|",
            ),
        };
        Term {
            clause: "enclosure",
            text: format!(
                "enclosure {kind} {{ radius {}  wall {} }}",
                write(radius, &write::LENGTH),
                write(wall, &write::STIFFNESS)
            ),
            laws: vec![Law {
                meaning,
                equation: Some(equation),
                values: vec![
                    self.of(Kind::Length, "R", "radius", radius),
                    self.of(Kind::Stiffness, "k", "wall", wall),
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
}
