//! A secret key of the user: what is signed with it was written by this user, and not by whoever else has given a file.
//!
//! It is made when it is needed first, in `stochc/key` of `$XDG_STATE_HOME` or `~/.local/state` (XDG Base Directory Specification), and
//! only the user may read it.
use std::fs;
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use hmac::{Hmac, KeyInit as _, Mac as _};
use sha2::Sha256;

/// Bytes of a key, and of a signature (HMAC-SHA-256, RFC 2104).
pub const LENGTH: usize = 32;

/// What says that somebody who has the key has written something.
pub type Signature = [u8; LENGTH];

/// A secret key.
#[derive(Clone)]
pub struct SecretKey([u8; LENGTH]);

impl std::fmt::Debug for SecretKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("SecretKey")
    }
}

impl SecretKey {
    /// That of the user, which is made if there is none.
    ///
    /// # Errors
    /// If there is no place for it, or others could read it.
    pub fn of_user() -> io::Result<&'static SecretKey> {
        static KEY: OnceLock<SecretKey> = OnceLock::new();
        if let Some(key) = KEY.get() {
            return Ok(key);
        }
        let key = place().and_then(|path| SecretKey::at(&path))?;
        Ok(KEY.get_or_init(|| key))
    }

    /// The key in a file, which is made if it is not there.
    fn at(path: &Path) -> io::Result<SecretKey> {
        let key = match read(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                make(path).and_then(|()| read(path))
            }
            found => found,
        };
        let named = |error: io::Error| {
            let path = path.display();
            io::Error::new(error.kind(), format!("the key `{path}`: {error}"))
        };
        key.map(SecretKey).map_err(named)
    }

    fn hmac(&self) -> Hmac<Sha256> {
        Hmac::new_from_slice(&self.0).expect("a key of any length will do")
    }

    /// Whether a signature is that of the first `length` bytes that come.
    ///
    /// # Errors
    /// Those of the reader.
    pub fn has_signed(
        &self,
        from: impl Read,
        length: u64,
        signature: &Signature,
    ) -> io::Result<bool> {
        let mut signed = Signed::new(io::sink(), self);
        let mut from = BufReader::with_capacity(1 << 16, from.take(length));
        Ok(io::copy(&mut from, &mut signed)? == length
            && signed.hmac.verify_slice(signature).is_ok())
    }
}

/// Signs what is written through it.
#[derive(Debug)]
pub struct Signed<W> {
    to: W,
    hmac: Hmac<Sha256>,
}

impl<W> Signed<W> {
    /// Before the first byte.
    pub fn new(to: W, key: &SecretKey) -> Signed<W> {
        Signed {
            to,
            hmac: key.hmac(),
        }
    }

    /// Where it was written to, and the signature.
    pub fn finish(self) -> (W, Signature) {
        (self.to, self.hmac.finalize().into_bytes().into())
    }
}

impl<W: Write> Write for Signed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.to.write(bytes)?;
        self.hmac.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

fn place() -> io::Result<PathBuf> {
    let states = std::env::var_os("XDG_STATE_HOME").map(PathBuf::from);
    // The specification has a relative path ignored.
    let states = states.filter(|path| path.is_absolute());
    let states = states.or_else(|| Some(std::env::home_dir()?.join(".local/state")));
    let missing = "there is no home directory for a key to sign it with; set `XDG_STATE_HOME`";
    let states = states.filter(|path| path.is_absolute());
    let states = states.ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, missing))?;
    Ok(states.join("stochc").join("key"))
}

fn read(path: &Path) -> io::Result<[u8; LENGTH]> {
    let file = fs::File::open(path)?;
    let metadata = file.metadata()?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        if metadata.permissions().mode() & 0o077 != 0 {
            return Err(io::Error::other("others can read it; `chmod 600` it"));
        }
    }
    let mut key = [0; LENGTH];
    if !metadata.is_file() || metadata.len() != LENGTH as u64 {
        return Err(io::Error::other("it is none; remove it"));
    }
    (&file).read_exact(&mut key)?;
    Ok(key)
}

/// Makes a key, unless somebody else makes one at the same time.
fn make(path: &Path) -> io::Result<()> {
    let folder = path.parent().ok_or(io::ErrorKind::NotFound)?;
    fs::create_dir_all(folder)?;
    let mut key = [0; LENGTH];
    getrandom::fill(&mut key).map_err(io::Error::other)?;
    // Whole before it has its name; a temporary file is its user's alone.
    let mut draft = tempfile::NamedTempFile::new_in(folder)?;
    draft.write_all(&key)?;
    draft.as_file().sync_all()?;
    match draft.persist_noclobber(path) {
        Err(error) if error.error.kind() != io::ErrorKind::AlreadyExists => Err(error.error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signed(key: &SecretKey, bytes: &[u8]) -> Signature {
        let mut signed = Signed::new(Vec::new(), key);
        signed.write_all(bytes).unwrap();
        let (written, signature) = signed.finish();
        assert_eq!(written, bytes);
        signature
    }

    /// RFC 4231, test case 2.
    #[test]
    fn a_signature_is_that_of_the_standard() {
        let mut padded = [0; LENGTH];
        padded[..4].copy_from_slice(b"Jefe");
        let signature = signed(&SecretKey(padded), b"what do ya want for nothing?");
        let known = "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843";
        let shown: String = signature.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(shown, known);
    }

    #[test]
    fn one_key_is_made_and_only_its_signatures_count() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stochc/key");
        let keys: Vec<SecretKey> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..8)
                .map(|_| scope.spawn(|| SecretKey::at(&path).unwrap()))
                .collect();
            threads.into_iter().map(|it| it.join().unwrap()).collect()
        });
        assert!(keys.iter().all(|key| key.0 == keys[0].0));
        assert_ne!(keys[0].0, [0; LENGTH]);
        let other = SecretKey::at(&folder.path().join("other")).unwrap();
        let signature = signed(&keys[0], b"state");
        let has_signed = |key: &SecretKey, bytes: &[u8]| {
            key.has_signed(bytes, bytes.len() as u64, &signature)
                .unwrap()
        };
        assert!(has_signed(&keys[0], b"state"));
        assert!(!has_signed(&keys[0], b"statf"));
        assert!(!has_signed(&other, b"state"));
        // Fewer bytes than were signed, or than are said to come.
        assert!(!keys[0].has_signed(&b"state"[..], 4, &signature).unwrap());
        assert!(!keys[0].has_signed(&b"state"[..], 6, &signature).unwrap());
    }

    #[cfg(unix)]
    #[test]
    fn a_key_that_is_none_or_that_others_could_read_is_refused() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("key");
        SecretKey::at(&path).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).unwrap();
        let error = SecretKey::at(&path).unwrap_err().to_string();
        assert!(error.contains("others can read it"), "{error}");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).unwrap();
        fs::OpenOptions::new()
            .write(true)
            .open(&path)
            .and_then(|file| file.set_len(5))
            .unwrap();
        let error = SecretKey::at(&path).unwrap_err().to_string();
        assert!(error.contains("it is none; remove it"), "{error}");
        let error = SecretKey::at(&path.join("stochc/key")).unwrap_err();
        assert!(error.to_string().contains("stochc/key`: "), "{error}");
    }
}
