//! Declared scenes and their bases.
use rustc_hash::FxHashMap;
use stochc_grammar::Symbols;
use stochc_grammar::tree::{Item, ItemKind, SceneDeclaration, Tree};

use crate::names::{Definition, Names};
use crate::scene::is_built_in;
use crate::{Checked, FileId, SourceLocation};

/// A declared scene with its file.
#[derive(Clone, Copy, Debug)]
pub struct DeclaredScene<'a> {
    /// File of the declaration.
    pub file: FileId,
    /// Declaration with its documentation.
    pub item: &'a Item,
    /// Content of the declaration.
    pub scene: &'a SceneDeclaration,
    /// Index of its base among the declared scenes. `None` if the base is built in, unknown or
    /// absent.
    pub base: Option<usize>,
    pub(crate) definition: Definition,
}

impl DeclaredScene<'_> {
    pub(crate) fn location(&self) -> SourceLocation {
        SourceLocation {
            file: self.file,
            span: self.scene.name.span,
        }
    }
}

/// Returns the scenes of a checked file and its imports. Imported files come before the files that
/// import them. Of several scenes with one name, only the first is returned.
pub fn declared_scenes(checked: &Checked) -> Vec<DeclaredScene<'_>> {
    let names = Names::from_declarations(checked);
    scenes_from_trees(checked.trees(), &names, &checked.symbols, &mut |_, _| {})
}

/// Returns the declared scenes of all trees. Reports a scene that has the name of an earlier one.
pub(crate) fn scenes_from_trees<'a>(
    trees: impl Iterator<Item = (FileId, &'a Tree)>,
    names: &Names,
    symbols: &Symbols,
    duplicate: &mut dyn FnMut(&DeclaredScene<'_>, &DeclaredScene<'_>),
) -> Vec<DeclaredScene<'a>> {
    let mut scenes: Vec<DeclaredScene<'a>> = Vec::new();
    let mut numbers: FxHashMap<Definition, usize> = FxHashMap::default();
    for (file, tree) in trees {
        for item in &tree.items {
            let ItemKind::Scene(scene) = &item.kind else {
                continue;
            };
            let Some(definition) = names.definition(file, scene.name.span) else {
                continue;
            };
            let declared = DeclaredScene {
                file,
                item,
                scene,
                base: None,
                definition,
            };
            match numbers.get(&definition) {
                Some(&old) => duplicate(&scenes[old], &declared),
                None => {
                    numbers.insert(definition, scenes.len());
                    scenes.push(declared);
                }
            }
        }
    }
    for (number, it) in scenes.iter_mut().enumerate() {
        let Some(base) = it.scene.base else { continue };
        let definition = names.definition(it.file, base.span);
        let declared = definition.and_then(|it| numbers.get(&it).copied());
        // A scene may replace the built-in one that it is derived from.
        let is_itself = declared == Some(number);
        it.base = declared.filter(|_| !(is_itself && is_built_in(symbols.word(base.symbol))));
    }
    scenes
}
