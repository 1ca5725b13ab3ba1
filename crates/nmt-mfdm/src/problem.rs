//! What is solved: the Prandtl problem's formulation and the condition on holes.

/// How the boundary value problem is discretised; paper, eqs (17) and (18).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Formulation {
    /// One equation a node, ∇²F = −2Gθ collocated at the interior nodes (17).
    Local,
    /// The weak form (18): trial functions blended from nodal polynomials, linear hats as test functions [D13].
    #[default]
    Variational,
}

impl Formulation {
    /// Every formulation, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Variational, Self::Local];

    /// The word of the problem file and of the reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Local => "local",
            Self::Variational => "variational",
        }
    }
}

/// What holds on the boundary of a hole [D12].
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
