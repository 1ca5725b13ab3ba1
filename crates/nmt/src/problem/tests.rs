//! Sound files come out typed, options win, and no text, however damaged, panics or takes long.

use super::*;
use nmt_curve::Curve;
use nmt_mfdm::{Formulation, HoleCondition, Load, SolveParams, Solver, StarChoice, Test, Trial};
use nmt_tri::Elimination;
use proptest::prelude::*;
use std::time::{Duration, Instant};

/// Every key and every form of an edge.
const EVERYTHING: &str = r#"
title = "Everything"
units = "mm"

[[subdomain]]
name = "left"
nodes = [41, 21]
irregularity = 0.25
shear_modulus = 80_000
formulation = "local"
edge_clearance = 0.25
node_clearance = 0.4
outline = [
  [0, 0],
  { line = true, name = "base", nodes = 12 },
  [2.0, 0.0],
  [2.0, 1.0],
  { curve = "1 + 0.2*sin(pi*x)^2" },
  [1.0, 1.0],
  { arc = { centre = [0.5, 1.0] } },
  [0.0, 1.0],
  { x = "-0.2*sin(t)", y = "t/pi", t = [3.141592653589793, 0], name = "wave" },
]
[[subdomain.hole]]
name = "bore"
circle = { centre = [0.5, 0.4], radius = 0.1 }
nodes = [11, 11]
[[subdomain.hole]]
ellipse = { centre = [1.0, 0.5], semi_axes = [0.2, 0.1], angle = 30 }
[[subdomain.hole]]
outline = [
  [1.4, 0.4],
  { arc = { centre = [1.5, 0.4], ccw = false } },
  [1.6, 0.4],
]

[[subdomain]]
nodes = [5, 6]
rectangle = { from = [0, -1], to = [2, 0] }

[solve]
formulation = "variational"
torque = -2.5e3
holes = "zero"
order = 2
star = 12
seed = 0
"#;

fn parse(text: &str) -> Result<Problem, Vec<ProblemError>> {
    Problem::parse("a.toml", text, &Overrides::default())
}

fn sound(text: &str, options: &Overrides) -> Problem {
    Problem::parse("a.toml", text, options).unwrap_or_else(|errors| panic!("{errors:#?}"))
}

fn faults(text: &str, options: &Overrides) -> Vec<String> {
    let errors = Problem::parse("a.toml", text, options).expect_err("a fault");
    errors.iter().map(ToString::to_string).collect()
}

#[test]
fn a_file_with_everything_comes_out_typed() {
    let problem = sound(EVERYTHING, &Overrides::default());
    assert_eq!((problem.title.as_str(), problem.units.as_str()), ("Everything", "mm"));
    let [left, s2] = &problem.subdomains[..] else { panic!("two subdomains") };

    assert_eq!((left.name.as_str(), left.nodes), ("left", [41, 21]));
    assert_eq!((left.irregularity, left.shear_modulus, left.formulation), (0.25, 8e4, Some(Formulation::Local)));
    assert_eq!((left.edge_clearance, left.node_clearance), (0.25, 0.4));
    assert_eq!(left.contour.vertices, [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0]]);
    let names: Vec<_> = left.contour.edges.iter().map(|edge| edge.name.as_str()).collect();
    assert_eq!(names, ["base", "e2", "e3", "e4", "wave"]);
    let nodes: Vec<_> = left.contour.edges.iter().map(|edge| edge.nodes).collect();
    assert_eq!(nodes, [Some(12), None, None, None, None]);
    assert!(matches!(left.contour.edges[1].curve, Curve::Line { from: [2.0, 0.0], to: [2.0, 1.0] }));
    assert!(matches!(left.contour.edges[2].curve, Curve::Graph { from_x: 2.0, to_x: 1.0, .. }));
    assert!(matches!(left.contour.edges[3].curve, Curve::Arc { .. }));
    assert!(matches!(left.contour.edges[4].curve, Curve::Parametric { to_t: 0.0, .. }));

    let names: Vec<_> = left.holes.iter().map(|hole| (hole.name.as_str(), hole.nodes)).collect();
    assert_eq!(names, [("bore", Some([11, 11])), ("h2", None), ("h3", None)]);
    let names: Vec<_> = left.holes.iter().flat_map(|hole| &hole.outline.edges).map(|edge| &edge.name[..]).collect();
    assert_eq!(names, ["bore/e1", "h2/e1", "h3/e1", "h3/e2"]);
    let Curve::Ellipse { rotation, .. } = left.holes[1].outline.edges[0].curve else { panic!("an ellipse") };
    assert!((rotation - std::f64::consts::FRAC_PI_6).abs() < 1e-15); // rounding

    assert_eq!((s2.name.as_str(), s2.nodes, s2.formulation), ("s2", [5, 6], None));
    assert_eq!((s2.irregularity, s2.shear_modulus), (0.0, 1.0));
    assert_eq!((s2.edge_clearance, s2.node_clearance), (1.0 / 3.0, 0.5));

    let solve = &problem.solve;
    assert_eq!((solve.formulation, solve.holes), (Formulation::Variational, HoleCondition::Zero));
    assert_eq!((solve.load, solve.order, solve.star, solve.seed), (Load::Torque(-2500.0), 2, Some(12), 0));
}

