//! `replay --against`: the states of another program. The guide's engine in JavaScript and its mistakes are run as they
//! are printed there.

use crate::command_line::SCENE;
use crate::rebond::Workplace;
use std::process::Command;

const CHAPTER: &str = include_str!("../../src/guide/student-engine.md");

/// The blocks of code in `text` that are marked as `language`.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<&'a str> {
    let start = format!("```{language}\n");
    text.split(&start).skip(1).filter_map(|rest| rest.split("```").next()).collect()
}

/// Runs a program with node in the workplace and writes its output to `states.csv`.
fn run_program(workplace: &Workplace, program: &str) {
    workplace.write("engine.mjs", program);
    let run = Command::new("node").arg("engine.mjs").current_dir(workplace.path(".")).output().expect("node runs");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    workplace.write("states.csv", &String::from_utf8(run.stdout).expect("text"));
}

/// Returns true if node can be run; otherwise says that the test is skipped.
fn has_node() -> bool {
    let is_there = Command::new("node").arg("--version").output().is_ok_and(|run| run.status.success());
    if !is_there {
        eprintln!("skipped: the program node is not installed");
    }
    is_there
}

#[test]
fn the_engine_of_the_guide_is_the_same_and_its_mistakes_are_explained_as_the_guide_says() {
    if !has_node() {
        return;
    }
    let workplace = Workplace::with_scene(blocks(CHAPTER, "toml")[0]);
    workplace.done("record scene.toml -o scene.mcap");
    let [program] = blocks(CHAPTER, "js")[..] else { panic!("one program") };
    run_program(&workplace, program);
    let verdict = workplace.done("replay scene.mcap --against states.csv").output;
    assert!(CHAPTER.contains(&format!("`{}`", verdict.trim_end())), "{verdict}");
    let mistakes: Vec<&str> = CHAPTER.split("\n### ").skip(1).collect();
    assert_eq!(mistakes.len(), 5);
    for mistake in mistakes {
        let diff = blocks(mistake, "diff")[0];
        let lines = |sign| diff.lines().filter_map(|line| Some(line.strip_prefix(sign)?.to_owned() + "\n")).collect();
        let (removed, added): (String, String) = (lines('-'), lines('+'));
        assert_eq!(program.matches(&removed).count(), 1, "{mistake}");
        run_program(&workplace, &program.replace(&removed, &added));
        let outcome = workplace.rebond("replay scene.mcap --against states.csv");
        assert_eq!(outcome.code, 3, "{outcome:?}");
        assert_eq!(outcome.output, blocks(mistake, "text")[0], "{mistake}");
    }
}

fn recorded() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap");
    workplace
}

/// The exported states with another order of rows and columns.
fn shuffled(table: &str) -> String {
    let order = |row: &str| {
        let [step, _, name, x, y, vx, vy] = row.split(',').collect::<Vec<&str>>()[..] else { panic!("seven fields") };
        [vy, name, x, step, vx, y].join(",")
    };
    let mut rows: Vec<String> = table.lines().skip(1).map(order).collect();
    rows.sort();
    format!("vy,name,x,step,vx,y\n{}\n", rows.join("\n"))
}

#[test]
fn exported_states_are_the_same_in_any_order_of_rows_and_columns_and_without_some_columns() {
    let workplace = recorded();
    let table = workplace.done("export run.mcap").output;
    workplace.write("states.csv", &table);
    workplace.write("shuffled.csv", &shuffled(&table));
    let same = "same: 91 states, 7 bodies; compared x, y, vx, vy";
    for name in ["states.csv", "shuffled.csv"] {
        let outcome = workplace.done(&format!("replay run.mcap --against {name}"));
        assert_eq!(outcome.output.lines().last(), Some(same), "{name}");
    }
    let columns = |row: &str| row.split(',').take(4).collect::<Vec<&str>>().join(",") + "\n";
    let x_only = table.lines().filter(|row| !row.contains("wall")).map(columns).collect::<String>();
    let outcome = workplace.rebond_with_input("replay run.mcap --against -", &x_only);
    assert_eq!((outcome.code, outcome.output.as_str()), (0, "same: 91 states, 3 bodies; compared x\n"));
    // A thinned recording needs only the states that it has in full.
    workplace.done("record scene.toml -o thin.mcap --every 10");
    workplace.write("thin.csv", &workplace.done("export thin.mcap").output);
    workplace.done("replay thin.mcap --against thin.csv");
    workplace.done("replay thin.mcap --against states.csv");
    let outcome = workplace.rebond("replay run.mcap --against thin.csv");
    assert_eq!(outcome.code, 4);
    assert!(outcome.output.contains("no rows for steps 1 to 9 and 72 more steps; 10 states same"), "{outcome:?}");
    let [steps, times] = ["--from 30 --to 60", "--from 0.5s --to 1s"]
        .map(|range| workplace.done(&format!("replay run.mcap --against states.csv {range}")).output);
    assert!(steps.contains("same: 31 states"), "{steps}");
    assert_eq!(times, steps);
}

