//! Names whose blocks or instances may or may not exist, because a statement could not be
//! evaluated.
use stochc_grammar::tree::{Item, ItemKind, Place};

use super::expander::Expander;

impl Expander<'_, '_> {
    /// Records that the block or instance with this name may or may not exist.
    pub(super) fn doubt(&mut self, place: &Place) {
        let words = place.path.iter().map(|segment| segment.name.symbol);
        self.plan.doubtful.extend(words);
    }

    /// Records that the effect of these statements is unknown.
    pub(super) fn doubt_all(&mut self, items: &[Item]) {
        for item in items {
            match &item.kind {
                ItemKind::Chain(chain) => {
                    (chain.links.iter()).for_each(|link| self.doubt(&link.place));
                }
                ItemKind::Release(release) => {
                    release.places.iter().for_each(|place| self.doubt(place));
                }
                ItemKind::Seat(seat) => self.doubt(&seat.place),
                ItemKind::Instance(instance) => {
                    instance.alias.iter().for_each(|alias| self.doubt(alias));
                }
                ItemKind::For(block) => self.doubt_all(&block.body),
                ItemKind::Phase(phase) => self.doubt_all(&phase.body),
                _ => {}
            }
        }
    }
}
