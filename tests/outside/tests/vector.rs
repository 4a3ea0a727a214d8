//! Compares SVG and PDF files, rasterised by independent renderers, with rebond's own raster.

#[path = "../../integration/frames.rs"]
mod frames;

use hayro::hayro_interpret::InterpreterSettings;
use hayro::hayro_syntax::Pdf;
use hayro::{RenderCache, RenderSettings};
use rebond::internals::picture::{DisplayList, Metadata, Painter, Picture, compose, pdf, svg};
use rebond::internals::picture::{ColorBy, Overlay, TextAs, Theme};
use resvg::{tiny_skia, usvg};

/// Asserts that two rasters agree except for antialiasing: few pixels differ much, and no filled area does.
fn assert_similar(ours: &Picture, theirs: &[[u8; 4]], case: &str) {
    assert_eq!(ours.pixels.len(), theirs.len(), "{case}");
    let difference = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).map(|at| a[at].abs_diff(b[at])).max().unwrap_or(0);
    let differences: Vec<u8> = ours.pixels.iter().zip(theirs).map(difference).collect();
    let mean = differences.iter().map(|&difference| f64::from(difference)).sum::<f64>() / differences.len() as f64;
    let far = differences.iter().filter(|&&difference| difference > 100).count();
    assert!(mean < 2.0, "{case}: {mean} on average");
    assert!(far * 50_000 < differences.len(), "{case}: {far} pixels differ by more than 100");
}

fn rasterised_svg(list: &DisplayList) -> Vec<[u8; 4]> {
    let mut file = Vec::new();
    svg::encode(list, &Metadata::default(), TextAs::Outlines, &mut file).unwrap();
    let tree = usvg::Tree::from_data(&file, &usvg::Options::default()).unwrap();
    let mut pixels = tiny_skia::Pixmap::new(list.size[0], list.size[1]).unwrap();
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixels.as_mut());
    pixels.data().as_chunks::<4>().0.to_vec()
}

fn rasterised_pdf(list: &DisplayList) -> Vec<[u8; 4]> {
    let mut file = Vec::new();
    pdf::encode(list, &Metadata::default(), &mut file).unwrap();
    let document = Pdf::new(file).unwrap();
    // A pixel is 3/4 of a point.
    let settings = RenderSettings { x_scale: 4.0 / 3.0, y_scale: 4.0 / 3.0, ..RenderSettings::default() };
    let page = &document.pages()[0];
    let pixels = hayro::render(page, &RenderCache::new(), &InterpreterSettings::default(), &settings);
    pixels.data_as_u8_slice().as_chunks::<4>().0.to_vec()
}

#[test]
fn frames_look_the_same_in_every_format() {
    for theme in Theme::ALL {
        for color_by in ColorBy::ALL {
            let list = compose(&frames::collision(), &frames::view(*theme, Overlay::ALL, *color_by));
            let ours = Painter::new().draw(&list);
            assert_similar(&ours, &rasterised_svg(&list), &format!("SVG, {theme:?}, {color_by:?}"));
            assert_similar(&ours, &rasterised_pdf(&list), &format!("PDF, {theme:?}, {color_by:?}"));
        }
    }
}

#[test]
fn many_boxes_look_the_same_in_every_format() {
    let list = compose(&frames::moving(60, 30), &frames::view(Theme::Light, Overlay::ALL, ColorBy::Body));
    let ours = Painter::new().draw(&list);
    assert_similar(&ours, &rasterised_svg(&list), "SVG");
    assert_similar(&ours, &rasterised_pdf(&list), "PDF");
}
