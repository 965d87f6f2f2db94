//! Layers drawn as text.
use stochc_ir::Cell;

use super::{UnreadableVoxels, at_the_plate};
use crate::target::limits::MAX_CELLS;

/// Reads cells drawn as text.
///
/// A line is a row from west to east, with `#` for a block and `.` for none. The northmost row
/// comes first. Layers are separated by empty lines, the lowest first. Lines that begin with `//`
/// are comments. Lines end with a line feed, a carriage return, or both.
///
/// # Errors
///
/// If a row has another character, or there are too many cells.
pub fn layers(text: &str) -> Result<Vec<Cell>, UnreadableVoxels> {
    let mut layers: Vec<Vec<Vec<bool>>> = Vec::new();
    let mut is_new = true;
    for (i, line) in lines(text).enumerate() {
        let line = line.trim_matches(is_space);
        if line.starts_with("//") {
            continue;
        }
        if line.is_empty() {
            is_new = true;
            continue;
        }
        if is_new {
            layers.push(Vec::new());
            is_new = false;
        }
        let row = row(line, i + 1)?;
        layers.last_mut().expect("a layer has begun").push(row);
    }
    let mut cells = Vec::new();
    for (z, rows) in layers.iter().enumerate() {
        for (y, row) in rows.iter().rev().enumerate() {
            let full = row.iter().enumerate().filter(|(_, is_full)| **is_full);
            cells.extend(full.map(|(x, _)| Cell::new(x as i32, y as i32, z as i32)));
            if cells.len() > MAX_CELLS {
                return Err(UnreadableVoxels::TooLarge);
            }
        }
    }
    Ok(at_the_plate(cells))
}

/// Splits a text at the line ends of all systems. Carriage returns before a line feed belong to it.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.split('\n').map(|line| line.trim_end_matches('\r'));
    lines.flat_map(|line| line.split('\r'))
}

/// Returns whether a character may separate those of a row. Characters that end a line or page may
/// not.
fn is_space(character: char) -> bool {
    let ends_line = matches!(
        character,
        '\u{b}' | '\u{c}' | '\u{85}' | '\u{2028}' | '\u{2029}'
    );
    character.is_whitespace() && !ends_line
}

fn row(line: &str, number: usize) -> Result<Vec<bool>, UnreadableVoxels> {
    let characters = line.chars().filter(|character| !is_space(*character));
    let is_full = |character| match character {
        '#' => Ok(true),
        '.' => Ok(false),
        character => Err(UnreadableVoxels::Character {
            line: number,
            character,
        }),
    };
    characters.map(is_full).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(places: &[(i32, i32, i32)]) -> Vec<Cell> {
        let cells = places.iter().map(|&(x, y, z)| Cell::new(x, y, z));
        cells.collect()
    }

    #[test]
    fn layers_are_drawn() {
        let drawn = layers("// feet\n# .\n. #\n\n# #\n").unwrap();
        let expected = [(1, 0, 1), (0, 1, 1), (0, 0, 2), (1, 0, 2)];
        assert_eq!(drawn, cells(&expected));
        let error = layers("#\n#x\n").unwrap_err().to_string();
        assert!(error.starts_with("line 2"), "{error}");
    }

    #[test]
    fn every_system_ends_lines_its_own_way() {
        let drawn = layers("##\n.#\n\n#.\n").unwrap();
        assert_eq!(drawn.len(), 4);
        for end in ["\r", "\r\n", "\r\r\n"] {
            let text = ["##", ".#", "", "#.", ""].join(end);
            assert_eq!(layers(&text).as_ref(), Ok(&drawn), "{text:?}");
        }
        let error = layers("#\r#\rx").unwrap_err().to_string();
        assert!(error.starts_with("line 3"), "{error}");
        for end in ['\u{b}', '\u{c}', '\u{85}', '\u{2028}', '\u{2029}'] {
            assert!(layers(&format!("#{end}#")).is_err(), "{end:?}");
        }
    }
}
