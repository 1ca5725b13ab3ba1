//! How the shapes of a problem lie: each closed and simple, holes inside their contours, subdomains side by side.

use super::error::Faults;
use super::limits::{self, LARGEST, SMALLEST, quote, rounded, show};
use super::read::{Draft, SubdomainDraft};
use super::shape::{self, Shape};
use nmt_geom::point::{cross, distance, sub};
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{Bbox, IndexedRegion, Point, Region, RegionFault, overlap};

/// Curves are checked as polygons that leave them by at most this fraction of the size.
///
/// A hundred times the tolerance of a point: a circle then has some thousand sides, not some ten thousand, and a fault
/// smaller than that is far below the spacing of any cloud (1e-4 of the size at 10⁸ nodes).
const FLATTEN_REL: f64 = 100.0 * SAME_POINT_REL;

/// Loops nearer than this fraction of the size touch, and subdomains that overlap by less are adjacent.
///
/// Two curves that coincide are flattened each in its own way: their polygons differ by twice [`FLATTEN_REL`], and the
/// deepest point between them must not count as common.
const TOUCH_REL: f64 = 4.0 * FLATTEN_REL;

/// Farthest from the origin, in sizes.
///
/// There rounding (1e-16 of a coordinate) is a tenth of [`SAME_POINT_REL`]; beyond, points that are one would differ.
const FARTHEST_REL: f64 = 1.0e6;

/// Smallest contour or hole, as a fraction of the size: ten times [`FLATTEN_REL`], so that its polygon has corners.
const SMALLEST_REL: f64 = 1.0e-6;

/// Notes every fault of the shapes that could be read, and of how they lie to each other.
pub(super) fn check(draft: &Draft, faults: &mut Faults) {
    let Some(size) = size(draft, faults) else { return };
    let regions: Vec<_> = draft.subdomains.iter().map(|subdomain| region(subdomain, size, faults)).collect();
    overlaps(&draft.subdomains, &regions, size, faults);
}

/// The shapes that could be read, in the order of the file.
fn shapes(subdomain: &SubdomainDraft) -> impl Iterator<Item = &Shape> {
    subdomain.contour.iter().chain(subdomain.holes.iter().filter_map(|hole| hole.shape.as_ref()))
}

/// Diagonal of the envelope of the whole problem; `None`, with the fault noted, where no tolerance can follow from it.
fn size(draft: &Draft, faults: &mut Faults) -> Option<f64> {
    let all = || draft.subdomains.iter().flat_map(shapes);
    let envelope = all().map(envelope).fold(Bbox::EMPTY, Bbox::union);
    let size = envelope.size();
    let first = all().next()?;
    let complete = draft
        .subdomains
        .iter()
        .all(|subdomain| subdomain.contour.is_some() && subdomain.holes.iter().all(|hole| hole.shape.is_some()));
    if !complete {
        // What is missing may be the larger part.
        return (size > 0.0).then_some(size);
    }
    if size < SMALLEST {
        let message = format!("the whole problem measures {} across, less than {SMALLEST:e}", show(rounded(size)));
        faults.push(first.place.clone(), first.item.as_str(), message, "choose a smaller unit of length");
        return None;
    }
    let farthest = (0..2).map(|d| envelope.min[d].abs().max(envelope.max[d].abs())).fold(0.0, f64::max);
    if farthest > FARTHEST_REL * size {
        let message = format!(
            "the problem measures {} across but lies {} from the origin, where the digits of a coordinate no longer tell \
             its points apart",
            show(rounded(size)),
            show(rounded(farthest))
        );
        faults.push(first.place.clone(), first.item.as_str(), message, "move the origin nearer to the section");
        return None;
    }
    Some(size)
}

/// The envelope of a shape, that of its vertices where a curve runs beyond every limit (a fault of its own).
fn envelope(shape: &Shape) -> Bbox {
    let envelope = shape.outline.envelope();
    if within_limits(&envelope) { envelope } else { Bbox::of(shape.outline.vertices.iter().copied()) }
}

fn within_limits(envelope: &Bbox) -> bool {
    // A circle about a centre at the limit may reach twice as far.
    envelope.min.iter().chain(&envelope.max).all(|c| c.abs() <= 2.0 * LARGEST)
}

