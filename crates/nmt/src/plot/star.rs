//! The picture of one star: its nodes by weight, what hides others, and its ∇² row in a table.

use super::axes::{Axes, View};
use super::colour::{Map, Rgb};
use super::names::{meets, overlap};
use super::page::{MARGIN, description, title};
use super::scene::{Anchor, MarkForm, Point, Polyline, Scene, Shape, Stroke};
use super::text::{Run, Style, plain, width, wrapped};
use super::{Caption, StarFigure, is_drawable};

/// Size of the frame.
const FRAME: f64 = 600.0;
/// The frame shows this many radii to each side of the centre.
const SEEN: f64 = 1.3;
/// Width of the table, and between it and the frame.
const TABLE: f64 = 250.0;
const TABLE_GAP: f64 = 28.0;
/// Size and line of the table and of the numbers of nodes.
const SIZE: f64 = 13.0;
const LINE: f64 = 17.5;
/// Most rows of the table; the printed one has all.
const MOST_ROWS: usize = 34;
/// Sizes of marks: the least weight, the greatest, the centre.
const MARKS: [f64; 3] = [8.0, 20.0, 22.0];
const MESH: Stroke = Stroke { colour: Rgb(0xdcdcdc), width: 0.8, opacity: 1.0 };
const BOUNDARY: Stroke = Stroke { colour: Rgb::INK, width: 2.0, opacity: 1.0 };
const CIRCLE: Stroke = Stroke { colour: Rgb(0x6b6b6b), width: 1.0, opacity: 1.0 };
const HIDDEN: Stroke = Stroke { colour: Rgb(0xc0392b), width: 2.0, opacity: 1.0 };

/// The figure.
pub(super) fn scene(caption: &Caption<'_>, figure: &StarFigure<'_>) -> Scene {
    let place = |node: u32| figure.part.xy.get(node as usize).copied().filter(|p| p.iter().all(|&v| is_drawable(v)));
    let centre = place(figure.node).unwrap_or([0.0; 2]);
    let reach = figure.semi_axes[0].max(figure.semi_axes[1]);
    let reach = if reach.is_normal() && is_drawable(reach) { SEEN * reach } else { 1.0 };
    let view = View { corner: centre.map(|c| c - reach), scale: 0.5 * FRAME / reach, size: [FRAME; 2] };
    let axes = Axes::new(view, caption.units);
    let margins = axes.margins();
    let left = MARGIN + margins.left;
    let page_width = (left + FRAME + margins.right.max(TABLE_GAP) + TABLE + MARGIN).ceil();
    let (mut shapes, title_height) = title(caption, page_width);
    let origin = [left, MARGIN + title_height];
    let to_page = |node: u32| place(node).map(|p| view.to_page(origin, p));
    let bounds = [origin[0], origin[1], origin[0] + FRAME, origin[1] + FRAME];

    let line = |a: u32, b: u32| clip(to_page(a)?, to_page(b)?, bounds);
    let sides = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    // A side between two triangles is drawn once, by that in which it leads upwards; those of the rim are drawn below.
    let web = figure.part.triangles.iter().flat_map(sides).filter(|(a, b)| a < b);
    let web = web.filter_map(|(a, b)| line(a, b)).map(|ends| Polyline::open(ends.to_vec())).collect();
    shapes.push(Shape::lines(web, MESH));
    let rims = figure.part.loops.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    let rims: Vec<[Point; 2]> = rims.filter_map(|(a, b)| line(*a, *b)).collect();
    shapes.push(Shape::lines(rims.iter().map(|ends| Polyline::open(ends.to_vec())).collect(), BOUNDARY));
    let ellipse = (0..96).map(|k| {
        let (sine, cosine) = (f64::from(k) * std::f64::consts::TAU / 96.0).sin_cos();
        view.to_page(origin, [centre[0] + figure.semi_axes[0] * cosine, centre[1] + figure.semi_axes[1] * sine])
    });
    let ellipse: Vec<Point> = ellipse.filter(|p| p.iter().all(|v| v.is_finite())).collect();
    shapes.push(Shape::lines(vec![Polyline::closed(ellipse)], CIRCLE));

    let within = |p: &Point| p[0] > bounds[0] && p[1] > bounds[1] && p[0] < bounds[2] && p[1] < bounds[3];
    let others = (0..figure.part.xy.len()).filter_map(|node| to_page(u32::try_from(node).ok()?)).filter(within);
    let others = Shape::Marks { centres: others.collect(), form: MarkForm::Disc, size: 4.0, colour: Rgb(0xa8a8a8) };
    shapes.push(others);
    let crosses = figure.hidden.iter().filter_map(|node| to_page(*node)).flat_map(|[x, y]| {
        let d = 6.0;
        [[[x - d, y - d], [x + d, y + d]], [[x - d, y + d], [x + d, y - d]]].map(|ends| Polyline::open(ends.to_vec()))
    });
    shapes.push(Shape::lines(crosses.collect(), HIDDEN));

    let looks = Looks::of(figure);
    // The least weights last: they are the smallest marks.
    let mut marked: Vec<(Point, f64, u32)> = Vec::new();
    for member in figure.members {
        let Some(at) = to_page(member.node) else { continue };
        let size = looks.size(member.weight);
        marked.push((at, size, member.node));
        if member.node == figure.node {
            shapes.extend(super::page::marks(vec![at], MarkForm::Disc, size, Rgb::INK, Some(Rgb::WHITE)));
        } else {
            let form = MarkForm::Disc;
            shapes.push(Shape::Marks { centres: vec![at], form, size: size + 1.6, colour: Rgb::INK });
            shapes.push(Shape::Marks { centres: vec![at], form, size, colour: looks.colour(member.weight) });
        }
    }
    marked.extend(figure.hidden.iter().filter_map(|node| Some((to_page(*node)?, 12.0, *node))));
    shapes.extend(numbers(&marked, &rims, bounds));
    shapes.push(axes.draw(origin));
    let table_left = origin[0] + FRAME + margins.right.max(TABLE_GAP);
    shapes.push(table(figure, &looks, [table_left, origin[1]]));

    let mut y = origin[1] + FRAME + margins.bottom + 20.0;
    let about = figure.about.join("; ");
    for text in wrapped(&about, SIZE + 1.0, page_width - 2.0 * MARGIN, 4) {
        shapes.push(Shape::text([MARGIN, y], SIZE + 1.0, Anchor::Start, plain(text)));
        y += LINE + 1.0;
    }
    let note = "Marks grow with the logarithm of the weight; the ring is the centre. Thin: the radius. Red crosses: \
                nodes within it that the boundary hides.";
    for text in wrapped(note, SIZE, page_width - 2.0 * MARGIN, 3) {
        shapes.push(Shape::text([MARGIN, y], SIZE, Anchor::Start, plain(text)));
        y += LINE;
    }
    let kind = format!("star of node {}", figure.node);
    Scene { width: page_width, height: (y + MARGIN - SIZE).ceil(), description: description(caption, &kind), shapes }
}

