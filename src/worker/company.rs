//! The company as displayed by the screens. The session thread creates a new value after every change.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Map, Value};

use crate::posts::{self, Posts};
use novamind_course::LessonStatus;
use novamind_insight::HiddenValues;
use novamind_record::figures::WeekFigures;
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::stamp::StudyStamp;
use novamind_report::WeekReport;
use novamind_report::action_items::{ActionItem, action_items};
use novamind_report::fit::{Fit, fits};
use novamind_report::funnel::{Funnel, funnels};
use novamind_report::lead_costs::{LeadCost, lead_costs_by_pair};
use novamind_session::identifiers::{ByGroup, Group};
use novamind_session::{
    DeliveredQuality, EnterpriseNames, ForecastScore, Forecasts, GroupWeek, JournalEntry, Observation,
    ResearchMeans, RunningStudy, Session, ToolLimits,
};
use novamind_tools::{
    GetCostInfo, GetGroupInsights, GetMarketOverview, GroupInsights, ListResearchProjects, MarketOverview,
    ParameterNumbers, PriceList, ResearchProjects, ToolId,
};

/// The data that the screens display about the company. Hidden values are included only after an inspection.
#[derive(Debug, Clone)]
pub struct DisplayedCompany {
    /// What the player can observe about the run and the company.
    pub observation: Observation,
    /// Folder of the run; `None` for a run in memory.
    pub folder: Option<PathBuf>,
    /// Next decision day, or the last day of the run.
    pub next_decision_day: u32,
    /// Cash at the end of each day, starting with day 0.
    pub cash_by_day: Vec<f64>,
    /// Company figures of every simulated week, oldest first.
    pub weeks: Vec<WeekFigures>,
    /// Report on the last week; `None` before the first week.
    pub last_week: Option<WeekReport>,
    /// Negotiation funnel of every known group.
    pub funnels: Vec<Funnel>,
    /// Fit of the plans for every known group.
    pub fits: Vec<Fit>,
    /// Costs per lead, by channel and group.
    pub lead_costs: Vec<LeadCost>,
    /// Figures of all groups for every simulated week.
    pub group_weeks: Arc<[ByGroup<GroupWeek>]>,
    /// Action items, most urgent first.
    pub action_items: Vec<ActionItem>,
    /// Notifications of the last week, each with its day and text.
    pub notices: Vec<(u32, String)>,
    /// Delivered quality of every known group.
    pub quality: Vec<DeliveredQuality>,
    /// Base quality, and the general bonus that development has added.
    pub quality_base: (f64, f64),
    /// Naive forecasts of cash, which the forecast form can fill in.
    pub naive_forecasts: Forecasts,
    /// Scores of past forecasts, by horizon.
    pub forecast_scores: Vec<ForecastScore>,
    /// Journal of all confirmed actions.
    pub journal: Vec<JournalEntry>,
    /// SQL statements of past queries, newest last.
    pub past_queries: Vec<String>,
    /// Day on which the user last left each screen in an earlier session.
    pub last_viewed_days: BTreeMap<String, u32>,
    /// Text of the player's notes.
    pub notes: String,
    /// For each tool, the arguments that would set the values in force.
    pub settings: BTreeMap<ToolId, Map<String, Value>>,
    /// Prices of model tiers and capacity tiers.
    pub price_list: PriceList,
    /// Available and started R&D projects.
    pub projects: ResearchProjects,
    /// Mean duration and gain of each R&D tier, lowest tier first.
    pub research_means: Vec<ResearchMeans>,
    /// Posts of other authors, as returned by `get_social_posts`.
    pub posts: Posts,
    /// Overview of the known groups and the economy.
    pub market: MarketOverview,
    /// Names of enterprises, which replace customer numbers in texts.
    pub enterprise_names: EnterpriseNames,
    /// Result of `get_group_insights` for every known group.
    pub insights: BTreeMap<Group, GroupInsights>,
    /// Limits and prices that apply to the tools, for forms.
    pub tool_limits: ToolLimits,
    /// Parameter values that are inserted into the descriptions of tools.
    pub numbers: Arc<ParameterNumbers>,
    /// Market studies that have not been completed.
    pub running_studies: Vec<RunningStudy>,
    /// Messages about problems found when the run was opened.
    pub remarks: Vec<String>,
    /// Whether this is a position of a playback, where the run cannot be changed.
    pub is_playback: bool,
    /// Whether inspections of hidden state are permitted.
    pub can_inspect: bool,
    /// Hidden true values of the displayed day; `None` unless the screens show true values.
    pub hidden_values: Option<Arc<HiddenValues>>,
    /// Session rules of the run.
    pub rules: SessionRules,
    /// Study to which the run belongs, if any.
    pub study: Option<StudyStamp>,
    /// State of the lesson to which the run belongs.
    pub lesson: Option<LessonStatus>,
}

impl DisplayedCompany {
    /// Returns the current company of a session.
    pub fn from_session(session: &Session) -> DisplayedCompany {
        DisplayedCompany::update_from_session(session, None)
    }

