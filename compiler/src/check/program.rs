//! The stages of a check.
use rustc_hash::FxHashMap;
use stochc_grammar::tree::{Item, ItemKind, Tree};
use stochc_grammar::{Cancellation, Cancelled, Symbols};
use stochc_ir::scene::scalars;
use stochc_ir::scene::warnings::Stepping;

use crate::blocks::unused;
use crate::check::assembly::{AssemblyInput, Stage, compile_aggregate};
use crate::check::changes::Changes;
use crate::check::checked::{Checked, Program};
use crate::check::{claims, short_timeout, trial};
use crate::diagnostic::lint_levels::{FileLevels, LintLevels};
use crate::diagnostic::{Code, Diagnostic, Fix, TextChange, fold, report};
use crate::expand::{
    Declarations, DeclaredItems, ExpansionSettings, Limits, duplicate, expand_aggregate,
};
use crate::names::{Keep, Names};
use crate::scene::scene_check;
use crate::scene::scenes::Scenes;
use crate::sources::load::{Loaded, load};
use crate::sources::reader::Reader;
use crate::{FileId, SourceLocation, Sources, scene};

/// Checks the file at `path` and its imports, and compiles its assemblies.
pub fn check(path: &str, reader: &mut dyn Reader, limits: Limits) -> Checked {
    check_with(path, reader, limits, &LintLevels::default())
}

/// Checks a program like [`check`]. `levels` applies to warnings whose level the source does not
/// set.
pub fn check_with(
    path: &str,
    reader: &mut dyn Reader,
    limits: Limits,
    levels: &LintLevels,
) -> Checked {
    check_changed(path, reader, limits, levels, Changes::NONE)
}

/// Checks a program like [`check_with`], with other values of parameters.
pub fn check_changed(
    path: &str,
    reader: &mut dyn Reader,
    limits: Limits,
    levels: &LintLevels,
    changes: Changes<'_>,
) -> Checked {
    let settings = unhurried(limits);
    to_its_end(check_verified(path, reader, settings, levels, changes))
}

/// Checks a program like [`check`], and can be cancelled.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn check_cancellable(
    path: &str,
    reader: &mut dyn Reader,
    limits: Limits,
    cancellation: Cancellation<'_>,
) -> Result<Checked, Cancelled> {
    let settings = ExpansionSettings {
        limits,
        parameters: &[],
        cancellation,
    };
    check_verified(
        path,
        reader,
        settings,
        &LintLevels::default(),
        Changes::NONE,
    )
}

/// Returns the settings of an expansion that cannot be cancelled.
fn unhurried(limits: Limits) -> ExpansionSettings<'static> {
    ExpansionSettings {
        limits,
        parameters: &[],
        cancellation: Cancellation::NEVER,
    }
}

/// Returns the result of a computation that cannot be cancelled.
fn to_its_end<T>(result: Result<T, Cancelled>) -> T {
    match result {
        Ok(result) => result,
        Err(Cancelled) => unreachable!("there is no cancellation"),
    }
}

/// Checks a program like [`check_all`], then tries its fixes. Only fixes that pass their trial are
/// safe.
fn check_verified(
    path: &str,
    reader: &mut dyn Reader,
    settings: ExpansionSettings<'_>,
    levels: &LintLevels,
    changes: Changes<'_>,
) -> Result<Checked, Cancelled> {
    let check_all = |texts: &mut dyn Reader, is_trial: bool| {
        check_all(
            path,
            texts,
            settings,
            levels,
            changes,
            is_trial,
            &mut |_| {},
        )
    };
    let mut checked = check_all(reader, false)?;
    trial::verify_fixes(&mut checked, reader, &mut |texts| {
        let mut after = check_all(texts, true)?;
        after.diagnostics = fold(after.diagnostics);
        Ok(after)
    })?;
    Ok(checked)
}

/// Checks a program like [`check_with`], and reports when each stage of each assembly is complete.
/// Fixes are not tried, so all are unsafe.
pub fn check_observed(
    path: &str,
    reader: &mut dyn Reader,
    limits: Limits,
    levels: &LintLevels,
    done: &mut dyn FnMut(Stage),
) -> Checked {
    let settings = unhurried(limits);
    let checked = check_all(path, reader, settings, levels, Changes::NONE, false, done);
    let mut checked = to_its_end(checked);
    trial::distrust(&mut checked);
    checked
}

