//! Export of a run as an animated scene in glTF.
use std::collections::BTreeMap;
use std::io::{self, Write};

use serde_json::{Value, json};
use stochc_ir::scene::Scene;
use stochc_ir::table::{PhaseId, Tables};
use stochc_ir::{Cell, Face};
use stochc_runtime::observe::{ObservedEvent, Observer};
use stochc_runtime::world::SpatialWorld;
use stochc_text::palette::{DARK, PHASES, Rgb};

/// Largest size of the file \[bytes\]. The format stores lengths in 32 bits.
const LARGEST: u64 = 0xFFFF_0000;

/// Returns the colours of the phases, then the colours of free blocks, of named seeds and of the
/// plate.
fn colours() -> impl Iterator<Item = Rgb> {
    PHASES.into_iter().chain([DARK.free, DARK.seed, DARK.plate])
}

// Constants of the format: <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>.
const FLOAT: u32 = 5126;
const SHORT: u32 = 5122;
const UNSIGNED_SHORT: u32 = 5123;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// Byte sequence that every exported glTF file contains.
pub const GLTF_MARK: &[u8] = b"\"generator\":\"stochc ";

/// Error of exporting glTF.
#[derive(Debug, thiserror::Error)]
pub enum GltfError {
    /// The animation exceeds the length fields of the format.
    #[error("the animation is larger than a glTF file can be; show fewer ticks with `--every`")]
    TooLarge,
    /// The file cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// Collects the positions of all blocks for a binary glTF 2.0 file (`.glb`).
///
/// Each block is a node with an animation of translation and rotation. There is a keyframe at every
/// nth tick, and at every tick that changes the structure. Lengths are in metres, times in seconds,
/// y is up. A block has the colour of the phase that captures it first.
pub struct Gltf {
    every: u64,
    ticks: Vec<u64>,
    /// Positions of each block: three numbers per keyframe.
    translations: Vec<Vec<f32>>,
    /// Rotations of each block: four numbers per keyframe.
    rotations: Vec<Vec<i16>>,
    phase: PhaseId,
    /// Final role of each block, and the phase of its first capture.
    roles: BTreeMap<u32, (String, PhaseId)>,
    names: Vec<String>,
    is_too_large: bool,
}

impl Gltf {
    /// Creates an empty animation of `bodies` free blocks, with a keyframe at every `every`th tick.
    pub fn new(every: u32, bodies: u32, tables: &Tables) -> Gltf {
        Gltf {
            every: every.max(1).into(),
            ticks: Vec::new(),
            translations: vec![Vec::new(); bodies as usize],
            rotations: vec![Vec::new(); bodies as usize],
            phase: PhaseId(0),
            roles: BTreeMap::new(),
            names: tables.roles.iter().map(|role| role.name.clone()).collect(),
            is_too_large: false,
        }
    }

