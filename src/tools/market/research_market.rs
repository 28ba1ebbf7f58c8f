use serde_json::{Value, json};

use super::super::arguments::Arguments;
use super::super::research::affordable;
use super::super::{Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};

/// Pays for an attempt to find a group.
pub struct ResearchMarket;

static SPEC: Spec = Spec {
    id: ToolId::ResearchMarket,
    code: "FIND",
    module: Module::Market,
    kind: Kind::Purchase,
    summary: "Pay for one attempt to find an unknown customer group",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Now,
    effect: "Three attempts in ten find one of the groups still unknown, each equally likely. A group that \
             is found is known at level 1 at once: it sends leads by word of mouth from the next day, and \
             ads, development, operations and discounts can be aimed at it. Any number of attempts a week; \
             once all groups are found, an attempt is still charged.",
    cost: "$25,000 an attempt, at once",
    writes: &["ledger", "segment_discovery", "group_info_levels", "notifications"],
    refusals: &["insufficient_funds"],
    returns: &[
        Output { name: "discovered_group_id", kind: "text", doc: "the group, only if one was found" },
        Output { name: "cost", kind: "number", doc: "$, only if none was found" },
    ],
    example: "{}",
};

impl Tool for ResearchMarket {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, _: &Arguments) -> Result<Command, Refusal> {
        affordable(view.params().market_research.discovery_cost_level_1, view)?;
        Ok(Command::ResearchMarket)
    }

    fn answer(&self, _: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        let ResolvedCommand::ResearchMarket(attempt) = resolved else { return Value::Null };
        match attempt.found {
            Some(group) => json!({ "discovered_group_id": group }),
            None => json!({ "cost": json_number(attempt.cost) }),
        }
    }
}
