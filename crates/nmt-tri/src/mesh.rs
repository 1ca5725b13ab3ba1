//! The mesh: a cloud and the triangles on it.

use crate::adjacency::edges;
use crate::carve::carve;
use crate::delaunay::constrained;
use crate::error::MeshError;
use crate::lattice::triangulate;
use crate::order::in_order;
use crate::ties::{Placed, settle};
use crate::unconstrained::{Elimination, MeshCensus, Stages, stages};
use nmt_cloud::Cloud;
use nmt_geom::point::{cross, sub};
use nmt_geom::{NodeId, Point, TriId};

/// Triangles on exactly the nodes of a cloud, none added, none lost.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    cloud: Cloud,
    tri_nodes: Vec<[NodeId; 3]>, // shape (n_triangles, 3), counter-clockwise, smallest node first, sorted
}

/// Relative difference between the sum of the triangles' areas and the polygon's that rounding explains.
///
/// A sum of n terms rounds to √n·1e-16; with 10⁶ triangles 1e-13.
const AREA_REL: f64 = 1.0e-12;

/// Triangles that are summed at a time.
const PART: usize = 1024;

impl Mesh {
    /// The constrained Delaunay triangulation of the cloud, cut to its real boundary.
    ///
    /// Where four nodes lie on one circle the diagonal that contains the smallest node number is taken; triangles begin
    /// with their smallest node and are sorted, so that the mesh is a function of the cloud alone. A cloud that was
    /// generated on a lattice is triangulated by way of it, any other by [`Self::constrained_general`].
    ///
    /// # Errors
    /// [`MeshError`] where two nodes coincide, or a segment of the real boundary is crossed.
    ///
    /// ```
    /// use nmt_cloud::{CloudParams, Section, generate};
    /// use nmt_curve::Outline;
    /// use nmt_tri::Mesh;
    ///
    /// let plate = Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0]));
    /// let cloud = generate(&plate, &CloudParams { nodes: [5, 3], ..CloudParams::default() })?;
    /// let mesh = Mesh::constrained(cloud)?;
    /// assert_eq!(mesh.n_triangles(), 16);
    /// assert_eq!(mesh.check(), Ok(()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn constrained(cloud: Cloud) -> Result<Self, MeshError> {
        match triangulate(&cloud) {
            Some(tri_nodes) => Ok(Self { cloud, tri_nodes }),
            None => Self::constrained_general(cloud),
        }
    }

    /// [`Self::constrained`] for any cloud, whether it was born on a lattice or not: slower, with the same triangles.
    ///
    /// # Errors
    /// Those of [`Self::constrained`].
    pub fn constrained_general(cloud: Cloud) -> Result<Self, MeshError> {
        let mut placed = Placed { xy: cloud.xy(), triangles: carve(&cloud, constrained(&cloud)?)? };
        let n_sides = 3 * placed.triangles.nodes.len() as u32;
        settle(&mut placed, 0..n_sides);
        let nodes = placed.triangles.nodes;
        let tri_nodes = in_order(cloud.n_nodes(), || nodes.iter().copied());
        Ok(Self { cloud, tri_nodes })
    }

    /// The paper's own way (Sec. 5): Delaunay of all nodes, elimination of what does not belong, completion of what is
    /// missing; with the triangles by step.
    ///
    /// Steps that `elimination` switches off are left out, and the result may then be no sound mesh: see [`Self::check`].
    ///
    /// # Errors
    /// [`MeshError`] where two nodes coincide, or a segment of the real boundary stays bare although completion is asked
    /// for.
    ///
    /// ```
    /// use nmt_cloud::{CloudParams, Section, generate};
    /// use nmt_curve::Outline;
    /// use nmt_tri::{Elimination, Mesh};
    ///
    /// let l = Section::solid(Outline::polygon([[0., 0.], [2., 0.], [2., 1.], [1., 1.], [1., 2.], [0., 2.]]));
    /// let cloud = generate(&l, &CloudParams { nodes: [9, 9], ..CloudParams::default() })?;
    /// let (mesh, census) = Mesh::unconstrained(cloud, &Elimination::default())?;
    /// assert_eq!(mesh.check(), Ok(()));
    /// assert!(census.outside > 0 && census.completed == 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn unconstrained(cloud: Cloud, elimination: &Elimination) -> Result<(Self, MeshCensus), MeshError> {
        let Stages { completed, census, .. } = stages(&cloud, elimination)?;
        Ok((Self { cloud, tri_nodes: completed }, census))
    }

    /// [`Self::constrained`] by way of the cloud's lattice; `None` where the general way is taken instead. For tests.
    #[doc(hidden)]
    pub fn constrained_on_lattice(cloud: Cloud) -> Option<Self> {
        triangulate(&cloud).map(|tri_nodes| Self { cloud, tri_nodes })
    }

    /// The cloud it stands on.
    pub fn cloud(&self) -> &Cloud {
        &self.cloud
    }

    /// Coordinates of the nodes, shape (n_nodes, 2), user's length unit.
    pub fn xy(&self) -> &[Point] {
        self.cloud.xy()
    }

    /// Nodes of each triangle, shape (n_triangles, 3), counter-clockwise.
    pub fn tri_nodes(&self) -> &[[NodeId; 3]] {
        &self.tri_nodes
    }

    /// Number of triangles.
    pub fn n_triangles(&self) -> usize {
        self.tri_nodes.len()
    }

    /// Corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: TriId) -> [Point; 3] {
        self.tri_nodes[triangle.index()].map(|node| self.xy()[node.index()])
    }

    /// Area of a triangle by cross product \[D9\], square of the user's length unit.
    #[inline]
    pub fn area(&self, triangle: TriId) -> f64 {
        let [a, b, c] = self.corners(triangle);
        cross(sub(b, a), sub(c, a)) / 2.0
    }

    /// Sum of the triangles' areas.
    pub fn total_area(&self) -> f64 {
        self.triangles().map(|t| self.area(t)).sum()
    }

    /// Centroid of the area.
    pub fn centroid(&self) -> Point {
        let origin = self.cloud.boundary().envelope().min;
        let (mut area, mut moment) = (0.0, [0.0; 2]);
        for t in self.triangles() {
            let a = self.area(t);
            area += a;
            let corners = self.corners(t);
            (0..2).for_each(|d| moment[d] += a * corners.iter().map(|p| p[d] - origin[d]).sum::<f64>() / 3.0);
        }
        [origin[0] + moment[0] / area, origin[1] + moment[1] / area]
    }

    /// All triangles by number.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = TriId> + use<> {
        (0..self.tri_nodes.len() as u32).map(TriId)
    }

    /// Checks the invariants of a finished mesh: areas positive and summing to the polygon's, every interior edge in two
    /// triangles and every boundary segment in one, V − E + T = 1 − holes, every node in some triangle.
    ///
    /// Areas count as they are computed, for gradients are divided by them: one that is positive but for rounding is none.
    ///
    /// # Errors
    /// The first invariant that is broken.
    pub fn check(&self) -> Result<(), MeshError> {
        let nodes = |t: TriId| self.tri_nodes[t.index()].map(NodeId::index);
        if let Some(t) = self.triangles().find(|&t| self.area(t) <= 0.0) {
            return Err(MeshError::FlatTriangle { triangle: t.index(), nodes: nodes(t), area: self.area(t) });
        }
        // Summed in two stages: straight on, the equal cells of 10⁶ regular nodes round the same way, to 1e-11.
        let part = |first: usize| -> f64 { self.triangles().skip(first).take(PART).map(|t| self.area(t)).sum() };
        let sum: f64 = (0..self.n_triangles()).step_by(PART).map(part).sum();
        let area = self.cloud.boundary().area();
        if (sum - area).abs() > AREA_REL * area {
            return Err(MeshError::Area { sum, area });
        }
        let boundary = self.cloud.boundary();
        let mut expected: Vec<[u32; 2]> =
            boundary.segments().iter().map(|s| [s.from.0.min(s.to.0), s.from.0.max(s.to.0)]).collect();
        expected.sort_unstable();
        let edges = edges(&self.tri_nodes);
        for edge in &edges {
            let on_boundary = expected.binary_search(&edge.nodes).is_ok();
            let wanted = if on_boundary { 1 } else { 2 };
            if edge.n_triangles != wanted {
                let nodes = edge.nodes.map(|n| n as usize);
                return Err(MeshError::Edge { nodes, found: edge.n_triangles, expected: wanted });
            }
        }
        let is_edge = |nodes: &&[u32; 2]| edges.binary_search_by(|e| e.nodes.cmp(nodes)).is_err();
        if let Some(bare) = expected.iter().find(is_edge) {
            return Err(MeshError::Edge { nodes: bare.map(|n| n as usize), found: 0, expected: 1 });
        }
        let mut used = vec![false; self.cloud.n_nodes()];
        self.tri_nodes.iter().flatten().for_each(|node| used[node.index()] = true);
        if let Some(node) = used.iter().position(|used| !used) {
            return Err(MeshError::LostNode { node, at: self.xy()[node] });
        }
        let found = used.len() as i64 - edges.len() as i64 + self.n_triangles() as i64;
        let expected = 2 - boundary.n_loops() as i64;
        if found == expected { Ok(()) } else { Err(MeshError::Euler { found, expected }) }
    }
}