    /// Writes the glTF file.
    ///
    /// # Errors
    ///
    /// [`GltfError::TooLarge`], and errors of `out`.
    pub fn write(
        &self,
        tables: &Tables,
        scene: &Scene,
        title: &str,
        mut out: impl Write,
    ) -> Result<(), GltfError> {
        if self.is_too_large {
            return Err(GltfError::TooLarge);
        }
        let mut file = BinaryBuffer::default();
        let meshes = cubes(&mut file);
        let mut nodes = Vec::new();
        for (name, cell, material) in plate(tables) {
            let [x, y, z] = centre(cell, tables);
            nodes
                .push(json!({ "name": name, "mesh": meshes + material, "translation": [x, y, z] }));
        }
        let seconds: Vec<f32> = (self.ticks.iter())
            .map(|&tick| (tick as f64 * scene.tick) as f32)
            .collect();
        let (first, last) = (seconds.first().copied(), seconds.last().copied());
        let bytes: Vec<u8> = seconds
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        let input = file.accessor(&bytes, None, json!({
            "componentType": FLOAT, "count": seconds.len(), "type": "SCALAR", "min": [first], "max": [last],
        }));
        let (mut channels, mut samplers) = (Vec::new(), Vec::new());
        for (body, (translations, rotations)) in
            self.translations.iter().zip(&self.rotations).enumerate()
        {
            let (name, material) = match self.roles.get(&(body as u32)) {
                Some((role, phase)) => (
                    format!("block {body}, {role}"),
                    phase.0 as usize % PHASES.len(),
                ),
                None => (format!("block {body}"), PHASES.len()),
            };
            let node = nodes.len();
            nodes.push(json!({
                "name": name,
                "mesh": meshes + material,
                "translation": translations.first_chunk::<3>(),
            }));
            let bytes: Vec<u8> = translations
                .iter()
                .flat_map(|number| number.to_le_bytes())
                .collect();
            let count = seconds.len();
            let translation = file.accessor(
                &bytes,
                None,
                json!({ "componentType": FLOAT, "count": count, "type": "VEC3" }),
            );
            let bytes: Vec<u8> = rotations
                .iter()
                .flat_map(|number| number.to_le_bytes())
                .collect();
            let turns = file.accessor(
                &bytes,
                None,
                json!({
                    "componentType": SHORT, "normalized": true, "count": count, "type": "VEC4",
                }),
            );
            for (path, output) in [("translation", translation), ("rotation", turns)] {
                channels.push(
                    json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }),
                );
                samplers
                    .push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
            }
        }
        // In the structure, z is up and the unit is the block length. In glTF, y is up and the unit
        // is the metre.
        let half = 0.5f64.sqrt();
        let side = scene.block.side;
        let children: Vec<usize> = (0..nodes.len()).collect();
        let root = nodes.len();
        nodes.push(json!({
            "name": title, "rotation": [-half, 0.0, 0.0, half], "scale": [side, side, side], "children": children,
        }));
        let mut gltf = json!({
            "asset": { "version": "2.0", "generator": concat!("stochc ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "name": scene.name, "nodes": [root] }],
            "nodes": nodes,
            "meshes": (0..colours().count()).map(mesh).collect::<Vec<_>>(),
            "materials": colours().map(|colour| json!({
                "pbrMetallicRoughness": { "baseColorFactor": factor(colour), "metallicFactor": 0.0, "roughnessFactor": 0.8 },
            })).collect::<Vec<_>>(),
        });
        if !channels.is_empty() {
            gltf["animations"] =
                json!([{ "name": title, "channels": channels, "samplers": samplers }]);
        }
        file.write(gltf, &mut out)
    }
}

impl Observer for Gltf {
    fn look(&mut self, arena: &impl SpatialWorld, events: &[ObservedEvent]) {
        let mut is_notable = false;
        for event in events {
            match *event {
                ObservedEvent::Phase(phase) => self.phase = phase,
                ObservedEvent::Captured { body, role, .. } => {
                    let (name, phase) = (self.names[role.0 as usize].clone(), self.phase);
                    let entry = self.roles.entry(body).or_insert((String::new(), phase));
                    entry.0 = name;
                    is_notable = true;
                }
                ObservedEvent::Released { .. } => is_notable = true,
                _ => {}
            }
        }
        let tick = arena.tick();
        if self.is_too_large || !(is_notable || tick.is_multiple_of(self.every)) {
            return;
        }
        self.ticks.push(tick);
        // Per keyframe, a block has twelve bytes for its translation and eight for its rotation.
        let bytes = self.ticks.len() as u64 * (20 * self.translations.len() as u64 + 4);
        self.is_too_large = bytes > LARGEST;
        for (id, (translations, rotations)) in
            (0..).zip(self.translations.iter_mut().zip(&mut self.rotations))
        {
            let state = arena.state(id);
            translations.extend(state.position.iter().map(|&number| number as f32));
            let q = state.orientation.coords;
            rotations.extend(q.iter().map(|&part| (part * 32767.0).round() as i16));
        }
    }
}

/// Returns the blocks of the plate: name, cell and colour.
fn plate(tables: &Tables) -> Vec<(String, Cell, usize)> {
    let named: BTreeMap<Cell, &str> = (tables.seeds())
        .map(|(role, cell)| (cell, tables.name(role)))
        .collect();
    let across = |n: u32| 0..i32::try_from(n).unwrap_or(i32::MAX);
    let mut blocks = Vec::new();
    for y in across(tables.plate.depth) {
        for x in across(tables.plate.width) {
            let cell = Cell::new(x, y, 0);
            blocks.push(match named.get(&cell) {
                Some(name) => ((*name).to_owned(), cell, PHASES.len() + 1),
                None => (format!("plate ({x}, {y})"), cell, PHASES.len() + 2),
            });
        }
    }
    blocks
}

/// Returns the centre of a cell, relative to the centre of the plate's upper side \[block
/// lengths\].
fn centre(cell: Cell, tables: &Tables) -> [f64; 3] {
    let across = |n: i32, blocks: u32| f64::from(n) - (f64::from(blocks) - 1.0) / 2.0;
    [
        across(cell.x, tables.plate.width),
        across(cell.y, tables.plate.depth),
        f64::from(cell.z) - 0.5,
    ]
}

/// Adds a cube of side 1. The first three accessors are its corners, normals and triangles.
fn cubes(file: &mut BinaryBuffer) -> usize {
    let (mut corners, mut normals, mut indices) = (Vec::new(), Vec::new(), Vec::new());
    for (number, face) in (0u16..).zip(Face::ALL) {
        let n = face.normal().map(|x| x as f32);
        // Two directions in the face, with u x v = n.
        let u = [n[1], n[2], n[0]];
        let v = [
            n[1] * u[2] - n[2] * u[1],
            n[2] * u[0] - n[0] * u[2],
            n[0] * u[1] - n[1] * u[0],
        ];
        for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            corners.extend((0..3).map(|i| 0.5 * (n[i] + a * u[i] + b * v[i])));
            normals.extend(n);
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|corner| 4 * number + corner));
    }
    let bytes =
        |numbers: &[f32]| -> Vec<u8> { numbers.iter().flat_map(|x| x.to_le_bytes()).collect() };
    file.accessor(&bytes(&corners), Some(VERTICES), json!({
        "componentType": FLOAT, "count": 24, "type": "VEC3", "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5],
    }));
    file.accessor(
        &bytes(&normals),
        Some(VERTICES),
        json!({ "componentType": FLOAT, "count": 24, "type": "VEC3" }),
    );
    let bytes: Vec<u8> = indices.iter().flat_map(|x: &u16| x.to_le_bytes()).collect();
    file.accessor(
        &bytes,
        Some(INDICES),
        json!({ "componentType": UNSIGNED_SHORT, "count": 36, "type": "SCALAR" }),
    );
    0
}

