//! The image files that a scene names for its bodies.

use super::tree::{self, Node, Value};
use super::{Action, Diagnostic, DiagnosticKind, Excerpt, Scene, SceneError, diagnostic::Reporter};
use crate::recording::{SceneImage, limits};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

impl Scene {
    /// The names of the images that the inputs of the scene use, each once.
    pub fn image_names(&self) -> std::collections::BTreeSet<String> {
        let blueprints = self.inputs.iter().filter_map(|input| match &input.action {
            Action::Wall(request) | Action::Spawn(request) => Some(&request.blueprint),
            Action::Click { spawn, .. } => spawn.as_ref(),
            Action::Delete { .. } => None,
        });
        blueprints.filter_map(|blueprint| blueprint.paint.image()).map(String::from).collect()
    }

    /// The files of the images that the inputs of the scene use, each once. Their names are relative to `folder`.
    pub fn image_paths(&self, folder: &Path) -> Vec<PathBuf> {
        self.image_names().iter().map(|name| folder.join(name)).collect()
    }

    /// Reads the image files of the scene, whose names are relative to `folder`. Without this, its recording contains
    /// no images, and its boxes are drawn without them.
    ///
    /// # Errors
    /// Returns [`SceneError::Scene`] if there are more than 1,000 images, or with each image that cannot be read, is
    /// too large or is no PNG file.
    pub fn load_images(&mut self, folder: &Path) -> Result<(), SceneError> {
        let names = self.image_names();
        if names.is_empty() {
            return Ok(());
        }
        let root = tree::parse_toml(&self.source.text);
        let mut places = BTreeMap::new();
        if let Ok(root) = &root {
            find_images(root, &mut places);
        }
        let excerpt = || Excerpt { name: self.source.path.clone(), line: 1, text: self.source.text.clone() };
        let reporter = Reporter::default();
        if names.len() > limits::IMAGES {
            let mut spans: Vec<&Range<usize>> = places.values().collect();
            spans.sort_by_key(|span| span.start);
            let span = spans.get(limits::IMAGES).map_or(0..0, |span| (*span).clone());
            let kind = DiagnosticKind::TooMany { what: "image files", limit: limits::IMAGES as u64 };
            let result = Err(reporter.report(Diagnostic::new(kind, span)));
            return reporter.finish(result, excerpt).map_err(SceneError::Scene);
        }
        let (mut images, mut bytes, mut pixels) = (Vec::new(), 0, 0);
        let mut result = Ok(());
        for name in names {
            let read = read_image(&folder.join(&name)).and_then(|(png, [width, height])| {
                bytes += png.len();
                pixels += width * height;
                if bytes > limits::IMAGES_BYTES || pixels > limits::IMAGES_PIXELS {
                    let mebibytes = limits::IMAGES_BYTES >> 20;
                    let pixels = limits::IMAGES_PIXELS;
                    Err(format!("the images of the scene together have more than {mebibytes} MiB or {pixels} pixels"))
                } else {
                    Ok(SceneImage::new(&name, png))
                }
            });
            match read {
                Ok(image) => images.push(image),
                Err(reason) => {
                    let span = places.get(&name).cloned().unwrap_or(0..0);
                    let kind = DiagnosticKind::Image { image: name, reason };
                    result = Err(reporter.report(Diagnostic::new(kind, span)));
                }
            }
        }
        reporter.finish(result, excerpt).map_err(SceneError::Scene)?;
        self.images = images;
        Ok(())
    }
}

/// The place of the first mention of each image.
fn find_images(node: &Node, places: &mut BTreeMap<String, Range<usize>>) {
    match &node.value {
        Value::Table(entries) => {
            for entry in entries {
                match &entry.node.value {
                    Value::Text(name) if entry.key == "image" => {
                        places.entry(name.clone()).or_insert_with(|| entry.node.span.clone());
                    }
                    _ => find_images(&entry.node, places),
                }
            }
        }
        Value::List(nodes) => nodes.iter().for_each(|node| find_images(node, places)),
        _ => {}
    }
}

/// Reads an image file, and its width and height.
fn read_image(path: &Path) -> Result<(Vec<u8>, [u64; 2]), String> {
    let mut png = Vec::new();
    // Opening a named pipe would wait for its writer.
    if !path.metadata().map_err(|error| error.to_string())?.is_file() {
        return Err("it is no regular file".into());
    }
    let file = File::open(path).map_err(|error| error.to_string())?;
    file.take(limits::IMAGE_BYTES as u64 + 1).read_to_end(&mut png).map_err(|error| error.to_string())?;
    if png.len() > limits::IMAGE_BYTES {
        return Err(format!("it has more than {} MiB", limits::IMAGE_BYTES >> 20));
    }
    let [width, height] = png_size(&png).ok_or("it is not a PNG file")?;
    let sides = 1..=u64::from(limits::IMAGE_SIDE);
    if !sides.contains(&width) || !sides.contains(&height) {
        return Err(format!("it has {width} × {height} pixels, but each side must have 1 to {}", limits::IMAGE_SIDE));
    }
    #[cfg(feature = "draw")]
    {
        if crate::picture::apng::is_animated(&png) {
            return Err("it is an animation".into());
        }
        crate::picture::png::decode_bitmap(&png)?;
    }
    Ok((png, [width, height]))
}

/// Width and height of a PNG file, from its header.
fn png_size(file: &[u8]) -> Option<[u64; 2]> {
    let header = file.strip_prefix(b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR")?;
    let side = |at: usize| Some(u64::from(u32::from_be_bytes(header.get(at..at + 4)?.try_into().ok()?)));
    Some([side(0)?, side(4)?])
}
