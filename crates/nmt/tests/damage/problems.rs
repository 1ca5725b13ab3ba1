//! What nmt says about a damaged problem file: each case is one edit of a sound one, the snapshot every fault it finds.

use crate::case::{Case, Report, case};
use nmt::problem::{Overrides, Problem};

/// Sound, and with most of what a file can hold. Lines are counted from the first below.
const SOUND: &str = r#"title = "Arch with a round hole"
units = "m"

[[subdomain]]
name = "arch"
nodes = [41, 21]
irregularity = 0.25
shear_modulus = 1.0
outline = [
  [0.0, 0.0],
  [2.0, 0.0],
  [2.0, 1.0],
  { curve = "1 + 0.2*sin(pi*x)^2", name = "crown", nodes = 20 },
  [0.0, 1.0],
]
[[subdomain.hole]]
name = "bore"
circle = { centre = [1.0, 0.5], radius = 0.2 }
nodes = [11, 11]

[[subdomain]]
name = "foot"
nodes = [21, 11]
rectangle = { from = [0, -1], to = [2, 0] }

[solve]
formulation = "variational"
twist = 1.0
holes = "circulation"
order = 2
star = 9
seed = 20170301
"#;

const CIRCLE: &str = "circle = { centre = [1.0, 0.5], radius = 0.2 }";
const OUTLINE: &str = r#"outline = [
  [0.0, 0.0],
  [2.0, 0.0],
  [2.0, 1.0],
  { curve = "1 + 0.2*sin(pi*x)^2", name = "crown", nodes = 20 },
  [0.0, 1.0],
]"#;
const CROWN: &str = r#"{ curve = "1 + 0.2*sin(pi*x)^2", name = "crown", nodes = 20 },"#;
const RECTANGLE: &str = "rectangle = { from = [0, -1], to = [2, 0] }";

