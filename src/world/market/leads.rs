//! The daily number of leads of each group (docs/mechanics/market/leads.md).

use super::Market;
use super::economy::Dimension;
use super::social::own_posts::social_multiplier;
use super::surges::surge_factor;
use crate::canonical::canonical;
use crate::events::Source;
use crate::fault::Fault;
use crate::identifiers::{ByChannel, ByGroup, Channel, Group};
use crate::params::{Leads, Params};
use crate::settings::TargetedAds;

/// Factors from which today's expected leads of a group are computed. Hidden from the player.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeadFactors {
    /// Factor from the company's reputation in the group.
    pub reputation: f64,
    /// Factor from market saturation, 0..=1. The factor falls as the number of subscribers rises.
    pub saturation: f64,
    /// Calendar factor: weekday factor times day-of-month factor.
    pub calendar: f64,
    /// Factor from the economy; 1 is neutral.
    pub economy: f64,
    /// Factor from the reactions to the company's posts; 1 is neutral.
    pub social: f64,
    /// Factor from demand surges, or 1 if there is no surge.
    pub surge: f64,
    /// Leads of each paid channel, before the factors are applied.
    pub paid: ByChannel<f64>,
    /// Leads by word of mouth, before the factors are applied.
    pub network: f64,
}

canonical! { LeadFactors { reputation, saturation, calendar, economy, social, surge, paid, network } }

impl LeadFactors {
    /// Returns the expected number of leads: the product of all factors, times the sum of paid leads and leads by word
    /// of mouth.
    pub fn expected(&self) -> f64 {
        let paid: f64 = self.paid.iter().sum();
        self.reputation
            * self.saturation
            * self.calendar
            * self.economy
            * self.social
            * self.surge
            * (paid + self.network)
    }

    /// Picks the source of a lead with a uniform draw `u`, in proportion to each source's share of today's leads. In
    /// the order of the sources, paid channels precede word of mouth.
    pub fn pick_source(&self, u: f64) -> Source {
        let total = self.paid.iter().sum::<f64>() + self.network;
        if total <= 0.0 {
            return Source::Organic;
        }
        let mut rest = u * total;
        for channel in Channel::ALL {
            if rest < self.paid[channel] {
                return Source::from_channel(channel);
            }
            rest -= self.paid[channel];
        }
        if self.network > 0.0 {
            return Source::Network;
        }
        // Because of rounding, the draw can be above the sum of all contributions.
        let last = Channel::ALL.into_iter().rev().find(|channel| self.paid[*channel] > 0.0);
        last.map_or(Source::Organic, Source::from_channel)
    }
}

/// Returns the size of a group's market on a day, in individuals or enterprises.
pub fn market_cap(base: f64, annual_growth: f64, day: u32, leads: &Leads) -> f64 {
    base * (1.0 + annual_growth * f64::from(day) / leads.days_per_year)
}

/// Returns the saturation factor: max(0, 1 - (N / cap)^2). The factor is 1 if there are no subscribers or the cap is 0.
pub fn saturation(subscribers: u32, cap: f64, leads: &Leads) -> f64 {
    if subscribers == 0 || cap <= 0.0 {
        return 1.0;
    }
    let taken = libm::pow(f64::from(subscribers) / cap, leads.saturation_exponent);
    (leads.saturation_base - taken).max(leads.saturation_floor)
}

/// Returns the leads from an advertising budget before the factors are applied: dollars times leads per 1,000 dollars.
pub fn paid_leads(spend: f64, leads_per_unit: f64, leads: &Leads) -> f64 {
    spend * leads_per_unit / leads.ad_spend_unit
}

/// Inputs from which the leads of a day are computed.
pub struct LeadContext<'a> {
    /// Day for which the leads are computed.
    pub day: u32,
    /// Calendar factor: weekday factor times day-of-month factor.
    pub calendar: f64,
    /// Market whose reputation, yields, economy and surges determine the leads.
    pub market: &'a Market,
    /// Active subscriptions of each group after today's cancellations.
    pub subscribers: &'a ByGroup<u32>,
    /// Advertising budgets by channel and group.
    pub ads: &'a TargetedAds,
    /// Parameters of the run.
    pub params: &'a Params,
}

/// Returns the leads by word of mouth before the factors are applied, for each group whose subscribers bring leads.
pub fn word_of_mouth<'a>(
    group: Group,
    context: &'a LeadContext<'_>,
) -> impl Iterator<Item = (Group, f64)> + use<'a> {
    let &LeadContext { market, subscribers, params, .. } = context;
    let is_swapped = params.has_fault(Fault::ReferralsSwapped);
    let rate = move |source| {
        let (from, to) = if is_swapped { (group, source) } else { (source, group) };
        params.referral_rate(from, to)
    };
    Group::all()
        .filter(|source| market.is_known(*source) && subscribers[*source] > 0)
        .map(move |source| (source, f64::from(subscribers[source]) * rate(source)))
}

