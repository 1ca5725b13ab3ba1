//! The right side of −∇²u = s, and its integrals with the hats.

use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::gauss::Rule;
use crate::hat::Hat;
use crate::true_edges::of_triangle;
use crate::weak::places;
use nmt_geom::Point;
use nmt_tri::{Mesh, barycentric};

/// s of −∇²u = s.
#[derive(Clone, Copy)]
pub(crate) enum Source<'a> {
    /// The same everywhere: 2 for torsion with Gθ = 1.
    Constant(f64),
    /// −f of ∇²u = f.
    Minus(&'a (dyn Fn(Point) -> f64 + Sync)),
}

impl Source<'_> {
    /// s at a place.
    ///
    /// # Errors
    /// [`MfdmError::Datum`] where it is not finite.
    pub fn at(&self, p: Point) -> Result<f64, MfdmError> {
        match self {
            Self::Constant(value) => Ok(*value),
            Self::Minus(f) => {
                let value = f(p);
                if value.is_finite() { Ok(-value) } else { Err(MfdmError::Datum { quantity: "source", at: p, value }) }
            }
        }
    }

    /// ∫s·v + ∫q·v of a hat v.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn with_hat(&self, mesh: &Mesh, rule: &Rule, fluxes: &Fluxes, hat: &Hat) -> Result<f64, MfdmError> {
        let constant = match self {
            Self::Constant(value) if fluxes.slivers.is_empty() => Some(value * hat.volume()),
            _ => None,
        };
        let mut sum = constant.unwrap_or(0.0);
        if constant.is_some() && fluxes.edges.is_empty() {
            return Ok(sum);
        }
        for element in hat.elements() {
            if constant.is_none() {
                for (p, weight) in places(mesh, rule, fluxes, element.triangle) {
                    sum += weight * self.at(p)? * barycentric(element.corners, p)[0];
                }
            }
            for sample in of_triangle(&fluxes.edges, element.triangle) {
                sum += sample.weight * barycentric(element.corners, sample.at)[0];
            }
        }
        Ok(sum)
    }
}
