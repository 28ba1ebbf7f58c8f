use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::research::check_affordable;
use super::super::{
    EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId, ToolKind, ToolModule,
    ToolSpec,
};
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::identifiers::Group;

/// The tool `research_market`, which buys an attempt to discover a group.
pub struct ResearchMarket;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::ResearchMarket,
    code: "FIND",
    module: ToolModule::Market,
    kind: ToolKind::Purchase,
    summary: "Pay for one attempt to discover an unknown customer group",
    arguments: &[],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Now,
    effect: "{market_research.market_research_discover_prob:tenths} attempts in ten find one of the unknown groups, all equally likely. A discovered group \
             is known at level 1 at once: it brings leads by word of mouth from the next day, and \
             ads, development, operations and discounts can target it. The number of attempts per week is not limited; \
             once all groups are known, an attempt is still charged.",
    cost: "{market_research.discovery_cost_level_1:$} per attempt, at once",
    written_tables: &["ledger", "segment_discovery", "group_info_levels", "notifications"],
    rejection_codes: &["insufficient_funds"],
    result_fields: &[
        ResultField {
            name: "discovered_group_id",
            kind: "text",
            description: "the group, only if one was found",
        },
        ResultField { name: "cost", kind: "number", description: "$, only if none was found" },
    ],
    example: "{}",
};

/// The result of an attempt to discover a group.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DiscoveryAttempt {
    /// The attempt discovered a group.
    Found {
        /// Group that the player now knows at study level 1.
        discovered_group_id: Group,
    },
    /// The attempt discovered no group.
    Nothing {
        /// Cost of the attempt in dollars.
        cost: f64,
    },
}

impl Tool for ResearchMarket {
    type Args = ();
    type Answer = DiscoveryAttempt;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, _: &Arguments) -> Result<(), Rejection> {
        Ok(())
    }

    fn plan(&self, view: &ToolContext<'_>, (): ()) -> Result<PlannedCall<DiscoveryAttempt>, Rejection> {
        check_affordable(view.params().market_research.discovery_cost_level_1, view)?;
        Ok(PlannedCall::with_draws(Command::ResearchMarket, |resolved| match resolved {
            ResolvedCommand::ResearchMarket(attempt) => Some(match attempt.found {
                Some(group) => DiscoveryAttempt::Found { discovered_group_id: group },
                None => DiscoveryAttempt::Nothing { cost: attempt.cost },
            }),
            _ => None,
        }))
    }
}
