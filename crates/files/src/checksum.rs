//! CRC-32 checksums of lines, parts and whole files. They detect accidental corruption.
use std::fmt::Write as _;
use std::io::{self, BufRead as _, BufReader, Read, Write};

use flate2::Crc;

/// Returns the checksum of bytes.
pub fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = Crc::new();
    crc.update(bytes);
    crc.sum()
}

/// Number of bytes with their checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sum {
    /// Number of bytes.
    pub bytes: u64,
    /// Checksum.
    pub crc32: u32,
}

impl Sum {
    /// Returns the number and the checksum of bytes.
    pub fn from_bytes(bytes: &[u8]) -> Sum {
        Sum {
            bytes: bytes.len() as u64,
            crc32: crc32(bytes),
        }
    }
}

/// Writer that computes a checksum of its output.
#[derive(Debug)]
pub struct Summed<W> {
    to: W,
    bytes: u64,
    crc: Crc,
}

impl<W> Summed<W> {
    /// Wraps a writer.
    pub fn new(to: W) -> Summed<W> {
        Summed {
            to,
            bytes: 0,
            crc: Crc::new(),
        }
    }

    /// Returns the inner writer and the checksum.
    pub fn finish(self) -> (W, Sum) {
        let sum = Sum {
            bytes: self.bytes,
            crc32: self.crc.sum(),
        };
        (self.to, sum)
    }
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.to.write(bytes)?;
        self.crc.update(&bytes[..count]);
        self.bytes += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// Computes the checksum of the first `length` bytes of a file.
///
/// # Errors
///
/// Errors of the file system.
pub fn sum_file(file: impl Read, length: u64) -> io::Result<Sum> {
    let mut crc = Crc::new();
    let mut from = BufReader::with_capacity(1 << 16, file.take(length));
    let mut bytes = 0;
    loop {
        let part = from.fill_buf()?;
        if part.is_empty() {
            let crc32 = crc.sum();
            return Ok(Sum { bytes, crc32 });
        }
        crc.update(part);
        let read = part.len();
        bytes += read as u64;
        from.consume(read);
    }
}

/// Integrity of a line of JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineIntegrity {
    /// The checksum matches.
    Valid,
    /// The checksum does not match.
    Corrupted,
    /// There is no checksum.
    Unsealed,
}

/// Start of the checksum field, which is the last field of a JSON object.
const FIELD: &[u8] = b",\"crc\":\"";
/// Length of the field `,"crc":"01234567"}`.
const LENGTH: usize = FIELD.len() + 8 + 2;

/// Appends the field `crc` to a JSON object. The field contains the hexadecimal checksum of all
/// text before the field.
///
/// # Panics
///
/// If the text is not an object with at least one field, or has trailing white space.
pub fn sealed(mut object: String) -> String {
    assert_eq!(object.pop(), Some('}'), "an object ends with a brace");
    let crc = crc32(object.as_bytes());
    write!(object, ",\"crc\":\"{crc:08x}\"}}").expect("writing to a string cannot fail");
    object
}

/// Checks a line, without its line break, against its checksum.
pub fn check(line: &[u8]) -> LineIntegrity {
    let Some(at) = line.len().checked_sub(LENGTH) else {
        return LineIntegrity::Unsealed;
    };
    let (body, seal) = line.split_at(at);
    if !seal.starts_with(FIELD) {
        return LineIntegrity::Unsealed;
    }
    // Compares digits, so that only one form is valid.
    let crc = crc32(body);
    let digits = (0..8).map(|place| b"0123456789abcdef"[(crc >> (28 - 4 * place) & 15) as usize]);
    let expected = digits.chain(*b"\"}");
    if expected.eq(seal[FIELD.len()..].iter().copied()) {
        LineIntegrity::Valid
    } else {
        LineIntegrity::Corrupted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_flipped_bit_of_a_line_passes() {
        let line = sealed("{\"a\":[1,2,3],\"b\":\"\u{e4}\"}".to_owned()).into_bytes();
        assert_eq!(check(&line), LineIntegrity::Valid);
        assert_eq!(check(b"{\"a\":1}"), LineIntegrity::Unsealed);
        for bit in 0..8 * line.len() {
            let mut line = line.clone();
            line[bit / 8] ^= 1 << (bit % 8);
            assert_ne!(check(&line), LineIntegrity::Valid, "{bit}");
        }
    }

    #[test]
    fn the_checksum_is_that_of_zip_and_png() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }
}
