use super::Picture;

/// The difference of a picture to the previous one: the bounding rectangle of all changed pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameDelta {
    /// The upper-left corner of the rectangle in the picture, px.
    pub at: [u32; 2],
    /// Width and height, px.
    pub size: [u32; 2],
    /// The new pixels row by row; [`UNCHANGED`] where a pixel keeps its value.
    pub pixels: Vec<[u8; 4]>,
}

/// Marks a pixel that does not change. Pixels of pictures are opaque and never have this value.
pub const UNCHANGED: [u8; 4] = [0; 4];

impl FrameDelta {
    /// The difference of `after` to `before`, which has the same size, or all of `after` if there is no
    /// previous picture.
    pub fn between(before: Option<&Picture>, after: &Picture) -> FrameDelta {
        let Some(before) = before else {
            return FrameDelta { at: [0, 0], size: after.size, pixels: after.pixels.clone() };
        };
        let Some(area) = changed_area(before, after) else { return FrameDelta::unchanged() };
        let width = after.size[0] as usize;
        let mut pixels = Vec::with_capacity((area.right - area.left) * (area.bottom - area.top));
        for row in area.top..area.bottom {
            let span = row * width + area.left..row * width + area.right;
            let both = before.pixels[span.clone()].iter().zip(&after.pixels[span]);
            pixels.extend(both.map(|(before, after)| if before == after { UNCHANGED } else { *after }));
        }
        let at = [area.left, area.top].map(|at| at as u32);
        let size = [area.right - area.left, area.bottom - area.top].map(|side| side as u32);
        FrameDelta { at, size, pixels }
    }

    /// One unchanged pixel, because every frame of an animation needs an image.
    fn unchanged() -> FrameDelta {
        FrameDelta { at: [0, 0], size: [1, 1], pixels: vec![UNCHANGED] }
    }
}

/// A rectangle of pixels; `right` and `bottom` are exclusive.
struct Area {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

/// The bounding rectangle of all differing pixels.
fn changed_area(before: &Picture, after: &Picture) -> Option<Area> {
    let mut changed: Option<Area> = None;
    for (row, (a, b)) in before.rows().zip(after.rows()).enumerate() {
        let Some([left, right]) = changed_columns(a, b) else { continue };
        let area = changed.unwrap_or(Area { left, top: row, right, bottom: row });
        changed = Some(Area { left: area.left.min(left), right: area.right.max(right), bottom: row + 1, ..area });
    }
    changed
}

/// The first column in which two rows differ, and the one after the last such column.
fn changed_columns(a: &[[u8; 4]], b: &[[u8; 4]]) -> Option<[usize; 2]> {
    if a == b {
        return None;
    }
    let first = a.iter().zip(b).position(|(a, b)| a != b)?;
    let last = a.iter().zip(b).rposition(|(a, b)| a != b)?;
    Some([first, last + 1])
}
