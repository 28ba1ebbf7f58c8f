use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::research::affordable;
use super::super::{Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When};
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::identifiers::Group;

/// The tool `research_market`.
pub struct ResearchMarket;

static SPEC: Spec = Spec {
    id: ToolId::ResearchMarket,
    code: "FIND",
    module: Module::Market,
    kind: Kind::Purchase,
    summary: "Pay for one attempt to discover an unknown customer group",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Now,
    effect: "{market_research.market_research_discover_prob:tenths} attempts in ten find one of the unknown groups, all equally likely. A discovered group \
             is known at level 1 at once: it brings leads by word of mouth from the next day, and \
             ads, development, operations and discounts can target it. The number of attempts per week is not limited; \
             once all groups are known, an attempt is still charged.",
    cost: "{market_research.discovery_cost_level_1:$} per attempt, at once",
    writes: &["ledger", "segment_discovery", "group_info_levels", "notifications"],
    refusals: &["insufficient_funds"],
    returns: &[
        Output { name: "discovered_group_id", kind: "text", doc: "the group, only if one was found" },
        Output { name: "cost", kind: "number", doc: "$, only if none was found" },
    ],
    example: "{}",
};

/// Result of an attempt to discover a group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DiscoveryAttempt {
    /// A group was discovered.
    Found {
        /// The group.
        discovered_group_id: Group,
    },
    /// No group was discovered.
    Nothing {
        /// Cost, dollars.
        cost: f64,
    },
}

impl Tool for ResearchMarket {
    type Args = ();
    type Answer = DiscoveryAttempt;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, _: &Arguments) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, view: &View<'_>, (): ()) -> Result<Planned<DiscoveryAttempt>, Refusal> {
        affordable(view.params().market_research.discovery_cost_level_1, view)?;
        Ok(Planned::drawing(Command::ResearchMarket, |resolved| match resolved {
            ResolvedCommand::ResearchMarket(attempt) => Some(match attempt.found {
                Some(group) => DiscoveryAttempt::Found { discovered_group_id: group },
                None => DiscoveryAttempt::Nothing { cost: attempt.cost },
            }),
            _ => None,
        }))
    }
}
