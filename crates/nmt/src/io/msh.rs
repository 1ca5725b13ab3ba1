//! mesh.msh: Gmsh's format MSH 4.1, ASCII, with names for subdomains, edges and common edges (docs/gmsh.md).

mod model;
mod names;

use crate::io::fields::NodeFields;
use crate::io::text::Text;
use crate::pipeline::MeshPart;
use model::{Entity, Model};
use nmt_geom::{Bbox, NodeId, Point};
use std::fmt::Write as _;
use std::io::{self, Write};

/// Gmsh's number for a line of two nodes.
const LINE: u8 = 1;
/// Gmsh's number for a triangle of three nodes.
const TRIANGLE: u8 = 2;

/// The meshes: a physical surface of every subdomain, a physical curve of every edge and of every common edge.
///
/// Where all common edges conform the subdomains share their nodes; otherwise each subdomain keeps its own. Nodes and
/// triangles are numbered as in nodes.csv and mesh.vtu, from 1, but for nodes of a welded mesh that an earlier subdomain
/// has already.
///
/// # Errors
/// Those of `sink`.
pub fn msh_of_meshes(sink: &mut dyn Write, parts: &[MeshPart]) -> io::Result<()> {
    let parts: Vec<&MeshPart> = parts.iter().collect();
    Msh::of(sink, &Model::new(&parts), &parts).out.finish()
}

/// The meshes with the fields of the solution (`F, tau_zx, tau_zy, tau` of torsion) at nodes as views; where subdomains share
/// nodes, at the nodes of triangles, since each subdomain has values of its own there.
///
/// # Errors
/// Those of `sink`.
pub fn msh_of_solutions(sink: &mut dyn Write, solved: &[NodeFields]) -> io::Result<()> {
    let parts: Vec<&MeshPart> = solved.iter().map(|fields| fields.part).collect();
    let model = Model::new(&parts);
    let mut msh = Msh::of(sink, &model, &parts);
    for (field, (name, _)) in solved.first().map_or(&[][..], |fields| &fields.at_nodes).iter().enumerate() {
        msh.view(name, &model, &parts, |k, node| solved[k].at_nodes[field].1[node.index()]);
    }
    msh.out.finish()
}

// Numbers are written in the shortest form that reads back to the same bits; writing to a text cannot fail.
struct Msh<'w> {
    out: Text<'w>,
}

