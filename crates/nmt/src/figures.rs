//! The pictures of a run: nodes, mesh and the four panels of the solution, from the pipeline's data.

use crate::edges::{EdgeTable, loop_name};
use crate::pipeline::{MeshPart, PoissonPart, Solved, SolvedPart};
use crate::plot::{
    Caption, EdgeProfile, Fields, NodeMark, Part, PoissonFields, Profiles, StarFigure, StarNode, edges_figure,
    histogram_figure, indicator_figure, mesh_figure, nodes_figure, poisson_figure, solution_figure, star_figure,
};
use crate::problem::Problem;
use crate::star::StarView;
use nmt_cloud::{Cloud, NodeKind};
use nmt_geom::{LoopId, NodeId};
use nmt_mfdm::{EdgePoint, EdgeStress};
use nmt_tri::{Mesh, Stages, quality};

/// What a picture needs of one cloud or mesh, in the plain form that [`crate::plot`] takes.
struct Drawn<'a> {
    name: &'a str,
    cloud: &'a Cloud,
    marks: Vec<NodeMark>,
    spacings: Vec<f64>, // of a graded cloud
    loops: Vec<Vec<u32>>,
    triangles: Vec<[u32; 3]>,
}

impl<'a> Drawn<'a> {
    fn of_cloud(name: &'a str, cloud: &'a Cloud) -> Self {
        let mark = |node: usize| match cloud.kind(NodeId::of(node)) {
            NodeKind::Vertex => NodeMark::Vertex,
            NodeKind::Edge => NodeMark::Edge,
            NodeKind::Interior => NodeMark::Interior,
        };
        let boundary = cloud.boundary();
        let ring = |k: usize| boundary.loop_segments(LoopId::of(k)).iter().map(|s| s.from.0).collect();
        Self {
            name,
            cloud,
            marks: (0..cloud.n_nodes()).map(mark).collect(),
            spacings: match cloud.is_graded() {
                true => (0..cloud.n_nodes()).map(|node| cloud.local_spacing(NodeId::of(node))).collect(),
                false => Vec::new(),
            },
            loops: (0..boundary.n_loops()).map(ring).collect(),
            triangles: Vec::new(),
        }
    }

    fn of_mesh(name: &'a str, mesh: &'a Mesh) -> Self {
        let triangles = mesh.tri_nodes().iter().map(|nodes| nodes.map(|node| node.0)).collect();
        Self { triangles, ..Self::of_cloud(name, mesh.cloud()) }
    }

    fn part(&self) -> Part<'_> {
        Part {
            name: self.name,
            xy: self.cloud.xy(),
            marks: &self.marks,
            spacings: &self.spacings,
            loops: &self.loops,
            triangles: &self.triangles,
        }
    }
}

fn caption(problem: &Problem) -> Caption<'_> {
    Caption { title: &problem.title, units: &problem.units }
}

/// nodes.svg of clouds.
pub fn nodes_svg<'a>(problem: &Problem, parts: impl IntoIterator<Item = (&'a str, &'a Cloud)>) -> String {
    let drawn: Vec<Drawn> = parts.into_iter().map(|(name, cloud)| Drawn::of_cloud(name, cloud)).collect();
    nodes_figure(&caption(problem), &drawn.iter().map(Drawn::part).collect::<Vec<_>>())
}

/// mesh.svg of meshes.
pub fn mesh_svg<'a>(problem: &Problem, parts: impl IntoIterator<Item = (&'a str, &'a Mesh)>) -> String {
    let drawn: Vec<Drawn> = parts.into_iter().map(|(name, mesh)| Drawn::of_mesh(name, mesh)).collect();
    mesh_figure(&caption(problem), &drawn.iter().map(Drawn::part).collect::<Vec<_>>())
}

/// quality.svg: shapes of the triangles of all subdomains, before and after smoothing where there was any.
pub fn quality_svg(problem: &Problem, parts: &[MeshPart]) -> String {
    let sum = |all: &mut dyn Iterator<Item = [usize; 10]>| {
        all.fold([0; 10], |sum, counts| std::array::from_fn(|k| sum[k] + counts[k]))
    };
    let after = sum(&mut parts.iter().filter_map(|part| quality(&part.mesh)).map(|q| q.histogram));
    let smoothed = parts.iter().any(|part| part.smoothing.is_some());
    let before = sum(&mut parts.iter().filter_map(|part| Some(part.smoothing.as_ref()?.before.histogram)));
    histogram_figure(&caption(problem), smoothed.then_some(before), after)
}

