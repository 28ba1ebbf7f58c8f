use serde_json::{Map, Value, json};

use super::super::arguments::Arguments;
use super::super::{Argument, ArgumentKind, Kind, Module, Output, Refusal, Spec, Tool, ToolId, View, When};
use super::{known_group, noise_label, segment};
use crate::notation::json_number;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::identifiers::Group;
use crate::world::market::insights::Insights;

/// Tells what is known of a group.
pub struct GetGroupInsights;

static SPEC: Spec = Spec {
    id: ToolId::GetGroupInsights,
    code: "INS",
    module: Module::Market,
    kind: Kind::Read,
    summary: "Show the estimates of a known group, as of its last study",
    arguments: &[Argument {
        name: "group_id",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "group",
        doc: "a known group, for instance S1",
    }],
    own_unknown: false,
    whole: None,
    when: When::Never,
    effect: "",
    cost: "nothing",
    writes: &[],
    refusals: &["group_not_discovered"],
    returns: &[
        Output { name: "group_id", kind: "text", doc: "the group" },
        Output { name: "group_name", kind: "text", doc: "its name" },
        Output { name: "segment", kind: "Individual or Enterprise", doc: "its segment" },
        Output { name: "info_level", kind: "integer", doc: "level of knowledge, 1 to 5" },
        Output { name: "noise", kind: "text", doc: "largest error of the estimates" },
        Output {
            name: "estimates",
            kind: "{willingness_to_pay, usage_volume, quality_floor_q_min, contract_lockin_aversion, market_cap, \
                   annual_market_cap_growth_rate}, for companies also {seat_range, decision_rounds, \
                   avg_response_days}",
            doc: "means of the group: $/month, units/day (of companies per seat), quality, customers, share a year, \
                  days; budget, quality floor and market as of the last study",
        },
        Output {
            name: "network_influence",
            kind: "{outgoing, incoming}: map group -> number",
            doc: "leads per subscriber and day that the group brings to known groups, and they to it",
        },
        Output {
            name: "reputation_influence",
            kind: "{outgoing, incoming}: map group -> number",
            doc: "weight of its reputation for known groups, and of theirs for it, 0 to 1",
        },
    ],
    example: r#"{"group_id": "S1"}"#,
};

impl Tool for GetGroupInsights {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        known_group(arguments, view).map(Command::ReadInsights)
    }

    fn answer(&self, view: &View<'_>, _: &Arguments, resolved: &ResolvedCommand) -> Value {
        let ResolvedCommand::ReadInsights(Some(insights)) = resolved else { return Value::Null };
        json!({
            "group_id": insights.group,
            "group_name": view.params().group(insights.group).name,
            "segment": segment(insights.group),
            "info_level": insights.level,
            "noise": noise_label(insights.noise),
            "estimates": estimates(insights),
            "network_influence": {
                "outgoing": links(&insights.referrals_to),
                "incoming": links(&insights.referrals_from),
            },
            "reputation_influence": {
                "outgoing": links(&insights.reputation_to),
                "incoming": links(&insights.reputation_from),
            },
        })
    }
}

fn estimates(insights: &Insights) -> Value {
    let mut estimates = json!({
        "willingness_to_pay": json_number(insights.willingness_to_pay),
        "usage_volume": json_number(insights.usage_volume),
        "quality_floor_q_min": json_number(insights.quality_floor),
        "contract_lockin_aversion": json_number(insights.lockin_aversion),
        "market_cap": insights.market_cap,
        "annual_market_cap_growth_rate": json_number(insights.growth_rate),
    });
    if let Some(company) = &insights.company {
        estimates["seat_range"] = json!([company.seats_least, company.seats_most]);
        estimates["decision_rounds"] = json!(company.decision_rounds);
        estimates["avg_response_days"] = json_number(company.response_days);
    }
    estimates
}

fn links(list: &[(Group, f64)]) -> Map<String, Value> {
    list.iter().map(|(group, value)| (group.id().to_owned(), json_number(*value))).collect()
}
