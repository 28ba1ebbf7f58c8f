//! The market: discovery, leads, reputation, social media, competitors and the economy.

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
    /// Reputation of the company in each group.
    pub reputation: reputation::Reputations,
    /// Accumulated drift of expectations and budgets.
    pub drift: drift::DriftTotals,
    /// Channel yields: leads per 1,000 dollars of advertising, by channel and group.
    pub yields: ByChannel<ByGroup<f64>>,
    /// State of the economy.
    pub economy: economy::Economy,
    /// All past competitor events.
    pub competitors: Vec<competitors::CompetitorEvent>,
    /// All demand surges that have been drawn.
    pub surges: Vec<surges::Surge>,
    /// The player's knowledge of each group.
    pub knowledge: ByGroup<Knowledge>,
    /// Number of past attempts to discover a group.
    pub attempts: u32,
    /// Market studies in progress, in the order of purchase.
    pub studies: Vec<Study>,
    /// State of social media.
    pub social: social::Social,
}

canonical! {
    Market { reputation, drift, yields, economy, competitors, surges, knowledge, attempts, studies, social }
}

impl Market {
    /// Returns the market on day 0.
    pub fn initial(params: &Params) -> Market {
        let knowledge = |group: Group| {
            let known = group.is_initially_known();
            let initial = &params.initial;
            Knowledge {
                level: if known {
                    initial.initial_group_info_level
                } else {
                    initial.discoverable_group_info_level
                },
                discovered_day: known.then_some(0),
                last_research_day: known.then_some(0),
                snapshot: discovery::initial_snapshot(group, params),
            }
        };
        Market {
            reputation: reputation::Reputations::initial(params),
            drift: drift::DriftTotals::default(),
            yields: params.starting_yields(),
            economy: economy::Economy::initial(params),
            competitors: Vec::new(),
            surges: Vec::new(),
            knowledge: ByGroup::from_fn(knowledge),
            attempts: 0,
            studies: Vec::new(),
            social: social::Social::initial(&Settings::initial(params)),
        }
    }

    /// Returns whether the player knows a group.
    pub fn is_known(&self, group: Group) -> bool {
        self.knowledge[group].level >= 1
    }
}
