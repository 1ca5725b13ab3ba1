//! The picture of τ along edges: of each subdomain a drawing that names its edges, and a diagram over each of its loops.

use super::axes::{TICK_SIZE, centred_baseline};
use super::colour::{Rgb, of_subdomain};
use super::names::{Named, Names, Stretch, beside};
use super::page::{MARGIN, PAGE_WIDTH, description, tint, title};
use super::scene::{Anchor, MarkForm, Point, Polyline, Scene, Shape, Stroke};
use super::strip::Strip;
use super::text::{Run, Style, clipped, plain, wrapped};
use super::ticks::{three_digits, unit_exponent};
use super::{Caption, EdgeProfile, Profiles, is_drawable};

/// Left of the diagrams: ticks, their labels, the label of the axis.
const LEFT: f64 = MARGIN + 76.0;
/// Size of a diagram.
const DIAGRAM: Point = [PAGE_WIDTH - LEFT - MARGIN - 14.0, 170.0];
/// Room of the drawing, and of the names around it.
const DRAWING: Point = [560.0, 250.0];
const NAMES_ROOM: f64 = 64.0;
/// Size of headings and notes.
const HEADING: f64 = 15.0;
const NOTE: f64 = 13.0;
/// Between subdomains, and between diagrams.
const GAP: f64 = 26.0;
/// Free room above the largest value.
const HEADROOM: f64 = 1.2;
/// Values at vertices where τ is infinite are cut off where they are above the others by more than this factor.
const CUT_FACTOR: f64 = 1.5;
/// Nodes this near to such a vertex, as a fraction of their edge, belong to its peak.
const PEAK_SHARE: f64 = 0.1;
/// Nodes at least this far apart, in page units, have marks.
const MARKED_DISTANCE: f64 = 9.0;
/// Look of a vertex where τ is infinite.
const SINGULAR: Stroke = Stroke { colour: Rgb(0xc0392b), width: 1.2, opacity: 1.0 };
/// Lines at vertices.
const VERTEX: Stroke = Stroke { colour: Rgb(0x8a8a8a), width: 0.8, opacity: 1.0 };

/// The figure.
pub(super) fn scene(caption: &Caption<'_>, subdomains: &[Profiles<'_>]) -> Scene {
    let (mut shapes, title_height) = title(caption, PAGE_WIDTH);
    let mut y = MARGIN + title_height;
    let (mut cut, mut singular) = (false, false);
    for (number, profiles) in subdomains.iter().enumerate() {
        if subdomains.len() > 1 {
            let name = clipped(profiles.name, HEADING, PAGE_WIDTH - 2.0 * MARGIN);
            shapes.push(Shape::text([MARGIN, y + HEADING], HEADING, Anchor::Start, plain(name)));
            y += HEADING + 8.0;
        }
        shapes.extend(drawing(profiles, number, &mut y));
        let top = Top::of(profiles);
        cut |= top.is_cut;
        for edges in profiles.loops {
            singular |= edges.iter().any(|edge| edge.is_singular[0]);
            shapes.extend(diagram(caption, profiles, edges, number, top.value, &mut y));
            y += GAP;
        }
    }
    for line in notes(singular, cut) {
        shapes.push(Shape::text([LEFT, y], NOTE, Anchor::Start, plain(line)));
        y += 1.4 * NOTE;
    }
    let height = (y + MARGIN - NOTE).ceil();
    Scene { width: PAGE_WIDTH, height, description: description(caption, "τ along the edges"), shapes }
}

/// What stands below the diagrams.
fn notes(singular: bool, cut: bool) -> Vec<String> {
    let mut text = String::from(
        "s: arc length along the edges as the file lists them, from the ringed vertex the way of the arrow. \
         Ringed dot: the largest τ at nodes of the loop",
    );
    if singular {
        text.push_str(" away from red vertices. Red: re-entrant vertices, where the exact τ is infinite and the value at nodes grows under refinement");
        text.push_str(if cut { "; the axis ends below those values." } else { "." });
    } else {
        text.push('.');
    }
    wrapped(&text, NOTE, PAGE_WIDTH - LEFT - MARGIN, 4)
}

