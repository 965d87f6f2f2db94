//! Declared shapes of the files of a program.
use stochc_grammar::tree::{Item, ItemKind, Shape};

use crate::expanded::ExpandedProgram;
use crate::names::{NameKind, Names};
use crate::{Checked, FileId, SourceLocation};

/// Declared shapes of all files, including shapes inside assemblies.
pub struct DeclaredShapes<'a> {
    checked: &'a Checked,
    names: Names,
    shapes: Vec<DeclaredShape<'a>>,
}

/// A declared shape with its file.
#[derive(Clone, Copy, Debug)]
pub struct DeclaredShape<'a> {
    /// File of the declaration.
    pub file: FileId,
    /// Declaration with its documentation.
    pub item: &'a Item,
    /// Content of the declaration.
    pub shape: &'a Shape,
    /// Whether the shape is declared inside an assembly. Only that assembly can use it.
    pub is_local: bool,
}

impl<'a> DeclaredShapes<'a> {
    /// Returns the shapes of a checked file and its imports.
    pub fn new(checked: &'a Checked) -> DeclaredShapes<'a> {
        let mut shapes = Vec::new();
        for (file, tree) in checked.trees() {
            for outer in &tree.items {
                let (is_local, items) = match &outer.kind {
                    ItemKind::Assembly(assembly) => (true, &assembly.body[..]),
                    _ => (false, std::slice::from_ref(outer)),
                };
                shapes.extend(items.iter().filter_map(|item| match &item.kind {
                    ItemKind::Shape(shape) => Some(DeclaredShape {
                        file,
                        item,
                        shape,
                        is_local,
                    }),
                    _ => None,
                }));
            }
        }
        DeclaredShapes {
            checked,
            names: Names::from_declarations(checked),
            shapes,
        }
    }

    /// Returns all shapes. Imported files come before the files that import them.
    pub fn all(&self) -> &[DeclaredShape<'a>] {
        &self.shapes
    }

    /// Returns the shape that a word names in a program. Returns `None` if the word names no shape.
    pub fn seen_from(&self, program: &ExpandedProgram, word: &str) -> Option<&DeclaredShape<'a>> {
        let word = self.checked.symbols.get(word)?;
        let seen = (self.names).seen_from(program.location, NameKind::Shape, word)?;
        self.shapes.iter().find(|it| {
            let (file, span) = (it.file, it.shape.name.span);
            SourceLocation { file, span } == seen
        })
    }
}
