//! The company as displayed by the screens. The session thread creates it after every change.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Map, Value};

use crate::posts::{self, Posts};
use novamind_course::LessonPage;
use novamind_insight::HiddenValues;
use novamind_record::figures::WeekFigures;
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::stamp::StudyStamp;
use novamind_report::WeekReport;
use novamind_report::fit::{Fit, fits};
use novamind_report::funnel::{Funnel, funnels};
use novamind_report::lead_costs::{PairCost, pair_costs};
use novamind_report::needs::{Need, needs};
use novamind_session::identifiers::{ByGroup, Group};
use novamind_session::{
    CompanyNames, DeliveredQuality, ForecastScore, Forecasts, GroupWeek, JournalEntry, Observation,
    ResearchMeans, RunningStudy, Session, ToolLimits,
};
use novamind_tools::{
    GetCostInfo, GetGroupInsights, GetMarketOverview, GroupInsights, ListResearchProjects, MarketOverview,
    Numbers, PriceList, ResearchProjects, ToolId,
};

/// The company as a player may know it.
#[derive(Debug, Clone)]
pub struct Company {
    /// Key figures.
    pub seen: Observation,
    /// Run folder.
    pub folder: Option<PathBuf>,
    /// First day after the next week, or the last day.
    pub next_decision_day: u32,
    /// Cash at the end of each day, day 0 first.
    pub cash_by_day: Vec<f64>,
    /// Figures of every week.
    pub weeks: Vec<WeekFigures>,
    /// Report of the last week.
    pub week: Option<WeekReport>,
    /// Negotiation funnel, by known group.
    pub funnels: Vec<Funnel>,
    /// Fit of the plans with every known group.
    pub fits: Vec<Fit>,
    /// Costs per lead, by channel and group.
    pub lead_costs: Vec<PairCost>,
    /// Figures by group for every week.
    pub group_weeks: Arc<[ByGroup<GroupWeek>]>,
    /// Action items, the most urgent first.
    pub needs: Vec<Need>,
    /// Notices of the last week: day and text.
    pub notices: Vec<(u32, String)>,
    /// Delivered quality of every known group.
    pub quality: Vec<DeliveredQuality>,
    /// Base quality before development, and the quality that general development has added.
    pub quality_base: (f64, f64),
    /// Naive forecasts of cash.
    pub naive: Forecasts,
    /// Scores of past forecasts.
    pub scores: Vec<ForecastScore>,
    /// Journal of past actions.
    pub journal: Vec<JournalEntry>,
    /// Past queries, the newest last.
    pub asked: Vec<String>,
    /// Last day on which each screen was viewed in an earlier session.
    pub viewed: BTreeMap<String, u32>,
    /// Notes of the run.
    pub memo: String,
    /// Current arguments of every tool.
    pub settings: BTreeMap<ToolId, Map<String, Value>>,
    /// Prices of models and capacity.
    pub costs: PriceList,
    /// Available and started R&D projects.
    pub projects: ResearchProjects,
    /// Mean duration and gain of each R&D tier, the first tier first.
    pub research_means: Vec<ResearchMeans>,
    /// Posts of others, as returned by `get_social_posts`.
    pub posts: Posts,
    /// The known groups and the economy.
    pub market: MarketOverview,
    /// Names of enterprises.
    pub names: CompanyNames,
    /// Insights of every known group.
    pub insights: BTreeMap<Group, GroupInsights>,
    /// Limits of tool arguments.
    pub terms: ToolLimits,
    /// Parameters that texts mention.
    pub numbers: Arc<Numbers>,
    /// Running market studies.
    pub studies: Vec<RunningStudy>,
    /// Remarks on the opening of the run.
    pub remarks: Vec<String>,
    /// Whether it is a position of a playback, which is read-only.
    pub replayed: bool,
    /// Whether hidden state may be shown.
    pub may_look_inside: bool,
    /// True values of the day, while the screens show them.
    pub hidden: Option<Arc<HiddenValues>>,
    /// Session rules of the run.
    pub rules: SessionRules,
    /// Study that the run belongs to.
    pub study: Option<StudyStamp>,
    /// State of the lesson that the run belongs to.
    pub lesson: Option<LessonPage>,
}

impl Company {
    /// Returns the current company of a session.
    pub fn of(session: &Session) -> Company {
        Company::after(session, None)
    }