#[test]
fn a_problem_needs_only_nodes_and_a_shape() {
    let problem =
        sound("[[subdomain]]\nnodes = [5, 5]\ncircle = { centre = [0, 0], radius = 1 }\n", &Overrides::default());
    assert_eq!(problem.solve, SolveSettings::default());
    assert_eq!(problem.solve.load, Load::Twist(1.0));
    assert_eq!(problem.solve.seed, 20170301);
    assert_eq!((problem.title.as_str(), problem.subdomains[0].name.as_str()), ("", "s1"));
}

#[test]
fn places_point_at_what_they_name() {
    let problem = sound(EVERYTHING, &Overrides::default());
    let at = |place: &Place| match place {
        Place::File(span) => EVERYTHING[span.clone()].to_owned(),
        Place::Option(option) => option.clone(),
    };
    let left = &problem.subdomains[0];
    assert_eq!(at(&left.place), "[[subdomain]]");
    assert_eq!(at(&left.nodes_place), "[41, 21]");
    assert_eq!(at(&left.contour_place), "outline");
    assert_eq!(at(&left.edge_places[0]), "{ line = true, name = \"base\", nodes = 12 }");
    assert_eq!(at(&left.edge_places[1]), "[2.0, 0.0]");
    assert_eq!(at(&left.holes[0].place), "[[subdomain.hole]]");
    assert_eq!(at(&left.holes[0].edge_places[0]), "{ centre = [0.5, 0.4], radius = 0.1 }");
    assert_eq!(problem.solve.star_place.as_ref().map(at), Some("12".into()));
    let error = problem.source.error(&left.edge_places[0], "edge \"base\"", "too coarse", "give more nodes");
    assert_eq!(error.to_string(), "a.toml:15:3: edge \"base\": too coarse; give more nodes");
}

#[test]
fn options_replace_what_the_file_says() {
    let options = Overrides {
        method: Some("unconstrained".into()),
        elim: Some(vec!["outside".into(), "in_hole".into()]),
        nodes: Some([9, 8]),
        formulation: Some("variational".into()),
        twist: Some(0.5),
        holes: Some("circulation".into()),
        order: Some(2),
        star: Some(9),
        seed: Some(7),
        ..Overrides::default()
    };
    let problem = sound(EVERYTHING, &options);
    assert!(problem.subdomains.iter().all(|s| s.nodes == [9, 8] && s.formulation.is_none()));
    assert_eq!(problem.subdomains[0].nodes_place, Place::Option("--nodes 9,8".into()));
    let steps = Elimination { outside: true, in_hole: true, tiny: false, complete: false };
    assert_eq!((problem.mesh.method, problem.mesh.elimination), (MeshMethod::Unconstrained, steps));
    let solve = &problem.solve;
    assert_eq!(
        (solve.load, solve.holes, solve.star, solve.seed),
        (Load::Twist(0.5), HoleCondition::Circulation, Some(9), 7)
    );
    assert_eq!(solve.star_place, Some(Place::Option("--star 9".into())));
}

