//! Figures of the market: economy, posts, notices, negotiations and deals.

use super::{Daily, Day, Kind, by_group, initial, now, push, sum};
use novamind_world::events::{DealClosed, EndCause, Notice, Post, Sentiment, SubscriptionStatus, ThreadKind};
use novamind_world::identifiers::{Group, Plan};

/// A value that is averaged over deals.
type PerDeal = fn(&DealClosed) -> f64;

impl Day<'_> {
    pub(super) fn market(&self, list: &mut Vec<Daily>) {
        let market = &self.xray.world().market;
        let today = market.competitors.iter().filter(|event| event.day == self.report.figures.day);
        let total =
            |value: fn(&novamind_world::market::competitors::Event) -> f64| today.clone().map(value).sum();
        sum(list, "comp_events_cum", total(|_| 1.0));
        sum(list, "comp_boost_cum", total(|event| event.boost));
        sum(list, "comp_sampled_cum", total(|event| event.sampled));
        sum(list, "comp_feedback_wins_cum", total(|event| f64::from(u8::from(event.by_feedback))));
        now(list, "pmi", market.economy.pmi);
        push(
            list,
            "pmi_published_last",
            "",
            Kind::Now,
            market.economy.published.map(|reading| reading.value),
        );
    }

    pub(super) fn posts(&self, list: &mut Vec<Daily>) {
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
        sum(list, "posts_total_cum", posts().count() as f64);
        for (figure, customer) in [("posts_customer_cum", true), ("posts_market_cum", false)] {
            for (name, tone) in tones {
                push(list, figure, name, Kind::Sum, Some(count(customer, tone)));
            }
        }
    }

    pub(super) fn notices(&self, list: &mut Vec<Daily>) {
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
            push(list, "notif_cum", kind, Kind::Sum, value);
        }
        let completed =
            self.xray.world().product.research.iter().filter(|project| project.completed_day.is_some());
        now(list, "rnd_completed", completed.count() as f64);
        let market = &self.xray.world().market;
        let discovered = Group::all().filter(|group| !group.initially_known() && market.is_known(*group));
        now(list, "discovered", discovered.count() as f64);
        now(list, "discovery_attempts", f64::from(market.attempts));
        sum(list, "customers_total", self.xray.facts().arrivals.len() as f64);
    }

    pub(super) fn enterprise(&self, list: &mut Vec<Daily>) {
        let facts = self.xray.facts();
        let opened = |group: Group| {
            let leads = facts.openings.iter().filter(|opened| opened.status == SubscriptionStatus::Lead);
            let first = facts.arrivals.first().map_or(0, |arrival| arrival.customer);
            let of = |customer: u32| facts.arrivals[(customer - first) as usize].group;
            leads.filter(|lead| of(lead.customer) == group).count() as f64
        };
        by_group(list, "ent_new_leads_cum", Kind::Sum, opened);
        for kind in ThreadKind::ALL {
            let begun = facts.turns.iter().filter(|turn| turn.number == 0);
            let opened = match kind {
                // Threads that the player started between two days count for the next day.
                ThreadKind::Renegotiation => f64::from(self.threads_opened) - begun.count() as f64,
                _ => begun.filter(|turn| turn.kind == kind).count() as f64,
            };
            push(list, "ent_threads_opened_cum", kind.id(), Kind::Sum, Some(opened));
        }
        self.deals(list);
        by_group(list, "ent_lost_cum", Kind::Sum, |group| {
            let lost = |cause: EndCause| matches!(cause, EndCause::LeadTimeout | EndCause::LeadSilent);
            facts.endings.iter().filter(|ending| ending.group == group && lost(ending.cause)).count() as f64
        });
        by_group(list, "ent_cancel_cum", Kind::Sum, |group| self.companies_left[group]);
    }

    fn deals(&self, list: &mut Vec<Daily>) {
        let deals: Vec<(Group, &DealClosed)> = self.deals_by_group();
        let of = |group: Group| deals.iter().filter(move |(own, _)| *own == group).map(|(_, deal)| *deal);
        by_group(list, "ent_accepted_cum", Kind::Sum, |group| of(group).count() as f64);
        for kind in ThreadKind::ALL {
            let count = deals.iter().filter(|(_, deal)| deal.kind == kind).count();
            push(list, "ent_accepted_type_cum", kind.id(), Kind::Sum, Some(count as f64));
        }
        for plan in Plan::ALL {
            let count = deals.iter().filter(|(_, deal)| deal.plan == plan).count();
            push(list, "ent_accepted_plan_cum", plan.id(), Kind::Sum, Some(count as f64));
        }
        let means: [(&'static str, PerDeal); 4] = [
            ("ent_acc_agent_turns_mean", |deal| f64::from(deal.agent_turns)),
            ("ent_acc_days_mean", |deal| f64::from(deal.days)),
            ("ent_acc_price_mean", |deal| deal.price),
            ("ent_acc_seats_mean", |deal| f64::from(deal.seats)),
        ];
        for (figure, value) in means {
            for group in initial().filter(|group| group.is_enterprise()) {
                let kind = Kind::Mean { weight: of(group).count() as f64 };
                push(list, figure, group.id(), kind, Some(of(group).map(value).sum()));
            }
        }
    }

    fn deals_by_group(&self) -> Vec<(Group, &DealClosed)> {
        let customers = &self.xray.world().customers;
        let deals = self.xray.facts().deals.iter();
        deals.filter_map(|deal| Some((customers.find(deal.customer)?.0, deal))).collect()
    }
}
