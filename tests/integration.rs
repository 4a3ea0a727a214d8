//! All integration tests, in one binary: linking is most of what they cost.

#[path = "integration/clips.rs"]
mod clips;
#[path = "integration/frames.rs"]
mod frames;
#[path = "integration/reference.rs"]
mod reference;
#[path = "integration/snapshot.rs"]
mod snapshot;
#[path = "integration/stills.rs"]
mod stills;
