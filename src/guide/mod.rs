// The chapters are the Markdown files of this folder. `links.md` comes first in each of them, and of several
// definitions of a link the first one counts: rustdoc links to the modules below, whereas a repository browser
// uses the definitions at the end of each file and links to the files. Pictures are shown by a repository browser and
// by the documentation that is built in a clone.
#![doc = include_str!("links.md")]
#![doc = include_str!("overview.md")]

#[doc = include_str!("links.md")]
#[doc = include_str!("scene-format.md")]
pub mod scene_format {}

#[doc = include_str!("links.md")]
#[doc = include_str!("recording-format.md")]
pub mod recording_format {}

#[doc = include_str!("links.md")]
#[doc = include_str!("determinism.md")]
pub mod determinism {}

#[doc = include_str!("links.md")]
#[doc = include_str!("solvers.md")]
pub mod solvers {}

#[doc = include_str!("links.md")]
#[doc = include_str!("accuracy-and-speed.md")]
pub mod accuracy_and_speed {}

#[doc = include_str!("links.md")]
#[doc = include_str!("checking.md")]
pub mod checking {}

#[doc = include_str!("links.md")]
#[doc = include_str!("pictures.md")]
pub mod pictures {}

#[doc = include_str!("links.md")]
#[doc = include_str!("page.md")]
pub mod page {}

#[doc = include_str!("links.md")]
#[doc = include_str!("handout.md")]
pub mod handout {}

#[doc = include_str!("links.md")]
#[doc = include_str!("student-engine.md")]
pub mod student_engine {}

#[doc = include_str!("links.md")]
#[doc = include_str!("studies.md")]
pub mod studies {}

#[doc = include_str!("links.md")]
#[doc = include_str!("notebooks.md")]
pub mod notebooks {}

#[doc = include_str!("links.md")]
#[doc = include_str!("architecture.md")]
pub mod architecture {}

#[cfg(test)]
mod tests {
    use std::path::Path;

    const README: &str = include_str!("../../README.md");
    const FIRST_SCENE: &str = include_str!("../../recordings/first-scene.toml");
    const RUSTDOC_LINKS: &str = include_str!("links.md");
    const CHAPTERS: [&str; 14] = [
        include_str!("overview.md"),
        include_str!("scene-format.md"),
        include_str!("recording-format.md"),
        include_str!("determinism.md"),
        include_str!("solvers.md"),
        include_str!("accuracy-and-speed.md"),
        include_str!("checking.md"),
        include_str!("pictures.md"),
        include_str!("page.md"),
        include_str!("handout.md"),
        include_str!("student-engine.md"),
        include_str!("studies.md"),
        include_str!("notebooks.md"),
        include_str!("architecture.md"),
    ];

    /// The definitions of links: their labels and targets.
    fn definitions(text: &str) -> impl Iterator<Item = (&str, &str)> {
        text.lines().filter_map(|line| line.strip_prefix('[')?.split_once("]: "))
    }

    #[test]
    fn the_first_scene_of_the_readme_is_the_one_in_the_repository() {
        assert!(README.contains(&format!("<<'END'\n{FIRST_SCENE}END\n")));
    }

    #[test]
    fn every_link_between_chapters_works_in_rustdoc_and_in_a_repository_browser() {
        let labels: Vec<&str> = definitions(RUSTDOC_LINKS).map(|(label, _)| label).collect();
        for chapter in CHAPTERS {
            for (label, file) in definitions(chapter) {
                let target = definitions(RUSTDOC_LINKS).find(|(defined, _)| *defined == label);
                let (_, target) = target.unwrap_or_else(|| panic!("links.md does not define [{label}]"));
                match file.strip_prefix("../../") {
                    // The documentation of the chapter is in target/doc/rebond/guide/NAME.
                    Some(picture) => {
                        assert_eq!(target, format!("../../../../../{picture}"));
                        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
                        assert!(package.join(picture).is_file(), "{picture} does not exist");
                    }
                    None => assert_eq!(file, format!("{}.md", label.replace(' ', "-"))),
                }
            }
            for label in labels.iter().filter(|label| chapter.contains(&format!("[{label}]"))) {
                assert!(definitions(chapter).any(|(defined, _)| defined == *label), "[{label}] has no definition");
            }
        }
    }
}
