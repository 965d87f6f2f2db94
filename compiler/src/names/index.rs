//! All names of a program, sorted by location and linked to their definitions.
use rustc_hash::FxHashMap;
use stochc_grammar::{Span, Symbol};

use super::declared::DeclaredNames;
use super::definition::{Definition, NameKind, Occurrence, Use};
use crate::{FileId, SourceLocation};

/// Names of all files of a program.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Names sorted by file and location.
    pub(super) occurrences: Vec<Occurrence>,
    pub(super) kinds: Vec<(NameKind, Symbol)>,
    /// Definitions that the expansion needs, by file and first byte of the name.
    pub(super) definitions: FxHashMap<(FileId, u32), Definition>,
    /// Uses of each parameter in source order.
    pub(super) uses: FxHashMap<Definition, Vec<Use>>,
    /// Patterns, shapes and scenes by word.
    pub(super) declared: DeclaredNames,
}

impl Names {
    /// Returns the definition of a number, counter, parameter, pattern, shape or scene. Returns
    /// `None` for other names.
    pub(crate) fn definition(&self, file: FileId, span: Span) -> Option<Definition> {
        self.definitions.get(&(file, span.start)).copied()
    }

    /// Returns the location of the declaration of a pattern or shape that this word names in an
    /// assembly. Returns `None` if the word is not declared.
    pub(crate) fn seen_from(
        &self,
        assembly: SourceLocation,
        kind: NameKind,
        word: Symbol,
    ) -> Option<SourceLocation> {
        let place = (assembly.file, assembly.span.start);
        let number = self.declared.assemblies.get(&place).copied();
        let seen = self.declared.seen_from(number, kind, word);
        seen.map(|it| it.location)
    }

    /// Returns the scene that a word names. The scene may be undeclared. Returns `None` if no
    /// program uses the word as a scene.
    pub(crate) fn scene(&self, word: Symbol) -> Option<Definition> {
        self.declared.scenes.get(&word).copied()
    }

    /// Returns the uses of a parameter in source order.
    pub(crate) fn uses(&self, file: FileId, parameter: Span) -> &[Use] {
        let uses = self
            .definition(file, parameter)
            .and_then(|it| self.uses.get(&it));
        uses.map_or(&[], Vec::as_slice)
    }

    /// Returns the name at a byte of a file, or the name that ends there. Returns `None` if the
    /// byte is not part of a name.
    pub fn at(&self, file: FileId, at: u32) -> Option<&Occurrence> {
        let key =
            |occurrence: &Occurrence| (occurrence.location.file, occurrence.location.span.start);
        let behind = (self.occurrences).partition_point(|occurrence| key(occurrence) <= (file, at));
        let candidate = &self.occurrences[behind.checked_sub(1)?];
        let location = candidate.location;
        (location.file == file && at <= location.span.end).then_some(candidate)
    }

    /// Returns all names, sorted by file and location.
    pub fn all(&self) -> &[Occurrence] {
        &self.occurrences
    }

    /// Returns all locations of a definition's name, sorted.
    pub fn occurrences_of(&self, definition: Definition) -> impl Iterator<Item = &Occurrence> {
        (self.occurrences.iter()).filter(move |occurrence| occurrence.definition == definition)
    }

    /// Returns the kind of a definition.
    pub fn kind(&self, definition: Definition) -> NameKind {
        self.kinds[definition.0 as usize].0
    }

    /// Returns the word of a definition.
    pub fn word(&self, definition: Definition) -> Symbol {
        self.kinds[definition.0 as usize].1
    }
}

#[cfg(test)]
mod tests {
    use stochc_grammar::Cancellation;

    use super::*;
    use crate::{Limits, check};