#[test]
fn the_first_differing_number_is_found_with_its_distance_in_ulps() {
    let workplace = recorded();
    let table = workplace.done("export run.mcap").output;
    let row = table.lines().find(|row| row.starts_with("50,") && row.contains(",c,")).unwrap().to_owned();
    let fields: Vec<&str> = row.split(',').collect();
    let vx: f64 = fields[5].parse().unwrap();
    let next = f64::from_bits(vx.to_bits() + 2);
    let changed = row.replace(&format!(",{},", fields[5]), &format!(",{next:?},"));
    workplace.write("states.csv", &table.replace(&row, &changed));
    let outcome = workplace.rebond("replay run.mcap --against states.csv --json");
    let verdict: serde_json::Value = serde_json::from_str(&outcome.output).unwrap();
    let found = &verdict["divergence"];
    assert_eq!(outcome.code, 3);
    assert_eq!(
        (found["step"].as_u64(), found["body"].as_str(), found["field"].as_str()),
        (Some(50), Some("c"), Some("vx"))
    );
    assert_eq!(
        (found["ulps"].as_u64(), found["recorded"].as_f64(), found["given"].as_f64()),
        (Some(2), Some(vx), Some(next))
    );
    assert_eq!((verdict["same_states"].as_u64(), verdict["states"].as_u64()), (Some(90), Some(91)));
    assert_eq!(verdict["last_event"], "spawn \"late\" at step 30");
    workplace.done("replay run.mcap --against states.csv --tolerance 1e-12");
    assert_eq!(workplace.rebond("replay run.mcap --against states.csv --tolerance 0").code, 3);
}

#[test]
fn bodies_that_are_missing_or_unknown_are_differences() {
    let workplace = recorded();
    let table = workplace.done("export run.mcap").output;
    let without =
        |part: &str| table.lines().filter(|row| !row.contains(part)).map(|row| format!("{row}\n")).collect::<String>();
    let last = |table: &str| {
        workplace.write("states.csv", table);
        let outcome = workplace.rebond("replay run.mcap --against states.csv");
        assert_eq!(outcome.code, 3, "{outcome:?}");
        outcome.output.lines().last().unwrap_or_default().to_owned()
    };
    let missing = last(&without(",late,"));
    assert!(missing.starts_with("diverged at step 30: the table has no row for body \"late\""), "{missing}");
    let unknown = last(&format!("{table}70,{},late,0.0,0.0,0.0,0.0\n", 70.0 / 60.0));
    assert!(unknown.starts_with("diverged at step 70: the table has body \"late\" on line "), "{unknown}");
}

#[test]
fn a_comparison_is_a_junit_report() {
    let workplace = recorded();
    workplace.write("states.csv", &workplace.done("export run.mcap").output);
    workplace.write("wrong.csv", "step,name,x\n0,c,undefined\n");
    workplace.write("other.csv", "step,name,x\n0,c,7\n0,#2,5\n");
    for (name, code, element) in [
        ("states", 0, "<testcase classname=\"run.mcap\" name=\"states.csv\" time=\"0\"/>"),
        (
            "wrong",
            1,
            "<error type=\"error\" message=\"wrong.csv: line 2: x is &quot;undefined&quot;; expected a number\"/>",
        ),
        (
            "other",
            3,
            "<failure type=\"difference\" message=\"diverged at step 0: body &quot;c&quot; x recorded 1.0 given 7.0",
        ),
    ] {
        let outcome = workplace.rebond(&format!("replay run.mcap --against {name}.csv --junit {name}.xml"));
        assert_eq!(outcome.code, code, "{outcome:?}");
        let report = String::from_utf8(workplace.read(&format!("{name}.xml"))).unwrap();
        assert!(report.contains(element), "{report}");
    }
    let report = workplace.read("states.xml");
    workplace.rebond("replay run.mcap --against other.csv --junit states.xml");
    assert_ne!(workplace.read("states.xml"), report, "an earlier report is replaced");
    workplace.done("replay run.mcap --against states.csv --junit states.xml");
    assert_eq!(workplace.read("states.xml"), report);
    workplace.write("notes.txt", "my notes");
    let refused = workplace.rebond("replay run.mcap --against states.csv --junit notes.txt");
    assert!(refused.code == 1 && workplace.read("notes.txt") == b"my notes", "{refused:?}");
    workplace.done("replay run.mcap --against states.csv --junit notes.txt --force");
    assert_eq!(workplace.read("notes.txt"), report);
    let refused = workplace.rebond("replay run.mcap --against states.csv --junit states.csv --force");
    assert!(refused.code == 1 && refused.errors.contains("reads this file"), "{refused:?}");
    assert_eq!(workplace.rebond("replay run.mcap --junit x.xml").code, 2);
}
