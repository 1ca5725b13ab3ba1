//! From a problem file to the torsion of a section: the facade of the nmt crates.
