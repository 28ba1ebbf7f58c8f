//! Companies: `configs/world/enterprise.toml`.

use serde::{Deserialize, Serialize};

/// Negotiations (chapter 40 §1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Enterprise {
    /// Mean first bid as a share of the most a company would pay.
    pub enterprise_initial_offer_factor_mean: f64,
    /// Its spread.
    pub enterprise_initial_offer_factor_std: f64,
    /// Days without an answer that lose a lead or a customer.
    pub agent_response_timeout_days: u32,
}
