//! edges.csv: τ along every edge, one row a node.

use super::csv::quoted;
use crate::edges::{EdgeTable, loop_name};
use crate::pipeline::SolvedPart;
use std::fmt::Write as _;

/// `subdomain,edge,loop,node,x,y,s,fraction,tau_zx,tau_zy,tau,tau_t,tau_n,singular`: edge after edge in the order of the
/// file, on each its nodes from its first vertex to its last, both included, with 17 significant digits.
///
/// `s` is the arc length along the true edge (user's length unit), `fraction` the same over the edge's length; `tau_t` is τ
/// along the tangent, which leads as `s` does, `tau_n` along the outward normal: 0 but for the error of the solution.
/// `singular` is 1 at vertices where the exact τ is infinite. `loop` is `contour` or the hole's name.
pub fn csv_of_edges(parts: &[SolvedPart]) -> String {
    let mut out = String::from("subdomain,edge,loop,node,x,y,s,fraction,tau_zx,tau_zy,tau,tau_t,tau_n,singular\n");
    for solved in parts {
        let (table, name) = (EdgeTable::of(solved), quoted(&solved.part.name));
        for edge in &table.edges {
            let edge_name = solved.part.edge_names.get(edge.edge.index()).map_or(String::new(), |name| quoted(name));
            let ring = quoted(loop_name(solved, edge.ring));
            for p in &edge.points {
                let [x, y] = solved.part.mesh.xy()[p.node.index()];
                let tau = [p.stress.zx, p.stress.zy, p.stress.magnitude(), p.tangential, p.normal];
                // Writing to a string cannot fail.
                let _ = write!(out, "{name},{edge_name},{ring},{}", p.node.0);
                for value in [x, y, p.s, p.fraction].into_iter().chain(tau) {
                    let _ = write!(out, ",{value:.16e}");
                }
                let _ = writeln!(out, ",{}", u8::from(table.is_singular(p.node)));
            }
        }
    }
    out
}
