//! The length of an interval of the parameter by chords, and how far it can be trusted.

use nmt_geom::Point;
use nmt_geom::point::sub;

use crate::Curve;

/// Chords of the finest of the sums that are extrapolated.
pub(crate) const CHORDS: usize = 8;

/// Share of a gain that the next halving of the chords leaves on a smooth curve: 1/4 in the limit.
const SMOOTH: [std::ops::RangeInclusive<f64>; 2] = [0.05..=0.6, 0.15..=0.35];

/// Part of all the bending that a smooth curve has at two neighbouring chord ends, at most: 0.61 beside an inflection.
///
/// A kink or cusp has all of it at the ends of the chord that cuts it off.
const SHARPEST: f64 = 0.75;

/// Factor on the last step of the extrapolation, whose own error is smaller by as much as the step before was larger.
const STEP_SAFETY: f64 = 8.0;

/// Factor on what gains, bends and chords show beside kinks, where they are estimates of the error's magnitude at best.
const SAFETY: f64 = 12.0;

/// How much longer than its neighbour a chord of a smooth curve is at most.
///
/// Much shorter than its neighbours is the chord that cuts off a cusp from side to side.
const UNEVEN: f64 = 8.0;

/// How much more a smooth curve bends at an end of the interval than within it, at most, measured by what two chords
/// are longer than one: less than twice even beside an inflection.
const BEND: f64 = 8.0;

/// A value of the parameter and the point there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(crate) u: f64,
    pub(crate) point: Point,
}

/// Sums of 1, 2, 4 and 8 chords from one parameter to another.
pub(crate) struct ChordSums {
    points: [Point; CHORDS + 1],
    sums: [f64; 4],
}

impl ChordSums {
    pub(crate) fn new(curve: &Curve, from: End, to: End) -> Self {
        let width = to.u - from.u;
        let mut points = [from.point; CHORDS + 1];
        for (k, point) in points.iter_mut().enumerate().take(CHORDS).skip(1) {
            *point = curve.point(from.u + width * k as f64 / CHORDS as f64);
        }
        points[CHORDS] = to.point;
        let sum =
            |stride: usize| -> f64 { (0..CHORDS).step_by(stride).map(|k| chord(points[k], points[k + stride])).sum() };
        Self { points, sums: [8, 4, 2, 1].map(sum) }
    }

    /// The length: the sums extrapolated to infinitely many chords; paper, (3)–(4) \[D2\].
    ///
    /// The chords of a smooth curve are short by a series in the square of their number, so that Romberg's scheme has
    /// order 8. Chords are never longer than the curve, and neither is the result shorter than they are.
    pub(crate) fn length(&self) -> f64 {
        self.extrapolated()[0].max(self.sums[3])
    }

    /// The best extrapolation and the one before it.
    fn extrapolated(&self) -> [f64; 2] {
        let richardson = |coarse: f64, fine: f64, power: f64| fine + (fine - coarse) / (power - 1.0);
        let [one, two, four, eight] = self.sums;
        let [a, b, c] = [richardson(one, two, 4.0), richardson(two, four, 4.0), richardson(four, eight, 4.0)];
        let [d, e] = [richardson(a, b, 16.0), richardson(b, c, 16.0)];
        [richardson(d, e, 64.0), e]
    }

