//! Stars and their rows against the reference's: the nodes of every star exactly, the rows of a sample.

use super::fixture::Table;
use super::{Entry, Scale};
use anyhow::{Context as _, Result, bail};
use nmt_cloud::{Cloud, Section};
use nmt_geom::NodeId;
use nmt_mfdm::{Mwls, StarChoice, StarFinder, Surroundings, default_star, n_monomials};
use std::fs;
use std::path::Path;

const STAR: &str = "subdomain,order,node,star";
const MWLS: &[&str] = &["subdomain", "order", "node", "other", "u_x", "u_y", "u_xx", "u_xy", "u_yy"];

/// Powers of the radius that the rows of u_x, u_y, u_xx, u_xy, u_yy are divided by.
const DEGREES: [i32; 5] = [1, 1, 2, 2, 2];

/// A star as the reference writes it, numbers from 1.
struct Star {
    subdomain: usize,
    order: usize,
    node: usize,
    nodes: Vec<usize>,
}

impl Star {
    fn name(&self) -> String {
        format!("subdomain {}, order {}, node {}", self.subdomain, self.order, self.node)
    }
}

/// What the stars of a case are, and which of them have another rule on the other side.
#[derive(Clone, Debug, PartialEq)]
pub struct StarsOf {
    /// Nodes in a star of order 2; those of order 3 have the default number.
    pub size: usize,
    /// How many the reference enlarged: they are left out.
    pub enlarged: usize,
    /// Order and node (of the first subdomain) of those that must differ, for a reason that the case states.
    pub left_out: Vec<[usize; 2]>,
}

/// Expected and found entries of the stars, and of the rows of a sample.
pub fn entries(clouds: &[(Section, Cloud)], expected: &Path, of: &StarsOf) -> Result<(Vec<Entry>, Vec<Entry>)> {
    let StarsOf { size, enlarged, ref left_out } = *of;
    let surroundings: Vec<Surroundings> = clouds.iter().map(|(_, cloud)| Surroundings::new(cloud)).collect();
    if let Some(k) = surroundings.iter().position(|s| s.metric().stretch() != [1.0, 1.0]) {
        bail!("nmt measures distances of subdomain {} in stretched coordinates, the reference does not", k + 1);
    }
    let nearest: Vec<_> = surroundings.iter().map(Surroundings::nearest).collect();
    let mut finders: Vec<StarFinder> = surroundings
        .iter()
        .zip(&nearest)
        .map(|(s, nearest)| StarFinder::new(s, nearest, StarChoice::Nearest))
        .collect();
    let wanted = |order: usize| if order == 2 { size } else { default_star(order) };
    let (stars, larger): (Vec<Star>, Vec<Star>) =
        read_stars(&expected.join("star.csv"))?.into_iter().partition(|star| star.nodes.len() == wanted(star.order));
    let count = |id: &str, value: usize| Entry { id: id.into(), value: value as f64, scale: Scale::Exact };
    let n_nodes: usize = clouds.iter().map(|(_, cloud)| cloud.n_nodes()).sum();
    let mut of_reference = vec![
        count("star.csv, stars the reference enlarged", enlarged),
        count("star.csv, stars of orders 2 and 3", 2 * n_nodes),
    ];
    let mut of_nmt = vec![
        count("star.csv, stars the reference enlarged", larger.len()),
        count("star.csv, stars of orders 2 and 3", stars.len() + larger.len()),
    ];
    let mut found = Vec::new();
    for star in &stars {
        let finder = finders.get_mut(star.subdomain - 1).with_context(|| format!("{}: no such cloud", star.name()))?;
        finder.find(NodeId::of(star.node - 1), wanted(star.order), &mut found);
        if left_out.contains(&[star.order, star.node]) && star.subdomain == 1 {
            // A star is not left out without need.
            let differs = found.iter().map(|node| node.index() + 1).ne(star.nodes.iter().copied());
            let id = format!("star.csv, {}, left out since it differs", star.name());
            of_reference.push(count(&id, 1));
            of_nmt.push(count(&id, usize::from(differs)));
            continue;
        }
        for (place, there) in star.nodes.iter().enumerate() {
            let id = format!("star.csv, {}, its node {} by number", star.name(), place + 1);
            let here = found.get(place).map_or(0, |node| node.index() + 1);
            of_reference.push(count(&id, *there));
            of_nmt.push(count(&id, here));
        }
    }
    let (rows_of_reference, rows_of_nmt) = rows(&surroundings, &expected.join("mwls.csv"))?;
    of_reference.extend(rows_of_reference);
    of_nmt.extend(rows_of_nmt);
    Ok((of_reference, of_nmt))
}

/// The rows of the reference's stars, each by itself: a star that differs is told above.
fn rows(surroundings: &[Surroundings], file: &Path) -> Result<(Vec<Entry>, Vec<Entry>)> {
    let table = Table::read(file, MWLS)?;
    let (mut of_reference, mut of_nmt) = (Vec::new(), Vec::new());
    let (mut mwls, mut scaled) = (Mwls::default(), Vec::new());
    for star in table.rows.chunk_by(|a, b| a[..3] == b[..3]) {
        let [subdomain, order, node] = [0, 1, 2].map(|k| star[0][k] as usize);
        let cloud = surroundings.get(subdomain - 1).with_context(|| format!("mwls.csv: no subdomain {subdomain}"))?;
        let at =
            |number: usize| cloud.xy().get(number - 1).copied().with_context(|| format!("mwls.csv: no node {number}"));
        let others: Vec<usize> = star.iter().map(|row| row[3] as usize).collect();
        let points = others.iter().map(|other| at(*other)).collect::<Result<Vec<_>>>()?;
        let centre = others.iter().position(|other| *other == node);
        let condition = mwls.factorise(points.into_iter(), at(node)?, centre, order, 0.0);
        if !condition.is_finite() || centre.is_none() {
            bail!("mwls.csv, subdomain {subdomain}, order {order}, node {node}: no star of this node");
        }
        scaled.clear();
        mwls.rows(&mut scaled);
        let n = others.len();
        debug_assert_eq!(scaled.len(), (n_monomials(order) - 1) * n);
        for (m, degree) in DEGREES.into_iter().enumerate() {
            let largest = star.iter().map(|row| row[4 + m].abs()).fold(0.0, f64::max);
            for (k, other) in others.iter().enumerate() {
                let name = MWLS[4 + m];
                let id = format!("mwls.csv, subdomain {subdomain}, order {order}, node {node}, other {other}, {name}");
                let here = scaled[m * n + k] / mwls.radius().powi(degree);
                of_reference.push(Entry { id: id.clone(), value: star[k][4 + m], scale: Scale::Length(largest) });
                of_nmt.push(Entry { id, value: here, scale: Scale::Length(largest) });
            }
        }
    }
    Ok((of_reference, of_nmt))
}

fn read_stars(file: &Path) -> Result<Vec<Star>> {
    let text = fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))?;
    let mut lines = text.lines();
    if lines.next() != Some(STAR) {
        bail!("{}: the columns are not {STAR}", file.display());
    }
    let star = |(k, line): (usize, &str)| {
        let fields: Vec<&str> = line.split(',').collect();
        let [subdomain, order, node, nodes] = fields[..] else { bail!("{}, line {}", file.display(), k + 2) };
        let [subdomain, order, node] = [subdomain.parse()?, order.parse()?, node.parse()?];
        let nodes = nodes.split(' ').map(str::parse).collect::<Result<Vec<usize>, _>>()?;
        Ok(Star { subdomain, order, node, nodes })
    };
    lines.enumerate().map(star).collect()
}
