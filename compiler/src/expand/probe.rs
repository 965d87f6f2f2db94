//! Finds the blocks that a source location names.
use stochc_grammar::Span;
use stochc_grammar::tree::Segment;

use crate::FileId;
use crate::expanded::NameKey;

/// Search for the blocks that a source location names.
#[derive(Debug, Default)]
pub(crate) struct Probe {
    /// File and byte to look up. `None` if no location is looked up.
    pub at: Option<(FileId, u32)>,
    /// Names of the blocks in expansion order, without duplicates.
    pub keys: Vec<NameKey>,
}

/// Largest number of names to record. In a loop, one location can name millions of blocks.
const MAX_KEYS: usize = 64;

impl Probe {
    /// Records the blocks of a name if the name contains the location to look up.
    pub fn note(&mut self, file: FileId, place: &[Segment], keys: impl Iterator<Item = NameKey>) {
        // Instances before the last name, and names in its indices, are other names.
        if let Some(last) = place.last() {
            self.note_span(file, last.name.span, keys);
        }
    }

    /// Records the blocks of a source range if the range contains the location to look up.
    pub(crate) fn note_span(
        &mut self,
        file: FileId,
        span: Span,
        keys: impl Iterator<Item = NameKey>,
    ) {
        let Some((probed, at)) = self.at else { return };
        if probed != file || !(span.start..=span.end).contains(&at) {
            return;
        }
        for key in keys {
            if self.keys.len() == MAX_KEYS {
                break;
            }
            if !self.keys.contains(&key) {
                self.keys.push(key);
            }
        }
    }
}
