//! Penetration depths of blocks into compliant contacts and the wall.
use super::super::warning_kind::SceneWarningKind;
use super::super::{ContactLaw, Enclosure, Scene};
use super::{BlockUnits, DimensionlessNumber, ExpectedRange, settling, speed};

/// Spring of compliant contacts or of the wall, in block units.
#[derive(Clone, Copy)]
struct Spring {
    stiffness: f64,
    damping: f64,
    /// Steady force that presses a block into the spring \[block lengths / tick^2\].
    load: f64,
}

/// Words for the two depths of one kind of spring.
struct Words {
    symbols: [&'static str; 2],
    meanings: [&'static str; 2],
    beyond: [&'static str; 2],
    remedy: &'static str,
}

const CONTACT: Words = Words {
    symbols: ["F / (k a), contact", "v √(m/k) / a, contact"],
    meanings: [
        "block lengths that weight and drag press a block into its support",
        "block lengths that a block at the speed v penetrates other bodies",
    ],
    beyond: [
        "blocks at rest overlap their support, or sink through it",
        "blocks pass through each other, the structure and the floor",
    ],
    remedy: "give `contact` a larger `stiffness`",
};

const WALL: Words = Words {
    symbols: ["F / (k a), wall", "v √(m/k) / a, wall"],
    meanings: [
        "block lengths that weight and drag press a block out of the wall",
        "block lengths that a block at the speed v goes out of the wall",
    ],
    beyond: [
        "blocks are pressed out of the enclosure",
        "fast blocks go more than a block length out of the enclosure",
    ],
    remedy: "give the enclosure a stiffer `wall`",
};

/// Without contacts, the wall alone supports sinking blocks.
const FLOORLESS: &str = "give the scene a `contact`, without which there is no floor, or the enclosure a stiffer `wall`";

/// Largest acceptable penetration of contacts and wall under a steady load \[block lengths\].
const MAX_STEADY: f64 = 0.5;
const MAX_MOVING: f64 = 1.0;

/// Adds two depths for the contacts and two for the enclosure to `out` \[block lengths\]. The first is
/// the penetration depth of a pressed block, the second of a moving block.
pub(super) fn softness(scene: &Scene, out: &mut Vec<DimensionlessNumber>) {
    let units = BlockUnits::from_scene(scene);
    let down = settling::down(scene);
    let weight = units.acceleration(settling::load(scene));
    let lies_on_floor = down > 0.0 && scene.contact.is_some();
    // Jets come from the wall, and are slower at the structure and at the opposite wall.
    let radius = scene.enclosure.as_ref().map_or(0.0, Enclosure::radius);
    let moving = |away| speed::impact(scene, away).map_or(0.0, |speed| units.speed(speed));
    let load = |away, bears: bool| {
        let drag = units.force(speed::flow_force(scene, away));
        drag + if bears { weight } else { 0.0 }
    };
    if let Some(ContactLaw::Compliant { stiffness, damping }) =
        scene.contact.as_ref().map(|contact| &contact.law)
    {
        let spring = Spring {
            stiffness: units.stiffness(*stiffness),
            damping: units.damping(*damping),
            load: load(radius, lies_on_floor),
        };
        spring.add(&CONTACT, CONTACT.remedy, moving(radius), out);
    }
    if let Some(wall) = scene.enclosure.as_ref().map(Enclosure::wall) {
        let spring = Spring {
            stiffness: units.stiffness(wall),
            damping: 0.0,
            load: load(2.0 * radius, !lies_on_floor),
        };
        let has_no_floor = down > 0.0 && scene.contact.is_none();
        let remedy = if has_no_floor { FLOORLESS } else { WALL.remedy };
        spring.add(&WALL, remedy, moving(2.0 * radius), out);
    }
}

impl Spring {
    /// Adds the penetration depths of a block that presses on the spring, and of a block that hits
    /// it with the speed `moving` \[block lengths\].
    fn add(
        self,
        words: &Words,
        remedy: &'static str,
        moving: f64,
        out: &mut Vec<DimensionlessNumber>,
    ) {
        let values = [self.load / self.stiffness, self.depth(moving)];
        for (number, (value, most)) in values.into_iter().zip([MAX_STEADY, MAX_MOVING]).enumerate()
        {
            if value > 0.0 {
                let expected = ExpectedRange {
                    most,
                    beyond: words.beyond[number],
                    remedy,
                    kind: SceneWarningKind::SoftContact,
                };
                let (symbol, meaning) = (words.symbols[number], words.meanings[number]);
                out.push(DimensionlessNumber::new(symbol, meaning, value).expected(expected));
            }
        }
    }

    /// Returns the depth that a block reaches before spring and damper stop it. `speed` is its
    /// initial speed.
    ///
    /// The depth is the first maximum of a damped oscillator of mass 1.
    fn depth(self, speed: f64) -> f64 {
        let frequency = self.stiffness.sqrt();
        let ratio = speed::damping_ratio(self.stiffness, self.damping);
        let undamped = speed / frequency;
        let rest = (1.0 - ratio * ratio).abs().sqrt();
        let exponent = match ratio {
            0.0 => 0.0,
            ratio if rest < 1e-6 * ratio => 1.0,
            ratio if ratio < 1.0 => ratio / rest * (rest / ratio).atan(),
            ratio => ratio / rest * (rest / ratio).atanh(),
        };
        undamped * (-exponent).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_spring_agrees_with_its_equation() {
        let solved = |spring: Spring| {
            let dt = 1e-5;
            let (mut depth, mut speed) = (0.0, 1.0);
            while speed > 0.0 {
                speed -= (spring.stiffness * depth + spring.damping * speed) * dt;
                depth += speed * dt;
            }
            depth
        };
        for (stiffness, damping) in [(4.0, 0.0), (4.0, 1.0), (4.0, 3.99), (4.0, 4.0), (4.0, 9.0)] {
            let spring = Spring {
                stiffness,
                damping,
                load: 0.0,
            };
            let (estimated, solved) = (spring.depth(1.0), solved(spring));
            assert!(
                (estimated / solved - 1.0).abs() < 1e-3,
                "{damping}: {estimated}, {solved}"
            );
        }
    }
}
