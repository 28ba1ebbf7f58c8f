//! The lead equation of a group on a day: factors, sources, and the probability of the actual number of leads.

use std::fmt;

use super::hidden_day::HiddenDay;
use super::inspector::Inspector;
use novamind_session::InspectionPermit;
use novamind_tools::Rejection;
use novamind_world::identifiers::{Channel, Group};
use novamind_world::market::leads::LeadFactors;

/// Number of days in a view, including the requested day.
pub(crate) const WINDOW_DAYS: u32 = 28;

/// A factor in the lead equation of a group (docs/mechanics/market/leads.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeadFactor {
    /// Reputation of the group.
    Reputation,
    /// Unused share of the group's market.
    Saturation,
    /// Factor of the weekday times factor of the day of the month.
    Calendar,
    /// Effect of the economy on leads.
    Economy,
    /// Reactions to the company's posts.
    Social,
    /// Effect of active demand surges.
    Surge,
}

impl LeadFactor {
    /// All lead factors, in the order of the equation.
    pub const ALL: [LeadFactor; 6] = [
        LeadFactor::Reputation,
        LeadFactor::Saturation,
        LeadFactor::Calendar,
        LeadFactor::Economy,
        LeadFactor::Social,
        LeadFactor::Surge,
    ];

    /// Returns the letter of the factor in the equation.
    pub fn letter(self) -> &'static str {
        ["R", "D", "C", "M", "A", "Z"][self as usize]
    }

    /// Returns the display name of the factor.
    pub fn name(self) -> &'static str {
        ["reputation", "unused market", "calendar", "economy", "own posts", "surges"][self as usize]
    }

    /// Returns the factor with the given letter.
    pub fn parse(letter: &str) -> Option<LeadFactor> {
        LeadFactor::ALL.into_iter().find(|factor| factor.letter().eq_ignore_ascii_case(letter))
    }

    fn factor_mut(self, factors: &mut LeadFactors) -> &mut f64 {
        match self {
            LeadFactor::Reputation => &mut factors.reputation,
            LeadFactor::Saturation => &mut factors.saturation,
            LeadFactor::Calendar => &mut factors.calendar,
            LeadFactor::Economy => &mut factors.economy,
            LeadFactor::Social => &mut factors.social,
            LeadFactor::Surge => &mut factors.surge,
        }
    }
}

impl fmt::Display for LeadFactor {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.letter())
    }
}

/// The lead equation of a group on a day: R D C M A Z (channels + word of mouth) = expected leads.
#[derive(Debug, Clone, PartialEq)]
pub struct LeadEquation {
    /// Group whose leads are described.
    pub group: Group,
    /// Day of the leads, from 1.
    pub day: u32,
    /// Whether the group had been discovered by the day. Undiscovered groups have no leads.
    pub is_known: bool,
    /// Word-of-mouth leads by source group, before the factors apply.
    pub word_of_mouth: Vec<(Group, f64)>,
    /// Actual leads of the day.
    pub actual_leads: u32,
    /// Whether the market cap is unlimited.
    pub has_unlimited_market: bool,
    factors: LeadFactors,
}

impl LeadEquation {
    fn new(group: Group, day: u32, seen: &HiddenDay) -> LeadEquation {
        LeadEquation {
            group,
            day,
            is_known: seen.known_groups[group],
            word_of_mouth: seen.word_of_mouth[group].clone(),
            actual_leads: seen.arrived_leads[group],
            has_unlimited_market: seen.groups[group].market_cap <= 0.0,
            factors: seen.lead_factors[group],
        }
    }

    /// Returns the value of a factor on the day.
    pub fn factor(&self, factor: LeadFactor) -> f64 {
        let mut factors = self.factors;
        *factor.factor_mut(&mut factors)
    }

    /// Returns each paid channel with its leads before the factors apply. Omits channels without leads.
    pub fn channels(&self) -> impl Iterator<Item = (Channel, f64)> {
        let paid = self.factors.paid;
        Channel::ALL
            .into_iter()
            .map(move |channel| (channel, paid[channel]))
            .filter(|(_, leads)| *leads > 0.0)
    }

    /// Returns the number of word-of-mouth leads before the factors apply.
    pub fn word_of_mouth_leads(&self) -> f64 {
        self.factors.network
    }

    /// Returns the expected leads, which are the mean of the Poisson distribution of the day's leads.
    pub fn expected_leads(&self) -> f64 {
        self.factors.expected()
    }

    /// Returns the number of leads that would be expected if the factors in `held` had the given values.
    pub fn expected_leads_with(&self, held: &[(LeadFactor, f64)]) -> f64 {
        let mut factors = self.factors;
        held.iter().for_each(|(factor, value)| *factor.factor_mut(&mut factors) = *value);
        factors.expected()
    }

    /// Returns the two-sided p-value of the actual leads, 0..=1: twice the smaller tail of the Poisson distribution
    /// with the expected leads as mean.
    pub fn p_value(&self) -> f64 {
        two_sided_p_value(self.expected_leads(), self.actual_leads)
    }
}

impl Inspector<'_> {
    /// Returns the lead equations of a group on a day, by default the last day, and on up to 27 earlier days. Records
    /// the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn lead_equations(&mut self, group: Group, day: Option<u32>) -> Result<Vec<LeadEquation>, Rejection> {
        let permit = InspectionPermit::start(self.run, "leads", group.id(), day)?;
        let day = permit.day();
        let first = (day + 1).saturating_sub(WINDOW_DAYS).max(1);
        let seen = self.hidden_days(&permit, first..=day)?;
        Ok((first..).zip(&seen).map(|(day, seen)| LeadEquation::new(group, day, seen)).collect())
    }
}

/// Returns twice the smaller tail of a Poisson distribution, at most 1. Each tail includes `number`.
fn two_sided_p_value(mean: f64, number: u32) -> f64 {
    if mean <= 0.0 {
        return if number == 0 { 1.0 } else { 0.0 };
    }
    let chance = |k: u32| {
        let k = f64::from(k);
        libm::exp(k * libm::log(mean) - mean - libm::lgamma(k + 1.0))
    };
    // The small tail is summed directly, because subtraction from 1 would lose precision.
    let tail: f64 = match f64::from(number) > mean {
        true => (number..).map(chance).take_while(|chance| *chance > 0.0).sum(),
        false => (0..=number).map(chance).sum(),
    };
    (2.0 * tail).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poisson_tails_match_published_values() {
        // For mean 3, P(X <= 2) = 0.423190, P(X >= 2) = 0.800852 and P(X >= 10) = 0.001102.
        for (mean, number, p) in [(3.0, 2, 0.846380), (3.0, 10, 0.002205), (3.0, 3, 1.0), (0.0, 0, 1.0)] {
            assert!(
                (two_sided_p_value(mean, number) - p).abs() < 2e-6,
                "{mean} {number}: {}",
                two_sided_p_value(mean, number)
            );
        }
        assert_eq!(two_sided_p_value(0.0, 1), 0.0);
        assert!((two_sided_p_value(20_000.0, 20_000) - 1.0).abs() < 1e-9);
        assert!(two_sided_p_value(20_000.0, 21_000) < 1e-11);
    }
}
