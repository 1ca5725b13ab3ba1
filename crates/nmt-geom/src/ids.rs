//! Row numbers with a type each, so that a triangle cannot be taken for a node.
//!
//! They are 32 bits wide: a problem may have up to 10⁸ grid points, and the mesh of a million nodes holds six
//! million of them.

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// The id of row `index`.
            #[inline]
            pub fn of(index: usize) -> Self {
                debug_assert!(u32::try_from(index).is_ok());
                Self(index as u32)
            }

            /// The row, for indexing.
            #[inline]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id! {
    /// A node of one cloud, counted from 0.
    NodeId
}
id! {
    /// A triangle of one mesh, counted from 0.
    TriId
}
id! {
    /// An edge of the outline of one subdomain: those of the main contour first, then of each hole, counted from 0.
    EdgeId
}
id! {
    /// A closed loop of the boundary: 0 is the main contour, k the k-th hole.
    LoopId
}
id! {
    /// A subdomain of a problem, counted from 0.
    SubdomainId
}