/// Returns an opaque colour as linear light, for a glTF material.
fn factor(colour: Rgb) -> Vec<f64> {
    let light = colour.linear().map(|part| (100.0 * part).round() / 100.0);
    light.into_iter().chain([1.0]).collect()
}

/// Returns the mesh of the cube with one of the materials.
fn mesh(material: usize) -> Value {
    json!({ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 }, "indices": 2, "material": material }] })
}

/// Binary part of a glTF file, with its buffer views and accessors.
#[derive(Default)]
struct BinaryBuffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl BinaryBuffer {
    /// Adds numbers and the `accessor` that describes them. Returns the index of the accessor.
    fn accessor(&mut self, bytes: &[u8], target: Option<u32>, mut accessor: Value) -> usize {
        let mut view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(view);
        self.accessors.push(accessor);
        self.bytes.extend(bytes);
        // Numbers must be aligned to a multiple of their size.
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.accessors.len() - 1
    }

    fn write(self, mut gltf: Value, out: &mut impl Write) -> Result<(), GltfError> {
        gltf["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        gltf["bufferViews"] = json!(self.views);
        gltf["accessors"] = json!(self.accessors);
        let mut text = gltf.to_string();
        while !text.len().is_multiple_of(4) {
            text.push(' ');
        }
        let length = |bytes: usize| u32::try_from(bytes).map_err(|_| GltfError::TooLarge);
        let total = length(12 + 8 + text.len() + 8 + self.bytes.len())?;
        out.write_all(b"glTF")?;
        for number in [2, total, length(text.len())?] {
            out.write_all(&number.to_le_bytes())?;
        }
        out.write_all(b"JSON")?;
        out.write_all(text.as_bytes())?;
        out.write_all(&length(self.bytes.len())?.to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        out.write_all(&self.bytes)?;
        Ok(out.flush()?)
    }
}