/// How marks show weights: by their logarithm.
struct Looks {
    low: f64,
    high: f64,
}

impl Looks {
    fn of(figure: &StarFigure<'_>) -> Self {
        let logs = figure.members.iter().map(|m| m.weight.ln()).filter(|v| v.is_finite());
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        Self { low, high }
    }

    /// 0 for the least weight, 1 for the greatest.
    fn share(&self, weight: f64) -> f64 {
        let share = (weight.ln() - self.low) / (self.high - self.low);
        if share.is_finite() { share.clamp(0.0, 1.0) } else { 1.0 }
    }

    fn size(&self, weight: f64) -> f64 {
        if weight.is_infinite() { MARKS[2] } else { MARKS[0] + (MARKS[1] - MARKS[0]) * self.share(weight) }
    }

    fn colour(&self, weight: f64) -> Rgb {
        Map::Sequential.at(0.95 - 0.75 * self.share(weight))
    }
}

/// Numbers of nodes beside their marks, at the first of eight places where they lie on nothing else, better not on the
/// boundary either.
fn numbers(marked: &[(Point, f64, u32)], rims: &[[Point; 2]], bounds: [f64; 4]) -> Vec<Shape> {
    let mut taken: Vec<[f64; 4]> = marked
        .iter()
        // A disc leaves the corners of its box to the numbers.
        .map(|([x, y], size, _)| [x - 0.35 * size, y - 0.35 * size, x + 0.35 * size, y + 0.35 * size])
        .collect();
    let mut shapes = Vec::new();
    for ([x, y], size, node) in marked {
        let text = node.to_string();
        let half = [0.5 * width(&plain(&text), SIZE), 0.4 * SIZE];
        let away = [0.5 * size + half[0] + 2.0, 0.5 * size + half[1] + 2.0];
        let side = 0.36 * size + 1.0;
        let corner = [side + half[0], side + half[1]];
        let candidates = [
            [corner[0], -corner[1]],
            [corner[0], corner[1]],
            [-corner[0], -corner[1]],
            [-corner[0], corner[1]],
            [away[0], 0.0],
            [-away[0], 0.0],
            [0.0, -away[1]],
            [0.0, away[1]],
        ];
        let place = |[dx, dy]: &Point, off_boundary: bool| {
            let centre = [x + dx, y + dy];
            let own = [centre[0] - half[0], centre[1] - half[1], centre[0] + half[0], centre[1] + half[1]];
            let inside = own[0] > bounds[0] && own[1] > bounds[1] && own[2] < bounds[2] && own[3] < bounds[3];
            let clear = !taken.iter().any(|other| overlap(own, *other));
            let off = !off_boundary || !rims.iter().any(|line| meets(own, *line));
            (inside && clear && off).then_some((centre, own))
        };
        let off_boundary = candidates.iter().find_map(|offset| place(offset, true));
        let free = off_boundary.or_else(|| candidates.iter().find_map(|offset| place(offset, false)));
        if let Some((centre, own)) = free {
            taken.push(own);
            let at = [centre[0], super::axes::centred_baseline(centre[1], SIZE)];
            shapes.push(Shape::text(at, SIZE, Anchor::Middle, plain(text)));
        }
    }
    shapes
}

