//! Graded clouds: stars from all sides without being told, and a multigrid that does not feel the spacings.

use nmt_cloud::{CloudParams, Grading, Section, generate};
use nmt_curve::Outline;
use nmt_geom::EdgeId;
use nmt_mfdm::{Formulation, SolveParams, StarChoice, TorsionProblem, TorsionSolution, solve};
use nmt_tri::Mesh;

/// A section with its re-entrant corners, the spacing far from them, and J.
struct Case {
    name: &'static str,
    section: Section,
    nodes: [usize; 2],
    corners: Vec<[f64; 2]>,
    j: f64, // two independent high-order solutions to 11 digits
}

fn cases() -> [Case; 3] {
    let polygon = |points: &[[f64; 2]]| Section::solid(Outline::polygon(points.iter().copied()));
    let l = polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
    let (floor, tops) = ([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [3.0, 3.0]], [[1.0, 3.0], [0.0, 3.0]]);
    let u = polygon(&[&floor[..], &[[3.0, 1.0], [1.0, 1.0]], &tops].concat());
    let thick_box = Section {
        contour: Outline::rectangle([0.0, 0.0], [4.0, 3.0]),
        holes: vec![Outline::rectangle([1.0, 1.0], [3.0, 2.0])],
    };
    let of_box = vec![[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.0, 2.0]];
    [
        Case { name: "L", section: l, nodes: [41, 41], corners: vec![[1.0, 1.0]], j: 0.856_303_210_746_053_2 },
        Case {
            name: "U",
            section: u,
            nodes: [61, 46],
            corners: vec![[3.0, 1.0], [1.0, 1.0]],
            j: 2.601_318_121_960_135,
        },
        Case { name: "box", section: thick_box, nodes: [61, 46], corners: of_box, j: 18.754_147_777_315_97 },
    ]
}

/// Spacings in a ratio of 5000 (L) to 7000.
fn towards(corners: &[[f64; 2]]) -> Grading {
    corners.iter().fold(Grading::default(), |grading, &corner| grading.near(corner, 1e-5, 0.2))
}

fn mesh(section: &Section, params: &CloudParams) -> Mesh {
    let mesh = Mesh::constrained(generate(section, params).expect("a cloud")).expect("a mesh");
    assert_eq!(mesh.check(), Ok(()));
    mesh
}

fn solved(mesh: &Mesh, params: &SolveParams) -> TorsionSolution {
    solve(&TorsionProblem::default(), mesh, params).expect("a solution")
}

#[test]
fn stars_of_graded_clouds_are_balanced_unless_told_and_gain_a_digit() {
    for case in cases() {
        let clouds = [(0.0, 1), (0.25, 1), (0.25, 2), (0.25, 3)].map(|(irregularity, seed)| {
            let (nodes, grading) = (case.nodes, Some(towards(&case.corners)));
            mesh(&case.section, &CloudParams { nodes, irregularity, seed, grading, ..CloudParams::default() })
        });
        // Bounds and what was measured of the largest error: L, U, box.
        let bounds = [
            (Formulation::Local, 2, 4e-4),       // 9.9e-5, 1.8e-4, 2.3e-4
            (Formulation::Local, 4, 8e-5),       // 3.2e-5, 1.7e-5, 8e-6
            (Formulation::Variational, 2, 5e-5), // 2.2e-5, 1.2e-5, 9.9e-6
        ];
        for (formulation, order, bound) in bounds {
            let errors = |stars: Option<StarChoice>| {
                let params = SolveParams { formulation, order, stars, ..SolveParams::default() };
                clouds.each_ref().map(|mesh| {
                    let solution = solved(mesh, &params);
                    assert_eq!(solution.stars.choice, stars.unwrap_or(StarChoice::Balanced));
                    (solution.j / case.j - 1.0).abs()
                })
            };
            let (found, nearest) = (errors(None), errors(Some(StarChoice::Nearest)));
            println!("{} {} {order}: {found:?}, nearest {nearest:?}", case.name, formulation.name());
            assert!(found.iter().all(|error| *error < bound), "{} {order}: {found:?}", case.name);
            // The regular cloud, where nothing else hides what the change of level does: a third at least, a tenth of local 2.
            assert!(3.0 * found[0] < nearest[0], "{} {order}: {found:?}, {nearest:?}", case.name);
        }
        // Where nothing is to be gained, and on uniform clouds, stars are the nearest.
        let third = SolveParams { order: 3, ..SolveParams::default() };
        assert_eq!(solved(&clouds[0], &third).stars.choice, StarChoice::Nearest);
        let uniform = mesh(&case.section, &CloudParams { nodes: case.nodes, ..CloudParams::default() });
        assert_eq!(solved(&uniform, &SolveParams::default()).stars.choice, StarChoice::Nearest);
    }
}

#[test]
fn iterations_on_graded_clouds_are_at_most_twice_those_on_uniform_ones() {
    let plate = Section {
        contour: Outline::rectangle([-1.0, -1.0], [1.0, 1.0]),
        holes: [[0.3, 0.2], [-0.5, 0.5], [-0.4, -0.3], [0.6, -0.6]].map(|at| Outline::circle(at, 0.01)).into(),
    };
    let around = (4..8).fold(Grading::default(), |grading, edge| grading.along(EdgeId::of(edge), 1e-3, 0.1));
    let [l, u, thick_box] = cases().map(|case| {
        let gradual = case.corners.iter().fold(Grading::default(), |g, &corner| g.near(corner, 1e-6, 0.1));
        (case.name, case.section, gradual)
    });
    // Densities that give as many unknowns graded and uniform: where the multigrid is used by itself.
    let sections = [
        (l, [203, 203], [215, 215]),
        (u, [225, 169], [253, 190]),
        (thick_box, [185, 139], [229, 172]),
        (("plate", plate, around), [161, 161], [178, 178]),
    ];
    for ((name, section, grading), graded, uniform) in sections {
        let cloud = CloudParams { irregularity: 0.25, seed: 1, ..CloudParams::default() };
        let graded = mesh(&section, &CloudParams { nodes: graded, grading: Some(grading), ..cloud.clone() });
        let uniform = mesh(&section, &CloudParams { nodes: uniform, ..cloud });
        for formulation in Formulation::MESHLESS {
            let iterations = |mesh: &Mesh| {
                let solution = solved(mesh, &SolveParams { formulation, ..SolveParams::default() });
                let TorsionSolution { unknowns, linear, .. } = &solution;
                assert!((30_000..40_000).contains(unknowns) && !linear.fell_back, "{name}: {unknowns}, {linear:?}");
                linear.iteration.expect("an iteration").iterations
            };
            let counts = [&graded, &uniform].map(iterations);
            println!("{name} {}: {counts:?}", formulation.name());
            assert!(counts[0] <= 2 * counts[1], "{name} {}: {counts:?}", formulation.name()); // 7 to 9 and 7 to 8
        }
    }
}
