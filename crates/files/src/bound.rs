//! Folders that a program may import from.
use std::io;
use std::path::{Component, Path, PathBuf};

/// Folders with all links resolved.
#[derive(Clone, Debug)]
pub struct ImportFolders(Vec<PathBuf>);

impl ImportFolders {
    /// Returns the folder of a program and further folders, as [`folder`] resolves them.
    pub fn new(program: &str, further: &[PathBuf]) -> ImportFolders {
        let own = Path::new(program).parent().unwrap_or(Path::new(""));
        let own = std::iter::once(resolved(own));
        ImportFolders(own.chain(further.iter().cloned()).collect())
    }

    /// Returns `None` if a file is in one of the allowed folders. Otherwise returns the program's
    /// folder, for a message. Does not reveal whether the file exists.
    pub fn outside(&self, path: &str) -> Option<String> {
        let path = resolved(Path::new(path));
        let is_above = |folder: &PathBuf| path.starts_with(folder);
        let own = self.0.first()?;
        (!self.0.iter().any(is_above)).then(|| own.to_string_lossy().into_owned())
    }
}

/// Returns a folder with links resolved.
///
/// # Errors
///
/// Errors of the file system, and a path that is not a folder.
pub fn folder(path: &Path) -> io::Result<PathBuf> {
    let path = std::fs::canonicalize(path)?;
    if path.is_dir() {
        Ok(path)
    } else {
        Err(io::ErrorKind::NotADirectory.into())
    }
}

/// Returns the path of an existing file with all links resolved. All paths of the file give the
/// same result. Returns `None` if the file does not exist.
pub fn identity(path: &str) -> Option<String> {
    let path = std::fs::canonicalize(Path::new(".").join(path)).ok()?;
    path.into_os_string().into_string().ok()
}

/// Resolves links in the part of a path that exists.
fn resolved(path: &Path) -> PathBuf {
    let path = Path::new(".").join(path);
    let absolute = std::path::absolute(&path).unwrap_or(path);
    for there in absolute.ancestors() {
        let Ok(mut found) = std::fs::canonicalize(there) else {
            continue;
        };
        let rest = absolute.strip_prefix(there).unwrap_or(Path::new(""));
        for part in rest.components() {
            match part {
                Component::ParentDir => {
                    found.pop();
                }
                part => found.push(part),
            }
        }
        return found;
    }
    absolute
}

#[cfg(test)]
mod tests {
    #![allow(clippy::disallowed_methods, reason = "the test creates its files")]
    use super::*;

    #[test]
    #[cfg(unix)]
    fn imports_stay_within_the_folder_whatever_their_path_is() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
        for name in ["in/deep", "in-between", "out"] {
            std::fs::create_dir_all(at(name)).unwrap();
        }
        for name in ["in/own.sa", "in/deep/a.sa", "out/b.sa"] {
            std::fs::write(at(name), "").unwrap();
        }
        std::os::unix::fs::symlink(at("out"), at("in/link")).unwrap();
        std::os::unix::fs::symlink(at("out/b.sa"), at("in/b.sa")).unwrap();
        std::os::unix::fs::symlink(at("in"), at("same")).unwrap();
        let inside = [
            "in/own.sa",
            "in/deep/a.sa",
            "in/deep/../own.sa",
            "in/missing.sa",
            "in/missing/x.sa",
            "same/own.sa",
        ];
        let outside = [
            "out/b.sa",
            "in/b.sa",
            "in/link/b.sa",
            "in/link/missing.sa",
            "in/../out/b.sa",
            "in/missing/../../out/b.sa",
            "in-between/x.sa",
            "missing.sa",
        ];
        for program in ["in/own.sa", "same/own.sa"] {
            let bound = ImportFolders::new(&at(program), &[]);
            for path in inside {
                assert_eq!(bound.outside(&at(path)), None, "{path}");
            }
            for path in outside {
                assert!(bound.outside(&at(path)).is_some(), "{path}");
            }
        }
        let allowed = super::folder(Path::new(&at("in/link"))).unwrap();
        let bound = ImportFolders::new(&at("in/own.sa"), &[allowed]);
        assert_eq!(bound.outside(&at("in/b.sa")), None);
        assert!(bound.outside(&at("missing.sa")).is_some());
        assert!(super::folder(Path::new(&at("in/own.sa"))).is_err());
        assert!(
            ImportFolders::new("own.sa", &[])
                .outside("/etc/passwd")
                .is_some()
        );
        assert_eq!(ImportFolders::new("own.sa", &[]).outside("deep/x.sa"), None);
    }
}
