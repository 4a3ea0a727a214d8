//! Where snapshots of text live: snapshots/ at the top, under the names tests give them.

/// Compares `text` with the committed snapshot of that name, exactly.
///
/// `INSTA_UPDATE=always cargo test` accepts what changed.
pub fn assert_text(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(concat!(env!("CARGO_MANIFEST_DIR"), "/snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}
