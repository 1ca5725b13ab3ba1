//! The variational formulation with the trial functions as test functions (Bubnov–Galerkin); paper, eq. (18).

use crate::assembly::{Frame, Setting, dirichlet_row};
use crate::error::MfdmError;
use crate::gauss::Rule;
use crate::parallel::map_chunks;
use crate::row_sum::RowSum;
use crate::shapes::{ShapeFinder, Shapes, TrialSpace};
use crate::system::{Equation, LinearSystem, Role};
use crate::true_edges::of_triangle;
use crate::weak::places;
use nmt_geom::{NodeId, TriId};

/// Triangles whose matrices are held at a time.
const BATCH: usize = 4096;

/// ∫∇φ_i·∇φ_j and ∫s·φ_i + ∫q·φ_i over one triangle.
struct Element {
    nodes: Vec<NodeId>,
    matrix: Vec<f64>, // shape (n, n)
    load: Vec<f64>,
}

/// One equation an unknown: ∫∇u·∇φ_i = ∫s·φ_i + ∫q·φ_i with the node's own shape function φ_i.
///
/// Triangles are summed in their order, so that the result does not depend on the number of threads.
pub(crate) fn assemble(setting: &Setting, space: TrialSpace, rule: &Rule) -> Result<LinearSystem, MfdmError> {
    let Frame { mesh, roles, .. } = setting.frame;
    let n_nodes = mesh.cloud().n_nodes();
    let mut rows: Vec<Row> = (0..n_nodes).map(|_| Row::default()).collect();
    for first in (0..mesh.n_triangles()).step_by(BATCH) {
        let pieces = map_chunks(first..(first + BATCH).min(mesh.n_triangles()), |piece| {
            let (mut finder, mut shapes) = (ShapeFinder::new(space), Shapes::default());
            piece
                .map(|t| element(setting.frame, rule, TriId::of(t), &mut finder, &mut shapes))
                .collect::<Result<Vec<_>, _>>()
        });
        for piece in pieces {
            for Element { nodes, matrix, load } in piece? {
                for (i, test) in nodes.iter().enumerate() {
                    if matches!(roles.of(*test), Role::Unknown(_)) {
                        rows[test.index()].add(&nodes, &matrix[i * nodes.len()..(i + 1) * nodes.len()], load[i]);
                    }
                }
            }
        }
    }
    let mut sum = RowSum::new(n_nodes);
    let equation = |k: usize| {
        let node = roles.node(k);
        if let Some(equation) = dirichlet_row(setting, node, &mut sum)? {
            return Ok(equation);
        }
        let row = std::mem::take(&mut rows[node.index()]);
        row.entries.iter().for_each(|&(other, value)| sum.add(other, value));
        Ok(Equation { row: sum.take(roles), rhs: row.load })
    };
    LinearSystem::of(roles, (0..roles.n_unknowns).map(equation))
}

fn element(
    frame: Frame,
    rule: &Rule,
    t: TriId,
    finder: &mut ShapeFinder,
    shapes: &mut Shapes,
) -> Result<Element, MfdmError> {
    let mut samples = Vec::new();
    let mut sample = |p, weight: f64, load: f64| {
        finder.at(t, p, shapes)?;
        samples.push(Sampled { shapes: shapes.clone(), weight, load });
        Ok::<(), MfdmError>(())
    };
    for (p, weight) in places(frame.mesh, rule, frame.fluxes, t) {
        sample(p, weight, weight * frame.source.at(p)?)?;
    }
    for flux in of_triangle(&frame.fluxes.edges, t) {
        sample(flux.at, 0.0, flux.weight)?;
    }
    let mut nodes: Vec<NodeId> = samples.iter().flat_map(|sample| sample.shapes.nodes.iter().copied()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let n = nodes.len();
    let (mut matrix, mut load) = (vec![0.0; n * n], vec![0.0; n]);
    for Sampled { shapes, weight, load: own } in &samples {
        let slots: Vec<usize> = shapes.nodes.iter().map(|node| nodes.partition_point(|other| other < node)).collect();
        for (i, &row) in slots.iter().enumerate() {
            load[row] += own * shapes.value[i];
            for (j, &column) in slots.iter().enumerate() {
                let product = shapes.by_x[i] * shapes.by_x[j] + shapes.by_y[i] * shapes.by_y[j];
                matrix[row * n + column] += weight * product;
            }
        }
    }
    Ok(Element { nodes, matrix, load })
}

/// Shape functions at one Gauss point.
struct Sampled {
    shapes: Shapes,
    weight: f64,
    load: f64,
}

/// A row that grows by triangles; equal columns are summed when it has doubled.
#[derive(Default)]
struct Row {
    entries: Vec<(NodeId, f64)>,
    summed: usize, // length when last summed
    load: f64,
}

impl Row {
    fn add(&mut self, nodes: &[NodeId], values: &[f64], load: f64) {
        self.entries.extend(nodes.iter().copied().zip(values.iter().copied()));
        self.load += load;
        if self.entries.len() > 2 * self.summed + 64 {
            // Stable: equal columns stay in the order of their triangles.
            self.entries.sort_by_key(|(node, _)| *node);
            self.entries.dedup_by(|later, kept| {
                let same = later.0 == kept.0;
                if same {
                    kept.1 += later.1;
                }
                same
            });
            self.summed = self.entries.len();
        }
    }
}