#[test]
fn nodes_of_the_command_make_up_for_missing_ones() {
    let text = "[[subdomain]]\ncircle = { centre = [0, 0], radius = 1 }\n";
    assert_eq!(faults(text, &Overrides::default()).len(), 1);
    let options = Overrides { nodes: Some([5, 5]), ..Overrides::default() };
    assert_eq!(sound(text, &options).subdomains[0].nodes, [5, 5]);
}

#[test]
fn faults_of_options_name_the_option() {
    let options = Overrides {
        nodes: Some([1, 20_000]),
        formulation: Some("lokal".into()),
        twist: Some(f64::NAN),
        torque: Some(0.0),
        holes: Some("none".into()),
        order: Some(7),
        star: Some(3),
        ..Overrides::default()
    };
    assert_eq!(
        faults(EVERYTHING, &options),
        [
            "--formulation lokal: unknown formulation \"lokal\"; did you mean \"local\"? \
             (use \"variational\", \"local\" or \"fem\")",
            "--holes none: unknown condition on holes \"none\"; use \"circulation\" or \"zero\"",
            "--twist NaN --torque 0: both are given, and each determines the other; keep one of them",
            "--twist NaN: `twist` is NaN; give a finite number",
            "--torque 0: `torque` is 0: nothing is twisted, and J = T/(Gθ) has no value; \
             give another torque, or leave it out for twist = 1",
            "--order 7: `order` is 7, outside 1 … 4; give order = 2, 3 or 4, or 1 in the variational formulation; or leave \
             it out for 2",
            "--nodes 1,20000: `nodes` has N_x = 1; give at least 2 grid lines each way, for example nodes = [41, 21]",
            "--star 3: `star` is 3, fewer nodes than the 6 monomials of order 2; give at least 6, or leave it out for the \
             default",
        ]
    );
}

#[test]
fn an_option_does_not_hide_a_fault_of_the_file() {
    let text = EVERYTHING.replace("order = 2", "order = 5");
    let options = Overrides { order: Some(2), ..Overrides::default() };
    assert_eq!(
        faults(&text, &options),
        [
            "a.toml:45:9: [solve]: `order` is 5, outside 1 … 4; give order = 2, 3 or 4, or 1 in the variational formulation; \
          or leave it out for 2"
        ]
    );
    let options = Overrides { star: Some(9), ..Overrides::default() };
    let found = faults(&EVERYTHING.replace("star = 12", "star = 5"), &options);
    assert!(found.len() == 1 && found[0].starts_with("a.toml:46:8: [solve]: `star` is 5, fewer"), "{found:?}");
}

/// A subdomain and a `[solve]`.
fn square_with(solve: &str) -> String {
    format!("[[subdomain]]\nnodes = [5, 5]\nrectangle = {{ from = [0, 0], to = [1, 1] }}\n[solve]\n{solve}\n")
}

#[test]
fn how_it_is_solved_is_read_from_file_and_options() {
    let text = square_with(
        "order = 3\nstar = 22\nstars = \"balanced\"\nsmoothing = 0.25\ntrial = \"mwls\"\ntest = \"trial\"\ngauss = 7\n\
         solver = \"iterative\"",
    );
    let solve = sound(&text, &Overrides::default()).solve;
    let given = SolveParams {
        formulation: Formulation::Variational,
        order: 3,
        star: Some(22),
        stars: Some(StarChoice::Balanced),
        smoothing: 0.25,
        trial: Trial::Mwls,
        test: Test::Trial,
        gauss: Some(7),
        solver: Solver::Iterative,
    };
    assert_eq!(solve.params(None), given);
    let options = Overrides {
        order: Some(1),
        star: Some(4),
        stars: Some("nearest".into()),
        smoothing: Some(0.0),
        trial: Some("blended".into()),
        test: Some("hat".into()),
        gauss: Some(12),
        solver: Some("auto".into()),
        ..Overrides::default()
    };
    let expected = SolveParams {
        order: 1,
        star: Some(4),
        stars: Some(StarChoice::Nearest),
        gauss: Some(12),
        ..SolveParams::default()
    };
    assert_eq!(sound(&text, &options).solve.params(None), expected);
}

