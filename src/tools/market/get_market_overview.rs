use serde_json::{Value, json};

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use super::{noise_label, segment};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::identifiers::Group;

/// Shows the known groups and the economy.
pub struct GetMarketOverview;

static SPEC: Spec = Spec {
    id: ToolId::GetMarketOverview,
    code: "MKT",
    module: Module::Market,
    kind: Kind::Read,
    summary: "Show the known groups, how many are still unknown, and the latest published index",
    arguments: &[],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &[],
    returns: &[
        Output {
            name: "known_groups",
            kind: "list of {group_id, group_name, segment, info_level, noise}",
            doc: "by group_id; noise is the largest error of estimates at that level",
        },
        Output { name: "undiscovered_count", kind: "integer", doc: "groups still unknown" },
        Output {
            name: "macroeconomic",
            kind: "{pmi_value, pmi_trend, pmi_change, cycle_phase, description} or null",
            doc: "latest published index of the economy; null before day 31",
        },
    ],
    example: "{}",
};

impl Tool for GetMarketOverview {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, _: &View<'_>, _: &Arguments) -> Result<Command, Refusal> {
        Ok(Command::None)
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, _: &ResolvedCommand) -> Value {
        let mut known: Vec<Group> = view.known_groups().collect();
        known.sort_by_key(|group| group.id());
        let entry = |group: Group| {
            let level = view.world().market.knowledge[group].level;
            json!({
                "group_id": group,
                "group_name": view.params().group(group).name,
                "segment": segment(group),
                "info_level": level,
                "noise": noise_label(view.params().level(level).noise),
            })
        };
        let economy = view.world().market.economy.published.map(|reading| {
            json!({
                "pmi_value": json_number(reading.value),
                "pmi_trend": reading.trend,
                "pmi_change": json_number(reading.change),
                "cycle_phase": reading.phase,
                "description": view.surroundings().describe(&reading),
            })
        });
        json!({
            "known_groups": known.into_iter().map(entry).collect::<Vec<_>>(),
            "undiscovered_count": view.world().market.undiscovered().count(),
            "macroeconomic": economy,
        })
    }
}
