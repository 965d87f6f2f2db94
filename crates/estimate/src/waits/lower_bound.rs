//! Conditions under which times of the rate model are lower bounds.
use serde::{Serialize, Serializer};
use stochc_ir::JamRisk;
use stochc_ir::scene::Scene;

use crate::Rates;

/// A reason why a program takes longer than the rate model predicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LowerBoundReason {
    /// Blocks may jam in a gap one block wide.
    TightApproach,
    /// Blocks may jam before faces near each other.
    CrowdedCaptures,
    /// The structure is larger than all structures of the calibration.
    ///
    /// Solid shapes of 66 to 121 blocks take 11 to 24 % longer in physical simulations. See
    /// docs/validation/rates.md.
    LargeStructure,
    /// The scene has hardware faults. Sums along the dependency graph ignore them.
    Faults,
}

impl LowerBoundReason {
    const ALL: [LowerBoundReason; 4] = [
        LowerBoundReason::TightApproach,
        LowerBoundReason::CrowdedCaptures,
        LowerBoundReason::LargeStructure,
        LowerBoundReason::Faults,
    ];

    /// Returns the reason as part of a sentence.
    const fn text(self) -> &'static str {
        match self {
            LowerBoundReason::TightApproach => {
                "`tight-approach` captures take longer than the rate model predicts"
            }
            LowerBoundReason::CrowdedCaptures => {
                "`crowded-captures` take longer than the rate model predicts"
            }
            LowerBoundReason::LargeStructure => {
                "the structure has more blocks than any that the rates were measured with"
            }
            LowerBoundReason::Faults => "the estimate ignores the `faults` of the scene",
        }
    }
}

impl From<JamRisk> for LowerBoundReason {
    fn from(risk: JamRisk) -> LowerBoundReason {
        match risk {
            JamRisk::TightApproach => LowerBoundReason::TightApproach,
            JamRisk::CrowdedCaptures => LowerBoundReason::CrowdedCaptures,
        }
    }
}

/// Reasons why times of the rate model are lower bounds. Empty if the times are estimates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LowerBoundReasons([bool; LowerBoundReason::ALL.len()]);

impl LowerBoundReasons {
    /// Finds the reasons why the times of a program are lower bounds. `blocks` is the size of its
    /// largest structure.
    pub fn new(jam_risks: &[JamRisk], rates: &Rates, blocks: u32) -> LowerBoundReasons {
        let is_large = rates.largest_structure().is_some_and(|most| blocks > most);
        let holds = |reason: LowerBoundReason| match reason {
            LowerBoundReason::LargeStructure => is_large,
            LowerBoundReason::Faults => false,
            _ => jam_risks.iter().any(|&risk| reason == risk.into()),
        };
        LowerBoundReasons(LowerBoundReason::ALL.map(holds))
    }

    /// Adds the faults of a scene, for a method that ignores them.
    #[must_use]
    pub fn ignoring_faults(mut self, scene: &Scene) -> LowerBoundReasons {
        let faults = scene.faults.iter();
        let mut shares = faults.flat_map(|it| [it.dead, it.latch]).flatten();
        let index = LowerBoundReason::Faults as usize;
        self.0[index] |= shares.any(|share| share > 0.0);
        self
    }

    /// Returns whether times are estimates.
    pub fn is_empty(self) -> bool {
        self.0 == [false; LowerBoundReason::ALL.len()]
    }

    /// Returns the reasons, in a fixed order.
    pub fn iter(self) -> impl Iterator<Item = LowerBoundReason> {
        let all = LowerBoundReason::ALL.into_iter().zip(self.0);
        all.filter_map(|(reason, holds)| holds.then_some(reason))
    }

    /// Returns the reasons as part of a sentence. Empty without reasons.
    pub fn text(self) -> String {
        let reasons: Vec<&str> = self.iter().map(LowerBoundReason::text).collect();
        reasons.join(", and ")
    }

    /// Returns the text before a time: `at least ` for a lower bound, empty for an estimate.
    pub fn prefix(self) -> &'static str {
        if self.is_empty() { "" } else { "at least " }
    }
}

impl Serialize for LowerBoundReasons {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

#[cfg(test)]
mod tests {
    use stochc_ir::scene::Faults;

    use super::*;

    #[test]
    fn uncalibrated_conditions_give_a_lower_bound() {
        let rates = &Rates::shipped()[0];
        // `calibrate` builds 39 blocks of 300.
        assert_eq!(rates.largest_structure(), Some(39));
        let reasons = |risks: &[JamRisk], blocks| LowerBoundReasons::new(risks, rates, blocks);
        assert!(reasons(&[], 39).is_empty());
        let all = reasons(&[JamRisk::CrowdedCaptures, JamRisk::TightApproach], 40);
        assert_eq!(all.iter().count(), 3);
        assert_eq!(
            serde_json::to_value(all).expect("it is a list"),
            serde_json::json!(["tight-approach", "crowded-captures", "large-structure"])
        );
        let mut scene = rates.scene.clone();
        let ignoring = |scene: &Scene| LowerBoundReasons::default().ignoring_faults(scene);
        assert!(ignoring(&scene).is_empty());
        for (latch, is_bound) in [(0.0, false), (0.01, true)] {
            scene.faults = Some(Faults {
                dead: None,
                latch: Some(latch),
            });
            assert_eq!(!ignoring(&scene).is_empty(), is_bound, "{latch}");
        }
        assert_eq!((all.prefix(), reasons(&[], 1).prefix()), ("at least ", ""));
    }
}