/// The paper's way to a mesh in four pictures, as in its Fig. 11: the cloud, its Delaunay triangles, what elimination leaves,
/// and the completed mesh.
pub fn stages_svg(units: &str, name: &str, cloud: &Cloud, stages: &Stages) -> [String; 4] {
    let picture = |title: &str, triangles: Option<&[[NodeId; 3]]>| {
        let mut drawn = Drawn::of_cloud(name, cloud);
        let caption = Caption { title, units };
        let Some(triangles) = triangles else { return nodes_figure(&caption, &[drawn.part()]) };
        drawn.triangles = triangles.iter().map(|nodes| nodes.map(|node| node.0)).collect();
        mesh_figure(&caption, &[drawn.part()])
    };
    [
        picture("a) Cloud of nodes", None),
        picture("b) Delaunay triangles of all nodes", Some(&stages.delaunay)),
        picture("c) After elimination", Some(&stages.eliminated)),
        picture("d) After completion", Some(&stages.completed)),
    ]
}

/// solution.svg: F, τ_zx, τ_zy and τ.
pub fn solution_svg(problem: &Problem, parts: &[SolvedPart]) -> String {
    struct Values {
        tau_zx: Vec<f64>,
        tau_zy: Vec<f64>,
        tau: Vec<f64>,
    }
    let values = |solved: &SolvedPart| {
        let stress = |node: usize| solved.solution.stress_at_node(NodeId::of(node));
        let stresses: Vec<_> = (0..solved.part.mesh.cloud().n_nodes()).map(stress).collect();
        Values {
            tau_zx: stresses.iter().map(|s| s.zx).collect(),
            tau_zy: stresses.iter().map(|s| s.zy).collect(),
            tau: stresses.iter().map(|s| s.magnitude()).collect(),
        }
    };
    let drawn: Vec<(Drawn, Values)> =
        parts.iter().map(|s| (Drawn::of_mesh(&s.part.name, &s.part.mesh), values(s))).collect();
    let figures: Vec<(Part, Fields)> = drawn
        .iter()
        .zip(parts)
        .map(|((drawn, values), solved)| {
            let Values { tau_zx, tau_zy, tau } = values;
            (drawn.part(), Fields { f: &solved.solution.f, tau_zx, tau_zy, tau })
        })
        .collect();
    solution_figure(&caption(problem), &figures)
}

/// error.svg: where the errors of J come from, as log₁₀ of what the triangles around a node contribute to the relative error of J,
/// over their share of the area; `None` where no error is estimated.
pub fn error_svg(problem: &Problem, parts: &[SolvedPart]) -> Option<String> {
    let drawn: Vec<(Drawn, Vec<f64>)> =
        parts.iter().filter_map(|s| Some((Drawn::of_mesh(&s.part.name, &s.part.mesh), error_density(s)?))).collect();
    let figures: Vec<(Part, &[f64])> = drawn.iter().map(|(drawn, values)| (drawn.part(), values.as_slice())).collect();
    (!figures.is_empty()).then(|| indicator_figure(&caption(problem), &figures))
}

/// log₁₀ of the density of the relative error of J at nodes.
fn error_density(solved: &SolvedPart) -> Option<Vec<f64>> {
    let (estimate, mesh) = (solved.estimate.made()?, &solved.part.mesh);
    let mut sums = vec![[0.0; 2]; mesh.cloud().n_nodes()];
    for (t, own) in mesh.triangles().zip(&estimate.indicators) {
        for node in mesh.tri_nodes()[t.index()] {
            sums[node.index()][0] += own;
            sums[node.index()][1] += mesh.area(t);
        }
    }
    let scale = mesh.total_area() / solved.solution.j.abs();
    // What is rounding is drawn as that, not as an abyss.
    let log = |[own, area]: [f64; 2]| (scale * own / area).max(f64::EPSILON * f64::EPSILON).log10();
    Some(sums.into_iter().map(log).collect())
}

