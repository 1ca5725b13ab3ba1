//! Graded clouds as a user gets them: J, report, files, what is refused.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const J_OF_L: f64 = 0.856_303_210_746_053_2; // three unit squares, two independent high-order solutions to 12 digits

fn nmt(arguments: &[&str], threads: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nmt"));
    command.args(arguments).env("RAYON_NUM_THREADS", threads).output().expect("the command starts")
}

fn problem(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/problems").join(name).display().to_string()
}

/// A fresh directory below the target directory.
fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("graded-{name}"));
    let _ = std::fs::remove_dir_all(&directory);
    std::fs::create_dir_all(&directory).expect("a scratch directory");
    directory
}

/// The path of a file of one subdomain, an L with these further keys.
fn l_with(directory: &Path, keys: &str) -> String {
    let path = directory.join("l.toml");
    let outline = "outline = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]";
    std::fs::write(&path, format!("[[subdomain]]\nnodes = [21, 21]\n{keys}\n{outline}\n")).expect("a scratch file");
    path.display().to_string()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("stdout is JSON alone")
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).expect("UTF-8")
}

fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).expect("UTF-8")
}

#[test]
fn the_graded_l_reaches_two_hundred_times_the_accuracy_of_a_uniform_one() {
    let error = |arguments: &[&str]| {
        let report = json(&nmt(&[&["solve", arguments[0], "--json"], &arguments[1..]].concat(), "2"));
        let subdomain = &report["subdomains"][0];
        let nodes = subdomain["nodes"].as_u64().expect("nodes");
        (nodes, (subdomain["J"].as_f64().expect("J") / J_OF_L - 1.0).abs())
    };
    let graded = problem("graded-l.toml");
    let (n_graded, of_graded) = error(&[&graded]);
    let uniform = l_with(&scratch("uniform"), "");
    let (n_uniform, of_uniform) = error(&[&uniform, "--nodes", "55,55"]);
    assert!(n_graded < n_uniform, "{n_graded}, {n_uniform}");
    assert!(of_graded < 1e-5, "{of_graded}"); // 3.2e-6 measured
    assert!(of_uniform > 100.0 * of_graded, "{of_uniform}"); // 2.0e-3 measured
    // Stars are balanced where levels meet, unless told otherwise.
    let (_, local) = error(&[&graded, "--formulation", "local"]);
    let (_, nearest) = error(&[&graded, "--formulation", "local", "--stars", "nearest"]);
    assert!(local < 1e-4 && nearest > 3.0 * local, "{local}, {nearest}"); // 3.7e-5 and 3.7e-4 measured
}

#[test]
fn the_report_of_a_graded_cloud_reads_well() {
    let output = nmt(&["nodes", &problem("graded-l.toml")], "2");
    assert_eq!(output.status.code(), Some(0));
    insta::assert_snapshot!(std::str::from_utf8(&output.stdout).expect("UTF-8"));
}

#[test]
fn the_report_says_that_stars_are_balanced_for_the_sake_of_the_cloud_where_nobody_did() {
    let graded = problem("graded-l.toml");
    let text = |arguments: &[&str]| stdout(&nmt(&[&["solve", &graded], arguments].concat(), "2")).to_owned();
    let stars = |report: &Value| report["subdomains"][0]["stars"].clone();
    assert!(text(&[]).contains("of 9 nodes, balanced, for the cloud is graded: "), "{}", text(&[]));
    let told = text(&["--stars", "balanced"]);
    assert!(told.contains("of 9 nodes, balanced: ") && !told.contains("is graded"), "{told}");
    assert!(text(&["--stars", "nearest"]).contains("of 9 nodes, nearest: "));
    let report = json(&nmt(&["solve", &graded, "--json"], "2"));
    assert_eq!(stars(&report)["choice"], "balanced");
    assert_eq!(stars(&report)["for_graded_cloud"], true);
    let told = json(&nmt(&["solve", &graded, "--json", "--stars", "nearest"], "2"));
    assert_eq!(stars(&told)["choice"], "nearest");
    assert!(stars(&told).get("for_graded_cloud").is_none());
}

