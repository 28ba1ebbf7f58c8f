//! The data on which a judgement depends: the readers' experience and current events
//! (docs/mechanics/market/social/judge.md#circumstances). The judge uses no other data about the company.

use super::lexicon::Lexicon;
use novamind_world::events::{Severity, Trend};
use novamind_world::identifiers::{ByGroup, Group, Plan};
use novamind_world::market::competitors::severity;
use novamind_world::market::social::chronicle::Page;
use novamind_world::params::Params;
use novamind_world::quality::{quota_demand, quota_factor};
use novamind_world::state::World;

/// Facts about the company on which a judgement depends.
#[derive(Debug, Clone, PartialEq)]
pub struct JudgeContext {
    /// Experience of the readers of each group.
    pub groups: ByGroup<ReaderGroup>,
    /// Number of active subscriptions in all groups.
    pub subscribers: u32,
    /// Whether an R&D project of the company was completed in the last four weeks.
    pub research_done: bool,
    /// Whether a list price is lower or the discount is larger than four weeks ago.
    pub price_cut: bool,
    /// Whether the first-bill discount is above 0.
    pub promotion: bool,
    /// Whether a quota is larger than four weeks ago.
    pub quota_up: bool,
    /// Number of days with an outage in the last two weeks.
    pub outage_days: u32,
    /// Largest overload of the last two weeks.
    pub overload: f64,
    /// Mean 95th-percentile latency of the last seven days, in milliseconds.
    pub p95_ms: f64,
    /// Number of open issues per subscriber.
    pub issue_rate: f64,
    /// Mean age of open issues, in days.
    pub issue_age: f64,
    /// Current events, each with its age in days.
    pub live_events: Vec<(LiveEvent, u32)>,
}

/// The experience of the readers of one group.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReaderGroup {
    /// Number of active subscriptions in the group.
    pub subscribers: u32,
    /// Mean satisfaction of the subscribers, or 0 if there are none.
    pub satisfaction: f64,
    /// Change in the group's quality bonus over four weeks.
    pub progress: f64,
}

/// A current event that a post can address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LiveEvent {
    /// An outage of the service.
    Outage,
    /// An increase of a list price.
    PriceUp,
    /// Many or old open issues.
    Issues,
    /// A quota that is too small for many subscribers.
    Quota,
    /// A moderate or larger improvement by a competitor.
    Competitor,
    /// A published PMI that shows a contracting economy.
    MacroDown,
    /// A published PMI that shows a growing economy.
    MacroUp,
    /// The completion of an R&D project.
    Research,
}

impl LiveEvent {
    /// Returns the name that the reasons of a judgement use for the event.
    pub fn id(self) -> &'static str {
        match self {
            LiveEvent::Outage => "outage",
            LiveEvent::PriceUp => "price raised",
            LiveEvent::Issues => "open issues",
            LiveEvent::Quota => "quota",
            LiveEvent::Competitor => "rival",
            LiveEvent::MacroDown => "weak economy",
            LiveEvent::MacroUp => "strong economy",
            LiveEvent::Research => "research done",
        }
    }
}

const FOUR_WEEKS: u32 = 28;
const TWO_WEEKS: usize = 14;
const WEEK: usize = 7;

