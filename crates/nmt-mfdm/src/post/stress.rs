//! Shear stresses; paper, eq. (16).

use crate::blend::NodalPolynomials;
use nmt_tri::Mesh;

/// Shear stresses at a point, in units of G.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stress {
    /// τ_zx = ∂F/∂y.
    pub zx: f64,
    /// τ_zy = −∂F/∂x.
    pub zy: f64,
}

impl Stress {
    /// The stresses of a stress function with that gradient.
    pub fn of_gradient([f_x, f_y]: [f64; 2]) -> Self {
        Self { zx: f_y, zy: -f_x }
    }

    /// τ = √(τ_zx² + τ_zy²).
    pub fn magnitude(self) -> f64 {
        self.zx.hypot(self.zy)
    }
}

/// Integrals of the stresses over one triangle: stress × length².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StressIntegral {
    /// ∫τ_zx.
    pub zx: f64,
    /// ∫τ_zy.
    pub zy: f64,
    /// ∫τ.
    pub magnitude: f64,
}

/// Integrals of the stresses of the blend over every triangle, exact for τ_zx and τ_zy.
pub fn stress_integrals(mesh: &Mesh, field: &NodalPolynomials) -> Vec<StressIntegral> {
    let rule = field.rule();
    mesh.triangles()
        .map(|t| StressIntegral {
            zx: field.integrate(mesh, t, &rule, |v| v.gradient[1]),
            zy: field.integrate(mesh, t, &rule, |v| -v.gradient[0]),
            magnitude: field.integrate(mesh, t, &rule, |v| Stress::of_gradient(v.gradient).magnitude()),
        })
        .collect()
}
