//! The insides whose instructions `cargo xtask perf --check` counts; not part of the interface.

use crate::assembly::Frame;
use crate::blend::NodalPolynomials;
use crate::flux::Fluxes;
use crate::gauss::six_points;
use crate::problem::HoleCondition;
use crate::solver::kernels::{cycles, products, setups};
use crate::source::Source;
use crate::star::default_star;
use crate::stencils::{Kept, StarParams, Stencils};
use crate::surroundings::Surroundings;
use crate::system::{Dirichlet, LinearSystem, Roles};
use crate::weak::WeakForm;
use crate::{MfdmError, local, variational};
use nmt_tri::{Mesh, NodeTris};

/// A part of the solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kernel {
    /// Stars of nine nodes and their rows.
    Rows,
    /// The same stars and their rows of ∇² alone.
    LaplacianRows,
    /// The system of the local form.
    LocalAssembly,
    /// The system of the variational form with hats.
    VariationalAssembly,
    /// The levels of the multigrid, of the local system.
    MultigridSetup,
    /// One cycle.
    Cycle,
    /// A matrix × vector product.
    Product,
    /// Polynomials of order 3 about the nodes, blended and integrated.
    Recovery,
}

impl Kernel {
    /// All, with their names in the baseline.
    pub const ALL: [(&'static str, Self); 8] = [
        ("rows", Self::Rows),
        ("rows of ∇²", Self::LaplacianRows),
        ("local assembly", Self::LocalAssembly),
        ("variational assembly", Self::VariationalAssembly),
        ("multigrid set-up", Self::MultigridSetup),
        ("multigrid cycle", Self::Cycle),
        ("matrix × vector", Self::Product),
        ("recovery", Self::Recovery),
    ];

    /// Prepares the kernel on a mesh, runs it `times` times, and returns a number that depends on all it did.
    ///
    /// # Errors
    /// Those of a solution.
    pub fn run(self, mesh: &Mesh, times: usize) -> Result<f64, MfdmError> {
        let surroundings = Surroundings::new(mesh.cloud());
        let nearest = surroundings.nearest();
        let params = StarParams::nearest(2, default_star(2));
        let n_nodes = mesh.cloud().n_nodes();
        let rows = || Stencils::new(&surroundings, &nearest, params, 0..n_nodes);
        if self == Self::Rows {
            return Ok((0..times).map(|_| rows().report().worst_condition).sum());
        }
        if self == Self::LaplacianRows {
            let around = (&surroundings, &nearest);
            let rows = || Stencils::meeting(around, params, Kept::Laplacian, 0..n_nodes, |_| None, &mut |_| {});
            return Ok((0..times).map(|_| rows().report().worst_condition).sum());
        }
        if self == Self::Recovery {
            let values: Vec<f64> = mesh.xy().iter().map(|[x, y]| x * y).collect();
            let params = StarParams::nearest(3, default_star(3));
            let volume = |_| Ok(NodalPolynomials::fit(&surroundings, &nearest, params, &values)?.volume(mesh));
            return (0..times).map(volume).sum();
        }
        // As the solution has them: the local equations take the rows of ∇² alone.
        let kept = if self == Self::VariationalAssembly { Kept::Derivatives } else { Kept::Laplacian };
        let stencils = Stencils::meeting((&surroundings, &nearest), params, kept, 0..n_nodes, |_| None, &mut |_| {});
        let conditions = Roles::of_torsion(mesh, HoleCondition::Circulation);
        let roles = Roles::new(conditions, mesh.cloud().n_interior(), Dirichlet::Eliminated);
        let (node_tris, fluxes) = (NodeTris::new(n_nodes, mesh.tri_nodes()), Fluxes::default());
        let rule = six_points();
        let source = Source::Constant(2.0);
        let frame = Frame { mesh, node_tris: &node_tris, roles: &roles, source, fluxes: &fluxes, source_rule: &rule };
        let setting = frame.with(&stencils);
        let sum = |system: LinearSystem| system.rhs.iter().sum::<f64>();
        if self == Self::VariationalAssembly {
            let weak = WeakForm::blended(&stencils, &fluxes, &rule);
            return (0..times).map(|_| variational::assemble(&setting, &weak).map(sum)).sum();
        }
        if self == Self::LocalAssembly {
            return (0..times).map(|_| local::assemble(&setting).map(sum)).sum();
        }
        let system = local::assemble(&setting)?;
        Ok(match self {
            Self::MultigridSetup => setups(&system, times),
            Self::Cycle => cycles(&system, times),
            _ => products(&system, times),
        })
    }
}
