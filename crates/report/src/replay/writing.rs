//! Assembly of the replay page.
use std::io;
use std::io::{Read, Write};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use stochc_text::escaped;

use super::{colours, text};
use crate::template::{fill, policy};

/// Byte sequence near the start of every replay page.
pub const MARK: &str = "<meta name=\"generator\" content=\"stochc replay\">";

const PAGE: &str = include_str!("page/page.html");

const STYLE: &str = include_str!("page/style.css");

/// Parts of the page's script, in the order of execution. Each part uses only earlier parts.
const SCRIPT: &[&str] = &[
    include_str!("page/failure.js"),
    include_str!("page/maths.js"),
    include_str!("page/recording.js"),
    include_str!("page/groups.js"),
    include_str!("page/history.js"),
    include_str!("page/theme.js"),
    include_str!("page/camera.js"),
    include_str!("page/shapes.js"),
    include_str!("page/shell.js"),
    include_str!("page/shaders.js"),
    include_str!("page/painter.js"),
    include_str!("page/sheet.js"),
    include_str!("page/axes.js"),
    include_str!("page/arrows.js"),
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

/// Writes the replay page of a recording. `about` is the result of [`about()`](super::about()).
/// `against` is the recording of another run of the same program, for comparison.
///
/// # Errors
///
/// Errors of `recording` and `out`.
pub fn write(
    title: &str,
    about: &serde_json::Value,
    mut recording: impl Read,
    mut against: Option<impl Read>,
    mut out: impl Write,
) -> io::Result<()> {
    let script = script();
    let policy = policy(&script);
    let about = text::json(about);
    let title = escaped(title);
    fill(PAGE, &mut out, |name, out| match name {
        "POLICY" => out.write_all(policy.as_bytes()),
        "TITLE" => out.write_all(title.as_bytes()),
        "STYLE" => write!(out, "{}{STYLE}", colours::style()),
        "SCRIPT" => out.write_all(script.as_bytes()),
        "ABOUT" => out.write_all(about.as_bytes()),
        "AGAINST" => match &mut against {
            Some(against) => encode(against, out),
            None => Ok(()),
        },
        _ => encode(&mut recording, out),
    })?;
    out.flush()
}

pub(super) fn script() -> String {
    format!("\"use strict\";\n{}{}", colours::script(), SCRIPT.concat())
}

/// Copies a stream as base64. Encodes parts with a multiple of three bytes, so that they can be
/// concatenated.
fn encode(from: &mut impl Read, out: &mut impl Write) -> io::Result<()> {
    const CHUNK: u64 = 3 << 16;
    loop {
        let mut chunk = Vec::new();
        from.take(CHUNK).read_to_end(&mut chunk)?;
        out.write_all(BASE64.encode(&chunk).as_bytes())?;
        if (chunk.len() as u64) < CHUNK {
            return Ok(());
        }
    }
}
