//! From values to bands of colour, and the colour bar that tells which is which.

use super::axes::{FRAME_STROKE, TICK_GAP, TICK_LENGTH, TICK_SIZE, centred_baseline};
use super::colour::{Map, Rgb};
use super::is_drawable;
use super::scene::{Anchor, Point, Polyline, Shape};
use super::text::{Run, plain, width};
use super::ticks::{Decimal, LEVEL_STEPS, TICK_STEPS, decade, multiples, power_of_ten, step_at_least, three_digits};

/// Most bands on a scale; between 10 and this many are used, so that their borders are rounded numbers.
const MOST_BANDS: f64 = 24.0;
/// A field whose values differ by less than this share of its magnitude is constant: what differs is rounding.
const CONSTANT_REL: f64 = 1.0e-9;
/// Share of the values below the cap of a scale with peaks.
const CAP_QUANTILE: f64 = 0.995;
/// Peaks are cut off the scale where they would lengthen it by more than this factor.
const CAP_FACTOR: f64 = 1.5;

/// Width of a colour bar.
const BAR_WIDTH: f64 = 15.0;
/// Height of the arrow at an end beyond which there are peaks.
const ARROW_HEIGHT: f64 = 16.0;
/// Between the bar and the baseline of the power of ten above it: that of the panel title.
pub(super) const POWER_GAP: f64 = 11.0;
/// Least distance of ticks on a colour bar.
const BAR_TICK_DISTANCE: f64 = 1.9 * TICK_SIZE;
/// Most intervals between ticks on a long colour bar.
const MOST_BAR_INTERVALS: f64 = 14.0;

/// Which values lie beyond an end of the scale.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Peak {
    /// The farthest of them.
    value: f64,
}

/// A value with the size of what it stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighed {
    pub value: f64,
    pub weight: f64,
}

/// Bands of values, each with its colour.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scale {
    map: Map,
    /// Step between borders; they are its multiples `first..=last`.
    step: Decimal,
    first: i64,
    last: i64,
    below: Option<Peak>,
    above: Option<Peak>,
    /// The value itself, where all values are one.
    constant: Option<f64>,
}

/// A border of the picture: from this level on the colour is this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Band {
    pub from: f64,
    pub colour: Rgb,
}

impl Scale {
    /// For these values, those that cannot be drawn left out; `None` where no value is left. A value counts as zero below
    /// `noise`, rounding of a larger field that this one is a part of.
    pub fn new(values: impl Iterator<Item = f64>, map: Map, noise: f64) -> Option<Self> {
        Self::weighed(values.map(|value| Weighed { value, weight: 1.0 }), map, noise)
    }

    /// [`Self::new`] for values that stand for areas of different size: a peak is what covers little of the picture, however
    /// many nodes it has.
    pub fn weighed(values: impl Iterator<Item = Weighed>, map: Map, noise: f64) -> Option<Self> {
        let mut values: Vec<Weighed> = values.filter(|v| is_drawable(v.value)).collect();
        let first = values.first()?.value;
        let (least, most) = (f64::min as fn(f64, f64) -> f64, f64::max as fn(f64, f64) -> f64);
        let [min, max] = [least, most].map(|end| values.iter().map(|v| v.value).fold(first, end));
        let magnitude = min.abs().max(max.abs());
        if magnitude <= noise || max - min <= CONSTANT_REL * magnitude || max - min < f64::MIN_POSITIVE / CONSTANT_REL {
            let constant = Some(if magnitude <= noise { 0.0 } else { 0.5 * min + 0.5 * max });
            let step = Decimal { digits: 1, exponent: 0 };
            return Some(Self { map, step, first: 0, last: 1, below: None, above: None, constant });
        }
        let (low, high) = match map {
            Map::Sequential => (min, without_peaks(&mut values, min, max)),
            Map::Diverging => {
                values.iter_mut().for_each(|v| v.value = v.value.abs());
                let high = without_peaks(&mut values, 0.0, magnitude);
                (-high, high)
            }
        };
        let step = step_at_least((high / MOST_BANDS - low / MOST_BANDS).abs(), LEVEL_STEPS);
        let size = step.value();
        // A border within rounding of an end is the end.
        let (first, last) = ((low / size + CONSTANT_REL).floor(), (high / size - CONSTANT_REL).ceil());
        let (first, last) = (first as i64, (last as i64).max(first as i64 + 1));
        let above = (max > step.times(last).value() * (1.0 + CONSTANT_REL)).then_some(Peak { value: max });
        let below = (min < step.times(first).value() * (1.0 + CONSTANT_REL) && map == Map::Diverging)
            .then_some(Peak { value: min });
        Some(Self { map, step, first, last, below, above, constant: None })
    }

