//! The history of a run for screens, dashboard and reports: figures of weeks, decisions, journal.

use super::first_answers::FirstAnswers;
use super::irrevocable::Irrevocable;
use super::simulation::Simulation;
use super::this_week::ThisWeek;
use crate::figures::changes::{Change, Decisions, changes};
use crate::figures::groups::{self, GroupWeek};
use crate::figures::journal::JournalEntry;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::{Calculated, Ended};
use novamind_world::events::{DayFigures, LedgerEntry, Notice};
use novamind_world::identifiers::ByGroup;
use novamind_world::state::World;

pub(crate) struct History {
    /// Cash at the end of each day, day 0 first.
    pub(crate) cash_by_day: Vec<f64>,
    /// Figures of every completed week, including a shortened last one.
    pub(crate) weeks: Vec<WeekFigures>,
    /// Figures of a week that was started with single days.
    pub(crate) running_week: WeekFigures,
    /// Group figures of every completed week.
    pub(crate) group_weeks: Vec<ByGroup<GroupWeek>>,
    /// Group figures of a week that was started with single days.
    pub(crate) running_groups: ByGroup<GroupWeek>,
    pub(crate) decisions: Vec<Decisions>,
    /// Notices of the last simulated days: day and text.
    pub(crate) notices: Vec<(u32, String)>,
    pub(crate) this_week: ThisWeek,
    pub(crate) journal: Vec<JournalEntry>,
    /// Distinct SQL statements of this run, newest last.
    pub(crate) asked: Vec<String>,
    pub(crate) calculated: Vec<Calculated>,
    /// The dashboard after the last simulated days; `None` before the first.
    pub(crate) last_dashboard: Option<String>,
    /// Ledger entries of calls since the last day.
    pub(crate) called: Vec<LedgerEntry>,
    pub(crate) ended: Option<Ended>,
    pub(crate) first_answers: FirstAnswers,
}

impl History {
    pub(crate) fn begin(world: &World) -> History {
        let settings = world.settings.clone();
        History {
            cash_by_day: vec![world.finance.cash],
            weeks: Vec::new(),
            running_week: WeekFigures::default(),
            group_weeks: Vec::new(),
            running_groups: ByGroup::default(),
            decisions: Vec::new(),
            notices: Vec::new(),
            this_week: ThisWeek { settings, undo: Vec::new(), redo: Vec::new(), done: Vec::new() },
            journal: Vec::new(),
            asked: Vec::new(),
            calculated: Vec::new(),
            last_dashboard: None,
            called: Vec::new(),
            ended: None,
            first_answers: FirstAnswers::default(),
        }
    }

    /// Returns the settings changed since the last week, with old and new values.
    pub(crate) fn changes(&self, world: &World) -> Vec<Change> {
        changes(&self.this_week.settings, &world.settings)
    }

    pub(crate) fn count_day(&mut self, figures: &DayFigures, simulation: &Simulation, notices: &[String]) {
        let Simulation { facts, params, world, .. } = simulation;
        self.cash_by_day.push(figures.cash);
        let repeated = |notice: &Notice| matches!(notice, Notice::LeadLossRepeated { .. });
        let told = facts.notices.iter().zip(notices).filter(|(notice, _)| !repeated(notice));
        self.notices.extend(told.map(|(_, text)| (figures.day, text.clone())));
        groups::count(&mut self.running_groups, figures, facts, world);
        self.running_week.count(figures, facts, &self.called, params);
    }

    /// Completes the figures of the simulated days, and of the week if it has ended.
    pub(crate) fn settle(
        &mut self,
        simulation: &Simulation,
        opening_cash: f64,
        open_issues: u32,
    ) -> WeekFigures {
        let Simulation { params, world, .. } = simulation;
        let before = self.weeks.last().map_or(opening_cash, |week| week.cash);
        self.running_week.cash_change = world.finance.cash - before;
        self.running_week.open_issues = open_issues;
        let figures = self.running_week;
        if world.day.is_multiple_of(params.run.days_per_week) || world.is_over(params) {
            self.weeks.push(figures);
            self.running_week = WeekFigures::default();
            let mut groups = std::mem::take(&mut self.running_groups);
            groups::settle(&mut groups, world, params, |group| simulation.estimated_floor(group));
            self.group_weeks.push(groups);
        }
        self.decisions.push(Decisions {
            day: self.decisions.last().map_or(0, |before| before.until),
            until: world.day,
            changes: self.changes(world),
            purchases: std::mem::take(&mut self.this_week.done).iter().map(Irrevocable::to_string).collect(),
        });
        self.journal.push(JournalEntry::Week { figures });
        self.this_week.begin(world.settings.clone());
        figures
    }

    /// Returns the figures of the current week, or of the last one if no day of the current week has run.
    pub(crate) fn latest_week(&self) -> WeekFigures {
        match self.running_week.days_run {
            0 => self.weeks.last().copied().unwrap_or_default(),
            _ => self.running_week,
        }
    }
}
