//! The bytes of a `.vox` file, read from the front. Nothing is kept but slices of the file.
use super::super::UnreadableVoxels;

/// The rest of a file or chunk.
#[derive(Clone, Copy, Debug)]
pub struct Bytes<'a>(pub &'a [u8]);

/// A part of a file.
pub struct Chunk<'a> {
    /// Four letters.
    pub name: &'a [u8],
    /// Its own content.
    pub content: Bytes<'a>,
    /// The chunks in it.
    pub children: Bytes<'a>,
}

/// The attributes of a node that place or hide it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attributes<'a> {
    /// Whether it is hidden.
    pub is_hidden: bool,
    /// A rotation, as a number in decimal digits.
    pub rotation: Option<&'a [u8]>,
    /// A translation, as three numbers in decimal digits.
    pub translation: Option<&'a [u8]>,
}

impl<'a> Bytes<'a> {
    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Takes so many bytes.
    pub fn take(&mut self, length: usize) -> Result<&'a [u8], UnreadableVoxels> {
        let split = self.0.split_at_checked(length);
        let (taken, rest) = split.ok_or(UnreadableVoxels::CutOff)?;
        self.0 = rest;
        Ok(taken)
    }

    /// Takes a number of 32 bits.
    pub fn number(&mut self) -> Result<u32, UnreadableVoxels> {
        let split = self.0.split_first_chunk::<4>();
        let (number, rest) = split.ok_or(UnreadableVoxels::CutOff)?;
        self.0 = rest;
        Ok(u32::from_le_bytes(*number))
    }

    /// Takes a chunk with all that is in it.
    pub fn chunk(&mut self) -> Result<Chunk<'a>, UnreadableVoxels> {
        let name = self.take(4)?;
        let (content, children) = (self.number()?, self.number()?);
        Ok(Chunk {
            name,
            content: Bytes(self.take(content as usize)?),
            children: Bytes(self.take(children as usize)?),
        })
    }

    fn string(&mut self) -> Result<&'a [u8], UnreadableVoxels> {
        let length = self.number()?;
        self.take(length as usize)
    }

    /// Takes a dictionary.
    pub fn attributes(&mut self) -> Result<Attributes<'a>, UnreadableVoxels> {
        let mut attributes = Attributes::default();
        for _ in 0..self.number()? {
            let (key, value) = (self.string()?, self.string()?);
            match key {
                b"_hidden" => attributes.is_hidden = value == b"1",
                b"_r" => attributes.rotation = Some(value),
                b"_t" => attributes.translation = Some(value),
                _ => {}
            }
        }
        Ok(attributes)
    }
}
