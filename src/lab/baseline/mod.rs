//! The paper's rule-based configurations, and custom grids (docs/laboratory/baseline.md).

mod grid;
mod report;
mod shared_runs;
#[cfg(test)]
mod tests;

pub use grid::{GridPoint, PolicyGrid};
pub use report::baseline_report;
pub use shared_runs::{is_shared_run, representative_configurations};

/// Name of the bundled grid with the paper's configurations.
pub const PAPER_GRID: &str = "paper";
