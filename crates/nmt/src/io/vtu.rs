//! mesh.vtu: VTK's XML format for unstructured grids, all subdomains in one grid.

use crate::io::fields::NodeFields;
use crate::io::stars::StarArrays;
use crate::io::text::Text;
use crate::pipeline::MeshPart;
use nmt_cloud::NodeKind;
use nmt_geom::NodeId;
use nmt_tri::{Mesh, shape};
use std::fmt::Write as _;
use std::io::{self, Write};

/// VTK's number for a triangle.
const VTK_TRIANGLE: u8 = 5;

/// The meshes with point data `node, kind` and cell data `subdomain, area, quality`.
///
/// `kind` is 0 for a vertex, 1 for an edge node, 2 for an interior node; `subdomain` counts from 0.
///
/// # Errors
/// Those of `sink`.
pub fn vtu_of_meshes(sink: &mut dyn Write, parts: &[MeshPart]) -> io::Result<()> {
    let meshes: Vec<&Mesh> = parts.iter().map(|part| &part.mesh).collect();
    let mut grid = Grid::open(sink, &meshes);
    grid.point_data(&meshes);
    grid.out.push("</PointData>\n");
    grid.cell_data(&meshes);
    grid.close()
}

/// The meshes with the solution: its fields (`F, tau_zx, tau_zy, tau` of torsion) and the stars of the equations (`star_size, star_order,
/// star_radius, star_condition, star_hidden, star_diagonal, star_residual`, 0 where a node has none) at nodes, `residual`
/// of the differential equation at centroids, and where errors are estimated what each triangle contributes to that of J,
/// `error_indicator`.
///
/// # Errors
/// Those of `sink`.
pub fn vtu_of_solutions(sink: &mut dyn Write, parts: &[NodeFields]) -> io::Result<()> {
    let meshes: Vec<&Mesh> = parts.iter().map(|fields| &fields.part.mesh).collect();
    let mut grid = Grid::open(sink, &meshes);
    grid.point_data(&meshes);
    for (k, (name, _)) in parts.first().map_or(&[][..], |fields| &fields.at_nodes).iter().enumerate() {
        grid.numbers(name, parts.iter().flat_map(|fields| fields.at_nodes[k].1.iter().copied()));
    }
    let stars: Vec<StarArrays> = parts.iter().map(StarArrays::of).collect();
    grid.integers("star_size", "Int64", stars.iter().flat_map(|s| s.size.iter().copied()));
    grid.integers("star_order", "Int64", stars.iter().flat_map(|s| s.order.iter().copied()));
    grid.numbers("star_radius", stars.iter().flat_map(|s| s.radius.iter().copied()));
    grid.numbers("star_condition", stars.iter().flat_map(|s| s.condition.iter().copied()));
    grid.integers("star_hidden", "Int64", stars.iter().flat_map(|s| s.hidden.iter().copied()));
    grid.integers("star_diagonal", "Int64", stars.iter().flat_map(|s| s.diagonal.iter().copied()));
    grid.numbers("star_residual", stars.iter().flat_map(|s| s.residual.iter().copied()));
    grid.out.push("</PointData>\n");
    grid.cell_data(&meshes);
    grid.numbers("residual", parts.iter().flat_map(|fields| fields.residual.iter().copied()));
    if parts.iter().any(|fields| fields.error_indicator.is_some()) {
        let indicators = parts.iter().flat_map(|fields| match &fields.error_indicator {
            Some(own) => own.clone(),
            None => vec![0.0; fields.part.mesh.n_triangles()],
        });
        grid.numbers("error_indicator", indicators);
    }
    grid.close()
}

struct Grid<'w> {
    out: Text<'w>,
}

impl<'w> Grid<'w> {
    fn open(sink: &'w mut dyn Write, meshes: &[&Mesh]) -> Self {
        let n_nodes: usize = meshes.iter().map(|mesh| mesh.cloud().n_nodes()).sum();
        let n_triangles: usize = meshes.iter().map(|mesh| mesh.n_triangles()).sum();
        let mut grid = Self { out: Text::to(sink) };
        grid.out.push("<?xml version=\"1.0\"?>\n");
        grid.out.push("<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n");
        // Writing to a text cannot fail; its end tells.
        let _ = write!(
            grid.out,
            "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{n_nodes}\" NumberOfCells=\"{n_triangles}\">\n<Points>\n"
        );
        let points = meshes.iter().flat_map(|mesh| mesh.xy()).flat_map(|p| [p[0], p[1], 0.0]);
        grid.array("Points", "Float64", " NumberOfComponents=\"3\"", points, Text::number);
        grid.out.push("</Points>\n<Cells>\n");
        let mut first = 0;
        let mut connectivity = Vec::with_capacity(3 * n_triangles);
        for mesh in meshes {
            connectivity.extend(mesh.tri_nodes().iter().flatten().map(|node| node.index() + first));
            first += mesh.cloud().n_nodes();
        }
        grid.integers("connectivity", "Int64", connectivity);
        grid.integers("offsets", "Int64", (1..=n_triangles).map(|t| 3 * t));
        grid.integers("types", "UInt8", (0..n_triangles).map(|_| VTK_TRIANGLE));
        grid.out.push("</Cells>\n");
        grid
    }

    fn point_data(&mut self, meshes: &[&Mesh]) {
        self.out.push("<PointData>\n");
        self.integers("node", "Int64", meshes.iter().flat_map(|mesh| 0..mesh.cloud().n_nodes()));
        let kind = |mesh: &Mesh, node: usize| match mesh.cloud().kind(NodeId::of(node)) {
            NodeKind::Vertex => 0,
            NodeKind::Edge => 1,
            NodeKind::Interior => 2,
        };
        let kinds = meshes.iter().flat_map(|mesh| (0..mesh.cloud().n_nodes()).map(move |node| kind(mesh, node)));
        self.integers("kind", "Int64", kinds);
    }

    fn cell_data(&mut self, meshes: &[&Mesh]) {
        self.out.push("<CellData>\n");
        let numbers = meshes.iter().enumerate().flat_map(|(k, mesh)| std::iter::repeat_n(k, mesh.n_triangles()));
        self.integers("subdomain", "Int64", numbers);
        self.numbers("area", meshes.iter().flat_map(|mesh| mesh.triangles().map(|t| mesh.area(t))));
        self.numbers("quality", meshes.iter().flat_map(|mesh| mesh.triangles().map(|t| shape(mesh, t))));
    }

    fn integers<T: itoa::Integer>(&mut self, name: &str, kind: &str, values: impl IntoIterator<Item = T>) {
        self.array(name, kind, "", values, Text::integer);
    }

    /// Numbers are written in the shortest form that reads back to the same bits.
    fn numbers(&mut self, name: &str, values: impl IntoIterator<Item = f64>) {
        self.array(name, "Float64", "", values, Text::number);
    }

    fn array<T>(
        &mut self,
        name: &str,
        kind: &str,
        more: &str,
        values: impl IntoIterator<Item = T>,
        write: impl Fn(&mut Text<'w>, T),
    ) {
        let _ = writeln!(self.out, "<DataArray type=\"{kind}\" Name=\"{name}\"{more} format=\"ascii\">");
        for (k, value) in values.into_iter().enumerate() {
            write(&mut self.out, value);
            self.out.push(if k % 12 == 11 { "\n" } else { " " });
        }
        self.out.push("\n</DataArray>\n");
    }

    fn close(mut self) -> io::Result<()> {
        self.out.push("</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        self.out.finish()
    }
}