    /// All bands from the lowest: the first from −∞.
    pub fn bands(&self) -> Vec<Band> {
        if let Some(value) = self.constant {
            let colour = self.map.at(if value == 0.0 && self.map == Map::Sequential { 0.0 } else { 0.5 });
            return vec![Band { from: f64::NEG_INFINITY, colour }];
        }
        let lowest = if self.below.is_some() { self.first - 1 } else { self.first };
        let highest = if self.above.is_some() { self.last } else { self.last - 1 };
        // On a map centred at zero the colours stay symmetrical whichever end has an arrow.
        let (start, end) = match self.map {
            Map::Sequential => (lowest, highest),
            Map::Diverging => {
                let reach = (-lowest).max(highest + 1);
                (-reach, reach - 1)
            }
        };
        let colour = |k: i64| self.map.at((k - start) as f64 / (end - start).max(1) as f64);
        let from = |k: i64| if k == lowest { f64::NEG_INFINITY } else { self.step.times(k).value() };
        (lowest..=highest).map(|k| Band { from: from(k), colour: colour(k) }).collect()
    }

    /// The bands, with one more for what is zero: neither of the colours beside it. Values other than 0 are at least `noise`
    /// in size.
    pub fn bands_about_zero(&self, noise: f64) -> Vec<Band> {
        let mut bands = self.bands();
        let positive = bands.iter().position(|band| band.from == 0.0);
        if let (Map::Diverging, Some(k)) = (self.map, positive.filter(|_| noise > 0.0)) {
            bands[k].from = noise;
            bands.insert(k, Band { from: 0.0, colour: self.map.at(0.5) });
        }
        bands
    }

    /// Values at which ticks stand on a bar of this height, and their labels in units of `10^unit`.
    fn ticks(&self, height: f64, unit: i32) -> Vec<(f64, String)> {
        if let Some(value) = self.constant {
            return vec![(0.5, three_digits(value, unit))];
        }
        let per_step = height / (self.last - self.first) as f64;
        let least = BAR_TICK_DISTANCE.max(height / MOST_BAR_INTERVALS) / per_step * self.step.value();
        // Ticks stand on borders of bands where a rounded step allows it.
        let multiple_of_step = [1, 2, 4, 5, 10, 20].map(|k| self.step.times(k).reduced()).into_iter();
        let step = multiple_of_step
            .filter(|s| s.value() >= least * (1.0 - CONSTANT_REL))
            .find(|s| matches!(s.digits, 1 | 2 | 4 | 5))
            .unwrap_or_else(|| step_at_least(least, TICK_STEPS));
        let (low, high) = (self.step.times(self.first).value(), self.step.times(self.last).value());
        multiples(step, low, high)
            .map(|k| step.times(k))
            .map(|tick| ((tick.value() - low) / (high - low), tick.in_units_of(unit)))
            .collect()
    }

    fn unit(&self) -> i32 {
        let largest = match self.constant {
            Some(value) => value.abs(),
            None => self.step.times(self.last).value().abs().max(self.step.times(self.first).value().abs()),
        };
        let reads_well = largest == 0.0 || (0.01..1.0e4).contains(&largest);
        if reads_well { 0 } else { decade(largest) }
    }

    /// `×10^n` where the labels of the bar are in units of it.
    fn power(&self) -> Option<Vec<Run>> {
        let unit = self.unit();
        (unit != 0).then(|| [vec![Run::upright("×")], power_of_ten(unit)].concat())
    }

    /// Labels of the arrows at the lower and upper end.
    fn peak_labels(&self) -> [Option<String>; 2] {
        let label = |name: &str, peak: Peak| format!("{name} {}", three_digits(peak.value, self.unit()));
        [self.below.map(|p| label("min", p)), self.above.map(|p| label("max", p))]
    }

