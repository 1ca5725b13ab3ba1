//! Error estimates and tolerances as a user gets them: report, files, steps, exit codes.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const J_OF_L: f64 = 0.856_303_210_746_053_2; // three unit squares, two independent high-order solutions to 12 digits

fn nmt(arguments: &[&str], threads: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nmt"));
    command.args(arguments).env("RAYON_NUM_THREADS", threads).output().expect("the command starts")
}

/// A fresh directory below the target directory, with an L in it.
fn scratch(name: &str) -> (PathBuf, String) {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("tolerance-{name}"));
    let _ = std::fs::remove_dir_all(&directory);
    std::fs::create_dir_all(&directory).expect("a scratch directory");
    let file = directory.join("l.toml");
    let outline = "outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]";
    std::fs::write(&file, format!("[[subdomain]]\nnodes = [21, 21]\nirregularity = 0.2\n{outline}\n")).expect("a file");
    (directory, file.display().to_string())
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("stdout is JSON alone")
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("UTF-8")
}

#[test]
fn a_tolerance_is_reached_step_by_step_with_the_same_files_for_any_number_of_threads() {
    let (directory, file) = scratch("reached");
    let run = |threads: &str| {
        let out = directory.join(threads);
        let arguments = ["solve", &file, "--tolerance", "1e-4", "--json", "--out", &out.display().to_string()];
        let output = nmt(&arguments, threads);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        (output, out)
    };
    let (output, out) = run("1");
    let report = json(&output);
    let subdomain = &report["subdomains"][0];
    let number = |value: &Value| value.as_f64().expect("a number");
    assert!((number(&subdomain["J"]) / J_OF_L - 1.0).abs() < 1e-4);
    let [low, high] = [0, 1].map(|k| number(&subdomain["error_estimate"]["J_bounds"][k]));
    assert!(low < J_OF_L && J_OF_L < high);
    assert!(subdomain["error_estimate"]["tau_max"].is_null()); // infinite at the corner
    let steps = subdomain["tolerance"]["steps"].as_array().expect("steps");
    assert!(subdomain["tolerance"]["reached"] == true && (2..8).contains(&steps.len()));
    // Each step is told while it works, on stderr.
    let told = text(&output.stderr).lines().filter(|line| line.contains("nodes, J = ")).count();
    assert_eq!(told, steps.len());
    assert!(steps.iter().all(|step| number(&step["seconds"]) > 0.0));
    assert_eq!(steps.last().map(|step| &step["nodes"]), Some(&subdomain["nodes"]));
    for picture in ["error.svg", "error.png", "nodes.svg", "mesh.vtu"] {
        assert!(out.join(picture).exists(), "{picture}");
    }
    let read = |out: &Path, name: &str| std::fs::read(out.join(name)).expect("a file");
    assert!(text(&read(&out, "mesh.vtu")).contains("Name=\"error_indicator\""));
    let (_, other) = run("2");
    for name in ["nodes.csv", "mesh.vtu", "error.svg"] {
        assert!(read(&out, name) == read(&other, name), "{name} depends on the number of threads");
    }
}

#[test]
fn a_tolerance_out_of_reach_ends_with_exit_3_and_the_best_answer() {
    let (directory, file) = scratch("missed");
    let out = directory.join("out");
    let limits = ["--tolerance", "1e-9", "--max-nodes", "2000"];
    let output = nmt(&[&["solve", &file, "--out", &out.display().to_string()], &limits[..]].concat(), "2");
    assert_eq!(output.status.code(), Some(3));
    let stderr = text(&output.stderr);
    assert!(stderr.contains("the tolerance 1e-9 is not reached") && stderr.contains("--max-nodes"), "{stderr}");
    let stdout = text(&output.stdout);
    assert!(stdout.contains("1e-9 of J, not reached on") && stdout.contains("J by bounds"), "{stdout}");
    assert!(stdout.contains("the next cloud would have more than 2000 nodes"), "{stdout}");
    assert!(out.join("report.json").exists() && out.join("solution.svg").exists());
}

#[test]
fn no_estimate_leaves_it_out_everywhere() {
    let (directory, file) = scratch("without");
    let out = directory.join("out");
    let output = nmt(&["solve", &file, "--no-estimate", "--json", "--out", &out.display().to_string()], "2");
    let subdomain = &json(&output)["subdomains"][0];
    assert!(subdomain.get("error_estimate").is_none() && subdomain["seconds"].get("estimate").is_none());
    assert!(!out.join("error.svg").exists());
    assert!(!text(&std::fs::read(out.join("mesh.vtu")).expect("a file")).contains("error_indicator"));
}

#[test]
fn what_does_not_go_with_a_tolerance_is_told() {
    let (directory, file) = scratch("faults");
    let holed = directory.join("holed.toml");
    let shapes = "[[subdomain]]\nnodes = [21, 21]\nrectangle = { from = [0, 0], to = [2, 2] }\ndivision = \"chord\"\n\
                  [[subdomain.hole]]\ncircle = { centre = [1, 1], radius = 0.4 }\n";
    std::fs::write(&holed, format!("{shapes}[solve]\ntolerance = 0.5\n")).expect("a file");
    let holed = holed.display().to_string();
    let cases: [(&[&str], &str); 5] = [
        (&[&file, "--no-estimate", "--tolerance", "1e-4"], "no error is estimated"),
        (&[&file, "--tolerance", "0"], "outside [1e-12, 0.1]"),
        (&[&file, "--max-nodes", "100"], "belongs to a `tolerance`"),
        (&[&file, "--source", "1", "--tolerance", "1e-3"], "belongs to torsion"),
        (&[&holed, "--tolerance", "1e-3"], "division = \"chord\" of subdomain \"s1\" belongs to uniform ones"),
    ];
    for (arguments, message) in cases {
        let output = nmt(&[&["solve"], arguments].concat(), "1");
        let stderr = text(&output.stderr);
        assert!(output.status.code() == Some(1) && stderr.contains(message), "{arguments:?}: {stderr}");
    }
}

#[test]
fn f_may_be_0_on_holes() {
    let (directory, _) = scratch("zero");
    let holed = directory.join("holed.toml");
    let problem = "[[subdomain]]\nnodes = [21, 21]\nrectangle = { from = [0, 0], to = [2, 2] }\n\
                   [[subdomain.hole]]\ncircle = { centre = [1, 1], radius = 0.5 }\n[solve]\nholes = \"zero\"\n";
    std::fs::write(&holed, problem).expect("a file");
    let output = nmt(&["solve", &holed.display().to_string(), "--tolerance", "1e-3", "--json"], "2");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("2∫F is not the torsion constant"), "{}", text(&output.stderr));
    let subdomain = &json(&output)["subdomains"][0];
    let (j, estimate) = (subdomain["J"].as_f64().expect("J"), subdomain["error_estimate"]["J"].as_f64().expect("one"));
    assert!(estimate < 1e-3 * j && (j - 0.388_725_964).abs() < estimate, "{j} {estimate}");
}
