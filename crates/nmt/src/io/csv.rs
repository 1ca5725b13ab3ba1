//! nodes.csv: one row a node.

use crate::io::fields::NodeFields;
use crate::io::text::Text;
use nmt_cloud::Cloud;
use nmt_geom::NodeId;
use std::fmt::Write as _;
use std::io::{self, Write};

/// `subdomain,node,x,y,kind,edges`, node from 0 in each subdomain, edges joined by `;`, 17 significant digits.
///
/// # Errors
/// Those of `sink`.
pub fn csv_of_clouds<'a>(
    sink: &mut dyn Write,
    parts: impl IntoIterator<Item = (&'a str, &'a [String], &'a Cloud)>,
) -> io::Result<()> {
    let mut out = Text::to(sink);
    out.push("subdomain,node,x,y,kind,edges\n");
    for (name, edge_names, cloud) in parts {
        let rows = Rows::new(name, edge_names, cloud);
        for node in 0..cloud.n_nodes() {
            rows.write(&mut out, NodeId::of(node));
            out.push("\n");
        }
    }
    out.finish()
}

/// The same with the fields at nodes: `F,tau_zx,tau_zy,tau` of torsion.
///
/// # Errors
/// Those of `sink`.
pub fn csv_of_solutions(sink: &mut dyn Write, parts: &[NodeFields]) -> io::Result<()> {
    let mut out = Text::to(sink);
    out.push("subdomain,node,x,y,kind,edges");
    for (name, _) in parts.first().map_or(&[][..], |fields| &fields.at_nodes) {
        // Writing to a text cannot fail; its end tells.
        let _ = write!(out, ",{name}");
    }
    out.push("\n");
    for NodeFields { part, at_nodes, .. } in parts {
        let cloud = part.mesh.cloud();
        let rows = Rows::new(&part.name, &part.edge_names, cloud);
        for node in (0..cloud.n_nodes()).map(NodeId::of) {
            rows.write(&mut out, node);
            for (_, values) in at_nodes {
                let _ = write!(out, ",{:.16e}", values[node.index()]);
            }
            out.push("\n");
        }
    }
    out.finish()
}

struct Rows<'a> {
    name: String,
    edge_names: Vec<String>,
    cloud: &'a Cloud,
}

impl<'a> Rows<'a> {
    fn new(name: &str, edge_names: &[String], cloud: &'a Cloud) -> Self {
        Self { name: quoted(name), edge_names: edge_names.to_vec(), cloud }
    }

    fn write(&self, out: &mut Text, node: NodeId) {
        let [x, y] = self.cloud.xy()[node.index()];
        let edges = match self.cloud.edges(node) {
            Some(edges) if edges.first == edges.second => quoted(&self.edge_names[edges.first.index()]),
            Some(edges) => {
                quoted(&format!("{};{}", self.edge_names[edges.first.index()], self.edge_names[edges.second.index()]))
            }
            None => String::new(),
        };
        let kind = self.cloud.kind(node).name();
        out.push(&self.name);
        out.push(",");
        out.integer(node.0);
        let _ = write!(out, ",{x:.16e},{y:.16e},{kind},");
        out.push(&edges);
    }
}

/// A field as RFC 4180 wants it.
pub(super) fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field.into() }
}

#[cfg(test)]
mod tests {
    use super::quoted;

    #[test]
    fn fields_with_separators_are_quoted() {
        assert_eq!(quoted("web"), "web");
        assert_eq!(quoted("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}
