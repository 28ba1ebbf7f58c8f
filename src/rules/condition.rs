//! Conditions of rules, which compare fields of a thread with values.

use super::thread::ThreadContext;
use novamind_session::identifiers::Plan;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Field {
    Group,
    Type,
    Seats,
    Asked,
    AskedPlan,
    LastOffer,
    Offers,
    Turn,
    DaysLeft,
    RequiredQuota,
    Customer,
}

/// Names of the fields, in the order of the documentation. Two fields also have an alias.
pub(super) const FIELDS: [(&str, Field); 13] = [
    ("group", Field::Group),
    ("type", Field::Type),
    ("kind", Field::Type),
    ("seats", Field::Seats),
    ("asked", Field::Asked),
    ("asked_plan", Field::AskedPlan),
    ("last_offer", Field::LastOffer),
    ("offers_so_far", Field::Offers),
    ("offers", Field::Offers),
    ("turn", Field::Turn),
    ("days_left", Field::DaysLeft),
    ("needed_quota", Field::RequiredQuota),
    ("customer", Field::Customer),
];

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Word(String),
}

impl Field {
    /// Returns whether the values of the field are words rather than numbers.
    pub(super) fn is_word(self) -> bool {
        matches!(self, Field::Group | Field::Type | Field::AskedPlan)
    }

    /// Returns the value of this field in a thread, or `None` if the thread has no value.
    fn thread_value(self, thread: &ThreadContext) -> Option<Value> {
        let (waiting_thread, number) = (&thread.waiting, |value: u32| Value::Number(f64::from(value)));
        Some(match self {
            Field::Group => Value::Word(waiting_thread.group.to_owned()),
            Field::Type => Value::Word(waiting_thread.kind.to_owned()),
            Field::AskedPlan => Value::Word(thread.asked_plan.map(Plan::id)?.to_owned()),
            Field::Seats => number(waiting_thread.seats),
            Field::Asked => Value::Number(waiting_thread.asked?),
            Field::LastOffer => Value::Number(lowest(&waiting_thread.last_offer)?),
            Field::Offers => number(waiting_thread.offers_so_far),
            Field::Turn => number(waiting_thread.turn),
            Field::DaysLeft => number(waiting_thread.days_left),
            Field::RequiredQuota => Value::Number(thread.required_quota?),
            Field::Customer => number(waiting_thread.customer),
        })
    }
}

fn lowest(offer: &[(Plan, f64)]) -> Option<f64> {
    offer.iter().map(|(_, price)| *price).reduce(f64::min)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Comparison {
    Equal,
    NotEqual,
    Less,
    AtMost,
    More,
    AtLeast,
}

impl Comparison {
    fn is_satisfied(self, left: &Value, right: &Value) -> bool {
        use Comparison::{AtLeast, AtMost, Equal, Less, More, NotEqual};
        match (left, right) {
            (Value::Number(left), Value::Number(right)) => match self {
                Equal => left == right,
                NotEqual => left != right,
                Less => left < right,
                AtMost => left <= right,
                More => left > right,
                AtLeast => left >= right,
            },
            (Value::Word(left), Value::Word(right)) => left.eq_ignore_ascii_case(right) == (self == Equal),
            _ => false,
        }
    }
}

/// A condition on a field of a thread. Only `is null` matches a missing value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Condition {
    Compared(Field, Comparison, Value),
    OneOf(Field, Vec<Value>),
    IsNull(Field),
    IsPresent(Field),
}

impl Condition {
    pub(super) fn is_satisfied(&self, thread: &ThreadContext) -> bool {
        match self {
            Condition::Compared(field, comparison, value) => {
                field.thread_value(thread).is_some_and(|actual| comparison.is_satisfied(&actual, value))
            }
            Condition::OneOf(field, values) => {
                let is_one =
                    |actual: Value| values.iter().any(|value| Comparison::Equal.is_satisfied(&actual, value));
                field.thread_value(thread).is_some_and(is_one)
            }
            Condition::IsNull(field) => field.thread_value(thread).is_none(),
            Condition::IsPresent(field) => field.thread_value(thread).is_some(),
        }
    }
}
