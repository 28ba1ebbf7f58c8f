//! Hidden state of groups on a day: quality, satisfaction and reputation.

use super::hidden_day::GroupDayEnd;
use super::inspector::Inspector;
use super::lead_equation::WINDOW_DAYS;
use super::quality_equation::QualityEquation;
use super::reputation_equation::{ReputationEquation, Spillover};
use super::satisfaction_equation::SatisfactionEquation;
use novamind_session::InspectionPermit;
use novamind_tools::Rejection;
use novamind_world::identifiers::Group;

impl Inspector<'_> {
    /// Returns the quality equation of a group on a day, by default the last day. Records the inspection in the
    /// trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn quality_equation(&mut self, group: Group, day: Option<u32>) -> Result<QualityEquation, Rejection> {
        let permit = InspectionPermit::start(self.run, "quality", group.id(), day)?;
        let day = permit.day();
        self.hidden_day(&permit, day).map(|seen| QualityEquation::new(group, day, &seen.quality))
    }

    /// Returns the satisfaction equation of a group on a day, by default the last day. Records the inspection in the
    /// trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn satisfaction_equation(
        &mut self,
        group: Group,
        day: Option<u32>,
    ) -> Result<SatisfactionEquation, Rejection> {
        let permit = InspectionPermit::start(self.run, "satisfaction", group.id(), day)?;
        let day = permit.day();
        let seen = self.hidden_day(&permit, day)?;
        let day_end = &seen.groups[group];
        let subscribers = (
            day_end.active,
            day_end.mean_satisfaction_and_relationship.map(|(satisfaction, _)| satisfaction),
        );
        let yesterday = match day {
            1 => None,
            day => Some(self.hidden_day(&permit, day - 1)?.satisfaction[group]),
        };
        let recent_days = self.values_of_recent_days(&permit, group, day, |day_end| {
            day_end.mean_satisfaction_and_relationship.map(|(satisfaction, _)| satisfaction)
        })?;
        Ok(SatisfactionEquation::new(
            group,
            day,
            seen.satisfaction[group],
            subscribers,
            yesterday,
            recent_days,
        ))
    }

    /// Returns the reputation equation of a group on a day, by default the last day. Records the inspection in the
    /// trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn reputation_equation(
        &mut self,
        group: Group,
        day: Option<u32>,
    ) -> Result<ReputationEquation, Rejection> {
        let permit = InspectionPermit::start(self.run, "reputation", group.id(), day)?;
        let day = permit.day();
        let recent_days = self.values_of_recent_days(&permit, group, day, |day_end| day_end.reputation)?;
        self.hidden_day(&permit, day)
            .map(|seen| ReputationEquation::new(group, day, &seen.reputation, recent_days))
    }

    /// Returns a group's values at the end of a day and of up to 27 earlier days.
    fn values_of_recent_days<T>(
        &mut self,
        permit: &InspectionPermit,
        group: Group,
        day: u32,
        read: impl Fn(&GroupDayEnd) -> T,
    ) -> Result<Vec<T>, Rejection> {
        let recorder = self.all_hidden_days(permit, self.cache.hidden_days.records_threads())?;
        let first = (day + 1).saturating_sub(WINDOW_DAYS).max(1);
        let value_of_day = |day| recorder.with_day(day, |seen| read(&seen.groups[group]));
        Ok((first..=day).filter_map(value_of_day).collect())
    }

    /// Returns the spillover of reputation between groups on a day, by default the last day. Records the inspection in
    /// the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn spillover(&mut self, day: Option<u32>) -> Result<Spillover, Rejection> {
        let permit = InspectionPermit::start(self.run, "spillover", "", day)?;
        let day = permit.day();
        self.hidden_day(&permit, day).map(|seen| Spillover::new(day, &seen.known_groups, seen.reputation))
    }
}
