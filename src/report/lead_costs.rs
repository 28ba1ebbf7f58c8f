//! Cost per lead by channel and group: the last four weeks compared with the cheapest four weeks before them.

use novamind_session::identifiers::{ByGroup, Channel, Group};
use novamind_session::{GroupWeek, PaidLeads};

/// Number of weeks that are combined. A single week has too few leads to compare.
pub const SPELL: usize = 4;
/// Minimum number of leads in a period for its cost per lead to be compared.
pub const ENOUGH: f64 = 20.0;
/// Minimum ratio to the lowest cost per lead that counts as a rise.
pub const RISE: f64 = 2.0;

/// Consecutive weeks of advertising of a channel for a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdSpell {
    /// First and last week.
    pub weeks: (u32, u32),
    /// Number of leads.
    pub leads: u32,
    /// Spending, dollars.
    pub spend: f64,
    /// Individuals among them who were billed. `None` for enterprises, which are billed weeks after they
    /// arrive.
    pub billed: Option<u32>,
}

/// Costs of a channel and group that were advertised in the last four weeks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairCost {
    /// Channel.
    pub channel: Channel,
    /// Group.
    pub group: Group,
    /// The last four weeks.
    pub recent: AdSpell,
    /// The four consecutive earlier weeks with the lowest cost per lead. `None` if no period brought enough
    /// leads.
    pub cheapest: Option<AdSpell>,
}

impl AdSpell {
    fn of(weeks: &[ByGroup<GroupWeek>], from: usize, (channel, group): (Channel, Group)) -> AdSpell {
        let upto = (from + SPELL).min(weeks.len());
        let sum = weeks[from..upto].iter().map(|week| &week[group].paid[channel]).fold(
            PaidLeads::default(),
            |sum, own| PaidLeads {
                leads: sum.leads + own.leads,
                spend: sum.spend + own.spend,
                billed: sum.billed + own.billed,
            },
        );
        AdSpell {
            weeks: (from as u32 + 1, upto as u32),
            leads: sum.leads,
            spend: sum.spend,
            billed: (!group.is_enterprise()).then_some(sum.billed),
        }
    }

    /// Returns dollars per lead; `None` without leads.
    pub fn per_lead(&self) -> Option<f64> {
        (self.leads > 0).then(|| self.spend / f64::from(self.leads))
    }

    /// Returns dollars per first bill; `None` without bills.
    pub fn per_bill(&self) -> Option<f64> {
        self.billed.filter(|billed| *billed > 0).map(|billed| self.spend / f64::from(billed))
    }
}

impl PairCost {
    /// Returns the ratio of the current to the lowest cost per lead if it rose by more than chance explains: at the
    /// lowest cost, the money would have brought enough leads. Without any lead, assumes that the next dollar brings
    /// one.
    pub fn rise(&self) -> Option<f64> {
        let before = self.cheapest?.per_lead()?;
        let now = self.recent.per_lead().unwrap_or(self.recent.spend);
        (self.recent.spend / before >= ENOUGH && now >= RISE * before).then(|| now / before)
    }
}

/// Returns the costs of every pair advertised in the last four weeks, highest spending first.
pub fn pair_costs(weeks: &[ByGroup<GroupWeek>]) -> Vec<PairCost> {
    let last = weeks.len().saturating_sub(SPELL);
    let pairs = Group::all().flat_map(|group| Channel::ALL.map(|channel| (channel, group)));
    let mut costs: Vec<PairCost> = pairs
        .filter_map(|pair| {
            let recent = AdSpell::of(weeks, last, pair);
            let before = (0..(last + 1).saturating_sub(SPELL)).map(|from| AdSpell::of(weeks, from, pair));
            let cheapest = before
                .filter(|spell| f64::from(spell.leads) >= ENOUGH)
                .filter_map(|spell| Some((spell.per_lead()?, spell)))
                .min_by(|left, right| left.0.total_cmp(&right.0))
                .map(|(_, spell)| spell);
            (recent.spend > 0.0).then_some(PairCost { channel: pair.0, group: pair.1, recent, cheapest })
        })
        .collect();
    costs.sort_by(|left, right| right.recent.spend.total_cmp(&left.recent.spend));
    costs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn referrals() -> (Channel, Group) {
        (Channel::ReferralProgram, Group::parse("S3").expect("a group"))
    }

    fn weeks(all: &[(u32, f64, u32)]) -> Vec<ByGroup<GroupWeek>> {
        let week = |&(leads, spend, billed): &(u32, f64, u32)| {
            let mut week: ByGroup<GroupWeek> = ByGroup::default();
            week[referrals().1].paid[referrals().0] = PaidLeads { leads, spend, billed };
            week
        };
        all.iter().map(week).collect()
    }

    #[test]
    fn the_last_four_weeks_stand_beside_the_cheapest_before_them() {
        let dear = [(10, 150.0, 5); 2].into_iter().chain([(20, 150.0, 10); 4]).chain([(5, 600.0, 1); 4]);
        let costs = pair_costs(&weeks(&dear.collect::<Vec<_>>()));
        let [pair] = costs.as_slice() else { panic!("{costs:?}") };
        let cheapest = pair.cheapest.expect("enough leads");
        assert_eq!(
            (pair.channel, pair.group, pair.recent.weeks, cheapest.weeks),
            (referrals().0, referrals().1, (7, 10), (3, 6))
        );
        assert_eq!((pair.recent.per_lead(), cheapest.per_lead()), (Some(120.0), Some(7.5)));
        assert_eq!((pair.recent.per_bill(), cheapest.per_bill()), (Some(600.0), Some(15.0)));
        assert_eq!(pair.rise(), Some(16.0));
    }

    #[test]
    fn few_leads_and_small_budgets_are_no_rise() {
        let few = [(4, 40.0, 1); 4].into_iter().chain([(1, 400.0, 0); 4]).collect::<Vec<_>>();
        assert_eq!(pair_costs(&weeks(&few))[0].cheapest, None, "16 leads are too few to compare");
        let tried = [(20, 200.0, 1); 4].into_iter().chain([(0, 40.0, 0); 4]).collect::<Vec<_>>();
        assert_eq!(pair_costs(&weeks(&tried))[0].rise(), None, "16 leads would have come");
        let dead = [(20, 200.0, 1); 4].into_iter().chain([(0, 60.0, 0); 4]).collect::<Vec<_>>();
        let dead = pair_costs(&weeks(&dead))[0];
        assert_eq!((dead.recent.per_lead(), dead.rise()), (None, Some(24.0)));
        let ended = [(20, 200.0, 1); 4].into_iter().chain([(0, 0.0, 0); 4]).collect::<Vec<_>>();
        assert!(pair_costs(&weeks(&ended)).is_empty(), "no spending in the last four weeks");
        assert!(pair_costs(&[]).is_empty());
    }
}