#[test]
fn an_option_without_use_is_a_fault_and_a_key_of_the_file_is_only_where_its_own_formulation_has_none() {
    // The file says how it is solved; finite elements for comparison need no edit of it.
    let text = square_with("order = 3\ntrial = \"mwls\"");
    let fem = Overrides { formulation: Some("fem".into()), ..Overrides::default() };
    assert_eq!(sound(&text, &fem).solve.params(None).formulation, Formulation::Fem);
    let idle = Overrides { order: Some(3), gauss: Some(3), ..fem.clone() };
    assert_eq!(
        faults(&text, &idle),
        [
            "--order 3: `order` is given, and finite elements, which alone are used, are linear and have no stars; leave \
             it out, or choose formulation = \"variational\" or \"local\"",
            "--gauss 3: `gauss` is given, and belongs to the variational formulation, which no subdomain has; leave it \
             out, or choose formulation = \"variational\"",
        ]
    );
    let local = Overrides { formulation: Some("local".into()), order: Some(1), ..Overrides::default() };
    let found = faults(&text, &local);
    assert!(
        found.len() == 1 && found[0].starts_with("--order 1: `order` is 1, and the local formulation"),
        "{found:?}"
    );
    let star = Overrides { order: Some(4), ..Overrides::default() };
    let found = faults(&square_with("star = 9"), &star);
    assert!(found.len() == 1 && found[0].contains("fewer nodes than the 15 monomials of order 4"), "{found:?}");
}

#[test]
fn a_closed_parametric_edge_is_an_outline_of_one_vertex() {
    let text = r#"
[[subdomain]]
nodes = [9, 9]
outline = [[1, 0], { x = "cos(t)", y = "sin(t)*(1 + 0.3*cos(t))", t = [0, 6.283185307179586] }]
"#;
    assert_eq!(sound(text, &Overrides::default()).subdomains[0].contour.edges.len(), 1);
}

#[test]
fn adjacent_curves_written_differently_do_not_overlap() {
    let text = r#"
[[subdomain]]
nodes = [9, 9]
outline = [[-1, 0], [1, 0], { arc = { centre = [0, 0] } }]
[[subdomain]]
nodes = [9, 9]
outline = [[1, 0], [1, 2], [-1, 2], [-1, 0], { curve = "sqrt(1 - x^2)" }]
[[subdomain]]
nodes = [9, 9]
outline = [[-1, 0], { x = "cos(t)", y = "sin(t)", t = [3.141592653589793, 6.283185307179586] }, [1, 0]]
"#;
    sound(text, &Overrides::default());
}

#[test]
fn an_inclusion_may_fill_a_hole() {
    let text = r#"
[[subdomain]]
nodes = [9, 9]
rectangle = { from = [-2, -2], to = [2, 2] }
[[subdomain.hole]]
circle = { centre = [0, 0], radius = 1 }
[[subdomain]]
nodes = [9, 9]
circle = { centre = [0, 0], radius = 1 }
"#;
    sound(text, &Overrides::default());
}

