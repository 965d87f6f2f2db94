//! Reads and parses a file and its imports.
use rustc_hash::FxHashMap;
use stochc_grammar::tree::{Item, ItemKind, Tree};
use stochc_grammar::{
    BYTE_ORDER_MARK, Cancellation, Cancelled, Span, Symbol, Symbols, parse_cancellable,
};
use stochc_text::visible;

use crate::diagnostic::{Code, Diagnostic, Edit, Fix, removal, report};
use crate::sources::reader::Reader;
use crate::{FileId, SourceLocation, Sources};

/// A parsed file.
#[derive(Clone, Debug)]
pub struct Module {
    /// File of the module.
    pub file: FileId,
    /// Syntax tree.
    pub tree: Tree,
}

/// A file and all of its imports.
#[derive(Debug, Default)]
pub struct Loaded {
    /// Modules in import order: imported files come before the files that import them. The
    /// program's own file is the last.
    pub modules: Vec<Module>,
    pub symbols: Symbols,
    /// Words in those parts of the files that the parser could not read.
    pub uncertain: rustc_hash::FxHashSet<Symbol>,
}

/// Reads and parses `path` and its imports, each file once.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn load(
    path: &str,
    reader: &mut dyn Reader,
    sources: &mut Sources,
    cancellation: Cancellation<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Loaded, Cancelled> {
    let mut loader = Loader {
        reader,
        sources,
        cancellation,
        diagnostics,
        loaded: Loaded::default(),
        state: FxHashMap::default(),
        first: FxHashMap::default(),
        bytes: 0,
        full: false,
    };
    loader.run(path)?;
    Ok(loader.loaded)
}

/// Largest number of files of a program. With links to parent folders, a file can import itself by
/// ever new paths.
const MAX_FILES: usize = 10_000;

/// Limit of the total size of all files \[bytes\].
const MAX_BYTES: u64 = 1 << 32;

/// State of loading a file.
#[derive(Clone, Copy, PartialEq)]
enum LoadState {
    /// The imports of this file are being read. Contains the location of the current import.
    Open(SourceLocation),
    Done,
}

struct Loader<'a> {
    reader: &'a mut dyn Reader,
    sources: &'a mut Sources,
    cancellation: Cancellation<'a>,
    diagnostics: &'a mut Vec<Diagnostic>,
    loaded: Loaded,
    state: FxHashMap<String, LoadState>,
    /// First path of each file, by [identity](Reader::identity).
    first: FxHashMap<String, String>,
    /// Number of bytes of all files.
    bytes: u64,
    /// Whether the limit is reached and reported.
    full: bool,
}

/// A file whose imports are being read.
struct Pending {
    path: String,
    module: Module,
    /// Imports still to read: path, location of the path, and location of the whole statement. The
    /// last is `None` for a statement with documentation.
    imports: std::vec::IntoIter<(String, Span, Option<Span>)>,
}