    /// Returns the names of a program with the numbers of their definitions, in source order. A
    /// star marks declarations.
    fn shown(files: &[(&str, &str)]) -> String {
        let mut reader = |path: &str| {
            let file = files.iter().find(|(name, _)| *name == path);
            file.map(|(_, text)| text.as_bytes().to_vec())
                .ok_or(std::io::ErrorKind::NotFound.into())
        };
        let checked = check(files[0].0, &mut reader, Limits::default());
        let names = Names::new(&checked, Cancellation::NEVER).unwrap();
        let mut seen: Vec<Definition> = Vec::new();
        let mut shown = Vec::new();
        for occurrence in names.all() {
            let number = seen
                .iter()
                .position(|&definition| definition == occurrence.definition);
            let number = number.unwrap_or_else(|| {
                seen.push(occurrence.definition);
                seen.len() - 1
            });
            let word = checked.sources.text(occurrence.location);
            assert_eq!(
                word,
                checked.symbols.word(names.word(occurrence.definition))
            );
            let star = if occurrence.declares { "*" } else { "" };
            shown.push(format!("{word}{number}{star}"));
        }
        shown.join(" ")
    }

    #[test]
    fn blocks_belong_to_their_assembly() {
        let one = "{ seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> T[1].up -> T[2] \
                   release T[2] after T[1] } }";
        assert_eq!(
            shown(&[("a.sa", &format!("assembly a {one} assembly b {one}"))]),
            "a0* M1* p2* M1 T3* T3* T3 T3 b4* M5* p6* M5 T7* T7* T7 T7"
        );
    }

    #[test]
    fn inner_numbers_shadow_outer_ones() {
        let text = "let n = 1 let k = n + -(n) assembly a { seed plate n x (n) { M[n] at (0, 0) }
            let n = n phase p[n] { for n in n..2 { let n = n M[n].up -> T[( n )] } } }";
        assert_eq!(
            shown(&[("a.sa", text)]),
            "n0* k1* n0 n0 a2* n0 n0 M3* n0 n4* n0 p5* n4 n6* n4 n7* n6 M3 n7 T8* n7"
        );
    }

    #[test]
    fn patterns_have_blocks_of_their_own() {
        let text = "pattern t(base, h, side) { base.up ->> T[1..h] T[h].side -> U }
            pattern two(a, b) { t(a, 1, up) as l t(b, 2, up) as r l.T[1].up -> r.T[3] }
            assembly a { seed plate 2 x 1 { A at (0, 0) T at (1, 0) }
            phase p { two(A, T) as g[1] t(T, 3, east) as s }
            phase q { g[1].l.T[1].up -> T s.U.up -> V } }";
        assert_eq!(
            shown(&[("a.sa", text)]),
            "t0* base1* h2* side3* base1 T4* h2 T4 h2 side3 U5* two6* a7* b8* t0 a7 l9* t0 b8 r10* \
             l9 T4 r10 T4* a11* A12* T13* p14* two6 A12 T13 g15* t0 T13 s16* q17* g15 l9 T4 T13* \
             s16 U5 V18*"
        );
    }

    #[test]
    fn ambiguous_names_are_merged() {
        let text = "let n = 1 pattern t(base) { base.up -> T[n] }
            assembly a { let n = 2 seed plate n x 1 { A at (0, 0) } phase p { t(A) } }
            assembly b { let m = 3 pattern s(base) { base.up -> T[m] } seed plate 1 x 1 { A at (0, 0) }
            phase p { s(A) } }";
        assert_eq!(
            shown(&[("a.sa", text)]),
            "n0* t1* base2* base2 T3* n0 a4* n0* n0 A5* p6* t1 A5 b7* m8* s9* base10* base10 T11* m8 \
             A12* p13* s9 A12"
        );
    }

    #[test]
    fn files_share_their_names() {
        let main = "import \"b.sa\" assembly a in dry { seed plate w x 1 { M at (0, 0) }
            phase p { t(M) yields s } }";
        let other = "let w = 1 pattern t(b) { b.up -> T } shape s { layer 1 { # } }
            scene dry from hemisphere { free 3 uniform }";
        assert_eq!(
            shown(&[("a.sa", main), ("b.sa", other)]),
            "a0* dry1 w2 M3* p4* t5 M3 s6 w2* t5* b7* b7 T8* s6* dry1* hemisphere9"
        );
    }
}
