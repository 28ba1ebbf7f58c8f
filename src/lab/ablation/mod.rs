//! Effect of competitors that copy shared development and drain targeted development (docs/laboratory/ablation.md).

mod exhibit;
mod probes;
mod rivals;
#[cfg(test)]
mod tests;

pub use exhibit::{Axis, SHORT_DAYS, ShortRun, ablation_exhibit};
pub use probes::{shared_probe, short_run_policies, targeted_probe};
pub use rivals::{COPY, DRAIN, RivalSetting, arms};
