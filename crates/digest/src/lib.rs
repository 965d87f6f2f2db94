//! Digest of a crate's sources, for its build script. Two builds with equal digests compute equal
//! results.
//!
//! It depends only on the names and contents of files in `src`, not on their location or line
//! endings.
use std::io;
use std::path::Path;

/// Sets the variable `STOCHC_SOURCES` for the crate of the calling build script. Cargo repeats this
/// whenever a file in `src` changes.
///
/// # Errors
///
/// If the sources cannot be read.
pub fn emit() -> io::Result<()> {
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=STOCHC_SOURCES={}", of(Path::new("src"))?);
    Ok(())
}

/// Returns the digest of a folder as 32 hexadecimal digits.
///
/// Ignores documentation pages (`.md`).
///
/// # Errors
///
/// If the folder or one of its files cannot be read.
pub fn of(folder: &Path) -> io::Result<String> {
    let mut files = Vec::new();
    collect(folder, "", &mut files)?;
    files.sort();
    let mut hash = Fnv::new();
    for (name, content) in files {
        hash.part(name.as_bytes());
        hash.part(&content);
    }
    Ok(format!("{:032x}", hash.0))
}

fn collect(folder: &Path, within: &str, files: &mut Vec<(String, Vec<u8>)>) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let name = format!("{within}/{}", name.to_string_lossy());
        if entry.file_type()?.is_dir() {
            collect(&entry.path(), &name, files)?;
        } else if !name.ends_with(".md") {
            let mut content = std::fs::read(entry.path())?;
            content.retain(|&byte| byte != b'\r');
            files.push((name, content));
        }
    }
    Ok(())
}

/// 128-bit FNV-1a hash. Its code is short, and accidental collisions are very unlikely.
///
/// # Source
///
/// G. Fowler, L. C. Noll and K.-P. Vo.
struct Fnv(u128);

impl Fnv {
    fn new() -> Fnv {
        Fnv(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    /// Adds the number of bytes, then the bytes. Different lists of parts therefore give different
    /// hashes.
    fn part(&mut self, bytes: &[u8]) {
        self.bytes(&(bytes.len() as u64).to_le_bytes());
        self.bytes(bytes);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(PRIME);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares hashes with test vectors from the authors' table.
    #[test]
    fn the_hash_matches_the_published_vectors() {
        for (text, hash) in [
            ("", 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d_u128),
            ("a", 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964),
            ("foobar", 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18),
        ] {
            let mut found = Fnv::new();
            found.bytes(text.as_bytes());
            assert_eq!(found.0, hash, "{text}");
        }
    }

    #[test]
    #[expect(clippy::disallowed_methods, reason = "the files are the test's own")]
    fn only_names_within_the_folder_and_contents_count() {
        let base = std::env::temp_dir().join(format!("stochc-digest-{}", std::process::id()));
        let write = |name: &str, text: &str| {
            let path = base.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        };
        write("one/lib.rs", "mod a;\nmod b;\n");
        write("one/a/mod.rs", "");
        write("elsewhere/two/a/mod.rs", "");
        write("elsewhere/two/lib.rs", "mod a;\r\nmod b;\r\n");
        write("elsewhere/two/page.md", "words");
        let digest = |name: &str| of(&base.join(name)).unwrap();
        assert_eq!(digest("one"), digest("elsewhere/two"));
        assert_eq!(digest("one").len(), 32);
        write("one/a/mod.rs", " ");
        assert_ne!(digest("one"), digest("elsewhere/two"));
        write("one/a/mod.rs", "");
        std::fs::rename(base.join("one/a"), base.join("one/c")).unwrap();
        assert_ne!(digest("one"), digest("elsewhere/two"));
        std::fs::remove_dir_all(&base).unwrap();
    }
}
