//! What has happened in a run, as far as screens, dashboard and report look back: figures of weeks, decisions, journal.

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

/// What has happened so far.
pub(crate) struct History {
    /// Cash at the end of each day, day 0 first.
    pub(crate) cash_by_day: Vec<f64>,
    /// Every full or shortened week that ran.
    pub(crate) weeks: Vec<WeekFigures>,
    /// The week that has begun with single steps.
    pub(crate) running_week: WeekFigures,
    /// What every week that ran brought of each group.
    pub(crate) group_weeks: Vec<ByGroup<GroupWeek>>,
    /// The same of the week that has begun.
    pub(crate) running_groups: ByGroup<GroupWeek>,
    /// What was decided before each of them, or before single steps.
    pub(crate) decisions: Vec<Decisions>,
    /// What the last days put into the inbox: day and text.
    pub(crate) notices: Vec<(u32, String)>,
    /// What has been set since the last week.
    pub(crate) this_week: ThisWeek,
    /// Everything that was done, in order.
    pub(crate) journal: Vec<JournalEntry>,
    /// Statements the database was asked in this run, each once, the newest last.
    pub(crate) asked: Vec<String>,
    /// What the calculations said before the last week.
    pub(crate) calculated: Vec<Calculated>,
    /// The dashboard as it was when the last days had run; none before the first.
    pub(crate) last_dashboard: Option<String>,
    /// Money that calls moved since the last day.
    pub(crate) called: Vec<LedgerEntry>,
    /// How the run ended, if it did.
    pub(crate) ended: Option<Ended>,
    /// First answers to requests that carried an id.
    pub(crate) first_answers: FirstAnswers,
}

impl History {
    /// Nothing has happened yet in this world.
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

    /// Settings changed since the last week, old -> new.
    pub(crate) fn changes(&self, world: &World) -> Vec<Change> {
        changes(&self.this_week.settings, &world.settings)
    }

    /// Counts a day that was just simulated, with its notices.
    pub(crate) fn count_day(&mut self, figures: &DayFigures, simulation: &Simulation, notices: &[String]) {
        let Simulation { facts, params, world, .. } = simulation;
        self.cash_by_day.push(figures.cash);
        let repeated = |notice: &Notice| matches!(notice, Notice::LeadLossRepeated { .. });
        let told = facts.notices.iter().zip(notices).filter(|(notice, _)| !repeated(notice));
        self.notices.extend(told.map(|(_, text)| (figures.day, text.clone())));
        groups::count(&mut self.running_groups, figures, facts, world);
        self.running_week.count(figures, facts, &self.called, params);
    }

    /// Ends the figures of the days that ran, and the week if it is complete.
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

    /// Figures of the week that runs, or of the last one that ran.
    pub(crate) fn latest_week(&self) -> WeekFigures {
        match self.running_week.days_run {
            0 => self.weeks.last().copied().unwrap_or_default(),
            _ => self.running_week,
        }
    }
}
