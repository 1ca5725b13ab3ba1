//! mesh.vtu: VTK's XML format for unstructured grids, all subdomains in one grid.

use crate::io::fields::NodeFields;
use crate::io::stars::StarArrays;
use crate::pipeline::MeshPart;
use nmt_cloud::NodeKind;
use nmt_geom::NodeId;
use nmt_tri::{Mesh, shape};
use std::fmt::{Display, Write as _};

/// VTK's number for a triangle.
const VTK_TRIANGLE: u8 = 5;

/// The meshes with point data `node, kind` and cell data `subdomain, area, quality`.
///
/// `kind` is 0 for a vertex, 1 for an edge node, 2 for an interior node; `subdomain` counts from 0.
pub fn vtu_of_meshes(parts: &[MeshPart]) -> String {
    let meshes: Vec<&Mesh> = parts.iter().map(|part| &part.mesh).collect();
    let mut grid = Grid::open(&meshes);
    grid.point_data(&meshes);
    grid.out.push_str("</PointData>\n");
    grid.cell_data(&meshes);
    grid.close()
}

/// The meshes with the solution: its fields (`F, tau_zx, tau_zy, tau` of torsion) and the stars of the equations (`star_size, star_order,
/// star_radius, star_condition, star_hidden, star_diagonal, star_residual`, 0 where a node has none) at nodes, `residual`
/// of the differential equation at centroids.
pub fn vtu_of_solutions(parts: &[NodeFields]) -> String {
    let meshes: Vec<&Mesh> = parts.iter().map(|fields| &fields.part.mesh).collect();
    let mut grid = Grid::open(&meshes);
    grid.point_data(&meshes);
    for (k, (name, _)) in parts.first().map_or(&[][..], |fields| &fields.at_nodes).iter().enumerate() {
        grid.array(name, "Float64", parts.iter().flat_map(|fields| fields.at_nodes[k].1.iter().copied()));
    }
    let stars: Vec<StarArrays> = parts.iter().map(StarArrays::of).collect();
    grid.array("star_size", "Int64", stars.iter().flat_map(|s| &s.size));
    grid.array("star_order", "Int64", stars.iter().flat_map(|s| &s.order));
    grid.array("star_radius", "Float64", stars.iter().flat_map(|s| &s.radius));
    grid.array("star_condition", "Float64", stars.iter().flat_map(|s| &s.condition));
    grid.array("star_hidden", "Int64", stars.iter().flat_map(|s| &s.hidden));
    grid.array("star_diagonal", "Int64", stars.iter().flat_map(|s| &s.diagonal));
    grid.array("star_residual", "Float64", stars.iter().flat_map(|s| &s.residual));
    grid.out.push_str("</PointData>\n");
    grid.cell_data(&meshes);
    grid.array("residual", "Float64", parts.iter().flat_map(|fields| fields.residual.iter().copied()));
    grid.close()
}

struct Grid {
    out: String,
}

impl Grid {
    fn open(meshes: &[&Mesh]) -> Self {
        let n_nodes: usize = meshes.iter().map(|mesh| mesh.cloud().n_nodes()).sum();
        let n_triangles: usize = meshes.iter().map(|mesh| mesh.n_triangles()).sum();
        let mut grid = Self { out: String::new() };
        grid.out.push_str("<?xml version=\"1.0\"?>\n");
        grid.out.push_str("<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n");
        // Writing to a string cannot fail.
        let _ = write!(
            grid.out,
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{n_nodes}\" NumberOfCells=\"{n_triangles}\">\n<Points>\n"
        );
        let points = meshes.iter().flat_map(|mesh| mesh.xy()).flat_map(|p| [p[0], p[1], 0.0]);
        grid.array_of("Points", "Float64", " NumberOfComponents=\"3\"", points);
        grid.out.push_str("</Points>\n<Cells>\n");
        let mut first = 0;
        let mut connectivity = Vec::with_capacity(3 * n_triangles);
        for mesh in meshes {
            connectivity.extend(mesh.tri_nodes().iter().flatten().map(|node| node.index() + first));
            first += mesh.cloud().n_nodes();
        }
        grid.array("connectivity", "Int64", connectivity);
        grid.array("offsets", "Int64", (1..=n_triangles).map(|t| 3 * t));
        grid.array("types", "UInt8", (0..n_triangles).map(|_| VTK_TRIANGLE));
        grid.out.push_str("</Cells>\n");
        grid
    }

    fn point_data(&mut self, meshes: &[&Mesh]) {
        self.out.push_str("<PointData>\n");
        self.array("node", "Int64", meshes.iter().flat_map(|mesh| 0..mesh.cloud().n_nodes()));
        let kind = |mesh: &Mesh, node: usize| match mesh.cloud().kind(NodeId::of(node)) {
            NodeKind::Vertex => 0,
            NodeKind::Edge => 1,
            NodeKind::Interior => 2,
        };
        let kinds = meshes.iter().flat_map(|mesh| (0..mesh.cloud().n_nodes()).map(move |node| kind(mesh, node)));
        self.array("kind", "Int64", kinds);
    }

    fn cell_data(&mut self, meshes: &[&Mesh]) {
        self.out.push_str("<CellData>\n");
        let numbers = meshes.iter().enumerate().flat_map(|(k, mesh)| std::iter::repeat_n(k, mesh.n_triangles()));
        self.array("subdomain", "Int64", numbers);
        self.array("area", "Float64", meshes.iter().flat_map(|mesh| mesh.triangles().map(|t| mesh.area(t))));
        self.array("quality", "Float64", meshes.iter().flat_map(|mesh| mesh.triangles().map(|t| shape(mesh, t))));
    }

    fn array<T: Display>(&mut self, name: &str, kind: &str, values: impl IntoIterator<Item = T>) {
        self.array_of(name, kind, "", values);
    }

    /// Numbers are written in the shortest form that reads back to the same bits.
    fn array_of<T: Display>(&mut self, name: &str, kind: &str, more: &str, values: impl IntoIterator<Item = T>) {
        let _ = writeln!(self.out, "<DataArray type=\"{kind}\" Name=\"{name}\"{more} format=\"ascii\">");
        for (k, value) in values.into_iter().enumerate() {
            let end = if k % 12 == 11 { '\n' } else { ' ' };
            let _ = write!(self.out, "{value}{end}");
        }
        self.out.push_str("\n</DataArray>\n");
    }

    fn close(mut self) -> String {
        self.out.push_str("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        self.out
    }
}
