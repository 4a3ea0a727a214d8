use super::*;
use crate::physics::*;
use crate::scene::*;
use std::sync::Arc;
pub fn sample(kind: &str) -> Frame {
    let mut sprites = vec![];
    let size = (16.0, 9.0);
    let walls = [
        (-1.0, -1.0, 18.0, 1.0, "wall-top"),
        (-1.0, 9.0, 18.0, 1.0, "wall-bottom"),
        (-1.0, 0.0, 1.0, 9.0, "wall-left"),
        (16.0, 0.0, 1.0, 9.0, "wall-right"),
    ];
    let _ = size;
    for (i, w) in walls.iter().enumerate() {
        sprites.push(Sprite {
            appearance: Arc::new(Appearance {
                id: i as u32,
                name: w.4.into(),
                material: "".into(),
                color: None,
                mass: f64::INFINITY,
                is_wall: true,
            }),
            rect: Rect::new(Vector::new(w.0, w.1), w.2, w.3),
            velocity: Vector::ZERO,
            trail: vec![],
        });
    }
    let mut seed = 12345u64;
    let mut r = |a: f64, b: f64| {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        a + (b - a) * ((seed >> 33) as f64 / (1u64 << 31) as f64)
    };
    let n = match kind {
        "gas" => 50,
        "big" => 1000,
        _ => 7,
    };
    for i in 0..n {
        let (w, h) = if kind == "gas" {
            (r(0.3, 0.9), r(0.3, 0.9))
        } else if kind == "big" {
            (r(0.1, 0.3), r(0.1, 0.3))
        } else {
            (r(0.6, 2.4), r(0.6, 1.8))
        };
        let (x, y) = (r(0.1, 15.5 - w), r(0.1, 8.8 - h));
        let v = Vector::new(r(-5.0, 5.0), r(-5.0, 5.0));
        let trail = (0..40)
            .map(|k| {
                let t = (40 - k) as f64 / 60.0;
                Vector::new(x + w / 2.0 - v.x * t, y + h / 2.0 - v.y * t + t * t * 4.9)
            })
            .collect();
        let name = if kind == "gas" || kind == "big" {
            format!("#{i}")
        } else {
            ["c", "b", "Ωé", "heavy", "AVATar", "box 5", "anvil"][i].to_string()
        };
        sprites.push(Sprite {
            appearance: Arc::new(Appearance {
                id: (i + 4) as u32,
                name,
                material: ["steel", "wood", ""][i % 3].into(),
                color: None,
                mass: if i == 6 { f64::INFINITY } else { 1.0 },
                is_wall: false,
            }),
            rect: Rect::new(Vector::new(x, y), w, h),
            velocity: v,
            trail,
        });
    }
    let rects = [sprites[4].rect, {
        let mut q = sprites[4].rect;
        q.move_by(Vector::new(q.width() - 0.1, 0.3));
        q
    }];
    Frame {
        step: 75,
        time: 1.25,
        collisions: vec![Collision {
            step: 74,
            time: 0.0,
            bodies: [4, 5],
            rects,
            normal: Vector::new(-1.0, 0.0),
            penetration: Vector::new(-0.1, 0.0),
            shares: [0.5, 0.5],
            impulse: 1.0,
            before: [Vector::ZERO; 2],
            after: [Vector::ZERO; 2],
        }],
        sprites,
    }
}
#[test]
#[ignore]
fn look() {
    let only = std::env::var("LOOK").unwrap_or_default();
    for (name, kind, theme, show, by) in [
        ("plain", "few", Theme::Light, vec![Overlay::Name, Overlay::Clock], ColorBy::Body),
        (
            "dark",
            "few",
            Theme::Dark,
            vec![Overlay::Name, Overlay::Clock, Overlay::Velocity, Overlay::Grid],
            ColorBy::Body,
        ),
        ("all", "few", Theme::Light, Overlay::ALL.to_vec(), ColorBy::Material),
        ("gas", "gas", Theme::Light, vec![Overlay::Name, Overlay::Clock], ColorBy::Body),
        ("gasspeed", "gas", Theme::Light, vec![Overlay::Velocity, Overlay::Trail, Overlay::Clock], ColorBy::Speed),
        ("darkspeed", "gas", Theme::Dark, vec![Overlay::Velocity, Overlay::Trail, Overlay::Clock], ColorBy::Speed),
        ("big", "big", Theme::Light, vec![Overlay::Clock], ColorBy::Speed),
    ] {
        if !only.is_empty() && only != name {
            continue;
        }
        let style = Style { theme, show, color_by: by, top_speed: 7.0, materials: vec!["steel".into(), "wood".into()] };
        let view = View::fit(Vector::new(16.0, 9.0), [1280, 720], style).unwrap();
        let frame = sample(kind);
        let mut painter = Painter::new();
        let mut best = [f64::MAX; 4];
        for _ in 0..20 {
            let t0 = std::time::Instant::now();
            let list = compose(&frame, &view);
            let t1 = std::time::Instant::now();
            let picture = painter.draw(&list);
            let t2 = std::time::Instant::now();
            let indexed = indexed::Indexed::exact(&picture.pixels);
            let t3 = std::time::Instant::now();
            let mut out = vec![];
            png::encode(&picture, &Metadata::default(), &mut out).unwrap();
            let t4 = std::time::Instant::now();
            for (b, t) in best.iter_mut().zip([t1 - t0, t2 - t1, t3 - t2, t4 - t3]) {
                let t = t.as_secs_f64() * 1e3;
                if t < *b {
                    *b = t
                }
            }
            std::fs::write(format!("/tmp/look/{name}.png"), &out).unwrap();
            if best[3] == (t4 - t3).as_secs_f64() * 1e3 {
                eprintln!(
                    "{name} colours {:?} bytes {} shapes {}",
                    indexed.map(|i| i.palette.len()),
                    out.len(),
                    list.shapes.len()
                );
            }
        }
        eprintln!(
            "{name}: compose {:.3} draw {:.3} index {:.3} png(with index) {:.3} ms",
            best[0], best[1], best[2], best[3]
        );
    }
}

