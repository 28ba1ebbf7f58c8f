//! The paper's rule-based configurations, and custom grids (docs/laboratory/baseline.md).

mod exhibit;
mod grid;
mod shared_play;
#[cfg(test)]
mod tests;

pub use exhibit::baseline_exhibit;
pub use grid::{Grid, GridPoint};
pub use shared_play::{is_shared, leaders};

/// Name of the bundled grid with the paper's configurations.
pub const PAPER: &str = "paper";
