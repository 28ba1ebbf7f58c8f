//! A condition on the figures of a day.

use std::fmt;

use super::measure::Quantity;
use super::measured_days::MeasuredDay;

/// A comparison of a figure with a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// `>`
    Above,
    /// `>=`
    AtLeast,
    /// `<`
    Below,
    /// `<=`
    AtMost,
}

impl Relation {
    /// Returns the operator.
    pub fn symbol(self) -> &'static str {
        match self {
            Relation::Above => ">",
            Relation::AtLeast => ">=",
            Relation::Below => "<",
            Relation::AtMost => "<=",
        }
    }

    /// Returns whether the comparison is true.
    pub fn is_satisfied(self, value: f64, threshold: f64) -> bool {
        match self {
            Relation::Above => value > threshold,
            Relation::AtLeast => value >= threshold,
            Relation::Below => value < threshold,
            Relation::AtMost => value <= threshold,
        }
    }
}

/// The direction of a figure compared with the day before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// The figure is higher.
    Rises,
    /// The figure is lower.
    Falls,
}

impl Direction {
    /// Returns the keyword.
    pub fn name(self) -> &'static str {
        match self {
            Direction::Rises => "rises",
            Direction::Falls => "falls",
        }
    }
}

/// An event of a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorldEvent {
    /// A competitor move.
    Competitor,
    /// Drift of expectations and budgets.
    Drift,
    /// A demand surge is active.
    Surge,
    /// An outage.
    Outage,
}

impl WorldEvent {
    /// All events.
    pub const ALL: [WorldEvent; 4] =
        [WorldEvent::Competitor, WorldEvent::Drift, WorldEvent::Surge, WorldEvent::Outage];

    /// Returns the name in conditions.
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

/// A condition on a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// A figure is above or below a number.
    Compared(Quantity, Relation, f64),
    /// A figure differs from the day before.
    Changed(Quantity, Direction),
    /// An event occurs.
    Event(WorldEvent),
}

impl Condition {
    /// Returns the figure; `None` for an event.
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

    /// Returns whether the condition is true on a day. It is false if the figure has no value, and on day 0.
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

/// Writes `churn(S1) > 0.05 over 7`, `reputation(S3) falls` or `event rival`.
impl fmt::Display for Condition {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Condition::Compared(quantity, relation, threshold) => {
                let (sign, span) = (relation.symbol(), quantity.describe_days());
                // Removes the sign of zero, and uses exponents for large numbers.
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
    /// The day, from 1.
    pub day: u32,
    /// Value of the figure; `None` for an event, or without a value.
    pub value: Option<f64>,
    /// Value of the figure on the day before.
    pub before: Option<f64>,
    /// Whether the condition is true.
    pub is_true: bool,
    /// Whether the condition was true on the day before.
    pub was_true: bool,
    /// Whether a figure over several days has its first value, or its first value after a gap.
    pub is_first_value: bool,
}

impl ConditionState {
    /// Returns whether the condition became true on the day. The first value of a figure over several days is not a change, because its
    /// days were incomplete before.
    pub fn becomes_true(&self) -> bool {
        self.is_true && !self.was_true && !self.is_first_value
    }
}
