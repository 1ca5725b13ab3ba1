//! The command as a user runs it: exit codes, streams, files, identical bytes.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn nmt(arguments: &[&str]) -> Output {
    nmt_with_threads(arguments, "2")
}

fn nmt_with_threads(arguments: &[&str], threads: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nmt"));
    command.args(arguments).env("RAYON_NUM_THREADS", threads).output().expect("the command starts")
}

fn problem(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/problems").join(name).display().to_string()
}

/// A fresh directory below the target directory.
fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&directory);
    std::fs::create_dir_all(&directory).expect("a scratch directory");
    directory
}

fn file(directory: &Path, name: &str, text: &str) -> String {
    let path = directory.join(name);
    std::fs::write(&path, text).expect("a scratch file");
    path.display().to_string()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("stdout is JSON alone")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("output is UTF-8")
}

/// The report without the three keys that hold clock and memory.
fn timeless(value: &Value) -> Value {
    match value {
        Value::Object(map) => {
            let kept = map.iter().filter(|(key, _)| !["seconds", "peak_rss_mb", "threads"].contains(&key.as_str()));
            Value::Object(kept.map(|(key, value)| (key.clone(), timeless(value))).collect())
        }
        Value::Array(list) => Value::Array(list.iter().map(timeless).collect()),
        other => other.clone(),
    }
}

