//! The formats of `rebond check` that CI systems read, and the workflow of the guide.

use crate::check::lecture_folder;
use crate::command_line::SCENE;
use crate::rebond::{Outcome, Workplace};
use serde_json::Value;
use std::fs;
use std::process::Command;

const GUIDE: &str = include_str!("../../src/guide/checking.md");

/// The first code block of the guide in a language.
fn block(language: &str) -> &'static str {
    let start = GUIDE.find(&format!("```{language}\n")).unwrap_or_else(|| panic!("a block of {language}"));
    let block = &GUIDE[start + language.len() + 4..];
    &block[..block.find("```").unwrap()]
}

/// Checks a value against a schema, as far as the schema of the guide uses JSON Schema.
fn validate(value: &Value, schema: &Value, path: &str) -> Result<(), String> {
    let is_of = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("type {other}"),
    };
    for (keyword, expected) in schema.as_object().expect("a schema") {
        let is_valid = match keyword.as_str() {
            "$schema" | "title" | "description" => true,
            "type" => match expected {
                Value::String(name) => is_of(name),
                names => names.as_array().unwrap().iter().any(|name| is_of(name.as_str().unwrap())),
            },
            "const" => value == expected,
            "enum" => expected.as_array().unwrap().contains(value),
            "minimum" => value.as_f64().is_none_or(|number| number >= expected.as_f64().unwrap()),
            "required" => value.as_object().is_none_or(|object| {
                expected.as_array().unwrap().iter().all(|key| object.contains_key(key.as_str().unwrap()))
            }),
            "properties" => {
                for (key, inner) in value.as_object().into_iter().flatten() {
                    let schema = expected.get(key).ok_or_else(|| format!("{path}.{key} is not documented"))?;
                    validate(inner, schema, &format!("{path}.{key}"))?;
                }
                true
            }
            "items" => {
                let items = value.as_array().into_iter().flatten();
                items
                    .enumerate()
                    .try_for_each(|(index, item)| validate(item, expected, &format!("{path}[{index}]")))?;
                true
            }
            other => panic!("keyword {other}"),
        };
        if !is_valid {
            return Err(format!("{path} is {value}, which {keyword} {expected} does not allow"));
        }
    }
    Ok(())
}

/// A folder in which all kinds of things are wrong.
fn broken_folder() -> Workplace {
    let workplace = lecture_folder();
    workplace.write("scene.toml", &SCENE.replace("rate = 60", "rate = 50"));
    workplace.write("all.check", "rebond figure strobe scene.mcap -o strobe.svg\nrebond draw\n");
    workplace.done("render scene.mcap -o fall.png --force --at 20 --theme dark");
    workplace.write("hit.svg", "");
    workplace.write("photo.png", "a photo");
    workplace.write("new|<b>.toml", SCENE);
    fs::write(workplace.path("cut.mcap"), &workplace.read("scene.mcap")[..2000]).unwrap();
    workplace
}

#[test]
fn the_schema_of_the_guide_describes_every_object() {
    let schema: Value = serde_json::from_str(block("json")).unwrap();
    let workplace = broken_folder();
    let mut outcomes = std::collections::BTreeSet::new();
    let mut lines = String::new();
    for command in ["check . --json", "check . --json --update", "check . nowhere --json"] {
        lines += &workplace.rebond(command).output;
    }
    for line in lines.lines() {
        let value: Value = serde_json::from_str(line).unwrap();
        validate(&value, &schema, "$").unwrap_or_else(|error| panic!("{error}: {line}"));
        outcomes.insert(value["outcome"].as_str().unwrap().to_owned());
    }
    assert!(outcomes.len() >= 6, "{outcomes:?}");
    let mut wrong: Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
    wrong["severity"] = "fine".into();
    assert!(validate(&wrong, &schema, "$").is_err(), "the validator finds what is wrong");
}

