//! The market around the company: who hears of it, what they think, what rivals and the economy do.

pub mod arrivals;
pub mod competitors;
pub mod discovery;
pub mod economy;
pub mod insights;
pub mod lead_sample;
pub mod leads;
pub mod social;
pub mod studies;
pub mod surges;
pub mod yields;

use super::canonical::canonical;
use super::customers::drift;
use super::events::{Knowledge, Study};
use super::identifiers::{ByChannel, ByGroup, Group};
use super::params::Params;
use super::reputation;
use super::settings::Settings;

/// The hidden state of the market.
#[derive(Debug, Clone, PartialEq)]
pub struct Market {
    /// Reputation by group.
    pub reputation: reputation::ReputationBook,
    /// How much expectations and budgets have moved.
    pub drift: drift::DriftTotals,
    /// Leads a day for 1,000 dollars a day, by channel and group.
    pub yields: ByChannel<ByGroup<f64>>,
    /// The economy.
    pub economy: economy::Economy,
    /// Competitor events so far.
    pub competitors: Vec<competitors::Event>,
    /// Demand surges drawn so far.
    pub surges: Vec<surges::Surge>,
    /// What the company knows about each group.
    pub knowledge: ByGroup<Knowledge>,
    /// Attempts to find a group so far.
    pub attempts: u32,
    /// Studies of groups that run, in the order in which they were ordered.
    pub studies: Vec<Study>,
    /// Social media.
    pub social: social::Social,
}

canonical! {
    Market { reputation, drift, yields, economy, competitors, surges, knowledge, attempts, studies, social }
}

impl Market {
    /// The market of day 0.
    pub fn opening(params: &Params) -> Market {
        let knowledge = |group: Group| {
            let known = group.initially_known();
            let initial = &params.initial;
            Knowledge {
                level: if known {
                    initial.initial_group_info_level
                } else {
                    initial.discoverable_group_info_level
                },
                discovered_day: known.then_some(0),
                last_research_day: known.then_some(0),
                snapshot: discovery::opening_snapshot(group, params),
            }
        };
        Market {
            reputation: reputation::ReputationBook::opening(params),
            drift: drift::DriftTotals::default(),
            yields: params.starting_yields(),
            economy: economy::Economy::opening(params),
            competitors: Vec::new(),
            surges: Vec::new(),
            knowledge: ByGroup::from_fn(knowledge),
            attempts: 0,
            studies: Vec::new(),
            social: social::Social::opening(&Settings::opening(params)),
        }
    }

    /// Whether a group has been discovered.
    pub fn is_known(&self, group: Group) -> bool {
        self.knowledge[group].level >= 1
    }
}
