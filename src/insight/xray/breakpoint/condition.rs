//! A condition on the figures of a day.

use std::fmt;

use super::measure::Quantity;
use super::series::MeasuredDay;

/// How a figure is compared with a number.
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
    /// Its sign.
    pub fn sign(self) -> &'static str {
        match self {
            Relation::Above => ">",
            Relation::AtLeast => ">=",
            Relation::Below => "<",
            Relation::AtMost => "<=",
        }
    }

    /// Whether it holds.
    pub fn holds(self, value: f64, threshold: f64) -> bool {
        match self {
            Relation::Above => value > threshold,
            Relation::AtLeast => value >= threshold,
            Relation::Below => value < threshold,
            Relation::AtMost => value <= threshold,
        }
    }
}

/// How a figure moves against the day before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// It is higher.
    Rises,
    /// It is lower.
    Falls,
}

impl Direction {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Direction::Rises => "rises",
            Direction::Falls => "falls",
        }
    }
}

/// Something that happens on a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorldEvent {
    /// Rivals move.
    Rival,
    /// Expectations and budgets drift.
    Drift,
    /// A demand surge acts.
    Surge,
    /// The service is down.
    Outage,
}

impl WorldEvent {
    /// All of them.
    pub const ALL: [WorldEvent; 4] =
        [WorldEvent::Rival, WorldEvent::Drift, WorldEvent::Surge, WorldEvent::Outage];

    /// Its name in conditions.
    pub fn id(self) -> &'static str {
        ["rival", "drift", "surge", "outage"][self as usize]
    }

    fn happens_on(self, day: &MeasuredDay) -> bool {
        match self {
            WorldEvent::Rival => day.rival,
            WorldEvent::Drift => day.drift,
            WorldEvent::Surge => day.surge,
            WorldEvent::Outage => day.figures.outage,
        }
    }
}

/// What is true of a day or not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// A figure is beyond a number.
    Compared(Quantity, Relation, f64),
    /// A figure is not what it was on the day before.
    Moved(Quantity, Direction),
    /// Something happens.
    Event(WorldEvent),
}

impl Condition {
    /// The figure that it is about; none for an event.
    pub fn quantity(&self) -> Option<&Quantity> {
        match self {
            Condition::Compared(quantity, ..) | Condition::Moved(quantity, _) => Some(quantity),
            Condition::Event(_) => None,
        }
    }

    /// How it stands on a day of some days, day 1 first.
    pub(crate) fn judged(&self, days: &[MeasuredDay], day: u32) -> Judged {
        let before = day.saturating_sub(1);
        let at = |day: u32| self.quantity().and_then(|quantity| quantity.value(days, day));
        let (value, value_before) = (at(day), at(before));
        let is_over_days = self.quantity().is_some_and(|quantity| quantity.days() > 1);
        Judged {
            day,
            begins: is_over_days && value.is_some() && value_before.is_none(),
            value,
            before: value_before,
            is_true: self.holds(days, day),
            was_true: self.holds(days, before),
        }
    }

    /// Whether it is true of a day. What has no value is beyond nothing, and there is no day 0.
    fn holds(&self, days: &[MeasuredDay], day: u32) -> bool {
        let at = |quantity: &Quantity, day: u32| quantity.value(days, day);
        match self {
            Condition::Compared(quantity, relation, threshold) => {
                at(quantity, day).is_some_and(|value| relation.holds(value, *threshold))
            }
            Condition::Moved(quantity, direction) => {
                let pair = at(quantity, day).zip(at(quantity, day.saturating_sub(1)));
                pair.is_some_and(|(value, before)| match direction {
                    Direction::Rises => value > before,
                    Direction::Falls => value < before,
                })
            }
            Condition::Event(event) => {
                let own = day.checked_sub(1).and_then(|at| days.get(at as usize));
                own.is_some_and(|own| event.happens_on(own))
            }
        }
    }
}

/// `churn(S1) > 0.05 over 7`, `reputation(S3) falls`, `event rival`.
impl fmt::Display for Condition {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Condition::Compared(quantity, relation, threshold) => {
                let (sign, span) = (relation.sign(), quantity.span());
                // Zero has no sign, and nobody counts three hundred digits.
                match threshold + 0.0 {
                    large if large.abs() >= 1e15 => write!(formatter, "{quantity} {sign} {large:e}{span}"),
                    plain => write!(formatter, "{quantity} {sign} {plain}{span}"),
                }
            }
            Condition::Moved(quantity, direction) => {
                write!(formatter, "{quantity} {}{}", direction.word(), quantity.span())
            }
            Condition::Event(event) => write!(formatter, "event {}", event.id()),
        }
    }
}

/// How a condition stands on a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// The day, from 1.
    pub day: u32,
    /// The figure; none for an event, and where it has no value.
    pub value: Option<f64>,
    /// The same on the day before.
    pub before: Option<f64>,
    /// Whether it is true.
    pub is_true: bool,
    /// Whether it was true on the day before.
    pub was_true: bool,
    /// Whether it is a figure over several days that has its first value, or the first one after days without any.
    pub begins: bool,
}

impl Judged {
    /// Whether it became true on the day. A figure over several days that had no value on the day before has not: its days
    /// were not whole before, so with what it begins is no change.
    pub fn becomes_true(&self) -> bool {
        self.is_true && !self.was_true && !self.begins
    }
}
