//! Targeted operations and development.

mod set_targeted_dev_spend;
mod set_targeted_ops_spend;

pub use set_targeted_dev_spend::SetTargetedDevSpend;
pub use set_targeted_ops_spend::SetTargetedOpsSpend;
