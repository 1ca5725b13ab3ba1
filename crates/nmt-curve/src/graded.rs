//! Equal parts of ∫ds/h: nodes along an edge whose spacing varies.

use crate::CurveError;

/// Steps of the table are at most this fraction of the spacing at their ends and middle.
///
/// The density 1/h is taken as linear in each: where h grows by 0.5 a unit of length, the most a grading may have, the
/// number of segments is then right to 3e-3, at 0.3 to 1e-3.
const STEP: f64 = 0.25;

/// Steps of the table, at most: a million nodes on one edge.
const MOST_STEPS: usize = 1 << 22;

/// Halvings of the edge, at most: a spacing of 1e-12 of it.
const MOST_HALVINGS: u32 = 40;

/// How many spacings an edge is long, and where equal parts of that number end.
///
/// The spacing h(s) must be positive and change gradually, by less than the distance: between the places that are looked at
/// it is taken as known.
///
/// ```
/// # use nmt_curve::SpacingTable;
/// // Twice as dense at the beginning as at the end: ∫ds/(1 + s) = ln 2 from 0 to 1.
/// let table = SpacingTable::new(1.0, |s| Ok::<_, nmt_curve::CurveError>(0.01 * (1.0 + s)))?;
/// assert!((table.spacings() - 100.0 * 2f64.ln()).abs() < 1e-3);
/// let fractions = table.equal_parts(2);
/// assert!((fractions[1] - (2f64.sqrt() - 1.0)).abs() < 1e-5);
/// # Ok::<(), nmt_curve::CurveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SpacingTable {
    length: f64,
    places: Vec<f64>,    // arc lengths, ascending from 0 to the length
    densities: Vec<f64>, // 1/h there
    spacings: Vec<f64>,  // ∫ds/h up to there
}

impl SpacingTable {
    /// The table of an edge of `length`, whose spacing at arc length s from its first vertex is `spacing(s)`, both in the
    /// user's unit.
    ///
    /// The edge and the same one backwards have the same table, backwards, to rounding.
    ///
    /// # Errors
    /// [`CurveError::NodeCount`] where the edge would have more than about a million nodes, and those of `spacing`.
    pub fn new<E: From<CurveError>>(length: f64, mut spacing: impl FnMut(f64) -> Result<f64, E>) -> Result<Self, E> {
        let [first, last] = [spacing(0.0)?, spacing(length)?];
        let mut table = Self { length, places: vec![0.0], densities: vec![1.0 / first], spacings: Vec::new() };
        table.add([0.0, 1.0], [first, last], MOST_HALVINGS, &mut spacing)?;
        table.spacings = Vec::with_capacity(table.places.len());
        let mut sum = 0.0;
        table.spacings.push(sum);
        for k in 1..table.places.len() {
            let step = table.places[k] - table.places[k - 1];
            sum += 0.5 * step * (table.densities[k - 1] + table.densities[k]);
            table.spacings.push(sum);
        }
        Ok(table)
    }

    /// Adds the places of the stretch between two fractions of the length, without its first: by halving, so that the
    /// places are those of the edge backwards too.
    fn add<E: From<CurveError>>(
        &mut self,
        [from, to]: [f64; 2],
        [first, last]: [f64; 2],
        halvings: u32,
        spacing: &mut impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<(), E> {
        let middle = 0.5 * (from + to);
        let between = spacing(self.length * middle)?;
        let finest = first.min(last).min(between);
        if halvings == 0 || self.length * (to - from) <= 2.0 * STEP * finest {
            for (place, h) in [(middle, between), (to, last)] {
                self.places.push(self.length * place);
                self.densities.push(1.0 / h);
            }
            if self.places.len() > MOST_STEPS {
                let n = (self.length / (finest * STEP)) as usize;
                return Err(CurveError::NodeCount { n, least: 2, most: (MOST_STEPS as f64 * STEP) as usize }.into());
            }
            return Ok(());
        }
        self.add([from, middle], [first, between], halvings - 1, spacing)?;
        self.add([middle, to], [between, last], halvings - 1, spacing)
    }

    /// ∫ds/h: how many spacings the edge is long.
    pub fn spacings(&self) -> f64 {
        self.spacings.last().copied().unwrap_or(0.0)
    }

    /// The ends of `n` parts of equal ∫ds/h, as fractions of the length: n + 1 of them, from 0 to 1.
    pub fn equal_parts(&self, n: usize) -> Vec<f64> {
        let mut fractions = Vec::with_capacity(n + 1);
        fractions.push(0.0);
        let mut step = 0;
        for k in 1..n {
            let target = self.spacings() * (k as f64 / n as f64);
            while step + 2 < self.spacings.len() && self.spacings[step + 1] <= target {
                step += 1;
            }
            let (from, to) = (self.places[step], self.places[step + 1]);
            let (first, last) = (self.densities[step], self.densities[step + 1]);
            // The root of first·x + (last − first)·x²/(2·width) = left, written so that nothing cancels.
            let (left, slope) = (target - self.spacings[step], (last - first) / (to - from));
            let x = 2.0 * left / (first + (first * first + 2.0 * slope * left).max(0.0).sqrt());
            fractions.push((from + x.clamp(0.0, to - from)) / self.length);
        }
        fractions.push(1.0);
        fractions
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(length: f64, h: impl Fn(f64) -> f64) -> SpacingTable {
        SpacingTable::new(length, |s| Ok::<_, CurveError>(h(s))).unwrap()
    }

    #[test]
    fn an_even_spacing_makes_equal_segments() {
        let fractions = table(2.0, |_| 0.1).equal_parts(20);
        assert!(fractions.iter().enumerate().all(|(k, t)| (t - k as f64 / 20.0).abs() < 1e-15)); // rounding
    }

    #[test]
    fn segments_follow_the_spacing_from_a_point() {
        let h = |s: f64| 0.001 + 0.3 * (s - 0.25).abs();
        let table = table(1.0, h);
        // ∫ds/(a + g·s) = ln(1 + g·s/a)/g to either side.
        let exact = [0.25, 0.75].map(|s: f64| (1.0 + 0.3 * s / 0.001).ln() / 0.3).iter().sum::<f64>();
        assert!((table.spacings() / exact - 1.0).abs() < 1e-3); // as the step promises
        let n = table.spacings().ceil() as usize;
        for pair in table.equal_parts(n).windows(2) {
            let asked = h(0.5 * (pair[0] + pair[1]));
            let ratio = (pair[1] - pair[0]) / asked;
            assert!((0.8..1.1).contains(&ratio), "{ratio} at {}", pair[0]);
        }
    }

    #[test]
    fn an_edge_backwards_has_the_same_nodes() {
        let h = |s: f64| 0.003 + 0.2 * (s - 0.4).abs();
        let (there, back) = (table(1.0, h), table(1.0, |s| h(1.0 - s)));
        let n = 37;
        let (there, back) = (there.equal_parts(n), back.equal_parts(n));
        assert!((0..=n).all(|k| (there[k] + back[n - k] - 1.0).abs() < 1e-13)); // rounding
    }

    #[test]
    fn too_many_nodes_are_an_error() {
        let error = SpacingTable::new(1.0, |_| Ok::<_, CurveError>(1e-9)).unwrap_err();
        assert!(matches!(error, CurveError::NodeCount { .. }));
    }
}
