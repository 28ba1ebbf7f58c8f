//! The company as displayed by the screens. The session thread creates it after every change.

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

/// The company as a player may know it.
#[derive(Debug, Clone)]
pub struct DisplayedCompany {
    /// Key figures.
    pub observation: Observation,
    /// Run folder.
    pub folder: Option<PathBuf>,
    /// First day after the next week, or the last day.
    pub next_decision_day: u32,
    /// Cash at the end of each day, day 0 first.
    pub cash_by_day: Vec<f64>,
    /// Figures of every week.
    pub weeks: Vec<WeekFigures>,
    /// Report of the last week.
    pub last_week: Option<WeekReport>,
    /// Negotiation funnel, by known group.
    pub funnels: Vec<Funnel>,
    /// Fit of the plans with every known group.
    pub fits: Vec<Fit>,
    /// Costs per lead, by channel and group.
    pub lead_costs: Vec<LeadCost>,
    /// Figures by group for every week.
    pub group_weeks: Arc<[ByGroup<GroupWeek>]>,
    /// Action items, the most urgent first.
    pub action_items: Vec<ActionItem>,
    /// Notices of the last week: day and text.
    pub notices: Vec<(u32, String)>,
    /// Delivered quality of every known group.
    pub quality: Vec<DeliveredQuality>,
    /// Base quality before development, and the quality that general development has added.
    pub quality_base: (f64, f64),
    /// Naive forecasts of cash.
    pub naive_forecasts: Forecasts,
    /// Scores of past forecasts.
    pub forecast_scores: Vec<ForecastScore>,
    /// Journal of past actions.
    pub journal: Vec<JournalEntry>,
    /// Past queries, the newest last.
    pub past_queries: Vec<String>,
    /// Last day on which each screen was viewed in an earlier session.
    pub last_viewed_days: BTreeMap<String, u32>,
    /// Notes of the run.
    pub notes: String,
    /// Current arguments of every tool.
    pub settings: BTreeMap<ToolId, Map<String, Value>>,
    /// Prices of models and capacity.
    pub price_list: PriceList,
    /// Available and started R&D projects.
    pub projects: ResearchProjects,
    /// Mean duration and gain of each R&D tier, the first tier first.
    pub research_means: Vec<ResearchMeans>,
    /// Posts of others, as returned by `get_social_posts`.
    pub posts: Posts,
    /// The known groups and the economy.
    pub market: MarketOverview,
    /// Names of enterprises.
    pub company_names: EnterpriseNames,
    /// Insights of every known group.
    pub insights: BTreeMap<Group, GroupInsights>,
    /// Limits of tool arguments.
    pub tool_limits: ToolLimits,
    /// Parameters that texts mention.
    pub numbers: Arc<ParameterNumbers>,
    /// Running market studies.
    pub running_studies: Vec<RunningStudy>,
    /// Remarks on the opening of the run.
    pub remarks: Vec<String>,
    /// Whether it is a position of a playback, which is read-only.
    pub is_playback: bool,
    /// Whether hidden state may be shown.
    pub can_inspect: bool,
    /// True values of the day, while the screens show them.
    pub hidden_values: Option<Arc<HiddenValues>>,
    /// Session rules of the run.
    pub rules: SessionRules,
    /// Study that the run belongs to.
    pub study: Option<StudyStamp>,
    /// State of the lesson that the run belongs to.
    pub lesson: Option<LessonStatus>,
}

impl DisplayedCompany {
    /// Returns the current company of a session.
    pub fn from_session(session: &Session) -> DisplayedCompany {
        DisplayedCompany::update_from_session(session, None)
    }

    /// Returns the current company of a session. Data that is unchanged since `before` is shared.
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
            company_names: session.company().company_names().clone(),
            insights: group_insights(session),
            tool_limits: session.company().tool_limits(),
            numbers: session.numbers(),
            running_studies: session.company().running_studies(),
            remarks: session.remarks().to_vec(),
            is_playback: false,
            can_inspect: session.can_inspect(),
            hidden_values: None,
            rules: session.rules(),
            study: session.manifest().study.clone(),
            lesson: None,
        }
    }

    /// Returns the current company of a session, with the state of its lesson.
    pub fn from_session_with_lesson(
        session: &mut Session,
        before: Option<&DisplayedCompany>,
    ) -> DisplayedCompany {
        let lesson = LessonStatus::from_session(session);
        DisplayedCompany { lesson, ..DisplayedCompany::update_from_session(session, before) }
    }

    /// Returns the lesson while it restricts the user.
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

    /// Returns whether the run has not ended.
    pub fn is_running(&self) -> bool {
        self.observation.ended.is_none()
    }

    /// Returns whether the run is a baseline run.
    pub fn is_baseline(&self) -> bool {
        self.observation.mode == Mode::Baseline
    }

    /// Returns whether causes of changes may be shown: not in an unfinished baseline run.
    pub fn can_explain_causes(&self) -> bool {
        !self.is_baseline() || self.can_inspect
    }

    /// Returns whether forecast scores may be shown. Some rules permit them only after the end.
    pub fn shows_calibration(&self) -> bool {
        self.rules.calibration || !self.is_running()
    }

    /// Returns the fit of a known group.
    pub fn fit(&self, group: Group) -> Option<&Fit> {
        self.fits.iter().find(|fit| fit.group == group)
    }

    /// Returns a current argument of a tool as a number, or 0 if it has none.
    pub fn setting(&self, tool: ToolId, argument: &str) -> f64 {
        self.settings.get(&tool).and_then(|all| all.get(argument)).and_then(Value::as_f64).unwrap_or(0.0)
    }

    /// Returns the latest forecasts with their decision day.
    pub fn last_forecasts(&self) -> Option<(u32, &[novamind_tools::Forecast])> {
        self.journal.iter().rev().find_map(|entry| match entry {
            JournalEntry::Advance { day, forecasts, .. } => Some((*day, forecasts.as_slice())),
            _ => None,
        })
    }

    /// Returns a figure of the last `count` weeks, oldest first.
    pub fn trend(&self, count: usize, figure: impl Fn(&WeekFigures) -> f64) -> Vec<f64> {
        let from = self.weeks.len().saturating_sub(count);
        self.weeks[from..].iter().map(figure).collect()
    }

    /// Returns the mean of a figure over the last four weeks, or `None` before the first week.
    pub fn four_week_mean(&self, figure: impl Fn(&WeekFigures) -> f64) -> Option<f64> {
        let last = self.trend(4, figure);
        (!last.is_empty()).then(|| last.iter().sum::<f64>() / last.len() as f64)
    }
}

/// These calls are free and not recorded.
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
    fn trend_and_mean_use_the_last_weeks() {
        let company = DisplayedCompany::from_session(&played_session(6));
        let payments: Vec<f64> = company.weeks.iter().map(|week| week.payments).collect();
        assert_eq!(company.trend(4, |week| week.payments), payments[2..]);
        assert_eq!(company.trend(9, |week| week.payments), payments);
        let mean = company.four_week_mean(|week| week.payments).expect("weeks have passed");
        assert!((mean - payments[2..].iter().sum::<f64>() / 4.0).abs() < 1e-9);
        assert_eq!(
            DisplayedCompany::from_session(&played_session(0)).four_week_mean(|week| week.payments),
            None
        );
    }
}