/// Returns the lead factors of a discovered group.
pub fn lead_factors(group: Group, context: &LeadContext<'_>) -> LeadFactors {
    let &LeadContext { day, calendar, market, subscribers, ads, params } = context;
    let group_params = params.group(group);
    let cap =
        market_cap(group_params.base_market_cap, group_params.annual_cap_growth_rate, day, &params.leads);
    let paid = |channel: Channel| {
        let spend = ads.spend(channel, group);
        if spend > 0.0 { paid_leads(spend, market.yields[channel][group], &params.leads) } else { 0.0 }
    };
    let network = word_of_mouth(group, context).map(|(_, leads)| leads).sum();
    LeadFactors {
        reputation: market.reputation.get(group),
        saturation: saturation(subscribers[group], cap, &params.leads),
        calendar,
        economy: market.economy.multiplier(group, Dimension::LeadGeneration, params),
        social: social_multiplier(group, day, &market.social.own, &params.ceo_posts),
        surge: surge_factor(day, &market.surges, params.fidelity.surge_start),
        paid: ByChannel::from_fn(paid),
        network,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::market::social::own_posts::OwnPost;
    use crate::market::surges::Surge;
    use indexmap::IndexMap;

    fn group(id: &str) -> Group {
        Group::parse(id).expect("a group")
    }

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() <= 1e-9 * expected.abs(), "got {actual}, expected {expected}");
    }

    #[test]
    fn expected_leads_is_the_product_of_all_factors() {
        let params = Params::bundled();
        let mut market = Market::initial(&params);
        market.economy.pmi = 45.0;
        market.economy.started = true;
        market.reputation.set(group("S1"), 0.62);
        let mut effects = ByGroup::default();
        effects[group("S1")] = 0.9;
        market.social.own.push(OwnPost { effects: Some(effects), ..OwnPost::new(0, "a post", None) });
        market.surges.push(Surge { day: 1, end_day: 9, multiplier: 2.5 });
        let mut subscribers = ByGroup::default();
        for (id, count) in [("S1", 2000), ("S3", 300), ("E3", 2)] {
            subscribers[group(id)] = count;
        }
        let spend = |pairs: &[(&str, f64)]| pairs.iter().map(|&(id, spend)| (group(id), spend)).collect();
        let ads = TargetedAds {
            targeted_spend: IndexMap::from([
                (Channel::SocialMedia, spend(&[("S1", 500.0), ("E1", 1000.0)])),
                (Channel::ContentMarketing, spend(&[("S1", 750.0), ("D_S01", 100.0)])),
                (Channel::Linkedin, spend(&[("S1", 0.0)])),
            ]),
        };
        let context = LeadContext {
            day: 3,
            calendar: 1.1,
            market: &market,
            subscribers: &subscribers,
            ads: &ads,
            params: &params,
        };
        for (id, saturation, economy, social, paid, network, expected) in [
            ("S1", 0.9999461115691, 0.85, 1.09375, 302.563425, 59.872186, 574.4719572974636),
            ("S2", 1.0, 0.925, 1.0, 0.0, 2.83256, 3.60266225),
            ("S3", 0.9999875759510, 0.91, 1.0, 0.0, 8.541866, 10.687877044142),
            ("E1", 1.0, 0.865, 1.0, 0.1038, 2.04596, 2.5568708),
            ("E2", 1.0, 0.955, 1.0, 0.0, 2.37356, 3.116780975),
            ("E3", 0.9997840920872, 0.94, 1.0, 0.0, 1.719662, 2.222183244442),
        ] {
            let factors = lead_factors(group(id), &context);
            assert_near(factors.saturation, saturation);
            assert_near(factors.economy, economy);
            assert_near(factors.social, social);
            assert_near(factors.paid.iter().sum::<f64>(), paid);
            assert_near(factors.network, network);
            assert_near(factors.expected(), expected);
        }
    }

    #[test]
    fn saturation_decreases_with_market_share() {
        let leads = Params::bundled().leads;
        assert_near(saturation(136_000, market_cap(272_000.0, 0.2, 0, &leads), &leads), 0.75);
        assert_near(saturation(136_000, market_cap(272_000.0, 0.2, 250, &leads), &leads), 0.806611990129);
        assert_near(saturation(600, market_cap(1190.0, 0.14, 100, &leads), &leads), 0.764215155299);
        assert_eq!(saturation(140, market_cap(136.0, 0.1, 0, &leads), &leads), 0.0);
        assert_eq!(saturation(0, 0.0, &leads), 1.0);
        assert_near(market_cap(272_000.0, 0.2, 365, &leads), 326_400.0);
        assert_near(market_cap(136.0, 0.1, 500, &leads), 154.630136986301);
    }

    #[test]
    fn first_campaign_leads_are_yield_times_calendar_factor() {
        let params = Params::bundled();
        let market = Market::initial(&params);
        let subscribers = ByGroup::default();
        let ads = TargetedAds {
            targeted_spend: IndexMap::from([(
                Channel::SearchAds,
                [(group("S1"), 1000.0)].into_iter().collect(),
            )]),
        };
        for (day, calendar, expected) in [(7, 1.0, 62.29245), (6, 0.6, 37.37547)] {
            let context = LeadContext {
                day,
                calendar,
                market: &market,
                subscribers: &subscribers,
                ads: &ads,
                params: &params,
            };
            assert_near(lead_factors(group("S1"), &context).expected(), expected);
        }
    }

    #[test]
    fn sources_are_picked_in_proportion() {
        let mut factors = LeadFactors { network: 30.0, ..LeadFactors::default() };
        factors.paid[Channel::SearchAds] = 50.0;
        factors.paid[Channel::ReferralProgram] = 20.0;
        for (u, source) in
            [(0.0, "search_ads"), (0.499, "search_ads"), (0.501, "referral_program"), (0.71, "network")]
        {
            assert_eq!(factors.pick_source(u).id(), source, "{u}");
        }
        assert_eq!(LeadFactors::default().pick_source(0.5), Source::Organic);
    }
}
