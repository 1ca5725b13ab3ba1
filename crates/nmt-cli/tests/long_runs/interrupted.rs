//! What a run that does not end well leaves behind: nothing.

use crate::square;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

fn names(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).into_iter().flatten();
    let mut names: Vec<String> = entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Files of the run under way, those not yet in place.
fn unfinished(out: &Path) -> Vec<String> {
    let stage = names(out).into_iter().find(|name| name.starts_with(".nmt-"));
    stage.map_or_else(Vec::new, |stage| names(&out.join(stage)))
}

/// Starts the command and waits until what it has under way satisfies `is_time`.
fn start_until(arguments: &[&str], is_time: impl Fn() -> bool) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nmt"));
    let mut child =
        command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts");
    let start = Instant::now();
    while !is_time() {
        assert!(start.elapsed() < Duration::from_secs(120), "the run does not come so far");
        assert!(child.try_wait().expect("a state").is_none(), "the run has ended before");
        std::thread::sleep(Duration::from_millis(1));
    }
    child
}

fn interrupt(child: Child, signal: &str) -> Output {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill starts");
    assert!(sent.success());
    child.wait_with_output().expect("the end of the run")
}

fn has_begun(out: &Path) -> bool {
    names(out).iter().any(|name| name.starts_with(".nmt-"))
}

#[test]
fn ctrl_c_while_solving_leaves_no_directory() {
    let (directory, file) = square("interrupted-solving", 401);
    let out = directory.join("new/out");
    let child = start_until(&["solve", &file, "--out", &out.display().to_string()], || has_begun(&out));
    let output = interrupt(child, "-INT");
    assert_eq!(output.status.code(), Some(130));
    assert!(output.stdout.is_empty());
    assert_eq!(String::from_utf8_lossy(&output.stderr).trim(), "interrupted; no file was written");
    assert_eq!(names(&directory), ["square.toml"]);
}

#[test]
fn ctrl_c_while_files_are_written_leaves_those_of_the_run_before() {
    let (directory, file) = square("interrupted-writing", 301);
    let out = directory.join("out");
    std::fs::create_dir_all(&out).expect("a directory");
    for name in ["nodes.csv", "mine.txt"] {
        std::fs::write(out.join(name), "kept").expect("a file");
    }
    // Once while the first file is written, and once when several are complete.
    for complete in [0, 4] {
        let is_time = || unfinished(&out).len() > complete;
        let child = start_until(&["solve", &file, "--out", &out.display().to_string()], is_time);
        assert_eq!(interrupt(child, "-INT").status.code(), Some(130));
        assert_eq!(names(&out), ["mine.txt", "nodes.csv"]);
        assert_eq!(std::fs::read(out.join("nodes.csv")).expect("the file"), b"kept");
    }
}

#[test]
fn sigterm_cleans_up_too_and_is_told_from_ctrl_c_by_its_code() {
    let (directory, file) = square("interrupted-terminated", 401);
    let out = directory.join("out");
    let child = start_until(&["mesh", &file, "--out", &out.display().to_string()], || has_begun(&out));
    assert_eq!(interrupt(child, "-TERM").status.code(), Some(143));
    assert_eq!(names(&directory), ["square.toml"]);
}

#[test]
fn a_run_that_ends_well_puts_all_files_in_place_and_leaves_no_temporary() {
    let (directory, file) = square("interrupted-well", 15);
    let out = directory.join("out");
    for _ in 0..2 {
        let output = Command::new(env!("CARGO_BIN_EXE_nmt")).args(["nodes", &file, "--out"]).arg(&out).output();
        assert_eq!(output.expect("the command starts").status.code(), Some(0));
        assert_eq!(names(&out), ["nodes.csv", "nodes.png", "nodes.svg", "report.json"]);
    }
}

/// A limit on the size of files stands for a full disk: the system refuses a write in the midst of a file.
#[test]
fn a_file_that_cannot_be_completed_leaves_none() {
    let (directory, file) = square("interrupted-full", 61);
    let out = directory.join("out");
    let script = "trap '' XFSZ; ulimit -f 200; exec \"$0\" solve \"$1\" --out \"$2\"";
    let output = Command::new("sh").args(["-c", script, env!("CARGO_BIN_EXE_nmt"), &file]).arg(&out).output();
    let output = output.expect("a shell");
    assert_eq!(output.status.code(), Some(4));
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("cannot be written") && message.contains("nodes.csv"), "{message}");
    assert!(output.stdout.is_empty());
    assert_eq!(names(&directory), ["square.toml"]);
}

#[test]
fn an_error_leaves_the_directory_as_it_was() {
    let (directory, file) = square("interrupted-error", 15);
    let run = |arguments: &[&str], out: &Path| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_nmt"));
        command.args(arguments).arg(&file).arg("--out").arg(out).output().expect("the command starts")
    };
    // A fault that is found when the clouds are there.
    let out = directory.join("out");
    let failed = run(&["solve", "--star", "100000"], &out);
    assert_eq!(failed.status.code(), Some(1));
    assert_eq!(names(&directory), ["square.toml"]);

    // A directory stands where a file should: none of the files comes.
    std::fs::create_dir_all(out.join("nodes.svg")).expect("a directory");
    let failed = run(&["nodes"], &out);
    assert_eq!(failed.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&failed.stderr).contains("nodes.svg"));
    assert_eq!(names(&out), ["nodes.svg"]);

    // Nothing can be written there: told before the work.
    assert_eq!(run(&["nodes"], Path::new(&file)).status.code(), Some(4));
}
