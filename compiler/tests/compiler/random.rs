//! Random programs that are valid by construction.
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use stochc_compiler::Program;
use stochc_compiler::diagnostic::Code;
use stochc_ir::table::Tables;
use stochc_ir::{Cell, Face};

/// A program and the structure that it builds.
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
    reuse: Reuse,
    /// Whether the program has parameters, which its conditions compare.
    has_parameters: bool,
    text: String,
    /// Declarations of the shapes that the phases claim.
    shapes: String,
}

/// Earliest reuse of names, cells and faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reuse {
    /// Names are reused in a later phase, cells and faces in the same phase.
    Later,
    /// Everything is reused in the same phase, as often as possible. Branches move, and blocks take
    /// the name or cell of a released block. Some blocks are captured and released within the
    /// phase.
    AtOnce,
}

/// State of a phase while it is written.
struct Stage {
    /// Blocks at the start of the phase.
    start: BTreeMap<String, Block>,
    /// Events so far, which `after` can name. Using only earlier events avoids cycles.
    events: Vec<String>,
    captured: BTreeSet<String>,
    released: BTreeSet<String>,
    /// Blocks that have captured. If such a block existed at the start, its name may not be reused.
    busy: BTreeSet<String>,
    /// Cells of the captures.
    filled: BTreeSet<Cell>,
}

impl Generator {
    fn choose(&mut self, most: usize) -> usize {
        self.choices
            .next()
            .map_or(0, |choice| choice as usize % most.max(1))
    }

    fn new_name(&mut self, stage: &Stage) -> String {
        if self.reuse == Reuse::AtOnce {
            let free: Vec<&String> = (stage.released.iter())
                .filter(|name| stage.can_be_taken(name))
                .collect();
            if !free.is_empty() && self.choose(4) > 0 {
                return free[self.choose(free.len())].clone();
            }
        }
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
        let head = self.text.len();
        let _ = writeln!(self.text, "    phase p{number} {{");
        if head.is_multiple_of(5) {
            let _ = writeln!(self.text, "        wait {} ticks", 1 + head % 7);
        }
        let mut stage = Stage {
            start: self.blocks.clone(),
            events: Vec::new(),
            captured: BTreeSet::new(),
            released: BTreeSet::new(),
            busy: BTreeSet::new(),
            filled: BTreeSet::new(),
        };
        for _ in 0..=self.choose(8) {
            if self.reuse == Reuse::AtOnce && self.choose(3) == 0 && self.move_branch(&mut stage) {
                continue;
            }
            let after = self.after(&stage.events);
            if self.choose(4) == 0 {
                let leaves = self.leaves(&stage);
                if !leaves.is_empty() {
                    let name = leaves[self.choose(leaves.len())].clone();
                    self.release(&mut stage, name, &after);
                    continue;
                }
            }
            let parents: Vec<String> = self.blocks.keys().cloned().collect();
            let parent = parents[self.choose(parents.len())].clone();
            if let Some(face) = self.free_face(&stage, &parent) {
                let name = self.new_name(&stage);
                self.capture(&mut stage, parent, face, name, &after);
            }
        }
        self.claim(number);
        self.text.push_str("    }");
        // Phases with releases cannot be retried.
        if stage.released.is_empty()
            && stage.captured.len() < 5
            && self.text.len().is_multiple_of(3)
        {
            let plain = format!("phase p{number} {{");
            let limited = format!("phase p{number} timeout 10000000000 ticks {{");
            let phase = self.text.split_off(head).replacen(&plain, &limited, 1);
            let pause = ["", "wait 1 min "][self.text.len() % 2];
            let handler = format!(
                "release p{number} {pause}retry {}",
                stage.captured.len() + 1
            );
            let _ = write!(self.text, "{phase} on timeout {{ {handler} }}");
        }
        self.text.push('\n');
        let releases = stage.released.into_iter();
        self.spare
            .extend(releases.filter(|name| !self.blocks.contains_key(name)));
    }