pub fn moving(kind: &str, step: u64) -> Frame {
    let mut frame = sample(kind);
    let fold = |x: f64, range: f64| {
        let m = x.rem_euclid(2.0 * range);
        if m < range { m } else { 2.0 * range - m }
    };
    let t = step as f64 / 60.0;
    for s in frame.sprites.iter_mut().filter(|s| !s.appearance.is_wall) {
        let (w, h) = (s.rect.width(), s.rect.height());
        s.rect = Rect::new(
            Vector::new(
                fold(s.rect.origin.x + s.velocity.x * t, 16.0 - w),
                fold(s.rect.origin.y + s.velocity.y * t, 9.0 - h),
            ),
            w,
            h,
        );
        s.trail.clear();
    }
    frame.collisions.clear();
    frame.step = step;
    frame.time = t;
    frame
}
#[test]
#[ignore]
fn gif() {
    for (name, kind, show, by) in [
        ("few", "few", vec![Overlay::Name, Overlay::Clock], ColorBy::Body),
        ("gas", "gas", vec![Overlay::Name, Overlay::Clock], ColorBy::Body),
        ("gasplain", "gas", vec![], ColorBy::Body),
        ("gasspeed", "gas", vec![Overlay::Velocity, Overlay::Grid, Overlay::Clock], ColorBy::Speed),
        ("big", "big", vec![], ColorBy::Speed),
    ] {
        for threads in [1, 2] {
            let style =
                Style { theme: Theme::Light, show: show.clone(), color_by: by, top_speed: 7.0, materials: vec![] };
            let view = View::fit(Vector::new(16.0, 9.0), [1280, 720], style).unwrap();
            let sampling = Sampling::new(0..=299, 60.0, Thinning::Every(2));
            let frames: Vec<_> = (0..150).map(|i| moving(kind, 2 * i)).collect();
            let t = std::time::Instant::now();
            let mut out = vec![];
            write_gif::<RenderError>(
                frames.iter().cloned().map(Ok),
                &view,
                &sampling,
                &Metadata::default(),
                threads.try_into().unwrap(),
                &mut out,
            )
            .unwrap();
            let e = t.elapsed().as_secs_f64() * 1e3 / 150.0;
            let t = std::time::Instant::now();
            let mut bytes = 0;
            write_png_sequence::<RenderError>(
                frames.iter().cloned().map(Ok),
                &view,
                |_| Metadata::default(),
                threads.try_into().unwrap(),
                |_, f| {
                    bytes += f.len();
                    Ok(())
                },
            )
            .unwrap();
            let p = t.elapsed().as_secs_f64() * 1e3 / 150.0;
            eprintln!(
                "{name} threads {threads}: gif {e:.2} ms/frame {} kB/frame; png {p:.2} ms/frame {} kB",
                out.len() / 150_000,
                bytes / 150_000
            );
            std::fs::write(format!("/tmp/look/{name}.gif"), &out).unwrap();
        }
    }
}

#[test]
#[ignore]
fn stages() {
    for (name, kind, show, by) in [
        ("few", "few", vec![Overlay::Name, Overlay::Clock], ColorBy::Body),
        ("gas", "gas", vec![Overlay::Name, Overlay::Clock], ColorBy::Body),
        ("gasplain", "gas", vec![], ColorBy::Body),
        ("gasspeed", "gas", vec![Overlay::Velocity, Overlay::Grid, Overlay::Clock], ColorBy::Speed),
        ("big", "big", vec![], ColorBy::Speed),
    ] {
        let style = Style { theme: Theme::Light, show: show.clone(), color_by: by, top_speed: 7.0, materials: vec![] };
        let view = View::fit(Vector::new(16.0, 9.0), [1280, 720], style).unwrap();
        let (a, b) = (moving(kind, 10), moving(kind, 12));
        let mut painter = Painter::new();
        let pa = painter.draw(&compose(&a, &view));
        let mut best = [f64::MAX; 6];
        let mut n = 0;
        let mut colors = 0;
        for _ in 0..40 {
            let t0 = std::time::Instant::now();
            let list = compose(&b, &view);
            let t1 = std::time::Instant::now();
            let pb = painter.draw(&list);
            let t2 = std::time::Instant::now();
            let patch = patch::Patch::between(Some(&pa), &pb);
            let t3 = std::time::Instant::now();
            n = patch.pixels.len();
            colors = patch.palette.len();
            let c = lzw::compress(&patch.pixels);
            let t4 = std::time::Instant::now();
            let i = indexed::Indexed::exact(&pb.pixels);
            let t5 = std::time::Instant::now();
            let mut out = vec![];
            png::encode(&pb, &Metadata::default(), &mut out).unwrap();
            let t6 = std::time::Instant::now();
            std::hint::black_box((c, i));
            for (b, t) in best.iter_mut().zip([t1 - t0, t2 - t1, t3 - t2, t4 - t3, t5 - t4, t6 - t5]) {
                let t = t.as_secs_f64() * 1e3;
                if t < *b {
                    *b = t
                }
            }
        }
        eprintln!(
            "{name}: compose {:.3} draw {:.3} patch {:.3} ({n} px, {colors} col) lzw {:.3} index {:.3} png {:.3}",
            best[0], best[1], best[2], best[3], best[4], best[5]
        );
    }
}
