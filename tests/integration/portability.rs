//! What clippy cannot see and yet could make the bits differ between processors, runs or
//! versions of the standard library: words that stand nowhere in the source, or only where
//! they do no harm.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// A word, where it may stand all the same, and why it may stand nowhere else.
struct Rule {
    word: &'static str,
    allowed: &'static [&'static str],
    reason: &'static str,
}

const fn nowhere(word: &'static str, reason: &'static str) -> Rule {
    Rule { word, allowed: &[], reason }
}

const RULES: &[Rule] = &[
    nowhere("_ne_bytes", "the order of bytes is the processor's; write to_le_bytes"),
    nowhere("transmute", "it shows how the processor lays out its memory"),
    nowhere("offset_of", "it shows how the processor lays out its memory"),
    nowhere("size_of", "it is not the same on 32 and 64 bits"),
    nowhere("usize::MAX", "it is not the same on 32 and 64 bits"),
    nowhere("isize", "it is not the same on 32 and 64 bits"),
    nowhere("len().to_le_bytes", "a length is a usize; make it a u64 first"),
    nowhere("as *const", "an address is another in every run"),
    nowhere("{:p}", "an address is another in every run"),
    nowhere("target_", "code for one kind of machine is not tested on the others"),
    nowhere("is_x86_feature_detected", "code for one kind of machine is not tested on the others"),
    nowhere("std::arch", "code for one kind of machine is not tested on the others"),
    nowhere("cfg!(debug_assertions)", "debug and release are to do the same"),
    nowhere("algebraic", "it lets the compiler change the order of operations"),
    nowhere("from_rotate", "tiny-skia asks the mathematics library for sine and cosine"),
    nowhere("pre_rotate", "tiny-skia asks the mathematics library for sine and cosine"),
    nowhere("post_rotate", "tiny-skia asks the mathematics library for sine and cosine"),
    nowhere(
        "RadialGradient",
        "equal bits are shown for tiny-skia's coverage of filled paths, not for its float pipeline",
    ),
    nowhere(
        "LinearGradient",
        "equal bits are shown for tiny-skia's coverage of filled paths, not for its float pipeline",
    ),
    nowhere("BlendMode", "colour burn and colour dodge use approximate reciprocals, in which processors differ"),
    nowhere("par_iter", "the order of a parallel reduction is the scheduler's; use in_order"),
    nowhere("hash_map", "its order changes from run to run"),
    nowhere("rand::", "it is seeded by the system; use scene::Random"),
    nowhere("SystemTime", "no result may depend on the clock"),
    Rule {
        word: "std::time",
        allowed: &["src/report/clock.rs"],
        reason: "no result may depend on the clock; only `rebond report` tells the time",
    },
    nowhere("select_nth_unstable", "what comes before and after is in no order"),
    Rule {
        word: "thread::",
        allowed: &[
            "src/cli/jobs.rs",
            "src/recording/background.rs",
            "src/recording/writer.rs",
            "src/render/in_order.rs",
        ],
        reason: "work is dealt out to threads in one place for recording and one for drawing",
    },
    Rule {
        word: "Mask",
        allowed: &["src/render/stencil.rs"],
        reason: "of tiny-skia only integer coverage of filled paths is used, and in one place",
    },
    Rule {
        word: "env::",
        allowed: &["src/cli/report.rs", "src/cli/source.rs"],
        reason: "no result may depend on the surroundings; report runs this program again",
    },
];

/// Source of the library and the program, without tests.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let named = |path: PathBuf| {
        let name = path.strip_prefix(root).unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap();
        let end = text.find("\n#[cfg(test)]\nmod ").unwrap_or(text.len());
        (name, text[..end].to_owned())
    };
    let is_test = |name: &str| name.ends_with("tests.rs") || name.ends_with("testing.rs");
    files(&root.join("src")).into_iter().map(named).filter(|(name, _)| !is_test(name)).collect()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] });
    files.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// The lines of code with a word in them; comments may say what they like.
fn lines_with<'a>(text: &'a str, word: &str) -> impl Iterator<Item = (usize, &'a str)> {
    let code = |line: &'a str| line.split("//").next().unwrap_or_default();
    text.lines().map(code).zip(1..).map(|(line, number)| (number, line)).filter(move |(_, line)| line.contains(word))
}

#[test]
fn no_source_has_what_could_differ_between_machines() {
    let sources = sources();
    assert!(sources.len() > 100, "{} files of source", sources.len());
    for Rule { word, allowed, reason } in RULES {
        for (name, text) in &sources {
            let found: Vec<_> = lines_with(text, word).collect();
            match allowed.contains(&name.as_str()) {
                true => assert!(!found.is_empty(), "{name} has no {word} any more: it need not be allowed"),
                false => assert!(found.is_empty(), "{name}: {found:?}: {reason}"),
            }
        }
    }
}

/// A count that is written or hashed has the same width everywhere.
#[test]
fn no_message_holds_a_usize() {
    for (name, text) in sources().iter().filter(|(_, text)| text.contains("Serialize")) {
        let fields: Vec<_> = lines_with(text, ": usize,").chain(lines_with(text, "<usize>")).collect();
        assert!(fields.is_empty(), "{name}: {fields:?}");
    }
}

/// With `std` tiny-skia would ask the platform's mathematics library.
#[test]
fn tiny_skia_brings_its_own_mathematics() {
    let manifest = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap();
    let features = r#"tiny-skia = { version = "0.12", default-features = false, features = ["no-std-float", "simd"] }"#;
    assert!(manifest.contains(features));
}
