//! What the screens show of the run: made by the session's thread after everything that changes it.

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
    /// At a glance.
    pub seen: Observation,
    /// Folder of the run.
    pub folder: Option<PathBuf>,
    /// First day after the next week, or the last day.
    pub next_decision_day: u32,
    /// Cash at the end of each day, day 0 first.
    pub cash_by_day: Vec<f64>,
    /// Figures of every week.
    pub weeks: Vec<WeekFigures>,
    /// The last week told.
    pub week: Option<WeekReport>,
    /// The way of companies to a deal, by known group.
    pub funnels: Vec<Funnel>,
    /// Every known group beside the plans.
    pub fits: Vec<Fit>,
    /// What leads cost, by channel and group.
    pub lead_costs: Vec<PairCost>,
    /// Figures of the groups for every week.
    pub group_weeks: Arc<[ByGroup<GroupWeek>]>,
    /// What needs the person, the most urgent first.
    pub needs: Vec<Need>,
    /// What the last week put into the inbox: day and text.
    pub notices: Vec<(u32, String)>,
    /// Delivered quality of every known group.
    pub quality: Vec<DeliveredQuality>,
    /// Quality before any improvement, and what development has added for everybody.
    pub quality_base: (f64, f64),
    /// The naive projection of cash.
    pub naive: Forecasts,
    /// How forecasts did so far.
    pub scores: Vec<ForecastScore>,
    /// Everything that was done.
    pub journal: Vec<JournalEntry>,
    /// Statements the database was asked, the newest last.
    pub asked: Vec<String>,
    /// The last day on which each screen was left in an earlier sitting.
    pub viewed: BTreeMap<String, u32>,
    /// Notes of the run.
    pub memo: String,
    /// Present arguments of every tool.
    pub settings: BTreeMap<ToolId, Map<String, Value>>,
    /// What models and capacity cost.
    pub costs: PriceList,
    /// What can be researched.
    pub projects: ResearchProjects,
    /// Mean duration and gain of each R&D tier, the first tier first.
    pub research_means: Vec<ResearchMeans>,
    /// Everything that people have written, as get_social_posts tells it.
    pub posts: Posts,
    /// The known groups and the economy.
    pub market: MarketOverview,
    /// What companies are called.
    pub names: CompanyNames,
    /// What is known of every known group.
    pub insights: BTreeMap<Group, GroupInsights>,
    /// ToolLimits of the tools.
    pub terms: ToolLimits,
    /// The numbers that documentation names.
    pub numbers: Arc<Numbers>,
    /// Studies of groups that run.
    pub studies: Vec<RunningStudy>,
    /// What the person should know about the opening of the run.
    pub remarks: Vec<String>,
    /// It is a moment of a recorded run that is played again: nothing can be done.
    pub replayed: bool,
    /// Whether hidden state may be shown.
    pub may_look_inside: bool,
    /// True values of the day, while they stand on the screens.
    pub hidden: Option<Arc<HiddenValues>>,
    /// By which rules it is played.
    pub rules: SessionRules,
    /// The study it belongs to.
    pub study: Option<StudyStamp>,
    /// Where the person stands in the lesson it belongs to.
    pub lesson: Option<LessonPage>,
}

impl Company {
    /// What a session shows now.
    pub fn of(session: &Session) -> Company {
        Company::after(session, None)
    }

    /// The same, with what an earlier look at this run has read already.
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

    /// The same of a run that may belong to a lesson: what it stands at is measured.
    pub fn in_lesson(session: &mut Session, before: Option<&Company>) -> Company {
        let lesson = LessonPage::of(session);
        Company { lesson, ..Company::after(session, before) }
    }

    /// The lesson, as long as it says what the person may do.
    pub fn running_lesson(&self) -> Option<&LessonPage> {
        self.lesson.as_ref().filter(|_| self.is_running() && !self.replayed)
    }

    /// Whether the person has a tool: a lesson has some of them.
    pub fn has_tool(&self, tool: ToolId) -> bool {
        let tools = self.running_lesson().and_then(|lesson| lesson.tools.as_ref());
        !tool.spec().kind.acts()
            || tool == ToolId::NextWeek
            || tools.is_none_or(|tools| tools.contains(&tool))
    }

    /// Whether time can still pass.
    pub fn is_running(&self) -> bool {
        self.seen.ended.is_none()
    }

    /// Whether the run is a baseline.
    pub fn is_baseline(&self) -> bool {
        self.seen.mode == Mode::Baseline
    }

    /// Whether the person may ask why a figure changed: not in an unfinished baseline run.
    pub fn tells_causes(&self) -> bool {
        !self.is_baseline() || self.may_look_inside
    }

    /// Whether the person may see how their own forecasts have done: where that is no part of the session, once it is
    /// over.
    pub fn shows_calibration(&self) -> bool {
        self.rules.calibration || !self.is_running()
    }

    /// A known group beside the plans.
    pub fn fit(&self, group: Group) -> Option<&Fit> {
        self.fits.iter().find(|fit| fit.group == group)
    }

    /// A present argument of a tool as a number, 0 if it has none.
    pub fn setting(&self, tool: ToolId, argument: &str) -> f64 {
        self.settings.get(&tool).and_then(|all| all.get(argument)).and_then(Value::as_f64).unwrap_or(0.0)
    }

    /// The forecasts that were filed last: decision day and forecasts.
    pub fn last_forecasts(&self) -> Option<(u32, &[novamind_tools::Forecast])> {
        self.journal.iter().rev().find_map(|entry| match entry {
            JournalEntry::Advance { day, forecasts, .. } => Some((*day, forecasts.as_slice())),
            _ => None,
        })
    }

    /// One figure of the last weeks, oldest first.
    pub fn trend(&self, count: usize, figure: impl Fn(&WeekFigures) -> f64) -> Vec<f64> {
        let from = self.weeks.len().saturating_sub(count);
        self.weeks[from..].iter().map(figure).collect()
    }

    /// Mean of a figure over the last four weeks; none before the first.
    pub fn mean_of_four(&self, figure: impl Fn(&WeekFigures) -> f64) -> Option<f64> {
        let last = self.trend(4, figure);
        (!last.is_empty()).then(|| last.iter().sum::<f64>() / last.len() as f64)
    }
}

/// What is known of every known group; free, and not recorded.
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
