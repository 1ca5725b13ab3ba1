//! `nmt compare` as a user runs it: the table, the files, what it refuses.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const EXACT: &str = "0.1405770149551537"; // unit square, by its series

fn compare(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nmt")).arg("compare").args(arguments).output().expect("the command starts")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("output is UTF-8")
}

/// A fresh directory below the target directory, and in it the file of a unit square.
fn square(name: &str) -> (PathBuf, String) {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("compare-{name}"));
    let _ = std::fs::remove_dir_all(&directory);
    std::fs::create_dir_all(&directory).expect("a scratch directory");
    let path = directory.join("square.toml");
    let problem = "title = \"Unit square\"\n[[subdomain]]\nnodes = [15, 15]\nirregularity = 0.25\n\
                   rectangle = { from = [0, 0], to = [1, 1] }\n";
    std::fs::write(&path, problem).expect("a scratch file");
    (directory, path.display().to_string())
}

/// The table without its last column, the seconds.
fn timeless(table: &str) -> String {
    let shown = |line: &str| match line.rsplit_once("  ") {
        Some((rest, last)) if last == "seconds" || last.trim().parse::<f64>().is_ok() => rest.trim_end().to_owned(),
        _ => line.to_owned(),
    };
    table.lines().map(shown).collect::<Vec<_>>().join("\n")
}

/// The rows without their seconds.
fn timeless_rows(json: &[u8]) -> Value {
    let mut value: Value = serde_json::from_slice(json).expect("JSON");
    for row in value["rows"].as_array_mut().expect("rows") {
        let seconds = row.as_object_mut().and_then(|row| row.remove("seconds"));
        assert!(seconds.and_then(|s| s.as_f64()).is_some_and(|s| s > 0.0));
    }
    value
}

#[test]
fn the_table_reads_well() {
    let (_, file) = square("table");
    let output = compare(&[&file, "--nodes", "9,9", "--nodes", "15,15", "--exact-J", EXACT]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    insta::assert_snapshot!(timeless(text(&output.stdout)));
}

#[test]
fn orders_that_a_small_cloud_cannot_carry_are_marked() {
    let (_, file) = square("small");
    let output = compare(&[&file, "--nodes", "3,3"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    assert!(table.contains("local 4 * ") && table.contains("* some stars are of a lower order"), "{table}");
    assert!(!table.contains("local 2 *"), "{table}");
}

#[test]
fn the_files_are_the_same_in_two_runs_but_for_the_times() {
    let (directory, file) = square("files");
    let runs = ["first", "second"].map(|run| {
        let out = directory.join(run);
        let shown = out.display().to_string();
        let output =
            compare(&[&file, "--exact-J", EXACT, "--nodes", "9,9", "--nodes", "15,15", "--out", &shown, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert_eq!(output.stdout, std::fs::read(out.join("compare.json")).expect("compare.json"));
        out
    });
    let read = |run: &Path, name: &str| std::fs::read(run.join(name)).expect("a result");
    for name in ["compare-unknowns.svg", "compare-unknowns.png"] {
        assert!(read(&runs[0], name) == read(&runs[1], name), "{name} differs");
    }
    let rows = [0, 1].map(|run| timeless_rows(&read(&runs[run], "compare.json")));
    assert_eq!(rows[0], rows[1]);
    assert_eq!(rows[0]["rows"].as_array().map(Vec::len), Some(20));
    assert!(read(&runs[0], "compare-time.png").starts_with(b"\x89PNG"));
}

#[test]
fn without_an_exact_j_there_are_no_pictures() {
    let (directory, file) = square("no-pictures");
    let out = directory.join("out");
    assert_eq!(compare(&[&file, "--out", &out.display().to_string()]).status.code(), Some(0));
    let names: Vec<_> = std::fs::read_dir(out).expect("results").map(|e| e.expect("an entry").file_name()).collect();
    assert_eq!(names, ["compare.json"]);
}

#[test]
fn methods_that_fail_end_in_exit_code_3_and_the_table_has_the_others() {
    let (directory, _) = square("failed");
    // Four nodes: too few for a polynomial of order 2, enough for finite elements.
    let file = directory.join("triangle.toml");
    let edge = "{ line = true, nodes = 2 }";
    let problem =
        format!("[[subdomain]]\nnodes = [3, 3]\noutline = [[0, 0], {edge}, [1, 0], {edge}, [0.5, 0.9], {edge}]\n");
    for more in ["", "[solve]\nsource = \"1\"\n"] {
        std::fs::write(&file, format!("{problem}{more}")).expect("a scratch file");
        let out = directory.join("out");
        let output = compare(&[&file.display().to_string(), "--out", &out.display().to_string()]);
        assert_eq!(output.status.code(), Some(3));
        assert!(text(&output.stderr).contains("5 of 10 rows could not be solved"), "{}", text(&output.stderr));
        let table = text(&output.stdout);
        assert!(table.contains("  fem                                    1 "), "{table}");
        assert_eq!(table.matches("failed: the star of ").count(), 5, "{table}");
        let json: Value =
            serde_json::from_slice(&std::fs::read(out.join("compare.json")).expect("rows")).expect("JSON");
        let with_error = json["rows"].as_array().expect("rows").iter().filter(|row| row["error"].is_string()).count();
        assert_eq!(with_error, 5);
    }
}

#[test]
fn a_poisson_problem_has_its_errors_in_the_table_and_its_pictures() {
    let directory = square("poisson").0;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/problems/poisson-square.toml");
    let (file, out) = (file.display().to_string(), directory.join("out"));
    let output = compare(&[&file, "--nodes", "15,15", "--nodes", "21,21", "--out", &out.display().to_string()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    insta::assert_snapshot!("poisson_table", timeless(text(&output.stdout)));
    for name in ["compare.json", "compare-unknowns.svg", "compare-unknowns.png", "compare-time.svg", "compare-time.png"]
    {
        assert!(out.join(name).is_file(), "{name}");
    }
    assert_eq!(compare(&[&file, "--exact-J", "1"]).status.code(), Some(2));
}

#[test]
fn what_does_not_suit_is_refused() {
    let (_, file) = square("refused");
    let two = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/problems/paper-1.toml").display().to_string();
    let output = compare(&[&two, "--exact-J", "2.25"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("the problem has 2 subdomains"), "{}", text(&output.stderr));
    assert!(output.stdout.is_empty());
    for exact in ["0", "-1", "nan", "inf", "much"] {
        assert_eq!(compare(&[&file, "--exact-J", exact]).status.code(), Some(2), "{exact}");
    }
    assert_eq!(compare(&[&file, "--nodes", "15"]).status.code(), Some(2));
    assert_eq!(compare(&[&file, "--nodes", "15,15", "--nodes", "1,15"]).status.code(), Some(1));
    assert_eq!(compare(&[&file, "--nodes", "2,2", "--json"]).status.code(), Some(1));
    assert_eq!(compare(&["no-such-file.toml"]).status.code(), Some(4));
}
