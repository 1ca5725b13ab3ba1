//! stars.json: the star of every node in the equations.

use crate::io::fields::NodeFields;
use nmt_mfdm::StarDiagnostics;
use serde::Serialize;
use std::io::{self, Write};

/// The stars of one subdomain, each array of shape (n_nodes,); all 0 where a node has none: finite elements, and boundary
/// nodes in the local formulation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StarArrays {
    /// The subdomain's name.
    pub name: String,
    /// Nodes in the star, the centre included.
    pub size: Vec<u32>,
    /// Order of its polynomial.
    pub order: Vec<u32>,
    /// Distance of its farthest node in the coordinates of the stars (stretched where h_x and h_y differ), user's length
    /// unit.
    pub radius: Vec<f64>,
    /// Condition number of its system.
    pub condition: Vec<f64>,
    /// Hidden nodes passed over.
    pub hidden: Vec<u32>,
    /// Sign of the node's own coefficient in its ∇² row: −1 is right; 0 where there is no second derivative.
    pub diagonal: Vec<i8>,
    /// Largest error of its rows on the monomials of its order, in scaled coordinates.
    pub residual: Vec<f64>,
}

impl StarArrays {
    /// The stars of a solved subdomain; every number is finite.
    pub fn of(fields: &NodeFields) -> Self {
        let mut stars = fields.stars.clone();
        stars.resize(fields.part.mesh.cloud().n_nodes(), StarDiagnostics::default());
        let finite = |of: fn(&StarDiagnostics) -> f64| -> Vec<f64> {
            stars.iter().map(of).map(|value| if value.is_finite() { value } else { 0.0 }).collect()
        };
        Self {
            name: fields.part.name.clone(),
            radius: finite(|star| star.radius),
            condition: finite(|star| star.condition),
            residual: finite(|star| star.residual),
            size: stars.iter().map(|star| star.size).collect(),
            order: stars.iter().map(|star| star.order).collect(),
            hidden: stars.iter().map(|star| star.hidden).collect(),
            diagonal: stars.iter().map(|star| star.diagonal).collect(),
        }
    }
}

/// `{"subdomains": [{"name", "size", "order", "radius", "condition", "hidden", "diagonal", "residual"}]}`, one entry a
/// subdomain in the order of the file, on one line that ends with a line break.
///
/// # Errors
/// Those of `sink`; where JSON cannot hold a value, which it can every star's.
pub fn stars_json(sink: &mut dyn Write, parts: &[NodeFields]) -> io::Result<()> {
    #[derive(Serialize)]
    struct Stars {
        subdomains: Vec<StarArrays>,
    }
    let stars = Stars { subdomains: parts.iter().map(StarArrays::of).collect() };
    serde_json::to_writer(&mut *sink, &stars)?;
    sink.write_all(b"\n")
}
