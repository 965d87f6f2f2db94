//! Functions that the page provides.
use std::sync::Once;

#[link(wasm_import_module = "host")]
unsafe extern "C" {
    /// Receives JSON, and the positions of all blocks at several frames: seven numbers per block.
    /// Returns the new number of ticks between two frames.
    safe fn frames(text: *const u8, length: usize, places: *const f32, count: usize) -> u32;
    /// Receives the message of a panic.
    safe fn panicked(text: *const u8, length: usize);
}

/// Sends events and frames of a run to the page. Returns the new number of ticks between two
/// frames.
pub fn send(text: &str, places: &[f32]) -> u32 {
    frames(text.as_ptr(), text.len(), places.as_ptr(), places.len())
}

/// Sends the message of each panic to the page, before the panic ends this instance.
pub fn report_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        std::panic::set_hook(Box::new(|panic| {
            let text = panic.to_string();
            panicked(text.as_ptr(), text.len());
        }));
    });
}
