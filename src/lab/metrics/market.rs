//! Figures of the market: economy, posts, notifications, negotiations and deals.

use super::{
    Aggregation, DailyValue, MetricsDay, initial_groups, push_by_group, push_latest, push_sum, push_value,
};
use novamind_world::events::{DealClosed, EndCause, Notice, Post, Sentiment, SubscriptionStatus, ThreadKind};
use novamind_world::identifiers::{Group, Plan};

/// A function that returns a value of a deal, for a mean over deals.
type DealFigureFn = fn(&DealClosed) -> f64;

impl MetricsDay<'_> {
    pub(super) fn push_market(&self, list: &mut Vec<DailyValue>) {
        let market = &self.xray.world().market;
        let today = market.competitors.iter().filter(|event| event.day == self.report.figures.day);
        let total = |value: fn(&novamind_world::market::competitors::CompetitorEvent) -> f64| {
            today.clone().map(value).sum()
        };
        push_sum(list, "comp_events_cum", total(|_| 1.0));
        push_sum(list, "comp_boost_cum", total(|event| event.boost));
        push_sum(list, "comp_sampled_cum", total(|event| event.sampled));
        push_sum(list, "comp_feedback_wins_cum", total(|event| f64::from(u8::from(event.by_feedback))));
        push_latest(list, "pmi", market.economy.pmi);
        push_value(
            list,
            "pmi_published_last",
            "",
            Aggregation::Latest,
            market.economy.published.map(|reading| reading.value),
        );
    }

    pub(super) fn push_posts(&self, list: &mut Vec<DailyValue>) {
        let posts = || self.xray.facts().posts.iter();
        let count = |customer: bool, tone: Sentiment| {
            let fits = |post: &&Post| post.author.is_some() == customer && post.sentiment == tone;
            posts().filter(fits).count() as f64
        };
        let tones = [
            ("negative", Sentiment::Negative),
            ("neutral", Sentiment::Neutral),
            ("positive", Sentiment::Positive),
        ];
        push_sum(list, "posts_total_cum", posts().count() as f64);
        for (figure, customer) in [("posts_customer_cum", true), ("posts_market_cum", false)] {
            for (name, tone) in tones {
                push_value(list, figure, name, Aggregation::Sum, Some(count(customer, tone)));
            }
        }
    }

    pub(super) fn push_notifications(&self, list: &mut Vec<DailyValue>) {
        let count = |fits: fn(&Notice) -> bool| {
            Some(self.xray.notices().iter().filter(|notice| fits(notice)).count() as f64)
        };
        let timeout = count(|notice| {
            matches!(notice, Notice::LeadLostByTimeout { .. } | Notice::LeadLossRepeated { .. })
        });
        let silent = count(|notice| matches!(notice, Notice::LeadSilent));
        for (kind, value) in [
            ("large_customer_message", count(|notice| notice.kind() == "large_customer_message")),
            ("deal_won", count(|notice| matches!(notice, Notice::DealWon { .. }))),
            ("lead_lost", count(|notice| notice.kind() == "lead_lost")),
            ("lead_lost_timeout", timeout),
            ("lead_lost_ghost", silent),
            ("macro_economic_update", count(|notice| matches!(notice, Notice::EconomyUpdate(_)))),
            ("group_research_complete", count(|notice| matches!(notice, Notice::StudyComplete { .. }))),
            ("research_complete", count(|notice| matches!(notice, Notice::ResearchComplete { .. }))),
        ] {
            push_value(list, "notif_cum", kind, Aggregation::Sum, value);
        }
        let completed =
            self.xray.world().product.research.iter().filter(|project| project.completed_day.is_some());
        push_latest(list, "rnd_completed", completed.count() as f64);
        let market = &self.xray.world().market;
        let discovered = Group::all().filter(|group| !group.is_initially_known() && market.is_known(*group));
        push_latest(list, "discovered", discovered.count() as f64);
        push_latest(list, "discovery_attempts", f64::from(market.attempts));
        push_sum(list, "customers_total", self.xray.facts().arrivals.len() as f64);
    }

    pub(super) fn push_enterprise(&self, list: &mut Vec<DailyValue>) {
        let facts = self.xray.facts();
        let opened = |group: Group| {
            let leads = facts.openings.iter().filter(|opened| opened.status == SubscriptionStatus::Lead);
            let first = facts.arrivals.first().map_or(0, |arrival| arrival.customer);
            let of = |customer: u32| facts.arrivals[(customer - first) as usize].group;
            leads.filter(|lead| of(lead.customer) == group).count() as f64
        };
        push_by_group(list, "ent_new_leads_cum", Aggregation::Sum, opened);
        for kind in ThreadKind::ALL {
            let started = facts.turns.iter().filter(|turn| turn.number == 0);
            let opened = match kind {
                // A thread that the player started between two days is counted on the next day.
                ThreadKind::Renegotiation => f64::from(self.threads_opened) - started.count() as f64,
                _ => started.filter(|turn| turn.kind == kind).count() as f64,
            };
            push_value(list, "ent_threads_opened_cum", kind.id(), Aggregation::Sum, Some(opened));
        }
        self.push_deals(list);
        push_by_group(list, "ent_lost_cum", Aggregation::Sum, |group| {
            let lost = |cause: EndCause| matches!(cause, EndCause::LeadTimeout | EndCause::LeadSilent);
            facts.endings.iter().filter(|ending| ending.group == group && lost(ending.cause)).count() as f64
        });
        push_by_group(list, "ent_cancel_cum", Aggregation::Sum, |group| self.companies_left[group]);
    }

    fn push_deals(&self, list: &mut Vec<DailyValue>) {
        let deals: Vec<(Group, &DealClosed)> = self.deals_by_group();
        let of = |group: Group| {
            deals.iter().filter(move |(deal_group, _)| *deal_group == group).map(|(_, deal)| *deal)
        };
        push_by_group(list, "ent_accepted_cum", Aggregation::Sum, |group| of(group).count() as f64);
        for kind in ThreadKind::ALL {
            let count = deals.iter().filter(|(_, deal)| deal.kind == kind).count();
            push_value(list, "ent_accepted_type_cum", kind.id(), Aggregation::Sum, Some(count as f64));
        }
        for plan in Plan::ALL {
            let count = deals.iter().filter(|(_, deal)| deal.plan == plan).count();
            push_value(list, "ent_accepted_plan_cum", plan.id(), Aggregation::Sum, Some(count as f64));
        }
        let means: [(&'static str, DealFigureFn); 4] = [
            ("ent_acc_agent_turns_mean", |deal| f64::from(deal.agent_turns)),
            ("ent_acc_days_mean", |deal| f64::from(deal.days)),
            ("ent_acc_price_mean", |deal| deal.price),
            ("ent_acc_seats_mean", |deal| f64::from(deal.seats)),
        ];
        for (figure, value) in means {
            for group in initial_groups().filter(|group| group.is_enterprise()) {
                let kind = Aggregation::Mean { weight: of(group).count() as f64 };
                push_value(list, figure, group.id(), kind, Some(of(group).map(value).sum()));
            }
        }
    }

    fn deals_by_group(&self) -> Vec<(Group, &DealClosed)> {
        let customers = &self.xray.world().customers;
        let deals = self.xray.facts().deals.iter();
        deals.filter_map(|deal| Some((customers.find(deal.customer)?.0, deal))).collect()
    }
}
