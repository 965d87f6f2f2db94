//! The page that plays a recording: one file of HTML that needs nothing else.
//!
//! `page/` holds its parts. The recording goes into it as it is, and is unpacked piece by piece
//! while the page plays.
mod about;
mod colours;
mod program_text;
mod text;
mod tour;

use std::io::{self, Read, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use sha2::{Digest as _, Sha256};
use stochc_ensemble::text::escaped;

pub use about::about;
pub use program_text::EventLocation;
pub use tour::tour;

/// What every such page begins with, but for a few lines.
pub const MARK: &str = "<meta name=\"generator\" content=\"stochc replay\">";

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");

/// The parts of the script, in an order in which each knows those before it.
const SCRIPT: &[&str] = &[
    include_str!("page/failure.js"),
    include_str!("page/maths.js"),
    include_str!("page/recording.js"),
    include_str!("page/groups.js"),
    include_str!("page/history.js"),
    include_str!("page/theme.js"),
    include_str!("page/camera.js"),
    include_str!("page/shapes.js"),
    include_str!("page/shaders.js"),
    include_str!("page/painter.js"),
    include_str!("page/axes.js"),
    include_str!("page/labels.js"),
    include_str!("page/sight.js"),
    include_str!("page/cloud.js"),
    include_str!("page/target.js"),
    include_str!("page/scene.js"),
    include_str!("page/overview.js"),
    include_str!("page/graph.js"),
    include_str!("page/program.js"),
    include_str!("page/panel.js"),
    include_str!("page/timeline.js"),
    include_str!("page/player.js"),
    include_str!("page/against.js"),
    include_str!("page/tour.js"),
    include_str!("page/link.js"),
    include_str!("page/pictures.js"),
    include_str!("page/save.js"),
    include_str!("page/api.js"),
    include_str!("page/start.js"),
];

/// Writes the page of a recording, of which [`about`] tells the page the rest; `against` is another run of the same program.
///
/// # Errors
/// Those of `recording` and `out`.
pub fn write(
    title: &str,
    about: &serde_json::Value,
    mut recording: impl Read,
    mut against: Option<impl Read>,
    mut out: impl Write,
) -> io::Result<()> {
    let script = format!("\"use strict\";\n{}{}", colours::script(), SCRIPT.concat());
    // Nothing from elsewhere, and no script but this one, whatever slips into the page.
    let hash = BASE64.encode(Sha256::digest(script.as_bytes()));
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{hash}'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
    );
    let about = text::json(about);
    let title = escaped(title);
    let mut rest = PAGE;
    while let Some((before, after)) = rest.split_once('@') {
        out.write_all(before.as_bytes())?;
        let (name, after) = after.split_once('@').unwrap_or((after, ""));
        rest = after;
        match name {
            "POLICY" => out.write_all(policy.as_bytes())?,
            "TITLE" => out.write_all(title.as_bytes())?,
            "STYLE" => write!(out, "{}{STYLE}", colours::style())?,
            "SCRIPT" => out.write_all(script.as_bytes())?,
            "ABOUT" => out.write_all(about.as_bytes())?,
            "AGAINST" => {
                if let Some(against) = &mut against {
                    encode(against, &mut out)?;
                }
            }
            _ => encode(&mut recording, &mut out)?,
        }
    }
    out.write_all(rest.as_bytes())?;
    out.flush()
}

/// Copies in base64, in pieces of whole groups of three bytes.
fn encode(from: &mut impl Read, out: &mut impl Write) -> io::Result<()> {
    const PIECE: u64 = 3 << 16;
    loop {
        let mut piece = Vec::new();
        from.take(PIECE).read_to_end(&mut piece)?;
        out.write_all(BASE64.encode(&piece).as_bytes())?;
        if (piece.len() as u64) < PIECE {
            return Ok(());
        }
    }
}
