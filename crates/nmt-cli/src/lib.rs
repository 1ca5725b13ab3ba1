//! The command nmt.
