//! Random programs that are right by construction.
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use stochc::compiler::finding::Code;
use stochc::compiler::table::Tables;
use stochc::compiler::{Cell, Face};

/// A program, and what it builds.
#[derive(Clone, Debug)]
pub struct Declared {
    pub text: String,
    pub structure: BTreeMap<String, Cell>,
}

#[derive(Clone)]
struct Block {
    cell: Cell,
    parent: Option<String>,
    face: Face,
}

/// Turns a list of numbers into a program: each number is one choice.
struct Generator {
    choices: std::vec::IntoIter<u32>,
    blocks: BTreeMap<String, Block>,
    names: u32,
    spare: Vec<String>,
    text: String,
}

impl Generator {
    fn choose(&mut self, most: usize) -> usize {
        self.choices
            .next()
            .map_or(0, |choice| choice as usize % most.max(1))
    }

    fn new_name(&mut self) -> String {
        if !self.spare.is_empty() && self.choose(2) == 0 {
            let i = self.choose(self.spare.len());
            return self.spare.swap_remove(i);
        }
        self.names += 1;
        match self.choose(2) {
            0 => format!("N{}", self.names),
            _ => format!("T[{}, {}]", self.names, self.names + 1),
        }
    }

    fn phase(&mut self, number: usize) {
        let _ = writeln!(self.text, "    phase p{number} {{");
        let start = self.blocks.clone();
        // Events so far, as `after` can name them; only earlier ones, so that no circle arises.
        let mut events: Vec<String> = Vec::new();
        let mut captured: BTreeSet<String> = BTreeSet::new();
        let mut released: BTreeSet<String> = BTreeSet::new();
        let mut busy: BTreeSet<String> = BTreeSet::new();
        let mut taken: BTreeSet<Cell> = start.values().map(|block| block.cell).collect();
        for _ in 0..=self.choose(8) {
            let after = self.after(&events);
            if self.choose(4) == 0 {
                // Of the blocks that were there, one that nothing hangs on, or whose children go too.
                let leaves: Vec<String> = (start.iter())
                    .filter(|(name, block)| block.parent.is_some() && !released.contains(*name))
                    .filter(|(name, _)| !busy.contains(*name))
                    .filter(|(name, _)| {
                        self.blocks
                            .values()
                            .all(|block| block.parent.as_ref() != Some(name))
                    })
                    .map(|(name, _)| name.clone())
                    .collect();
                if !leaves.is_empty() {
                    let name = leaves[self.choose(leaves.len())].clone();
                    let _ = writeln!(self.text, "        release {name}{after}");
                    self.blocks.remove(&name);
                    events.push(format!("release {name}"));
                    released.insert(name);
                    continue;
                }
            }
            let parents: Vec<String> = self
                .blocks
                .keys()
                .filter(|name| !released.contains(*name))
                .cloned()
                .collect();
            let parent = parents[self.choose(parents.len())].clone();
            let block = self.blocks[&parent].clone();
            let faces: Vec<Face> = Face::ALL
                .into_iter()
                .filter(|&face| match &block.parent {
                    None => face == Face::Up,
                    Some(_) => face != block.face.opposite(),
                })
                .filter(|&face| {
                    let cell = block.cell.across(face).unwrap();
                    // A cell that is emptied in this phase may be filled in this phase.
                    let emptied = released.iter().any(|name| start[name].cell == cell);
                    let filled = self.blocks.values().any(|block| block.cell == cell);
                    cell.z >= 1 && !filled && (!taken.contains(&cell) || emptied)
                })
                .collect();
            if faces.is_empty() {
                continue;
            }
            let face = faces[self.choose(faces.len())];
            let cell = block.cell.across(face).unwrap();
            let name = self.new_name();
            let _ = writeln!(self.text, "        {parent}.{face} -> {name}{after}");
            taken.insert(cell);
            busy.insert(parent.clone());
            captured.insert(name.clone());
            events.push(name.clone());
            self.blocks.insert(
                name,
                Block {
                    cell,
                    parent: Some(parent),
                    face,
                },
            );
        }
        self.spare.extend(released);
        self.text.push_str("    }\n");
    }

    fn after(&mut self, events: &[String]) -> String {
        if events.is_empty() || self.choose(3) > 0 {
            return String::new();
        }
        let mut list: Vec<String> = (0..=self.choose(2))
            .map(|_| events[self.choose(events.len())].clone())
            .collect();
        list.dedup();
        format!(" after {}", list.join(", "))
    }
}

/// The program that a list of choices leads to, for blocks that magnetize `faces` faces at a time.
pub fn declare(choices: Vec<u32>, faces: u8) -> Declared {
    let mut generator = Generator {
        choices: choices.into_iter(),
        blocks: BTreeMap::new(),
        names: 0,
        spare: Vec::new(),
        text: format!(
            "scene many from hemisphere {{ block cube {{ side 20cm mass 1kg faces {faces} }} }}\n\
             assembly random in many {{\n    seed plate 3 x 3 {{\n"
        ),
    };
    for (name, x, y) in [("A", 0, 0), ("B", 2, 0), ("C", 1, 1)] {
        let _ = writeln!(generator.text, "        {name} at ({x}, {y})");
        let cell = Cell::new(x, y, 0);
        generator.blocks.insert(
            name.into(),
            Block {
                cell,
                parent: None,
                face: Face::Up,
            },
        );
    }
    generator.text.push_str("    }\n");
    for number in 0..=generator.choose(4) {
        generator.phase(number);
    }
    generator.text.push_str("}\n");
    let structure = generator
        .blocks
        .into_iter()
        .map(|(name, block)| (name, block.cell))
        .collect();
    Declared {
        text: generator.text,
        structure,
    }
}

impl Declared {
    /// Its event tables.
    ///
    /// # Panics
    /// If the compiler finds anything wrong.
    pub fn tables(&self) -> Tables {
        let mut reader = |_: &str| Ok(self.text.clone().into_bytes());
        let mut checked = stochc::compiler::check("random.sa", &mut reader, Default::default());
        let errors: Vec<_> = (checked.findings.iter())
            .filter(|finding| finding.is_error() && finding.code != Code::SealedCavity)
            .collect();
        assert!(errors.is_empty(), "{}\n{errors:#?}", self.text);
        // What chance can wall in still keeps to the protocol, in a world that knows no walls.
        let program = checked.programs.remove(0);
        program.tables.or(program.stuck).unwrap()
    }
}
