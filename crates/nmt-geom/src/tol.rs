//! Geometric tolerances, each relative and with its reason.

/// Points nearer than this fraction of the *size* are one point.
///
/// Rounding moves a point by 1e-15 of the size; the nodes of a cloud of 10⁸ are 1e-4 of it apart. 1e-9 is far from
/// both.
pub const SAME_POINT_REL: f64 = 1.0e-9;

/// Slack of the clearance tests, as a fraction of the *size* \[D7\].
///
/// A node exactly at the limit is kept although rounding (1e-16 of the coordinates, a few operations) moves it: 1e-12
/// is well above that, and far below any spacing.
pub const CLEARANCE_SLACK_REL: f64 = 1.0e-12;