    /// Claims the structure at the end of a phase, or every second cell of it.
    fn claim(&mut self, number: usize) {
        let (claim, step) = match self.text.len() % 4 {
            0 => ("yields", 1),
            1 => ("yields at least", 2),
            _ => return,
        };
        let blocks = self.blocks.values().map(|block| block.cell);
        let cells: BTreeSet<Cell> = blocks.filter(|cell| cell.z > 0).collect();
        let cells: BTreeSet<Cell> = cells.into_iter().step_by(step).collect();
        if !cells.is_empty() {
            let _ = writeln!(self.text, "        {claim} s{number}");
            self.shapes.push_str(&shape(number, &cells));
        }
    }

    /// Claims something about the runs of the program. `last` is the number of the last phase.
    fn claims(&mut self, last: usize) {
        let number = self.text.len();
        let relation = [">=", "<="][number % 2];
        let within = ["", " within 2 min", " within 5 ms", " within 1e12 s"][number % 4];
        let bound = ["0.5", "99.99 %", "1e-7", "0.9999"][number / 2 % 4];
        let mut events = vec![
            "complete".to_owned(),
            format!("phase p{}", number % (last + 1)),
        ];
        let captured = |(name, block): (&String, &Block)| {
            Some(format!("captured {name} by {}", block.parent.as_ref()?))
        };
        events.extend(self.blocks.iter().find_map(captured));
        for event in events {
            let claim = format!("{event}{within} with probability {relation} {bound}");
            let _ = writeln!(self.text, "    expect {claim}");
        }
        let _ = writeln!(
            self.text,
            "    expect mean completion {relation} {number} ticks"
        );
    }

    /// Returns the blocks that can be released: those without children.
    fn leaves(&self, stage: &Stage) -> Vec<String> {
        (self.blocks.iter())
            .filter(|(name, block)| block.parent.is_some() && !stage.released.contains(*name))
            .filter(|(name, _)| {
                let stays = !stage.captured.contains(*name) && !stage.busy.contains(*name);
                stays || self.reuse == Reuse::AtOnce
            })
            .filter(|(name, _)| self.children(name).next().is_none())
            .map(|(name, _)| name.clone())
            .collect()
    }

    fn children<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a String> {
        let is_child = |block: &Block| block.parent.as_deref() == Some(name);
        (self.blocks.iter())
            .filter(move |(_, block)| is_child(block))
            .map(|(name, _)| name)
    }

    fn release(&mut self, stage: &mut Stage, name: String, after: &str) {
        if after.is_empty() && self.reuse == Reuse::AtOnce && self.choose(4) == 0 {
            let _ = writeln!(self.text, "        drop({name})");
        } else {
            let delay = match (self.text.len() % 3, after) {
                (0, "") => " after 2 s",
                (0, _) => ", 7 ticks",
                _ => "",
            };
            let _ = writeln!(self.text, "        release {name}{after}{delay}");
        }
        self.blocks.remove(&name);
        stage.events.push(format!("release {name}"));
        stage.released.insert(name);
    }

    /// Returns a free face of a block for a capture.
    fn free_face(&mut self, stage: &Stage, parent: &str) -> Option<Face> {
        let block = &self.blocks[parent];
        let faces: Vec<Face> = Face::ALL
            .into_iter()
            .filter(|&face| match &block.parent {
                None => face == Face::Up,
                Some(_) => face != block.face.opposite(),
            })
            .filter(|&face| {
                let cell = block.cell.across(face).unwrap();
                // A cell that is emptied in this phase may be filled in this phase, once.
                let is_full = self.blocks.values().any(|block| block.cell == cell);
                cell.z >= 1 && !is_full && !stage.filled.contains(&cell)
            })
            .collect();
        let which = (!faces.is_empty()).then(|| self.choose(faces.len()))?;
        Some(faces[which])
    }