const CASES: &[Case] = &[
    // The text itself.
    case("an array that is not closed", &[("[41, 21]", "[41, 21")]),
    case("a text without quotes", &[("\"arch\"", "arch")]),
    case("a text that is not closed", &[("\"arch\"", "\"arch")]),
    case("a key without a value", &[("irregularity = 0.25", "irregularity =")]),
    case("a missing comma", &[("[41, 21]", "[41 21]")]),
    case("a key twice, beside another fault", &[("units = \"m\"", "title = \"again\""), ("order = 2", "order = 7")]),
    case("a table twice", &[("[solve]", "[solve]\norder = 2\n[solve]")]),
    case("a number with a leading zero", &[("0.25", "00.25")]),
    case("two syntax errors on two lines", &[("\"m\"", "m"), ("= 1.0", "= 1.0.0")]),
    case("a number that begins with its point", &[("0.25", ".25")]),
    case("a decimal comma", &[("0.25", "0,25")]),
    case("pairs in parentheses", &[("[41, 21]", "(41, 21)")]),
    case("a formula in place of a number", &[("[41, 21]", "[41, 7*3]")]),
    case("a formula in quotes in place of a number", &[("irregularity = 0.25", "irregularity = \"1/4\"")]),
    case("an unknown division", &[("irregularity = 0.25", "irregularity = 0.25\ndivision = \"chords\"")]),
    case("an unknown unit of clearances", &[("irregularity = 0.25", "irregularity = 0.25\nclearance = \"both\"")]),
    case("an unknown way to a mesh", &[("[solve]", "[mesh]\nmethod = \"delaunay\"\n[solve]")]),
    case("steps that do not exist", &[("[solve]", "[mesh]\nmethod = \"unconstrained\"\nelim = [\"outsid\"]\n[solve]")]),
    case("elimination without need", &[("[solve]", "[mesh]\nelim = [1, 1, 1, 0]\n[solve]")]),
    case("smoothing without measure", &[("[solve]", "[mesh]\nsmooth = -1\n[solve]")]),
    case("steps of the wrong kind", &[("[solve]", "[mesh]\nmethod = \"unconstrained\"\nelim = 1\n[solve]")]),
    // Keys.
    case("a misspelt key", &[("irregularity", "iregularity")]),
    case("a misspelt key of a shape", &[("radius", "raduis")]),
    case("a key of another table", &[("seed = 20170301", "irregularity = 0.25")]),
    case("a hole beside its subdomain", &[("[[subdomain.hole]]", "[[hole]]")]),
    case("a table that does not exist", &[("[solve]", "[meshes]\nmethod = \"constrained\"\n[solve]")]),
    case("a key that no table knows", &[("order = 2", "order = 2\ncolour = \"x\"")]),
    case("a key with a blank", &[("units", "\"my units\"")]),
    // Subdomains and names.
    case("nothing at all", &[(SOUND, "")]),
    case("no subdomain", &[(SOUND, "[solve]\norder = 2\n")]),
    case("an empty list of subdomains", &[(SOUND, "subdomain = []\n")]),
    case("a single subdomain in single brackets", &[("[[subdomain]]\nname = \"foot\"", "[foot]\nname = \"foot\"")]),
    case("a subdomain that is a number", &[(SOUND, "subdomain = 3\n")]),
    case("single brackets", &[(SOUND, "[subdomain]\nnodes = [5, 5]\ncircle = { centre = [0, 0], radius = 1 }\n")]),
    case("a hole in single brackets", &[("[[subdomain.hole]]", "[subdomain.hole]")]),
    case("a hole before its subdomain", &[(SOUND, "[[subdomain.hole]]\ncircle = { centre = [0, 0], radius = 1 }\n")]),
    case("two subdomains of one name", &[("\"foot\"", "\"arch\"")]),
    case("a default name that is taken", &[("name = \"foot\"\n", ""), ("\"arch\"", "\"s2\"")]),
    case(
        "two holes of one name",
        &[(
            "[[subdomain.hole]]",
            "[[subdomain.hole]]\nname = \"bore\"\ncircle = { centre = [0.4, 0.5], radius = 0.1 }\n[[subdomain.hole]]",
        )],
    ),
    case("two edges of one name", &[("[2.0, 1.0],", "{ line = true, name = \"crown\" },\n  [2.0, 1.0],")]),
    case("an edge named like another's default", &[("\"crown\"", "\"e1\"")]),
    case("an empty name", &[("\"arch\"", "\" \"")]),
    case("a name with a separator", &[("\"bore\"", "\"a;b\"")]),
    case("a title over two lines", &[("\"Arch with a round hole\"", "\"two\\nlines\"")]),
    case("a title that is a number", &[("\"Arch with a round hole\"", "5")]),
    // Values of a subdomain.
    case("no nodes", &[("nodes = [41, 21]\n", "")]),
    case("one grid line", &[("[41, 21]", "[1, 21]")]),
    case("no and negative grid lines", &[("[41, 21]", "[0, -3]")]),
    case("too many grid points", &[("[41, 21]", "[40_000, 20_000]")]),
    case(
        "a number of grid lines beyond all bounds",
        &[("[41, 21]", "[99999999999999999999999999999999999999999999, 2]")],
    ),
    case("nodes that are not whole", &[("[41, 21]", "[41.0, 21]")]),
    case("nodes of one number", &[("[41, 21]", "[41]")]),
    case("nodes that are one number", &[("[41, 21]", "41")]),
    case("hole nodes out of range", &[("[11, 11]", "[11, 1]")]),
    case("an irregularity of half a spacing", &[("0.25", "0.5")]),
    case("a negative irregularity", &[("0.25", "-0.1")]),
    case("an irregularity that is no number", &[("0.25", "nan")]),
    case("an irregularity in quotes", &[("0.25", "\"0.25\"")]),
    case("a shear modulus of 0", &[("shear_modulus = 1.0", "shear_modulus = 0")]),
    case("an infinite shear modulus", &[("shear_modulus = 1.0", "shear_modulus = inf")]),
    case("a shear modulus of a wrong kind", &[("shear_modulus = 1.0", "shear_modulus = \"steel\"")]),
    // A spacing that varies: put in place of the irregularity.
    case("a density that is a number", &[("irregularity = 0.25", "density = 0.01")]),
    case("a density that does not parse", &[("irregularity = 0.25", "density = \"0.01 + 2x\"")]),
    case("a density of another variable", &[("irregularity = 0.25", "density = \"0.01 + r\"")]),
    case("a graded cloud divided by chords", &[("irregularity = 0.25", "density = \"0.1\"\ndivision = \"chord\"")]),
    case(
        "a graded cloud with scaled clearances",
        &[("irregularity = 0.25", "refine = [{ edge = \"crown\", size = 0.01 }]\nclearance = \"scaled\"")],
    ),
    case("a graph written as y", &[("curve = \"1 + 0.2*sin(pi*x)^2\"", "y = \"1 + 0.2*sin(pi*x)^2\"")]),
    case("a growth alone out of range", &[("irregularity = 0.25", "growth = 0.7")]),
    case("growths out of range", &[("irregularity = 0.25", "density = \"0.1\"\ngrowth = 0.7")]),
    case("a refinement that is no list", &[("irregularity = 0.25", "refine = { point = [1, 1], size = 0.01 }")]),
    case("an empty list of refinements", &[("irregularity = 0.25", "refine = []")]),
    case("a refinement that is no table", &[("irregularity = 0.25", "refine = [[1, 1]]")]),
    case(
        "refinements of nothing, of two things, and without a size",
        &[(
            "irregularity = 0.25",
            "refine = [{ size = 0.01 }, { point = [1, 1], edge = \"crown\", size = 0.01 }, { point = [1, 1] }]",
        )],
    ),
    case(
        "sizes and growths out of range",
        &[(
            "irregularity = 0.25",
            "refine = [\n  { point = [0, 0], size = 0, growth = 0 },\n  { point = [0, 0], size = -1, growth = 0.6 },\n  \
             { point = [0, 0], size = 1e-9, growth = nan },\n  { point = [0, inf], size = inf },\n]",
        )],
    ),
    case(
        "edges that do not exist, and a misspelt key",
        &[(
            "irregularity = 0.25",
            "refine = [{ edge = \"crwon\", size = 0.01 }, { edge = 3, size = 0.01 }, { edge = \"e9\", size = 0.01 }, \
             { edge = \"bore/e1\", sise = 0.01 }]",
        )],
    ),
    case("clearances out of range", &[("irregularity = 0.25", "edge_clearance = -0.1\nnode_clearance = 2.5")]),
    case("an unknown formulation of a subdomain", &[("irregularity = 0.25", "formulation = \"fvm\"")]),
    // Shapes.
    case("no shape", &[(RECTANGLE, "")]),
    case(
        "two shapes, one of them bad",
        &[(RECTANGLE, "rectangle = { from = [0, -1], to = [2, 0] }\ncircle = { centre = [0, 0], radius = -1 }")],
    ),
    case("a hole without a shape", &[(CIRCLE, "")]),
    case("a negative radius", &[("radius = 0.2", "radius = -0.2")]),
    case("a circle without a radius", &[(", radius = 0.2", "")]),
    case("a centre of three numbers", &[("[1.0, 0.5]", "[1.0, 0.5, 0]")]),
    case("a circle that is a number", &[(CIRCLE, "circle = 0.2")]),
    case(
        "an ellipse with a zero semi-axis",
        &[(CIRCLE, "ellipse = { centre = [1, 0.5], semi_axes = [0.2, 0], angle = 30 }")],
    ),
    case(
        "an ellipse with an angle in quotes",
        &[(CIRCLE, "ellipse = { centre = [1, 0.5], semi_axes = [0.2, 0.1], angle = \"30\" }")],
    ),
    case("a rectangle without height", &[("to = [2, 0]", "to = [2, -1]")]),
    case("a coordinate beyond all bounds", &[("[2.0, 1.0],", "[1e300, 1.0],")]),
    case("a coordinate that overflows", &[("[2.0, 1.0],", "[1e999, 1.0],")]),
    case("coordinates that are no numbers", &[("[2.0, 1.0],", "[nan, \"1.0\"],")]),
    // Outlines.
    case("an outline that is a text", &[(OUTLINE, "outline = \"arch.svg\"")]),
    case("an empty outline", &[(OUTLINE, "outline = []")]),
    case("two vertices and no curve", &[(OUTLINE, "outline = [[0, 0], [1, 0], { line = true }]")]),
    case("one vertex", &[(OUTLINE, "outline = [[0, 0]]")]),
    case("an arc from a vertex to itself", &[(OUTLINE, "outline = [[1, 0], { arc = { centre = [0, 0] } }]")]),
    case("an outline that starts with an edge", &[("outline = [\n", "outline = [\n  { line = true },\n")]),
    case("two edges in a row", &[(CROWN, "{ curve = \"1\" },\n  { line = true },")]),
    case("a repeated closing vertex", &[("  [0.0, 1.0],\n", "  [0.0, 1.0],\n  [0.0, 0.0],\n")]),
    case("a vertex almost repeated", &[("  [2.0, 0.0],\n", "  [2.0, 0.0],\n  [2.0, 1e-12],\n")]),
    case("a repeated vertex", &[("  [2.0, 0.0],\n", "  [2.0, 0.0],\n  [2, 0],\n")]),
    case("a formula as an item", &[(CROWN, "\"1 + 0.2*sin(pi*x)^2\",")]),
    case("an item that is a number", &[("  [2.0, 0.0],\n", "  2.0, 0.0,\n")]),
    case("a vertex of one number", &[("  [2.0, 0.0],\n", "  [2.0],\n")]),
    case("an edge without a path", &[(CROWN, "{ name = \"crown\" },")]),
    case("an edge with a misspelt path", &[("{ curve =", "{ cruve =")]),
    case("an edge with two paths", &[("{ curve =", "{ line = true, curve =")]),
    case("an edge that is no line", &[(CROWN, "{ line = false },")]),
    case("an edge of one node", &[("nodes = 20", "nodes = 1")]),
    case("an edge of half a node", &[("nodes = 20", "nodes = 20.5")]),
    case("an arc without a centre", &[(CROWN, "{ arc = { ccw = true } },")]),
    case("an arc with a direction in words", &[(CROWN, "{ arc = { centre = [1, 1], ccw = \"yes\" } },")]),
    case("a parametric edge without an interval", &[(CROWN, "{ x = \"1 + cos(t)\", y = \"1 + sin(t)\" },")]),
    case("a parametric edge of no length", &[(CROWN, "{ x = \"1 + cos(t)\", y = \"1 + sin(t)\", t = [1, 1] },")]),
    // Formulas.
    case("a missing operator", &[("0.2*sin", "0.2sin")]),
    case("an unknown function", &[("sin(pi*x)", "sine(pi*x)")]),
    case("the wrong variable", &[("sin(pi*x)", "sin(pi*t)")]),
    case("an open parenthesis", &[("sin(pi*x)^2", "sin(pi*x^2")]),
    case("an empty formula", &[("\"1 + 0.2*sin(pi*x)^2\"", "\"\"")]),
    case("a formula after letters of two bytes", &[("\"1 + 0.2*sin(pi*x)^2\"", "\"1 + µ\", name = \"é\"")]),
    case("a formula written with escapes", &[("\"1 + 0.2*sin(pi*x)^2\"", "\"1 +\\t2x\"")]),
    case("a formula that is a number", &[("\"1 + 0.2*sin(pi*x)^2\"", "1.2")]),
    case("faults in both formulas of an edge", &[(CROWN, "{ x = \"2t\", y = \"sin t\", t = [0, 1] },")]),
    // Curves.
    case("a curve that misses a vertex", &[("1 + 0.2*sin", "1.01 + 0.2*sin")]),
    case("a curve that is not finite", &[("1 + 0.2*sin(pi*x)^2", "1 + 0*ln(x - 1)")]),
    case("a curve with a pole", &[("1 + 0.2*sin(pi*x)^2", "1 + 1/(x - 1) - 1/(x - 1)")]),
    case("a vertical edge as a graph", &[("[2.0, 1.0],", "{ curve = \"x\" },\n  [2.0, 1.0],")]),
    case("an arc off its centre", &[(CROWN, "{ arc = { centre = [1.1, 1] } },")]),
    case(
        "a parametric edge that misses its vertices",
        &[(CROWN, "{ x = \"1 + cos(t)\", y = \"1 + sin(t)\", t = [0, 3.14] },")],
    ),
    case("a curve with a jump", &[("1 + 0.2*sin(pi*x)^2", "1 + 0.1*floor(x)*(2 - x)")]),
    // How shapes lie.
    case("a bow tie", &[(OUTLINE, "outline = [[0, 0], [2, 1], [2, 0], [0, 1]]")]),
    case("a curve that crosses an edge", &[("1 + 0.2*sin(pi*x)^2", "1 - 1.2*sin(pi*x/2)")]),
    case(
        "a curve that crosses itself",
        &[(CROWN, "{ x = \"1 + cos(3*t)\", y = \"1 + 0.5*sin(t)\", t = [0, 3.141592653589793] },")],
    ),
    case("a vertex on another edge", &[("[2.0, 1.0],", "[2.0, 0.5],\n  [1.0, 0.0],\n  [2.0, 1.0],")]),
    case("no area", &[(OUTLINE, "outline = [[0, 0], [1, 1], [2, 2]]")]),
    case("almost no area", &[(OUTLINE, "outline = [[0, 0], [2, 0], [1, 1e-13]]")]),
    case("a hole across the contour", &[("[1.0, 0.5], radius = 0.2", "[0.1, 0.5], radius = 0.2")]),
    case("a hole that touches the contour", &[("[1.0, 0.5], radius = 0.2", "[0.2, 0.5], radius = 0.2")]),
    case("a hole outside", &[("[1.0, 0.5], radius = 0.2", "[9.0, 0.5], radius = 0.2")]),
    case("a hole around the contour", &[("[1.0, 0.5], radius = 0.2", "[1.0, 0.5], radius = 8")]),
    case(
        "holes that overlap, one within another",
        &[(
            "[[subdomain.hole]]",
            "[[subdomain.hole]]\ncircle = { centre = [1.2, 0.5], radius = 0.1 }\n[[subdomain.hole]]\n\
             circle = { centre = [1, 0.5], radius = 0.01 }\n[[subdomain.hole]]",
        )],
    ),
    case("subdomains that overlap", &[("to = [2, 0]", "to = [2, 0.25]")]),
    case("a subdomain within another", &[(RECTANGLE, "circle = { centre = [0.4, 0.4], radius = 0.1 }")]),
    case("a subdomain twice", &[(RECTANGLE, OUTLINE)]),
    case("a hole too small to see", &[("radius = 0.2", "radius = 1e-8")]),
    case(
        "a section far from the origin",
        &[
            (OUTLINE, "rectangle = { from = [1e9, 0], to = [1000000001, 1] }"),
            (CIRCLE, "circle = { centre = [1000000000.5, 0.5], radius = 0.2 }"),
            (RECTANGLE, "rectangle = { from = [1e9, -1], to = [1000000001, 0] }"),
        ],
    ),
    case(
        "a section too small for any unit",
        &[(SOUND, "[[subdomain]]\nnodes = [5, 5]\nrectangle = { from = [0, 0], to = [1e-40, 1e-40] }\n")],
    ),
    // [solve].
    case("an unknown formulation", &[("\"variational\"", "\"galerkin\"")]),
    case("a misspelt formulation", &[("\"variational\"", "\"Variatonal\"")]),
    case("an unknown condition on holes", &[("\"circulation\"", "\"one\"")]),
    case("both twist and torque", &[("twist = 1.0", "twist = 1.0\ntorque = 2.0")]),
    case("no twist", &[("twist = 1.0", "twist = 0.0")]),
    case("an infinite torque", &[("twist = 1.0", "torque = -inf")]),
    case("an order out of range", &[("order = 2", "order = 5")]),
    case("no order", &[("order = 2", "order = 0")]),
    case("a plane in the local formulation", &[("\"variational\"", "\"local\""), ("order = 2", "order = 1")]),
    case(
        "a plane in one local subdomain",
        &[("irregularity = 0.25", "formulation = \"local\""), ("order = 2", "order = 1")],
    ),
    case("a star too small for its order", &[("order = 2", "order = 4")]),
    case("an unknown choice of stars", &[("star = 9", "stars = \"balance\"")]),
    case("a star in words", &[("star = 9", "star = \"nearest\"")]),
    case("a smoothing out of range", &[("star = 9", "smoothing = 1.5")]),
    case("a smoothing that is no number", &[("star = 9", "smoothing = nan")]),
    case("unknown trial and test functions", &[("star = 9", "trial = \"moving\"\ntest = \"hats\"")]),
    case("a Gauss rule that does not exist", &[("star = 9", "gauss = 5")]),
    case("a Gauss rule that is not whole", &[("star = 9", "gauss = 3.0")]),
    case("a misspelt key of [solve]", &[("star = 9", "smoothin = 0.1")]),
    case("order and star of finite elements", &[("\"variational\"", "\"fem\"")]),
    case(
        "everything that finite elements have no use for",
        &[
            ("\"variational\"", "\"fem\""),
            ("star = 9", "star = 3\nstars = \"nearest\"\nsmoothing = 0.1\ntrial = \"mwls\"\ntest = \"hat\"\ngauss = 3"),
        ],
    ),
    case(
        "what only the variational formulation has",
        &[("\"variational\"", "\"local\""), ("star = 9", "trial = \"mwls\"\ntest = \"trial\"\ngauss = 3")],
    ),
    case(
        "an order beside a formulation that cannot be read",
        &[("\"variational\"", "\"fem\""), ("irregularity = 0.25", "formulation = \"lokal\"")],
    ),
    case("an order that is not whole", &[("order = 2", "order = 2.0")]),
    case("a star too small", &[("star = 9", "star = 5")]),
    case("a negative seed", &[("seed = 20170301", "seed = -1")]),
    case(
        "settings that are no table",
        &[(SOUND, "solve = 3\n[[subdomain]]\nnodes = [5, 5]\ncircle = { centre = [0, 0], radius = 1 }\n")],
    ),
    case("settings that are a date", &[("seed = 20170301", "seed = 2017-03-01")]),
    // Several at once.
    case(
        "faults everywhere are listed together",
        &[
            ("units = \"m\"", "unit = \"m\""),
            ("[41, 21]", "[41, 1]"),
            ("0.2*sin", "0.2sin"),
            ("radius = 0.2", "radius = 0"),
            ("order = 2", "order = 5"),
            ("star = 9", "star = \"9\"\ngauss = 2"),
        ],
    ),
    case(
        "a contour that cannot be read hides the faults of no other",
        &[
            ("0.2*sin", "0.2sin"),
            ("to = [2, 0]", "to = [0, 0]"),
            ("[1.0, 0.5], radius = 0.2", "[9.0, 0.5], radius = 0.2"),
        ],
    ),
];

fn faults(case: &Case) -> Vec<String> {
    let problem = Problem::parse("arch.toml", &case.damaged(SOUND), &Overrides::default());
    problem.err().unwrap_or_default().iter().map(ToString::to_string).collect()
}

#[test]
fn the_file_that_is_damaged_is_sound() {
    let found = Problem::parse("arch.toml", SOUND, &Overrides::default());
    assert!(found.is_ok(), "{found:?}");
}

#[test]
fn every_damage_is_named_with_its_place_and_a_remedy() {
    let Report { text, silent } = Report::of(CASES, SOUND, faults);
    insta::assert_snapshot!(text);
    assert!(silent.is_empty(), "no fault was found in: {silent:?}");
}
