//! Sequential reader of a `.vox` file. All results are slices of the file.
use super::super::UnreadableVoxels;

/// Rest of a file or chunk.
#[derive(Clone, Copy, Debug)]
pub struct Bytes<'a>(pub &'a [u8]);

pub struct Chunk<'a> {
    /// Name of four letters.
    pub name: &'a [u8],
    /// Content of the chunk without its children.
    pub content: Bytes<'a>,
    pub children: Bytes<'a>,
}

/// Attributes of a node that affect placement and visibility.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Attributes<'a> {
    pub is_hidden: bool,
    /// Rotation, as a decimal number.
    pub rotation: Option<&'a [u8]>,
    /// Translation, as three decimal numbers.
    pub translation: Option<&'a [u8]>,
}

impl<'a> Bytes<'a> {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Reads `length` bytes.
    pub fn take(&mut self, length: usize) -> Result<&'a [u8], UnreadableVoxels> {
        let split = self.0.split_at_checked(length);
        let (taken, rest) = split.ok_or(UnreadableVoxels::CutOff)?;
        self.0 = rest;
        Ok(taken)
    }

    /// Reads a 32-bit number.
    pub fn number(&mut self) -> Result<u32, UnreadableVoxels> {
        let split = self.0.split_first_chunk::<4>();
        let (number, rest) = split.ok_or(UnreadableVoxels::CutOff)?;
        self.0 = rest;
        Ok(u32::from_le_bytes(*number))
    }

    /// Reads a chunk with its children.
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

    /// Reads a dictionary.
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
