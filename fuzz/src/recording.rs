//! Reads arbitrary bytes as a recording.
//!
//! The first byte selects the form of the rest. The form is a whole file, or uncompressed parts
//! without checksums. A part has a kind, a length and a content.
use std::io::Write as _;
use std::sync::LazyLock;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use stochc_files::checksum::crc32;
use stochc_ir::table::Tables;
use stochc_results::recording::{Outline, Recording};

static TABLES: LazyLock<Tables> = LazyLock::new(|| super::program().tables);

const HEADER: &str =
    "{\"stochc\":\"\",\"ensemble\":\"\",\"program\":0,\"run\":0,\"every\":1,\"bodies\":4}";

/// Uncompressed size of a part with positions, excluding four bytes per tick \[bytes\].
const FIXED: usize = 48;

fn sealed(part: &[u8]) -> Vec<u8> {
    [part, &crc32(part).to_le_bytes()].concat()
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).expect("memory takes everything");
    encoder.finish().expect("memory takes everything")
}

fn whole(mut bytes: &[u8]) -> Vec<u8> {
    let length = (HEADER.len() as u32).to_le_bytes();
    let header = [
        b"STOCHREC",
        &1u32.to_le_bytes()[..],
        &length,
        HEADER.as_bytes(),
    ]
    .concat();
    let mut file = sealed(&header);
    while let [kind, low, high, rest @ ..] = bytes {
        let length = usize::from(u16::from_le_bytes([*low, *high])).min(rest.len());
        let (part, behind) = rest.split_at(length);
        bytes = behind;
        let (tag, payload) = match kind % 3 {
            0 => {
                let frames = part.get(8).copied().unwrap_or(0);
                let fixed = (FIXED + 4 * usize::from(frames)).min(part.len());
                let mut payload = part[..fixed].to_vec();
                if let Some(high) = payload.get_mut(9..16) {
                    high.fill(0);
                }
                payload.extend(packed(&part[fixed..]));
                (b"POSE", payload)
            }
            1 => (b"EVNT", packed(part)),
            _ => (b"DONE", packed(part)),
        };
        let length = (payload.len() as u32).to_le_bytes();
        file.extend(sealed(&[&tag[..], &length, &payload].concat()));
    }
    file
}

/// Reads an input as a recording. Panics if the result is wrong.
pub fn read(bytes: &[u8]) {
    let Some((how, bytes)) = bytes.split_first() else {
        return;
    };
    let file = match how % 2 {
        0 => bytes.to_vec(),
        _ => whole(bytes),
    };
    let outline = Outline::read(&file[..], &TABLES);
    let read = Recording::read(&file[..], &TABLES);
    assert_eq!(outline.is_ok(), read.is_ok());
    let Ok(recording) = read else {
        return;
    };
    let end = recording.record().ticks;
    // Displaying the recording must not panic.
    if recording.header().bodies <= 1000 {
        for frame in recording.frames().take(1000) {
            assert!(frame.tick <= end && frame.poses.len() == recording.header().bodies as usize);
        }
    }
    assert!(recording.events().iter().all(|event| event.tick <= end));
}