/// Where the ordinates of a subdomain's diagrams end.
struct Top {
    value: f64,
    is_cut: bool,
}

impl Top {
    /// Above all values but the peaks at vertices where τ is infinite, where those would squeeze the others.
    fn of(profiles: &Profiles<'_>) -> Self {
        let (mut all, mut calm) = (0.0f64, 0.0f64);
        for edge in profiles.loops.iter().flat_map(|edges| edges.iter()) {
            for [s, tau] in shown(edge) {
                all = all.max(tau);
                if !is_peak(edge, s) {
                    calm = calm.max(tau);
                }
            }
        }
        let is_cut = calm > 0.0 && all > CUT_FACTOR * calm;
        let value = HEADROOM * if is_cut { calm } else { all };
        Self { value: if value.is_normal() { value } else { 1.0 }, is_cut }
    }
}

/// True where the place at `s` belongs to the peak at a vertex where τ is infinite.
fn is_peak(edge: &EdgeProfile<'_>, s: f64) -> bool {
    let near = [s, edge.length - s].map(|d| d < PEAK_SHARE * edge.length);
    (0..2).any(|end| edge.is_singular[end] && near[end])
}

/// (s, τ) at the nodes of an edge.
fn shown(edge: &EdgeProfile<'_>) -> Vec<Point> {
    edge.s.iter().zip(edge.tau).map(|(s, tau)| [*s, *tau]).filter(|p| p.iter().all(|&v| is_drawable(v))).collect()
}

/// The outlines with their vertices and the names of the edges; moves `y` below it.
fn drawing(profiles: &Profiles<'_>, number: usize, y: &mut f64) -> Vec<Shape> {
    let edges: Vec<&EdgeProfile<'_>> = profiles.loops.iter().flat_map(|edges| edges.iter()).collect();
    let all = edges.iter().flat_map(|edge| edge.xy).filter(|p| p.iter().all(|&v| is_drawable(v)));
    let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for p in all {
        (min, max) = ([min[0].min(p[0]), min[1].min(p[1])], [max[0].max(p[0]), max[1].max(p[1])]);
    }
    let span = [max[0] - min[0], max[1] - min[1]];
    if !(span[0] >= 0.0 && span[1] >= 0.0 && span[0].max(span[1]).is_normal()) {
        return Vec::new();
    }
    let scale = (DRAWING[0] / span[0]).min(DRAWING[1] / span[1]);
    let origin = [0.5 * (PAGE_WIDTH - scale * span[0]), *y + NAMES_ROOM * 0.5];
    let bottom = origin[1] + scale * span[1];
    let to_page = |p: &Point| [origin[0] + scale * (p[0] - min[0]), bottom - scale * (p[1] - min[1])];
    let pages: Vec<Vec<Point>> = edges.iter().map(|edge| edge.xy.iter().map(to_page).collect()).collect();

    let (mut outlines, mut next) = (Vec::new(), 0);
    for edges in profiles.loops {
        let ring: Vec<Point> =
            pages[next..next + edges.len()].iter().flat_map(|page| page.iter().skip(1)).copied().collect();
        outlines.push(Polyline::closed(ring));
        next += edges.len();
    }
    let colour = of_subdomain(number);
    let mut shapes = vec![
        Shape::area(outlines.clone(), tint(colour)),
        Shape::lines(outlines, Stroke::new(colour.mixed(Rgb::BLACK, 0.25), 1.6)),
    ];
    let (mut next, mut named, mut taken) = (0, Vec::new(), Vec::new());
    for (k, edges) in profiles.loops.iter().enumerate() {
        let own = &pages[next..next + edges.len()];
        next += edges.len();
        shapes.extend(vertices(edges, own));
        // Names keep off the ring at the first vertex.
        taken.extend(
            own.iter().filter_map(|page| page.first()).take(1).map(|&[x, y]| [x - 8.0, y - 8.0, x + 8.0, y + 8.0]),
        );
        let ring: Vec<Point> = own.iter().flat_map(|page| page.iter().skip(1)).copied().collect();
        let around = ring.iter().zip(ring.iter().cycle().skip(1));
        // On the page y leads down: a loop that is counter-clockwise in the plane has a negative area here.
        let counter_clockwise = around.map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>() < 0.0;
        let material = if counter_clockwise == (k == 0) { 1.0 } else { -1.0 };
        named.extend(edges.iter().zip(own).map(|(edge, points)| Named { name: edge.name, points, material }));
    }
    shapes.extend(beside(&named, taken, [MARGIN, *y, PAGE_WIDTH - MARGIN, bottom + 0.5 * NAMES_ROOM]));
    *y = bottom + 0.5 * NAMES_ROOM;
    vec![Shape::Group { id: "drawing", shapes }]
}