/// The elements and attributes that the JUnit schemas of Jenkins and of Ant have in common.
fn assert_junit(text: &str) {
    let mut open: Vec<String> = Vec::new();
    let mut children = Vec::new();
    let mut rest = text.strip_prefix("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n").expect("the declaration");
    while let Some(start) = rest.find('<') {
        let end = start + rest[start..].find('>').expect("the end of a tag");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name), "{text}");
            continue;
        }
        let name = tag.split([' ', '/']).next().unwrap();
        let (parent, required): (Option<&str>, &[&str]) = match name {
            "testsuites" => (None, &[]),
            "testsuite" => (
                Some("testsuites"),
                &["name", "package", "id", "tests", "failures", "errors", "time", "timestamp", "hostname"],
            ),
            "properties" | "system-out" | "system-err" => (Some("testsuite"), &[]),
            "testcase" => (Some("testsuite"), &["classname", "name", "time"]),
            "failure" | "error" => (Some("testcase"), &["type", "message"]),
            other => panic!("the element {other} in {text}"),
        };
        assert_eq!(open.last().map(String::as_str), parent, "{name} in {text}");
        let attributes = tag.matches("=\"").count();
        assert_eq!(attributes, required.len(), "the schemas know no other attribute: {tag}");
        children.push(name);
        for attribute in required {
            assert!(tag.contains(&format!(" {attribute}=\"")), "{attribute} of {name} in {text}");
        }
        if !tag.ends_with('/') {
            open.push(name.to_owned());
        }
    }
    assert!(open.is_empty(), "{text}");
    children.retain(|name| !["failure", "error"].contains(name));
    children.dedup();
    let order = ["testsuites", "testsuite", "properties", "testcase", "system-out", "system-err"];
    assert_eq!(children, order, "{text}");
}

#[test]
fn a_junit_report_has_one_case_per_file_and_counts_what_failed() {
    let workplace = broken_folder();
    let outcome = workplace.rebond("check . --junit check.xml --json");
    let report = String::from_utf8(workplace.read("check.xml")).unwrap();
    assert_junit(&report);
    let lines: Vec<Value> = outcome.output.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let count = |severities: &[&str]| {
        lines.iter().filter(|line| severities.contains(&line["severity"].as_str().unwrap())).count()
    };
    let [failures, errors] = [count(&["different", "damaged"]), count(&["failed"])];
    assert!(failures > 0 && errors > 0);
    let counts = format!("tests=\"{}\" failures=\"{failures}\" errors=\"{errors}\"", lines.len());
    assert!(report.contains(&counts), "{counts}: {report}");
    assert!(
        report.contains("new|&lt;b&gt;.mcap") && report.contains("Accept: rebond check fall.png --update"),
        "{report}"
    );
    workplace.rebond("check . --junit check.xml");
    assert_eq!(String::from_utf8(workplace.read("check.xml")).unwrap(), report, "an earlier report is replaced");
    let outcome = workplace.rebond("check . --junit photo.png");
    assert!(outcome.code == 1 && workplace.read("photo.png") == b"a photo", "{outcome:?}");
    let outcome = workplace.rebond("check . --junit no/folder/check.xml");
    assert_eq!(outcome.code, 1, "{outcome:?}");
}

