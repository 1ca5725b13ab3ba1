//! The command `nmt`.
fn main() {}