/// The polygon of a subdomain where all of it is sound, its faults noted otherwise.
fn region(subdomain: &SubdomainDraft, size: f64, faults: &mut Faults) -> Option<Region> {
    let before = faults.len();
    let sound: Vec<_> = shapes(subdomain).map(|shape| is_sound(shape, size, faults)).collect();
    let mut sound = sound.into_iter();
    let contour = subdomain.contour.as_ref().filter(|_| sound.next() == Some(true))?;
    // Holes with a fault of their own are left out, and what is left keeps its place in the list.
    let holes: Vec<_> =
        subdomain.holes.iter().filter(|hole| hole.shape.is_some() && sound.next() == Some(true)).collect();
    let flatten = |shape: &Shape| shape.outline.flatten(FLATTEN_REL * size);
    let region = Region {
        contour: flatten(contour),
        holes: holes.iter().filter_map(|hole| hole.shape.as_ref()).map(flatten).collect(),
    };
    let loops: Vec<_> = std::iter::once(contour).chain(holes.iter().filter_map(|hole| hole.shape.as_ref())).collect();
    let names: Vec<_> = holes.iter().map(|hole| hole.name.as_str()).collect();
    let found = region.faults(TOUCH_REL * size);
    let has_no_inside = |ring: usize| {
        found.iter().any(|fault| match fault {
            RegionFault::SelfIntersection { ring: at_fault, .. } | RegionFault::ZeroArea { ring: at_fault } => {
                at_fault.index() == ring
            }
            _ => false,
        })
    };
    for fault in &found {
        // Inside and outside mean nothing for a loop that crosses itself or is flat: that fault is to be mended first.
        let follows = match fault {
            RegionFault::HoleOutside { .. } | RegionFault::HoleMeetsContour { .. } => has_no_inside(0),
            RegionFault::HoleInHole { outer, .. } => has_no_inside(outer + 1),
            _ => false,
        };
        if !follows {
            note(fault, &region, &loops, &names, size, faults);
        }
    }
    (faults.len() == before).then_some(region)
}

/// Notes a fault of a region; `loops` are the shapes of its contour and holes, `names` those of the holes.
fn note(fault: &RegionFault, region: &Region, loops: &[&Shape], names: &[&str], size: f64, faults: &mut Faults) {
    let hole = |k: &usize| loops[k + 1];
    let (shape, message, remedy) = match fault {
        RegionFault::SelfIntersection { ring, at, segments } => {
            let shape = loops[ring.index()];
            let corners = region.loops().nth(ring.index()).map_or(&[][..], Vec::as_slice);
            if in_one_line(corners, size) {
                let message = "it encloses no area, its vertices lie in one line";
                faults.push(shape.place.clone(), shape.item.as_str(), message, "move one of them off the line");
                return;
            }
            let [first, second] = segments.map(|side| edge_of(&shape.outline.vertices, corners, side));
            let [name, other] = [first, second].map(|k| shape.outline.edges.get(k).map_or("", |edge| &edge.name));
            let (message, remedy) = if first == second {
                let message = format!("edge {} crosses or touches itself at {}", quote(name), point(*at, size));
                (message, "choose a curve, or a part of it, that does not")
            } else {
                let names = format!("edges {} and {}", quote(name), quote(other));
                let remedy = "give the vertices in order around the section, so that edges meet only at their ends";
                (format!("{names} cross or touch at {}", point(*at, size)), remedy)
            };
            let (place, item) = match shape.edges.get(second) {
                Some(mark) => (mark.place.clone(), shape.item_of(mark)),
                None => (shape.place.clone(), shape.item.clone()),
            };
            faults.push(place, item, message, remedy);
            return;
        }
        RegionFault::ZeroArea { ring } => {
            let remedy = "move its vertices or curves apart";
            (loops[ring.index()], "it encloses no area".to_owned(), remedy)
        }
        RegionFault::HoleMeetsContour { hole: k, at } => {
            let message = format!("it crosses or touches the contour at {}", point(*at, size));
            (hole(k), message, "leave a wall between them, or make the hole a part of the contour's outline")
        }
        RegionFault::HoleOutside { hole: k } => {
            (hole(k), "it lies outside the contour".to_owned(), "move it inside, or remove it")
        }
        RegionFault::HolesMeet { holes: [i, j], at } => {
            let message = format!("it crosses or touches hole {} at {}", quote(names[*i]), point(*at, size));
            (hole(j), message, "leave a wall between the two, or join them to one hole")
        }
        RegionFault::HoleInHole { inner, outer } => {
            let message = format!("it lies inside hole {}", quote(names[*outer]));
            (hole(inner), message, "remove one of the two; material within a hole is a [[subdomain]] of its own")
        }
        // Faults of a later geometry are shown as they are rather than lost.
        other => (loops[0], format!("{other:?}"), "correct the outline"),
    };
    faults.push(shape.place.clone(), shape.item.as_str(), message, remedy);
}

