//! Solutions against the reference's: F at every node in every form, J and the largest stress.

use super::{Entry, Scale};
use anyhow::{Context as _, Result, bail};
use nmt_cloud::{Cloud, Section};
use nmt_mfdm::{Formulation, SolveParams, Test, TorsionProblem, TorsionSolution, Trial, solve};
use nmt_tri::{Elimination, Mesh};
use std::fs;
use std::path::Path;

const LOCAL: &str = "subdomain,node,F";
const VAR: &str = "subdomain,trial,test,node,F";
const RESULTS: &str = "subdomain,form,quantity,value";

/// Expected and found entries of the forms named: `local`, or trial and test functions as `blended+hat`; with `size` nodes
/// in a star of order 2, on the mesh of the paper's way.
pub fn entries(
    clouds: &[(Section, Cloud)],
    expected: &Path,
    size: usize,
    forms: &[String],
) -> Result<(Vec<Entry>, Vec<Entry>)> {
    let forms = forms.iter().map(|form| Form::of(form, size)).collect::<Result<Vec<_>>>()?;
    // Without a weak form the diagonals of the triangles are free, and with them J by as much as the field is wrong.
    let is_weak = |form: &Form| form.params.formulation == Formulation::Variational;
    let with_j = forms.iter().any(is_weak);
    let [mut local, mut var, mut results, mut repaired] = [const { Vec::new() }; 4];
    for (k, (_, cloud)) in clouds.iter().enumerate() {
        let number = k + 1;
        let (mesh, _) = Mesh::unconstrained(cloud.clone(), &Elimination::default())?;
        for Form { name, columns, params } in &forms {
            let solution = solve(&TorsionProblem::default(), &mesh, params)
                .with_context(|| format!("subdomain {number}, {name}"))?;
            let (into, start) = match params.formulation {
                Formulation::Local => (&mut local, format!("local.csv, {number}")),
                _ => (&mut var, format!("var.csv, {number},{columns}")),
            };
            into.extend(solution.f.iter().enumerate().map(|(node, f)| (format!("{start},{}", node + 1), *f)));
            let result = |quantity: &str| format!("results.csv, {number},{name},{quantity}");
            if with_j {
                results.push((result("J"), solution.j));
            }
            results.push((result("tau_max"), solution.tau_max.value));
            repaired.push((format!("stars that nmt repaired, {number},{name}"), repairs(&solution) as f64));
        }
    }
    let mut of_reference = labelled(expected, "local.csv", LOCAL)?;
    if with_j {
        of_reference.extend(labelled(expected, "var.csv", VAR)?);
    }
    let largest = of_reference.iter().map(|(_, f)| f.abs()).fold(0.0, f64::max);
    let n_fields = of_reference.len();
    of_reference.extend(labelled(expected, "results.csv", RESULTS)?);
    let n_numbers = of_reference.len();
    of_reference.extend(repaired.iter().map(|(id, _)| (id.clone(), 0.0)));
    let scaled = |(k, (id, value)): (usize, (String, f64))| {
        let scale = match k {
            _ if k < n_fields => Scale::Length(largest),
            _ if k < n_numbers => Scale::Itself,
            _ => Scale::Exact,
        };
        Entry { id, value, scale }
    };
    let found = local.into_iter().chain(var).chain(results).chain(repaired);
    Ok((of_reference.into_iter().enumerate().map(scaled).collect(), found.enumerate().map(scaled).collect()))
}

/// Stars that are not the nearest nodes of the size asked for: the reference has another rule for them.
fn repairs(solution: &TorsionSolution) -> usize {
    [solution.stars, solution.recovery_stars].iter().map(|stars| stars.enlarged + stars.order_lowered).sum()
}

/// A form of the equations.
struct Form {
    name: String,
    columns: String, // in var.csv
    params: SolveParams,
}

impl Form {
    fn of(name: &str, size: usize) -> Result<Self> {
        let params = SolveParams { star: Some(size), ..SolveParams::default() };
        let (columns, params) = match name.split_once('+') {
            None if name == "local" => (String::new(), SolveParams { formulation: Formulation::Local, ..params }),
            Some((trial, test)) => {
                let trial_of = Trial::ALL.into_iter().find(|kind| kind.name() == trial);
                let test_of = Test::ALL.into_iter().find(|kind| kind.name() == test);
                let (trial_of, test_of) = trial_of.zip(test_of).with_context(|| format!("no form {name}"))?;
                (format!("{trial},{test}"), SolveParams { trial: trial_of, test: test_of, ..params })
            }
            None => bail!("no form {name}"),
        };
        Ok(Self { name: name.into(), columns, params })
    }
}

/// Lines of which the last field is a number and the others name it.
fn labelled(directory: &Path, name: &str, header: &str) -> Result<Vec<(String, f64)>> {
    let file = directory.join(name);
    let text = fs::read_to_string(&file).with_context(|| format!("{} cannot be read", file.display()))?;
    let mut lines = text.lines();
    if lines.next() != Some(header) {
        bail!("{}: the columns are not {header}", file.display());
    }
    let entry = |(k, line): (usize, &str)| {
        let (id, value) = line.rsplit_once(',').with_context(|| format!("{}, line {}", file.display(), k + 2))?;
        Ok((format!("{name}, {id}"), value.trim().parse()?))
    };
    lines.enumerate().map(entry).collect()
}
