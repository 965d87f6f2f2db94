//! Which blocks are meant at one place of the text.
use stochc_grammar::Span;
use stochc_grammar::tree::Segment;

use crate::FileId;
use crate::plan::NameKey;

/// A place of the text, and the blocks that are found to be meant there.
#[derive(Debug, Default)]
pub(crate) struct Probe {
    /// The file and a byte of it. `None` means no place at all.
    pub at: Option<(FileId, u32)>,
    /// The names, in the order in which the program is written out, each once.
    pub keys: Vec<NameKey>,
}

/// Names that are kept of one place; in a loop it may stand for millions.
const MAX_KEYS: usize = 64;

impl Probe {
    /// Notes the blocks of a place if it is the one in question.
    pub fn note(&mut self, file: FileId, place: &[Segment], keys: impl Iterator<Item = NameKey>) {
        // The instances before the last name are other things, and so are the names of its indices.
        if let Some(last) = place.last() {
            self.note_span(file, last.name.span, keys);
        }
    }

    /// Notes the blocks of a part of the text.
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
