//! Values at points that the user asks for.

use crate::pipeline::MeshPart;
use nmt_geom::Point;
use nmt_geom::tol::SAME_POINT_REL;
use nmt_mfdm::{FieldValue, NodalPolynomials, Stress};
use nmt_tri::TriangleIndex;
use serde::Serialize;

/// A point asked for; `null` outside.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointReport {
    /// The point.
    pub at: Point,
    /// The subdomain that holds it: the first of the file.
    pub subdomain: Option<String>,
    /// What was found there.
    #[serde(flatten)]
    pub values: PointValues,
}

/// What was found at a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PointValues {
    /// Of torsion.
    Torsion {
        /// F.
        #[serde(rename = "F")]
        f: Option<f64>,
        /// ∂F/∂y.
        tau_zx: Option<f64>,
        /// −∂F/∂x.
        tau_zy: Option<f64>,
        /// Their magnitude.
        tau: Option<f64>,
    },
    /// Of a Poisson problem.
    Poisson {
        /// u.
        u: Option<f64>,
        /// ∂u/∂x.
        u_x: Option<f64>,
        /// ∂u/∂y.
        u_y: Option<f64>,
    },
}

impl PointValues {
    /// F and τ of a field of torsion.
    pub(super) fn of_torsion(field: Option<FieldValue>) -> Self {
        let stress = field.map(|field| Stress::of_gradient(field.gradient));
        Self::Torsion {
            f: field.map(|field| field.value),
            tau_zx: stress.map(|stress| stress.zx),
            tau_zy: stress.map(|stress| stress.zy),
            tau: stress.map(Stress::magnitude),
        }
    }

    /// u and its gradient.
    pub(super) fn of_poisson(field: Option<FieldValue>) -> Self {
        Self::Poisson {
            u: field.map(|field| field.value),
            u_x: field.map(|field| field.gradient[0]),
            u_y: field.map(|field| field.gradient[1]),
        }
    }
}

/// The values of the fields at points: inside is what the real boundary encloses, itself included, to 1e-9 of the size.
pub(super) fn report(
    parts: &[(&MeshPart, &NodalPolynomials)],
    points: &[Point],
    values: fn(Option<FieldValue>) -> PointValues,
) -> Vec<PointReport> {
    if points.is_empty() {
        return Vec::new();
    }
    let indices: Vec<TriangleIndex> = parts.iter().map(|(part, _)| TriangleIndex::new(&part.mesh)).collect();
    let report = |&at: &Point| {
        let found = parts.iter().zip(&indices).find_map(|((part, field), index)| {
            let triangle = index.locate(at, SAME_POINT_REL * part.mesh.cloud().size())?;
            Some((part.name.clone(), field.blend(&part.mesh, triangle, at)))
        });
        let (subdomain, field) = found.unzip();
        PointReport { at, subdomain, values: values(field) }
    };
    points.iter().map(report).collect()
}
