//! Runs a scene: `run SCENE.toml [--log] [--quiet]`. Prints the states as reference.py does.
use edmd::physics::Collision;
use edmd::scene::{Scene, digits17, log_line};
use std::io::Write;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let log = args.iter().any(|arg| arg == "--log");
    let quiet = args.iter().any(|arg| arg == "--quiet");
    let path = args.iter().find(|arg| !arg.starts_with("--")).expect("a scene");
    let scene = Scene::parse(&std::fs::read_to_string(path).unwrap());
    let mut names: Vec<String> = scene.walls().iter().filter_map(|event| match event {
        edmd::physics::Event::Spawn(spawn) => Some(spawn.name.clone()),
        _ => None,
    }).collect();
    let mut order: Vec<usize> = (0..scene.spawn.len()).collect();
    order.sort_by_key(|index| scene.spawn[*index].step);
    names.extend(order.iter().map(|i| scene.spawn[*i].name.clone().unwrap_or_else(|| format!("#{}", i + 1))));
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    writeln!(out, "step,name,x,y,vx,vy").unwrap();
    let mut collisions: Vec<Collision> = Vec::new();
    let result = scene.run(&mut collisions, |engine| {
        if quiet {
            return;
        }
        for body in &engine.world().bodies {
            let numbers = [body.rect.origin.x, body.rect.origin.y, body.velocity.x, body.velocity.y].map(digits17);
            writeln!(out, "{},{},{}", engine.current_step(), body.name, numbers.join(",")).unwrap();
        }
    });
    out.flush().unwrap();
    let mut err = std::io::BufWriter::new(std::io::stderr().lock());
    if let Err(error) = &result {
        writeln!(err, "{error}").unwrap();
    }
    if log {
        for collision in &collisions {
            writeln!(err, "{}", log_line(collision, |id| names[id as usize].clone())).unwrap();
        }
    }
    writeln!(err, "collisions {}", collisions.len()).unwrap();
    err.flush().unwrap();
    drop(err);
    std::process::exit(i32::from(result.is_err()));
}
