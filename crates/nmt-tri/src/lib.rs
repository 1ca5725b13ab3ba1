//! Triangular meshes of exactly the nodes of a given cloud.
