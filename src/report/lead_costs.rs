//! Cost per lead by channel and group: the last four weeks, compared with those four consecutive earlier weeks that had
//! the lowest cost.

use novamind_session::identifiers::{ByGroup, Channel, Group};
use novamind_session::{GroupWeek, PaidLeads};

/// Number of weeks over which the cost per lead is computed. A single week has too few leads for a comparison.
pub const WINDOW_WEEKS: usize = 4;
/// Minimum number of leads in four weeks for comparing the cost per lead.
pub const MIN_LEADS: f64 = 20.0;
/// The cost per lead has risen if it is at least this multiple of the lowest cost per lead.
pub const MIN_RISE_RATIO: f64 = 2.0;

/// Results of the advertising for a group in a channel, over consecutive weeks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdResults {
    /// Numbers of the first and the last week.
    pub weeks: (u32, u32),
    /// Number of leads in these weeks.
    pub leads: u32,
    /// Advertising spending in these weeks, dollars.
    pub spend: f64,
    /// Number of these leads who paid a first bill; `None` for enterprises, which pay their first bill weeks after they
    /// arrive.
    pub first_bills: Option<u32>,
}

/// Lead costs of a channel and group with advertising in the last four weeks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeadCost {
    /// Channel in which the ads run.
    pub channel: Channel,
    /// Group for which the ads run.
    pub group: Group,
    /// Results of the last four weeks.
    pub recent: AdResults,
    /// Results of the four consecutive earlier weeks with the lowest cost per lead. `None` if no such weeks had enough
    /// leads.
    pub cheapest: Option<AdResults>,
}

impl AdResults {
    fn new(weeks: &[ByGroup<GroupWeek>], from: usize, (channel, group): (Channel, Group)) -> AdResults {
        let upto = (from + WINDOW_WEEKS).min(weeks.len());
        let sum = weeks[from..upto].iter().map(|week| &week[group].paid[channel]).fold(
            PaidLeads::default(),
            |sum, paid_leads| PaidLeads {
                leads: sum.leads + paid_leads.leads,
                spend: sum.spend + paid_leads.spend,
                billed: sum.billed + paid_leads.billed,
            },
        );
        AdResults {
            weeks: (from as u32 + 1, upto as u32),
            leads: sum.leads,
            spend: sum.spend,
            first_bills: (!group.is_enterprise()).then_some(sum.billed),
        }
    }

    /// Returns the cost per lead in dollars, or `None` if there are no leads.
    pub fn cost_per_lead(&self) -> Option<f64> {
        (self.leads > 0).then(|| self.spend / f64::from(self.leads))
    }

    /// Returns the cost per first bill in dollars, or `None` if there are no bills.
    pub fn cost_per_bill(&self) -> Option<f64> {
        self.first_bills.filter(|billed| *billed > 0).map(|billed| self.spend / f64::from(billed))
    }
}

impl LeadCost {
    /// Returns the ratio of the current to the lowest cost per lead. Returns `None` if the ratio is below
    /// [`MIN_RISE_RATIO`]. Also returns `None` if the spending would bring fewer than [`MIN_LEADS`] leads at the lowest
    /// cost, because a difference between so few leads can be random. If there are no leads, the total spending counts
    /// as the cost of one lead.
    pub fn cost_rise(&self) -> Option<f64> {
        let before = self.cheapest?.cost_per_lead()?;
        let now = self.recent.cost_per_lead().unwrap_or(self.recent.spend);
        (self.recent.spend / before >= MIN_LEADS && now >= MIN_RISE_RATIO * before).then(|| now / before)
    }
}

/// Returns the lead costs of every channel and group with advertising in the last four weeks, highest spending first.
pub fn lead_costs_by_pair(weeks: &[ByGroup<GroupWeek>]) -> Vec<LeadCost> {
    let last = weeks.len().saturating_sub(WINDOW_WEEKS);
    let pairs = Group::all().flat_map(|group| Channel::ALL.map(|channel| (channel, group)));
    let mut costs: Vec<LeadCost> = pairs
        .filter_map(|pair| {
            let recent = AdResults::new(weeks, last, pair);
            let before =
                (0..(last + 1).saturating_sub(WINDOW_WEEKS)).map(|from| AdResults::new(weeks, from, pair));
            let cheapest = before
                .filter(|spell| f64::from(spell.leads) >= MIN_LEADS)
                .filter_map(|spell| Some((spell.cost_per_lead()?, spell)))
                .min_by(|left, right| left.0.total_cmp(&right.0))
                .map(|(_, spell)| spell);
            (recent.spend > 0.0).then_some(LeadCost { channel: pair.0, group: pair.1, recent, cheapest })
        })
        .collect();
    costs.sort_by(|left, right| right.recent.spend.total_cmp(&left.recent.spend));
    costs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn referral_pair() -> (Channel, Group) {
        (Channel::ReferralProgram, Group::parse("S3").expect("a group"))
    }

    fn weeks(all: &[(u32, f64, u32)]) -> Vec<ByGroup<GroupWeek>> {
        let week = |&(leads, spend, billed): &(u32, f64, u32)| {
            let mut week: ByGroup<GroupWeek> = ByGroup::default();
            week[referral_pair().1].paid[referral_pair().0] = PaidLeads { leads, spend, billed };
            week
        };
        all.iter().map(week).collect()
    }

    #[test]
    fn cost_rise_compares_recent_window_with_cheapest_earlier_window() {
        let dear = [(10, 150.0, 5); 2].into_iter().chain([(20, 150.0, 10); 4]).chain([(5, 600.0, 1); 4]);
        let costs = lead_costs_by_pair(&weeks(&dear.collect::<Vec<_>>()));
        let [pair] = costs.as_slice() else { panic!("{costs:?}") };
        let cheapest = pair.cheapest.expect("enough leads");
        assert_eq!(
            (pair.channel, pair.group, pair.recent.weeks, cheapest.weeks),
            (referral_pair().0, referral_pair().1, (7, 10), (3, 6))
        );
        assert_eq!((pair.recent.cost_per_lead(), cheapest.cost_per_lead()), (Some(120.0), Some(7.5)));
        assert_eq!((pair.recent.cost_per_bill(), cheapest.cost_per_bill()), (Some(600.0), Some(15.0)));
        assert_eq!(pair.cost_rise(), Some(16.0));
    }

    #[test]
    fn cost_rise_ignores_small_samples() {
        let few = [(4, 40.0, 1); 4].into_iter().chain([(1, 400.0, 0); 4]).collect::<Vec<_>>();
        assert_eq!(lead_costs_by_pair(&weeks(&few))[0].cheapest, None, "16 leads are too few to compare");
        let tried = [(20, 200.0, 1); 4].into_iter().chain([(0, 40.0, 0); 4]).collect::<Vec<_>>();
        assert_eq!(lead_costs_by_pair(&weeks(&tried))[0].cost_rise(), None, "16 leads would have come");
        let dead = [(20, 200.0, 1); 4].into_iter().chain([(0, 60.0, 0); 4]).collect::<Vec<_>>();
        let dead = lead_costs_by_pair(&weeks(&dead))[0];
        assert_eq!((dead.recent.cost_per_lead(), dead.cost_rise()), (None, Some(24.0)));
        let ended = [(20, 200.0, 1); 4].into_iter().chain([(0, 0.0, 0); 4]).collect::<Vec<_>>();
        assert!(lead_costs_by_pair(&weeks(&ended)).is_empty(), "no spending in the last four weeks");
        assert!(lead_costs_by_pair(&[]).is_empty());
    }
}