#[test]
fn paper_1_at_41_has_the_torsion_constants_of_its_series_and_warns_that_each_is_alone() {
    let output = nmt(&["solve", &problem("paper-1.toml"), "--nodes", "41,41", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let report = json(&output);
    // Square of side 2 and right isosceles triangle of leg 2, by their series.
    for (k, reference) in [2.249_232_239_28, 0.417_434_427_38].into_iter().enumerate() {
        let j = report["subdomains"][k]["J"].as_f64().expect("J");
        assert!((j / reference - 1.0).abs() < 3e-5, "{j}"); // 1e-5 measured
    }
    assert!(text(&output.stderr).contains("solved each alone"), "{}", text(&output.stderr));
}

#[test]
fn every_file_is_the_same_to_the_bit_for_one_and_two_threads_and_in_two_runs() {
    let directory = scratch("identical");
    let runs = ["1", "2", "2"].map(|threads| {
        let out = directory.join(format!("run-{threads}-{}", std::fs::read_dir(&directory).expect("dir").count()));
        let shown = out.display().to_string();
        let arguments = ["solve", &problem("paper-2.toml"), "--nodes", "31,31", "--out", &shown, "--json"];
        assert_eq!(nmt_with_threads(&arguments, threads).status.code(), Some(0));
        out
    });
    let names = [
        "nodes.csv",
        "mesh.vtu",
        "mesh.msh",
        "stars.json",
        "edges.csv",
        "nodes.svg",
        "mesh.svg",
        "solution.svg",
        "edges.svg",
        "nodes.png",
        "mesh.png",
        "solution.png",
        "edges.png",
    ];
    let read = |run: &PathBuf, name: &str| std::fs::read(run.join(name)).expect("a result");
    for run in &runs[1..] {
        for name in names {
            assert!(read(&runs[0], name) == read(run, name), "{name} differs");
        }
        let report = |run: &PathBuf| -> Value { serde_json::from_slice(&read(run, "report.json")).expect("JSON") };
        assert_eq!(timeless(&report(&runs[0])), timeless(&report(run)));
    }
}

#[test]
fn nodes_and_mesh_stop_earlier_and_write_their_own_files() {
    let directory = scratch("earlier");
    for (command, files) in [
        ("nodes", &["nodes.csv", "nodes.svg", "nodes.png", "report.json"][..]),
        (
            "mesh",
            &[
                "nodes.csv",
                "mesh.vtu",
                "mesh.msh",
                "nodes.svg",
                "nodes.png",
                "quality.svg",
                "quality.png",
                "mesh.svg",
                "mesh.png",
                "report.json",
            ][..],
        ),
    ] {
        let out = directory.join(command);
        let shown = out.display().to_string();
        let output = nmt(&[command, &problem("paper-4.toml"), "--nodes", "21,11", "--out", &shown, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let mut found: Vec<String> = std::fs::read_dir(&out)
            .expect("results")
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        found.sort();
        let mut wanted: Vec<String> = files.iter().map(|f| (*f).to_owned()).collect();
        wanted.sort();
        assert_eq!(found, wanted);
        let report = json(&output);
        assert_eq!(report["subdomains"][0].get("J"), None);
        assert_eq!(report["subdomains"][0].get("triangles").is_some(), command == "mesh");
        let csv = std::fs::read_to_string(out.join("nodes.csv")).expect("nodes.csv");
        assert!(csv.starts_with("subdomain,node,x,y,kind,edges\n"));
    }
}

#[test]
fn smoothing_is_reported_with_the_quality_before_and_after() {
    let output = nmt(&["mesh", &problem("paper-4.toml"), "--nodes", "21,11", "--smooth", "3", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let part = &json(&output)["subdomains"][0];
    assert_eq!(part["smoothing"]["sweeps"], 3);
    let mean = |quality: &serde_json::Value| quality["mean"].as_f64().expect("a number");
    assert!(mean(&part["quality"]) > mean(&part["smoothing"]["quality_before"]), "{part}");
}

#[test]
fn check_gives_the_census_of_a_solve_and_warns_of_thin_parts() {
    let directory = scratch("check");
    let thin = file(
        &directory,
        "thin.toml",
        "[[subdomain]]\nnodes = [81, 41]\nrectangle = { from = [0, 0], to = [4, 2] }\n\
         [[subdomain.hole]]\nrectangle = { from = [0.1, 0.1], to = [3.9, 1.9] }\n",
    );
    let check = nmt(&["check", &thin, "--json"]);
    assert_eq!(check.status.code(), Some(0));
    assert!(text(&check.stderr).contains("only 3 nodes across its thinnest part"), "{}", text(&check.stderr));
    let solve = nmt(&["solve", &thin, "--json"]);
    assert_eq!(json(&check)["subdomains"][0]["census"], json(&solve)["subdomains"][0]["census"]);
}

#[test]
fn exit_codes_tell_whose_fault_it_is() {
    let directory = scratch("codes");
    let wrong =
        file(&directory, "wrong.toml", "[[subdomain]]\nnodes = [1, 5]\ncircle = { centre = [0, 0], radius = -1 }\n");
    let output = nmt(&["solve", &wrong]);
    assert_eq!(output.status.code(), Some(1));
    let stderr = text(&output.stderr);
    assert!(stderr.contains("2 faults") && stderr.contains(":2:") && stderr.contains(":3:"), "{stderr}");
    assert!(output.stdout.is_empty());

    let coarse =
        file(&directory, "coarse.toml", "[[subdomain]]\nnodes = [2, 2]\nrectangle = { from = [0, 0], to = [1, 1] }\n");
    let output = nmt(&["solve", &coarse, "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let stderr = text(&output.stderr);
    assert!(stderr.contains("no interior node") && stderr.contains("nodes = [3, 3] would give some"), "{stderr}");
    assert!(output.stdout.is_empty(), "with --json stdout is JSON or empty");

    std::fs::write(directory.join("binary.toml"), [b'a', 0xff, 0xfe]).expect("a scratch file");
    let binary = directory.join("binary.toml").display().to_string();
    assert_eq!(nmt(&["check", &binary]).status.code(), Some(1));
    assert_eq!(nmt(&["solve", "no-such-file.toml"]).status.code(), Some(4));
    assert_eq!(nmt(&["solve"]).status.code(), Some(2));
    assert_eq!(nmt(&["solve", &coarse, "--nodes", "41"]).status.code(), Some(2));
    assert_eq!(nmt(&["solve", &coarse, "--nodes", "21,21", "--order", "7"]).status.code(), Some(1));
    assert_eq!(nmt(&["solve", &coarse, "--nodes", "5,5", "--star", "99"]).status.code(), Some(1));
    let blocked = file(&directory, "not-a-directory", "");
    assert_eq!(nmt(&["nodes", &coarse, "--nodes", "5,5", "--out", &blocked]).status.code(), Some(4));
    assert_eq!(nmt(&["--version"]).status.code(), Some(0));
}

#[test]
fn points_are_reported_in_order_on_the_boundary_too_and_outside_as_null() {
    let output = nmt(&[
        "solve",
        &problem("paper-1.toml"),
        "--nodes",
        "21,21",
        "--json",
        "--at",
        "1,1",
        "--at",
        "2,1",
        "--at",
        "-0.5,0.2",
        "--at",
        "3,1",
    ]);
    assert_eq!(output.status.code(), Some(0));
    let report = json(&output);
    let points = report["points"].as_array().expect("points");
    let names: Vec<_> = points.iter().map(|p| p["subdomain"].as_str()).collect();
    let first = report["subdomains"][0]["name"].as_str();
    let second = report["subdomains"][1]["name"].as_str();
    // On the common edge the first subdomain of the file; the last point lies on the triangle's long side.
    assert_eq!(names, [first, first, None, second]);
    assert!(points[2]["F"].is_null() && points[2]["tau"].is_null());
    assert!(points[1]["F"].as_f64().is_some_and(|f| f.abs() < 1e-12));
    assert!(text(&output.stderr).contains("outside every subdomain"));
}

#[test]
fn zero_on_holes_is_named_in_the_report_and_warned_of() {
    let directory = scratch("zero");
    let ring = file(
        &directory,
        "ring.toml",
        "[[subdomain]]\nnodes = [81, 81]\ncircle = { centre = [0, 0], radius = 1 }\n\
         [[subdomain.hole]]\nname = \"bore\"\ncircle = { centre = [0, 0], radius = 0.5 }\n",
    );
    // Closed forms of the ring.
    for (holes, reference, warned) in [("circulation", 1.472_621_556_37, false), ("zero", 0.197_895_266_48, true)] {
        for formulation in ["local", "variational"] {
            let output = nmt(&["solve", &ring, "--holes", holes, "--formulation", formulation, "--json"]);
            let report = json(&output);
            let subdomain = &report["subdomains"][0];
            let j = subdomain["J"].as_f64().expect("J");
            assert!((j / reference - 1.0).abs() < 1e-4, "{holes} {formulation} {j}"); // 1e-5 measured
            assert_eq!(subdomain["holes"][0]["condition"], holes);
            let warning = text(&output.stderr).contains("2∫F is not the torsion constant");
            assert_eq!(warning, warned);
            let unknowns = subdomain["unknowns"].as_u64().expect("unknowns");
            let interior =
                subdomain["nodes"].as_u64().expect("nodes") - subdomain["boundary_nodes"].as_u64().expect("nodes");
            assert_eq!(unknowns, interior + u64::from(holes == "circulation"));
        }
    }
}

/// Subdomains of side 1 in a row, the first two side by side and the third apart.
fn row_of_squares(n: usize, solve: &str) -> String {
    let square =
        |x: usize| format!("[[subdomain]]\nnodes = [9, 9]\nrectangle = {{ from = [{x}, 0], to = [{}, 1] }}\n", x + 1);
    [0, 1, 3].into_iter().take(n).map(square).collect::<String>() + solve
}

#[test]
fn only_subdomains_with_common_edges_are_said_not_to_add_up() {
    let directory = scratch("alone");
    let stderr_of = |name: &str, text_of_file: &str, command: &str| {
        let output = nmt(&[command, &file(&directory, name, text_of_file)]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stderr)
    };
    for command in ["check", "solve"] {
        let stderr = stderr_of("three.toml", &row_of_squares(3, ""), command);
        assert!(
            stderr.contains("subdomains \"s1\" and \"s2\" have common edges, and are solved each alone"),
            "{stderr}"
        );
        assert!(!stderr.contains("torque"), "{stderr}");
        // Bars apart: each is solved as it is, and their torques under one twist add up.
        let apart = row_of_squares(3, "").replace("[1, 0], to = [2, 1]", "[1.5, 0], to = [2.5, 1]");
        assert_eq!(stderr_of("apart.toml", &apart, command), "");
        let stderr = stderr_of("torque.toml", &(apart + "[solve]\ntorque = 2\n"), command);
        assert!(stderr.contains("each of the 3 subdomains carries the torque"), "{stderr}");
        assert_eq!(stderr_of("one.toml", &row_of_squares(1, "[solve]\ntorque = 2\n"), command), "");
    }
}

#[test]
fn reports_of_several_subdomains_say_that_each_is_solved_alone_whether_they_touch_or_not() {
    let directory = scratch("each-alone");
    let (touching, one) = (row_of_squares(2, ""), row_of_squares(1, ""));
    let apart = touching.replace("[1, 0], to = [2, 1]", "[1.5, 0], to = [2.5, 1]");
    let poisson = "[solve]\nsource = \"-2\"\n";
    let said = |name: &str, problem: &str, command: &str| {
        let path = file(&directory, name, problem);
        let report = json(&nmt(&[command, &path, "--json"]));
        let each = report.get("each_alone").map(|each| each.as_str().expect("a sentence").to_owned());
        let output = text(&nmt(&[command, &path]).stdout);
        assert_eq!(output.contains("Subdomains: each subdomain is solved alone"), each.is_some(), "{output}");
        assert!(each.as_ref().is_none_or(|each| output.contains(&format!("Subdomains: {each}."))), "{output}");
        each
    };
    for command in ["check", "solve"] {
        for problem in [&touching, &apart] {
            let torsion = said("torsion.toml", problem, command).expect("two subdomains");
            assert!(torsion.contains("add up under one twist"), "{torsion}");
            let each = said("poisson.toml", &format!("{problem}{poisson}"), command).expect("two subdomains");
            assert!(each.contains("nothing joins u of one to u of another"), "{each}");
        }
        assert_eq!(said("one.toml", &one, command), None);
    }
    assert_eq!(said("mesh.toml", &apart, "mesh"), None); // nothing is solved
}

#[test]
fn three_parts_have_the_same_nodes_on_both_sides_of_all_common_edges_since_two_are_conforming() {
    let directory = scratch("conforming");
    let file_text = std::fs::read_to_string(problem("three-parts.toml")).expect("a problem that ships");
    let own = file(&directory, "own.toml", &file_text.replace("conforming = true", "conforming = false"));
    let common = |problem: &str| {
        let report = json(&nmt(&["nodes", problem, "--json"]));
        report["common_edges"].as_array().expect("several subdomains").clone()
    };
    let names =
        |edge: &Value| (edge["between"].clone(), edge["edges"].clone(), edge["from"].clone(), edge["to"].clone());
    let (conforming, own) = (common(&problem("three-parts.toml")), common(&own));
    assert_eq!(conforming.len(), 2);
    assert_eq!(conforming.iter().map(names).collect::<Vec<_>>(), own.iter().map(names).collect::<Vec<_>>());
    assert_eq!(conforming[0]["between"], serde_json::json!(["arch", "head"]));
    assert_eq!(conforming[1]["edges"], serde_json::json!(["bore/e1", "e1"]));
    for edge in &conforming {
        assert_eq!((&edge["nodes"][0], &edge["conforming"]), (&edge["nodes"][1], &Value::Bool(true)), "{edge}");
        assert!(edge["nodes"][0].as_u64() > Some(2), "{edge}");
    }
    for edge in &own {
        assert_eq!(edge["conforming"], false);
        assert_ne!(edge["nodes"][0], edge["nodes"][1], "{edge}");
    }
}

#[test]
fn common_edges_are_reported_where_there_are_several_subdomains() {
    let paper_1 = problem("paper-1.toml");
    // Two densities side by side, as in the paper.
    let square_and_triangle = serde_json::json!([{
        "between": ["square", "triangle"], "edges": ["e2", "e3"], "from": [2.0, 0.0], "to": [2.0, 2.0],
        "nodes": [41, 61], "conforming": false
    }]);
    for command in ["nodes", "mesh", "solve"] {
        let output = nmt(&[command, &paper_1, "--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert_eq!(json(&output)["common_edges"], square_and_triangle, "{command}");
    }
    let directory = scratch("common");
    let apart = file(
        &directory,
        "apart.toml",
        "[[subdomain]]\nnodes = [5, 5]\nrectangle = { from = [0, 0], to = [1, 1] }\n\
         [[subdomain]]\nnodes = [5, 5]\nrectangle = { from = [2, 0], to = [3, 1] }\n",
    );
    assert_eq!(json(&nmt(&["nodes", &apart, "--json"]))["common_edges"], serde_json::json!([]));
    assert!(!text(&nmt(&["nodes", &apart]).stdout).contains("Common edges"));
    assert_eq!(json(&nmt(&["nodes", &problem("paper-4.toml"), "--json"])).get("common_edges"), None);
}

#[test]
fn the_report_as_text_reads_well() {
    let output = nmt(&["solve", &problem("paper-1.toml"), "--nodes", "9,9", "--at", "0.5,0.5", "--at", "9,9"]);
    // The residual is rounding: its digits are nobody's business.
    let is_rounding = |line: &&str| line.trim_start().starts_with("linear solver");
    let lasting: Vec<&str> =
        std::str::from_utf8(&output.stdout).expect("UTF-8").lines().filter(|l| !is_rounding(l)).collect();
    insta::assert_snapshot!(lasting.join("\n"));
}

#[test]
fn the_report_as_json_has_the_documented_keys_in_order() {
    let output = nmt(&["solve", &problem("square-tube.toml"), "--nodes", "33,33", "--json"]);
    let stdout = text(&output.stdout);
    let keys: Vec<&str> = stdout
        .lines()
        .filter_map(|line| line.trim().strip_prefix('"')?.split_once("\":").map(|(key, _)| key))
        .collect();
    insta::assert_snapshot!(keys.join(" "));
}

#[test]
fn a_poisson_problem_is_checked_solved_and_written() {
    let shipped = problem("poisson-square.toml");
    let check = nmt(&["check", &shipped]);
    assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
    assert!(text(&check.stdout).contains("Poisson problem, ∇²u = 1, 3 edges with a flux, u = exp(x)"));
    assert_eq!(json(&nmt(&["check", &shipped, "--json"]))["solves"]["problem"], "poisson");

    let out = scratch("poisson").join("out");
    let shown = out.display().to_string();
    let arguments =
        ["solve", &shipped, "--nodes", "21,23", "--at", "0.25,0.25", "--at", "5,5", "--out", &shown, "--json"];
    let output = nmt(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let report = json(&output);
    let part = &report["subdomains"][0];
    let number = |value: &Value| value.as_f64().expect("a number");
    assert_eq!((&part["problem"], &part["J"], &part["tau_max"]), (&"poisson".into(), &Value::Null, &Value::Null));
    assert!(number(&part["errors"]["max_relative"]) < 2e-4, "{part}"); // 3e-5 measured
    assert_eq!(part["fluxes"].as_array().map(Vec::len), Some(3));
    let point = &report["points"][0];
    let exact = 0.25f64.exp() * 0.25f64.cos() + 0.5 * 0.25 * 0.25;
    assert!((number(&point["u"]) - exact).abs() < 1e-4, "{point}");
    assert!((number(&point["u_x"]) - 0.25f64.exp() * 0.25f64.cos() - 0.5).abs() < 1e-2, "{point}");
    assert!(report["points"][1]["u"].is_null() && report["points"][1].get("F").is_none());
    let read = |name: &str| std::fs::read_to_string(out.join(name)).expect("a result");
    assert!(read("nodes.csv").starts_with("subdomain,node,x,y,kind,edges,u,u_x,u_y,exact,error\n"));
    for name in ["u", "u_x", "u_y", "exact", "error", "star_size", "residual"] {
        assert!(read("mesh.vtu").contains(&format!("Name=\"{name}\"")), "{name}");
    }
    assert!(read("mesh.msh").contains("\"error\"") && read("stars.json").contains("\"condition\""));
    assert!(read("solution.svg").contains("Error"));

    // Options make a Poisson problem of any section.
    let square =
        file(&out, "square.toml", "[[subdomain]]\nnodes = [9, 9]\nrectangle = { from = [0, 0], to = [1, 1] }\n");
    let arguments = ["solve", &square, "--source", "4", "--boundary", "x^2 + y^2", "--exact", "x^2 + y^2"];
    let output = nmt(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let shown = text(&output.stdout);
    assert!(shown.contains("error at nodes") && !shown.contains("torsion") && !shown.contains('τ'), "{shown}");

    let infinite = nmt(&["solve", &square, "--source", "1/(x - x)"]);
    assert_eq!(infinite.status.code(), Some(1));
    assert!(
        text(&infinite.stderr).contains("--source 1/(x - x): subdomain \"s1\": `source` is inf at"),
        "{}",
        text(&infinite.stderr)
    );
}