#[test]
fn the_same_section_in_millimetres_and_kilometres_is_as_sound() {
    for scale in [1e-29, 1e-3, 1e3, 1e29] {
        let text = format!(
            "[[subdomain]]\nnodes = [9, 9]\noutline = [[{s:e}, 0], {{ arc = {{ centre = [0, 0] }} }}, [-{s:e}, 0]]\n\
             [[subdomain.hole]]\ncircle = {{ centre = [0, {:e}], radius = {:e} }}\n",
            0.4 * scale,
            0.2 * scale,
            s = scale
        );
        sound(&text, &Overrides::default());
        let touching = text
            .replace("[[subdomain.hole]]", "[[subdomain.hole]]\nname = \"low\"")
            .replace(&format!("{:e}]", 0.4 * scale), "0]");
        assert_eq!(faults(&touching, &Overrides::default()).len(), 1, "{touching}");
    }
}

#[test]
fn windows_line_ends_and_a_byte_order_mark_move_no_column() {
    let text = format!("\u{feff}{}", EVERYTHING.trim_start().replace('\n', "\r\n").replace("title", "titel"));
    let errors = parse(&text).unwrap_err();
    assert_eq!((errors.len(), errors[0].line, errors[0].column), (1, 1, 1));
    let text = text.replace("titel", "title").replace("star = 12", "star = 1");
    let errors = parse(&text).unwrap_err();
    assert_eq!((errors.len(), errors[0].line, errors[0].column), (1, 45, 8));
}

#[test]
fn a_file_of_faults_is_cut_after_a_hundred() {
    let text: String = (0..250).map(|k| format!("key{k} = {k}\n")).collect();
    let errors = parse(&text).unwrap_err();
    assert_eq!(errors.len(), 101);
    assert_eq!(errors[100].message, "and 151 more faults");
}

#[test]
fn deep_and_long_texts_are_refused_without_delay() {
    let started = Instant::now();
    let deep = format!("title = {}", "[".repeat(100_000));
    let formula = format!(
        "[[subdomain]]\nnodes = [5, 5]\noutline = [[0, 0], {{ curve = \"{}\" }}, [1, 0]]",
        "(".repeat(1_000_000)
    );
    let keys: String = (0..20_000).map(|k| format!("nodes{k} = {k}\n")).collect();
    for text in [deep, formula, keys] {
        assert!(parse(&text).is_err());
    }
    assert!(started.elapsed() < Duration::from_secs(10)); // milliseconds each; a shared machine may be slow
}

#[test]
fn a_thousand_subdomains_side_by_side_are_read_at_once() {
    let started = Instant::now();
    let text: String = (0..1000)
        .map(|k| {
            let (x, y) = (k % 40, k / 40);
            format!("[[subdomain]]\nnodes = [3, 3]\nrectangle = {{ from = [{x}, {y}], to = [{}, {}] }}\n", x + 1, y + 1)
        })
        .collect();
    assert_eq!(sound(&text, &Overrides::default()).subdomains.len(), 1000);
    assert!(started.elapsed() < Duration::from_secs(10)); // a fraction of a second
}

/// One change of a text.
#[derive(Clone, Debug)]
enum Damage {
    Delete(usize, usize),
    Repeat(usize, usize),
    Insert(usize, String),
    Swap(usize, usize),
}

/// Words that files hold, and some that they should not.
const TOKENS: &[&str] = &[
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    ",",
    "=",
    "\n",
    "#",
    ".",
    "[[subdomain]]\n",
    "[[subdomain.hole]]\n",
    "[solve]\n",
    "nan",
    "-inf",
    "1e300",
    "-1",
    "0",
    "1e-300",
    "99999999999999999999",
    "true",
    "1979-05-27",
    "\"e1\"",
    "outline = [",
    "nodes",
    "[2, 0], ",
    "{ line = true }, ",
    "{ curve = \"1/x\" }, ",
    "{ arc = { centre = [1, 0] } }, ",
    "\\u0000",
    "é",
    "\u{feff}",
    "circle = { centre = [0, 0], radius = 1 }\n",
    "1e-9",
    "0x7f",
    "\"\"\"",
];