    fn capture(
        &mut self,
        stage: &mut Stage,
        parent: String,
        face: Face,
        name: String,
        after: &str,
    ) {
        let statement = if after.is_empty() && self.reuse == Reuse::AtOnce && self.choose(4) == 0 {
            instance(&parent, &name, face, self.text.len())
        } else {
            match name.strip_suffix(']') {
                Some(head) if self.text.len().is_multiple_of(5) => {
                    let last = head.rsplit(' ').next().unwrap_or_default();
                    format!("{parent}.{face} ->> {head}..{last}]{after}")
                }
                _ => format!("{parent}.{face} -> {name}{after}"),
            }
        };
        // The other branch contains names that do not exist.
        let (start, end) = match self.text.len() % 5 {
            0 if self.has_parameters => ("if edge > 2 and not (last == 0) {", "} else { drop() }"),
            1 if self.has_parameters => (
                "if edge % 2 == 0 { release Nothing } else if min(edge, 9) == abs(last + 1) {",
                "} else { Nothing.up -> None }",
            ),
            2 => ("for round in 3..3 {", "}"),
            _ => ("", ""),
        };
        let _ = writeln!(self.text, "        {start} {statement} {end}");
        let cell = self.blocks[&parent].cell.across(face).unwrap();
        stage.filled.insert(cell);
        stage.busy.insert(parent.clone());
        stage.captured.insert(name.clone());
        stage.events.push(name.clone());
        let parent = Some(parent);
        self.blocks.insert(name, Block { cell, parent, face });
    }

    /// Releases a block with its branch and captures a branch of the same size, perhaps elsewhere.
    /// Returns whether there was such a block.
    fn move_branch(&mut self, stage: &mut Stage) -> bool {
        let is_idle = |name: &String| {
            stage.start.contains_key(name)
                && !stage.released.contains(name)
                && !stage.busy.contains(name)
        };
        let branches: Vec<Vec<String>> = (self.blocks.iter())
            .filter(|(_, block)| block.parent.is_some())
            .map(|(name, _)| self.branch(name))
            .filter(|branch| branch.iter().all(is_idle))
            .collect();
        if branches.is_empty() {
            return false;
        }
        let branch = branches[self.choose(branches.len())].clone();
        for name in branch.iter().rev() {
            let after = self.after(&stage.events);
            self.release(stage, name.clone(), &after);
        }
        for name in branch {
            let parents: Vec<String> = self.blocks.keys().cloned().collect();
            let before = stage.start[&name].parent.clone();
            let parent = match before.filter(|parent| self.blocks.contains_key(parent)) {
                Some(parent) if self.choose(4) > 0 => parent,
                _ => parents[self.choose(parents.len())].clone(),
            };
            if !stage.can_be_taken(&name) || self.choose(8) == 7 {
                continue;
            }
            if let Some(face) = self.free_face(stage, &parent) {
                let after = self.after(&stage.events);
                self.capture(stage, parent, face, name, &after);
            }
        }
        true
    }

