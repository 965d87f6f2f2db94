use serde::{Deserialize, Serialize};

/// Face of a block, in the structure's frame: east is +x, north +y, up +z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[repr(u8)]
pub enum Face {
    /// +x
    East,
    /// -x
    West,
    /// +y
    North,
    /// -y
    South,
    /// +z
    Up,
    /// -z
    Down,
}

impl Face {
    /// All six faces, in the order of their discriminants.
    pub const ALL: [Face; 6] = [
        Face::East,
        Face::West,
        Face::North,
        Face::South,
        Face::Up,
        Face::Down,
    ];

    /// The four horizontal faces.
    pub const SIDES: [Face; 4] = [Face::East, Face::West, Face::North, Face::South];

    /// Returns the outward unit normal \[cells\].
    pub const fn normal(self) -> [i32; 3] {
        match self {
            Face::East => [1, 0, 0],
            Face::West => [-1, 0, 0],
            Face::North => [0, 1, 0],
            Face::South => [0, -1, 0],
            Face::Up => [0, 0, 1],
            Face::Down => [0, 0, -1],
        }
    }

    /// Returns the face on the other side of the block.
    pub const fn opposite(self) -> Face {
        match self {
            Face::East => Face::West,
            Face::West => Face::East,
            Face::North => Face::South,
            Face::South => Face::North,
            Face::Up => Face::Down,
            Face::Down => Face::Up,
        }
    }

    /// Returns the face after quarter turns from east to north. Returns `None` for `up` and `down`.
    pub fn turned(self, quarters: u8) -> Option<Face> {
        const CIRCLE: [Face; 4] = [Face::East, Face::North, Face::West, Face::South];
        let at = CIRCLE.iter().position(|&face| face == self)?;
        Some(CIRCLE[(at + usize::from(quarters)) % CIRCLE.len()])
    }

    /// Returns the keyword of the face.
    pub const fn word(self) -> &'static str {
        match self {
            Face::East => "east",
            Face::West => "west",
            Face::North => "north",
            Face::South => "south",
            Face::Up => "up",
            Face::Down => "down",
        }
    }

    /// Returns the face of a keyword. Returns `None` for other words.
    pub fn from_word(word: &str) -> Option<Face> {
        Face::ALL.into_iter().find(|face| face.word() == word)
    }
}

impl std::fmt::Display for Face {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.word())
    }
}
