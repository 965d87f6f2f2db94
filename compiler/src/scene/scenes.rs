//! Scenes that a program can use: its own and the built-in ones.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::Name;
use stochc_grammar::{Symbol, Symbols};
use stochc_ir::scene::Scene;

use crate::diagnostic::{Code, Diagnostic, report, suggestion};
use crate::expand::duplicate;
use crate::names::{Definition, Names};
use crate::scene::declared_scenes::{DeclaredScene, scenes_from_trees};
use crate::scene::{BUILT_IN, DEFAULT, built_in, read};
use crate::sources::load::Module;
use crate::{FileId, SourceLocation};

/// Largest number of declared scenes that a message lists.
const MAX_LISTED: usize = 20;

/// Scenes that a program can use.
pub struct Scenes<'a> {
    names: &'a Names,
    read: FxHashMap<Definition, Option<Scene>>,
    /// Built-in scenes that serve as bases of declared scenes.
    built_in: FxHashMap<Symbol, Option<Scene>>,
}

impl<'a> Scenes<'a> {
    /// Reads all declared scenes, used or not.
    pub fn new(
        modules: &[Module],
        names: &'a Names,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Scenes<'a> {
        let trees = modules.iter().map(|module| (module.file, &module.tree));
        let declared = scenes_from_trees(trees, names, symbols, &mut |old, new| {
            let word = symbols.word(new.scene.name.symbol);
            let (old, new) = (old.location(), new.location());
            report(diagnostics, duplicate(word, old, new, "a scene", symbols));
        });
        let mut scenes = Scenes {
            names,
            read: FxHashMap::default(),
            built_in: FxHashMap::default(),
        };
        for number in 0..declared.len() {
            scenes.read_line(number, &declared, symbols, diagnostics);
        }
        scenes
    }

    /// Reads the scene with index `number`, after the scenes that it is based on.
    fn read_line(
        &mut self,
        number: usize,
        declared: &[DeclaredScene<'_>],
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        // The scene, its base, the base of that, and so forth. Ends at a scene that has been read,
        // or in a cycle.
        let mut line: Vec<&DeclaredScene<'_>> = Vec::new();
        let mut passed = FxHashSet::default();
        let mut base = None;
        let mut next = Some(number);
        while let Some(at) = next {
            let it = &declared[at];
            if let Some(known) = self.read.get(&it.definition) {
                base = known.clone();
                break;
            }
            if !passed.insert(at) {
                diagnostics.push(cycle(&line));
                break;
            }
            line.push(it);
            next = it.base;
            if let (None, Some(name)) = (next, it.scene.base) {
                let read = || built_in(symbols.word(name.symbol));
                base.clone_from(self.built_in.entry(name.symbol).or_insert_with(read));
                if base.is_none() {
                    let diagnostic = self.unknown(name, it.file, symbols, diagnostics);
                    report(diagnostics, diagnostic);
                }
            }
        }
        for it in line.into_iter().rev() {
            let scene = if it.scene.base.is_some() && base.is_none() {
                None
            } else {
                read(it.scene, base.take(), it.file, symbols, diagnostics)
            };
            base.clone_from(&scene);
            self.read.insert(it.definition, scene);
        }
    }

    /// Returns the scene of an assembly. Returns `None` if it is unknown or wrong, which has been
    /// reported.
    pub fn get(
        &self,
        name: Option<Name>,
        file: FileId,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Scene> {
        let definition = match name {
            Some(name) => self.names.definition(file, name.span),
            None => (symbols.get(DEFAULT)).and_then(|word| self.names.scene(word)),
        };
        if let Some(scene) = definition.and_then(|it| self.read.get(&it)) {
            return scene.clone();
        }
        let Some(name) = name else {
            return built_in(DEFAULT);
        };
        let scene = built_in(symbols.word(name.symbol));
        if scene.is_none() {
            let diagnostic = self.unknown(name, file, symbols, diagnostics);
            report(diagnostics, diagnostic);
        }
        scene
    }

    fn unknown(
        &self,
        name: Name,
        file: FileId,
        symbols: &Symbols,
        diagnostics: &[Diagnostic],
    ) -> Diagnostic {
        let word = symbols.word(name.symbol);
        let known = || {
            let read = self.read.keys();
            let read = read.map(|&scene| symbols.word(self.names.word(scene)));
            read.chain(BUILT_IN.iter().map(|(name, _)| *name))
        };
        let location = SourceLocation {
            file,
            span: name.span,
        };
        Diagnostic::about(Code::UnknownScene, "cannot find scene `{}`", &[word])
            .label(location, "no scene has this name")
            .suggest(location, suggestion(diagnostics, word, known()), || {
                if self.read.len() > MAX_LISTED {
                    return "declare it, or use a declared or built-in scene".to_owned();
                }
                let mut known: Vec<&str> = known().collect();
                known.sort_unstable();
                known.dedup();
                format!("write one of {}", known.join(", "))
            })
    }
}

/// Returns the error of scenes that are derived from each other.
fn cycle(line: &[&DeclaredScene<'_>]) -> Diagnostic {
    let title = "scenes are derived from each other in a cycle";
    let mut diagnostic = Diagnostic::new(Code::UnknownScene, title);
    for it in line {
        let name = it.scene.base.unwrap_or(it.scene.name);
        let location = SourceLocation {
            file: it.file,
            span: name.span,
        };
        diagnostic = diagnostic.label(location, "derived from this scene");
    }
    diagnostic.help("derive one of them from a built-in scene, such as `from hemisphere`")
}
