//! Text snapshots, stored in the top-level folder `snapshots` under the names that tests pass.

/// Asserts that `text` equals the committed snapshot `name`.
///
/// `INSTA_UPDATE=always cargo test` accepts changes.
pub fn assert_text(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(concat!(env!("CARGO_MANIFEST_DIR"), "/snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}
