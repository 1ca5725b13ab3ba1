//! `nmt plot star` as a user runs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn nmt(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nmt")).args(arguments).output().expect("the command starts")
}

fn problem(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/problems").join(name).display().to_string()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("output is UTF-8")
}

fn scratch(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&directory);
    directory
}

#[test]
fn the_star_beside_a_slot_passes_over_what_lies_across_it() {
    let out = scratch("star");
    let shown = out.display().to_string();
    let output = nmt(&["plot", "star", &problem("bare-segment.toml"), "--node", "27", "--out", &shown]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    insta::assert_snapshot!(text(&output.stdout));
    let svg = std::fs::read_to_string(out.join("star-27.svg")).expect("star-27.svg");
    assert!(svg.starts_with("<?xml") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    assert_eq!(svg.matches("<g ").count(), svg.matches("</g>").count());
    let png = std::fs::read(out.join("star-27.png")).expect("star-27.png");
    assert!(png.starts_with(b"\x89PNG"));
}

#[test]
fn on_a_square_lattice_the_row_is_the_nine_point_one_and_sums_to_zero() {
    let out = scratch("star-row").display().to_string();
    let file = problem("paper-1.toml");
    let arguments = ["plot", "star", &file, "--subdomain", "square", "--node", "56", "--nodes", "9,9", "--out", &out];
    for more in [&["--formulation", "local"][..], &["--order", "3"], &["--order", "4", "--stars", "balanced"]] {
        let output = nmt(&[&arguments[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let table = text(&output.stdout);
        let row = table.lines().skip_while(|line| !line.starts_with("    node")).skip(1);
        let row: Vec<f64> = row.map_while(|line| line.split_whitespace().nth(5)?.parse().ok()).collect();
        let largest = row.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        assert!(row.len() >= 9 && row[0] < 0.0 && row.iter().sum::<f64>().abs() < 1e-7 * largest, "{table}"); // printed digits
    }
}

#[test]
fn a_star_that_there_is_not_is_told_with_what_there_is() {
    let (one, three) = (problem("paper-3.toml"), problem("three-parts.toml"));
    let cases: [(&[&str], &str); 4] = [
        (
            &[&one, "--nodes", "21,21", "--node", "99999"],
            "there is no node 99999 in subdomain \"U\"; its nodes are 0 to ",
        ),
        (&[&three, "--node", "5"], "the problem has \"arch\", \"head\", \"inclusion\"; name the one"),
        (&[&three, "--node", "5", "--subdomain", "hat"], "there is no subdomain \"hat\"; the problem has \"arch\""),
        (&[&one, "--nodes", "21,21", "--node", "5", "--formulation", "fem"], "has no stars; choose --formulation"),
    ];
    for (arguments, message) in cases {
        let output = nmt(&[&["plot", "star"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(message), "{}", text(&output.stderr));
        assert!(output.stdout.is_empty());
    }
    assert_eq!(nmt(&["plot", "star", &one, "--node", "-1"]).status.code(), Some(2));
}

#[test]
fn of_several_subdomains_the_files_bear_the_name_of_the_stars_own() {
    let out = scratch("star-named");
    std::fs::create_dir_all(&out).expect("a scratch directory");
    let file = out.join("two.toml");
    let text = "[[subdomain]]\nname = \"left web/2\"\nnodes = [5, 5]\nrectangle = { from = [0, 0], to = [1, 1] }\n\
                [[subdomain]]\nname = \"right\"\nnodes = [5, 5]\nrectangle = { from = [2, 0], to = [3, 1] }\n";
    std::fs::write(&file, text).expect("a scratch file");
    let (file, shown) = (file.display().to_string(), out.display().to_string());
    for (name, picture) in [("left web/2", "star-left_web_2-20"), ("right", "star-right-20")] {
        let output = nmt(&["plot", "star", &file, "--subdomain", name, "--node", "20", "--out", &shown]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        for kind in ["svg", "png"] {
            assert!(out.join(format!("{picture}.{kind}")).is_file(), "{picture}.{kind}");
        }
    }
}
