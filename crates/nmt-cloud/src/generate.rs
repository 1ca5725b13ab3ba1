//! Section and density in, cloud out: the paper's steps in a row (Sec. 4).

use crate::boundary::{BoundaryNodes, boundary_nodes, slide};
use crate::clearance::{Clearance, Sieve, SiteSet};
use crate::cloud::{Born, Cloud, CloudParts};
use crate::error::CloudError;
use crate::graded::generate_graded;
use crate::irregular::Displacements;
use crate::lattice::Lattice;
use crate::section::{CloudParams, Section};
use nmt_geom::{Location, NodeId, Point, RealBoundary, RegionFault, SegmentIndex, ring};

/// Grid points that a cloud may have at most.
pub const MAX_GRID_POINTS: f64 = 1.0e8;

/// Memory of a grid point through cloud, mesh and solution, bytes: runs of 10⁵ nodes took 10⁴ a node, most of it in the
/// factorisation.
pub const BYTES_PER_GRID_POINT: f64 = 1.0e4;

/// Room about the boundary within which a displaced node is looked at, as a fraction of the size: above rounding, and above
/// the slack of the clearances.
const EXPOSED_ROOM_REL: f64 = 1.0e-9;

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
    generate_with(section, params, |node, draw| displacements.draw(node, draw))
}

/// [`generate`] with random numbers of the caller's: `random(node, draw)` gives 2r − 1 and 2r′ − 1 of (10), each in
/// [−1, 1), for a node of the finished cloud and its draw 0, 1, … 7.
///
/// An edge node takes the first number of its draw 0, an interior node both of as many draws as it needs. Asked for in
/// order of the nodes first, then again for those that draw again; never for a regular cloud.
///
/// # Errors
/// Those of [`generate`]; the densities that it advises are tried with the seed of `params`.
pub fn generate_with(
    section: &Section,
    params: &CloudParams,
    mut random: impl FnMut(usize, usize) -> [f64; 2],
) -> Result<Cloud, CloudError> {
    let random: &mut dyn FnMut(usize, usize) -> [f64; 2] = &mut random;
    if params.grading.is_some() {
        return generate_graded(section, params, random);
    }
    let Prepared { lattice, boundary: BoundaryNodes { boundary, n_vertices, fractions, closings }, clearance } =
        prepare(section, params, random)?;
    if let Some(fault) = boundary.faults().first() {
        let at = place_of(fault, &boundary);
        return Err(CloudError::BoundaryCrosses {
            at,
            remedy: density_that_does_not_cross(section, params, boundary.xy().len()),
        });
    }
    let sieve = Sieve::new(&lattice, &boundary, &clearance);
    let census = sieve.census();
    if census.kept == 0 {
        return Err(CloudError::NoInterior { remedy: density_with_interior(section, params, boundary.xy().len()) });
    }
    let n_boundary = boundary.xy().len();
    let mut xy = Vec::with_capacity(n_boundary + census.kept);
    xy.extend_from_slice(boundary.xy());
    let mut sites = Vec::with_capacity(census.kept);
    sieve.kept(|number, p| {
        sites.push(number);
        xy.push(p);
    });
    drop(sieve);
    if params.irregularity > 0.0 {
        // Only sites this near to the boundary can be moved too close to it, or across it.
        let [h_x, h_y] = lattice.spacing();
        let [s_x, s_y] = clearance.stretch;
        let moves = params.irregularity * (s_x * h_x).hypot(s_y * h_y);
        // Where no clearance is asked for, a hair of it decides whether a node crosses the boundary.
        let reach = clearance.reach().max(0.0) + moves + EXPOSED_ROOM_REL * s_x.max(s_y) * boundary.envelope().size();
        let exposed = SiteSet::near(&lattice, &boundary, &clearance, reach * (1.0 + EXPOSED_ROOM_REL));
        let is_exposed = |k: usize| exposed.contains(sites[k]);
        let [dx, dy] = lattice.spacing().map(|h| h * params.irregularity);
        let by = |_: usize, [r, s]: [f64; 2]| [dx * r, dy * s];
        displace(&mut xy, &boundary, by, |_| clearance, is_exposed, random);
    }
    let spacing = lattice.spacing();
    let born = Some(Born { lattice, sites });
    let fractions = Some(fractions);
    let local = None;
    Ok(Cloud::new(CloudParts {
        xy,
        n_vertices,
        boundary,
        fractions,
        spacing,
        clearance,
        born,
        local,
        closings,
        census,
    }))
}

