//! Two days of a run, or a day of two runs, held against each other: parts of the state, figures, customers.

use std::sync::Arc;

use serde_json::Value as Json;

use super::day_end::{Album, DayEnd, Fingerprints};
use super::inspector::Inspector;
use novamind_session::engine::json_of_value;
use novamind_session::{Look, Session};
use novamind_tools::Refusal;
use novamind_world::identifiers::Group;

/// Customers of whom it is told in what they differ.
const CUSTOMERS_TOLD: usize = 10;

/// Two ends of days, held against each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// The day of the first, and that of the second.
    pub days: (u32, u32),
    /// Parameters with which the days were simulated and that differ: key, value in the first, value in the second; null where
    /// one has none.
    pub parameters: Vec<(String, Json, Json)>,
    /// Names of the parts of the state whose hash differs, in the order of the state; at the end `facts`, what happened on the
    /// day.
    pub parts: Vec<&'static str>,
    /// Names of the parts that are alike.
    pub alike: Vec<&'static str>,
    /// Figures that differ: name, value in the first, value in the second.
    pub figures: Vec<(String, f64, f64)>,
    /// Customers who subscribe in both and differ in something.
    pub customers: usize,
    /// Customers who subscribe in the first only, and in the second only.
    pub only: (usize, usize),
    /// The first of those who differ, by their numbers.
    pub first_customers: Vec<CustomerDifference>,
}

/// What differs about a customer.
#[derive(Debug, Clone, PartialEq)]
pub struct CustomerDifference {
    /// Number.
    pub customer: u32,
    /// Group, in the first where it subscribes there.
    pub group: Group,
    /// Whether it subscribes in the first, and in the second.
    pub subscribes: (bool, bool),
    /// Where it does in both: column, value in the first, value in the second.
    pub columns: Vec<(&'static str, String, String)>,
}

/// Two runs, held against each other.
#[derive(Debug, Clone, PartialEq)]
pub struct RunDifference {
    /// The last day that both have.
    pub last_day: u32,
    /// The first day on which they differ; none: they are alike as far as both go.
    pub first_day: Option<u32>,
    /// What differs on the day that was asked for, or on the first on which something does; none where nothing does and no day
    /// was asked for.
    pub difference: Option<Difference>,
}

impl Difference {
    fn between(days: (u32, u32), one: &DayEnd, other: &DayEnd) -> Difference {
        let pairs = || one.parts.iter().zip(&other.parts);
        let names = |alike: bool| {
            pairs()
                .filter(|(own, other)| (own.hash == other.hash) == alike)
                .map(|(own, _)| own.part)
                .collect()
        };
        let figures = one.figures.iter().zip(&other.figures);
        let figures = figures.filter(|((_, own), (_, other))| own.to_bits() != other.to_bits());
        let all = customers_that_differ(one, other);
        let count = |subscribes| all.iter().filter(|own| own.subscribes == subscribes).count();
        let value = |value: Option<toml::Value>| value.as_ref().map_or(Json::Null, json_of_value);
        let parameters = one.params.differences(&other.params).into_iter();
        Difference {
            days,
            parameters: parameters.map(|own| (own.key, value(own.old), value(own.new))).collect(),
            parts: names(false),
            alike: names(true),
            figures: figures.map(|((name, own), (_, other))| (name.clone(), *own, *other)).collect(),
            customers: count((true, true)),
            only: (count((true, false)), count((false, true))),
            first_customers: all.into_iter().take(CUSTOMERS_TOLD).collect(),
        }
    }

    /// Whether nothing differs.
    pub fn is_none(&self) -> bool {
        self.parts.is_empty() && self.parameters.is_empty()
    }
}

fn customers_that_differ(one: &DayEnd, other: &DayEnd) -> Vec<CustomerDifference> {
    let only_in_other = other.customers.iter().filter(|(number, _)| !one.customers.contains_key(number));
    let mut found: Vec<CustomerDifference> = only_in_other
        .map(|(number, (group, _))| CustomerDifference {
            customer: *number,
            group: *group,
            subscribes: (false, true),
            columns: Vec::new(),
        })
        .collect();
    for (number, (group, row)) in &one.customers {
        let twin = other.customers.get(number);
        let columns = twin.map(|(_, twin)| row.differing(twin)).unwrap_or_default();
        if twin.is_none() || !columns.is_empty() {
            let subscribes = (true, twin.is_some());
            found.push(CustomerDifference { customer: *number, group: *group, subscribes, columns });
        }
    }
    found.sort_by_key(|own| own.customer);
    found
}

impl Inspector<'_> {
    /// What differs between the ends of two days. The look is recorded.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn difference_of_days(&mut self, one: u32, other: u32) -> Result<Difference, Refusal> {
        self.run.refuse_to_look_inside()?;
        let (one, other) =
            (Look::day_to_show(self.run, Some(one))?, Look::day_to_show(self.run, Some(other))?);
        let look = Look::begin(self.run, "difference", &format!("{one} {other}"), Some(one.max(other)))?;
        let album = Arc::new(Album::of(&[one, other]));
        look.watch_up_to(self.run, one.max(other), album.clone())?;
        let first = album.take(one).ok_or_else(not_reached)?;
        if one == other {
            return Ok(Difference::between((one, other), &first, &first));
        }
        let second = album.take(other).ok_or_else(not_reached)?;
        Ok(Difference::between((one, other), &first, &second))
    }

    /// What differs between this run and another on a day, or on the first day on which something does. The look is recorded in
    /// both.
    ///
    /// # Errors
    /// As [`Inspector::difference_of_days`]; the refusal of either run.
    pub fn difference_to(&mut self, other: &mut Session, day: Option<u32>) -> Result<RunDifference, Refusal> {
        let run = &mut *self.run;
        run.refuse_to_look_inside()?;
        other.refuse_to_look_inside()?;
        let last_day = run.day().min(other.day());
        if day.is_some() || last_day == 0 {
            Look::day_to_show(run, day)?;
            Look::day_to_show(other, day)?;
        }
        let (which, shown) = (|run: &Session| run.manifest().id.clone(), day.unwrap_or(last_day));
        let names = (which(run), which(other));
        let own_look = Look::begin_at(run, "difference", &names.1, shown)?;
        let other_look = Look::begin_at(other, "difference", &names.0, shown)?;
        let fingerprints = |run: &Session, look: &Look| {
            let seen = Arc::new(Fingerprints::with_ends(day.as_slice()));
            look.watch_up_to(run, last_day, seen.clone()).map(|()| seen)
        };
        let (own, others) = (fingerprints(run, &own_look)?, fingerprints(other, &other_look)?);
        let (days, other_days) = (own.all(), others.all());
        let differs =
            days.iter().zip(&other_days).take(last_day as usize).position(|(own, other)| own != other);
        let first_day = differs.map(|at| at as u32 + 1);
        let Some(day) = day.or(first_day) else {
            return Ok(RunDifference { last_day, first_day, difference: None });
        };
        let moment = |run: &Session, look: &Look, seen: &Fingerprints| {
            // A day that was named has been seen on the way.
            if let Some(end) = seen.take(day) {
                return Ok(end);
            }
            let album = Arc::new(Album::of(&[day]));
            look.watch_up_to(run, day, album.clone())?;
            album.take(day).ok_or_else(not_reached)
        };
        let difference = Difference::between(
            (day, day),
            &moment(run, &own_look, &own)?,
            &moment(other, &other_look, &others)?,
        );
        Ok(RunDifference { last_day, first_day, difference: Some(difference) })
    }
}

fn not_reached() -> Refusal {
    Refusal::new("not_readable", "the day was not reached when the run was simulated again")
}
