//! Sources that come through a pipe, which can be read only once.

use crate::rebond::Workplace;

/// Without its first bytes it has no steps.
const SCENE: &str = "run.steps = 60\n[[spawn]]\nname = \"c\"\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
                     velocity = [9.0, 0.0]\n";

#[test]
fn a_scene_from_a_pipe_is_read_once_and_completely() {
    let workplace = Workplace::with_scene(SCENE);
    for table in ["states", "collisions", "energy", "bodies"] {
        let from_file = workplace.done(&format!("export scene.toml --table {table}")).output;
        let piped = workplace.rebond_with_input(&format!("export /dev/stdin --table {table}"), SCENE);
        assert_eq!((piped.code, piped.output), (0, from_file), "{table}: {}", piped.errors);
    }
    for line in [
        "export /dev/stdin --set run.steps=[2|3]",
        "render /dev/stdin --at 60 -o state.png",
        "render /dev/stdin /dev/stdin --at 60 -o two.png",
        "figure energy /dev/stdin -o energy.svg",
    ] {
        let piped = workplace.rebond_with_input(line, SCENE);
        assert_eq!(piped.code, 0, "{line}: {piped:?}");
    }
}

#[test]
fn a_recording_from_a_pipe_is_refused_with_what_to_do() {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    let (recording, names) = (workplace.read("run.mcap"), workplace.names());
    for line in [
        "replay /dev/stdin",
        "info /dev/stdin",
        "recover /dev/stdin -o fixed.mcap",
        "export /dev/stdin -o states.csv",
        "render /dev/stdin --at 3 -o state.png",
        "figure energy /dev/stdin -o energy.svg",
    ] {
        let refused = workplace.rebond_with_input(line, &recording);
        let message = "/dev/stdin is not a regular file; save the recording to a file first";
        assert!(refused.code == 1 && refused.errors.contains(message), "{line}: {refused:?}");
        assert_eq!(workplace.names(), names, "{line}");
    }
}

#[test]
fn a_report_refuses_a_scene_that_it_cannot_read_again() {
    let workplace = Workplace::new();
    for scene in ["/dev/stdin", "-"] {
        let refused = workplace.rebond_with_input(&format!("report {scene}"), SCENE);
        let is_clear = refused.errors.contains("report reads each scene several times");
        assert!(refused.code == 1 && is_clear, "{scene}: {refused:?}");
    }
}