/// Randomises an existing cloud; paper, Sec. 4.4, eqs (10)–(11).
///
/// Edge nodes slide along their edges by ±`irregularity` of the shorter of their two segments, in arc length; interior
/// nodes move by up to `irregularity` of h_x and h_y to a place that is inside and clear of the boundary, drawn up to 8
/// times, else they stay. Vertices stay. An interior node that the slid boundary has come too near to goes, and is counted
/// under its cause in the census. Nodes that an edge was given slide like the others. `section` must be the one that the cloud was generated from.
///
/// # Errors
/// [`CloudError::Parameter`] where `irregularity` is not in [0, 0.5), [`CloudError::OtherSection`] where the cloud's
/// vertices are not the section's, [`CloudError::NotGenerated`] for one that came from no section,
/// [`CloudError::BoundaryCrosses`] where the slid boundary would cross itself.
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate, randomise};
/// use nmt_curve::Outline;
///
/// let disc = Section::solid(Outline::circle([0.0, 0.0], 1.0));
/// let regular = generate(&disc, &CloudParams { nodes: [21, 21], ..CloudParams::default() })?;
/// let irregular = randomise(&disc, &regular, 0.3, 1)?;
/// assert!(irregular.n_nodes() <= regular.n_nodes());
/// assert_eq!(irregular.xy()[0], [1.0, 0.0]); // the vertex
/// # Ok::<(), nmt_cloud::CloudError>(())
/// ```
pub fn randomise(section: &Section, cloud: &Cloud, irregularity: f64, seed: u64) -> Result<Cloud, CloudError> {
    let range = "[0, 0.5)";
    if !(0.0..0.5).contains(&irregularity) {
        return Err(CloudError::Parameter { parameter: "irregularity", value: irregularity, range });
    }
    let mut displacements = Displacements::new(seed);
    let random: &mut dyn FnMut(usize, usize) -> [f64; 2] = &mut |node, draw| displacements.draw(node, draw);
    let (n_vertices, clearance, spacing) = (cloud.n_vertices(), *cloud.clearance(), cloud.spacing());
    let fractions = cloud.edge_fractions().ok_or(CloudError::NotGenerated)?;
    let slid = slide(section, cloud.boundary(), n_vertices, fractions, irregularity, random)?;
    let (closings, BoundaryNodes { boundary, fractions, .. }) = (cloud.closings().to_vec(), slid);
    if let Some(fault) = boundary.faults().first() {
        let remedy = "choose a smaller irregularity".into();
        return Err(CloudError::BoundaryCrosses { at: place_of(fault, &boundary), remedy });
    }
    let index = boundary.index();
    let mut census = cloud.census();
    let mut xy = boundary.xy().to_vec();
    let mut sites = cloud.sites().map(|_| Vec::new());
    let mut local = cloud.local().cloned();
    local.iter_mut().for_each(|local| local.asked.truncate(cloud.n_boundary()));
    for (k, &p) in cloud.xy()[cloud.n_boundary()..].iter().enumerate() {
        let inside = index.locate(p) == Location::Inside;
        let node = NodeId::of(cloud.n_boundary() + k);
        let clearance = cloud.clearance_of(node);
        if inside && clearance.holds(p, index) {
            xy.push(p);
            local.iter_mut().for_each(|local| local.asked.push(cloud.local_spacing(node)));
            if let (Some(kept), Some(all)) = (&mut sites, cloud.sites()) {
                kept.push(all[k]);
            }
            continue;
        }
        let edge_alone = Clearance { node: 0.0, ..clearance };
        let cause = match inside {
            false => &mut census.outside,
            true if !edge_alone.holds(p, index) => &mut census.near_edge,
            true => &mut census.near_node,
        };
        *cause += 1;
        census.kept -= 1;
    }
    if xy.len() == boundary.xy().len() {
        return Err(CloudError::NoInterior { remedy: "choose a smaller irregularity".into() });
    }
    match &local {
        Some(local) => {
            let n_boundary = boundary.xy().len();
            let by = local.displacements(n_boundary, irregularity);
            displace(&mut xy, &boundary, by, |k| local.clearance_of(n_boundary + k), |_| true, random);
        }
        None => {
            let [dx, dy] = spacing.map(|h| h * irregularity);
            displace(&mut xy, &boundary, |_, [r, s]| [dx * r, dy * s], |_| clearance, |_| true, random);
        }
    }
    let born = cloud.lattice().zip(sites).map(|(lattice, sites)| Born { lattice: *lattice, sites });
    let born = born.filter(|born| born.all_within_boxes(&xy[boundary.xy().len()..]));
    let fractions = Some(fractions);
    Ok(Cloud::new(CloudParts {
        xy,
        n_vertices,
        boundary,
        fractions,
        spacing,
        clearance,
        born,
        local,
        closings,
        census,
    }))
}

/// Lattice, real boundary and clearances: all that the interior nodes depend on.
struct Prepared {
    lattice: Lattice,
    boundary: BoundaryNodes,
    clearance: Clearance,
}