/// True where every corner lies on one line, as far as points can be told apart.
fn in_one_line(corners: &[Point], size: f64) -> bool {
    let Some(&first) = corners.first() else { return true };
    let far =
        corners.iter().copied().max_by(|p, q| distance(first, *p).total_cmp(&distance(first, *q))).unwrap_or(first);
    let direction = sub(far, first);
    let limit = SAME_POINT_REL * size * distance(first, far);
    corners.iter().all(|p| cross(direction, sub(*p, first)).abs() <= limit)
}

/// The edge that side `side` of the flattened polygon belongs to: every vertex is a corner of it, in order.
fn edge_of(vertices: &[Point], corners: &[Point], side: usize) -> usize {
    let mut edge = 0;
    for corner in corners.iter().take(side + 1).skip(1) {
        if vertices.get(edge + 1) == Some(corner) {
            edge += 1;
        }
    }
    edge
}

/// True where a shape's vertices differ and its curves are what they claim to be; notes what is not.
fn is_sound(shape: &Shape, size: f64, faults: &mut Faults) -> bool {
    let before = faults.len();
    let vertices = &shape.outline.vertices;
    let n = vertices.len();
    let mut degenerate = Vec::new();
    for (k, vertex) in vertices.iter().enumerate().filter(|_| n > 1) {
        let next = (k + 1) % n;
        if distance(*vertex, vertices[next]) > SAME_POINT_REL * size {
            continue;
        }
        degenerate.push(k);
        let same = if *vertex == vertices[next] { "repeats" } else { "is within 1e-9 of the problem's size of" };
        let (message, remedy, at) = if next == 0 {
            (format!("the last vertex {same} the first"), "remove it: the outline closes by itself", k)
        } else {
            let before = format!("({}, {})", show(vertex[0]), show(vertex[1]));
            (format!("this vertex {same} the one before, {before}"), "remove one of the two", next)
        };
        let mark = &shape.vertices[at];
        faults.push(mark.place.clone(), shape.item_of(mark), message, remedy);
    }
    for fault in shape.outline.faults(size) {
        // The edge between equal vertices has been told already.
        if degenerate.contains(&fault.edge) {
            continue;
        }
        let Some(mark) = shape.edges.get(fault.edge) else { continue };
        let (message, remedy) = shape::split(&fault.error.to_string());
        faults.push(mark.place.clone(), shape.item_of(mark), message, remedy);
    }
    if faults.len() > before {
        return false;
    }
    let own = shape.outline.envelope();
    if !within_limits(&own) {
        let message = format!("its curves run beyond {:e} from the origin", 2.0 * LARGEST);
        faults.push(
            shape.place.clone(),
            shape.item.as_str(),
            message,
            "restrict them, or choose a larger unit of length",
        );
    } else if own.size() < SMALLEST_REL * size {
        let message = format!(
            "it measures {} across, less than {SMALLEST_REL:e} of the whole problem ({})",
            show(rounded(own.size())),
            show(rounded(size))
        );
        faults.push(
            shape.place.clone(),
            shape.item.as_str(),
            message,
            "make it larger, or solve it in a file of its own",
        );
    }
    faults.len() == before
}

/// Notes the pairs of sound subdomains with common points inside both; in the order of the file.
fn overlaps(subdomains: &[SubdomainDraft], regions: &[Option<Region>], size: f64, faults: &mut Faults) {
    // Swept from left to right, so that thousands of subdomains side by side are compared with their neighbours only.
    let indexed = |(k, region): (usize, &Option<Region>)| Some((k, IndexedRegion::new(region.as_ref()?)));
    let mut order: Vec<_> = regions.iter().enumerate().filter_map(indexed).collect();
    order.sort_by(|(_, a), (_, b)| a.envelope().min[0].total_cmp(&b.envelope().min[0]));
    let mut open: Vec<&(usize, IndexedRegion)> = Vec::new();
    for this in &order {
        let (k, region) = this;
        open.retain(|(_, other)| other.envelope().max[0] >= region.envelope().min[0]);
        for (other, other_region) in open.iter().copied() {
            let Some(at) = overlap(other_region, region, TOUCH_REL * size) else { continue };
            let (first, second) = (*k.min(other), *k.max(other));
            let Some(shape) = &subdomains[second].contour else { continue };
            let message = format!("it overlaps {}, for example at {}", subdomains[first].item, point(at, size));
            let remedy = "let them share edges only; one that lies within another needs a hole of its shape there";
            faults.push(shape.place.clone(), shape.item.as_str(), message, remedy);
        }
        open.push(this);
    }
}

/// A point for a message: six digits are enough to find it, and what is rounding is 0.
fn point(p: Point, size: f64) -> String {
    let [x, y] = p.map(|c| if c.abs() <= TOUCH_REL * size { 0.0 } else { rounded(c) }).map(limits::show);
    format!("({x}, {y})")
}
