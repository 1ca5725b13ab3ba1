//! The three figures as a whole: whatever comes in, a tidy page comes out.

use super::scene::{Anchor, Direction, Scene, Shape};
use super::*;

/// A subdomain of its own data.
struct Section {
    name: &'static str,
    xy: Vec<[f64; 2]>,
    marks: Vec<NodeMark>,
    loops: Vec<Vec<u32>>,
    triangles: Vec<[u32; 3]>,
    values: Vec<f64>,
}

impl Section {
    /// `width` by `height`, `n + 1` by `n + 1` nodes, corner at `at`, values of a signed bump.
    fn rectangle(name: &'static str, at: [f64; 2], [width, height]: [f64; 2], n: u32) -> Self {
        let m = n + 1;
        let node = |i: u32| [f64::from(i % m) / f64::from(n), f64::from(i / m) / f64::from(n)];
        let unit: Vec<[f64; 2]> = (0..m * m).map(node).collect();
        let mark = |p: &[f64; 2]| match p.iter().filter(|&&v| v == 0.0 || v == 1.0).count() {
            2 => NodeMark::Vertex,
            1 => NodeMark::Edge,
            _ => NodeMark::Interior,
        };
        let rim = (0..n)
            .chain((0..n).map(|k| n + k * m))
            .chain((0..n).map(|k| n * m + n - k))
            .chain((0..n).map(|k| (n - k) * m));
        let cells = (0..n * n).map(|c| c / n * m + c % n);
        Self {
            name,
            xy: unit.iter().map(|p| [at[0] + width * p[0], at[1] + height * p[1]]).collect(),
            marks: unit.iter().map(mark).collect(),
            loops: vec![rim.collect()],
            triangles: cells.flat_map(|a| [[a, a + 1, a + m + 1], [a, a + m + 1, a + m]]).collect(),
            values: unit.iter().map(|p| (3.0 * p[0]).sin() * (4.0 * p[1]).cos()).collect(),
        }
    }

    fn part(&self) -> Part<'_> {
        Part {
            name: self.name,
            xy: &self.xy,
            marks: &self.marks,
            spacings: &[],
            loops: &self.loops,
            triangles: &self.triangles,
        }
    }

    fn fields(&self) -> Fields<'_> {
        Fields { f: &self.values, tau_zx: &self.values, tau_zy: &self.values, tau: &self.values }
    }
}

fn scenes(caption: &Caption<'_>, sections: &[Section]) -> [Scene; 3] {
    let parts: Vec<Part<'_>> = sections.iter().map(Section::part).collect();
    let solved: Vec<(Part<'_>, Fields<'_>)> = sections.iter().map(|s| (s.part(), s.fields())).collect();
    let fields: Vec<_> = solved.iter().map(|(part, f)| (*part, [f.f, f.tau_zx, f.tau_zy, f.tau])).collect();
    let solution = solution::scene(caption, &solution::TORSION, &fields, |_| 0.0);
    [nodes::scene(caption, &parts), mesh::scene(caption, &parts), solution]
}

fn figures(caption: &Caption<'_>, sections: &[Section]) -> [String; 3] {
    scenes(caption, sections).map(|scene| svg::render(&scene))
}

/// Left, top, right and bottom of every text with the letters it holds.
fn text_boxes(shapes: &[Shape], found: &mut Vec<([f64; 4], String)>) {
    for shape in shapes {
        match shape {
            Shape::Clipped { shapes, .. } | Shape::Group { shapes, .. } => text_boxes(shapes, found),
            Shape::Text(text) => {
                let width = text::width(&text.runs, text.size);
                let before = match text.anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => 0.5 * width,
                    Anchor::End => width,
                };
                let (up, down) = (0.74 * text.size, 0.22 * text.size);
                let [x, y] = text.at;
                let bounds = match text.direction {
                    Direction::Rightwards => [x - before, y - up, x - before + width, y + down],
                    Direction::Upwards => [x - up, y + before - width, x + down, y + before],
                };
                found.push((bounds, text.runs.iter().map(|run| run.text.as_str()).collect()));
            }
            Shape::Path { .. } | Shape::Marks { .. } => {}
        }
    }
}

