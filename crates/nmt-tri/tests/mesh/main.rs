//! Whole meshes on whole sections: the invariants on hard regions, the Delaunay property and the look-up of triangles
//! recomputed by brute force.

mod delaunay;
mod faults;
mod invariants;
mod lattice;
mod locate;
mod sections;
mod smoothing;
mod unconstrained;