/// edges.svg: τ along the edges of every subdomain.
pub fn edges_svg(problem: &Problem, parts: &[SolvedPart]) -> String {
    /// Slices of one edge, to be lent to its profile.
    struct Along {
        ring: LoopId,
        xy: Vec<[f64; 2]>,
        s: Vec<f64>,
        tau: Vec<f64>,
    }
    let tables: Vec<EdgeTable> = parts.iter().map(EdgeTable::of).collect();
    let of_edges = |(solved, table): (&SolvedPart, &EdgeTable)| -> Vec<Along> {
        let nodes = solved.part.mesh.xy();
        let along = |edge: &EdgeStress| Along {
            ring: edge.ring,
            xy: edge.points.iter().map(|p| nodes[p.node.index()]).collect(),
            s: edge.points.iter().map(|p| p.s).collect(),
            tau: edge.points.iter().map(|p| p.stress.magnitude()).collect(),
        };
        table.edges.iter().map(along).collect()
    };
    let edges: Vec<Vec<Along>> = parts.iter().zip(&tables).map(of_edges).collect();
    let loops_of = |k: usize| -> Vec<Vec<EdgeProfile>> {
        let (solved, table) = (&parts[k], &tables[k]);
        let is_singular = |point: Option<&EdgePoint>| point.is_some_and(|p| table.is_singular(p.node));
        let mut loops: Vec<Vec<EdgeProfile>> = table.loops.iter().map(|_| Vec::new()).collect();
        for (edge, along) in table.edges.iter().zip(&edges[k]) {
            let Along { ring, xy, s, tau } = along;
            let name = solved.part.edge_names.get(edge.edge.index()).map_or("", String::as_str);
            let is_singular = [edge.points.first(), edge.points.last()].map(is_singular);
            loops[ring.index()].push(EdgeProfile { name, length: edge.length, xy, s, tau, is_singular });
        }
        loops
    };
    let loops: Vec<Vec<Vec<EdgeProfile>>> = (0..parts.len()).map(loops_of).collect();
    let names_of = |(solved, table): (&'_ SolvedPart, &EdgeTable)| -> Vec<String> {
        table.loops.iter().map(|around| loop_name(solved, around.ring).to_owned()).collect()
    };
    let names: Vec<Vec<String>> = parts.iter().zip(&tables).map(names_of).collect();
    let names: Vec<Vec<&str>> = names.iter().map(|own| own.iter().map(String::as_str).collect()).collect();
    let profiles = parts.iter().zip(&loops).zip(&names);
    let profiles: Vec<Profiles> = profiles
        .map(|((solved, loops), names)| Profiles { name: &solved.part.name, loop_names: names, loops })
        .collect();
    edges_figure(&caption(problem), &profiles)
}

/// solution.svg of a Poisson problem: u, its derivatives, and its error where the exact solution is given, otherwise |∇u|.
pub fn poisson_svg(problem: &Problem, parts: &[PoissonPart]) -> String {
    struct Values {
        u_x: Vec<f64>,
        u_y: Vec<f64>,
        gradient: Vec<f64>,
        error: Option<Vec<f64>>,
    }
    let values = |solved: &PoissonPart| {
        let gradients = solved.gradients();
        Values {
            u_x: gradients.iter().map(|g| g[0]).collect(),
            u_y: gradients.iter().map(|g| g[1]).collect(),
            gradient: gradients.iter().map(|g| g[0].hypot(g[1])).collect(),
            error: solved.error_at_nodes(),
        }
    };
    let drawn: Vec<(Drawn, Values)> =
        parts.iter().map(|s| (Drawn::of_mesh(&s.part.name, &s.part.mesh), values(s))).collect();
    let figures: Vec<(Part, PoissonFields)> = drawn
        .iter()
        .zip(parts)
        .map(|((drawn, values), solved)| {
            let Values { u_x, u_y, gradient, error } = values;
            let error = error.as_deref();
            (drawn.part(), PoissonFields { u: &solved.solution.u, u_x, u_y, gradient, error })
        })
        .collect();
    poisson_figure(&caption(problem), &figures)
}

/// solution.svg of whatever was solved.
pub fn solved_svg(problem: &Problem, solved: &Solved) -> String {
    match solved {
        Solved::Torsion(parts) => solution_svg(problem, parts),
        Solved::Poisson(parts) => poisson_svg(problem, parts),
    }
}

/// star-N.svg: the star of one node.
pub fn star_svg(problem: &Problem, view: &StarView) -> String {
    let StarView { part, star, .. } = view;
    let drawn = Drawn::of_mesh(&part.name, &part.mesh);
    let node = |member: &nmt_mfdm::StarMember| StarNode {
        node: member.node.0,
        weight: member.weight,
        laplacian: member.laplacian,
    };
    let figure = StarFigure {
        part: drawn.part(),
        node: star.node.0,
        members: &star.members.iter().map(node).collect::<Vec<_>>(),
        hidden: &star.hidden.iter().map(|node| node.0).collect::<Vec<_>>(),
        semi_axes: star.stretch.map(|stretch| star.radius / stretch),
        about: &view.about(),
    };
    star_figure(&caption(problem), &figure)
}
