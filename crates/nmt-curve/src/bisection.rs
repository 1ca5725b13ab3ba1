//! Bracketed root of a monotone function.

/// Steps allowed; bisection alone takes 60 to the last bit \[D3\].
const MAX_STEPS: usize = 100;

/// A root between two values, with what is left there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Root {
    /// The best value found.
    pub(crate) at: f64,
    /// The function there.
    pub(crate) residual: f64,
    /// Evaluations used.
    pub(crate) steps: usize,
}

/// A value and the function there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) at: f64,
    pub(crate) value: f64,
}

/// Where the rising `f` is 0 between `low` (not above 0) and `high` (not below 0), to a residual of `tolerance`.
///
/// Each step takes the zero of the inverse parabola through the bracket and the end it replaced last (or of the
/// secant), and halves the bracket instead where two steps have brought neither the bracket nor the residual down:
/// three evaluations on a nearly straight function, twice as many as bisection on the worst. It stops at the resolution
/// of the floats, so that a function with a step gives the place of the step.
pub(crate) fn monotone_root(f: impl Fn(f64) -> f64, low: Sample, high: Sample, tolerance: f64) -> Root {
    /// What two steps must leave at most of the width, or of the residual, not to be called slow.
    const WIDTH_LEFT: f64 = 0.5;
    const RESIDUAL_LEFT: f64 = 0.1;
    let nearer = |a: Sample, b: Sample| if a.value.abs() <= b.value.abs() { a } else { b };
    let (mut low, mut high) = (low, high);
    let mut replaced = None;
    let (mut width_before, mut residual_before) = (high.at - low.at, f64::INFINITY);
    let mut steps = 0;
    while steps < MAX_STEPS && nearer(low, high).value.abs() > tolerance {
        let (width, residual) = (high.at - low.at, nearer(low, high).value.abs());
        let mut slow = false;
        if steps > 0 && steps % 2 == 0 {
            slow = width > WIDTH_LEFT * width_before && residual > RESIDUAL_LEFT * residual_before;
            (width_before, residual_before) = (width, residual);
        }
        let guess = interpolated(low, high, replaced);
        let at = if !slow && guess > low.at && guess < high.at { guess } else { 0.5 * (low.at + high.at) };
        if !(low.at < at && at < high.at) {
            break;
        }
        let sample = Sample { at, value: f(at) };
        steps += 1;
        let end = if sample.value <= 0.0 { &mut low } else { &mut high };
        replaced = Some(std::mem::replace(end, sample));
    }
    let best = nearer(low, high);
    Root { at: best.at, residual: best.value, steps }
}

/// The zero of the secant, or of the inverse parabola where a third sample with a value of its own is given.
fn interpolated(low: Sample, high: Sample, third: Option<Sample>) -> f64 {
    let secant = low.at - low.value * ((high.at - low.at) / (high.value - low.value));
    let Some(third) = third else { return secant };
    let term = |a: Sample, b: Sample, c: Sample| {
        (a.at - low.at) * (b.value / (b.value - a.value)) * (c.value / (c.value - a.value))
    };
    let parabola = low.at + term(high, low, third) + term(third, low, high);
    if parabola.is_finite() { parabola } else { secant }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(f: impl Fn(f64) -> f64, low: f64, high: f64, tolerance: f64) -> Root {
        let [low, high] = [low, high].map(|at| Sample { at, value: f(at) });
        monotone_root(f, low, high, tolerance)
    }

    #[test]
    fn smooth_functions_take_a_few_steps() {
        let found = root(|x| x.sinh() - 1.0, 0.0, 2.0, 1e-14);
        assert!((found.at - 1.0_f64.asinh()).abs() < 1e-14); // the tolerance, slope above 1
        assert!(found.steps <= 8 && found.residual.abs() <= 1e-14, "{found:?}");
    }

    #[test]
    fn difficult_functions_take_at_most_a_hundred() {
        let functions: [fn(f64) -> f64; 5] = [
            |x| x.powi(21) - 1e-21,
            |x| x.cbrt() - 0.9999,
            |x| x.sqrt() - 1e-6,
            |x| (1e8 * (x - 0.3)).tanh(),
            |x| (x - 0.123_456).powi(3),
        ];
        for (k, f) in functions.into_iter().enumerate() {
            let found = root(f, 0.0, 1.0, 1e-13);
            assert!(found.steps < MAX_STEPS && found.residual.abs() <= 1e-13, "{k}: {found:?}");
        }
    }

    #[test]
    fn a_step_is_found_to_the_last_bit() {
        let found = root(|x| if x < 0.3 { -1.0 } else { 1.0 }, 0.0, 1.0, 1e-3);
        assert!((found.at - 0.3).abs() <= f64::EPSILON && found.steps < MAX_STEPS, "{found:?}");
    }

    #[test]
    fn a_root_at_an_end_costs_nothing() {
        assert_eq!(root(|x| x, 0.0, 1.0, 0.0), Root { at: 0.0, residual: 0.0, steps: 0 });
        assert_eq!(root(|x| x - 1.0, 0.0, 1.0, 0.0).at, 1.0);
    }

    #[test]
    fn undefined_values_end_the_search() {
        assert!(root(|_| f64::NAN, 0.0, 1.0, 0.0).residual.is_nan());
    }
}