impl Loader<'_> {
    /// Reads the file `root` and its imports, depth first. Uses an explicit stack, because chains
    /// of imports can be long.
    fn run(&mut self, root: &str) -> Result<(), Cancelled> {
        let mut stack: Vec<Pending> = Vec::new();
        let root = self.first_path(root.to_owned());
        stack.extend(self.open(root, None)?);
        while let Some(top) = stack.last_mut() {
            let Some((import, span, statement)) = top.imports.next() else {
                if let Some(done) = stack.pop() {
                    self.state.insert(done.path, LoadState::Done);
                    self.loaded.modules.push(done.module);
                }
                continue;
            };
            let file = top.module.file;
            let path = self.first_path(join(&top.path, &import));
            self.state.insert(
                top.path.clone(),
                LoadState::Open(SourceLocation { file, span }),
            );
            match self.state.get(&path) {
                None if self.state.len() >= MAX_FILES || self.bytes >= MAX_BYTES => {
                    self.too_many(SourceLocation { file, span });
                }
                None => stack.extend(self.open(path, Some(SourceLocation { file, span }))?),
                Some(LoadState::Done) => {}
                Some(LoadState::Open(_)) => {
                    let statement = statement.map(|span| SourceLocation { file, span });
                    self.cycle(&path, &stack, statement);
                }
            }
        }
        Ok(())
    }

    /// Returns the first path of a file. Other paths can lead to the same file through links.
    fn first_path(&mut self, path: String) -> String {
        match self.reader.identity(&path) {
            Some(identity) => self.first.entry(identity).or_insert(path).clone(),
            None => path,
        }
    }

    /// Reports once that the limit of the number or size of files is reached.
    fn too_many(&mut self, import: SourceLocation) {
        if std::mem::replace(&mut self.full, true) {
            return;
        }
        let title = format!("the program has more than {MAX_FILES} files or 4 GiB");
        self.diagnostics.push(
            Diagnostic::new(Code::ExpansionLimit, title)
                .label(import, "this import was not read")
                .help("remove symbolic links to parent folders: through them, a file imports itself under new names"),
        );
    }

    /// Reads a file. Returns `None` and reports the error if this fails.
    fn open(
        &mut self,
        path: String,
        importer: Option<SourceLocation>,
    ) -> Result<Option<Pending>, Cancelled> {
        self.cancellation.check()?;
        if let Some(location) = importer
            && let Some(folder) = self.reader.outside(&path)
        {
            self.outside(&path, &folder, location);
            self.state.insert(path, LoadState::Done);
            return Ok(None);
        }
        let bytes = match self.reader.read(&path) {
            Ok(bytes) => bytes,
            Err(reason) => {
                self.state.insert(path.clone(), LoadState::Done);
                let diagnostic = Diagnostic::new(
                    Code::ImportMissing,
                    format!("cannot read `{}`", visible(&path)),
                );
                let diagnostic = match importer {
                    Some(location) => diagnostic
                        .label(location, reason.to_string())
                        .help("write the path relative to the importing file"),
                    None => Diagnostic {
                        title: format!("{}: {reason}", diagnostic.title),
                        ..diagnostic
                    },
                };
                report(self.diagnostics, diagnostic);
                return Ok(None);
            }
        };
        self.bytes = self.bytes.saturating_add(bytes.len() as u64);
        let (mark, text, invalid) = decode(bytes);
        if let Some(at) = invalid {
            let file = self.sources.add_lossy(path.clone(), text);
            self.sources.set_mark(file, mark);
            let at = at as u32;
            let span = Span::new(at, at + '\u{fffd}'.len_utf8() as u32);
            self.diagnostics.push(
                Diagnostic::new(Code::NotUtf8, "the file is not UTF-8 text")
                    .label(SourceLocation { file, span }, "the first invalid byte")
                    .help("save the file as UTF-8 in your editor"),
            );
            self.state.insert(path, LoadState::Done);
            return Ok(None);
        }
        let file = self.sources.add(path.clone(), text);
        self.sources.set_mark(file, mark);
        let text = self.sources.file(file).text.clone();
        let mut parsed = parse_cancellable(&text, &mut self.loaded.symbols, self.cancellation)?;
        self.loaded.uncertain.extend(parsed.uncertain);
        self.diagnostics.extend(lone_returns(file, &text));
        let errors = parsed.errors.iter();
        let mut errors: Vec<Diagnostic> = errors
            .map(|error| Diagnostic::from_syntax(file, error, &text))
            .collect();
        if let Some(error) = no_program(&path, &errors, &parsed.tree) {
            errors = vec![error];
            parsed.tree = Tree::default();
        }
        self.diagnostics.append(&mut errors);
        let imports: Vec<_> = (parsed.tree.items.iter())
            .filter_map(|item| match &item.kind {
                ItemKind::Import(import) => {
                    let statement = item.docs.0.is_none().then_some(item.span);
                    Some((import.path.clone(), import.path_span, statement))
                }
                _ => None,
            })
            .collect();
        let location = SourceLocation {
            file,
            span: Span::default(),
        };
        self.state.insert(path.clone(), LoadState::Open(location));
        Ok(Some(Pending {
            path,
            module: Module {
                file,
                tree: parsed.tree,
            },
            imports: imports.into_iter(),
        }))
    }

    /// Reports an import that leaves the allowed folders.
    fn outside(&mut self, path: &str, folder: &str, import: SourceLocation) {
        let (path, folder) = (visible(path), visible(folder));
        let title = format!("import of `{path}` leaves the folder of the program");
        let diagnostic = Diagnostic::new(Code::ImportOutside, title)
            .label(import, format!("imports must be inside `{folder}`"))
            .help("move the file there, or allow its folder with `--allow-import DIR`");
        report(self.diagnostics, diagnostic);
    }

    /// Reports a cycle of imports, with a label for each import.
    fn cycle(&mut self, path: &str, stack: &[Pending], statement: Option<SourceLocation>) {
        /// Largest number of reported cycles, and of labelled imports per cycle.
        const MAX: usize = 10;
        let is_circle = |diagnostic: &&Diagnostic| diagnostic.code == Code::ImportCycle;
        if self.diagnostics.iter().filter(is_circle).count() >= MAX {
            return;
        }
        let first = stack.iter().position(|pending| pending.path == path);
        let circle = &stack[first.unwrap_or(0)..];
        let title = match circle.len() {
            1 => format!("`{}` imports itself", visible(path)),
            count @ 2..=MAX => format!("{count} files import each other in a cycle"),
            count => format!("{count} files import each other in a cycle; {MAX} are shown"),
        };
        let mut diagnostic = Diagnostic::new(Code::ImportCycle, title);
        for pending in circle.iter().take(MAX) {
            if let Some(LoadState::Open(location)) = self.state.get(&pending.path) {
                let import = self.sources.text(*location).to_owned();
                diagnostic = diagnostic.label(
                    *location,
                    format!("`{}` imports {import}", visible(&pending.path)),
                );
            }
        }
        let help = match circle.len() {
            1 => "remove the import",
            _ => "move the declarations that both need into a third file",
        };
        diagnostic = diagnostic.help(help);
        if let (1, Some(statement)) = (circle.len(), statement) {
            let location = removal(self.sources, statement);
            diagnostic = diagnostic.fix(Fix::remove(location, "remove the import"));
        }
        self.diagnostics.push(diagnostic);
    }
}