impl<'w> Msh<'w> {
    fn of(sink: &'w mut dyn Write, model: &Model, parts: &[&MeshPart]) -> Self {
        let mut msh = Self { out: Text::to(sink) };
        msh.out.push("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
        msh.physical_names(model);
        msh.entities(model);
        msh.nodes(model);
        msh.elements(model, parts);
        msh
    }

    fn section(&mut self, name: &str, write: impl FnOnce(&mut Text)) {
        let _ = writeln!(self.out, "${name}");
        write(&mut self.out);
        let _ = writeln!(self.out, "$End{name}");
    }

    fn physical_names(&mut self, model: &Model) {
        self.section("PhysicalNames", |out| {
            let _ = writeln!(out, "{}", model.groups.len());
            for (k, group) in model.groups.iter().enumerate() {
                let _ = writeln!(out, "{} {} \"{}\"", group.dimension, k + 1, group.name);
            }
        });
    }

    fn entities(&mut self, model: &Model) {
        let envelope = |nodes: &[NodeId]| Bbox::of(nodes.iter().map(|node| model.xy[node.index()]));
        let write_box = |out: &mut Text, tag: usize, Bbox { min: [x0, y0], max: [x1, y1] }: Bbox| {
            let _ = write!(out, "{tag} {x0} {y0} 0 {x1} {y1} 0");
        };
        let write_list = |out: &mut Text, tags: &[String]| {
            let _ = write!(out, " {}", tags.len());
            for tag in tags {
                let _ = write!(out, " {tag}");
            }
        };
        // Every end of a curve is a point.
        let point = |node: NodeId| model.points.binary_search(&node).map_or(0, |k| k + 1);
        self.section("Entities", |out| {
            let _ = writeln!(out, "{} {} {} 0", model.points.len(), model.curves.len(), model.surfaces.len());
            for (k, node) in model.points.iter().enumerate() {
                let [x, y]: Point = model.xy[node.index()];
                let _ = writeln!(out, "{} {x} {y} 0 0", k + 1);
            }
            for (k, curve) in model.curves.iter().enumerate() {
                write_box(out, k + 1, envelope(&curve.nodes));
                write_list(out, &curve.groups.iter().map(|group| (group + 1).to_string()).collect::<Vec<_>>());
                let ends = curve.nodes.first().zip(curve.nodes.last());
                // The end has the sign that says that the curve leads there.
                let ends = ends.map(|(&from, &to)| [point(from).to_string(), format!("-{}", point(to))]);
                write_list(out, ends.as_ref().map_or(&[][..], |ends| ends));
                out.push("\n");
            }
            for (k, surface) in model.surfaces.iter().enumerate() {
                write_box(out, k + 1, surface.envelope);
                write_list(out, &[(k + 1).to_string()]);
                let sign = |is_reversed: bool| if is_reversed { "-" } else { "" };
                let bounds = surface.bounds.iter().map(|b| format!("{}{}", sign(b.is_reversed), b.curve + 1));
                write_list(out, &bounds.collect::<Vec<_>>());
                out.push("\n");
            }
        });
    }

    fn nodes(&mut self, model: &Model) {
        let blocks = || model.owners.chunk_by(|p, q| p.0 == q.0);
        self.section("Nodes", |out| {
            let n_nodes = model.xy.len();
            let _ = writeln!(out, "{} {n_nodes} 1 {n_nodes}", blocks().count());
            for block in blocks() {
                let (dimension, tag) = match block[0].0 {
                    Entity::Point(k) => (0, k + 1),
                    Entity::Curve(k) => (1, k + 1),
                    Entity::Surface(k) => (2, k + 1),
                };
                let _ = writeln!(out, "{dimension} {tag} 0 {}", block.len());
                for (_, node) in block {
                    integers(out, [node.index() + 1]);
                }
                for (_, node) in block {
                    let [x, y] = model.xy[node.index()];
                    out.number(x);
                    out.push(" ");
                    out.number(y);
                    out.push(" 0\n");
                }
            }
        });
    }

    /// Lines come first, as the format has it, but triangles have the first numbers: those of mesh.vtu, from 1.
    fn elements(&mut self, model: &Model, parts: &[&MeshPart]) {
        let n_triangles: usize = parts.iter().map(|part| part.mesh.n_triangles()).sum();
        let n_lines: usize = model.curves.iter().map(|curve| curve.nodes.len() - 1).sum();
        self.section("Elements", |out| {
            let n = n_triangles + n_lines;
            let _ = writeln!(out, "{} {n} 1 {n}", model.curves.len() + parts.len());
            let mut tag = n_triangles;
            for (k, curve) in model.curves.iter().enumerate() {
                let _ = writeln!(out, "1 {} {LINE} {}", k + 1, curve.nodes.len() - 1);
                for pair in curve.nodes.windows(2) {
                    tag += 1;
                    let _ = writeln!(out, "{tag} {} {}", pair[0].index() + 1, pair[1].index() + 1);
                }
            }
            tag = 0;
            for (k, part) in parts.iter().enumerate() {
                let _ = writeln!(out, "2 {} {TRIANGLE} {}", k + 1, part.mesh.n_triangles());
                for nodes in model.triangles(k, part) {
                    tag += 1;
                    let [a, b, c] = nodes.map(|node| node.index() + 1);
                    integers(out, [tag, a, b, c]);
                }
            }
        });
    }

    /// A scalar by subdomain and node of that.
    fn view(&mut self, name: &str, model: &Model, parts: &[&MeshPart], value: impl Fn(usize, NodeId) -> f64) {
        let head = |out: &mut Text, n_rows: usize| {
            // One string, the name; one real, the time 0; three integers: step 0, one component, how many rows.
            let _ = writeln!(out, "1\n\"{name}\"\n1\n0\n3\n0\n1\n{n_rows}");
        };
        if model.is_welded {
            self.section("ElementNodeData", |out| {
                head(out, parts.iter().map(|part| part.mesh.n_triangles()).sum());
                let triangles =
                    parts.iter().enumerate().flat_map(|(k, p)| p.mesh.tri_nodes().iter().map(move |t| (k, t)));
                for (tag, (k, nodes)) in triangles.enumerate() {
                    out.integer(tag + 1);
                    out.push(" 3");
                    for node in nodes {
                        out.push(" ");
                        out.number(value(k, *node));
                    }
                    out.push("\n");
                }
            });
        } else {
            self.section("NodeData", |out| {
                let values: Vec<f64> = (parts.iter().enumerate())
                    .flat_map(|(k, part)| (0..part.mesh.cloud().n_nodes()).map(move |node| (k, NodeId::of(node))))
                    .map(|(k, node)| value(k, node))
                    .collect();
                head(out, values.len());
                // In the order of $Nodes, which readers that skip the numbers count on.
                for (_, node) in &model.owners {
                    out.integer(node.index() + 1);
                    out.push(" ");
                    out.number(values[node.index()]);
                    out.push("\n");
                }
            });
        }
    }
}

/// A line of whole numbers.
fn integers<const N: usize>(out: &mut Text, numbers: [usize; N]) {
    for (k, number) in numbers.into_iter().enumerate() {
        out.push(if k > 0 { " " } else { "" });
        out.integer(number);
    }
    out.push("\n");
}

#[cfg(test)]
mod tests;
