//! The pictures of a problem: its nodes, its mesh and its solution, as SVG and, from the same SVG, as PNG.
//!
//! A figure is data before it is text: [`nodes_figure`], [`mesh_figure`], [`solution_figure`] lay out a scene of paths
//! and texts in page units (a page unit is a CSS pixel, 1000 of them are meant for 180 mm of paper) and write it as SVG.
//! The input is plain slices, so this module knows no other crate. The same input gives the same bytes; coordinates or
//! values that are NaN, infinite or beyond 1e290 are treated as absent.
//!
//! | file | idea |
//! |---|---|
//! | `scene` | shapes on a page, pure data |
//! | `text` | runs of text (italic, subscript, superscript) and their widths |
//! | `svg`, `png` | scene → SVG text → PNG bytes |
//! | `ticks` | rounded numbers and how they are written |
//! | `axes` | data → page, frame, ticks and axis labels at equal scale |
//! | `page` | title, legend and the page around one frame |
//! | `topology` | edges and rim of a triangulation; edges as few long lines |
//! | `contour`, `simplify` | boundary of {value ≥ level}, traced exactly, then thinned to what the eye sees |
//! | `crowd` | dots and lines that lie too close to be drawn one by one |
//! | `colour`, `scale` | colour maps; values → bands of colour, and the colour bar |
//! | `strip`, `names` | a diagram over a length; names of edges, none over another |
//! | `nodes`, `mesh`, `solution`, `edges`, `histogram`, `compare`, `star` | the figures |

mod axes;
mod colour;
mod compare;
mod contour;
mod crowd;
mod edges;
mod histogram;
mod mesh;
mod names;
mod nodes;
mod page;
#[cfg(feature = "png")]
mod png;
mod scale;
mod scene;
mod simplify;
mod solution;
mod star;
mod strip;
mod svg;
mod text;
mod ticks;
mod topology;

#[cfg(feature = "png")]
pub use png::{PlotError, png};

/// Where a node of a cloud lies, hence how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeMark {
    /// At the end of an edge of the outline.
    Vertex,
    /// On an edge of the outline, between its ends.
    Edge,
    /// Inside the subdomain.
    Interior,
}

/// One subdomain to draw. Node numbers count from 0 within the part; those out of range are skipped.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Name of the subdomain, for the legend.
    pub name: &'a str,
    /// Coordinates of the nodes, shape (n_nodes, 2), in the user's length unit.
    pub xy: &'a [[f64; 2]],
    /// Mark of each node, shape (n_nodes,); nodes beyond its end count as interior.
    pub marks: &'a [NodeMark],
    /// Spacing at each node of a graded cloud, shape (n_nodes,), in the user's length unit; empty for a uniform one.
    pub spacings: &'a [f64],
    /// Closed loops of the real boundary by node number, main contour and holes; without them the rim of the mesh is drawn.
    pub loops: &'a [Vec<u32>],
    /// Triangles by node number, shape (n_triangles, 3), either orientation; empty for a bare cloud.
    pub triangles: &'a [[u32; 3]],
}

/// The solution at the nodes of one part, each of shape (n_nodes,); nodes beyond the end of a slice have no value.
#[derive(Clone, Copy, Debug)]
pub struct Fields<'a> {
    /// Prandtl function `F`.
    pub f: &'a [f64],
    /// Shear stress `τ_zx = ∂F/∂y`.
    pub tau_zx: &'a [f64],
    /// Shear stress `τ_zy = −∂F/∂x`.
    pub tau_zy: &'a [f64],
    /// Magnitude of the shear stress; paper, eq. (16).
    pub tau: &'a [f64],
}

/// The solution of a Poisson problem at the nodes of one part, each of shape (n_nodes,); nodes beyond the end of a slice
/// have no value.
#[derive(Clone, Copy, Debug)]
pub struct PoissonFields<'a> {
    /// `u`.
    pub u: &'a [f64],
    /// `∂u/∂x`.
    pub u_x: &'a [f64],
    /// `∂u/∂y`.
    pub u_y: &'a [f64],
    /// `|∇u|`.
    pub gradient: &'a [f64],
    /// `u` less the exact solution, where that is known.
    pub error: Option<&'a [f64]>,
}

