//! Conditions on the figures of a day.

use std::fmt;

use super::measure::Quantity;
use super::measured_days::MeasuredDay;

/// An operator that compares a figure with a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComparisonOperator {
    /// Greater than, `>`.
    Above,
    /// Greater than or equal to, `>=`.
    AtLeast,
    /// Less than, `<`.
    Below,
    /// Less than or equal to, `<=`.
    AtMost,
}

impl ComparisonOperator {
    /// Returns the operator as written in conditions.
    pub fn symbol(self) -> &'static str {
        match self {
            ComparisonOperator::Above => ">",
            ComparisonOperator::AtLeast => ">=",
            ComparisonOperator::Below => "<",
            ComparisonOperator::AtMost => "<=",
        }
    }

    /// Returns whether `value` and `threshold`, in this order, satisfy the comparison.
    pub fn is_satisfied(self, value: f64, threshold: f64) -> bool {
        match self {
            ComparisonOperator::Above => value > threshold,
            ComparisonOperator::AtLeast => value >= threshold,
            ComparisonOperator::Below => value < threshold,
            ComparisonOperator::AtMost => value <= threshold,
        }
    }
}

/// A direction in which a figure changes from one day to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// An increase from the day before.
    Rises,
    /// A decrease from the day before.
    Falls,
}

impl Direction {
    /// Returns the keyword that conditions use for the direction.
    pub fn name(self) -> &'static str {
        match self {
            Direction::Rises => "rises",
            Direction::Falls => "falls",
        }
    }
}

/// A world event that a condition can test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorldEvent {
    /// An improvement by a competitor on the day.
    Competitor,
    /// A drift of customers' requirements and budgets on the day.
    Drift,
    /// A demand surge that is active on the day.
    Surge,
    /// An outage on the day.
    Outage,
}

impl WorldEvent {
    /// All world events that a condition can test.
    pub const ALL: [WorldEvent; 4] =
        [WorldEvent::Competitor, WorldEvent::Drift, WorldEvent::Surge, WorldEvent::Outage];

    /// Returns the word that conditions use for the event.
    pub fn id(self) -> &'static str {
        ["rival", "drift", "surge", "outage"][self as usize]
    }

    fn happens_on(self, day: &MeasuredDay) -> bool {
        match self {
            WorldEvent::Competitor => day.has_competitor_move,
            WorldEvent::Drift => day.has_drift,
            WorldEvent::Surge => day.has_surge,
            WorldEvent::Outage => day.figures.outage,
        }
    }
}

/// A condition that is evaluated for a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// A comparison of a figure with a threshold.
    Compared(Quantity, ComparisonOperator, f64),
    /// A change in a figure compared with the day before.
    Changed(Quantity, Direction),
    /// An event. The condition is true on days on which the event occurs.
    Event(WorldEvent),
}

impl Condition {
    /// Returns the figure of the condition, or `None` for an event.
    pub fn quantity(&self) -> Option<&Quantity> {
        match self {
            Condition::Compared(quantity, ..) | Condition::Changed(quantity, _) => Some(quantity),
            Condition::Event(_) => None,
        }
    }

    /// Evaluates the condition on a day. `days` starts with day 1.
    pub(crate) fn evaluate(&self, days: &[MeasuredDay], day: u32) -> ConditionState {
        let before = day.saturating_sub(1);
        let at = |day: u32| self.quantity().and_then(|quantity| quantity.value(days, day));
        let (value, value_before) = (at(day), at(before));
        let is_over_days = self.quantity().is_some_and(|quantity| quantity.days() > 1);
        ConditionState {
            day,
            is_first_value: is_over_days && value.is_some() && value_before.is_none(),
            value,
            before: value_before,
            is_true: self.is_true_on(days, day),
            was_true: self.is_true_on(days, before),
        }
    }

    /// Returns whether the condition is true on a day. The condition is false on day 0 and if the figure has no value.
    fn is_true_on(&self, days: &[MeasuredDay], day: u32) -> bool {
        let at = |quantity: &Quantity, day: u32| quantity.value(days, day);
        match self {
            Condition::Compared(quantity, relation, threshold) => {
                at(quantity, day).is_some_and(|value| relation.is_satisfied(value, *threshold))
            }
            Condition::Changed(quantity, direction) => {
                let pair = at(quantity, day).zip(at(quantity, day.saturating_sub(1)));
                pair.is_some_and(|(value, before)| match direction {
                    Direction::Rises => value > before,
                    Direction::Falls => value < before,
                })
            }
            Condition::Event(event) => {
                let measured_day = day.checked_sub(1).and_then(|at| days.get(at as usize));
                measured_day.is_some_and(|measured_day| event.happens_on(measured_day))
            }
        }
    }
}

/// Formats a condition: `churn(S1) > 0.05 over 7`, `reputation(S3) falls` or `event rival`.
impl fmt::Display for Condition {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Condition::Compared(quantity, relation, threshold) => {
                let (sign, span) = (relation.symbol(), quantity.describe_days());
                // Replaces -0 by 0, and uses exponents for large numbers.
                match threshold + 0.0 {
                    large if large.abs() >= 1e15 => write!(formatter, "{quantity} {sign} {large:e}{span}"),
                    plain => write!(formatter, "{quantity} {sign} {plain}{span}"),
                }
            }
            Condition::Changed(quantity, direction) => {
                write!(formatter, "{quantity} {}{}", direction.name(), quantity.describe_days())
            }
            Condition::Event(event) => write!(formatter, "event {}", event.id()),
        }
    }
}

/// The state of a condition on a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConditionState {
    /// Day on which the condition is evaluated, from 1.
    pub day: u32,
    /// Value of the figure on the day; `None` for an event or if the figure has no value.
    pub value: Option<f64>,
    /// Value of the figure on the previous day; `None` if the figure had no value on that day.
    pub before: Option<f64>,
    /// Whether the condition is true on the day.
    pub is_true: bool,
    /// Whether the condition was true on the previous day.
    pub was_true: bool,
    /// Whether the day has the first value of a figure over several days, or the first value after a gap.
    pub is_first_value: bool,
}

impl ConditionState {
    /// Returns whether the condition became true on the day. The first value of a figure over several days does not
    /// count, because the condition could not be evaluated before.
    pub fn becomes_true(&self) -> bool {
        self.is_true && !self.was_true && !self.is_first_value
    }
}
