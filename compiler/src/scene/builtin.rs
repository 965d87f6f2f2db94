//! Built-in scenes, written in the language itself.
use stochc_grammar::tree::ItemKind;
use stochc_grammar::{Symbols, parse};
use stochc_ir::scene::Scene;

use super::read;
use crate::Sources;

/// Name and source of each built-in scene.
pub const BUILT_IN: [(&str, &str); 6] = [
    ("hemisphere", include_str!("hemisphere.sa")),
    ("hemisphere_soft", include_str!("hemisphere_soft.sa")),
    ("hemisphere_2005", include_str!("hemisphere_2005.sa")),
    ("magnet_tank", include_str!("magnet_tank.sa")),
    ("jet_tank", include_str!("jet_tank.sa")),
    ("suction_tank", include_str!("suction_tank.sa")),
];

/// Name of the default scene.
pub const DEFAULT: &str = "hemisphere";

/// Returns the built-in scene with this name. Returns `None` if there is none.
pub fn built_in(name: &str) -> Option<Scene> {
    let (_, text) = BUILT_IN.into_iter().find(|&(known, _)| known == name)?;
    let mut symbols = Symbols::new();
    let parsed = parse(text, &mut symbols);
    let file = Sources::default().add(name, text);
    let scene = parsed.tree.items.iter().find_map(|item| match &item.kind {
        ItemKind::Scene(scene) => Some(scene),
        _ => None,
    })?;
    let base = match scene.base {
        Some(base) => Some(built_in(symbols.word(base.symbol))?),
        None => None,
    };
    read(scene, base, file, &symbols, &mut Vec::new())
}

/// Returns whether a built-in scene has this name.
pub fn is_built_in(name: &str) -> bool {
    BUILT_IN.iter().any(|&(known, _)| known == name)
}

/// Returns the names of the built-in scenes as a list for messages.
pub fn built_in_names() -> String {
    BUILT_IN.map(|(name, _)| format!("`{name}`")).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_scene_reads_and_the_default_is_one() {
        for (name, _) in BUILT_IN {
            assert_eq!(
                built_in(name).map(|scene| scene.name).as_deref(),
                Some(name)
            );
        }
        assert!(built_in(DEFAULT).is_some());
    }
}
