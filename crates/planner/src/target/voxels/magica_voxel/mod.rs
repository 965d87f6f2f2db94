//! MagicaVoxel files (`.vox`): models, and the scene graph that places them.
//!
//! The crate `dot_vox` is not used: it recurses over nested chunks, and drops unreadable chunks and
//! node numbers. It also maps colours 0 and 1 to the same value.
mod bytes;
mod graph;
mod placement;
#[cfg(test)]
mod tests;

use stochc_ir::Cell;

use super::{UnreadableVoxels, at_the_plate};
use crate::target::limits::{FARTHEST, MAX_CELLS, MAX_VOXEL_PARTS};
use bytes::Bytes;
use graph::{Instance, SceneGraph};
use placement::Placement;

/// Visible content of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VoxelScene {
    /// Cells, the lowest on the plate. Cells of overlapping models may be repeated.
    pub cells: Vec<Cell>,
    /// Numbers of hidden models with voxels.
    pub hidden: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Model<'a> {
    size: [u32; 3],
    /// x, y, z and colour of each voxel.
    voxels: &'a [[u8; 4]],
}

#[derive(Debug, Default)]
struct VoxFile<'a> {
    models: Vec<Model<'a>>,
    graph: SceneGraph<'a>,
}

/// Reads the cells of the visible models in the scene, including copies. With a number, reads only
/// the copies of that model.
///
/// # Errors
///
/// If the file is invalid, has several models without a scene, or is animated.
pub fn magica_voxel(bytes: &[u8], requested: Option<u32>) -> Result<VoxelScene, UnreadableVoxels> {
    let file = VoxFile::read(bytes)?;
    let count = file.models.len();
    if count == 0 {
        return Err(UnreadableVoxels::NoModel);
    }
    if let Some(model) = requested.filter(|model| *model as usize >= count) {
        return Err(UnreadableVoxels::UnknownModel { model, count });
    }
    if file.graph.is_empty() {
        return file.only_model(requested);
    }
    file.scene(requested)
}

