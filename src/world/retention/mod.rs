//! Retention: satisfaction, support issues, renewal decisions and billing.

pub mod billing;
pub mod issues;
pub mod plan_comparison;
pub mod renewal;
pub mod satisfaction;
mod support_pools;

use super::customers::columns::Block;
use super::customers::curve::{Curve, required_quality};
use super::identifiers::Group;
use super::morning::Morning;
use super::params::{DriftCounted, Params};

/// Updates the required quality that a row stores. The required quality is computed from the row's curve and current
/// price, the budget of the last bill and the group's budget drift. The market's expectations are not included.
///
/// The minimum budget applies only if the drift is not 0 (`docs/mechanics/retention/satisfaction.md`).
#[inline]
pub fn refresh_required(block: &mut Block, at: usize, c_drift: f64, params: &Params) {
    let (curve, remembered) = (block.curve(at), block.effective_c_max[at]);
    block.required[at] = required_at_price(&curve, remembered, block.effective_price[at], c_drift, params);
}

/// Returns the required quality at a price, with the group's budget drift. `remembered` is the budget of the last
/// bill, or 0 before the first bill.
#[inline]
pub fn required_at_price(curve: &Curve, remembered: f64, price: f64, c_drift: f64, params: &Params) -> f64 {
    let budget = if remembered != 0.0 { remembered } else { curve.c_max };
    let budget =
        if c_drift != 0.0 { (budget + c_drift).max(params.quality.read_time_c_max_min) } else { budget };
    required_quality(price, &curve.with_budget(budget), params)
}

/// Returns the positions of a block's subscribers who are billed today.
pub fn due_today(block: &Block, day: u32, params: &Params) -> Vec<usize> {
    block.due_positions((day % params.billing.billing_period_days) as u8)
}

/// Updates the required quality that each row of a block stores.
pub fn refresh_block(group: Group, block: &mut Block, morning: &Morning, params: &Params) {
    for at in 0..block.len() {
        refresh_required(block, at, morning.expectations[group].c_max, params);
    }
}

/// Returns the budget that is stored with a bill: max(15, c + dc), or max(15, c) if drift is counted once.
pub fn remembered_budget(c_max: f64, c_drift: f64, params: &Params) -> f64 {
    let drift = match params.fidelity.drift_counted {
        DriftCounted::EveryRead => c_drift,
        DriftCounted::Once => 0.0,
    };
    (c_max + drift).max(params.billing.billing_c_max_min)
}
