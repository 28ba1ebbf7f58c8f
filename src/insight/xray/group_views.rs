//! Hidden state of groups on a day: quality, satisfaction and reputation.

use super::hidden_day::GroupEvening;
use super::inspector::Inspector;
use super::lead_equation::WINDOW_DAYS;
use super::quality_equation::QualityEquation;
use super::reputation_equation::{ReputationEquation, Spillover};
use super::satisfaction_equation::SatisfactionEquation;
use novamind_session::Look;
use novamind_tools::Refusal;
use novamind_world::identifiers::Group;

impl Inspector<'_> {
    /// Returns the quality equation of a group on a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn quality_equation(&mut self, group: Group, day: Option<u32>) -> Result<QualityEquation, Refusal> {
        let look = Look::begin(self.run, "quality", group.id(), day)?;
        let day = look.day();
        self.hidden_day(&look, day).map(|seen| QualityEquation::of(group, day, &seen.quality))
    }

    /// Returns the satisfaction equation of a group on a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn satisfaction_equation(
        &mut self,
        group: Group,
        day: Option<u32>,
    ) -> Result<SatisfactionEquation, Refusal> {
        let look = Look::begin(self.run, "satisfaction", group.id(), day)?;
        let day = look.day();
        let seen = self.hidden_day(&look, day)?;
        let evening = &seen.groups[group];
        let evening = (evening.active, evening.mood.map(|(satisfaction, _)| satisfaction));
        let yesterday = match day {
            1 => None,
            day => Some(self.hidden_day(&look, day - 1)?.satisfaction[group]),
        };
        let evenings =
            self.evenings(&look, group, day, |own| own.mood.map(|(satisfaction, _)| satisfaction))?;
        Ok(SatisfactionEquation::of(group, day, seen.satisfaction[group], evening, yesterday, evenings))
    }

    /// Returns the reputation equation of a group on a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn reputation_equation(
        &mut self,
        group: Group,
        day: Option<u32>,
    ) -> Result<ReputationEquation, Refusal> {
        let look = Look::begin(self.run, "reputation", group.id(), day)?;
        let day = look.day();
        let evenings = self.evenings(&look, group, day, |own| own.reputation)?;
        self.hidden_day(&look, day).map(|seen| ReputationEquation::of(group, day, &seen.reputation, evenings))
    }

    /// Returns a value of a group at the end of a day and of up to 27 days before it.
    fn evenings<T>(
        &mut self,
        look: &Look,
        group: Group,
        day: u32,
        read: impl Fn(&GroupEvening) -> T,
    ) -> Result<Vec<T>, Refusal> {
        let diary = self.diary_of_all_days(look, self.own.diary.keeps_threads())?;
        let first = (day + 1).saturating_sub(WINDOW_DAYS).max(1);
        let evening = |day| diary.read(day, |seen| read(&seen.groups[group]));
        Ok((first..=day).filter_map(evening).collect())
    }

    /// Returns the spillover of reputation between groups on a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn spillover(&mut self, day: Option<u32>) -> Result<Spillover, Refusal> {
        let look = Look::begin(self.run, "spillover", "", day)?;
        let day = look.day();
        self.hidden_day(&look, day).map(|seen| Spillover::of(day, &seen.known, seen.reputation))
    }
}