    /// Returns the current company of a session. Unchanged data is shared with `before`.
    pub fn update_from_session(session: &Session, before: Option<&DisplayedCompany>) -> DisplayedCompany {
        let settings = ToolId::all().map(|tool| (tool, tool.tool().current_arguments(session.settings())));
        DisplayedCompany {
            observation: session.company().observe(),
            folder: session.folder().map(PathBuf::from),
            next_decision_day: session.company().next_decision_day(),
            cash_by_day: session.cash_by_day().to_vec(),
            weeks: session.weeks().to_vec(),
            last_week: WeekReport::from_session(session),
            funnels: funnels(session),
            fits: fits(session),
            lead_costs: lead_costs_by_pair(session.company().group_weeks()),
            group_weeks: session.company().group_weeks().into(),
            action_items: action_items(session),
            notices: session.company().notices().to_vec(),
            quality: session.company().delivered_quality(),
            quality_base: session.company().base_quality(),
            naive_forecasts: session.company().naive_forecasts(),
            forecast_scores: session.company().forecast_scores(),
            journal: session.journal().to_vec(),
            past_queries: session.company().query_history().to_vec(),
            last_viewed_days: session.log().last_views().clone(),
            notes: session.notes().unwrap_or_default(),
            settings: settings.collect(),
            price_list: session.company().read_tool(&GetCostInfo, ()).unwrap_or_default(),
            projects: session.company().read_tool(&ListResearchProjects, ()).unwrap_or_default(),
            research_means: session.company().research_means(),
            posts: posts::read_posts(session, before.map(|company| &company.posts)),
            market: session.company().read_tool(&GetMarketOverview, ()).unwrap_or_default(),
            enterprise_names: session.company().enterprise_names().clone(),
            insights: group_insights(session),
            tool_limits: session.company().tool_limits(),
            numbers: session.numbers(),
            running_studies: session.company().running_studies(),
            remarks: session.remarks().to_vec(),
            is_playback: false,
            can_inspect: session.check_inspection().is_ok(),
            hidden_values: None,
            rules: session.rules(),
            study: session.manifest().study.clone(),
            lesson: None,
        }
    }

    /// Returns the current company of a session, including the state of its lesson.
    pub fn from_session_with_lesson(
        session: &mut Session,
        before: Option<&DisplayedCompany>,
    ) -> DisplayedCompany {
        let lesson = LessonStatus::from_session(session);
        DisplayedCompany { lesson, ..DisplayedCompany::update_from_session(session, before) }
    }

    /// Returns the lesson if it currently restricts the user.
    pub fn running_lesson(&self) -> Option<&LessonStatus> {
        self.lesson.as_ref().filter(|_| self.is_running() && !self.is_playback)
    }

    /// Returns whether a tool is available; a lesson may restrict the tools.
    pub fn has_tool(&self, tool: ToolId) -> bool {
        let Some(lesson) = self.running_lesson() else { return true };
        let sets_capacity = tool == ToolId::SetCapacityTier && lesson.has_automatic_capacity;
        let is_listed = lesson.tools.as_ref().is_none_or(|tools| tools.contains(&tool));
        tool == ToolId::NextWeek || (is_listed && !sets_capacity)
    }

    /// Returns whether the run is unfinished.
    pub fn is_running(&self) -> bool {
        self.observation.ended.is_none()
    }

    /// Returns whether the run is a baseline run.
    pub fn is_baseline(&self) -> bool {
        self.observation.mode == Mode::Baseline
    }

    /// Returns whether causes of changes may be shown. In an unfinished baseline run, causes are hidden.
    pub fn can_explain_causes(&self) -> bool {
        !self.is_baseline() || self.can_inspect
    }

    /// Returns whether forecast scores may be shown. Some session rules permit scores only after the end of the run.
    pub fn can_show_forecast_scores(&self) -> bool {
        self.rules.calibration || !self.is_running()
    }

    /// Returns the fit of the plans for a known group.
    pub fn fit(&self, group: Group) -> Option<&Fit> {
        self.fits.iter().find(|fit| fit.group == group)
    }

    /// Returns the current value of a tool's argument as a number, or 0 if the value is not a number.
    pub fn current_setting(&self, tool: ToolId, argument: &str) -> f64 {
        self.settings.get(&tool).and_then(|all| all.get(argument)).and_then(Value::as_f64).unwrap_or(0.0)
    }

    /// Returns the last submitted forecasts with their decision day.
    pub fn last_forecasts(&self) -> Option<(u32, &[novamind_tools::Forecast])> {
        self.journal.iter().rev().find_map(|entry| match entry {
            JournalEntry::Advance { day, forecasts, .. } => Some((*day, forecasts.as_slice())),
            _ => None,
        })
    }

    /// Returns the values of a figure in the last `count` weeks, oldest first.
    pub fn recent_values(&self, count: usize, figure: impl Fn(&WeekFigures) -> f64) -> Vec<f64> {
        let from = self.weeks.len().saturating_sub(count);
        self.weeks[from..].iter().map(figure).collect()
    }

    /// Returns the mean of a figure over the last four weeks, or `None` before the first week.
    pub fn four_week_mean(&self, figure: impl Fn(&WeekFigures) -> f64) -> Option<f64> {
        let last = self.recent_values(4, figure);
        (!last.is_empty()).then(|| last.iter().sum::<f64>() / last.len() as f64)
    }
}

/// Returns the insights about every known group. The tool calls are free and not recorded.
fn group_insights(session: &Session) -> BTreeMap<Group, GroupInsights> {
    let known = session.company().observe().known_groups;
    let read_insights = |group: Group| Some((group, session.company().read_tool(&GetGroupInsights, group)?));
    known.into_iter().filter_map(read_insights).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played_session;

    #[test]
    fn recent_values_and_mean_use_the_last_weeks() {
        let company = DisplayedCompany::from_session(&played_session(6));
        let payments: Vec<f64> = company.weeks.iter().map(|week| week.payments).collect();
        assert_eq!(company.recent_values(4, |week| week.payments), payments[2..]);
        assert_eq!(company.recent_values(9, |week| week.payments), payments);
        let mean = company.four_week_mean(|week| week.payments).expect("weeks have passed");
        assert!((mean - payments[2..].iter().sum::<f64>() / 4.0).abs() < 1e-9);
        assert_eq!(
            DisplayedCompany::from_session(&played_session(0)).four_week_mean(|week| week.payments),
            None
        );
    }
}