impl JudgeContext {
    /// Computes the context at the end of the last simulated day.
    pub fn from_world(world: &World, params: &Params, lexicon: &Lexicon) -> JudgeContext {
        let chronicle = &world.market.social.chronicle;
        let (today, before) = (chronicle.today(), chronicle.oldest());
        let (issue_rate, issue_age, short) = service_problems(world, params);
        let latencies: Vec<f64> = chronicle.newest_first(WEEK).filter_map(|page| page.p95_ms).collect();
        // A plan that was not on sale four weeks ago had price 0 then, so it never counts as cheaper.
        let cheaper = |plan: &Plan| today.prices[*plan] < before.prices[*plan];
        let mut judge_context = JudgeContext {
            groups: ByGroup::from_fn(|group| reader_group(group, world)),
            subscribers: world.customers.active_by_group().0.iter().sum(),
            research_done: research_ages(world).any(|age| age <= FOUR_WEEKS),
            price_cut: Plan::ALL.iter().any(cheaper) || today.discount > before.discount,
            promotion: today.discount > 0.0,
            quota_up: Plan::ALL.iter().any(|plan| today.quotas[*plan] > before.quotas[*plan]),
            outage_days: chronicle.newest_first(TWO_WEEKS).filter(|page| page.outage).count() as u32,
            overload: chronicle.newest_first(TWO_WEEKS).map(|page| page.overload).fold(0.0, f64::max),
            p95_ms: latencies.iter().sum::<f64>() / latencies.len().max(1) as f64,
            issue_rate,
            issue_age,
            live_events: Vec::new(),
        };
        judge_context.live_events = live_events(world, params, lexicon, &judge_context, short);
        judge_context
    }

    /// Returns the age of an event in days, or `None` if the event is not current.
    pub fn event_age(&self, event: LiveEvent) -> Option<u32> {
        self.live_events.iter().find(|(live, _)| *live == event).map(|(_, age)| *age)
    }
}

fn reader_group(group: Group, world: &World) -> ReaderGroup {
    let group_customers = &world.customers.groups[group];
    let count = group_customers.active_count();
    let sum: f64 = group_customers.blocks.iter().flat_map(|block| &block.satisfaction).sum();
    let satisfaction = if count == 0 { 0.0 } else { sum / f64::from(count) };
    ReaderGroup {
        subscribers: count,
        satisfaction,
        progress: world.market.social.chronicle.quality_change(group),
    }
}

/// Returns the open issues per subscriber, the mean age of open issues in days, and the share of subscribers whose
/// quota is too small.
fn service_problems(world: &World, params: &Params) -> (f64, f64, f64) {
    let core = &world.settings.core;
    let weekday = params.calendar.weekly[(world.day % 7) as usize];
    let (mut count, mut open, mut days, mut short) = (0u32, 0u32, 0u32, 0u32);
    for (_, block) in world.customers.blocks() {
        for at in 0..block.len() {
            count += 1;
            open += u32::from(block.open_issue_days[at] > 0);
            days += block.open_issue_days[at];
            let rate = block.usage_rate[at];
            let quota = core.quotas[block.plan[at]].units();
            let factor = quota_factor(quota, quota_demand(rate * weekday, rate, params), &params.quality);
            short += u32::from(factor < 1.0);
        }
    }
    let ratio = |part: u32, whole: u32| if whole == 0 { 0.0 } else { f64::from(part) / f64::from(whole) };
    (ratio(open, count), ratio(days, open), ratio(short, count))
}

fn research_ages(world: &World) -> impl Iterator<Item = u32> {
    world.product.research.iter().filter_map(|project| project.completed_day).map(|day| world.day - day)
}