    /// Width of the bar with all its labels.
    pub fn bar_width(&self, height: f64) -> f64 {
        let ticks = self.ticks(self.bar_height(height), self.unit()).into_iter().map(|(_, label)| label);
        let labels = ticks.chain(self.peak_labels().into_iter().flatten());
        let widest = labels.map(|label| width(&plain(label), TICK_SIZE)).fold(0.0, f64::max);
        let power = self.power().map_or(0.0, |runs| width(&runs, TICK_SIZE));
        (BAR_WIDTH + TICK_LENGTH + TICK_GAP + widest).max(power)
    }

    fn bar_height(&self, height: f64) -> f64 {
        let arrows = f64::from(u8::from(self.above.is_some()) + u8::from(self.below.is_some()));
        height - arrows * ARROW_HEIGHT
    }

    /// The colour bar, arrows included, of this height and with its upper left corner at `origin`.
    pub fn draw_bar(&self, origin: Point, height: f64) -> Shape {
        let [left, upper] = origin;
        let right = left + BAR_WIDTH;
        let middle = 0.5 * (left + right);
        let bar = self.bar_height(height);
        let top = upper + if self.above.is_some() { ARROW_HEIGHT } else { 0.0 };
        let bottom = top + bar;
        let mut outline = vec![[left, bottom]];
        if self.below.is_some() {
            outline.push([middle, bottom + ARROW_HEIGHT]);
        }
        outline.extend([[right, bottom], [right, top]]);
        if self.above.is_some() {
            outline.push([middle, upper]);
        }
        outline.push([left, top]);

        // Each band is painted up to the top and the next over it, so that no seam is seen between them.
        let mut shapes = Vec::new();
        let bands = self.bands();
        let (low, high) = (self.step.times(self.first).value(), self.step.times(self.last).value());
        for (k, band) in bands.iter().enumerate() {
            let y = bottom - (band.from - low) / (high - low) * bar;
            let lines = match (k == 0, y > top + 0.01) {
                (true, _) => Polyline::closed(outline.clone()),
                (false, true) => {
                    let mut area = vec![[left, y], [right, y]];
                    area.extend(outline.iter().skip_while(|p| **p != [right, top]));
                    Polyline::closed(area)
                }
                (false, false) => Polyline::closed(vec![[left, top], [right, top], [middle, upper]]),
            };
            shapes.push(Shape::area(vec![lines], band.colour));
        }
        let mut lines = vec![Polyline::closed(outline)];
        for (at, label) in self.ticks(bar, self.unit()) {
            let y = bottom - at * bar;
            lines.push(Polyline::open(vec![[right, y], [right + TICK_LENGTH, y]]));
            let at = [right + TICK_LENGTH + TICK_GAP, centred_baseline(y, TICK_SIZE)];
            shapes.push(Shape::text(at, TICK_SIZE, Anchor::Start, plain(label)));
        }
        let [min, max] = self.peak_labels();
        for (label, y) in [(max, upper), (min, bottom + ARROW_HEIGHT)] {
            if let Some(label) = label {
                let at = [right + TICK_LENGTH + TICK_GAP, centred_baseline(y, TICK_SIZE)];
                shapes.push(Shape::text(at, TICK_SIZE, Anchor::Start, plain(label)));
            }
        }
        if let Some(power) = self.power() {
            shapes.push(Shape::text([left, upper - POWER_GAP], TICK_SIZE, Anchor::Start, power));
        }
        shapes.push(Shape::lines(lines, FRAME_STROKE));
        Shape::Group { id: "colour-bar", shapes }
    }
}

