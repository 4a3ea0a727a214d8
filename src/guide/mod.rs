// The chapters are the Markdown files of this folder. `links.md` comes first in each of them, and of several
// definitions of a link the first one counts: rustdoc links to the modules below, whereas a repository browser
// uses the definitions at the end of each file and links to the files.
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
#[doc = include_str!("architecture.md")]
pub mod architecture {}
