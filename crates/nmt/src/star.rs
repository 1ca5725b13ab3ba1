//! The star of one node, to be looked at: `nmt plot star`.

use crate::pipeline::{MeshPart, poisson_on, torsion};
use crate::problem::Problem;
use crate::report::place;
use nmt_geom::NodeId;
use nmt_mfdm::{Formulation, MfdmError, NodeStar, SolveParams, Trial};
use std::fmt::Write as _;

/// Why there is no star to look at.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StarError {
    /// A subdomain of no such name.
    #[error("--subdomain: there is no subdomain \"{name}\"; the problem has {known}")]
    Subdomain {
        /// The name.
        name: String,
        /// Names there are.
        known: String,
    },
    /// Several subdomains and none named.
    #[error("--subdomain is missing: the problem has {known}; name the one that the node is of")]
    Several {
        /// Names there are.
        known: String,
    },
    /// A node of no such number.
    #[error(
        "--node: there is no node {node} in subdomain \"{subdomain}\"; its nodes are 0 to {last}, as in nodes.csv and mesh.vtu"
    )]
    Node {
        /// The number.
        node: usize,
        /// The subdomain.
        subdomain: String,
        /// The largest number there is.
        last: usize,
    },
    /// Finite elements have no stars.
    #[error("formulation \"fem\" has no stars; choose --formulation variational or local")]
    NoStars,
    /// The star's parameters are out of range.
    #[error(transparent)]
    Star(#[from] MfdmError),
}

/// The star of one node with the subdomain it is of.
#[derive(Clone, Debug)]
pub struct StarView<'a> {
    /// The subdomain.
    pub part: &'a MeshPart,
    /// How its equations are made.
    pub params: SolveParams,
    /// The star.
    pub star: NodeStar,
}

impl<'a> StarView<'a> {
    /// The star of `node` in the subdomain of that name, which may be left out where there is but one.
    ///
    /// # Errors
    /// [`StarError`] where there is no such subdomain or node, or no star.
    pub fn new(
        problem: &Problem,
        parts: &'a [MeshPart],
        subdomain: Option<&str>,
        node: usize,
    ) -> Result<Self, StarError> {
        let known = || parts.iter().map(|part| format!("\"{}\"", part.name)).collect::<Vec<_>>().join(", ");
        let found = match subdomain {
            Some(name) => parts.iter().position(|part| part.name == name),
            None if parts.len() > 1 => return Err(StarError::Several { known: known() }),
            None => Some(0),
        };
        let named = found.and_then(|k| Some((parts.get(k)?, problem.subdomains.get(k)?)));
        let Some((part, own)) = named else {
            return Err(StarError::Subdomain { name: subdomain.unwrap_or_default().into(), known: known() });
        };
        let cloud = part.mesh.cloud();
        if node >= cloud.n_nodes() {
            let last = cloud.n_nodes().saturating_sub(1);
            return Err(StarError::Node { node, subdomain: part.name.clone(), last });
        }
        let params = problem.solve.params(own.formulation);
        let id = NodeId::of(node);
        let star = match &problem.solve.poisson {
            Some(settings) => {
                poisson_on(own, settings, part, |poisson| NodeStar::in_poisson(poisson, &part.mesh, &params, id))
            }
            None => NodeStar::in_torsion(&torsion(problem, own), &part.mesh, &params, id),
        };
        // Where the data have no value somewhere, there are no equations yet, and the star is the one to be mended.
        let star = match star {
            Err(MfdmError::Datum { .. }) => NodeStar::of(cloud, &params, id),
            other => other,
        };
        Ok(Self { part, params, star: star?.ok_or(StarError::NoStars)? })
    }

    /// What there is to say of the star as a whole, a sentence a line.
    pub fn about(&self) -> Vec<String> {
        let Self { part, params, star } = self;
        let (cloud, outcome) = (part.mesh.cloud(), star.outcome);
        let kind = cloud.kind(star.node).name();
        let mut lines = vec![format!(
            "Node {} of \"{}\", {kind}, at {}",
            star.node.0,
            part.name,
            place(cloud.xy()[star.node.index()])
        )];
        let lowered = if outcome.order < params.order { " (lowered)" } else { "" };
        let enlarged = if outcome.enlarged { format!(" (enlarged from {})", star.asked) } else { String::new() };
        lines.push(format!(
            "{} nodes{enlarged}, {}, order {}{lowered}, condition {:.1}, radius {:.6}",
            star.members.len(),
            star.choice.name(),
            outcome.order,
            outcome.condition,
            star.radius
        ));
        let on_boundary = star.node.index() < cloud.n_boundary();
        let sign = match star.diagonal() {
            -1 => "negative, as it should be",
            1 if on_boundary => "positive, as stars on one side of their node may have it",
            1 => "positive: the wrong sign",
            _ => "absent: no second derivative at this order",
        };
        let hidden = star.hidden.len();
        if outcome.flattening > 0.0 {
            let why = "from all sides, since steep weights of the nearest nodes alone left it unsound";
            lines.push(format!("weights flattened to g = {}, nodes {why}", outcome.flattening));
        }
        lines.push(format!("{hidden} hidden {} passed over", if hidden == 1 { "node" } else { "nodes" }));
        lines.push(format!("own coefficient in the Laplacian {sign}"));
        if params.formulation == Formulation::Local && on_boundary {
            lines.push("on the boundary, where F is given: no local equation has this row".into());
        }
        if params.formulation == Formulation::Variational && params.trial == Trial::Mwls {
            lines.push("trial mwls takes stars at Gauss points; this is that of the node".into());
        }
        lines
    }

    /// The star as text: what there is to say, then a table of its nodes.
    pub fn text(&self) -> String {
        let mut out = self.about().join("\n");
        out.push_str(
            "\n\n    node              x              y       distance         weight      coefficient of ∇²\n",
        );
        for member in &self.star.members {
            let [x, y] = self.part.mesh.xy()[member.node.index()];
            let weight = if member.weight.is_finite() { format!("{:.6e}", member.weight) } else { "∞".into() };
            let laplacian = member.laplacian.map_or("–".into(), |value| format!("{value:+.9e}"));
            // Writing to a string cannot fail.
            let _ = writeln!(
                out,
                "{:8} {x:14.7} {y:14.7} {:14.7} {weight:>14} {laplacian:>22}",
                member.node.0, member.distance
            );
        }
        if !self.star.hidden.is_empty() {
            let hidden: Vec<String> = self.star.hidden.iter().map(|node| node.0.to_string()).collect();
            let _ = writeln!(out, "\nhidden: {}", hidden.join(", "));
        }
        out
    }
}
