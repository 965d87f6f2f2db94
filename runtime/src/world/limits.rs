//! Motions beyond which a world gives up, because what it computes would mean nothing.

/// A faster block \[side / tick, rad / tick\] is a fault.
const MOST_SPEED: f64 = 100.0;

/// Where blocks collide, one that moves farther \[side\] in a step is a fault: it could pass through
/// another one, or through the ground, unseen.
const FARTHEST_STEP: f64 = 2.0;

/// A block farther from the plate \[side\] is a fault: single precision resolves its place no more.
pub(crate) const FARTHEST: f64 = 1e5;

/// The greatest sound speed and spin \[side / tick, rad / tick\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub speed: f64,
    pub spin: f64,
    /// The greatest sound distance from the plate \[side\].
    pub far: f64,
}

impl Limits {
    /// For so many steps a tick, with or without collisions.
    pub fn new(substeps: u32, collide: bool) -> Limits {
        let step = FARTHEST_STEP * f64::from(substeps);
        Limits {
            speed: if collide {
                step.min(MOST_SPEED)
            } else {
                MOST_SPEED
            },
            spin: MOST_SPEED,
            far: FARTHEST,
        }
    }

    /// Where the ground ends sooner than the numbers do.
    pub fn within(self, far: f64) -> Limits {
        let far = self.far.min(far);
        Limits { far, ..self }
    }

    /// What is wrong with a block of this speed and spin, so far from the plate and with an
    /// orientation of this length; `None`: nothing.
    pub fn excess(&self, speed: f64, spin: f64, far: f64, length: f64) -> Option<String> {
        // What is not a number is not below anything.
        let sound = |value: f64, most: f64| value < most;
        if !sound(speed, MOST_SPEED) {
            Some(format!("its speed is {speed} sides per tick"))
        } else if !sound(speed, self.speed) {
            Some(format!(
                "its speed is {speed:.2} sides per tick, too fast to detect collisions; use more \
                 substeps"
            ))
        } else if !sound(spin, self.spin) {
            Some(format!("its spin is {spin} radians per tick"))
        } else if !sound(far, self.far) {
            Some(format!("it is {far} sides from the plate"))
        } else if !length.is_finite() {
            Some("its orientation is not a number".to_owned())
        } else {
            None
        }
    }
}
