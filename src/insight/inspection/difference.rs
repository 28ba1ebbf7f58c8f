//! Comparison of two days of a run, or of the same day in two runs, by state part, figure and customer.

use std::sync::Arc;

use serde_json::Value as Json;

use super::day_end::{DayEnd, DayEndRecorder, StateHashRecorder};
use super::inspector::Inspector;
use novamind_session::engine::value_to_json;
use novamind_session::{InspectionPermit, Session};
use novamind_tools::Rejection;
use novamind_world::identifiers::Group;

/// Maximum number of customers whose differences are listed.
const MAX_LISTED_CUSTOMERS: usize = 10;

/// Differences between the states at the end of two days.
#[derive(Debug, Clone, PartialEq)]
pub struct DayDifference {
    /// The two compared days.
    pub days: (u32, u32),
    /// Differing parameters: key, first value, second value. A missing value is null.
    pub parameters: Vec<(String, Json, Json)>,
    /// Names of the parts of the state whose hashes differ, in the order of the state. The last part is `facts`, the
    /// events of the day.
    pub differing_parts: Vec<&'static str>,
    /// Names of the parts of the state whose hashes are equal.
    pub equal_parts: Vec<&'static str>,
    /// Differing figures: name, first value, second value.
    pub figures: Vec<(String, f64, f64)>,
    /// Number of customers who are subscribers at the end of both days and differ.
    pub differing_customers: usize,
    /// Number of customers who are subscribers at the end of the first day only, and number of customers who are
    /// subscribers at the end of the second day only.
    pub only_in_one: (usize, usize),
    /// The first differing customers, sorted by customer number.
    pub first_customers: Vec<CustomerDifference>,
}

/// The differences in one customer between the states at the end of two days.
#[derive(Debug, Clone, PartialEq)]
pub struct CustomerDifference {
    /// Number of the customer whose values differ.
    pub customer: u32,
    /// Group of the customer, from the first day if the customer is a subscriber at the end of that day.
    pub group: Group,
    /// Whether the customer is a subscriber at the end of the first day and of the second day.
    pub subscribes: (bool, bool),
    /// Differing columns of a customer who is a subscriber at the end of both days: column, first value, second value.
    pub columns: Vec<(&'static str, String, String)>,
}

/// The comparison of two runs.
#[derive(Debug, Clone, PartialEq)]
pub struct RunDifference {
    /// Last day that both runs have reached.
    pub last_day: u32,
    /// First day on which the runs differ; `None` if the runs are equal on all common days.
    pub first_day: Option<u32>,
    /// Differences on the requested day, by default on the first differing day; `None` if no day was requested and no
    /// day differs.
    pub difference: Option<DayDifference>,
}

impl DayDifference {
    fn between(days: (u32, u32), one: &DayEnd, other: &DayEnd) -> DayDifference {
        let pairs = || one.parts.iter().zip(&other.parts);
        let names = |alike: bool| {
            pairs()
                .filter(|(part_hash, other)| (part_hash.hash == other.hash) == alike)
                .map(|(hash, _)| hash.part)
                .collect()
        };
        let figures = one.figures.iter().zip(&other.figures);
        let figures = figures.filter(|((_, one), (_, other))| one.to_bits() != other.to_bits());
        let all = differing_customers(one, other);
        let count = |subscribes| {
            all.iter().filter(|customer_difference| customer_difference.subscribes == subscribes).count()
        };
        let value = |value: Option<toml::Value>| value.as_ref().map_or(Json::Null, value_to_json);
        let parameters = one.params.differences(&other.params).into_iter();
        DayDifference {
            days,
            parameters: parameters
                .map(|parameter_difference| {
                    (
                        parameter_difference.key,
                        value(parameter_difference.old),
                        value(parameter_difference.new),
                    )
                })
                .collect(),
            differing_parts: names(false),
            equal_parts: names(true),
            figures: figures.map(|((name, one), (_, other))| (name.clone(), *one, *other)).collect(),
            differing_customers: count((true, true)),
            only_in_one: (count((true, false)), count((false, true))),
            first_customers: all.into_iter().take(MAX_LISTED_CUSTOMERS).collect(),
        }
    }

