//! Section and density in, cloud out: the paper's steps in a row (Sec. 4).

use crate::boundary::{BoundaryNodes, boundary_nodes};
use crate::clearance::{Clearance, Sieve, sites_near};
use crate::cloud::Cloud;
use crate::error::CloudError;
use crate::irregular::Displacements;
use crate::lattice::Lattice;
use crate::section::{CloudParams, Section};
use nmt_geom::point::sub;
use nmt_geom::{Location, Point, RealBoundary, RegionFault, SegmentIndex, ring};

/// Grid points that a cloud may have at most.
pub const MAX_GRID_POINTS: f64 = 1.0e8;

/// Memory of a grid point through cloud, mesh and solution, bytes: runs of 10⁵ nodes took 10⁴ a node, most of it in the
/// factorisation.
pub const BYTES_PER_GRID_POINT: f64 = 1.0e4;

/// Draws a node may take until its displaced place is clear of the boundary; then it stays.
const MAX_DRAWS: usize = 8;

/// Generates the cloud of a section; paper, Sec. 4, eqs (1)–(11) \[D3\]–\[D7\].
///
/// Nodes are numbered vertices first (contour, then holes), then edge nodes in the same order, then interior nodes row
/// by row. The same section and parameters give the same bits on every machine.
///
/// # Errors
/// [`CloudError`] where a parameter is out of range, an edge cannot be divided, the polygon through the boundary nodes
/// crosses itself (with a density that would do), or no interior node is left (with one that would give some).
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::Outline;
///
/// let plate = Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0]));
/// let cloud = generate(&plate, &CloudParams { nodes: [21, 11], ..CloudParams::default() })?;
/// assert_eq!((cloud.n_boundary(), cloud.n_interior()), (60, 19 * 9));
/// # Ok::<(), nmt_cloud::CloudError>(())
/// ```
pub fn generate(section: &Section, params: &CloudParams) -> Result<Cloud, CloudError> {
    let mut displacements = Displacements::new(params.seed);
    let prepared = prepare(section, params, &mut displacements)?;
    if let Some(fault) = prepared.boundary.faults().first() {
        let at = place_of(fault, &prepared.boundary);
        return Err(CloudError::BoundaryCrosses { at, remedy: density_that_does_not_cross(section, params) });
    }
    let lattice = &prepared.lattice;
    let sieve = Sieve::new(lattice, &prepared.boundary, &prepared.clearance);
    let census = sieve.census();
    if census.kept == 0 {
        return Err(CloudError::NoInterior { remedy: density_with_interior(section, params) });
    }
    let mut interior: Vec<Point> = Vec::with_capacity(census.kept);
    interior.extend(sieve.kept().map(|(i, j)| lattice.site(i, j)));
    if params.irregularity > 0.0 {
        let sites: Vec<(usize, usize)> = sieve.kept().collect();
        displace(&mut interior, &sites, &prepared, params.irregularity, &mut displacements);
    }
    Ok(Cloud::from_parts(prepared.boundary, prepared.n_vertices, interior, lattice.spacing(), census))
}

/// Lattice, real boundary and clearances: all that the interior nodes depend on.
struct Prepared {
    lattice: Lattice,
    boundary: RealBoundary,
    n_vertices: usize,
    clearance: Clearance,
}

fn prepare(section: &Section, params: &CloudParams, displacements: &mut Displacements) -> Result<Prepared, CloudError> {
    params.check()?;
    let [n_x, n_y] = params.nodes.map(|n| n as f64);
    if n_x * n_y > MAX_GRID_POINTS {
        let gigabytes = n_x * n_y * BYTES_PER_GRID_POINT / 1e9;
        return Err(CloudError::TooManyNodes { nodes: params.nodes, gigabytes, limit: MAX_GRID_POINTS });
    }
    let envelope = section.contour.envelope();
    let (width, height) = (envelope.width(), envelope.height());
    if !(width > 0.0 && height > 0.0 && envelope.size().is_finite()) {
        return Err(CloudError::NoExtent { width, height });
    }
    let lattice = Lattice::new(envelope, params.nodes);
    let BoundaryNodes { boundary, n_vertices } = boundary_nodes(section, params, displacements)?;
    let clearance = Clearance::new(&lattice, envelope.size(), params.edge_clearance, params.node_clearance);
    Ok(Prepared { lattice, boundary, n_vertices, clearance })
}

/// Moves each interior node as (10) says; a place that is not clear of the boundary is drawn again.
fn displace(
    interior: &mut [Point],
    sites: &[(usize, usize)],
    prepared: &Prepared,
    amplitude: f64,
    displacements: &mut Displacements,
) {
    let Prepared { lattice, boundary, clearance, .. } = prepared;
    let [h_x, h_y] = lattice.spacing();
    let n_boundary = boundary.xy().len();
    // Only sites this near to the boundary can be moved too close to it, or across it.
    let reach = clearance.reach() + amplitude * h_x.hypot(h_y);
    let columns = lattice.shape[0];
    let mut exposed = vec![false; columns * lattice.shape[1]];
    for [a, b] in boundary.all_ends() {
        sites_near(lattice, a, b, reach * (1.0 + 1e-9), |i, j| exposed[j * columns + i] = true);
    }
    let index = boundary.segment_index();
    let mut place = |k: usize, site: Point, draw: usize| {
        let [r, s] = displacements.draw(n_boundary + k, draw);
        [site[0] + h_x * amplitude * r, site[1] + h_y * amplitude * s]
    };
    let mut redraw = Vec::new();
    for (k, &(i, j)) in sites.iter().enumerate() {
        let new = place(k, interior[k], 0);
        if exposed[j * columns + i] && !may_move(interior[k], new, clearance, &index) {
            redraw.push(k);
        } else {
            interior[k] = new;
        }
    }
    for draw in 1..MAX_DRAWS {
        redraw.retain(|&k| {
            let new = place(k, interior[k], draw);
            let moves = may_move(interior[k], new, clearance, &index);
            if moves {
                interior[k] = new;
            }
            !moves
        });
    }
}

