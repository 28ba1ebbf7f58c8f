//! The ablation: the effect of competitors that copy shared development and drain targeted development
//! (docs/laboratory/ablation.md).

mod competitors;
mod probes;
mod report;
#[cfg(test)]
mod tests;

pub use competitors::{COPY_SETTINGS, CompetitorSetting, DRAIN_SETTINGS, competitor_arms, rebase_arms};
pub use probes::{shared_development_probe, short_run_policies, targeted_development_probe};
pub use report::{AblationAxis, SHORT_DAYS, ShortRun, ablation_report};
