//! Common edges of adjacent subdomains.