    /// Returns the current company of a session. Data that is unchanged since `before` is shared.
    pub fn after(session: &Session, before: Option<&Company>) -> Company {
        let settings = ToolId::all().map(|tool| (tool, tool.tool().current(session.settings())));
        Company {
            seen: session.company().observe(),
            folder: session.folder().map(PathBuf::from),
            next_decision_day: session.company().next_decision_day(),
            cash_by_day: session.cash_by_day().to_vec(),
            weeks: session.weeks().to_vec(),
            week: WeekReport::of_session(session),
            funnels: funnels(session),
            fits: fits(session),
            lead_costs: pair_costs(session.company().group_weeks()),
            group_weeks: session.company().group_weeks().into(),
            needs: needs(session),
            notices: session.company().notices().to_vec(),
            quality: session.company().delivered_quality(),
            quality_base: session.company().quality_base(),
            naive: session.company().naive_forecasts(),
            scores: session.company().forecast_scores(),
            journal: session.journal().to_vec(),
            asked: session.company().asked().to_vec(),
            viewed: session.log().viewed().clone(),
            memo: session.memo().unwrap_or_default(),
            settings: settings.collect(),
            costs: session.company().look_up(&GetCostInfo, ()).unwrap_or_default(),
            projects: session.company().look_up(&ListResearchProjects, ()).unwrap_or_default(),
            research_means: session.company().research_means(),
            posts: posts::read(session, before.map(|company| &company.posts)),
            market: session.company().look_up(&GetMarketOverview, ()).unwrap_or_default(),
            names: session.company().company_names().clone(),
            insights: insights(session),
            terms: session.company().tool_limits(),
            numbers: session.numbers(),
            studies: session.company().running_studies(),
            remarks: session.remarks().to_vec(),
            replayed: false,
            may_look_inside: session.may_look_inside(),
            hidden: None,
            rules: session.rules(),
            study: session.manifest().study.clone(),
            lesson: None,
        }
    }

    /// Returns the current company of a session, with the state of its lesson.
    pub fn in_lesson(session: &mut Session, before: Option<&Company>) -> Company {
        let lesson = LessonPage::of(session);
        Company { lesson, ..Company::after(session, before) }
    }

    /// Returns the lesson while it restricts the user.
    pub fn running_lesson(&self) -> Option<&LessonPage> {
        self.lesson.as_ref().filter(|_| self.is_running() && !self.replayed)
    }

    /// Returns whether a tool is available; a lesson may restrict the tools.
    pub fn has_tool(&self, tool: ToolId) -> bool {
        let tools = self.running_lesson().and_then(|lesson| lesson.tools.as_ref());
        !tool.spec().kind.acts()
            || tool == ToolId::NextWeek
            || tools.is_none_or(|tools| tools.contains(&tool))
    }

    /// Returns whether the run has not ended.
    pub fn is_running(&self) -> bool {
        self.seen.ended.is_none()
    }

    /// Returns whether the run is a baseline run.
    pub fn is_baseline(&self) -> bool {
        self.seen.mode == Mode::Baseline
    }

    /// Returns whether causes of changes may be shown: not in an unfinished baseline run.
    pub fn tells_causes(&self) -> bool {
        !self.is_baseline() || self.may_look_inside
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
    pub fn mean_of_four(&self, figure: impl Fn(&WeekFigures) -> f64) -> Option<f64> {
        let last = self.trend(4, figure);
        (!last.is_empty()).then(|| last.iter().sum::<f64>() / last.len() as f64)
    }
}

/// These calls are free and not recorded.
fn insights(session: &Session) -> BTreeMap<Group, GroupInsights> {
    let known = session.company().observe().known_groups;
    let told = |group: Group| Some((group, session.company().look_up(&GetGroupInsights, group)?));
    known.into_iter().filter_map(told).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played;

    #[test]
    fn a_trend_has_as_many_weeks_as_were_asked_for_and_the_mean_those_of_four() {
        let company = Company::of(&played(6));
        let payments: Vec<f64> = company.weeks.iter().map(|week| week.payments).collect();
        assert_eq!(company.trend(4, |week| week.payments), payments[2..]);
        assert_eq!(company.trend(9, |week| week.payments), payments);
        let mean = company.mean_of_four(|week| week.payments).expect("weeks have passed");
        assert!((mean - payments[2..].iter().sum::<f64>() / 4.0).abs() < 1e-9);
        assert_eq!(Company::of(&played(0)).mean_of_four(|week| week.payments), None);
    }
}