/// Node, weight and coefficient of every node of the star.
fn table(figure: &StarFigure<'_>, looks: &Looks, [left, top]: Point) -> Shape {
    let columns = [left + 74.0, left + 150.0, left + TABLE];
    let mut shapes = Vec::new();
    let mut y = top + SIZE;
    for (head, x) in ["node", "weight"].into_iter().zip(columns) {
        shapes.push(Shape::text([x, y], SIZE, Anchor::End, plain(head)));
    }
    let derivative = |index: &str| [Run::new("F", Style::Italic), Run::new(index, Style::Subscript)];
    let head = [vec![Run::upright("in ")], derivative("xx").into(), vec![Run::upright(" + ")], derivative("yy").into()]
        .concat();
    shapes.push(Shape::text([columns[2], y], SIZE, Anchor::End, head));
    let rule = vec![Polyline::open(vec![[left, y + 7.0], [left + TABLE, y + 7.0]])];
    shapes.push(Shape::lines(rule, CIRCLE));
    y += 5.0;
    for member in figure.members.iter().take(MOST_ROWS) {
        y += LINE;
        let mark = [left + 11.0, y - 0.35 * SIZE];
        let size = looks.size(member.weight).min(LINE - 2.0);
        if member.node == figure.node {
            shapes.extend(super::page::marks(vec![mark], MarkForm::Disc, size, Rgb::INK, Some(Rgb::WHITE)));
        } else {
            let colour = looks.colour(member.weight);
            shapes.push(Shape::Marks { centres: vec![mark], form: MarkForm::Disc, size, colour });
        }
        let weight = if member.weight.is_finite() { scientific(member.weight) } else { "∞".into() };
        let laplacian =
            member.laplacian.map_or("–".into(), |v| format!("{}{}", if v > 0.0 { "+" } else { "" }, scientific(v)));
        for (text, x) in [member.node.to_string(), weight, laplacian].into_iter().zip(columns) {
            shapes.push(Shape::text([x, y], SIZE, Anchor::End, plain(text)));
        }
    }
    if figure.members.len() > MOST_ROWS {
        let more = format!("and {} more", figure.members.len() - MOST_ROWS);
        shapes.push(Shape::text([left, y + LINE], SIZE, Anchor::Start, plain(more)));
    }
    Shape::Group { id: "table", shapes }
}

/// Five digits, with an exponent where they need one.
fn scientific(value: f64) -> String {
    let size = value.abs();
    let text = if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e5).contains(&size) {
        format!("{value:.prec$}", prec = (4 - size.log10().floor() as i32).max(0) as usize)
    } else {
        format!("{value:.3e}")
    };
    text.replace('-', "−")
}

/// What of the segment `p q` lies within `bounds` (left, top, right, bottom).
fn clip(p: Point, q: Point, bounds: [f64; 4]) -> Option<[Point; 2]> {
    let (mut low, mut high) = (0.0f64, 1.0f64);
    for k in 0..2 {
        let d = q[k] - p[k];
        let (near, far) = (bounds[k] - p[k], bounds[k + 2] - p[k]);
        if d == 0.0 {
            if near > 0.0 || far < 0.0 {
                return None;
            }
            continue;
        }
        low = low.max((near / d).min(far / d));
        high = high.min((near / d).max(far / d));
    }
    let at = |t: f64| [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
    (low < high).then(|| [at(low), at(high)])
}