/// True where `to` is clear of the boundary and on the same side of it as the site.
fn may_move(site: Point, to: Point, clearance: &Clearance, index: &SegmentIndex) -> bool {
    clearance.holds(to, index) && !crosses_oddly(site, to, index)
}

/// True where an odd number of segments lies between two points that are both clear of the boundary.
///
/// A corner exactly on the line belongs to its left side, so that each passage counts once.
fn crosses_oddly(p: Point, q: Point, index: &SegmentIndex) -> bool {
    let left = |a: Point, b: Point, r: Point| nmt_geom::side(a, b, r) != std::cmp::Ordering::Less;
    let mut crossed = std::collections::BTreeSet::new();
    index.candidates(p, q, 0.0, |k| {
        let [a, b] = index.segment(k);
        if left(p, q, a) != left(p, q, b) && left(a, b, p) != left(a, b, q) {
            crossed.insert(k);
        }
    });
    crossed.len() % 2 == 1
}

/// Where a fault of the polygon is, for a message.
pub(crate) fn place_of(fault: &RegionFault, boundary: &RealBoundary) -> Point {
    let corner = |ring: usize| boundary.polygon(nmt_geom::LoopId::of(ring)).first().copied().unwrap_or([0.0; 2]);
    match fault {
        RegionFault::SelfIntersection { at, .. }
        | RegionFault::HoleMeetsContour { at, .. }
        | RegionFault::HolesMeet { at, .. } => *at,
        RegionFault::ZeroArea { ring } => ring::centroid(&boundary.polygon(*ring)),
        RegionFault::HoleOutside { hole } | RegionFault::HoleInHole { inner: hole, .. } => corner(hole + 1),
        _ => corner(0),
    }
}

/// Densities tried for a remedy: each this much finer than the one before.
const FINER: f64 = 1.25;

/// The first finer density that `does`, as advice; up to 10⁶ grid points, so that an error costs no more than a cloud.
fn advise(params: &CloudParams, does: impl Fn(&CloudParams) -> bool) -> Option<[usize; 2]> {
    let mut factor = FINER;
    loop {
        let nodes = params.nodes.map(|n| (n as f64 * factor).ceil() as usize);
        if nodes[0] as f64 * nodes[1] as f64 > 1e6 {
            return None;
        }
        let hole_nodes =
            params.hole_nodes.iter().map(|own| own.map(|n| n.map(|n| (n as f64 * factor).ceil() as usize)));
        let finer = CloudParams { nodes, hole_nodes: hole_nodes.collect(), ..params.clone() };
        if does(&finer) {
            return Some(nodes);
        }
        factor *= FINER;
    }
}

fn density_that_does_not_cross(section: &Section, params: &CloudParams) -> String {
    let does = |finer: &CloudParams| {
        prepare(section, finer, &mut Displacements::new(finer.seed))
            .is_ok_and(|prepared| prepared.boundary.faults().is_empty())
    };
    match advise(params, does) {
        Some([n_x, n_y]) => format!("nodes = [{n_x}, {n_y}] would do"),
        None => "give edges with `nodes` of their own more of them, or keep the curves further apart".into(),
    }
}

fn density_with_interior(section: &Section, params: &CloudParams) -> String {
    let does = |finer: &CloudParams| {
        prepare(section, finer, &mut Displacements::new(finer.seed)).is_ok_and(|prepared| {
            prepared.boundary.faults().is_empty() && {
                let locator = prepared.boundary.locator();
                let index = prepared.boundary.segment_index();
                let [columns, rows] = prepared.lattice.interior_shape();
                (1..=rows).any(|j| {
                    (1..=columns).any(|i| {
                        let p = prepared.lattice.site(i, j);
                        locator.locate(p) == Location::Inside && prepared.clearance.holds(p, &index)
                    })
                })
            }
        })
    };
    match advise(params, does) {
        Some([n_x, n_y]) => format!("nodes = [{n_x}, {n_y}] would give some"),
        None => {
            "a grid of 10⁶ points in this proportion gives none either: choose more nodes across the thin parts".into()
        }
    }
}

/// Fraction of the way that node `k` of `n` nodes lies along an edge.
pub(crate) fn evenly(k: usize, n_segments: usize) -> f64 {
    k as f64 / n_segments as f64
}

/// The point at fraction `t` of a straight edge; paper, eq. (1).
///
/// Written with the difference, so that nodes of a horizontal or vertical edge share a coordinate to the bit.
pub(crate) fn on_line(from: Point, to: Point, t: f64) -> Point {
    let v = sub(to, from);
    [from[0] + v[0] * t, from[1] + v[1] * t]
}