fn live_events(
    world: &World,
    params: &Params,
    lexicon: &Lexicon,
    judge_context: &JudgeContext,
    short: f64,
) -> Vec<(LiveEvent, u32)> {
    let (day, events) = (world.day, &lexicon.events);
    let chronicle = &world.market.social.chronicle;
    let age = |page: &Page| day - page.day;
    let raised = |(before, after): &(&Page, &Page)| {
        let rise = |plan: &Plan| {
            before.prices[*plan] > 0.0 && after.prices[*plan] >= before.prices[*plan] * events.price_rise
        };
        Plan::ALL.iter().any(rise)
    };
    let outage = chronicle.newest_first(TWO_WEEKS + 1).find(|page| page.outage).map(age);
    let price_up = chronicle.consecutive_pages().find(raised).map(|(_, after)| age(after));
    let issues = judge_context.issue_rate > events.issue_rate || judge_context.issue_age > events.issue_age;
    let rivals = world.market.competitors.iter().rev();
    let rival = rivals
        .filter(|event| severity(event.boost, &params.competitor) >= Severity::Moderate)
        .map(|event| day - event.day)
        .next();
    let published = world.market.economy.published.as_ref();
    let news = published.map(|reading| {
        let published_day = reading.measured_day + params.economy.macro_pmi_publication_delay_days;
        let event = match reading.trend {
            Trend::Contraction | Trend::SevereContraction => Some(LiveEvent::MacroDown),
            Trend::Expansion | Trend::StrongExpansion => Some(LiveEvent::MacroUp),
            Trend::Neutral => None,
        };
        (event, day.saturating_sub(published_day))
    });
    let economy = |wanted| news.filter(|(event, _)| *event == Some(wanted)).map(|(_, age)| age);
    [
        (LiveEvent::Outage, outage),
        (LiveEvent::PriceUp, price_up),
        (LiveEvent::Issues, issues.then_some(0)),
        (LiveEvent::Quota, (short > events.quota_share).then_some(0)),
        (LiveEvent::Competitor, rival),
        (LiveEvent::MacroDown, economy(LiveEvent::MacroDown)),
        (LiveEvent::MacroUp, economy(LiveEvent::MacroUp)),
        (LiveEvent::Research, research_ages(world).min()),
    ]
    .into_iter()
    .filter_map(|(event, age)| age.filter(|age| *age <= events.kept_days).map(|age| (event, age)))
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::day::step_day;
    use novamind_world::events::Facts;
    use novamind_world::quota::Quota;
    use novamind_world::random::Streams;

    #[test]
    fn price_changes_are_detected_for_four_weeks() {
        let (params, streams) = (Params::bundled(), Streams::new(2));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
        novamind_world::test_kit::apply_policy_p(&mut world);
        let (mut at_day, mut latencies) = (Vec::new(), Vec::new());
        for day in 1..=60 {
            match day {
                20 => world.settings.core.prices.0[1] *= 1.2,
                40 => world.settings.core.quotas.0[0] = Quota::from(120_000),
                50 => world.settings.promotion.global = 2.0,
                _ => {}
            }
            latencies.push(step_day(&mut world, &params, &streams, &mut facts).0.p95_ms);
            at_day.push(JudgeContext::from_world(&world, &params, Lexicon::bundled()));
        }
        let on = |day: usize| &at_day[day - 1];
        assert_eq!(on(19).event_age(LiveEvent::PriceUp), None, "the first prices are not a price increase");
        assert_eq!(
            (on(20).event_age(LiveEvent::PriceUp), on(34).event_age(LiveEvent::PriceUp)),
            (Some(0), Some(14))
        );
        assert_eq!(on(35).event_age(LiveEvent::PriceUp), None);
        assert!(!on(39).quota_up && on(40).quota_up && on(60).quota_up);
        assert!(!on(49).price_cut && on(50).price_cut && on(50).promotion);
        assert_eq!(
            (on(31).event_age(LiveEvent::MacroDown), on(31).event_age(LiveEvent::MacroUp)),
            (None, None)
        );
        assert_eq!(on(60).subscribers, world.customers.active_by_group().0.iter().sum::<u32>());
        let s1 = Group::at(0).expect("S1");
        assert!(on(60).groups[s1].progress > 0.0 && on(60).groups[s1].satisfaction != 0.0);
        let last_week = latencies[53..].iter().sum::<f64>() / 7.0;
        assert!((on(60).p95_ms / last_week - 1.0).abs() < 1e-12);
        let ages: Vec<Option<u32>> = at_day.iter().map(|day| day.event_age(LiveEvent::Outage)).collect();
        for (now, age) in at_day.iter().zip(&ages) {
            assert_eq!(now.outage_days > 0, age.is_some_and(|age| age < 14), "{age:?}");
        }
        assert!(ages.iter().flatten().any(|age| (7..14).contains(age)), "no outage is older than a week");
    }
}
