//! A scene as SVG text: no date, no name of the program, numbers in fixed decimals, so equal scenes give equal bytes.

use super::colour::Rgb;
use super::scene::{Anchor, Direction, MarkForm, Point, Polyline, Precision, Scene, Shape, Text};
use super::text::{FONT_FAMILY, SCRIPT_SIZE, Style};

/// How far a subscript sinks below the baseline, in em of its line.
const SUBSCRIPT_DROP: f64 = 0.2;
/// How far a superscript stands above the baseline, in em of its line.
const SUPERSCRIPT_RISE: f64 = 0.38;

/// The scene as a complete SVG document.
pub(super) fn render(scene: &Scene) -> String {
    let (width, height) = (number(scene.width), number(scene.height));
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    out.push_str("<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\"");
    out.push_str(&format!(" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n"));
    out.push_str(&format!("<title>{}</title>\n", escaped(&scene.description)));
    out.push_str(&format!("<path d=\"M0 0h{width}v{height}h-{width}z\" fill=\"#ffffff\"/>\n"));
    for shape in &scene.shapes {
        write_shape(&mut out, shape);
    }
    out.push_str("</svg>\n");
    out
}

fn write_shape(out: &mut String, shape: &Shape) {
    match shape {
        Shape::Path { lines, fill, stroke, precision } => {
            let data = path_data(lines, *precision);
            if data.is_empty() {
                return;
            }
            out.push_str("<path d=\"");
            out.push_str(&data);
            match fill {
                Some(colour) => out.push_str(&format!("\" fill=\"{}\" fill-rule=\"evenodd\"", hex(*colour))),
                None => out.push_str("\" fill=\"none\""),
            }
            if let Some(stroke) = stroke {
                out.push_str(&format!(" stroke=\"{}\" stroke-width=\"{}\"", hex(stroke.colour), number(stroke.width)));
                out.push_str(" stroke-linejoin=\"round\"");
                if stroke.opacity < 1.0 {
                    out.push_str(&format!(" stroke-opacity=\"{}\"", number(stroke.opacity)));
                }
            }
            out.push_str("/>\n");
        }
        Shape::Marks { centres, form, size, colour } => {
            if centres.is_empty() {
                return;
            }
            match form {
                MarkForm::Disc => {
                    out.push_str(&format!("<path d=\"{}\" fill=\"none\"", dot_data(centres)));
                    out.push_str(&format!(" stroke=\"{}\" stroke-width=\"{}\"", hex(*colour), number(*size)));
                    out.push_str(" stroke-linecap=\"round\"/>\n");
                }
                MarkForm::Square => {
                    // Not as lines of no length with square caps: some viewers leave part of those out.
                    let square = |c: &Point| Polyline::rectangle(c.map(|v| v - 0.5 * size), [*size; 2]);
                    let data = path_data(&centres.iter().map(square).collect::<Vec<_>>(), Precision::Hundredth);
                    out.push_str(&format!("<path d=\"{data}\" fill=\"{}\"/>\n", hex(*colour)));
                }
            }
        }
        Shape::Text(text) => write_text(out, text),
        Shape::Clipped { id, within, shapes } => {
            let data = path_data(within, Precision::Hundredth);
            out.push_str(&format!("<clipPath id=\"clip{id}\"><path d=\"{data}\" clip-rule=\"evenodd\"/></clipPath>\n"));
            // Squares side by side: smoothing of their sides would show as a net.
            out.push_str(&format!("<g clip-path=\"url(#clip{id})\" shape-rendering=\"crispEdges\">\n"));
            for shape in shapes {
                write_shape(out, shape);
            }
            out.push_str("</g>\n");
        }
        Shape::Group { id, shapes } => {
            out.push_str(&format!("<g id=\"{id}\">\n"));
            for shape in shapes {
                write_shape(out, shape);
            }
            out.push_str("</g>\n");
        }
    }
}

fn write_text(out: &mut String, text: &Text) {
    let (x, y) = (number(text.at[0]), number(text.at[1]));
    out.push_str(&format!(
        "<text x=\"{x}\" y=\"{y}\" font-family=\"{FONT_FAMILY}\" font-size=\"{}\"",
        number(text.size)
    ));
    out.push_str(&format!(" fill=\"{}\"", hex(Rgb::INK)));
    match text.anchor {
        Anchor::Start => {}
        Anchor::Middle => out.push_str(" text-anchor=\"middle\""),
        Anchor::End => out.push_str(" text-anchor=\"end\""),
    }
    if text.direction == Direction::Upwards {
        out.push_str(&format!(" transform=\"rotate(-90 {x} {y})\""));
    }
    out.push('>');
    let mut raised = 0.0; // by how much the baseline now lies above that of the line
    for run in &text.runs {
        let target = match run.style {
            Style::Upright | Style::Italic => 0.0,
            Style::Subscript => -SUBSCRIPT_DROP * text.size,
            Style::Superscript => SUPERSCRIPT_RISE * text.size,
        };
        let mut attributes = String::new();
        if target != raised {
            attributes.push_str(&format!(" dy=\"{}\"", number(raised - target)));
        }
        match run.style {
            Style::Upright => {}
            Style::Italic => attributes.push_str(" font-style=\"italic\""),
            Style::Subscript => {
                let size = number(SCRIPT_SIZE * text.size);
                attributes.push_str(&format!(" font-size=\"{size}\" font-style=\"italic\""));
            }
            Style::Superscript => {
                attributes.push_str(&format!(" font-size=\"{}\"", number(SCRIPT_SIZE * text.size)));
            }
        }
        raised = target;
        if attributes.is_empty() {
            out.push_str(&escaped(&run.text));
        } else {
            out.push_str(&format!("<tspan{attributes}>{}</tspan>", escaped(&run.text)));
        }
    }
    out.push_str("</text>\n");
}