/// Checks a program like [`check_changed`], and proposes fixes.
///
/// `is_trial` is set while a fix is tried. Then diagnostics get no help and are not merged.
fn check_all(
    path: &str,
    reader: &mut dyn Reader,
    settings: ExpansionSettings<'_>,
    levels: &LintLevels,
    changes: Changes<'_>,
    is_trial: bool,
    done: &mut dyn FnMut(Stage),
) -> Result<Checked, Cancelled> {
    let mut sources = Sources::default();
    let mut diagnostics = Vec::new();
    let mut loaded = load(
        path,
        reader,
        &mut sources,
        settings.cancellation,
        &mut diagnostics,
    )?;
    let readable = !diagnostics.iter().any(Diagnostic::is_error);
    let syntax = diagnostics.len();
    let file_levels = FileLevels::new(&loaded.modules, &sources, &loaded.symbols, &mut diagnostics);
    done(Stage::Parse);
    let about = About {
        sources: &sources,
        readable,
        settings,
        changes,
        stepping: levels.stepping(),
        is_trial,
    };
    let trees = loaded.modules.iter();
    let trees = trees.map(|module| (module.file, &module.tree));
    let names = Names::from_trees(trees, Keep::Declarations, settings.cancellation)?;
    let mut programs = programs(&mut loaded, &names, &about, &mut diagnostics, done)?;
    if !diagnostics.iter().any(Diagnostic::is_error) {
        unused::check(
            &loaded.modules,
            &names,
            &sources,
            &loaded.symbols,
            &mut diagnostics,
        );
    }
    mark_fixes_unsafe(&mut diagnostics, syntax);
    let tree = loaded
        .modules
        .pop()
        .map(|module| module.tree)
        .unwrap_or_default();
    diagnostics.sort_by_key(Diagnostic::place);
    let diagnostics = if is_trial {
        diagnostics
    } else {
        fold(diagnostics)
    };
    let (mut diagnostics, mut allowed) = file_levels.apply(diagnostics, levels, &sources);
    diagnostics.sort_by_key(|diagnostic| (diagnostic.severity, diagnostic.place()));
    let allowed_ones = allowed.iter_mut().map(|allowed| &mut allowed.diagnostic);
    for diagnostic in diagnostics.iter_mut().chain(allowed_ones) {
        attribute_by_place(diagnostic, &tree);
    }
    // A denied warning becomes an error only after the tables are written. They are removed here.
    if diagnostics.iter().any(Diagnostic::is_denied) {
        programs
            .iter_mut()
            .for_each(|program| program.tables = None);
    }
    Ok(Checked {
        sources,
        diagnostics,
        allowed,
        tree,
        imports: loaded.modules,
        symbols: loaded.symbols,
        programs,
    })
}

/// Marks fixes as unsafe if another diagnostic makes them doubtful. `syntax` is the number of
/// diagnostics from the parser, which come first.
fn mark_fixes_unsafe(diagnostics: &mut [Diagnostic], syntax: usize) {
    let wrong = |diagnostics: &[Diagnostic]| diagnostics.iter().any(Diagnostic::is_error);
    // A broken statement may mean something else, and an unused seed may be misspelt elsewhere.
    let (unreadable, wrong) = (wrong(&diagnostics[..syntax]), wrong(diagnostics));
    for diagnostic in &mut diagnostics[syntax..] {
        let uncertain = unreadable || (wrong && !diagnostic.is_error());
        if let Some(fix) = diagnostic.fix.as_mut().filter(|_| uncertain) {
            fix.safe = false;
        }
    }
}

/// Input for checking the assemblies of a file. All assemblies share it.
struct About<'a> {
    sources: &'a Sources,
    /// Whether all files could be read.
    readable: bool,
    settings: ExpansionSettings<'a>,
    /// Values that replace parameters.
    changes: Changes<'a>,
    /// Model and time steps for the check of scenes. `None` if runs have no physics.
    stepping: Option<Stepping>,
    /// Whether a fix is being tried. Diagnostics of a trial need no help.
    is_trial: bool,
}

impl About<'_> {
    /// Returns the codes and titles of the errors after these changes of the first file. Returns
    /// `None` if the changes overlap, or if the check was cancelled.
    fn errors_with(&self, fixes: &[&Fix]) -> Option<Vec<(Code, String)>> {
        let own = self.sources.files().first()?;
        let mut change = TextChange::new(FileId(0), &own.text);
        if !fixes.iter().all(|fix| change.add(fix)) {
            return None;
        }
        let mut unread = |_: &str| Err(std::io::Error::other("it has not been read"));
        let mut reader = change.over(self.sources, &mut unread);
        let levels = LintLevels::default();
        let checked = check_all(
            &own.name,
            &mut reader,
            self.settings,
            &levels,
            self.changes,
            true,
            &mut |_| {},
        );
        let checked = checked.ok()?;
        let mut errors: Vec<_> = (checked.diagnostics.into_iter())
            .filter(Diagnostic::is_error)
            .map(|diagnostic| (diagnostic.code, diagnostic.message()))
            .collect();
        errors.sort_unstable();
        Some(errors)
    }
}

