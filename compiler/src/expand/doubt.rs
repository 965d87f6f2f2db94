//! Names that a statement which could not be worked out may have given to a block or an instance, or taken from a block.
use stochc_grammar::tree::{Item, ItemKind, Place};

use super::Expander;

impl Expander<'_, '_> {
    /// Notes that nobody knows whether this block is there, or this instance.
    pub(super) fn doubt(&mut self, place: &Place) {
        let words = place.path.iter().map(|segment| segment.name.symbol);
        self.plan.doubtful.extend(words);
    }

    /// Notes that nobody knows what these statements do.
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