fn prepare(
    section: &Section,
    params: &CloudParams,
    random: &mut dyn FnMut(usize, usize) -> [f64; 2],
) -> Result<Prepared, CloudError> {
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
    let boundary = boundary_nodes(section, params, None, random)?;
    let CloudParams { clearance, edge_clearance, node_clearance, .. } = *params;
    let clearance = Clearance::new(&lattice, envelope.size(), clearance, edge_clearance, node_clearance);
    Ok(Prepared { lattice, boundary, clearance })
}

/// Moves each interior node as (10) says; a place that is not clear of the boundary is drawn again.
///
/// `by(k, [2r − 1, 2r′ − 1])` is how far interior node k goes, `clearance_of(k)` what it must keep, and `is_exposed(k)`
/// whether it could come too near to the boundary at all; the last is asked in order.
pub(crate) fn displace(
    xy: &mut [Point],
    boundary: &RealBoundary,
    by: impl Fn(usize, [f64; 2]) -> [f64; 2],
    clearance_of: impl Fn(usize) -> Clearance,
    mut is_exposed: impl FnMut(usize) -> bool,
    random: &mut dyn FnMut(usize, usize) -> [f64; 2],
) {
    let n_boundary = boundary.xy().len();
    let index = boundary.index();
    let mut place = |k: usize, site: Point, draw: usize| {
        let [dx, dy] = by(k, random(n_boundary + k, draw));
        [site[0] + dx, site[1] + dy]
    };
    let mut redraw = Vec::new();
    for (k, p) in xy[n_boundary..].iter_mut().enumerate() {
        let new = place(k, *p, 0);
        if is_exposed(k) && !may_move(*p, new, &clearance_of(k), index) {
            redraw.push(k);
        } else {
            *p = new;
        }
    }
    for draw in 1..MAX_DRAWS {
        redraw.retain(|&k| {
            let site = xy[n_boundary + k];
            let new = place(k, site, draw);
            let moves = may_move(site, new, &clearance_of(k), index);
            if moves {
                xy[n_boundary + k] = new;
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
    let mut odd = false;
    index.candidates(p, q, 0.0, |k| {
        let [a, b] = index.segment(k);
        odd ^= left(p, q, a) != left(p, q, b) && left(a, b, p) != left(a, b, q);
    });
    odd
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

/// Grid points and boundary nodes, at most, of a cloud that is tried for a remedy: an error shall cost no more than a cloud.
const MOST_TRIED: f64 = 1.0e6;

/// The first finer density that `does`, as advice; `n_boundary` nodes are on the boundary at the density that does not.
fn advise(params: &CloudParams, n_boundary: usize, does: impl Fn(&CloudParams) -> bool) -> Option<[usize; 2]> {
    let mut factor = FINER;
    loop {
        let nodes = params.nodes.map(|n| (n as f64 * factor).ceil() as usize);
        if nodes[0] as f64 * nodes[1] as f64 > MOST_TRIED || n_boundary as f64 * factor > MOST_TRIED {
            return None;
        }
        let hole_nodes =
            params.hole_nodes.iter().map(|own| own.map(|n| n.map(|n| (n as f64 * factor).ceil() as usize)));
        // Nodes that are given belong to the density they were made for.
        let edge_nodes = Vec::new();
        let finer = CloudParams { nodes, hole_nodes: hole_nodes.collect(), edge_nodes, ..params.clone() };
        if does(&finer) {
            return Some(nodes);
        }
        factor *= FINER;
    }
}

fn prepare_seeded(section: &Section, params: &CloudParams) -> Result<Prepared, CloudError> {
    let mut displacements = Displacements::new(params.seed);
    prepare(section, params, &mut |node, draw| displacements.draw(node, draw))
}

fn density_that_does_not_cross(section: &Section, params: &CloudParams, n_boundary: usize) -> String {
    let does = |finer: &CloudParams| {
        prepare_seeded(section, finer).is_ok_and(|prepared| prepared.boundary.boundary.faults().is_empty())
    };
    match advise(params, n_boundary, does) {
        Some([n_x, n_y]) => format!("nodes = [{n_x}, {n_y}] would do"),
        None => "give edges with `nodes` of their own more of them, or keep the curves further apart".into(),
    }
}

fn density_with_interior(section: &Section, params: &CloudParams, n_boundary: usize) -> String {
    let does = |finer: &CloudParams| {
        prepare_seeded(section, finer).is_ok_and(|Prepared { lattice, boundary, clearance }| {
            boundary.boundary.faults().is_empty()
                && Sieve::new(&lattice, &boundary.boundary, &clearance).census().kept > 0
        })
    };
    match advise(params, n_boundary, does) {
        Some([n_x, n_y]) => format!("nodes = [{n_x}, {n_y}] would give some"),
        None => {
            "densities tried up to 10⁶ nodes in this proportion give none either: choose more nodes across the thin parts".into()
        }
    }
}
