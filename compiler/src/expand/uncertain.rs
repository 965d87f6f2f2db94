//! Names whose blocks or instances may or may not exist, because a statement could not be
//! evaluated.
use stochc_grammar::tree::{Item, ItemKind, Place};

use super::expander::Expander;

impl Expander<'_, '_> {
    /// Records that the block or instance with this name may or may not exist.
    pub(super) fn mark_uncertain(&mut self, place: &Place) {
        let words = place.path.iter().map(|segment| segment.name.symbol);
        self.plan.uncertain.extend(words);
    }

    /// Records that the effect of these statements is unknown.
    pub(super) fn mark_all_uncertain(&mut self, items: &[Item]) {
        for item in items {
            match &item.kind {
                ItemKind::Chain(chain) => {
                    (chain.links.iter()).for_each(|link| self.mark_uncertain(&link.place));
                }
                ItemKind::Release(release) => {
                    release
                        .places
                        .iter()
                        .for_each(|place| self.mark_uncertain(place));
                }
                ItemKind::Seat(seat) => self.mark_uncertain(&seat.place),
                ItemKind::Instance(instance) => {
                    instance
                        .alias
                        .iter()
                        .for_each(|alias| self.mark_uncertain(alias));
                }
                ItemKind::For(_) | ItemKind::If(_) | ItemKind::Phase(_) => {
                    self.mark_all_uncertain(item.body());
                }
                _ => {}
            }
        }
    }
}
