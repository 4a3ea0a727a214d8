//! The decoded content of files as bytes, which does not depend on compression.

use rebond::internals::recording::{Playback, Recording};
use std::{io::Cursor, path::Path};

/// Decodes a file: pixels with offsets and delays, or states. Other files are returned unchanged.
pub fn decode(path: &Path, bytes: &[u8]) -> Vec<u8> {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("png" | "apng") => png(bytes),
        Some("gif") => gif(bytes),
        Some("mcap") => states(bytes),
        None | Some(_) => bytes.to_vec(),
    }
}

fn png(bytes: &[u8]) -> Vec<u8> {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().expect("a PNG file");
    let count = reader.info().animation_control.map_or(1, |control| control.num_frames);
    let mut pixels = vec![0; reader.output_buffer_size().expect("a small picture")];
    let mut content = Vec::new();
    for _ in 0..count {
        let frame = reader.next_frame(&mut pixels).expect("a frame");
        content.extend([frame.width, frame.height].map(u32::to_le_bytes).as_flattened());
        if let Some(control) = reader.info().frame_control() {
            content.extend([control.x_offset, control.y_offset].map(u32::to_le_bytes).as_flattened());
            content.extend([control.delay_num, control.delay_den].map(u16::to_le_bytes).as_flattened());
        }
        content.extend(&pixels[..frame.buffer_size()]);
    }
    content
}

fn gif(bytes: &[u8]) -> Vec<u8> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).expect("a GIF file");
    let mut content = Vec::new();
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        let layout = [frame.left, frame.top, frame.width, frame.height, frame.delay];
        content.extend(layout.map(u16::to_le_bytes).as_flattened());
        content.extend(&*frame.buffer);
    }
    content
}

/// All values of all states, and the identity, which depends on all other content.
fn states(bytes: &[u8]) -> Vec<u8> {
    let mut playback = Playback::new(Recording::read(Cursor::new(bytes)).expect("a recording"));
    let mut content = Vec::new();
    for frame in playback.by_ref() {
        let frame = frame.expect("a state");
        content.extend(frame.step.to_le_bytes());
        for body in &frame.bodies {
            let numbers = [body.position.x, body.position.y, body.velocity.x, body.velocity.y];
            content.extend(body.info.id.to_le_bytes());
            content.extend(numbers.map(f64::to_le_bytes).as_flattened());
        }
    }
    content.extend(playback.trailer().map_or(0, |end| end.identity.0).to_le_bytes());
    content
}
