//! The problem file: TOML text to a typed problem, or every fault of it in one run.
//!
//! The way of a text: `syntax` (a tree with places) → `read` and `shape` (kinds, ranges, names, outlines; the options of
//! the command obey the same `limits`) → `check` (how the shapes lie) → [`Problem`]. Each step notes its faults and goes
//! on with what is sound, and a later one looks only at what the one before could read: one mistake is told once.
//!
//! Limits of our own, beyond those the method needs: numbers are at most 1e30 in size, and lengths, moduli, twist and
//! torque at least 1e-30, so that nothing overflows later; the problem lies within 1e6 times its size of the origin, and
//! no contour or hole is smaller than 1e-6 of it, so that tolerances relative to the size tell points apart; clearances
//! are 0 to 2 spacings; names hold no `;` and no control character.

mod check;
mod error;
mod formula;
mod grading;
mod habits;
mod limits;
mod poisson;
mod read;
mod schema;
mod shape;
mod solve;
mod suggest;
mod syntax;
mod tree;

pub use error::{Place, ProblemError, Source};
pub use formula::Formula;
pub use grading::GradingSettings;
pub use schema::{Hole, MeshMethod, MeshSettings, Overrides, PoissonSettings, Problem, SolveSettings, Subdomain};

use error::Faults;
use read::{Draft, HoleDraft, SubdomainDraft};
use shape::Shape;
use tree::Reader;

impl Problem {
    /// The problem of a file's text, the options of the command over it.
    ///
    /// `file` is the name for messages; nothing is read from disk.
    ///
    /// # Errors
    /// Every fault that can be found without the cloud, options first, then in the order of the file; after 100 of them
    /// the others are counted only.
    pub fn parse(file: &str, text: &str, overrides: &Overrides) -> Result<Self, Vec<ProblemError>> {
        let source = Source { file: file.to_owned(), text: text.to_owned() };
        let mut faults = Faults::default();
        let tree = syntax::parse(text, &mut faults);
        let mut reader = Reader { text, faults };
        let draft = tree.map(|tree| read::read(&tree, overrides, &mut reader));
        let mut faults = reader.faults;
        if let Some(draft) = &draft {
            check::check(draft, &mut faults);
        }
        if faults.len() > 0 {
            return Err(faults.into_errors(&source));
        }
        let problem = draft.and_then(|draft| complete(draft, source.clone()));
        // Whatever a draft lacks was noted as a fault; an empty list would be an error without a word.
        problem.ok_or_else(|| vec![source.error(&Place::File(0..0), "", "the problem is incomplete", "complete it")])
    }
}

/// The problem of a draft without faults.
fn complete(draft: Draft, source: Source) -> Option<Problem> {
    let Draft { title, units, subdomains, mesh, solve } = draft;
    let subdomains = subdomains.into_iter().map(subdomain).collect::<Option<_>>()?;
    Some(Problem { title, units, subdomains, mesh, solve, source })
}

fn subdomain(draft: SubdomainDraft) -> Option<Subdomain> {
    let contour = draft.contour?;
    let of_holes = draft.holes.iter().filter_map(|hole| hole.shape.as_ref());
    let fluxes = std::iter::once(&contour).chain(of_holes).flat_map(|shape| shape.fluxes.clone()).collect();
    Some(Subdomain {
        fluxes,
        name: draft.name,
        nodes: draft.nodes?,
        irregularity: draft.irregularity,
        shear_modulus: draft.shear_modulus,
        formulation: draft.formulation,
        division: draft.division,
        clearance: draft.clearance,
        edge_clearance: draft.edge_clearance,
        node_clearance: draft.node_clearance,
        conforming: draft.conforming,
        grading: draft.grading,
        edge_places: edge_places(&contour),
        contour_place: contour.place.into(),
        contour: contour.outline,
        holes: draft.holes.into_iter().map(hole).collect::<Option<_>>()?,
        place: draft.place.into(),
        nodes_place: draft.nodes_place,
    })
}

fn hole(draft: HoleDraft) -> Option<Hole> {
    let HoleDraft { name, nodes, shape, place, .. } = draft;
    let shape = shape?;
    let edge_places = edge_places(&shape);
    Some(Hole { name, nodes, outline: shape.outline, place: place.into(), edge_places })
}

fn edge_places(shape: &Shape) -> Vec<Place> {
    shape.edges.iter().map(|mark| mark.place.clone().into()).collect()
}

#[cfg(test)]
mod tests;
