//! Lines thinned to what the eye sees (Douglas and Peucker, 1973): a point is dropped where that moves the line by less than
//! a tolerance.

use super::scene::Point;

/// Distance from `p` to the segment from `a` to `b`, squared.
fn distance_squared(p: Point, a: Point, b: Point) -> f64 {
    let (ab, ap) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length_squared = ab[0] * ab[0] + ab[1] * ab[1];
    let t = if length_squared > 0.0 { ((ap[0] * ab[0] + ap[1] * ab[1]) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    let d = [ap[0] - t * ab[0], ap[1] - t * ab[1]];
    d[0] * d[0] + d[1] * d[1]
}

/// The open line through a part of `points`, its ends kept.
pub(super) fn open(points: &[Point], tolerance: f64) -> Vec<Point> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[points.len() - 1] = true;
    let mut spans = vec![(0, points.len() - 1)];
    while let Some((first, last)) = spans.pop() {
        let mut worst = (tolerance * tolerance, first);
        for k in first + 1..last {
            let d = distance_squared(points[k], points[first], points[last]);
            if d > worst.0 {
                worst = (d, k);
            }
        }
        if worst.1 != first {
            keep[worst.1] = true;
            spans.push((first, worst.1));
            spans.push((worst.1, last));
        }
    }
    points.iter().zip(keep).filter_map(|(&p, kept)| kept.then_some(p)).collect()
}

/// The closed line through a part of `points` (the first not repeated at the end); fewer than three where nothing is left.
pub(super) fn closed(points: &[Point], tolerance: f64) -> Vec<Point> {
    let Some(&start) = points.first() else { return Vec::new() };
    let far = (1..points.len()).fold(0, |best, k| {
        if distance_squared(points[k], start, start) > distance_squared(points[best], start, start) { k } else { best }
    });
    let mut line = open(&points[..=far], tolerance);
    let mut back = points[far..].to_vec();
    back.push(start);
    let back = open(&back, tolerance);
    line.extend_from_slice(&back[1..back.len() - 1]);
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collinear_points_go_and_corners_stay() {
        let line: Vec<Point> =
            (0..=10).map(|k| [f64::from(k), 0.0]).chain((1..=5).map(|k| [10.0, f64::from(k)])).collect();
        assert_eq!(open(&line, 0.01), [[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]]);
    }

    #[test]
    fn a_circle_keeps_its_shape_within_the_tolerance() {
        let circle: Vec<Point> = (0..2000)
            .map(|k| f64::from(k) * std::f64::consts::TAU / 2000.0)
            .map(|a| [100.0 * a.cos(), 100.0 * a.sin()])
            .collect();
        let thin = closed(&circle, 0.1);
        assert!(thin.len() > 40 && thin.len() < 140, "{}", thin.len());
        for p in &circle {
            let nearest = (0..thin.len())
                .map(|i| distance_squared(*p, thin[i], thin[(i + 1) % thin.len()]))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest.sqrt() <= 0.1 + 1e-12); // the tolerance, and rounding
        }
    }

    #[test]
    fn short_lines_survive() {
        assert!(closed(&[], 0.1).is_empty());
        assert_eq!(closed(&[[1.0, 1.0]], 0.1), [[1.0, 1.0]]);
        assert_eq!(closed(&[[1.0, 1.0], [1.0, 1.0]], 0.1).len(), 1);
        assert_eq!(open(&[[1.0, 1.0]], 0.1).len(), 1);
    }
}
