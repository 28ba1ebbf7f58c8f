//! The paper's rule-based configurations, and grids of one's own (docs/laboratory/baseline.md).

mod exhibit;
mod grid;
mod shared_play;
#[cfg(test)]
mod tests;

pub use exhibit::baseline_exhibit;
pub use grid::{Grid, GridPoint};
pub use shared_play::{is_shared, leaders};

/// Name of the shipped grid of the paper.
pub const PAPER: &str = "paper";
