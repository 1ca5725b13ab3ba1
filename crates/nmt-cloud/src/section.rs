//! What a cloud is made from: the outlines of a section, and how dense and how irregular it shall be.

use crate::error::CloudError;
use crate::grading::Grading;
use nmt_curve::{Division, Outline};
use nmt_geom::Point;

/// A main contour with holes; checked outlines, the holes inside and apart.
#[derive(Clone, Debug)]
pub struct Section {
    /// The main contour; the paper's type 1.
    pub contour: Outline,
    /// Its holes; the paper's type 2.
    pub holes: Vec<Outline>,
}

impl Section {
    /// A section without holes.
    pub fn solid(contour: Outline) -> Self {
        Self { contour, holes: Vec::new() }
    }

    /// The outlines, the main contour first.
    pub fn loops(&self) -> impl Iterator<Item = &Outline> {
        std::iter::once(&self.contour).chain(&self.holes)
    }

    /// Number of edges, those of the holes included.
    pub fn n_edges(&self) -> usize {
        self.loops().map(|outline| outline.edges.len()).sum()
    }

    /// Name of every edge, by [`nmt_geom::EdgeId`]: those of the contour first, then of each hole.
    pub fn edge_names(&self) -> Vec<String> {
        self.loops().flat_map(|outline| outline.edges.iter().map(|edge| edge.name.clone())).collect()
    }
}

/// What distances of interior nodes from the boundary are measured in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ClearanceUnit {
    /// max(h_x, h_y), as in (8) and (9); the default.
    ///
    /// Where the spacings differ by more than 2 it clears whole rows of nodes beside the boundary.
    #[default]
    Max,
    /// x in units of h_x, y in units of h_y: a cloud of unequal spacings is cleared like a square one that is stretched.
    Scaled,
}

impl ClearanceUnit {
    /// Both units.
    pub const ALL: [Self; 2] = [Self::Max, Self::Scaled];

    /// The word of problem files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Max => "max",
            Self::Scaled => "scaled",
        }
    }
}

/// A node that an edge is given instead of those of its own division.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenNode {
    /// Arc length from the edge's first vertex as a fraction of the edge, in (0, 1).
    pub fraction: f64,
    /// Where it lies to the bit; it does not slide. `None`: at its fraction of the edge, from where it slides.
    pub at: Option<Point>,
}

/// Density and irregularity of a cloud.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudParams {
    /// N_x and N_y, the global densities of (2) and (6), each at least 2; 11 × 11 by default.
    pub nodes: [usize; 2],
    /// Densities of each hole relative to its own envelope; by default the contour's N_x/W and N_y/H hold.
    pub hole_nodes: Vec<Option<[usize; 2]>>,
    /// Nodes between the ends of an edge, in order along it, by [`nmt_geom::EdgeId`]; by default, and where it is `None`,
    /// an edge is divided by its own count.
    pub edge_nodes: Vec<Option<Vec<GivenNode>>>,
    /// How the spacing varies; by default, and where it is `None`, it does not.
    ///
    /// The uniform spacing, max(h_x, h_y), is then the largest; densities of holes and counts of edges remain.
    pub grading: Option<Grading>,
    /// How nodes are spread along curved edges \[D3\]; by arc length by default.
    pub division: Division,
    /// Amp of (10), in [0, 0.5); 0, the default, is a regular cloud.
    pub irregularity: f64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// What the two clearances are measured in; max(h_x, h_y), the paper's, by default.
    pub clearance: ClearanceUnit,
    /// Least distance of interior nodes from the real boundary, 1/3 by default (8).
    pub edge_clearance: f64,
    /// Least distance of interior nodes from boundary nodes, 1/2 by default (9).
    pub node_clearance: f64,
}

/// Seed of the randomisation where none is given.
pub const DEFAULT_SEED: u64 = 20170301;

impl Default for CloudParams {
    fn default() -> Self {
        Self {
            nodes: [11, 11],
            hole_nodes: Vec::new(),
            edge_nodes: Vec::new(),
            grading: None,
            division: Division::Arc,
            irregularity: 0.0,
            seed: DEFAULT_SEED,
            clearance: ClearanceUnit::Max,
            edge_clearance: 1.0 / 3.0,
            node_clearance: 0.5,
        }
    }
}

impl CloudParams {
    /// # Errors
    /// [`CloudError::Parameter`] for the first that is out of range.
    pub(crate) fn check(&self) -> Result<(), CloudError> {
        let own = self.hole_nodes.iter().flatten().flatten();
        for &n in self.nodes.iter().chain(own) {
            if n < 2 {
                return Err(CloudError::Parameter { parameter: "nodes", value: n as f64, range: "2, 3, …" });
            }
        }
        for given in self.edge_nodes.iter().flatten() {
            let mut before = 0.0;
            for &GivenNode { fraction, .. } in given {
                if !(before < fraction && fraction < 1.0) {
                    let range = "(0, 1), rising along the edge";
                    return Err(CloudError::Parameter { parameter: "fraction", value: fraction, range });
                }
                before = fraction;
            }
        }
        let ranges = [
            ("irregularity", self.irregularity, (0.0..0.5).contains(&self.irregularity), "[0, 0.5)"),
            ("edge_clearance", self.edge_clearance, (0.0..=2.0).contains(&self.edge_clearance), "[0, 2]"),
            ("node_clearance", self.node_clearance, (0.0..=2.0).contains(&self.node_clearance), "[0, 2]"),
        ];
        match ranges.iter().find(|(_, _, inside, _)| !inside) {
            Some(&(parameter, value, _, range)) => Err(CloudError::Parameter { parameter, value, range }),
            None => Ok(()),
        }
    }
}
