//! All integration tests, in one binary because linking takes most of their time.

#[path = "integration/accuracy.rs"]
mod accuracy;
#[path = "integration/altered_fields.rs"]
mod altered_fields;
#[path = "integration/altered_recordings.rs"]
mod altered_recordings;
#[path = "integration/animations.rs"]
mod animations;
#[path = "integration/bundled.rs"]
mod bundled;
#[path = "integration/check.rs"]
mod check;
#[path = "integration/check_formats.rs"]
mod check_formats;
#[path = "integration/check_update.rs"]
mod check_update;
#[path = "integration/clicks.rs"]
mod clicks;
#[path = "integration/coincident_events.rs"]
mod coincident_events;
#[path = "integration/command_line.rs"]
mod command_line;
#[path = "integration/command_line_errors.rs"]
mod command_line_errors;
#[path = "integration/crashes.rs"]
mod crashes;
#[path = "integration/damaged_recordings.rs"]
mod damaged_recordings;
#[path = "integration/digests.rs"]
mod digests;
#[path = "integration/double_double.rs"]
mod double_double;
#[path = "integration/event_driven_contacts.rs"]
mod event_driven_contacts;
#[path = "integration/event_driven_impacts.rs"]
mod event_driven_impacts;
#[path = "integration/event_driven_laws.rs"]
mod event_driven_laws;
#[path = "integration/event_driven_oracle.rs"]
mod event_driven_oracle;
#[path = "integration/figures.rs"]
mod figures;
#[path = "integration/forge.rs"]
mod forge;
#[path = "integration/frames.rs"]
mod frames;
#[path = "integration/fuzz_corpus.rs"]
mod fuzz_corpus;
#[path = "integration/handout_limits.rs"]
mod handout_limits;
#[path = "integration/hard_scenes.rs"]
mod hard_scenes;
#[cfg(target_os = "linux")]
#[path = "integration/hostile_lengths.rs"]
mod hostile_lengths;
#[path = "integration/images.rs"]
mod images;
#[path = "integration/laws/mod.rs"]
mod laws;
#[path = "integration/legibility.rs"]
mod legibility;
#[path = "integration/library.rs"]
mod library;
#[path = "integration/limits.rs"]
mod limits;
#[path = "integration/live_events.rs"]
mod live_events;
#[cfg(unix)]
#[path = "integration/output_files.rs"]
mod output_files;
#[cfg(unix)]
#[path = "integration/pipes.rs"]
mod pipes;
#[path = "integration/portability.rs"]
mod portability;
#[path = "integration/provenance.rs"]
mod provenance;
#[path = "integration/rebond.rs"]
mod rebond;
#[path = "integration/reference_image.rs"]
mod reference_image;
#[path = "integration/released.rs"]
mod released;
#[path = "integration/report.rs"]
mod report;
#[path = "integration/run_states.rs"]
mod run_states;
#[path = "integration/scene_errors.rs"]
mod scene_errors;
#[path = "integration/shards.rs"]
mod shards;
#[path = "integration/side_by_side.rs"]
mod side_by_side;
#[path = "integration/slow_motion.rs"]
mod slow_motion;
#[path = "integration/snapshot.rs"]
mod snapshot;
#[path = "integration/stills.rs"]
mod stills;
#[path = "integration/student_engine.rs"]
mod student_engine;
#[path = "integration/studies.rs"]
mod studies;
#[path = "integration/testing.rs"]
mod testing;
#[path = "integration/threads.rs"]
mod threads;
#[path = "integration/videos.rs"]
mod videos;
#[path = "integration/viewer.rs"]
mod viewer;
#[path = "integration/world_builder.rs"]
mod world_builder;