    /// Estimated error of the length.
    ///
    /// On a smooth curve, the last step of the extrapolation (of order 6). The curve is not smooth on the scale of the
    /// chords where halving them does not leave a quarter of the gain, or where nearly all of the bending is in one
    /// place: then that two extrapolations agree is chance, and the gain itself is the estimate. A kink or cusp close
    /// to an end of the interval shows in neither, as no chord ends beyond it; but the chord beyond the end turns away
    /// there, more than any two chords within the interval.
    pub(crate) fn error(&self, curve: &Curve, from: End, to: End) -> f64 {
        let [one, two, four, eight] = self.sums;
        let gains = [two - one, four - two, eight - four];
        let left = [gains[1] / gains[0], gains[2] / gains[1]];
        let [best, before] = self.extrapolated();
        let last_step = (best - before).abs();
        let second_step = (gains[2] + (gains[2] - gains[1]) / 3.0).abs();
        let mut bends = [0.0; CHORDS - 1];
        for (bent, p) in bends.iter_mut().zip(self.points.windows(3)) {
            *bent = bend(p[0], p[1], p[2]);
        }
        let sharpest = bends.windows(2).map(|pair| pair[0] + pair[1]).fold(0.0, f64::max);
        let spread = sharpest <= SHARPEST * bends.iter().sum::<f64>();
        let shown = match (spread, SMOOTH[0].contains(&left[0]) && SMOOTH[1].contains(&left[1])) {
            (true, true) => STEP_SAFETY * last_step,
            (true, false) => STEP_SAFETY * last_step + second_step,
            (false, _) => SAFETY * (eight - one),
        };
        let step = (to.u - from.u) / CHORDS as f64;
        let (low, high) = (curve.point((from.u - step).max(0.0)), curve.point((to.u + step).min(1.0)));
        let at_start = bend(low, from.point, self.points[1]);
        let at_finish = bend(self.points[CHORDS - 1], to.point, high);
        let at_ends = at_start.max(at_finish);
        let at_ends = if at_ends > BEND * bends.into_iter().fold(0.0, f64::max) { at_ends } else { 0.0 };
        shown.max(SAFETY * at_ends.max(self.uneven(low, high)))
    }

    /// The longest chord beside a much shorter one, the chords beyond the ends included; 0 where there is none.
    fn uneven(&self, low: Point, high: Point) -> f64 {
        let chain = [low].into_iter().chain(self.points).chain([high]);
        let mut before: Option<(Point, Option<f64>)> = None;
        let mut longest = 0.0_f64;
        for p in chain {
            let length = before.map(|(q, _)| chord(q, p));
            if let (Some((_, Some(last))), Some(length)) = (before, length)
                && last.min(length) > 0.0
                && last.max(length) > UNEVEN * last.min(length)
            {
                longest = longest.max(last).max(length);
            }
            before = Some((p, length));
        }
        longest
    }
}

/// What the way over `q` is longer than the chord from `p` to `r`.
fn bend(p: Point, q: Point, r: Point) -> f64 {
    chord(p, q) + chord(q, r) - chord(p, r)
}

/// Distance of two points, as `hypot` but without its cost where nothing can overflow.
#[inline]
fn chord(p: Point, q: Point) -> f64 {
    // Between these the square of the larger component loses nothing, and that of the smaller nothing that counts.
    const SAFE: std::ops::Range<f64> = 1e-200..1e200;
    let v = sub(q, p);
    let square = v[0] * v[0] + v[1] * v[1];
    if SAFE.contains(&square) { square.sqrt() } else { v[0].hypot(v[1]) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::samples::graph;

    #[test]
    fn extrapolated_chords_have_order_eight() {
        let off = |sweep: f64| {
            let circle = Curve::Arc { centre: [0.0, 0.0], radius: 1.0, start: 0.3, sweep };
            let [from, to] = [0.0, 1.0].map(|u| End { u, point: circle.point(u) });
            (ChordSums::new(&circle, from, to).length() / sweep - 1.0).abs()
        };
        assert!(off(6.0) / off(3.0) > 200.0, "{} {}", off(6.0), off(3.0)); // 2⁸ = 256 in the limit
        assert!(off(0.5) < 5e-14); // 4e-9 at 3, divided by 6⁸ and rounding of nine chords
    }

    #[test]
    fn a_kink_anywhere_shows() {
        for k in 0..4000 {
            // From end to end of the interval and, on a logarithmic scale, close to its ends.
            let spread = f64::from(k % 2000 + 1) / 2001.0;
            let x = if k < 2000 { 0.25 + 0.5 * spread } else { 0.25 + 1e-6_f64.powf(spread) };
            let kink = graph(&format!("abs(x-{x})"), 0.0, 1.0);
            let [from, to] = [0.25, 0.75].map(|u| End { u, point: kink.point(u) });
            let sums = ChordSums::new(&kink, from, to);
            let off = (sums.length() - 0.5_f64.sqrt()).abs();
            let error = sums.error(&kink, from, to);
            assert!(error >= off || off < 1e-15, "{x}: {error} is not {off}");
        }
    }
}
