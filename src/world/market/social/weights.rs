//! Weights that determine which customers are selected as authors of posts
//! (docs/mechanics/market/social/crowd.md#weights).

use crate::params::SocialParams;

/// Inputs of a subscriber's post weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PostWeightInputs {
    /// Satisfaction after today's update.
    pub satisfaction: f64,
    /// Today's change in satisfaction.
    pub change: f64,
    /// Whether the group is an influencer group.
    pub influencer: bool,
    /// Days since the subscription started.
    pub days_subscribed: u32,
    /// Number of problems today: overload, outage, issue, quota.
    pub events: u32,
    /// Whether an unhappy enterprise is locked in by a contract.
    pub contract_locked: bool,
    /// Number of whole seats.
    pub seats: f64,
}

/// Returns the post weight of a subscriber.
#[inline]
pub fn post_weight(inputs: &PostWeightInputs, params: &SocialParams) -> f64 {
    let s = inputs.satisfaction;
    let mut weight = 1.0 + params.weight_abs_satisfaction_coef * s.abs();
    if s < 0.0 {
        weight *= 1.0 + params.weight_negative_satisfaction_sq_coef * s * s;
    }
    if inputs.influencer {
        weight *= params.weight_influencer_multiplier;
    }
    if inputs.days_subscribed <= params.weight_new_customer_max_days {
        weight *= params.weight_new_customer_multiplier;
    }
    if inputs.change.abs() >= params.satisfaction_change_threshold {
        weight *= 1.0 + params.weight_satisfaction_change_coef * inputs.change.abs();
    }
    if inputs.events > 0 {
        weight *= 1.0 + params.weight_active_event_coef * f64::from(inputs.events);
    }
    if inputs.contract_locked {
        weight *= params.contract_dissatisfaction_reputation_multiplier;
    }
    replace_nonfinite(weight * inputs.seats.max(1.0), params)
}

/// Returns the post weight of an individual who cancelled today.
pub fn cancelled_weight(satisfaction: f64, seats: f64, params: &SocialParams) -> f64 {
    let bad = satisfaction.min(0.0).abs();
    replace_nonfinite(
        params.churn_weight_base * seats * (1.0 + params.churn_weight_negative_satisfaction_coef * bad),
        params,
    )
}

/// Returns the post weight of an enterprise that was lost today.
pub fn lost_company_weight(seats: f64, params: &SocialParams) -> f64 {
    replace_nonfinite(params.enterprise_churn_weight_base * seats.max(1.0), params)
}

#[inline]
fn replace_nonfinite(weight: f64, params: &SocialParams) -> f64 {
    if weight.is_finite() { weight } else { params.weight_nonfinite_replacement }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    const PLAIN: PostWeightInputs = PostWeightInputs {
        satisfaction: 0.0,
        change: 0.0,
        influencer: false,
        days_subscribed: 100,
        events: 0,
        contract_locked: false,
        seats: 1.0,
    };

    #[test]
    fn post_weight_multiplies_its_factors() {
        let params = Params::bundled().social;
        for (inputs, expected) in [
            (PLAIN, 1.0),
            (PostWeightInputs { satisfaction: 0.3, ..PLAIN }, 4.0),
            (PostWeightInputs { satisfaction: -0.3, ..PLAIN }, 11.2),
            (PostWeightInputs { satisfaction: -0.3, influencer: true, days_subscribed: 10, ..PLAIN }, 33.6),
            (PostWeightInputs { satisfaction: 0.1, change: 0.02, ..PLAIN }, 2.8),
            (PostWeightInputs { satisfaction: 0.1, change: -0.05, events: 2, ..PLAIN }, 44.0),
            (
                PostWeightInputs {
                    satisfaction: -0.25,
                    events: 1,
                    contract_locked: true,
                    seats: 80.0,
                    ..PLAIN
                },
                5670.0,
            ),
            (
                PostWeightInputs {
                    satisfaction: 0.2,
                    influencer: true,
                    days_subscribed: 30,
                    seats: 500.0,
                    ..PLAIN
                },
                4500.0,
            ),
            (PostWeightInputs { satisfaction: -40.0, ..PLAIN }, 12_832_401.0),
        ] {
            let weight = post_weight(&inputs, &params);
            assert!((weight / expected - 1.0).abs() < 1e-12, "{inputs:?}: got {weight}, expected {expected}");
        }
        assert_eq!(cancelled_weight(-0.2, 1.0, &params), 15.0);
        assert_eq!(cancelled_weight(0.3, 1.0, &params), 5.0);
        assert_eq!(lost_company_weight(120.0, &params), 960.0);
        assert_eq!(lost_company_weight(0.0, &params), 8.0);
        assert_eq!(post_weight(&PostWeightInputs { satisfaction: f64::INFINITY, ..PLAIN }, &params), 1e6);
    }
}
