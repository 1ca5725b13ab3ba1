//! Rounded numbers for scales, and how they are written. Multiples of a step are kept as decimal integers, so that a label
//! is exact: 0.3, never 0.30000000000000004.

use super::text::{Run, Style};

/// `digits · 10^exponent`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Decimal {
    pub digits: i128,
    pub exponent: i32,
}

/// Mantissas of the steps between ticks.
pub(super) const TICK_STEPS: &[Decimal] = &[decimal(1, 0), decimal(2, 0), decimal(5, 0), decimal(1, 1)];

/// Mantissas of the steps between contour levels: closer than those of ticks, so that their number varies less.
pub(super) const LEVEL_STEPS: &[Decimal] =
    &[decimal(1, 0), decimal(2, 0), decimal(25, -1), decimal(5, 0), decimal(1, 1)];

/// Share of a step by which a multiple may lie outside its interval and still count as its end: rounding, not position.
const STEP_SLACK: f64 = 1.0e-6;

/// More multiples than this fit no picture.
const MOST_MULTIPLES: f64 = 10_000.0;

const fn decimal(digits: i128, exponent: i32) -> Decimal {
    Decimal { digits, exponent }
}

impl Decimal {
    /// The nearest number, rounded once where `exponent` allows it.
    pub fn value(self) -> f64 {
        let digits = self.digits as f64;
        match self.exponent {
            e if e < -300 => digits / 1e300 / 10f64.powi(-300 - e),
            e if e < 0 => digits / 10f64.powi(-e),
            e => digits * 10f64.powi(e),
        }
    }

    /// `k` times this.
    pub fn times(self, k: i64) -> Self {
        decimal(self.digits.saturating_mul(i128::from(k)), self.exponent)
    }

    /// This minus a number whose exponent is not smaller.
    fn minus(self, coarser: Self) -> Self {
        let shift = u32::try_from(coarser.exponent - self.exponent).unwrap_or(0).min(30);
        let same_exponent = coarser.digits.saturating_mul(10i128.pow(shift));
        decimal(self.digits.saturating_sub(same_exponent), self.exponent)
    }

    /// In units of `10^unit`, with as many decimals as the exponent says: multiples of one step line up.
    pub fn in_units_of(self, unit: i32) -> String {
        if self.digits == 0 {
            return "0".to_owned();
        }
        let sign = if self.digits < 0 { "−" } else { "" };
        let digits = self.digits.unsigned_abs().to_string();
        let exponent = self.exponent - unit;
        if exponent >= 0 {
            return format!("{sign}{digits}{}", "0".repeat(exponent as usize));
        }
        let decimals = exponent.unsigned_abs() as usize;
        let padded = format!("{digits:0>width$}", width = decimals + 1);
        let (whole, part) = padded.split_at(padded.len() - decimals);
        format!("{sign}{whole}.{part}")
    }

    /// The same number without trailing zeros in its digits.
    pub fn reduced(mut self) -> Self {
        while self.digits != 0 && self.digits % 10 == 0 {
            self.digits /= 10;
            self.exponent += 1;
        }
        self
    }
}

/// Exponent of the power of ten at or below `value > 0`.
pub(super) fn decade(value: f64) -> i32 {
    let e = value.log10().floor() as i32;
    // The logarithm may be wrong in its last digit, which matters where it is a whole number.
    match () {
        () if decimal(1, e + 1).value() <= value => e + 1,
        () if decimal(1, e).value() > value => e - 1,
        () => e,
    }
}

/// Smallest of `mantissas · 10^n` that is at least `least > 0`.
pub(super) fn step_at_least(least: f64, mantissas: &[Decimal]) -> Decimal {
    let e = decade(least);
    let steps = mantissas.iter().map(|m| decimal(m.digits, m.exponent + e));
    let enough = |step: &Decimal| step.value() >= least * (1.0 - STEP_SLACK);
    steps.clone().find(enough).unwrap_or(decimal(1, e + 1)).reduced()
}

/// Whole numbers `k` with `low ≤ k·step ≤ high`, ends included; none where there would be more than a picture holds.
pub(super) fn multiples(step: Decimal, low: f64, high: f64) -> std::ops::RangeInclusive<i64> {
    let size = step.value();
    let (first, last) = ((low / size - STEP_SLACK).ceil(), (high / size + STEP_SLACK).floor());
    // Above 2^53 the multiples of a step are no longer told apart. NaN falls through to "none".
    if first.abs() < 9e15 && last.abs() < 9e15 && last - first < MOST_MULTIPLES {
        first as i64..=last as i64
    } else {
        std::ops::RangeInclusive::new(1, 0)
    }
}

/// Power of ten, a multiple of three as those of length units are, in which numbers up to `largest` are written; 0 where they read well as they are.
pub(super) fn unit_exponent(largest: f64) -> i32 {
    let reads_well = largest == 0.0 || (0.01..1.0e5).contains(&largest);
    if reads_well { 0 } else { decade(largest).div_euclid(3) * 3 }
}

