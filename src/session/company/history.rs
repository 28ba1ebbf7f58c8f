//! The history of a run for screens, dashboard and reports: figures of weeks, decisions and journal.

use super::idempotency::IdempotentResponses;
use super::irrevocable::IrrevocableAction;
use super::simulation::Simulation;
use super::week_actions::WeekActions;
use crate::figures::changes::{Decisions, SettingChange, setting_changes};
use crate::figures::groups::{self, GroupWeek};
use crate::figures::journal::JournalEntry;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::{CalculationOutput, RunEndReason};
use novamind_world::events::{DayFigures, LedgerEntry, Notice};
use novamind_world::identifiers::ByGroup;
use novamind_world::state::World;

pub(crate) struct History {
    /// Cash at the end of each day, starting with day 0.
    pub(crate) cash_by_day: Vec<f64>,
    /// Figures of every completed week, including a shortened last week.
    pub(crate) weeks: Vec<WeekFigures>,
    /// Figures of an incomplete current week, whose days are simulated one by one.
    pub(crate) current_week: WeekFigures,
    /// Group figures of every completed week.
    pub(crate) group_weeks: Vec<ByGroup<GroupWeek>>,
    /// Group figures of an incomplete current week, whose days are simulated one by one.
    pub(crate) current_groups: ByGroup<GroupWeek>,
    pub(crate) decisions: Vec<Decisions>,
    /// Notices of the last simulated days, each with its day and text.
    pub(crate) notices: Vec<(u32, String)>,
    pub(crate) week_actions: WeekActions,
    pub(crate) journal: Vec<JournalEntry>,
    /// Distinct SQL statements of this run, newest last.
    pub(crate) query_history: Vec<String>,
    pub(crate) calculation_outputs: Vec<CalculationOutput>,
    /// Dashboard after the last simulated days; `None` before the first day.
    pub(crate) last_dashboard: Option<String>,
    /// Ledger entries of calls since the last simulated day.
    pub(crate) call_ledger: Vec<LedgerEntry>,
    pub(crate) ended: Option<RunEndReason>,
    pub(crate) idempotent_responses: IdempotentResponses,
}

impl History {
    pub(crate) fn new(world: &World) -> History {
        let settings = world.settings.clone();
        History {
            cash_by_day: vec![world.finance.cash],
            weeks: Vec::new(),
            current_week: WeekFigures::default(),
            group_weeks: Vec::new(),
            current_groups: ByGroup::default(),
            decisions: Vec::new(),
            notices: Vec::new(),
            week_actions: WeekActions {
                settings,
                undo: Vec::new(),
                redo: Vec::new(),
                irrevocable_actions: Vec::new(),
            },
            journal: Vec::new(),
            query_history: Vec::new(),
            calculation_outputs: Vec::new(),
            last_dashboard: None,
            call_ledger: Vec::new(),
            ended: None,
            idempotent_responses: IdempotentResponses::default(),
        }
    }

    /// Returns the settings that differ from the end of the last week, with old and new values.
    pub(crate) fn setting_changes(&self, world: &World) -> Vec<SettingChange> {
        setting_changes(&self.week_actions.settings, &world.settings)
    }

    pub(crate) fn record_day(&mut self, figures: &DayFigures, simulation: &Simulation, notices: &[String]) {
        let Simulation { facts, params, world, .. } = simulation;
        self.cash_by_day.push(figures.cash);
        let repeated = |notice: &Notice| matches!(notice, Notice::LeadLossRepeated { .. });
        let kept_notices = facts.notices.iter().zip(notices).filter(|(notice, _)| !repeated(notice));
        self.notices.extend(kept_notices.map(|(_, text)| (figures.day, text.clone())));
        groups::add_day_to_week(&mut self.current_groups, figures, facts, world);
        self.current_week.add_simulated_day(figures, facts, &self.call_ledger, params);
    }

    /// Completes the figures of the simulated days, and of the week if the week has ended.
    pub(crate) fn finish_days(
        &mut self,
        simulation: &Simulation,
        opening_cash: f64,
        open_issues: u32,
    ) -> WeekFigures {
        let Simulation { params, world, .. } = simulation;
        let before = self.weeks.last().map_or(opening_cash, |week| week.cash);
        self.current_week.cash_change = world.finance.cash - before;
        self.current_week.open_issues = open_issues;
        let figures = self.current_week;
        if world.day.is_multiple_of(params.run.days_per_week) || world.is_over(params) {
            self.weeks.push(figures);
            self.current_week = WeekFigures::default();
            let mut groups = std::mem::take(&mut self.current_groups);
            groups::finish_week(&mut groups, world, params, |group| {
                simulation.estimated_required_quality(group)
            });
            self.group_weeks.push(groups);
        }
        self.decisions.push(Decisions {
            day: self.decisions.last().map_or(0, |before| before.until),
            until: world.day,
            changes: self.setting_changes(world),
            purchases: std::mem::take(&mut self.week_actions.irrevocable_actions)
                .iter()
                .map(IrrevocableAction::to_string)
                .collect(),
        });
        self.journal.push(JournalEntry::Week { figures });
        self.week_actions.reset(world.settings.clone());
        figures
    }

    /// Returns the figures of the current week, or of the last week if no day of the current week has been simulated.
    pub(crate) fn latest_week(&self) -> WeekFigures {
        match self.current_week.days_run {
            0 => self.weeks.last().copied().unwrap_or_default(),
            _ => self.current_week,
        }
    }
}