fn programs(
    loaded: &mut Loaded,
    names: &Names,
    about: &About,
    diagnostics: &mut Vec<Diagnostic>,
    done: &mut dyn FnMut(Stage),
) -> Result<Vec<Program>, Cancelled> {
    let Loaded {
        modules,
        symbols,
        uncertain,
    } = loaded;
    let scenes = Scenes::new(modules, names, symbols, diagnostics);
    let trees = modules.iter().map(|module| (module.file, &module.tree));
    let declarations = declarations(trees, names, symbols, diagnostics);
    let Some(own) = modules.last() else {
        return Ok(Vec::new());
    };
    let trial = |fixes: &[&Fix]| about.errors_with(fixes);
    let mut seen = FxHashMap::default();
    let mut programs = Vec::new();
    for item in &own.tree.items {
        let before = diagnostics.len();
        let (name, scene) = match &item.kind {
            ItemKind::Assembly(assembly) => (assembly.name, assembly.scene),
            ItemKind::Aggregate(aggregate) => (aggregate.name, aggregate.scene),
            _ => continue,
        };
        let at = |span| SourceLocation {
            file: own.file,
            span,
        };
        let location = at(name.span);
        let scene_location = scene.map_or(location, |scene| at(scene.span));
        if let Some(old) = seen.insert(name.symbol, location) {
            let name = symbols.word(name.symbol);
            report(
                diagnostics,
                duplicate(name, old, location, item.noun(), symbols),
            );
        }
        let scene = scenes.get(scene, own.file, symbols, diagnostics);
        let parameters = match &item.kind {
            ItemKind::Assembly(assembly) => &assembly.parameters[..],
            _ => &[],
        };
        let scene = scene.and_then(|scene| {
            let changes = (about.changes).of_scene(name, parameters, &scene, symbols);
            let wrong = |error| report(diagnostics, scene::diagnostic(&error, location));
            scalars::changed(scene, &changes).map_err(wrong).ok()
        });
        let About {
            sources, readable, ..
        } = *about;
        let assembly = match &item.kind {
            ItemKind::Assembly(assembly) => assembly,
            ItemKind::Aggregate(aggregate) => {
                let mut errors = Vec::new();
                let written = (own.file, &**aggregate);
                let plan = expand_aggregate(&declarations, written, sources, symbols, &mut errors);
                let wrong = !readable || diagnostics.iter().any(Diagnostic::is_error);
                let checked = scene.as_ref().zip(about.stepping);
                let scene_warnings = checked.map(|(scene, stepping)| {
                    scene_check::check(scene, None, stepping, scene_location, &mut errors)
                });
                let mut program =
                    compile_aggregate(plan, scene, wrong, symbols, sources, &mut errors)?;
                program.scene_warnings = scene_warnings.unwrap_or_default();
                diagnostics.append(&mut errors);
                attribute(&mut diagnostics[before..], programs.len());
                programs.push(program);
                continue;
            }
            _ => continue,
        };
        let input = AssemblyInput {
            declarations: &declarations,
            file: own.file,
            assembly,
            sources,
            settings: ExpansionSettings {
                parameters: about.changes.values(name, symbols),
                ..about.settings
            },
            readable,
            trial: (!about.is_trial).then_some(&trial),
            stepping: about.stepping,
            scene_location,
            uncertain,
        };
        let mut program = input.compile(scene, symbols, diagnostics, done)?;
        program.claims = claims::check(&program, &own.tree, symbols, diagnostics);
        if !about.is_trial && program.tables.is_some() {
            short_timeout::check(&program, diagnostics);
        }
        for diagnostic in &mut diagnostics[before..] {
            program.plan.branches.explain(diagnostic, symbols);
        }
        attribute(&mut diagnostics[before..], programs.len());
        programs.push(program);
    }
    Ok(programs)
}

/// Assigns diagnostics to the program with this index.
fn attribute(diagnostics: &mut [Diagnostic], program: usize) {
    for diagnostic in diagnostics {
        diagnostic.programs = vec![program];
    }
}

/// Assigns a parser diagnostic to the program that contains its location.
fn attribute_by_place(diagnostic: &mut Diagnostic, tree: &Tree) {
    let Some((FileId(0), at)) = diagnostic.place() else {
        return;
    };
    if diagnostic.programs.is_empty() {
        let is_program =
            |item: &&Item| matches!(item.kind, ItemKind::Assembly(_) | ItemKind::Aggregate(_));
        let mut programs = tree.items.iter().filter(is_program);
        let around = programs.position(|item| (item.span.start..item.span.end).contains(&at));
        diagnostic.programs.extend(around);
    }
}

/// Returns the declarations at the top level of the files.
pub(crate) fn declarations<'a>(
    trees: impl Iterator<Item = (FileId, &'a Tree)>,
    names: &'a Names,
    symbols: &Symbols,
    diagnostics: &mut Vec<Diagnostic>,
) -> Declarations<'a> {
    let mut declarations = Declarations {
        declared: DeclaredItems::default(),
        lets: Vec::new(),
        names,
    };
    for (file, tree) in trees {
        for item in &tree.items {
            if matches!(item.kind, ItemKind::Let(_)) {
                declarations.lets.push((file, item));
            }
            if let Some(duplicate) = (declarations.declared).declare((file, item), names, symbols) {
                report(diagnostics, duplicate);
            }
        }
    }
    declarations
}
