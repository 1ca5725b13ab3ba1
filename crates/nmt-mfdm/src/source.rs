//! The right side of −∇²u = s, and its integrals with the hats.

use crate::element::Element;
use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::gauss::Rule;
use crate::true_edges::of_triangle;
use crate::weak::places;
use nmt_geom::{NodeId, Point};
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

    /// ∫s·v + ∫q·v of the hat v of a node, over the elements around it.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn with_hat(
        &self,
        mesh: &Mesh,
        rule: &Rule,
        fluxes: &Fluxes,
        node: NodeId,
        around: &[Element],
    ) -> Result<f64, MfdmError> {
        let mut sum = 0.0;
        for element in around {
            let corner = element.corner_of(node);
            match self {
                // ∫v is a third of the triangle's area.
                Self::Constant(value) if fluxes.slivers.is_empty() => sum += value * element.area / 3.0,
                _ => {
                    for (p, weight) in places(mesh, rule, fluxes, element.triangle) {
                        sum += weight * self.at(p)? * barycentric(element.corners, p)[corner];
                    }
                }
            }
            for sample in of_triangle(&fluxes.edges, element.triangle) {
                sum += sample.weight * barycentric(element.corners, sample.at)[corner];
            }
        }
        Ok(sum)
    }
}