    /// Returns whether the two days are equal.
    pub fn is_empty(&self) -> bool {
        self.differing_parts.is_empty() && self.parameters.is_empty()
    }
}

fn differing_customers(one: &DayEnd, other: &DayEnd) -> Vec<CustomerDifference> {
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
        let other_row = other.customers.get(number);
        let columns = other_row.map(|(_, other_row)| row.differing(other_row)).unwrap_or_default();
        if other_row.is_none() || !columns.is_empty() {
            let subscribes = (true, other_row.is_some());
            found.push(CustomerDifference { customer: *number, group: *group, subscribes, columns });
        }
    }
    found.sort_by_key(|customer_difference| customer_difference.customer);
    found
}

impl Inspector<'_> {
    /// Compares the states at the end of two days. Records the inspection in the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn compare_days(&mut self, one: u32, other: u32) -> Result<DayDifference, Rejection> {
        self.run.check_inspection()?;
        let (one, other) = (
            InspectionPermit::resolve_day(self.run, Some(one))?,
            InspectionPermit::resolve_day(self.run, Some(other))?,
        );
        let permit =
            InspectionPermit::start(self.run, "difference", &format!("{one} {other}"), Some(one.max(other)))?;
        let end_recorder = Arc::new(DayEndRecorder::for_days(&[one, other]));
        permit.replay_until(self.run, one.max(other), end_recorder.clone())?;
        let first = end_recorder.take(one).ok_or_else(day_not_reached_error)?;
        if one == other {
            return Ok(DayDifference::between((one, other), &first, &first));
        }
        let second = end_recorder.take(other).ok_or_else(day_not_reached_error)?;
        Ok(DayDifference::between((one, other), &first, &second))
    }

    /// Compares two runs on a day, by default on the first differing day. Records the inspection in both runs.
    ///
    /// # Errors
    /// Same errors as [`Inspector::compare_days`], for either run.
    pub fn compare_with_run(
        &mut self,
        other: &mut Session,
        day: Option<u32>,
    ) -> Result<RunDifference, Rejection> {
        let run = &mut *self.run;
        run.check_inspection()?;
        other.check_inspection()?;
        let last_day = run.day().min(other.day());
        if day.is_some() || last_day == 0 {
            InspectionPermit::resolve_day(run, day)?;
            InspectionPermit::resolve_day(other, day)?;
        }
        let (which, shown) = (|run: &Session| run.manifest().id.clone(), day.unwrap_or(last_day));
        let names = (which(run), which(other));
        let own_permit = InspectionPermit::start_at_current_state(run, "difference", &names.1, shown)?;
        let other_permit = InspectionPermit::start_at_current_state(other, "difference", &names.0, shown)?;
        let record_hashes = |run: &Session, permit: &InspectionPermit| {
            let seen = Arc::new(StateHashRecorder::with_ends(day.as_slice()));
            permit.replay_until(run, last_day, seen.clone()).map(|()| seen)
        };
        let (hash_recorder, others) =
            (record_hashes(run, &own_permit)?, record_hashes(other, &other_permit)?);
        let (days, other_days) = (hash_recorder.part_hashes_by_day(), others.part_hashes_by_day());
        let differs = days
            .iter()
            .zip(&other_days)
            .take(last_day as usize)
            .position(|(part_hashes, other)| part_hashes != other);
        let first_day = differs.map(|at| at as u32 + 1);
        let Some(day) = day.or(first_day) else {
            return Ok(RunDifference { last_day, first_day, difference: None });
        };
        let moment = |run: &Session, inspection_permit: &InspectionPermit, seen: &StateHashRecorder| {
            // If the user requested a day, the end of this day was already recorded during the simulation.
            if let Some(end) = seen.take(day) {
                return Ok(end);
            }
            let end_recorder = Arc::new(DayEndRecorder::for_days(&[day]));
            inspection_permit.replay_until(run, day, end_recorder.clone())?;
            end_recorder.take(day).ok_or_else(day_not_reached_error)
        };
        let difference = DayDifference::between(
            (day, day),
            &moment(run, &own_permit, &hash_recorder)?,
            &moment(other, &other_permit, &others)?,
        );
        Ok(RunDifference { last_day, first_day, difference: Some(difference) })
    }
}

fn day_not_reached_error() -> Rejection {
    Rejection::new("not_readable", "the re-simulation of the run did not reach the day")
}