fn damage() -> impl Strategy<Value = Damage> {
    prop_oneof![
        (any::<prop::sample::Index>(), 1usize..12).prop_map(|(at, n)| Damage::Delete(at.index(EVERYTHING.len()), n)),
        (any::<prop::sample::Index>(), 1usize..60).prop_map(|(at, n)| Damage::Repeat(at.index(EVERYTHING.len()), n)),
        (any::<prop::sample::Index>(), prop::sample::select(TOKENS))
            .prop_map(|(at, token)| Damage::Insert(at.index(EVERYTHING.len()), token.to_owned())),
        (any::<prop::sample::Index>(), any::<char>())
            .prop_map(|(at, c)| Damage::Insert(at.index(EVERYTHING.len()), c.to_string())),
        (any::<prop::sample::Index>(), any::<prop::sample::Index>())
            .prop_map(|(a, b)| Damage::Swap(a.index(EVERYTHING.len()), b.index(EVERYTHING.len()))),
    ]
}

/// Tokens and words of the file, with the blanks between them: where they are exchanged the syntax mostly survives.
fn tokens(text: &str) -> Vec<&str> {
    text.split_inclusive(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.' | '-'))).collect()
}

impl Damage {
    fn apply(&self, text: &str) -> String {
        let boundary = |at: usize| (0..=at.min(text.len())).rev().find(|&k| text.is_char_boundary(k)).unwrap_or(0);
        match self {
            Self::Delete(at, n) => {
                let (from, to) = (boundary(*at), boundary(at + n));
                format!("{}{}", &text[..from], &text[to..])
            }
            Self::Repeat(at, n) => {
                let (from, to) = (boundary(*at), boundary(at + n));
                format!("{}{}", &text[..to], &text[from..])
            }
            Self::Insert(at, token) => {
                let at = boundary(*at);
                format!("{}{token}{}", &text[..at], &text[at..])
            }
            Self::Swap(a, b) => {
                let mut all = tokens(text);
                let n = all.len();
                if n > 0 {
                    all.swap(a % n, b % n);
                }
                all.concat()
            }
        }
    }
}

/// What holds of every answer, whatever the text.
fn answers_soundly(text: &str) -> Result<(), TestCaseError> {
    let started = Instant::now();
    match parse(text) {
        Ok(problem) => prop_assert!(!problem.subdomains.is_empty()),
        Err(errors) => {
            prop_assert!(!errors.is_empty() && errors.len() <= 101);
            for error in &errors {
                prop_assert!(
                    error.line >= 1 && error.column >= 1 && !error.message.is_empty() && !error.remedy.is_empty()
                );
                prop_assert!(error.line <= 1 + text.matches('\n').count());
                prop_assert!(error.span.start <= error.span.end && error.span.end <= text.len(), "{error:?}");
                prop_assert!(!error.to_string().contains(char::is_control), "{error:?}");
            }
        }
    }
    prop_assert!(started.elapsed() < Duration::from_secs(5)); // milliseconds; a shared machine may be slow
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn no_damage_panics_or_takes_long(damages in prop::collection::vec(damage(), 1..4)) {
        answers_soundly(&damages.iter().fold(EVERYTHING.to_owned(), |text, damage| damage.apply(&text)))?;
    }

    #[test]
    fn no_text_panics(text in "\\PC{0,200}") {
        answers_soundly(&text)?;
    }

    #[test]
    fn no_outline_panics(corners in prop::collection::vec((-3i32..4, -3i32..4, 0usize..9), 0..9)) {
        let edges = ["", "", "", "", "{ line = true }, ", "{ curve = \"1/x\" }, ", "{ curve = \"x^2\" }, ",
            "{ arc = { centre = [0, 0] } }, ", "{ x = \"t\", y = \"t^2\", t = [-1, 1] }, "];
        let items: String = corners.iter().map(|(x, y, edge)| format!("[{x}, {y}], {}", edges[*edge])).collect();
        answers_soundly(&format!("[[subdomain]]\nnodes = [5, 5]\noutline = [{items}]"))?;
    }
}
