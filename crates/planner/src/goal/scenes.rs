//! The scene declarations of a program as source.
use stochc_compiler::{Checked, declared_scenes};
use stochc_grammar::tree::Item;

/// Scenes of a program in the order of declaration.
#[derive(Clone, Debug, Default)]
pub(super) struct WrittenScenes(Vec<WrittenScene>);

#[derive(Clone, Debug)]
struct WrittenScene {
    name: String,
    /// Index of its base scene. `None` if the base is built in.
    base: Option<usize>,
    text: String,
}

impl WrittenScenes {
    pub(super) fn new(checked: &Checked) -> WrittenScenes {
        let scenes = declared_scenes(checked).into_iter().map(|it| WrittenScene {
            name: checked.symbols.word(it.scene.name.symbol).to_owned(),
            base: it.base,
            text: as_written(it.item, &checked.sources.file(it.file).text),
        });
        WrittenScenes(scenes.collect())
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|scene| scene.name.as_str())
    }

    /// Adds a scene that is based on another.
    pub(super) fn add(&mut self, name: &str, base: &str, text: String) {
        self.0.push(WrittenScene {
            name: name.to_owned(),
            base: self.number_of(base),
            text,
        });
    }

    /// Returns whether a scene of this name is declared.
    pub(super) fn declare(&self, name: &str) -> bool {
        self.number_of(name).is_some()
    }

    /// Returns all declarations.
    pub(super) fn all(&self) -> String {
        self.0.iter().map(|scene| scene.text.as_str()).collect()
    }

    /// Returns the declarations of a scene and its bases. Empty if the scene is not declared.
    pub(super) fn needed_for(&self, name: &str) -> String {
        let mut is_needed = vec![false; self.0.len()];
        let mut next = self.number_of(name);
        while let Some(number) = next.filter(|&number| !is_needed[number]) {
            is_needed[number] = true;
            next = self.0[number].base;
        }
        let needed = self.0.iter().zip(is_needed).filter(|&(_, needed)| needed);
        needed.map(|(scene, _)| scene.text.as_str()).collect()
    }

    fn number_of(&self, name: &str) -> Option<usize> {
        self.0.iter().position(|scene| scene.name == name)
    }
}

/// Returns the source of an item with its documentation and comments.
fn as_written(item: &Item, text: &str) -> String {
    let docs = item.docs.0.iter().flat_map(|lines| lines.iter());
    let docs: String = docs
        .map(|line| format!("{}\n", format!("/// {line}").trim_end()))
        .collect();
    let written = text.get(item.span.start as usize..item.span.end as usize);
    format!("{docs}{}\n", written.unwrap_or_default())
}