#[test]
fn the_report_tells_the_spacings_and_how_they_were_met() {
    let report = json(&nmt(&["nodes", &problem("graded-l.toml"), "--json"], "2"));
    let local = &report["subdomains"][0]["local_spacing"];
    assert_eq!((local["min"].as_f64(), local["max"].as_f64()), (Some(1e-5), Some(0.05)));
    let achieved = |key: &str| local["achieved"][key].as_f64().expect("a ratio");
    assert!(achieved("min") > 0.5 && (achieved("median") - 1.0).abs() < 0.2 && achieved("max") < 1.3);
    let uniform = json(&nmt(&["nodes", &problem("paper-1.toml"), "--json"], "2"));
    assert!(uniform["subdomains"][0].get("local_spacing").is_none());
}

#[test]
fn graded_clouds_are_the_same_to_the_bit_for_one_and_two_threads() {
    let directory = scratch("identical");
    let keys = "irregularity = 0.25\ndensity = \"0.02 + 0.1*abs(x - y)\"\nrefine = [{ point = [1, 1], size = 1e-3 }]";
    let file = l_with(&directory, keys);
    let runs = ["1", "2"].map(|threads| {
        let out = directory.join(threads);
        let output = nmt(&["solve", &file, "--out", &out.display().to_string()], threads);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        ["nodes.csv", "mesh.vtu", "nodes.svg"].map(|name| std::fs::read(out.join(name)).expect("a result"))
    });
    assert!(runs[0] == runs[1]);
}

#[test]
fn the_growth_of_a_subdomain_is_that_of_a_steep_density_and_of_refinements_without_their_own() {
    let directory = scratch("growth");
    let nodes = |keys: &str| {
        let output = nmt(&["nodes", &l_with(&directory, keys), "--json"], "2");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        json(&output)["subdomains"][0]["nodes"].as_u64().expect("a number")
    };
    let point = "refine = [{ point = [1, 1], size = 1e-3 }]";
    let own = "refine = [{ point = [1, 1], size = 1e-3, growth = 0.1 }]";
    for keys in ["density = \"max(0.01, 10*(x - 0.3))\"", point] {
        let of = |growth: &str| nodes(&format!("{keys}\n{growth}"));
        assert_eq!(of(""), of("growth = 0.3"));
        assert!(of("growth = 0.1") > of("growth = 0.3") && of("growth = 0.3") > of("growth = 0.5"), "{keys}");
    }
    assert_eq!(nodes(own), nodes(&format!("growth = 0.1\n{point}")));
    assert_eq!(nodes(own), nodes(&format!("growth = 0.4\n{own}")));
}

#[test]
fn both_ways_to_a_mesh_take_spacings_of_one_to_ten_thousand() {
    let file = l_with(&scratch("mesh"), "refine = [{ point = [1, 1], size = 1e-5 }, { edge = \"e1\", size = 0.02 }]");
    let triangles = ["constrained", "unconstrained"].map(|method| {
        let output = nmt(&["mesh", &file, "--method", method, "--json"], "2");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let report = json(&output);
        assert!(report["subdomains"][0]["quality"]["min_angle_deg"].as_f64().expect("an angle") > 20.0);
        report["subdomains"][0]["triangles"].as_u64()
    });
    assert_eq!(triangles[0], triangles[1]);
}

#[test]
fn wishes_that_change_nothing_are_told_with_a_remedy() {
    let directory = scratch("wishes");
    let warnings = |command: &str, keys: &str| {
        let file = l_with(&directory, keys);
        let output = nmt(&[command, &file, "--json"], "2");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let all = json(&output)["warnings"].as_array().expect("warnings").clone();
        let all: Vec<String> = all.iter().map(|w| w.as_str().expect("a sentence").to_owned()).collect();
        let nothing: Vec<String> = all.into_iter().filter(|w| w.contains("does nothing")).collect();
        nothing.iter().for_each(|warning| assert!(stderr(&output).contains(warning.as_str()), "{warning}"));
        nothing
    };
    // The uniform spacing is 0.1. A point may lie outside where its size still reaches in: the notch, and beside the outline.
    let useless = "density = \"0.1 + 0.05*x\"\nrefine = [{ point = [0.5, 0.5], size = 0.1 }, { edge = \"e1\", size = 0.2 }, \
                   { point = [1.4, 1.5], size = 1e-3, growth = 0.25 }, { point = [-9, 5], size = 1e-4 }]";
    insta::assert_snapshot!(warnings("solve", useless).join("\n"));
    let useful = "density = \"0.09 + 0.05*x\"\nrefine = [{ point = [0.5, 0.5], size = 0.09 }, { edge = \"e1\", size = 0.05 }, \
                  { point = [1.35, 1.5], size = 1e-3, growth = 0.25 }, { point = [-0.2, 1], size = 1e-4 }]";
    for command in ["check", "nodes", "mesh", "solve"] {
        assert_eq!(warnings(command, useful), Vec::<String>::new());
        assert_eq!(warnings(command, useless).len(), 5, "{command}");
    }
    let alone = warnings("mesh", "growth = 0.2");
    assert!(alone.len() == 1 && alone[0].contains("`growth` does nothing"), "{alone:?}");
    let output = nmt(&["solve", &l_with(&directory, "growth = 0.2"), "--tolerance", "0.05", "--json"], "1");
    assert!(output.status.code() == Some(0) && !stderr(&output).contains("does nothing"), "{}", stderr(&output));
}