/// τ along one edge. Slices of the nodes in order along it, both end vertices included, are of one shape (n_edge_nodes,).
#[derive(Clone, Copy, Debug)]
pub struct EdgeProfile<'a> {
    /// Name of the edge.
    pub name: &'a str,
    /// Its length, in the user's length unit.
    pub length: f64,
    /// Coordinates of its nodes.
    pub xy: &'a [[f64; 2]],
    /// Arc length of each node from the edge's first vertex.
    pub s: &'a [f64],
    /// τ at each node.
    pub tau: &'a [f64],
    /// True where the exact τ is infinite at its first and at its last vertex.
    pub is_singular: [bool; 2],
}

/// τ along all edges of one subdomain.
#[derive(Clone, Copy, Debug)]
pub struct Profiles<'a> {
    /// Name of the subdomain.
    pub name: &'a str,
    /// Names of the loops, the main contour first.
    pub loop_names: &'a [&'a str],
    /// The edges of each loop, in order around it.
    pub loops: &'a [Vec<EdgeProfile<'a>>],
}

/// A node of a star to draw.
#[derive(Clone, Copy, Debug)]
pub struct StarNode {
    /// Its number.
    pub node: u32,
    /// Its weight; infinite where the polynomial meets its value exactly.
    pub weight: f64,
    /// Its coefficient in the ∇² row.
    pub laplacian: Option<f64>,
}

/// One star to draw.
#[derive(Clone, Copy, Debug)]
pub struct StarFigure<'a> {
    /// The subdomain around it.
    pub part: Part<'a>,
    /// Its centre.
    pub node: u32,
    /// Its nodes, in the order of the table.
    pub members: &'a [StarNode],
    /// Nodes passed over since the boundary hides them.
    pub hidden: &'a [u32],
    /// Semi-axes of the ellipse within which nodes belong: a circle where distances are plain.
    pub semi_axes: [f64; 2],
    /// What is said of it below the picture.
    pub about: &'a [String],
}

/// What is written around a picture.
#[derive(Clone, Copy, Debug)]
pub struct Caption<'a> {
    /// Title of the problem, above the picture; may be empty.
    pub title: &'a str,
    /// Length unit for the axis labels, as `m` in `x [m]`; may be empty.
    pub units: &'a str,
}

/// SVG text of the nodes: a mark and a legend entry for each kind, a colour for each subdomain.
///
/// Of more than 200 000 nodes one is drawn in each place of 1.7 page units, and the legend says how many are.
pub fn nodes_figure(caption: &Caption<'_>, parts: &[Part<'_>]) -> String {
    svg::render(&nodes::scene(caption, parts))
}

/// SVG text of the mesh: every edge drawn once, the outline on top, a colour for each subdomain.
///
/// Of more than 200 000 edges those are drawn that are longer than 2.5 page units on average; elsewhere they are a shade, as
/// dark as they would be, and the legend says so.
pub fn mesh_figure(caption: &Caption<'_>, parts: &[Part<'_>]) -> String {
    svg::render(&mesh::scene(caption, parts))
}

/// SVG text of the solution: `F`, `τ_zx`, `τ_zy` and `τ` as filled contours of the linear interpolant on the mesh.
///
/// All parts share one colour scale a panel. Where a few peaks (as at re-entrant corners) lie far above all other values,
/// the scale ends at the 99.5th percentile, its bar in an arrow, and the bar says how high the peaks are.
pub fn solution_figure(caption: &Caption<'_>, parts: &[(Part<'_>, Fields<'_>)]) -> String {
    let fields: Vec<_> = parts.iter().map(|(part, f)| (*part, [f.f, f.tau_zx, f.tau_zy, f.tau])).collect();
    // Rounding of the stress, of which the signed panels are the components.
    let stress = solution::largest(parts.iter().flat_map(|(_, fields)| fields.tau.iter().copied()));
    let size = |panel: &solution::Panel| if panel.is_signed() { stress } else { 0.0 };
    svg::render(&solution::scene(caption, &solution::TORSION, &fields, size))
}

