//! Whole clouds on whole sections: what the reader of the paper may rely on, recomputed by other means.

mod clearance;
mod edges;
mod errors;
mod graded;
mod numbering;
mod random_regions;
mod randomising;
mod sections;
mod units;
