//! What is solved: the Prandtl torsion problem, its formulation, its load, the condition on holes.

use crate::error::MfdmError;

/// How the boundary value problem is discretised; paper, eqs (17) and (18).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Formulation {
    /// One equation a node, ∇²F = −2Gθ collocated at the interior nodes (17).
    Local,
    /// The weak form (18): trial functions blended from nodal polynomials, linear hats as test functions \[D13\].
    #[default]
    Variational,
    /// Linear finite elements on the same mesh, for comparison; results are those of the linear interpolant.
    Fem,
}

impl Formulation {
    /// Every formulation, in the order of the documentation.
    pub const ALL: [Self; 3] = [Self::Variational, Self::Local, Self::Fem];

    /// The meshless ones.
    pub const MESHLESS: [Self; 2] = [Self::Variational, Self::Local];

    /// The word of the problem file and of the reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Variational => "variational",
            Self::Fem => "fem",
        }
    }
}

/// Trial functions of the variational form; paper, eq. (18) \[D13\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Trial {
    /// On each triangle the polynomials of its three nodes, blended by the barycentric coordinates.
    #[default]
    Blended,
    /// The paper's: MWLS at every Gauss point from the nodes nearest to it. Discontinuous where the star changes.
    Mwls,
}

impl Trial {
    /// Both, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Blended, Self::Mwls];

    /// The word of the problem file and of the reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Blended => "blended",
            Self::Mwls => "mwls",
        }
    }
}

/// Test functions of the variational form; paper, eq. (18) \[D13\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Test {
    /// The linear hats of the mesh (Petrov–Galerkin).
    #[default]
    Hat,
    /// The trial functions themselves (Bubnov–Galerkin), as the paper has it.
    Trial,
}

impl Test {
    /// Both, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Hat, Self::Trial];

    /// The word of the problem file and of the reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hat => "hat",
            Self::Trial => "trial",
        }
    }
}

/// What holds on the boundary of a hole \[D12\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HoleCondition {
    /// The physics of a hollow section: F is an unknown constant on each hole, with ∮ ∂F/∂n ds = 2GθA.
    #[default]
    Circulation,
    /// The paper's: F = 0 on holes too. Then 2∫F is not the torsion constant of the hollow section.
    Zero,
}

impl HoleCondition {
    /// Every condition, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Circulation, Self::Zero];

    /// The word of the problem file and of the reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Circulation => "circulation",
            Self::Zero => "zero",
        }
    }
}

/// What the bar is loaded by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// θ, the twist per unit length.
    Twist(f64),
    /// T, the torque; the twist follows from J.
    Torque(f64),
}

/// The Prandtl problem: ∇²F = −2Gθ, F = 0 on the outer boundary; paper, eqs (16)–(17).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorsionProblem {
    /// G, the shear modulus; 1 by default.
    pub shear_modulus: f64,
    /// Twist or torque; a twist of 1 by default.
    pub load: Load,
    /// What holds on holes; circulation by default.
    pub holes: HoleCondition,
}

impl Default for TorsionProblem {
    fn default() -> Self {
        Self { shear_modulus: 1.0, load: Load::Twist(1.0), holes: HoleCondition::Circulation }
    }
}

impl TorsionProblem {
    /// # Errors
    /// [`MfdmError::Constant`] where G is not positive, or the load is 0 or not finite.
    pub(crate) fn check(&self) -> Result<(), MfdmError> {
        let (quantity, load) = match self.load {
            Load::Twist(twist) => ("twist", twist),
            Load::Torque(torque) => ("torque", torque),
        };
        if !(self.shear_modulus > 0.0 && self.shear_modulus.is_finite()) {
            return Err(MfdmError::Constant { quantity: "shear_modulus", value: self.shear_modulus });
        }
        if load == 0.0 || !load.is_finite() {
            return Err(MfdmError::Constant { quantity, value: load });
        }
        Ok(())
    }

    /// Whether 2∫F + 2Σc_kA_k is the torsion constant of a section of so many holes: not where F = 0 on them
    /// ([`HoleCondition::Zero`]).
    pub fn has_torsion_constant(&self, n_holes: usize) -> bool {
        n_holes == 0 || self.holes == HoleCondition::Circulation
    }

    /// θ for a section of torsion constant `j`.
    pub(crate) fn twist(&self, j: f64) -> f64 {
        match self.load {
            Load::Twist(twist) => twist,
            Load::Torque(torque) => torque / (self.shear_modulus * j),
        }
    }
}
