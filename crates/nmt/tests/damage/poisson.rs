//! What nmt says about a damaged Poisson problem: each case is one edit of a sound one, the snapshot every fault it finds.

use crate::case::{Case, Report, case, option};
use nmt::NmtError;
use nmt::prelude::*;

/// Sound. Lines are counted from the first below.
const SOUND: &str = r#"[[subdomain]]
name = "plate"
nodes = [9, 9]
outline = [
  [0, 0],
  { line = true, name = "bottom" },
  [1, 0],
  { line = true, name = "right", neumann = "x + y" },
  [1, 1],
  { curve = "1 + 0.1*sin(pi*x)^2", name = "crown", neumann = "0" },
  [0, 1],
  { line = true, name = "left" },
]
[[subdomain.hole]]
name = "bore"
circle = { centre = [0.5, 0.5], radius = 0.2, neumann = "y" }

[solve]
source = "1 + x*y"
boundary = "x^2"
exact = "x^2 - y^2"
"#;

const SOURCE: &str = "source = \"1 + x*y\"\n";

const CASES: &[Case] = &[
    case("boundary, exact and fluxes without a source", &[(SOURCE, "")]),
    case(
        "a flux on every side of a rectangle without a source",
        &[(SOUND, "[[subdomain]]\nnodes = [5, 5]\nrectangle = { from = [0, 0], to = [1, 1], neumann = \"0\" }\n")],
    ),
    case(
        "keys of torsion beside a source",
        &[
            (SOURCE, "source = \"1\"\ntwist = 1\nholes = \"zero\"\n"),
            ("nodes = [9, 9]", "nodes = [9, 9]\nshear_modulus = 2"),
        ],
    ),
    case("a torque beside a source", &[(SOURCE, "source = \"1\"\ntorque = 1\n")]),
    case(
        "no edge with a value",
        &[
            ("name = \"bottom\"", "name = \"bottom\", neumann = \"0\""),
            ("name = \"left\"", "name = \"left\", neumann = \"1\""),
        ],
    ),
    case(
        "a source that cannot be understood hides no other fault",
        &[
            (SOURCE, "source = \"1 + 2x\"\n"),
            ("\"x^2\"", "\"x^2 + z\""),
            ("\"x^2 - y^2\"", "\"x^2 - (y^2\""),
            ("\"x + y\"", "\"x + t\""),
            ("neumann = \"y\"", "neumann = \"y +\""),
        ],
    ),
    case("numbers in place of formulas", &[(SOURCE, "source = 1\n"), ("neumann = \"0\"", "neumann = 0")]),
    case("a formula of one variable more", &[("\"1 + 0.1*sin(pi*x)^2\"", "\"1 + 0.1*sin(pi*y)^2\"")]),
    case(
        "a flux of a whole subdomain, or solution",
        &[("name = \"plate\"", "name = \"plate\"\nneumann = \"0\""), (SOURCE, "source = \"1\"\nneumann = \"0\"\n")],
    ),
    case("a misspelt key", &[("boundary", "boundry"), ("neumann", "neuman")]),
    option("options of torsion over a Poisson problem", &[("twist", "2"), ("holes", "zero")]),
    option("an option that cannot be understood", &[("source", "1 + 2x"), ("exact", "sin x")]),
    Case {
        title: "an option makes it a Poisson problem",
        edits: &[(SOURCE, "torque = 1\n")],
        options: &[("source", "1")],
    },
    // Found only when it is solved.
    case("a source that is not finite", &[(SOURCE, "source = \"1/(x - x)\"\n")]),
    case("a boundary value that is not finite", &[("\"x^2\"", "\"log(x - 2)\"")]),
    case("a flux that is not finite", &[("\"x + y\"", "\"sqrt(y - 2)\"")]),
    case("an exact solution that is not finite", &[("\"x^2 - y^2\"", "\"log(x)\"")]),
    case("an exact solution without a norm", &[("\"x^2 - y^2\"", "\"1e200*x\"")]),
];

fn overrides(case: &Case) -> Overrides {
    let of = |key: &str| case.options.iter().find(|(name, _)| *name == key).map(|(_, value)| (*value).to_owned());
    Overrides {
        twist: of("twist").map(|value| value.parse().expect("a number")),
        holes: of("holes"),
        source: of("source"),
        exact: of("exact"),
        ..Overrides::default()
    }
}

fn faults(case: &Case) -> Vec<String> {
    let errors = match Problem::parse("plate.toml", &case.damaged(SOUND), &overrides(case)) {
        Err(errors) => errors,
        Ok(problem) => match solve_any(&problem) {
            Err(NmtError::Problem(errors)) => errors,
            Err(other) => return vec![other.to_string()],
            Ok(_) => return Vec::new(),
        },
    };
    errors.iter().map(ToString::to_string).collect()
}

#[test]
fn the_file_that_is_damaged_is_solved() {
    assert_eq!(faults(&case("", &[])), Vec::<String>::new());
}

#[test]
fn every_damage_is_named_with_its_place_and_a_remedy() {
    let Report { text, silent } = Report::of(CASES, SOUND, faults);
    insta::assert_snapshot!(text);
    assert!(silent.is_empty(), "no fault was found in: {silent:?}");
}
