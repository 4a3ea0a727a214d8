use rebond::recording::*;
use std::io::Cursor;
fn main() {
    let bytes = std::fs::read(std::env::args().nth(1).unwrap()).unwrap();
    let show = |bytes: &[u8]| {
        let mut r = Recording::read(Cursor::new(bytes)).unwrap();
        println!("gaps {:?} every {}", r.header.gaps, r.header.every);
        for i in r.by_ref() {
            let s = format!("{:?}", i.unwrap());
            println!("  {}", s.chars().take(150).collect::<String>());
        }
        println!("{:?}", r.health());
    };
    show(&bytes);
    let mut r = Recording::read(Cursor::new(bytes.as_slice())).unwrap();
    let (rec, once) = recover(&mut r, Vec::new()).unwrap();
    println!("{rec}\n-- once");
    show(&once);
    let mut r = Recording::read(Cursor::new(once.as_slice())).unwrap();
    let (rec, twice) = recover(&mut r, Vec::new()).unwrap();
    println!("{rec}\n-- twice {}", once == twice);
    if once != twice {
        show(&twice);
    }
}
