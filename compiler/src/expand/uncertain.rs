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
        each_name(items, &mut |_, place| self.mark_uncertain(place));
    }
}

/// Calls a function for each block or instance that these statements declare, and for each block
/// that they release.
pub(super) fn each_name(items: &[Item], note: &mut dyn FnMut(&Item, &Place)) {
    for item in items {
        match &item.kind {
            ItemKind::Chain(chain) => chain.links.iter().for_each(|it| note(item, &it.place)),
            ItemKind::Release(release) => release.places.iter().for_each(|it| note(item, it)),
            ItemKind::Seat(seat) => note(item, &seat.place),
            ItemKind::Instance(instance) => instance.alias.iter().for_each(|it| note(item, it)),
            ItemKind::For(_) | ItemKind::If(_) | ItemKind::Phase(_) => {
                each_name(item.body(), note);
            }
            _ => {}
        }
    }
}