/// `max`, the largest of at least one value, or the quantile that stands for it where it lies too far above `low` and the
/// others. The values are put in another order.
fn without_peaks(values: &mut [Weighed], low: f64, max: f64) -> f64 {
    values.sort_unstable_by(|a, b| a.value.total_cmp(&b.value));
    let total: f64 = values.iter().map(|v| v.weight).sum();
    let mut above = total;
    let quantile = values.iter().find(|v| {
        above -= v.weight;
        above <= (1.0 - CAP_QUANTILE) * total * (1.0 + CONSTANT_REL)
    });
    let quantile = quantile.map_or(max, |v| v.value);
    let has_peaks = max - low > CAP_FACTOR * (quantile - low) && quantile > low;
    if has_peaks { quantile } else { max }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(values: &[f64], map: Map) -> Scale {
        Scale::new(values.iter().copied(), map, 0.0).unwrap()
    }

    #[test]
    fn a_peak_is_what_covers_little_however_many_nodes_it_has() {
        // Half of the nodes in a hundredth of a thousandth of the area.
        let values = |weight: f64| {
            (0..200).map(move |k| Weighed { value: f64::from(k), weight: if k < 100 { 1.0 } else { weight } })
        };
        let of = |weight: f64| Scale::weighed(values(weight), Map::Sequential, 0.0).unwrap();
        assert_eq!(of(1.0).above, None);
        assert_eq!(of(1e-5).above, Some(Peak { value: 199.0 }));
        assert!(of(1e-5).step.times(of(1e-5).last).value() < 110.0);
    }

    #[test]
    fn bands_are_ten_to_twenty_four_rounded_and_cover_the_values() {
        for max in [0.147, 1.0, 0.675, 3.3e-7, 9.99e8, 2.4, 2.41] {
            let s = scale(&[0.0, 0.3 * max, max], Map::Sequential);
            let bands = s.bands();
            assert!((10..=25).contains(&bands.len()), "{max}: {}", bands.len());
            assert!(s.step.times(s.last).value() >= max * (1.0 - 1e-9)); // CONSTANT_REL
            assert!(bands.windows(2).all(|w| w[0].from < w[1].from));
            assert_eq!(bands[0].colour, Map::Sequential.at(0.0));
        }
    }

    #[test]
    fn a_signed_field_is_centred_at_zero() {
        let s = scale(&[-0.1, 0.0, 0.63], Map::Diverging);
        assert_eq!(s.first, -s.last);
        let zero = s.bands().into_iter().position(|b| b.from == 0.0).unwrap();
        assert_eq!(zero * 2, s.bands().len());
    }

    #[test]
    fn one_peak_does_not_eat_the_scale() {
        let mut values: Vec<f64> = (0..1000).map(|k| f64::from(k) / 1000.0).collect();
        values.push(50.0);
        let s = scale(&values, Map::Sequential);
        assert_eq!(s.above, Some(Peak { value: 50.0 }));
        assert!(s.step.times(s.last).value() <= 1.1);
        assert_eq!(s.peak_labels(), [None, Some("max 50.0".to_owned())]);
        values.push(-70.0);
        let s = scale(&values, Map::Diverging);
        assert!(s.above.is_some() && s.below.is_some());
        values.truncate(1000);
        assert_eq!(scale(&values, Map::Sequential).above, None);
    }

    #[test]
    fn constant_zero_and_absent_fields_have_a_scale_or_none() {
        assert_eq!(scale(&[0.0, 0.0], Map::Sequential).bands().len(), 1);
        assert_eq!(scale(&[3.7, 3.7], Map::Diverging).ticks(100.0, 0), [(0.5, "3.70".to_owned())]);
        assert_eq!(Scale::new([f64::NAN, f64::INFINITY].into_iter(), Map::Sequential, 0.0), None);
        assert_eq!(Scale::new([1e-17, -1e-17].into_iter(), Map::Diverging, 1e-9).unwrap().constant, Some(0.0));
        for extreme in [1e290, 1e-290, 1e-320] {
            let _ = scale(&[-extreme, extreme], Map::Diverging).draw_bar([0.0; 2], 100.0);
            let _ = scale(&[-extreme, extreme], Map::Sequential).draw_bar([0.0; 2], 100.0);
        }
    }

    #[test]
    fn ticks_of_the_bar_do_not_overlap() {
        for max in [0.147, 1.0, 0.675, 3.3e-7, 7.0, 2.4, 55.0] {
            for map in [Map::Sequential, Map::Diverging] {
                for height in [112.0, 330.0, 900.0] {
                    let ticks = scale(&[0.0, max], map).ticks(height, 0);
                    assert!(ticks.len() >= 2, "{max} {height}");
                    assert!(ticks.windows(2).all(|w| (w[1].0 - w[0].0) * height > 1.5 * TICK_SIZE));
                }
            }
        }
    }
}