/// SVG text of where the error of J comes from: the logarithm of its density at nodes, one slice a part.
pub fn indicator_figure(caption: &Caption<'_>, parts: &[(Part<'_>, &[f64])]) -> String {
    let fields: Vec<_> = parts.iter().map(|(part, values)| (*part, [*values])).collect();
    svg::render(&solution::scene(caption, &solution::INDICATOR, &fields, |_| 0.0))
}

/// SVG text of the solution of a Poisson problem: `u`, its derivatives, and its error, where all parts have one, otherwise
/// the magnitude of its gradient; as [`solution_figure`].
pub fn poisson_figure(caption: &Caption<'_>, parts: &[(Part<'_>, PoissonFields<'_>)]) -> String {
    let has_error = !parts.is_empty() && parts.iter().all(|(_, fields)| fields.error.is_some());
    let fields: Vec<_> = parts
        .iter()
        .map(|(part, f)| (*part, [f.u, f.u_x, f.u_y, f.error.filter(|_| has_error).unwrap_or(f.gradient)]))
        .collect();
    let mut panels = solution::POISSON;
    if has_error {
        panels[3] = solution::ERROR;
    }
    // Rounding of the gradient, of which the signed panels but that of the error are the components.
    let gradient = solution::largest(parts.iter().flat_map(|(_, fields)| fields.gradient.iter().copied()));
    let size = |panel: &solution::Panel| {
        if panel.is_signed() && *panel != solution::ERROR { gradient } else { 0.0 }
    };
    svg::render(&solution::scene(caption, &panels, &fields, size))
}

/// SVG text of τ along the edges: of each subdomain a drawing that names its edges, and for each loop a diagram over the
/// arc length around it, all of a subdomain to one scale.
///
/// Peaks at vertices where τ is infinite are cut off where they would squeeze the rest.
pub fn edges_figure(caption: &Caption<'_>, subdomains: &[Profiles<'_>]) -> String {
    svg::render(&edges::scene(caption, subdomains))
}

/// SVG text of one star: the cloud around it, its nodes by weight, hidden nodes, and its ∇² row in a table.
pub fn star_figure(caption: &Caption<'_>, figure: &StarFigure<'_>) -> String {
    svg::render(&star::scene(caption, figure))
}

/// One line of the picture of errors.
#[derive(Clone, Copy, Debug)]
pub struct ErrorSeries<'a> {
    /// Name, for the legend.
    pub name: &'a str,
    /// Cost and error, in the order that the line joins them; those that are not positive are left out.
    pub points: &'a [[f64; 2]],
    /// Series of one family have one colour; that of family 0 is grey.
    pub family: usize,
    /// Order of the method, which chooses the mark: 1 diamond, 2 disc, 3 square, 4 triangle.
    pub order: usize,
}

/// SVG text of errors against cost, both axes logarithmic: a line and a mark for each series, and a legend.
pub fn errors_figure(caption: &Caption<'_>, cost: &str, error: &str, series: &[ErrorSeries<'_>]) -> String {
    svg::render(&compare::scene(caption, cost, error, series))
}

/// SVG text of the shapes of triangles: the share of them by shape measure, from [0, 0.1) to [0.9, 1]; where `before` is
/// given, beside those before smoothing.
pub fn histogram_figure(caption: &Caption<'_>, before: Option<[usize; 10]>, after: [usize; 10]) -> String {
    let mut series = Vec::new();
    if let Some(counts) = before {
        series.push(histogram::Series { name: "before smoothing", counts });
    }
    series.push(histogram::Series { name: "after smoothing", counts: after });
    svg::render(&histogram::scene(caption, &series))
}

/// Largest magnitude of a coordinate or value that is drawn.
///
/// Differences and products of a few of them with page sizes (1e3) must not overflow 1.8e308.
const LARGEST_DRAWN: f64 = 1.0e290;

/// Whether a coordinate or value can be drawn: neither NaN, infinite nor beyond [`LARGEST_DRAWN`].
fn is_drawable(value: f64) -> bool {
    value.abs() <= LARGEST_DRAWN
}

#[cfg(test)]
mod tests;