/// A whole number with a true minus sign.
pub(super) fn signed(number: i32) -> String {
    number.to_string().replace('-', "−")
}

/// `10^exponent` with the exponent raised.
pub(super) fn power_of_ten(exponent: i32) -> Vec<Run> {
    vec![Run::upright("10"), Run::new(signed(exponent), Style::Superscript)]
}

/// `value` in units of `10^unit`, to three digits.
pub(super) fn three_digits(value: f64, unit: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let last = decade(value.abs()) - 2;
    let digits = (value / decimal(1, last).value()).round();
    decimal(digits as i128, last).in_units_of(unit)
}

/// Ticks along an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    /// Positions on the axis.
    pub at: Vec<f64>,
    /// What stands at them: position minus `offset`, in units of the axis.
    pub labels: Vec<String>,
    /// Subtracted from all positions where they differ only in late digits.
    pub offset: Option<Decimal>,
}

/// Positions whose magnitude is more than this many times the length of the axis are written relative to an offset:
/// with three digits of their own, labels would otherwise have seven or more.
const OFFSET_RATIO: f64 = 1.0e4;

impl Ticks {
    /// Multiples of `step` on `[low, high]`, written in units of `10^unit`.
    pub fn new(step: Decimal, low: f64, high: f64, unit: i32) -> Self {
        let offset = (low.abs().max(high.abs()) > OFFSET_RATIO * (high - low)).then(|| {
            let coarse = decimal(1, decade(high - low) + 1);
            coarse.times(((0.5 * low + 0.5 * high) / coarse.value()).round() as i64).reduced()
        });
        let exact: Vec<Decimal> = multiples(step, low, high).map(|k| step.times(k)).collect();
        let label = |tick: &Decimal| offset.map_or(*tick, |o| tick.minus(o)).in_units_of(unit);
        Self { at: exact.iter().map(|t| t.value()).collect(), labels: exact.iter().map(label).collect(), offset }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_one_two_five() {
        let step = |least: f64| step_at_least(least, TICK_STEPS).value();
        assert_eq!(
            [0.7, 1.0, 1.1, 2.0, 2.1, 5.1, 0.03, 1000.0, 1e-6].map(step),
            [1.0, 1.0, 2.0, 2.0, 5.0, 10.0, 0.05, 1000.0, 1e-6]
        );
        assert_eq!(step_at_least(2.1, LEVEL_STEPS).value(), 2.5);
    }

    #[test]
    fn labels_are_exact_and_have_equal_decimals() {
        let ticks = Ticks::new(step_at_least(0.09, TICK_STEPS), -0.2, 0.3, 0);
        assert_eq!(ticks.labels, ["−0.2", "−0.1", "0", "0.1", "0.2", "0.3"]);
        assert_eq!(ticks.at[5], 0.3);
        assert_eq!(Ticks::new(step_at_least(250.0, TICK_STEPS), 0.0, 1000.0, 0).labels, ["0", "500", "1000"]);
    }

    #[test]
    fn tiny_and_huge_axes_have_an_exponent_and_the_same_labels() {
        for size in [1e-6, 1.0, 1e6] {
            let unit = unit_exponent(size);
            let ticks = Ticks::new(step_at_least(0.45 * size, TICK_STEPS), 0.0, size, unit);
            assert_eq!(ticks.labels, ["0", "0.5", "1.0"], "size {size}");
        }
        assert_eq!([1e-6, 0.5, 9e4, 1e6, 2e7, 0.009].map(unit_exponent), [-6, 0, 0, 6, 6, -3]);
    }

    #[test]
    fn far_from_the_origin_labels_are_relative_to_an_offset() {
        let ticks = Ticks::new(step_at_least(0.4, TICK_STEPS), 2_000_003.0, 2_000_004.0, 0);
        assert_eq!(ticks.offset.map(Decimal::value), Some(2e6));
        assert_eq!(ticks.labels, ["3.0", "3.5", "4.0"]);
        let ticks = Ticks::new(step_at_least(0.4, TICK_STEPS), -2_000_004.0, -2_000_003.0, 0);
        assert_eq!(ticks.offset.map(Decimal::value), Some(-2_000_000.0));
        assert_eq!(ticks.labels, ["−4.0", "−3.5", "−3.0"]);
    }

    #[test]
    fn powers_of_ten_are_their_own_decade() {
        for e in -280..=280 {
            assert_eq!(decade(decimal(1, e).value()), e);
        }
    }

    #[test]
    fn three_digits_are_three_digits() {
        assert_eq!(three_digits(12.345, 0), "12.3");
        assert_eq!(three_digits(-0.00123456, -3), "−1.23");
        assert_eq!(three_digits(123_456.0, 3), "123");
        assert_eq!(three_digits(0.0, 0), "0");
    }

    #[test]
    fn nothing_overflows() {
        assert_eq!(multiples(decimal(1, -300), 0.0, 1e290).count(), 0);
        assert_eq!(multiples(decimal(1, 0), f64::NAN, 1.0).count(), 0);
        assert_eq!(decimal(7, -310).value(), 7e-310);
    }
}