/// Panics unless every text lies on the page and none touches another.
fn assert_tidy(scene: &Scene, case: &str) {
    let mut boxes = Vec::new();
    text_boxes(&scene.shapes, &mut boxes);
    for (k, (a, text)) in boxes.iter().enumerate() {
        let on_page = a[0] >= 0.0 && a[1] >= 0.0 && a[2] <= scene.width && a[3] <= scene.height;
        assert!(on_page, "{case}: `{text}` leaves the page of {} by {}: {a:?}", scene.width, scene.height);
        for (b, other) in &boxes[k + 1..] {
            let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
            assert!(apart, "{case}: `{text}` touches `{other}`: {a:?} {b:?}");
        }
    }
}

/// Panics unless tags are balanced, attributes quoted and no bare `&` or `<` is left: enough to catch a slip of the writer.
fn assert_well_formed(svg: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = svg.strip_prefix("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n").expect("declaration");
    while let Some(start) = rest.find('<') {
        let (text, tag) = rest.split_at(start);
        assert!(!text.contains('>'));
        for entity in text.split('&').skip(1) {
            assert!(["amp;", "lt;", "gt;", "quot;"].iter().any(|name| entity.starts_with(name)));
        }
        let end = tag.find('>').expect("closed tag");
        let inner = &tag[1..end];
        assert!(!inner.contains('<') && inner.matches('"').count() % 2 == 0);
        if let Some(name) = inner.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !inner.ends_with('/') {
            open.push(inner.split(' ').next().unwrap_or(inner));
        }
        rest = &tag[end + 1..];
    }
    assert!(open.is_empty() && rest.trim().is_empty());
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn no_text_touches_another_or_leaves_the_page_whatever_the_shape() {
    let long =
        "A title so long that no page can hold it on one line, nor would anyone want to read it there ".repeat(3);
    for (w, h) in
        [(1.0, 1.0), (20.0, 1.0), (1.0, 20.0), (3.0, 1.0), (1.0, 2.7), (1e-6, 1.4e-6), (1e6, 3e5), (100.0, 1.0)]
    {
        for (title, units) in [("", ""), ("Square", "m"), (long.as_str(), "furlongs")] {
            for at in [[0.0, 0.0], [-0.5 * w, -0.5 * h], [1e5 * w, -3e6 * h]] {
                let caption = Caption { title, units };
                let mut sections = vec![Section::rectangle("first", at, [w, h], 6)];
                for scene in scenes(&caption, &sections) {
                    assert_tidy(&scene, &format!("{w} by {h} at {at:?}, {}", scene.description));
                }
                sections.push(Section::rectangle("a second one of a longer name", [at[0] + w, at[1]], [w, h], 3));
                sections[0].values[10] = -1e7;
                for scene in scenes(&caption, &sections) {
                    assert_tidy(&scene, &format!("two of {w} by {h} at {at:?}, {}", scene.description));
                }
            }
        }
    }
}

#[test]
fn capped_and_scaled_colour_bars_are_tidy() {
    for size in [1e-9, 1e-3, 1.0, 123.0, 54_321.0, 1e12] {
        let mut section = Section::rectangle("", [0.0, 0.0], [2.0, 1.0], 40);
        section.values.iter_mut().for_each(|v| *v *= size);
        section.values[800] = 87.0 * size;
        section.values[900] = -69.0 * size;
        let [.., solution] = scenes(&Caption { title: "Peaks", units: "mm" }, &[section]);
        assert_tidy(&solution, &format!("values of {size}"));
        assert!(svg::render(&solution).contains("max "));
    }
}

#[test]
fn equal_input_gives_equal_bytes() {
    let draw =
        || figures(&Caption { title: "Twice", units: "m" }, &[Section::rectangle("", [0.0, 0.0], [1.0, 2.0], 12)]);
    assert_eq!(draw(), draw());
}

#[test]
fn names_and_titles_are_escaped() {
    let caption = Caption { title: "F < 1 & \"G\" > 2 \u{1}\u{b}", units: "<m>" };
    let sections = ["a&b", "<b>"].map(|name| Section::rectangle(name, [0.0, 0.0], [1.0, 1.0], 2));
    for svg in figures(&caption, &sections) {
        assert_well_formed(&svg);
        assert!(svg.contains("F &lt; 1 &amp; &quot;G&quot; &gt; 2"));
    }
}

#[test]
fn any_input_gives_a_well_formed_picture() {
    let square = || Section::rectangle("s", [0.0, 0.0], [1.0, 1.0], 4);
    let with = |change: fn(&mut Section)| {
        let mut section = square();
        change(&mut section);
        vec![section]
    };
    let cases = [
        vec![],
        with(|s| {
            *s = Section { name: "", xy: vec![], marks: vec![], loops: vec![], triangles: vec![], values: vec![] }
        }),
        with(|s| s.triangles.clear()),
        with(|s| s.triangles.truncate(1)),
        with(|s| s.loops.clear()),
        with(|s| s.loops = vec![vec![], vec![0], vec![0, 1], vec![0, 1, 999]]),
        with(|s| s.triangles.extend([[0, 1, 999], [3, 3, 4], [0, 1, 2], [0, 6, 1], [0, 1, 6]])),
        with(|s| s.marks.truncate(3)),
        with(|s| s.values.truncate(7)),
        with(|s| s.values.fill(0.0)),
        with(|s| s.values.fill(-3.25)),
        with(|s| s.values.fill(f64::NAN)),
        with(|s| s.values[12] = f64::INFINITY),
        with(|s| s.values[12] = f64::MAX),
        with(|s| s.values[12] = 1e289),
        with(|s| s.values.iter_mut().for_each(|v| *v *= 1e-300)),
        with(|s| s.xy[7] = [f64::NAN, 0.0]),
        with(|s| s.xy[7] = [f64::NEG_INFINITY, f64::MAX]),
        with(|s| s.xy[7] = [1e289, -1e289]),
        with(|s| s.xy.fill([f64::NAN; 2])),
        with(|s| s.xy.fill([2.0, 3.0])),
        with(|s| s.xy.iter_mut().for_each(|p| p[1] = 0.0)),
        with(|s| s.xy.iter_mut().for_each(|p| *p = p.map(|v| 1e300 * v))),
        with(|s| s.xy.iter_mut().for_each(|p| *p = p.map(|v| 1e-310 * v))),
        with(|s| s.xy.iter_mut().for_each(|p| *p = p.map(|v| 1e9 + 1e-6 * v))),
        (0..40).map(|k| Section::rectangle("many", [f64::from(k), 0.0], [1.0, 1.0], 2)).collect(),
    ];
    for (number, sections) in cases.iter().enumerate() {
        for scene in scenes(&Caption { title: "Any", units: "m" }, sections) {
            assert_tidy(&scene, &format!("case {number}"));
            let svg = svg::render(&scene);
            assert_well_formed(&svg);
            #[cfg(feature = "png")]
            assert!(png(&svg).is_ok(), "case {number}");
        }
    }
}

#[test]
fn a_hundred_thousand_nodes_make_small_files() {
    let section = Section::rectangle("large", [0.0, 0.0], [1.0, 1.0], 316);
    assert!(section.xy.len() > 100_000);
    let [nodes, mesh, solution] = figures(&Caption { title: "", units: "" }, &[section]);
    let megabytes = |svg: &str| svg.len() as f64 / 1e6;
    assert!(megabytes(&nodes) < 2.5 && megabytes(&mesh) < 3.0 && megabytes(&solution) < 0.5);
}

#[test]
fn crowded_pictures_stay_small_and_say_what_they_do_not_draw() {
    let caption = Caption { title: "", units: "" };
    let section = Section::rectangle("large", [0.0, 0.0], [1.0, 1.0], 600);
    let [nodes, mesh] = [nodes_figure(&caption, &[section.part()]), mesh_figure(&caption, &[section.part()])];
    assert!(nodes.len() < 3_000_000 && mesh.len() < 100_000, "{} {}", nodes.len(), mesh.len());
    assert!(nodes.contains("358\u{2009}801 interior nodes") && nodes.contains("nodes drawn: one where many lie"));
    assert!(mesh.contains("shaded where edges are too short") && mesh.contains("<clipPath id=\"clip0\">"));

    // Two columns of the same number of nodes: the one is crowded, in the other all edges are drawn.
    let mut xy = section.xy.clone();
    xy.iter_mut().filter(|p| p[0] > 0.1).for_each(|p| p[0] = 0.1 + 100.0 * (p[0] - 0.1));
    let graded = mesh_figure(&caption, &[Part { xy: &xy, ..section.part() }]);
    assert!(graded.len() < 3_000_000, "{}", graded.len());
    // Below the limit nothing of this is said.
    let small = Section::rectangle("small", [0.0, 0.0], [1.0, 1.0], 100);
    assert!(!nodes_figure(&caption, &[small.part()]).contains("drawn"));
    assert!(!mesh_figure(&caption, &[small.part()]).contains("shaded"));
}

#[test]
fn contours_have_no_seams_since_each_band_is_one_path() {
    let section = Section::rectangle("", [0.0, 0.0], [1.0, 1.0], 30);
    let solved = [(section.part(), section.fields())];
    let svg = solution_figure(&Caption { title: "", units: "" }, &solved);
    // Four panels of at most 25 bands, once on the section and once on the bar, and a few lines each.
    assert!(svg.matches("<path").count() < 4 * (2 * 25 + 5) + 1);
}

/// A regular polygon of `n` edges, node `n_nodes` to each, τ a half wave; every `k`-th vertex singular.
fn profiles_of(n: usize, n_nodes: usize, k: usize, draw: impl Fn(&[Profiles<'_>])) {
    let names: Vec<String> = (1..=n).map(|i| format!("edge {i}")).collect();
    let corner = |i: usize| {
        let (sine, cosine) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
        [cosine, sine]
    };
    let share = |j: usize| j as f64 / (n_nodes - 1) as f64;
    let at = |i: usize, j: usize| [0, 1].map(|d| corner(i)[d] + share(j) * (corner(i + 1)[d] - corner(i)[d]));
    let xy: Vec<Vec<[f64; 2]>> = (0..n).map(|i| (0..n_nodes).map(|j| at(i, j)).collect()).collect();
    let s: Vec<f64> = (0..n_nodes).map(share).collect();
    let tau: Vec<f64> = s.iter().map(|s| (3.1 * s).sin() + if *s == 0.0 { 50.0 } else { 0.0 }).collect();
    let edge = |i: usize| EdgeProfile {
        name: &names[i],
        length: 1.0,
        xy: &xy[i],
        s: &s,
        tau: &tau,
        is_singular: [i, (i + 1) % n].map(|i| k > 0 && i % k == 0),
    };
    let loops = [(0..n).map(edge).collect()];
    draw(&[Profiles { name: "one", loop_names: &["contour"], loops: &loops }]);
}

#[test]
fn names_along_edges_do_not_overlap_and_stay_on_the_page_with_3_edges_and_with_60() {
    for (n, k) in [(3, 0), (30, 1), (30, 3), (60, 0), (200, 2)] {
        profiles_of(n, 9, k, |profiles| {
            let scene = edges::scene(&Caption { title: "Along edges", units: "mm" }, profiles);
            let mut boxes = Vec::new();
            text_boxes(&scene.shapes, &mut boxes);
            assert!(boxes.iter().filter(|(_, text)| text.starts_with("edge")).count() >= n.min(50));
            for (i, ([left, top, right, bottom], text)) in boxes.iter().enumerate() {
                assert!(*left >= 0.0 && *top >= 0.0 && *right <= scene.width && *bottom <= scene.height, "{n}: {text}");
                for (other, name) in &boxes[..i] {
                    let apart = other[2] <= *left || *right <= other[0] || other[3] <= *top || *bottom <= other[1];
                    assert!(apart, "{n}: \"{text}\" overlaps \"{name}\"");
                }
            }
        });
    }
}

#[test]
fn edges_without_values_or_extent_make_a_picture_without_nan() {
    let edge = |tau: &'static [f64]| EdgeProfile {
        name: "e1",
        length: f64::NAN,
        xy: &[[0.0, 0.0], [f64::NAN, 1e300]],
        s: &[0.0, 1.0],
        tau,
        is_singular: [true, false],
    };
    for loops in [vec![], vec![vec![]], vec![vec![edge(&[f64::NAN, f64::INFINITY])]], vec![vec![edge(&[])]]] {
        let svg = edges_figure(
            &Caption { title: "", units: "" },
            &[Profiles { name: "", loop_names: &["contour"], loops: &loops }],
        );
        assert!(
            svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf\"") && !svg.contains("inf "),
            "{svg}"
        );
    }
}
