//! Targets as voxels: a model of MagicaVoxel, or layers of plain text.
use stochc_ir::Cell;
use thiserror::Error;

use crate::limits::MOST_CELLS;

/// Why a file holds no target.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{0}")]
pub struct UnreadableVoxels(String);

fn unreadable(what: impl Into<String>) -> UnreadableVoxels {
    UnreadableVoxels(what.into())
}

/// The cells of a model of MagicaVoxel (`.vox`), its lowest voxels resting on the plate, its western and southern ones at 0.
///
/// # Errors
/// If it is no such file, is cut off, or holds several models, whose places relative to each other are not read.
pub fn magica_voxel(bytes: &[u8]) -> Result<Vec<Cell>, UnreadableVoxels> {
    let rest = bytes
        .strip_prefix(b"VOX ")
        .ok_or_else(|| unreadable("it does not begin as a `.vox` file does"))?;
    // The version says nothing of what is read here.
    let rest = rest.get(4..).ok_or_else(cut_off)?;
    let (name, own, children, _) = chunk(rest)?;
    if name != b"MAIN" || !own.is_empty() {
        return Err(unreadable("it does not begin with the chunk `MAIN`"));
    }
    let mut models = Vec::new();
    let mut left = children;
    while !left.is_empty() {
        let (name, own, _, rest) = chunk(left)?;
        if name == b"XYZI" {
            models.push(own);
        }
        left = rest;
    }
    let [model] = models[..] else {
        return Err(match models.len() {
            0 => unreadable("it holds no model"),
            several => unreadable(format!(
                "it holds {several} models, and one is needed: join them into one in the editor"
            )),
        });
    };
    let (count, voxels) = number(model)?;
    let voxels = (count as usize)
        .checked_mul(4)
        .and_then(|length| voxels.get(..length));
    let voxels = voxels.ok_or_else(cut_off)?.chunks_exact(4);
    let cells = voxels.map(|voxel| Cell::new(voxel[0].into(), voxel[1].into(), voxel[2].into()));
    Ok(at_the_plate(cells.collect()))
}

fn cut_off() -> UnreadableVoxels {
    unreadable("it is cut off")
}

/// A number of 32 bits, and what is behind it.
fn number(bytes: &[u8]) -> Result<(u32, &[u8]), UnreadableVoxels> {
    let (number, rest) = bytes.split_first_chunk::<4>().ok_or_else(cut_off)?;
    Ok((u32::from_le_bytes(*number), rest))
}

/// A name, its own content, that of its children, and what is behind.
type VoxChunk<'a> = (&'a [u8], &'a [u8], &'a [u8], &'a [u8]);

fn chunk(bytes: &[u8]) -> Result<VoxChunk<'_>, UnreadableVoxels> {
    let (name, rest) = bytes.split_at_checked(4).ok_or_else(cut_off)?;
    let (own, rest) = number(rest)?;
    let (children, rest) = number(rest)?;
    let (own, rest) = rest.split_at_checked(own as usize).ok_or_else(cut_off)?;
    let (children, rest) = rest
        .split_at_checked(children as usize)
        .ok_or_else(cut_off)?;
    Ok((name, own, children, rest))
}

/// Cells drawn as text: a line is a row from west to east with `#` for a block and `.` for none, the northmost first; layers, the
/// lowest first, have an empty line between them. Lines that begin with `//` are comments.
///
/// # Errors
/// If something else stands there.
pub fn layers(text: &str) -> Result<Vec<Cell>, UnreadableVoxels> {
    let mut layers: Vec<Vec<Vec<bool>>> = Vec::new();
    let mut is_new = true;
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.starts_with("//") {
            continue;
        }
        if line.is_empty() {
            is_new = true;
            continue;
        }
        let signs = line.chars().filter(|sign| !sign.is_whitespace());
        let row: Option<Vec<bool>> = signs
            .map(|sign| match sign {
                '#' => Some(true),
                '.' => Some(false),
                _ => None,
            })
            .collect();
        let row = row.ok_or_else(|| {
            let line = i + 1;
            unreadable(format!(
                "line {line}: a row has `#` for a block and `.` for none"
            ))
        })?;
        if is_new {
            layers.push(Vec::new());
            is_new = false;
        }
        layers.last_mut().expect("one has begun").push(row);
    }
    let mut cells = Vec::new();
    for (z, rows) in layers.iter().enumerate() {
        for (y, row) in rows.iter().rev().enumerate() {
            let full = row.iter().enumerate().filter(|(_, is_full)| **is_full);
            cells.extend(full.map(|(x, _)| Cell::new(x as i32, y as i32, z as i32)));
            if cells.len() > MOST_CELLS {
                return Err(unreadable(format!(
                    "a target has at most {MOST_CELLS} cells"
                )));
            }
        }
    }
    Ok(at_the_plate(cells))
}

/// The same, moved: the least x and y are 0, and the least z is 1.
fn at_the_plate(mut cells: Vec<Cell>) -> Vec<Cell> {
    let least = |axis: fn(&Cell) -> i32| cells.iter().map(axis).min().unwrap_or(0);
    let (x, y, z) = (
        least(|cell| cell.x),
        least(|cell| cell.y),
        least(|cell| cell.z),
    );
    for cell in &mut cells {
        *cell = Cell::new(cell.x - x, cell.y - y, cell.z - z + 1);
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A file with these models.
    fn vox(models: &[&[[u8; 4]]]) -> Vec<u8> {
        let chunk = |name: &[u8], own: &[u8], children: &[u8]| {
            let lengths = [own, children].map(|part| (part.len() as u32).to_le_bytes());
            [name, &lengths.concat(), own, children].concat()
        };
        let mut children = Vec::new();
        for voxels in models {
            children.extend(chunk(b"SIZE", &[0; 12], &[]));
            let count = (voxels.len() as u32).to_le_bytes();
            children.extend(chunk(
                b"XYZI",
                &[&count[..], &voxels.concat()].concat(),
                &[],
            ));
        }
        [
            &b"VOX "[..],
            &150u32.to_le_bytes(),
            &chunk(b"MAIN", &[], &children),
        ]
        .concat()
    }

    #[test]
    fn a_model_is_put_on_the_plate() {
        let file = vox(&[&[[3, 4, 5, 1], [4, 4, 6, 9]]]);
        let cells = magica_voxel(&file).unwrap();
        assert_eq!(cells, [Cell::new(0, 0, 1), Cell::new(1, 0, 2)]);
        for length in 0..file.len() {
            assert!(magica_voxel(&file[..length]).is_err(), "{length}");
        }
        let error = magica_voxel(&vox(&[&[[0; 4]], &[[0; 4]]])).unwrap_err();
        assert!(error.to_string().contains("2 models"), "{error}");
    }

    #[test]
    fn layers_are_drawn() {
        let cells = layers("// feet\n# .\n. #\n\n# #\n").unwrap();
        let expected = [(1, 0, 1), (0, 1, 1), (0, 0, 2), (1, 0, 2)];
        assert_eq!(cells, expected.map(|(x, y, z)| Cell::new(x, y, z)));
        let error = layers("#\n#x\n").unwrap_err().to_string();
        assert!(error.starts_with("line 2"), "{error}");
    }

    proptest! {
        #[test]
        fn any_bytes_are_answered(mut file in Just(vox(&[&[[1, 2, 3, 4]; 3]])), place in 0usize..80, byte in any::<u8>()) {
            let place = place % file.len();
            file[place] = byte;
            let _ = magica_voxel(&file);
            let _ = layers(&String::from_utf8_lossy(&file));
        }
    }
}