#[test]
fn dips_of_a_density_are_found_however_narrow_they_are() {
    let directory = scratch("dips");
    let report = |density: &str| {
        let output = nmt(&["nodes", &l_with(&directory, &format!("density = \"{density}\"")), "--json"], "2");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let report = json(&output);
        let number = |key: &str| report["subdomains"][0][key].as_u64().expect("a number");
        let least = report["subdomains"][0]["local_spacing"]["min"].as_f64().expect("a spacing");
        (number("nodes"), least, report["warnings"].to_string())
    };
    let (even, ..) = report("0.1 + 0*x");
    let (peak, least, warnings) = report("0.1 - 0.09*exp(-((x - 0.337)^2 + (y - 0.741)^2)/1e-9)");
    assert!(peak > even + 40 && least < 0.014 && !warnings.contains("`density`"), "{peak} {least} {warnings}");
    let (crack, least, warnings) = report("0.1 - 0.09*(sign(x - 0.60001) - sign(x - 0.60002))/2");
    assert!(crack > 3 * peak && least < 0.014 && !warnings.contains("`density`"), "{crack} {least} {warnings}");
    // As a formula of the same spacing without the dips has it.
    let (wide, ..) = report("min(0.1, 0.01 + 0.3*abs(x - 0.600015))");
    assert!((0.95..1.1).contains(&(crack as f64 / wide as f64)), "{crack} {wide}");
    let (comb, .., warnings) = report("0.1 - 0.0999*exp(-(1000*sin(3.1e4*x + 0.7))^2)");
    assert!(comb < 2 * peak && warnings.contains("may have been passed over"), "{comb} {warnings}");
    assert!(!warnings.contains("does nothing"), "what was not looked into is not known: {warnings}");
}

#[test]
fn growth_alone_grades_a_cloud_towards_its_short_edges() {
    let path = scratch("growth").join("chamfer.toml");
    let outline = "outline = [[0, 0], [2, 0], [2, 1], [1.02, 1], [1, 1.02], [1, 2], [0, 2]]";
    let nodes = |keys: &str| {
        std::fs::write(&path, format!("[[subdomain]]\nnodes = [21, 21]\n{keys}\n{outline}\n")).expect("a scratch file");
        let output = nmt(&["mesh", &path.display().to_string(), "--json"], "1");
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(!stderr(&output).contains("does nothing"), "{}", stderr(&output));
        json(&output)["subdomains"][0]["nodes"].as_u64().expect("a number of nodes")
    };
    let [even, fast, slow] = ["", "growth = 0.5", "growth = 0.1"].map(nodes);
    assert!(even < fast && fast + 50 < slow, "{even} {fast} {slow}");
}

#[test]
fn what_shows_only_on_the_way_to_a_cloud_is_told_with_its_place() {
    let directory = scratch("faults");
    let fault = |keys: &str| {
        let output = nmt(&["check", &l_with(&directory, keys)], "2");
        assert_eq!(output.status.code(), Some(1), "{keys}");
        stderr(&output).replace(&directory.display().to_string(), "")
    };
    let all = [
        fault("density = \"0.3*sqrt((x - 1)^2 + (y - 1)^2)\""),
        fault("density = \"sqrt(x - 0.5)\""),
        fault("density = \"1e-5\""),
        fault("density = \"1e-9*(1 + x)\""),
    ];
    insta::assert_snapshot!(all.join("\n"));
}
