//! Substeps of the physics per tick.
use super::{Bond, Scene};
use stochc_text::counted;

/// Steps of the model per tick, in the syntax of the option `--substeps`: `4`, or `1/8`.
///
/// `1/8` is one step for blocks away from magnetized faces, and eight steps for blocks near them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Substeps {
    /// Number of steps per tick of blocks near magnetized faces.
    pub near: u32,
    /// Number of steps per tick of all other blocks. `None` if equal to `near`.
    pub away: Option<u32>,
}

impl Substeps {
    /// Largest number of steps per tick.
    pub const MAX: u32 = 1000;

    /// Default: the cheapest steps that preserve the times of the default scene
    /// (docs/validation/speed-and-accuracy.md).
    pub const DEFAULT: Substeps = Substeps {
        near: 8,
        away: Some(2),
    };

    /// Returns the number of steps per tick of the blocks with the longest steps.
    pub fn longest(self) -> u32 {
        self.away.unwrap_or(self.near)
    }

    /// Returns the steps that the model `rigid` takes in a scene.
    ///
    /// Steps of two lengths require that no fluid carries blocks and that free blocks do not
    /// attract each other.
    #[must_use]
    pub fn in_scene(self, scene: &Scene) -> Substeps {
        let local = takes_local_steps(scene);
        Substeps {
            away: self.away.filter(|_| local),
            ..self
        }
    }

    /// Returns the steps in words, such as "2 substeps per tick, 8 near open faces".
    pub fn in_words(self) -> String {
        let steps = counted(self.longest() as usize, "substep");
        match self.away {
            Some(_) => format!("{steps} per tick, {} near open faces", self.near),
            None => format!("{steps} per tick"),
        }
    }

    /// Returns whether both numbers are from 1 to [`Substeps::MAX`], and a long step contains an
    /// integer number of short ones.
    pub fn are_valid(self) -> bool {
        (1..=Substeps::MAX).contains(&self.near)
            && (self.away).is_none_or(|away| away > 0 && self.near.is_multiple_of(away))
    }
}

impl std::fmt::Display for Substeps {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.away {
            Some(away) => write!(f, "{away}/{}", self.near),
            None => write!(f, "{}", self.near),
        }
    }
}

/// Error of steps in another form or beyond the limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "say from 1 to {} steps a tick, such as `4`, or `1/8` for one away from magnetized faces and \
     eight near them, which have to be a multiple",
    Substeps::MAX
)]
pub struct InvalidSubsteps;

impl std::str::FromStr for Substeps {
    type Err = InvalidSubsteps;

    fn from_str(text: &str) -> Result<Substeps, InvalidSubsteps> {
        let number = |text: &str| text.trim().parse::<u32>().ok();
        let (away, near) = match text.split_once('/') {
            Some((away, near)) => (Some(number(away)), number(near)),
            None => (None, number(text)),
        };
        let read = match (away, near) {
            (None, Some(near)) => Some(Substeps { near, away: None }),
            (Some(Some(away)), Some(near)) => Some(Substeps {
                near,
                away: (away != near).then_some(away),
            }),
            _ => None,
        };
        read.filter(|steps| steps.are_valid())
            .ok_or(InvalidSubsteps)
    }
}

/// Returns whether blocks of a scene may take steps of different lengths.
pub fn takes_local_steps(scene: &Scene) -> bool {
    scene.fluid.is_none()
        && scene.flow.is_none()
        && !matches!(scene.bond, Some(Bond::Reject { .. }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_read_as_they_are_written() {
        for text in ["1", "4", "1/8", "2/16", "1000"] {
            let steps: Substeps = text.parse().expect("it is allowed");
            assert_eq!(steps.to_string(), text);
        }
        assert_eq!("8/8".parse(), "8".parse::<Substeps>());
        for text in [
            "", "0", "1001", "3/8", "8/1", "0/4", "1/", "/8", "1/8/2", "-1", "a",
        ] {
            assert!(text.parse::<Substeps>().is_err(), "{text}");
        }
    }
}
