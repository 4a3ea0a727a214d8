//! All integration tests, in one binary: linking is most of what they cost.

#[path = "integration/scene_errors.rs"]
mod scene_errors;
#[path = "integration/snapshot.rs"]
mod snapshot;
