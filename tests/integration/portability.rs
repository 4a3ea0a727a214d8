//! Forbids words in the source that could make results differ between processors, runs or versions of the
//! standard library and that clippy cannot forbid.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// A forbidden word, the files in which it is allowed, and the reason.
struct Rule {
    word: &'static str,
    allowed: &'static [&'static str],
    reason: &'static str,
}

const fn forbidden(word: &'static str, reason: &'static str) -> Rule {
    Rule { word, allowed: &[], reason }
}

const PLATFORM: &str = "code for one platform is not tested on the others";

const RULES: &[Rule] = &[
    forbidden("_ne_bytes", "the byte order depends on the processor; use to_le_bytes"),
    forbidden("transmute", "the memory layout depends on the processor"),
    forbidden("offset_of", "the memory layout depends on the processor"),
    Rule {
        word: "size_of",
        allowed: &["src/page/history.rs", "src/replay/scene_run.rs"],
        reason: "it differs between 32-bit and 64-bit processors; only the memory of snapshots is estimated with it",
    },
    forbidden("usize::MAX", "it differs between 32-bit and 64-bit processors"),
    forbidden("isize", "it differs between 32-bit and 64-bit processors"),
    forbidden("len().to_le_bytes", "a length is a usize; convert it to u64 first"),
    forbidden("as *const", "addresses differ between runs"),
    forbidden("{:p}", "addresses differ between runs"),
    forbidden("target_arch", PLATFORM),
    forbidden("target_endian", PLATFORM),
    forbidden("target_env", PLATFORM),
    forbidden("target_family", PLATFORM),
    forbidden("target_feature", PLATFORM),
    forbidden("target_os", PLATFORM),
    forbidden("target_pointer_width", PLATFORM),
    forbidden("target_vendor", PLATFORM),
    forbidden("is_x86_feature_detected", PLATFORM),
    forbidden("std::arch", PLATFORM),
    forbidden("cfg!(debug_assertions)", "debug and release builds must behave alike"),
    forbidden("algebraic", "it allows the compiler to reorder floating-point operations"),
    forbidden("from_rotate", "tiny-skia computes sine and cosine with the platform's mathematics library"),
    forbidden("pre_rotate", "tiny-skia computes sine and cosine with the platform's mathematics library"),
    forbidden("post_rotate", "tiny-skia computes sine and cosine with the platform's mathematics library"),
    forbidden(
        "RadialGradient",
        "of tiny-skia only the coverage of filled paths is proven bit-identical, not the float pipeline",
    ),
    forbidden(
        "LinearGradient",
        "of tiny-skia only the coverage of filled paths is proven bit-identical, not the float pipeline",
    ),
    forbidden("BlendMode", "colour burn and colour dodge use approximate reciprocals, which differ between processors"),
    forbidden("par_iter", "the order of a parallel reduction depends on scheduling; use ordered_parallel_map"),
    forbidden("hash_map", "its iteration order differs between runs"),
    forbidden("rand::", "its seed is random; use scene::Random"),
    forbidden("SystemTime", "no result may depend on the clock"),
    Rule {
        word: "std::time",
        allowed: &["src/cli/output_file.rs", "src/cli/supervisor.rs", "src/report/cost.rs"],
        reason: "no result may depend on the clock; only `rebond report` measures time, a child of `check` waits for the \
                 end of its parent, and `--skip-existing` for that of another recorder",
    },
    forbidden("select_nth_unstable", "the order before and after the selected element is unspecified"),
    Rule {
        word: "thread::",
        allowed: &[
            "src/cli/arguments.rs",
            "src/cli/output_file.rs",
            "src/cli/supervisor.rs",
            "src/temporary.rs",
            "src/recording/writer_thread.rs",
            "src/recording/writer.rs",
            "src/picture/encode/ordered_parallel_map.rs",
            "src/physics/event_driven/threads.rs",
        ],
        reason: "only these modules start or suspend threads: for recording, for drawing, for the work of the solver that \
                 depends on no order, and to wait for signals and processes",
    },
    Rule { word: "process::id", allowed: &["src/temporary.rs"], reason: "WASI panics; use temporary::process_number" },
    Rule { word: "temp_dir", allowed: &["src/temporary.rs"], reason: "WASI panics; use temporary::system_folder" },
    Rule {
        word: "tiny_skia",
        allowed: &["src/picture/raster/coverage_mask.rs"],
        reason: "of tiny-skia only the integer coverage of filled paths is used, in one module",
    },
    Rule {
        word: "env::",
        allowed: &[
            "src/cli/github.rs",
            "src/cli/report.rs",
            "src/cli/supervisor.rs",
            "src/temporary.rs",
            "src/testing/held.rs",
        ],
        reason: "no result may depend on the environment; report and check only start this program again, GitHub names its files, \
                 and tests are told whether to accept differences",
    },
];

/// Names and texts of the source files of the library and the program, without tests.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |path: PathBuf| {
        let name = path.strip_prefix(root).unwrap().to_string_lossy().into_owned();
        let text = fs::read_to_string(&path).unwrap();
        let end = text.find("\n#[cfg(test)]\nmod ").unwrap_or(text.len());
        (name, text[..end].to_owned())
    };
    let is_test = |name: &str| name.ends_with("tests.rs") || name.ends_with("testing.rs");
    files(&root.join("src")).into_iter().map(read).filter(|(name, _)| !is_test(name)).collect()
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] });
    files.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// The lines of code that contain a word, with their numbers. Comments are ignored. A word that starts with a
/// letter is only found at the start of an identifier: `thread::` is not in `writer_thread::`.
fn lines_with<'a>(text: &'a str, word: &str) -> impl Iterator<Item = (usize, &'a str)> {
    let code = |line: &'a str| line.split("//").next().unwrap_or_default();
    let continues = |before: &str| before.ends_with(|last: char| last.is_alphanumeric() || last == '_');
    let is_identifier = word.starts_with(char::is_alphabetic);
    let has_word = move |line: &str| line.match_indices(word).any(|(at, _)| !is_identifier || !continues(&line[..at]));
    text.lines().map(code).zip(1..).map(|(line, number)| (number, line)).filter(move |(_, line)| has_word(line))
}

#[test]
fn no_source_contains_a_forbidden_word() {
    let sources = sources();
    assert!(sources.len() > 100, "{} files of source", sources.len());
    for Rule { word, allowed, reason } in RULES {
        for (name, text) in &sources {
            let found: Vec<_> = lines_with(text, word).collect();
            if allowed.contains(&name.as_str()) {
                assert!(!found.is_empty(), "{name} does not contain {word} any more; remove it from the rule")
            } else {
                assert!(found.is_empty(), "{name}: {found:?}: {reason}")
            }
        }
    }
}

/// Numbers that are written or hashed must have the same width on all platforms.
#[test]
fn no_serialized_type_contains_a_usize() {
    for (name, text) in sources().iter().filter(|(_, text)| text.contains("Serialize")) {
        let fields: Vec<_> = lines_with(text, ": usize,").chain(lines_with(text, "<usize>")).collect();
        assert!(fields.is_empty(), "{name}: {fields:?}");
    }
}

/// With its feature `std`, tiny-skia would use the platform's mathematics library.
#[test]
fn tiny_skia_is_built_without_the_platforms_mathematics_library() {
    let manifest = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap();
    let features = r#"tiny-skia = { version = "0.12", default-features = false, features = ["no-std-float", "simd"], optional = true }"#;
    assert!(manifest.contains(features));
}
