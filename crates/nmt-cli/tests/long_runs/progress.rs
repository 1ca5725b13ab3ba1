//! The bar of progress: on a terminal after a second, nowhere else. The terminal is that of `script`, of util-linux.

use crate::square;
use std::path::Path;
use std::process::{Command, Output};

/// What the command writes to a terminal on stderr; stdout goes to a file, whose text comes second.
fn on_a_terminal(directory: &Path, arguments: &str) -> (String, String) {
    let out = directory.join("stdout.txt");
    let command = format!("'{}' {arguments} > '{}'", env!("CARGO_BIN_EXE_nmt"), out.display());
    let log = directory.join("terminal.txt");
    let status = Command::new("script")
        .args(["-q", "-e", "-c", &command])
        .arg(&log)
        .env("TERM", "xterm")
        .env_remove("NO_COLOR")
        .stdout(std::process::Stdio::null())
        .status();
    assert!(status.expect("script, of util-linux, starts").success());
    let log = std::fs::read_to_string(log).expect("what the terminal got");
    let shown: Vec<&str> = log.lines().filter(|line| !line.starts_with("Script ")).collect();
    (shown.join("\n"), std::fs::read_to_string(out).expect("stdout"))
}

fn without_a_terminal(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nmt")).args(arguments).output().expect("the command starts")
}

#[test]
fn a_long_run_shows_its_stages_on_a_terminal_and_nothing_of_them_on_stdout() {
    let (directory, file) = square("progress-long", 501);
    let out = directory.join("out");
    let (shown, stdout) = on_a_terminal(&directory, &format!("solve '{file}' --json --out '{}'", out.display()));
    // What comes before the first second is up depends on the machine.
    for part in ["recovery and results", " nodes", "files"] {
        assert!(shown.contains(part), "{part} is not in {shown}");
    }
    assert!(stdout.starts_with('{') && stdout.ends_with("}\n"));
    assert!(!stdout.contains("iteration 1,") && !stdout.contains('\u{1b}'));
    // The line is cleared in the end.
    assert!(shown.trim_end().ends_with("\u{1b}[2K"), "{shown}");
}

#[test]
fn the_option_and_a_short_run_show_nothing() {
    let (directory, file) = square("progress-none", 301);
    let (shown, stdout) = on_a_terminal(&directory, &format!("solve '{file}' --no-progress"));
    assert_eq!(shown, "");
    assert!(stdout.contains("J = T/(Gθ)"));
    let (shown, _) = on_a_terminal(&directory, &format!("check '{file}' --nodes 15,15"));
    assert_eq!(shown, "");
}

#[test]
fn without_a_terminal_nothing_is_written() {
    let (_, file) = square("progress-piped", 401);
    let output = without_a_terminal(&["solve", &file]);
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}