/// `d` of a path: absolute starts, then relative moves between rounded points, so that rounding does not add up.
fn path_data(lines: &[Polyline], precision: Precision) -> String {
    let grid = Grid::new(precision);
    let mut out = String::new();
    for line in lines {
        let mut points = line.points.iter().map(|&p| grid.cell(p));
        let Some(first) = points.next() else { continue };
        let mut at = first;
        let mut moves = String::new();
        for next in points {
            if next == at {
                continue;
            }
            let (dx, dy) = (next[0] - at[0], next[1] - at[1]);
            match (dx, dy) {
                (_, 0) => grid.write(&mut moves, 'h', &[dx]),
                (0, _) => grid.write(&mut moves, 'v', &[dy]),
                _ => grid.write(&mut moves, 'l', &[dx, dy]),
            }
            at = next;
        }
        if moves.is_empty() {
            continue;
        }
        grid.write(&mut out, 'M', &first);
        out.push_str(&moves);
        if line.closed {
            out.push('z');
        }
    }
    out
}

/// `d` of discs: lines of no length, which the round cap of the line makes discs. No other form is as brief.
fn dot_data(centres: &[Point]) -> String {
    let grid = Grid::new(Precision::Hundredth);
    let mut out = String::new();
    for &centre in centres {
        grid.write(&mut out, 'M', &grid.cell(centre));
        out.push_str("h0");
    }
    out
}

/// The fractions of a page unit that coordinates are rounded to.
struct Grid {
    per_unit: i64,
    decimals: usize,
}

impl Grid {
    fn new(precision: Precision) -> Self {
        match precision {
            Precision::Hundredth => Self { per_unit: 100, decimals: 2 },
            Precision::Tenth => Self { per_unit: 10, decimals: 1 },
        }
    }

    fn cell(&self, p: Point) -> [i64; 2] {
        // Shapes far off the page would be a bug; the bound keeps the differences of cells from overflowing even then.
        p.map(|v| (v * self.per_unit as f64).round().clamp(-1e12, 1e12) as i64)
    }

    /// Writes a command and its numbers as briefly as SVG allows.
    fn write(&self, out: &mut String, command: char, cells: &[i64]) {
        out.push(command);
        for (k, &cell) in cells.iter().enumerate() {
            if k > 0 && cell >= 0 {
                out.push(' ');
            }
            if cell < 0 {
                out.push('-');
            }
            let (whole, part) = (cell.abs() / self.per_unit, cell.abs() % self.per_unit);
            if whole > 0 || part == 0 {
                out.push_str(&whole.to_string());
            }
            if part > 0 {
                let digits = format!("{part:0width$}", width = self.decimals);
                out.push('.');
                out.push_str(digits.trim_end_matches('0'));
            }
        }
    }
}

/// A number with at most two decimals.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn hex(colour: Rgb) -> String {
    format!("#{:06x}", colour.0)
}

/// Text for XML: markup escaped, and without the characters that XML 1.0 forbids.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
            c if c.is_control() && c != '\n' && c != '\t' => {}
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::scene::Stroke;
    use super::super::text::Run;
    use super::*;

    #[test]
    fn path_data_is_relative_brief_and_without_drift() {
        let line = Polyline::closed(vec![[0.0, 0.0], [10.0, 0.0], [10.0, 2.5], [9.504, 2.0], [9.5, 2.0]]);
        assert_eq!(path_data(&[line], Precision::Hundredth), "M0 0h10v2.5l-.5-.5z");
        let thirds: Vec<Point> = (0..=300).map(|k| [f64::from(k) / 3.0, f64::from(k % 2)]).collect();
        let data = path_data(&[Polyline::open(thirds)], Precision::Tenth);
        let moves = data.split('l').skip(1);
        let sum: f64 =
            moves.map(|m| m.split([' ', '-']).next().unwrap_or_default().parse::<f64>().unwrap_or(0.0)).sum();
        assert!((sum - 100.0).abs() < 1e-9); // sum of 300 rounded numbers, exact to rounding
    }

    #[test]
    fn a_line_within_one_cell_is_not_written() {
        assert_eq!(path_data(&[Polyline::open(vec![[1.0, 1.0], [1.001, 1.0]])], Precision::Hundredth), "");
        assert_eq!(path_data(&[Polyline::open(vec![])], Precision::Hundredth), "");
    }

    #[test]
    fn numbers_have_no_needless_digits() {
        assert_eq!([1.0, 0.5, -0.001, 12.345].map(number), ["1", "0.5", "0", "12.35"].map(str::to_owned));
    }

    #[test]
    fn text_is_escaped_and_its_baseline_comes_back_after_a_subscript() {
        let runs = vec![Run::new("τ", Style::Italic), Run::new("zx", Style::Subscript), Run::upright(" < a & \u{1}b")];
        let mut out = String::new();
        write_shape(&mut out, &Shape::text([1.0, 2.0], 10.0, Anchor::Middle, runs));
        assert!(out.contains(
            "<tspan dy=\"2\" font-size=\"7.2\" font-style=\"italic\">zx</tspan><tspan dy=\"-2\"> &lt; a &amp; b</tspan>"
        ));
    }

    #[test]
    fn nothing_but_what_was_drawn_is_written() {
        let shapes = vec![
            Shape::lines(vec![], Stroke::new(Rgb::INK, 1.0)),
            Shape::Marks { centres: vec![], form: MarkForm::Disc, size: 1.0, colour: Rgb::INK },
        ];
        let scene = Scene { width: 10.0, height: 10.0, description: String::new(), shapes };
        assert_eq!(render(&scene).matches("<path").count(), 1); // the white page
    }
}
