//! Section and grading in, graded cloud out: the steps of a uniform cloud with a spacing that varies.

use crate::boundary::{BoundaryNodes, boundary_nodes};
use crate::clearance::Clearance;
use crate::cloud::{Cloud, CloudParts, Local};
use crate::error::CloudError;
use crate::even::even_out;
use crate::generate::{displace, place_of};
use crate::section::{ClearanceUnit, CloudParams, Section};
use crate::sow::{Field, LocalClearance, Sown, sow};
use crate::spacing::Spacing;
use nmt_curve::Division;
use nmt_geom::Point;
use std::f64::consts::SQRT_2;

/// A level's spacing is at most this many times what is asked for: ⁴√2, rounded up.
const LEVEL_OVER_ASKED: f64 = 1.19;

/// The cloud of a section whose spacing varies.
///
/// # Errors
/// As [`crate::generate`] has them.
pub(crate) fn generate_graded(
    section: &Section,
    params: &CloudParams,
    random: &mut dyn FnMut(usize, usize) -> [f64; 2],
) -> Result<Cloud, CloudError> {
    let uniform_only = [
        ("division by chords", params.division == Division::Chord, "divide edges by arc length"),
        (
            "scaled clearance",
            params.clearance == ClearanceUnit::Scaled,
            "its spacing is the same along x and y: use Max",
        ),
    ];
    if let Some(&(parameter, _, remedy)) = uniform_only.iter().find(|(_, given, _)| *given) {
        return Err(CloudError::NotGraded { parameter, remedy });
    }
    let spacing = Spacing::new(section, params)?;
    let BoundaryNodes { boundary, n_vertices, fractions, closings } =
        boundary_nodes(section, params, Some(&spacing), random)?;
    if let Some(fault) = boundary.faults().first() {
        let remedy = "ask for a smaller spacing there".into();
        return Err(CloudError::BoundaryCrosses { at: place_of(fault, &boundary), remedy });
    }
    let size = section.contour.envelope().size();
    let clearance = LocalClearance { edge: params.edge_clearance, node: params.node_clearance, size };
    let moves = params.irregularity * LEVEL_OVER_ASKED * SQRT_2;
    let field = Field { spacing: &spacing, boundary: &boundary, clearance, moves };
    let mut sown = sow(&field)?;
    if params.irregularity == 0.0 {
        even_out(&mut sown, &field);
    }
    let Sown { mut xy, mut asked, exposed, census, .. } = sown;
    let n_boundary = boundary.xy().len();
    xy.shrink_to_fit();
    asked.shrink_to_fit();
    if xy.len() == n_boundary {
        let remedy = "ask for a smaller spacing where the section is thin".into();
        return Err(CloudError::NoInterior { remedy });
    }
    let lattice = *spacing.lattice();
    let local = Local { lattice, asked, clearance, may_miss_dips: spacing.may_miss_dips() };
    if params.irregularity > 0.0 {
        let by = local.displacements(n_boundary, params.irregularity);
        let clearance_of = |k: usize| local.clearance_of(n_boundary + k);
        let mut exposed = exposed.into_iter().peekable();
        let is_exposed = |k: usize| exposed.next_if_eq(&(k as u32)).is_some();
        displace(&mut xy, &boundary, by, clearance_of, is_exposed, random);
    }
    let clearance = clearance.at(spacing.most());
    Ok(Cloud::new(CloudParts {
        xy,
        n_vertices,
        boundary,
        fractions: Some(fractions),
        spacing: lattice.spacing(),
        clearance,
        born: None,
        local: Some(local),
        closings,
        census,
    }))
}

impl Local {
    /// How far interior node k goes for two random numbers of [−1, 1): by `amplitude` of the steps of its level, which are
    /// along x and y or along the diagonals. The first interior node is node `n_boundary`.
    pub fn displacements(&self, n_boundary: usize, amplitude: f64) -> impl Fn(usize, [f64; 2]) -> Point + '_ {
        let levels = self.lattice.levels();
        let steps: Vec<[[f64; 2]; 2]> = (0..levels.len()).map(|level| self.lattice.steps(level)).collect();
        move |k, [r, s]| {
            let [u, v] = steps[levels.level_of(self.asked[n_boundary + k])];
            [amplitude * (r * u[0] + s * v[0]), amplitude * (r * u[1] + s * v[1])]
        }
    }

    /// What a node must keep from the boundary.
    pub fn clearance_of(&self, node: usize) -> Clearance {
        self.clearance.at(self.asked[node])
    }
}
