//! The data of a Poisson problem in `[solve]`: `source`, which makes it one, `boundary`, `exact`; what does not go with them.

use super::error::{Faults, Place};
use super::formula::{self, Formula};
use super::read::SubdomainDraft;
use super::schema::{Overrides, PoissonSettings};
use super::shape::Shape;
use super::solve::{ITEM, item};
use super::tree::{Reader, Table};

/// A key as it was given: last the option, which wins.
#[derive(Debug, Default)]
struct Datum {
    place: Option<Place>,
    formula: Option<Formula>,
}

/// The formulas of `[solve]`, and the keys of torsion, as far as they could be read.
#[derive(Debug, Default)]
pub(super) struct PoissonDraft {
    source: Datum,
    boundary: Datum,
    exact: Datum,
    /// Keys that belong to torsion alone.
    torsion: Vec<(&'static str, Place)>,
}

impl PoissonDraft {
    /// `[solve]` of the file.
    pub(super) fn read_file(&mut self, reader: &mut Reader<'_>, table: &Table<'_, '_>) {
        let Self { source, boundary, exact, torsion } = self;
        for (datum, key, example) in
            [(source, "source", "\"1\""), (boundary, "boundary", "\"0\""), (exact, "exact", "\"x^2 - y^2\"")]
        {
            if let Some(value) = table.get(key) {
                datum.place = Some(value.span().into());
                datum.formula = formula::of_the_plane(reader, ITEM, key, value, example);
            }
        }
        let given = ["twist", "torque", "holes", "estimate", "tolerance", "max_nodes"].into_iter();
        torsion.extend(given.filter_map(|key| Some((key, Place::File(table.get(key)?.span())))));
    }

    /// Puts the options of the command over those of the file.
    pub(super) fn read_options(&mut self, options: &Overrides, faults: &mut Faults) {
        let Self { source, boundary, exact, torsion } = self;
        let given = [
            (source, "source", &options.source),
            (boundary, "boundary", &options.boundary),
            (exact, "exact", &options.exact),
        ];
        for (datum, key, text) in given {
            if let Some(text) = text {
                let place = Place::Option(format!("--{key} {text}"));
                datum.formula = formula::of_an_option(faults, place.clone(), text);
                datum.place = Some(place);
            }
        }
        let shown = |value: Option<f64>| value.map(super::limits::show);
        let given = [
            ("twist", shown(options.twist)),
            ("torque", shown(options.torque)),
            ("holes", options.holes.clone()),
            ("tolerance", shown(options.tolerance)),
            ("max-nodes", options.max_nodes.map(|most| most.to_string())),
        ];
        let place =
            |(key, value): (&'static str, Option<String>)| Some((key, Place::Option(format!("--{key} {}", value?))));
        torsion.extend(given.into_iter().filter_map(place));
        let no_estimate = options.estimate.map(|_| ("no-estimate", Place::Option("--no-estimate".into())));
        torsion.extend(no_estimate);
    }

    /// The data of a Poisson problem; `None` for torsion.
    pub(super) fn finish(self, subdomains: &[SubdomainDraft], faults: &mut Faults) -> Option<PoissonSettings> {
        let Self { source, boundary, exact, torsion } = self;
        if source.place.is_none() {
            let remedy = "give source = \"f(x, y)\" in [solve] too, for ∇²u = f, or leave it out";
            for (key, datum) in [("boundary", &boundary), ("exact", &exact)] {
                if let Some(place) = &datum.place {
                    let message =
                        format!("`{key}` is given, and belongs to a Poisson problem, which only `source` makes it");
                    faults.push(place.clone(), item(place), message, remedy);
                }
            }
            for (place, item) in subdomains.iter().flat_map(fluxes) {
                let message = "`neumann` is given, and belongs to a Poisson problem, which only `source` makes it";
                faults.push(place, item, message, remedy);
            }
            return None;
        }
        let remedy = "leave it out, or leave `source` out for torsion";
        for (key, place) in torsion {
            let message = format!("`{key}` is given, and belongs to torsion; `source` makes this a Poisson problem");
            faults.push(place.clone(), item(&place), message, remedy);
        }
        for subdomain in subdomains {
            if let Some(place) = &subdomain.shear_modulus_place {
                let message = "`shear_modulus` is given, and belongs to torsion; `source` makes this a Poisson problem";
                faults.push(place.clone(), subdomain.item.as_str(), message, remedy);
            }
            value_of_an_edge(subdomain, faults);
        }
        // Where a formula could not be read, that has been told.
        Some(PoissonSettings { source: source.formula?, boundary: boundary.formula, exact: exact.formula })
    }
}

fn shapes(subdomain: &SubdomainDraft) -> impl Iterator<Item = &Shape> {
    subdomain.contour.iter().chain(subdomain.holes.iter().filter_map(|hole| hole.shape.as_ref()))
}

/// The fluxes of a subdomain with their items, one for each place: all edges of a rectangle or hole share one.
fn fluxes(subdomain: &SubdomainDraft) -> Vec<(Place, String)> {
    let mut found: Vec<(Place, String)> = Vec::new();
    for shape in shapes(subdomain) {
        for (flux, mark) in shape.fluxes.iter().zip(&shape.edges) {
            let Some(formula) = flux else { continue };
            if found.iter().all(|(place, _)| *place != formula.place) {
                found.push((formula.place.clone(), shape.item_of(mark)));
            }
        }
    }
    found
}

/// Notes a subdomain all of whose edges have a flux: u is then determined to a constant only, if at all.
fn value_of_an_edge(subdomain: &SubdomainDraft, faults: &mut Faults) {
    let Some(contour) = &subdomain.contour else { return };
    let is_complete = subdomain.holes.iter().all(|hole| hole.shape.is_some());
    let has_value = shapes(subdomain).flat_map(|shape| &shape.fluxes).any(Option::is_none);
    if is_complete && !has_value {
        let message = "every edge has a `neumann`, and u is determined to a constant only";
        let remedy = "leave `neumann` out at one edge at least: u = `boundary` holds there";
        faults.push(contour.place.clone(), subdomain.item.as_str(), message, remedy);
    }
}
