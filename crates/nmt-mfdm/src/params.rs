//! How a boundary value problem is made equations: formulation, order, stars, trial and test functions.

use crate::basis::{MAX_ORDER, n_monomials};
use crate::error::MfdmError;
use crate::gauss::Rule;
use crate::problem::{Formulation, Test, Trial};
use crate::repair::{EVEN, EVEN_WHERE_HELD};
use crate::solver::Solver;
use crate::star::{StarChoice, default_star};
use crate::stencils::StarParams;
use crate::surroundings::Metric;
use nmt_cloud::Cloud;

/// How a problem is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveParams {
    /// Variational by default.
    pub formulation: Formulation,
    /// p, the order of the MWLS polynomials: 2, the default, to 4, and 1 in the variational formulation. Finite elements
    /// are linear whatever it is.
    pub order: usize,
    /// Nodes in a star, the centre included; at least the number of monomials. By default 6, 9, 20, 30 for order 1 to 4, and
    /// up to four times as many where the spacings are in a ratio above 2.
    pub star: Option<usize>,
    /// How they are chosen; by default as [`Self::star_choice`] has it.
    pub stars: Option<StarChoice>,
    /// g of the weight, 0 to 1; 0, the default, interpolates.
    pub smoothing: f64,
    /// Trial functions of the variational formulation.
    pub trial: Trial,
    /// Test functions of the variational formulation.
    pub test: Test,
    /// Gauss points a triangle in the variational formulation; by default 3 for p ≤ 2, 6 for p = 3, 12 for p = 4.
    pub gauss: Option<usize>,
    /// Linear solver; [`Solver::Auto`] by default.
    pub solver: Solver,
}

impl Default for SolveParams {
    fn default() -> Self {
        Self {
            formulation: Formulation::Variational,
            order: 2,
            star: None,
            stars: None,
            smoothing: 0.0,
            trial: Trial::Blended,
            test: Test::Hat,
            gauss: None,
            solver: Solver::Auto,
        }
    }
}

/// Gauss points by order, unless chosen.
pub fn default_gauss(order: usize) -> usize {
    match order {
        0..=2 => 3,
        3 => 6,
        _ => 12,
    }
}

impl SolveParams {
    /// The order of the equations' polynomials: of finite elements 1.
    pub fn order_used(&self) -> usize {
        if self.formulation == Formulation::Fem { 1 } else { self.order }
    }

    /// The order that results are recovered with \[D14\].
    pub fn recovery_order(&self) -> usize {
        (self.order + 1).min(MAX_ORDER)
    }

    /// # Errors
    /// [`MfdmError`] where a value is out of range.
    pub(crate) fn check(&self) -> Result<(), MfdmError> {
        let least = if self.formulation == Formulation::Variational { 1 } else { 2 };
        if self.formulation != Formulation::Fem && !(least..=MAX_ORDER).contains(&self.order) {
            return Err(MfdmError::Order { order: self.order, formulation: self.formulation.name(), least });
        }
        if !(0.0..=1.0).contains(&self.smoothing) {
            return Err(MfdmError::Smoothing { g: self.smoothing });
        }
        self.rule().map(|_| ())
    }

    /// The Gauss rule of the weak forms.
    ///
    /// # Errors
    /// [`MfdmError::Gauss`] where there is none of so many points.
    pub(crate) fn rule(&self) -> Result<Rule, MfdmError> {
        let points = self.gauss.unwrap_or(default_gauss(self.order_used()));
        Rule::of(points).ok_or(MfdmError::Gauss { points })
    }

    /// How stars are chosen on `cloud` where nothing is said: the nearest nodes on uniform clouds. On graded ones they lie on one
    /// side where levels meet, and do not cancel what is odd in second derivatives: there `Balanced` at the order 2, and at the
    /// order 4 of the local equations. Odd orders have nothing to lose, and the weak form of order 4 hardly anything \[D17\].
    pub fn star_choice(&self, cloud: &Cloud) -> StarChoice {
        let gains = self.order == 2 || (self.order == 4 && self.formulation == Formulation::Local);
        let by_default = if cloud.is_graded() && gains { StarChoice::Balanced } else { StarChoice::Nearest };
        self.stars.unwrap_or(by_default)
    }

    /// The stars of the equations on `cloud`.
    ///
    /// # Errors
    /// [`MfdmError::StarSize`] where the size asked for is too small for the order, or larger than the cloud.
    pub(crate) fn star_params(&self, cloud: &Cloud, metric: &Metric) -> Result<StarParams, MfdmError> {
        let (order, least, n_nodes) = (self.order, n_monomials(self.order), cloud.n_nodes());
        let size = match self.star {
            Some(star) if star < least || star > n_nodes => {
                return Err(MfdmError::StarSize { star, order, least, n_nodes });
            }
            Some(star) => star,
            None => metric.star_size(default_star(order)).min(n_nodes),
        };
        let evening = if self.formulation == Formulation::Variational { EVEN_WHERE_HELD } else { EVEN };
        Ok(StarParams { order, size, choice: self.star_choice(cloud), smoothing: self.smoothing, evening })
    }
}
