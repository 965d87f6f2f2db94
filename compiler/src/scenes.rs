//! The scenes of a program: its own and the built-in ones.
use rustc_hash::FxHashMap;
use stochc_grammar::tree::{ItemKind, Name, SceneDeclaration};
use stochc_grammar::{Symbol, Symbols};
use stochc_ir::scene::Scene;

use crate::diagnostic::{Code, Diagnostic, meant, report};
use crate::load::Module;
use crate::scene::{BUILT_IN, DEFAULT, built_in, read};
use crate::{FileId, SourceLocation};

/// Scenes that a program may declare so that all are listed where none is meant.
const MOST_LISTED: usize = 20;

/// Every scene that a program may name.
pub struct Scenes {
    read: FxHashMap<Symbol, Option<Scene>>,
}

impl Scenes {
    /// Reads every declared scene, whether it is used or not.
    pub fn of(modules: &[Module], symbols: &Symbols, diagnostics: &mut Vec<Diagnostic>) -> Scenes {
        let mut declared: FxHashMap<Symbol, (FileId, &SceneDeclaration)> = FxHashMap::default();
        let mut order: Vec<Symbol> = Vec::new();
        for module in modules {
            for item in &module.tree.items {
                let ItemKind::Scene(scene) = &item.kind else {
                    continue;
                };
                let here = SourceLocation {
                    file: module.file,
                    span: scene.name.span,
                };
                if let Some((file, old)) = declared.get(&scene.name.symbol) {
                    let old = SourceLocation {
                        file: *file,
                        span: old.name.span,
                    };
                    let word = symbols.word(scene.name.symbol);
                    report(
                        diagnostics,
                        crate::expand::duplicate(word, old, here, "a scene"),
                    );
                    continue;
                }
                declared.insert(scene.name.symbol, (module.file, scene));
                order.push(scene.name.symbol);
            }
        }
        let mut scenes = Scenes {
            read: FxHashMap::default(),
        };
        for name in order {
            scenes.resolve(name, &declared, symbols, diagnostics);
        }
        scenes
    }

    /// Reads a scene and, before it, those it is derived from.
    fn resolve(
        &mut self,
        name: Symbol,
        declared: &FxHashMap<Symbol, (FileId, &SceneDeclaration)>,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) {
        // From the scene itself to the first one that is known or stands for itself.
        let mut line: Vec<(FileId, &SceneDeclaration)> = Vec::new();
        let mut passed = rustc_hash::FxHashSet::default();
        let mut base = None;
        let mut next = Some(name);
        while let Some(at) = next {
            if let Some(known) = self.read.get(&at) {
                base = known.clone();
                break;
            }
            let Some(&(file, tree)) = declared.get(&at) else {
                base = self.elsewhere(at, &line, symbols, diagnostics);
                break;
            };
            if !passed.insert(at) {
                let mut diagnostic = Diagnostic::new(
                    Code::UnknownScene,
                    "scenes derived from each other in a cycle",
                );
                for (file, tree) in &line {
                    let span = tree.base.map_or(tree.name.span, |base| base.span);
                    diagnostic =
                        diagnostic.label(SourceLocation { file: *file, span }, "derived from this");
                }
                diagnostics.push(diagnostic.help("one of them has to stand for itself"));
                break;
            }
            line.push((file, tree));
            next = tree.base.map(|base| base.symbol);
            // A scene may take the place of the built-in one it is derived from.
            if next == Some(at)
                && let Some(scene) = built_in(symbols.word(at))
            {
                base = Some(scene);
                break;
            }
        }
        for (file, tree) in line.into_iter().rev() {
            let scene = if tree.base.is_some() && base.is_none() {
                None
            } else {
                read(tree, base.take(), file, symbols, diagnostics)
            };
            base.clone_from(&scene);
            self.read.insert(tree.name.symbol, scene);
        }
    }

    fn elsewhere(
        &mut self,
        name: Symbol,
        line: &[(FileId, &SceneDeclaration)],
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Scene> {
        let word = symbols.word(name);
        let scene = built_in(word);
        if scene.is_some() {
            self.read.insert(name, scene.clone());
        } else if let Some((file, tree)) = line.last()
            && let Some(base) = tree.base
        {
            let diagnostic = self.unknown(base, *file, symbols, diagnostics);
            report(diagnostics, diagnostic);
        }
        scene
    }

    /// The scene of an assembly; `None` if it is unknown or wrong, which has been told.
    pub fn get(
        &self,
        name: Option<Name>,
        file: FileId,
        symbols: &Symbols,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Scene> {
        let Some(name) = name else {
            return self.read_or_built_in(symbols.get(DEFAULT), DEFAULT);
        };
        let scene = self.read_or_built_in(Some(name.symbol), symbols.word(name.symbol));
        if scene.is_none() && !self.read.contains_key(&name.symbol) {
            let diagnostic = self.unknown(name, file, symbols, diagnostics);
            report(diagnostics, diagnostic);
        }
        scene
    }

    fn read_or_built_in(&self, symbol: Option<Symbol>, word: &str) -> Option<Scene> {
        match symbol.and_then(|symbol| self.read.get(&symbol)) {
            Some(scene) => scene.clone(),
            None => built_in(word),
        }
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
            let read = self.read.keys().map(|&scene| symbols.word(scene));
            read.chain(BUILT_IN.iter().map(|(name, _)| *name))
        };
        let location = SourceLocation {
            file,
            span: name.span,
        };
        Diagnostic::new(Code::UnknownScene, format!("no scene is called `{word}`"))
            .label(location, "not known")
            .suggest(location, meant(diagnostics, word, known()), || {
                if self.read.len() > MOST_LISTED {
                    return "declare it, or take one that is declared or built in".to_owned();
                }
                let mut known: Vec<&str> = known().collect();
                known.sort_unstable();
                known.dedup();
                format!("known are {}", known.join(", "))
            })
    }
}
