//! Rapier with its default settings.
use std::error::Error;

use stochc_peers::drive::{arguments, serve};
use stochc_peers::rapier::Rapier;

fn main() -> Result<(), Box<dyn Error>> {
    let (engine, blocks, kick) = arguments()?;
    let mut gas = match engine.as_str() {
        "defaults" => Rapier::defaults(blocks, kick),
        _ => return Err("unknown engine".into()),
    };
    serve(&mut gas, "Rapier")
}