impl<'a> VoxFile<'a> {
    fn read(bytes: &'a [u8]) -> Result<VoxFile<'a>, UnreadableVoxels> {
        let rest = bytes.strip_prefix(b"VOX ");
        let mut rest = Bytes(rest.ok_or(UnreadableVoxels::NotVox)?);
        // All versions have the same chunks.
        rest.number()?;
        let main = rest.chunk()?;
        if main.name != b"MAIN" {
            return Err(UnreadableVoxels::NotVox);
        }
        let mut file = VoxFile::default();
        let mut size = None;
        let mut chunks = main.children;
        let mut parts = 0;
        while !chunks.is_empty() {
            let chunk = chunks.chunk()?;
            let content = chunk.content;
            match chunk.name {
                b"SIZE" => size = Some(model_size(content)?),
                b"XYZI" => file.add_model(content, size.take())?,
                b"nTRN" => file.graph.add_transform(content)?,
                b"nGRP" => file.graph.add_group(content)?,
                b"nSHP" => file.graph.add_shape(content)?,
                b"LAYR" => file.graph.add_layer(content)?,
                // Colours, materials, cameras and notes.
                _ => continue,
            }
            parts += 1;
            if parts > MAX_VOXEL_PARTS {
                return Err(UnreadableVoxels::TooManyParts);
            }
        }
        Ok(file)
    }

    fn add_model(
        &mut self,
        mut content: Bytes<'a>,
        size: Option<[u32; 3]>,
    ) -> Result<(), UnreadableVoxels> {
        let model = self.models.len() as u32;
        let size = size.ok_or(UnreadableVoxels::NoSize { model })?;
        let length = (content.number()? as usize).checked_mul(4);
        let voxels = content.take(length.ok_or(UnreadableVoxels::CutOff)?)?;
        let (voxels, _) = voxels.as_chunks();
        self.models.push(Model { size, voxels });
        Ok(())
    }

    /// Returns the cells of a file without a scene, as old versions write it.
    fn only_model(&self, requested: Option<u32>) -> Result<VoxelScene, UnreadableVoxels> {
        let numbers = 0..self.models.len() as u32;
        let sized = numbers.map(|number| (number, self.voxels(number)));
        let full: Vec<(u32, usize)> = sized.filter(|(_, voxels)| *voxels > 0).collect();
        let model = match (requested, &full[..]) {
            (Some(model), _) => model,
            (None, []) => 0,
            (None, [(model, _)]) => *model,
            (None, _) => return Err(UnreadableVoxels::SeveralModels { models: full }),
        };
        let shown = vec![(0, model, Placement::IDENTITY)];
        self.placed(&shown, Vec::new())
    }

    /// Returns the cells that the scene shows.
    fn scene(&self, requested: Option<u32>) -> Result<VoxelScene, UnreadableVoxels> {
        let (mut shown, mut hidden) = (Vec::new(), Vec::new());
        for instance in self.graph.instances()? {
            let Some(model) = self.chosen(&instance, requested)? else {
                continue;
            };
            if !instance.is_hidden {
                shown.push((instance.node, model, instance.placement));
            } else if self.voxels(model) > 0 {
                hidden.push(model);
            }
        }
        match requested {
            Some(model) if shown.is_empty() => Err(UnreadableVoxels::UnplacedModel { model }),
            _ => self.placed(&shown, hidden),
        }
    }

    /// Returns the model to build of an instance: the requested one, or the only one with voxels.
    /// Returns `None` if the instance has no such model.
    fn chosen(
        &self,
        instance: &Instance<'_>,
        requested: Option<u32>,
    ) -> Result<Option<u32>, UnreadableVoxels> {
        let node = instance.node;
        let mut models = instance.models.iter();
        let missing = models.find(|&&model| model as usize >= self.models.len());
        if let Some(&model) = missing {
            return Err(UnreadableVoxels::MissingModel { node, model });
        }
        if let Some(requested) = requested {
            return Ok(Some(requested).filter(|requested| instance.models.contains(requested)));
        }
        let models = instance.models.iter().copied();
        let full: Vec<u32> = models.filter(|model| self.voxels(*model) > 0).collect();
        match full[..] {
            [] => Ok(None),
            [model] => Ok(Some(model)),
            // Any model suffices for the note.
            [model, ..] if instance.is_hidden => Ok(Some(model)),
            _ => Err(UnreadableVoxels::Animation { node, models: full }),
        }
    }

    /// Returns the number of voxels of a model. Voxels of colour 0 are empty.
    fn voxels(&self, model: u32) -> usize {
        let voxels = self.models[model as usize].voxels.iter();
        voxels.filter(|[.., colour]| *colour != 0).count()
    }

    /// Returns the cells of models, each with its shape and its placement.
    fn placed(
        &self,
        shown: &[(u32, u32, Placement)],
        mut hidden: Vec<u32>,
    ) -> Result<VoxelScene, UnreadableVoxels> {
        hidden.sort_unstable();
        hidden.dedup();
        let lengths = shown.iter().map(|&(_, model, _)| model as usize);
        let lengths = lengths.map(|model| self.models[model].voxels.len());
        if lengths.sum::<usize>() > MAX_CELLS {
            return Err(UnreadableVoxels::TooLarge);
        }
        let mut cells = Vec::new();
        for (node, model, placement) in shown {
            let Model { size, voxels } = self.models[*model as usize];
            for &[x, y, z, colour] in voxels {
                if colour != 0 {
                    let cell = cell_of([x, y, z], size, placement);
                    cells.push(cell.ok_or(UnreadableVoxels::TooFar { node: *node })?);
                }
            }
        }
        Ok(VoxelScene {
            cells: at_the_plate(cells),
            hidden,
        })
    }
}

fn model_size(mut content: Bytes<'_>) -> Result<[u32; 3], UnreadableVoxels> {
    Ok([content.number()?, content.number()?, content.number()?])
}

/// Returns the cell of a voxel in a model of this size, or `None` if it is too far from the origin.
///
/// Models rotate about their centre, rounded down to a voxel corner.
fn cell_of(voxel: [u8; 3], size: [u32; 3], placement: &Placement) -> Option<Cell> {
    let centre = |axis: usize| 2 * (i64::from(voxel[axis]) - i64::from(size[axis] / 2)) + 1;
    let centre = placement.apply(std::array::from_fn(centre));
    // Centres are at odd numbers of half voxels.
    let [x, y, z] = centre.map(|at| (at - 1) / 2);
    let coordinate = |at: i64| {
        let at = i32::try_from(at).ok()?;
        (-FARTHEST..=FARTHEST).contains(&at).then_some(at)
    };
    Some(Cell::new(coordinate(x)?, coordinate(y)?, coordinate(z)?))
}