/// Returns the error of a text that is not a program. Returns `None` for a program with errors:
/// one that begins with a declaration, or that has few errors without a fix.
fn no_program(path: &str, errors: &[Diagnostic], tree: &Tree) -> Option<Diagnostic> {
    /// Smallest number of errors in a text that is not a program.
    const MIN: usize = 5;
    let unknown = || errors.iter().filter(|error| error.fix.is_none());
    let first = unknown().next()?.labels.first()?.location;
    let begins = |item: &Item| item.span.start < first.span.start;
    let count = unknown().filter(|error| error.code == Code::Syntax).count();
    if tree.items.first().is_some_and(begins) || count < MIN.max(3 * tree.items.len()) {
        return None;
    }
    let title = format!("`{}` does not look like a program", visible(path));
    let first = errors.first()?.labels.first()?.location;
    let diagnostic = Diagnostic::new(Code::Syntax, title)
        .label(first, "no declaration begins here")
        .help("pass a program (`*.sa`); `stochc new NAME` writes one");
    Some(diagnostic)
}

/// Returns the error of carriage returns without line feeds. Returns `None` if there are none.
///
/// Most editors show them as line ends. The grammar does not read them as line ends, so code after
/// a comment would be a part of the comment.
pub fn lone_returns(file: FileId, text: &str) -> Option<Diagnostic> {
    /// Largest number of carriage returns that one fix replaces.
    const MAX: usize = 10_000;
    let bytes = text.as_bytes();
    let is_lone = |&at: &usize| bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n');
    let mut places = (0..bytes.len()).filter(is_lone).map(|at| SourceLocation {
        file,
        span: Span::new(at as u32, at as u32 + 1),
    });
    let first = places.next()?;
    let diagnostic = Diagnostic::new(Code::Syntax, "carriage return without a line feed")
        .label(first, "this does not end a line")
        .help("save the file with Unix or Windows line ends");
    let edits: Vec<Edit> = std::iter::once(first)
        .chain(places)
        .take(MAX + 1)
        .map(|location| Edit {
            location,
            text: "\n".to_owned(),
        })
        .collect();
    Some(match edits.len() {
        0..=MAX => diagnostic.fix(Fix {
            title: "end lines with line feeds".to_owned(),
            edits,
            safe: true,
        }),
        _ => diagnostic,
    })
}

/// Decodes a file. Returns the length of its byte order mark, the text after it, and the position
/// of the first invalid byte.
fn decode(mut bytes: Vec<u8>) -> (u32, String, Option<usize>) {
    let mark = if bytes.starts_with(BYTE_ORDER_MARK.as_bytes()) {
        BYTE_ORDER_MARK.len()
    } else {
        0
    };
    bytes.drain(..mark);
    let mark = mark as u32;
    match String::from_utf8(bytes) {
        Ok(text) => (mark, text, None),
        Err(error) => {
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            (mark, text, Some(error.utf8_error().valid_up_to()))
        }
    }
}

/// Returns the path of an imported file. `import` is relative to the folder of the file `importer`.
/// The result is relative to the same folder as `importer`.
pub fn join(importer: &str, import: &str) -> String {
    let folder = importer.rfind('/').map_or("", |slash| &importer[..=slash]);
    let joined = if import.starts_with('/') {
        import.to_owned()
    } else {
        format!("{folder}{import}")
    };
    without_dots(&joined)
}

/// Returns a path without `.`, and without `..` after a folder name.
pub fn without_dots(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "." => {}
            // Consecutive slashes are equal to one, except at the beginning of a path.
            "" if !path.starts_with('/') || parts.iter().any(|part| !part.is_empty()) => {}
            ".." if parts.last().is_some_and(|last| !matches!(*last, ".." | "")) => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::join;

    #[test]
    fn imports_are_relative_to_their_file() {
        assert_eq!(join("a.sa", "b.sa"), "b.sa");
        assert_eq!(join("x/a.sa", "b.sa"), "x/b.sa");
        assert_eq!(join("x/a.sa", "../b.sa"), "b.sa");
        assert_eq!(join("x/a.sa", "./y/../b.sa"), "x/b.sa");
        assert_eq!(join("../a.sa", "../b.sa"), "../../b.sa");
        assert_eq!(join("/x/a.sa", "../../b.sa"), "/../b.sa");
        assert_eq!(join("x/a.sa", "/b.sa"), "/b.sa");
        for importer in [".//a.sa", "././/a.sa", "x/..//a.sa"] {
            assert_eq!(join(importer, "b.sa"), "b.sa", "{importer}");
        }
        assert_eq!(join("x//a.sa", "y//b.sa"), "x/y/b.sa");
        assert_eq!(join("a.sa", ".//b.sa"), "b.sa");
        assert_eq!(join("/x//a.sa", "b.sa"), "/x/b.sa");
    }
}
