//! The scenes that the files of a program declare, and which of them each is based on.
use rustc_hash::FxHashMap;
use stochc_grammar::Symbols;
use stochc_grammar::tree::{Item, ItemKind, SceneDeclaration, Tree};

use crate::names::{Definition, Names};
use crate::scene::is_built_in;
use crate::{Checked, FileId, SourceLocation};

/// A scene, with its file.
#[derive(Clone, Copy, Debug)]
pub struct DeclaredScene<'a> {
    /// Its file.
    pub file: FileId,
    /// What declares it.
    pub item: &'a Item,
    /// The scene itself.
    pub scene: &'a SceneDeclaration,
    /// The number of the declared one that it is based on; `None`: it is based on a built-in one, an unknown one, or none.
    pub base: Option<usize>,
    pub(crate) definition: Definition,
}

impl DeclaredScene<'_> {
    /// Where its name stands.
    pub(crate) fn location(&self) -> SourceLocation {
        SourceLocation {
            file: self.file,
            span: self.scene.name.span,
        }
    }
}

/// Those of a file that has been checked and of all that it imports: those of imported files before those of the files that
/// import them. Of several of one name, the first.
pub fn declared_scenes(checked: &Checked) -> Vec<DeclaredScene<'_>> {
    let names = Names::of_declarations(checked);
    of_trees(checked.trees(), &names, &checked.symbols, &mut |_, _| {})
}

/// The same, from the trees; tells of each that has the name of another one, which comes first.
pub(crate) fn of_trees<'a>(
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
        // A scene may take the place of the built-in one it is based on.
        let is_itself = declared == Some(number);
        it.base = declared.filter(|_| !(is_itself && is_built_in(symbols.word(base.symbol))));
    }
    scenes
}
