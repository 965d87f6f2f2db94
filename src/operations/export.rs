//! Export of the trajectories of a run to other applications.
use std::path::Path;

use stochc_files::atomic::{Draft, Replaces, ends_with, holds};
use stochc_report::export::{GLTF_MARK, Gltf, TRAJECTORIES_MARK, Trajectories};

use super::chosen_run::ChosenRun;
use crate::exit::Failure;
use crate::host::Host;

/// Repeats a run and writes the positions of its blocks at every `every`th tick as a Parquet table.
///
/// # Errors
/// If the repeated run differs from the stored one, or the file cannot be written.
pub fn parquet(
    chosen: &ChosenRun,
    every: u32,
    path: &Path,
    host: &dyn Host,
) -> Result<(), Failure> {
    let (tables, scene) = (chosen.entry().tables(), &chosen.entry().scene);
    let about = [
        ("ensemble", chosen.manifest.identity()),
        ("program", chosen.entry().name.clone()),
        ("run", chosen.run.to_string()),
        ("side_m", scene.block.side.to_string()),
        ("tick_s", scene.tick.to_string()),
    ];
    let file = Draft::new(
        path,
        Replaces::Ours(|file| ends_with(file, TRAJECTORIES_MARK)),
    )
    .map_err(|error| Failure::not_written(path, error))?;
    let mut table = Trajectories::new(file, every, tables, &about)
        .map_err(|error| Failure::not_written(path, error))?;
    chosen.again(&mut table, host)?;
    let file = table
        .finish()
        .map_err(|error| Failure::not_written(path, error))?;
    file.keep()
        .map_err(|error| Failure::not_written(path, error))
}

/// Repeats a run and writes it as a glTF animation.
///
/// # Errors
/// See [`parquet`].
pub fn gltf(chosen: &ChosenRun, every: u32, path: &Path, host: &dyn Host) -> Result<(), Failure> {
    let (tables, scene) = (chosen.entry().tables(), &chosen.entry().scene);
    // Open the file first, so that errors appear before a long run.
    let file = Draft::new(path, Replaces::Ours(|file| holds(file, GLTF_MARK)));
    let mut file = file.map_err(|error| Failure::not_written(path, error))?;
    let mut gltf = Gltf::new(every, scene.free.count, tables);
    chosen.again(&mut gltf, host)?;
    let title = format!("{}, run {}", tables.assembly, chosen.run);
    gltf.write(tables, scene, &title, &mut file)
        .map_err(|error| Failure::not_written(path, error))?;
    file.keep()
        .map_err(|error| Failure::not_written(path, error))
}
