//! Why a group brought so many leads on a day: every factor, every source, and how likely what came was.

use std::fmt;

use super::hidden_day::HiddenDay;
use super::inspector::Inspector;
use novamind_session::Look;
use novamind_tools::Refusal;
use novamind_world::identifiers::{Channel, Group};
use novamind_world::market::leads::LeadFactors;

/// Days that are shown with one: it and the days before it.
pub(crate) const WINDOW_DAYS: u32 = 28;

/// A factor of the leads of a group (docs/mechanics/market/leads.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeadFactor {
    /// Reputation of the group.
    Reputation,
    /// Room left in its market.
    Saturation,
    /// Weekday times day of the month.
    Calendar,
    /// The economy.
    Economy,
    /// Reactions to the company's posts.
    Social,
    /// Demand surges.
    Surge,
}

impl LeadFactor {
    /// All factors, in the order of the equation.
    pub const ALL: [LeadFactor; 6] = [
        LeadFactor::Reputation,
        LeadFactor::Saturation,
        LeadFactor::Calendar,
        LeadFactor::Economy,
        LeadFactor::Social,
        LeadFactor::Surge,
    ];

    /// Its letter in the equation.
    pub fn letter(self) -> &'static str {
        ["R", "D", "C", "M", "A", "Z"][self as usize]
    }

    /// What it stands for.
    pub fn in_words(self) -> &'static str {
        ["reputation", "room in the market", "calendar", "economy", "own posts", "surges"][self as usize]
    }

    /// The factor with this letter.
    pub fn parse(letter: &str) -> Option<LeadFactor> {
        LeadFactor::ALL.into_iter().find(|factor| factor.letter().eq_ignore_ascii_case(letter))
    }

    fn of(self, factors: &mut LeadFactors) -> &mut f64 {
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

/// The leads of a group on a day: R D C M A Z (channels + word of mouth) = expected.
#[derive(Debug, Clone, PartialEq)]
pub struct LeadEquation {
    /// The group.
    pub group: Group,
    /// The day, from 1.
    pub day: u32,
    /// Whether the group was discovered; if not, it brought no leads.
    pub is_known: bool,
    /// Leads by word of mouth before the factors, by the group whose subscribers bring them.
    pub word_of_mouth: Vec<(Group, f64)>,
    /// Leads that came.
    pub came: u32,
    /// Whether its market has no size: whatever it holds, there is room.
    pub is_without_limit: bool,
    factors: LeadFactors,
}

impl LeadEquation {
    fn of(group: Group, day: u32, seen: &HiddenDay) -> LeadEquation {
        LeadEquation {
            group,
            day,
            is_known: seen.known[group],
            word_of_mouth: seen.word_of_mouth[group].clone(),
            came: seen.came[group],
            is_without_limit: seen.groups[group].market_cap <= 0.0,
            factors: seen.leads[group],
        }
    }

    /// A factor of the equation.
    pub fn factor(&self, factor: LeadFactor) -> f64 {
        let mut factors = self.factors;
        *factor.of(&mut factors)
    }

    /// Leads of paid channels before the factors, those that bring any.
    pub fn channels(&self) -> impl Iterator<Item = (Channel, f64)> {
        let paid = self.factors.paid;
        Channel::ALL
            .into_iter()
            .map(move |channel| (channel, paid[channel]))
            .filter(|(_, leads)| *leads > 0.0)
    }

    /// Leads by word of mouth before the factors.
    pub fn by_word_of_mouth(&self) -> f64 {
        self.factors.network
    }

    /// Expected leads: what the day's number was drawn around.
    pub fn expected(&self) -> f64 {
        self.factors.expected()
    }

    /// Expected leads if some factors were others.
    pub fn holding(&self, held: &[(LeadFactor, f64)]) -> f64 {
        let mut factors = self.factors;
        held.iter().for_each(|(factor, value)| *factor.of(&mut factors) = *value);
        factors.expected()
    }

    /// How likely a number at least as far out as the one that came is, two-sided, 0..=1: twice the smaller tail of the
    /// Poisson distribution around the expectation.
    pub fn p_value(&self) -> f64 {
        two_sided(self.expected(), self.came)
    }
}

impl Inspector<'_> {
    /// The leads of a group on a day (the last one if none is named), after those of up to 27 days before it. The look is
    /// recorded.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn lead_equations(&mut self, group: Group, day: Option<u32>) -> Result<Vec<LeadEquation>, Refusal> {
        let look = Look::begin(self.run, "leads", group.id(), day)?;
        let day = look.day();
        let first = (day + 1).saturating_sub(WINDOW_DAYS).max(1);
        let seen = self.hidden_days(&look, first..=day)?;
        Ok((first..).zip(&seen).map(|(day, seen)| LeadEquation::of(group, day, seen)).collect())
    }
}

/// Twice the smaller tail of a Poisson distribution, at most 1; the number itself belongs to both tails.
fn two_sided(mean: f64, number: u32) -> f64 {
    if mean <= 0.0 {
        return if number == 0 { 1.0 } else { 0.0 };
    }
    let chance = |k: u32| {
        let k = f64::from(k);
        libm::exp(k * libm::log(mean) - mean - libm::lgamma(k + 1.0))
    };
    // The small tail is summed itself: what is left of 1 would be rounding.
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
    fn tails_of_a_poisson_distribution_are_those_of_its_table() {
        // P(X <= 2) = 0.423190 and P(X >= 2) = 0.800852 around 3; P(X >= 10) = 0.001102.
        for (mean, number, p) in [(3.0, 2, 0.846380), (3.0, 10, 0.002205), (3.0, 3, 1.0), (0.0, 0, 1.0)] {
            assert!(
                (two_sided(mean, number) - p).abs() < 2e-6,
                "{mean} {number}: {}",
                two_sided(mean, number)
            );
        }
        assert_eq!(two_sided(0.0, 1), 0.0);
        assert!((two_sided(20_000.0, 20_000) - 1.0).abs() < 1e-9);
        assert!(two_sided(20_000.0, 21_000) < 1e-11);
    }
}
