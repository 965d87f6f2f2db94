//! Firmware of `stochc compile --emit firmware`.
use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use clap::Args;
use stochc_files::atomic::{Replaces, make_folder, replace};
use stochc_firmware::{Image, MARK, Sizes, files};
use stochc_ir::table::Tables;
use stochc_text::number;

use crate::exit::{Exit, Failure};

/// Memory of a block's processor.
#[derive(Debug, Args)]
pub struct MemoryOptions {
    /// Flash memory of a block, such as 16KiB. Firmware that needs more is an error
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    flash: Option<usize>,
    /// RAM of a block without the stack, such as 256B. Firmware that needs more is an error
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    ram: Option<usize>,
}

impl MemoryOptions {
    /// Rejects the options for other stages of the compilation.
    pub fn only_for_firmware(&self, is_firmware_wanted: bool) -> Result<(), Failure> {
        if !is_firmware_wanted && (self.flash.is_some() || self.ram.is_some()) {
            return Err(Failure::usage(
                "`--flash` and `--ram` are for `--emit firmware` only",
            ));
        }
        Ok(())
    }

    /// Checks that the firmware fits into the memory.
    fn check(&self, image: &Image) -> Result<(), Failure> {
        let sizes = &image.sizes;
        let flash = Sizes::INTERPRETER + image.bytes.len();
        if let Some(limit) = self.flash
            && flash > limit
        {
            let largest = sizes.largest.iter();
            let largest: Vec<_> = largest
                .map(|(name, size)| format!("`{name}` ({size})"))
                .collect();
            return Err(Failure::usage(format!(
                "a block needs {} bytes of flash, and `--flash` allows {}. The interpreter takes \
                 {}, and all tables {}. The largest tables: {}",
                number(flash as f64),
                number(limit as f64),
                number(Sizes::INTERPRETER as f64),
                number(image.bytes.len() as f64),
                largest.join(", "),
            )));
        }
        if let Some(limit) = self.ram
            && sizes.ram() > limit
        {
            return Err(Failure::usage(format!(
                "a block needs {} bytes of RAM, and `--ram` allows {}. Waiting notifications take \
                 {}, observations {}, and rules {}. All else is the same for every program",
                number(sizes.ram() as f64),
                number(limit as f64),
                4 * sizes.waiting.max(1),
                sizes.observations.div_ceil(8),
                sizes.rules.div_ceil(8),
            )));
        }
        Ok(())
    }
}

/// Reads a size in bytes or KiB.
fn bytes(text: &str) -> Result<usize, String> {
    let (digits, unit) = match text.strip_suffix("KiB") {
        Some(digits) => (digits, 1024),
        None => (text.strip_suffix('B').unwrap_or(text), 1),
    };
    let count = digits.trim().parse::<u32>().ok();
    let size = count.and_then(|count| (count as usize).checked_mul(unit));
    size.ok_or_else(|| "write a size such as 256B or 16KiB".to_owned())
}

/// Writes the firmware of a program to a folder.
pub fn write(
    tables: &Tables,
    folder: Option<&Path>,
    memory: &MemoryOptions,
) -> Result<Exit, Failure> {
    let folder = folder.ok_or_else(|| {
        Failure::usage("firmware is several files: give a folder with `--out DIR`")
    })?;
    let image = Image::new(tables).map_err(Failure::usage)?;
    memory.check(&image)?;
    make_folder(folder).map_err(|error| Failure::not_written(folder, error))?;
    for (name, text) in files(&image, tables) {
        let path = folder.join(name);
        replace(&path, text.as_bytes(), Replaces::Ours(is_firmware))
            .map_err(|error| Failure::not_written(&path, error))?;
    }
    Ok(Exit::Success)
}

/// Returns whether a file begins as the files of the firmware do.
fn is_firmware(file: &mut File) -> io::Result<bool> {
    /// Number of bytes examined.
    const HEAD: u64 = 32;
    let mut head = Vec::new();
    file.take(HEAD).read_to_end(&mut head)?;
    Ok(String::from_utf8_lossy(&head).contains(MARK))
}