fn run_in(workplace: &Workplace, script: &str, variables: &[(&str, &str)]) -> Outcome {
    let rebond = std::path::Path::new(env!("CARGO_BIN_EXE_rebond")).parent().unwrap().to_owned();
    let path = std::env::join_paths(
        std::iter::once(rebond).chain(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())),
    );
    let mut command = Command::new("sh");
    command.args(["-euc", script]).current_dir(workplace.path("")).env("PATH", path.unwrap()).env("NO_COLOR", "1");
    command.envs(variables.iter().copied());
    let output = command.output().expect("a shell");
    Outcome {
        code: output.status.code().unwrap_or(-1),
        output: String::from_utf8_lossy(&output.stdout).into_owned(),
        errors: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

#[test]
#[cfg(unix)]
fn the_workflow_of_the_guide_annotates_files_and_writes_a_report_and_a_summary() {
    let steps: Vec<&str> = block("yaml").lines().filter_map(|line| line.trim().strip_prefix("- run: ")).collect();
    let ([install], [check]) = (&steps[..1], &steps[1..]) else { panic!("{steps:?}") };
    assert!(install.starts_with("cargo install ") && check.starts_with("rebond check "), "{steps:?}");
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("lecture")).unwrap();
    workplace.write("lecture/fall.toml", SCENE);
    workplace.done("record lecture/fall.toml -o lecture/fall.mcap");
    workplace.done("render lecture/fall.mcap -o lecture/fall.png --at 20");
    let summary = workplace.path("summary.md");
    let variables = [("GITHUB_STEP_SUMMARY", summary.to_str().unwrap())];
    let outcome = run_in(&workplace, check, &variables);
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(!outcome.output.contains("::error"), "{outcome:?}");
    workplace.write("lecture/fall.toml", &SCENE.replace("rate = 60", "rate = 50"));
    workplace.write("lecture/all.check", "\nrebond figure strobe fall.mcap -o strobe.svg\n");
    let outcome = run_in(&workplace, check, &variables);
    assert_eq!(outcome.code, 3, "{outcome:?}");
    for expected in [
        "::error file=lecture/fall.mcap,title=lecture/fall.mcap%3A drifted::drifted: it replays the same",
        "::error file=lecture/all.check,line=2,title=lecture/strobe.svg%3A missing::missing: the picture does not exist",
    ] {
        assert!(outcome.output.contains(expected), "{expected}: {outcome:?}");
    }
    let summary = fs::read_to_string(summary).unwrap();
    assert!(summary.starts_with("## rebond check\n\nsame: 1 recording, 1 picture\n"), "{summary}");
    assert!(
        summary.contains("| lecture/fall.mcap | drifted: ")
            && summary.contains("`rebond check lecture/fall.mcap --update`"),
        "{summary}"
    );
    assert_junit(&String::from_utf8(workplace.read("check.xml")).unwrap());
    assert!(workplace.path("rebond-check/index.html").is_file());
}

/// The commands of the guide, on a folder named as there.
#[test]
#[cfg(unix)]
fn the_commands_of_the_guide_run_as_they_are_written() {
    let workplace = Workplace::new();
    fs::create_dir(workplace.path("lecture")).unwrap();
    workplace.write("lecture/fall.toml", SCENE);
    workplace.write("lecture/gas.toml", SCENE);
    let manifest = GUIDE.split("```sh\n# in lecture/slides.check\n").nth(1).unwrap().split("```").next().unwrap();
    workplace.write("lecture/slides.check", manifest);
    workplace.done("record lecture/fall.toml -o lecture/fall.mcap");
    workplace.done("render lecture/fall.mcap -o lecture/fall.png --at 20");
    let commands: Vec<&str> = block("sh").lines().map(|line| line.split('#').next().unwrap().trim()).collect();
    let codes: Vec<i32> = commands.iter().map(|command| run_in(&workplace, command, &[]).code).collect();
    assert_eq!((commands.len(), codes), (4, vec![3, 0, 0, 0]), "missing at first, then accepted");
}

#[test]
fn a_review_asks_about_each_change() {
    let workplace = lecture_folder();
    let before = ["fall.png", "hit.svg"].map(|name| workplace.read(name));
    let change = |workplace: &Workplace| {
        workplace.done("render scene.mcap -o fall.png --force --at 21");
        workplace.done("figure collision scene.mcap -o hit.svg --force --caption other");
    };
    change(&workplace);
    let outcome = workplace.rebond_with_input("check . --review", "what\nreject\na\n");
    assert_eq!(outcome.code, 3, "{outcome:?}");
    assert!(outcome.errors.contains("(a)ccept, (r)eject, (s)kip or (q)uit?"), "{outcome:?}");
    assert!(workplace.read("fall.png") != before[0] && workplace.read("hit.svg") == before[1]);
    change(&workplace);
    let outcome = workplace.rebond_with_input("check . --review", "q\n");
    assert!(workplace.read("fall.png") != before[0] && workplace.read("hit.svg") != before[1], "{outcome:?}");
    assert_eq!(
        workplace.rebond_with_input("check . --review", "").code,
        3,
        "at the end of the answers, the rest is kept"
    );
    assert_eq!(workplace.rebond_with_input("check . --review", "a\na\n").code, 0);
    assert!(["fall.png", "hit.svg"].map(|name| workplace.read(name)) == before);
}