    /// Returns a block and its branch, each block after its parent.
    fn branch(&self, root: &str) -> Vec<String> {
        let mut branch = vec![root.to_owned()];
        let mut next = 0;
        while next < branch.len() {
            let children: Vec<String> = self.children(&branch[next]).cloned().collect();
            branch.extend(children);
            next += 1;
        }
        branch
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

impl Stage {
    /// Returns whether another block can take a name that is free, or becomes free, in this phase.
    fn can_be_taken(&self, name: &str) -> bool {
        self.start.contains_key(name) && !self.captured.contains(name) && !self.busy.contains(name)
    }
}

/// Returns the declaration of a shape with these cells.
fn shape(number: usize, cells: &BTreeSet<Cell>) -> String {
    let range = |of: fn(&Cell) -> i32| {
        let values = || cells.iter().map(of);
        values().min().unwrap()..=values().max().unwrap()
    };
    let (columns, rows) = (range(|cell| cell.x), range(|cell| cell.y));
    let (west, south) = (columns.start(), rows.start());
    let mut text = format!("shape s{number} at ({west}, {south}) {{\n");
    for z in 1..=*range(|cell| cell.z).end() {
        let _ = writeln!(text, "layer {z} {{");
        for y in rows.clone().rev() {
            let is_full = |x| cells.contains(&Cell::new(x, y, z));
            text.extend(columns.clone().map(|x| if is_full(x) { '#' } else { '.' }));
            text.push('\n');
        }
        text.push_str("}\n");
    }
    text + "}\n"
}

/// Returns a capture as an instance of a pattern in one of eight frames.
fn instance(parent: &str, name: &str, face: Face, frame: usize) -> String {
    let (is_mirrored, quarters) = (frame % 2 == 1, frame / 2 % 4);
    let mapped = |inner: &Face| {
        let is_east_west = matches!(inner, Face::East | Face::West);
        let inner = if is_mirrored && is_east_west {
            inner.opposite()
        } else {
            *inner
        };
        inner.turned(quarters as u8).unwrap_or(inner) == face
    };
    let side = Face::ALL.into_iter().find(mapped).unwrap();
    let side = match side {
        Face::Up => String::new(),
        side => format!(", side = {side}"),
    };
    let mirrored = if is_mirrored { " mirrored" } else { "" };
    format!("grow({parent}, {name}{side}){mirrored} turned {quarters} * 90")
}

/// Returns the program for a list of choices, for blocks that magnetize `faces` faces at a time.
pub fn declare(choices: Vec<u32>, faces: u8) -> Declared {
    declare_with(Reuse::Later, choices, faces)
}

/// Returns such a program with names, cells and faces reused at this time.
pub fn declare_with(reuse: Reuse, choices: Vec<u32>, faces: u8) -> Declared {
    let mut generator = Generator {
        has_parameters: choices.len() % 2 == 1,
        choices: choices.into_iter(),
        blocks: BTreeMap::new(),
        names: 0,
        spare: Vec::new(),
        reuse,
        shapes: String::new(),
        text: format!(
            "scene many from hemisphere {{ block cube {{ side 20cm mass 1kg faces {faces} }} }}\n"
        ),
    };
    if reuse == Reuse::AtOnce {
        let patterns = "pattern grow(p, x, side = up) {
            let back = opposite(side)
            let front = opposite(back)
            p.front -> x
        }
        pattern drop(x) { release x }\n";
        generator.text.push_str(patterns);
    }
    // Half of the programs have parameters.
    let (parameters, edge, places) = if generator.has_parameters {
        let places = ["last - 2, 0", "last, 0", "edge / 2, last / 2"];
        ("(edge = 3, last = edge - 1)", "edge", places)
    } else {
        ("", "3", ["0, 0", "2, 0", "1, 1"])
    };
    let _ = writeln!(generator.text, "assembly random{parameters} in many {{");
    let _ = writeln!(generator.text, "    seed plate {edge} x {edge} {{");
    let cells = [Cell::new(0, 0, 0), Cell::new(2, 0, 0), Cell::new(1, 1, 0)];
    for ((name, place), cell) in ["A", "B", "C"].into_iter().zip(places).zip(cells) {
        let _ = writeln!(generator.text, "        {name} at ({place})");
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
    let phases = generator.choose(4);
    for number in 0..=phases {
        generator.phase(number);
    }
    generator.claims(phases);
    generator.text.push_str("}\n");
    generator.text.push_str(&generator.shapes);
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
    /// Returns the same program in one of the enclosures. All are large enough for every program.
    #[allow(dead_code, reason = "not all test programs have enclosures")]
    pub fn in_enclosure(mut self, number: u64) -> Declared {
        let enclosure = [
            "",
            "enclosure box { length 21m  width 20m  height 19m  wall 250 N/m }",
            "enclosure cylinder { radius 15m  height 19m  wall 250 N/m }",
        ][number as usize % 3];
        let head = "scene many from hemisphere {";
        self.text = self.text.replacen(head, &format!("{head} {enclosure}"), 1);
        self
    }

    /// Returns the event tables.
    ///
    /// # Panics
    /// Panics if the compiler reports an error.
    pub fn tables(&self) -> Tables {
        // Random programs may enclose cells. Their tables are still valid in a world without walls.
        let program = self.program();
        program.tables.or(program.stuck).unwrap()
    }

    /// Returns the compiled program.
    ///
    /// # Panics
    /// Panics if the compiler reports an error.
    pub fn program(&self) -> Program {
        let mut reader = |_: &str| Ok(self.text.clone().into_bytes());
        let mut checked = stochc_compiler::check("random.sa", &mut reader, Default::default());
        let errors: Vec<_> = (checked.diagnostics.iter())
            .filter(|diagnostic| diagnostic.is_error() && diagnostic.code != Code::SealedCavity)
            .collect();
        assert!(errors.is_empty(), "{}\n{errors:#?}", self.text);
        checked.programs.remove(0)
    }
}