/// Marks at the vertices of a loop, the first one ringed, with an arrow the way of s.
fn vertices(edges: &[EdgeProfile<'_>], pages: &[Vec<Point>]) -> Vec<Shape> {
    let firsts = |singular: bool| -> Vec<Point> {
        let own = edges.iter().zip(pages).filter(|(edge, _)| edge.is_singular[0] == singular);
        own.filter_map(|(_, page)| page.first().copied()).collect()
    };
    let mark = |centres, size, colour| Shape::Marks { centres, form: MarkForm::Square, size, colour };
    let mut shapes = vec![mark(firsts(false), 5.0, Rgb::BLACK), mark(firsts(true), 7.0, SINGULAR.colour)];
    if let Some([p, q]) = pages.first().and_then(|page| page.get(..2)) {
        let along = [q[0] - p[0], q[1] - p[1]];
        let size = along[0].hypot(along[1]).max(f64::MIN_POSITIVE);
        let at = |forward: f64, left: f64| {
            let [t_x, t_y] = along.map(|v| v / size);
            [p[0] + forward * t_x - left * t_y, p[1] + forward * t_y + left * t_x]
        };
        let ring = (0..24).map(|k| {
            let (sine, cosine) = (f64::from(k) * std::f64::consts::TAU / 24.0).sin_cos();
            [p[0] + 7.0 * cosine, p[1] + 7.0 * sine]
        });
        shapes.push(Shape::lines(vec![Polyline::closed(ring.collect())], Stroke::new(Rgb::INK, 1.1)));
        shapes.push(Shape::area(vec![Polyline::closed(vec![at(24.0, 0.0), at(13.0, 4.5), at(13.0, -4.5)])], Rgb::INK));
    }
    shapes
}

/// τ over the arc length around a loop; moves `y` below it.
fn diagram(
    caption: &Caption<'_>,
    profiles: &Profiles<'_>,
    edges: &[EdgeProfile<'_>],
    number: usize,
    top: f64,
    y: &mut f64,
) -> Vec<Shape> {
    let length: f64 = edges.iter().map(|edge| edge.length).sum();
    if !length.is_normal() || !is_drawable(length) {
        return Vec::new();
    }
    let mut strip = Strip { origin: [LEFT, 0.0], size: DIAGRAM, reach: [length, top] };
    let mut starts = Vec::with_capacity(edges.len());
    edges.iter().fold(0.0, |s, edge| {
        starts.push(s);
        s + edge.length
    });
    let stretch = |(edge, start): (&'_ EdgeProfile<'_>, &f64)| [strip.x(*start), strip.x(start + edge.length)];
    let ends: Vec<[f64; 2]> = edges.iter().zip(&starts).map(stretch).collect();
    let stretches: Vec<Stretch> =
        edges.iter().zip(&ends).map(|(edge, [from, to])| Stretch { name: edge.name, from: *from, to: *to }).collect();
    let names = Names::new(&stretches);
    strip.origin[1] = *y + names.height();
    let (upper, lower) = (strip.origin[1], strip.bottom());
    *y = lower + Strip::BELOW;

    let colour = of_subdomain(number);
    let mut shapes = vec![strip.grid()];
    let points: Vec<Vec<Point>> = edges
        .iter()
        .zip(&starts)
        .map(|(edge, start)| shown(edge).into_iter().map(|[s, tau]| [start + s, tau]).collect())
        .collect();
    for own in &points {
        shapes.extend(strip.curve(own, colour.mixed(Rgb::WHITE, 0.8), Stroke::new(colour, 1.7)));
    }
    let n_nodes: usize = points.iter().map(Vec::len).sum();
    if strip.size[0] >= MARKED_DISTANCE * n_nodes as f64 {
        let seen = points.iter().flatten().filter(|p| p[1] <= top).map(|p| [strip.x(p[0]), strip.y(p[1])]).collect();
        shapes.push(Shape::Marks { centres: seen, form: MarkForm::Disc, size: 3.6, colour });
    }
    let upright = |x: f64| Polyline::open(vec![[x, upper], [x, lower]]);
    let at_vertices = |singular: bool| {
        let own = edges.iter().zip(&ends).filter(|(edge, _)| edge.is_singular[0] == singular);
        own.map(|(_, [from, _])| upright(*from)).collect::<Vec<_>>()
    };
    shapes.push(Shape::lines(at_vertices(false), VERTEX));
    let mut red = at_vertices(true);
    // The first vertex stands at the end of the diagram too.
    if edges.first().is_some_and(|edge| edge.is_singular[0]) {
        red.push(upright(strip.origin[0] + strip.size[0]));
    }
    shapes.push(Shape::lines(red, SINGULAR));
    shapes.extend(largest(&strip, edges, &starts, &points));

    let abscissa = vec![Run::new("s", Style::Italic)];
    let abscissa = if profiles.loops.len() > 1 {
        let name =
            clipped(profiles.loop_names.get(ring_of(profiles, edges)).copied().unwrap_or_default(), HEADING, 300.0);
        [vec![Run::upright(format!("{name}: "))], abscissa].concat()
    } else {
        abscissa
    };
    shapes.push(strip.axes(abscissa, vec![Run::new("τ", Style::Italic)], caption.units));
    shapes.extend(names.draw(upper));
    vec![Shape::Group { id: "diagram", shapes }]
}

/// Number of the loop that `edges` are of.
fn ring_of(profiles: &Profiles<'_>, edges: &[EdgeProfile<'_>]) -> usize {
    profiles.loops.iter().position(|own| std::ptr::eq(own.as_ptr(), edges.as_ptr())).unwrap_or(0)
}

/// A ring with its value at the largest τ of the loop's nodes; peaks at vertices where it is infinite are left out.
fn largest(strip: &Strip, edges: &[EdgeProfile<'_>], starts: &[f64], points: &[Vec<Point>]) -> Vec<Shape> {
    let mut best: Option<Point> = None;
    for ((edge, start), own) in edges.iter().zip(starts).zip(points) {
        // A local maximum: the flank of a peak has none.
        let around = |k: usize| own[k.saturating_sub(1)..(k + 2).min(own.len())].iter();
        let is_top = |k: &usize| around(*k).all(|other| other[1] <= own[*k][1]) && !is_peak(edge, own[*k][0] - start);
        for p in (0..own.len()).filter(is_top).map(|k| &own[k]) {
            if best.is_none_or(|b| p[1] > b[1] * (1.0 + 1e-9)) {
                best = Some(*p); // of values that differ by rounding the first
            }
        }
    }
    let Some(best) = best.filter(|p| p[1] > 0.0) else { return Vec::new() };
    let [x, y] = [strip.x(best[0]), strip.y(best[1])];
    let ring = super::page::marks(vec![[x, y]], MarkForm::Disc, 8.0, Rgb::INK, Some(Rgb::WHITE));
    let left = x < strip.origin[0] + strip.size[0] - 60.0;
    let (anchor, aside) = if left { (Anchor::Start, 8.0) } else { (Anchor::End, -8.0) };
    let at = [x + aside, centred_baseline((y - 10.0).max(strip.origin[1] + 9.0), TICK_SIZE)];
    [ring, vec![Shape::text(at, TICK_SIZE, anchor, plain(three_digits(best[1], unit_exponent(strip.reach[1]))))]]
        .concat()
}
