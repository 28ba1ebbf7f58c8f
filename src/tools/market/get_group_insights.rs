use indexmap::IndexMap;
use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId,
    ToolKind, ToolModule, ToolSpec,
};
use super::{margin_of_error_label, not_discovered_rejection, parse_group_argument, segment_label};
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::identifiers::Group;
use novamind_world::market::insights::Insights;

/// The tool `get_group_insights`, which returns the estimates of a known group.
pub struct GetGroupInsights;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::GetGroupInsights,
    code: "INS",
    module: ToolModule::Market,
    kind: ToolKind::Read,
    summary: "Show the estimates of a known group, as of its last study",
    arguments: &[Argument {
        name: "group_id",
        alias: None,
        kind: ArgumentKind::Text,
        required: true,
        unit: "group",
        description: "a known group, for instance S1",
    }],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &["group_not_discovered"],
    result_fields: &[
        ResultField { name: "group_id", kind: "text", description: "the group" },
        ResultField { name: "group_name", kind: "text", description: "its name" },
        ResultField { name: "segment", kind: "Individual or Enterprise", description: "its segment" },
        ResultField {
            name: "info_level",
            kind: "integer",
            description: "study level, 1 to {group_research.max_target_level}",
        },
        ResultField { name: "noise", kind: "text", description: "maximum error of the estimates" },
        ResultField {
            name: "estimates",
            kind: "{willingness_to_pay, usage_volume, quality_floor_q_min, contract_lockin_aversion, market_cap, \
                   annual_market_cap_growth_rate}, for enterprises also {seat_range, decision_rounds, \
                   avg_response_days}",
            description: "means of the group: $/month, units/day (per seat for enterprises), quality, customers, share per year, \
                  days; budget, required quality and market as of the last study",
        },
        ResultField {
            name: "network_influence",
            kind: "{outgoing, incoming}: map group -> number",
            description: "leads per subscriber and day from the group to known groups, and from them to it",
        },
        ResultField {
            name: "reputation_influence",
            kind: "{outgoing, incoming}: map group -> number",
            description: "weight of its reputation for known groups, and of theirs for it, 0 to 1",
        },
    ],
    example: r#"{"group_id": "S1"}"#,
};

/// Estimates of a group as of its last study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupInsights {
    /// Identifier of the group.
    pub group_id: Group,
    /// Name of the group.
    pub group_name: String,
    /// Segment of the group: Individual or Enterprise.
    pub segment: &'static str,
    /// Study level, 1 to 5.
    pub info_level: u8,
    /// Margin of error of the estimates, as text, for example `±40%`.
    pub noise: String,
    /// Estimated means of the group's parameters.
    pub estimates: Estimates,
    /// Leads per subscriber per day that the group brings to known groups, and that known groups bring to the group.
    pub network_influence: Influence,
    /// Weight of the group's reputation for known groups, and weight of their reputations for the group.
    pub reputation_influence: Influence,
}

/// Estimated means of a group's parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimates {
    /// Mean budget in dollars per month, for enterprises per seat.
    pub willingness_to_pay: f64,
    /// Mean usage in units per day, for enterprises per seat.
    pub usage_volume: f64,
    /// Mean of the lowest quality that a customer accepts.
    pub quality_floor_q_min: f64,
    /// Aversion to long contracts.
    pub contract_lockin_aversion: f64,
    /// Market cap in individuals or enterprises.
    pub market_cap: u64,
    /// Growth of the market as a share per year.
    pub annual_market_cap_growth_rate: f64,
    /// Number of seats of the smallest and the largest enterprise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seat_range: Option<[u64; 2]>,
    /// Mean number of turns after which an enterprise stops negotiating.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decision_rounds: Option<u64>,
    /// Mean number of days until an enterprise replies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub avg_response_days: Option<f64>,
}

/// Influence that a group exerts and receives, highest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Influence {
    /// Influence of the group on other groups.
    pub outgoing: IndexMap<Group, f64>,
    /// Influence of other groups on the group.
    pub incoming: IndexMap<Group, f64>,
}

impl Tool for GetGroupInsights {
    type Args = Group;
    type Answer = GroupInsights;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, view: &ToolContext<'_>, arguments: &Arguments) -> Result<Group, Rejection> {
        parse_group_argument(arguments, view)
    }

    fn plan(&self, view: &ToolContext<'_>, group: Group) -> Result<PlannedCall<GroupInsights>, Rejection> {
        if !view.is_known(group) {
            return Err(not_discovered_rejection(group.id(), view));
        }
        let group_name = view.params().group(group).name.clone();
        Ok(PlannedCall::with_draws(Command::ReadInsights(group), move |resolved| match resolved {
            ResolvedCommand::ReadInsights(insights) => {
                insights.as_ref().map(|insights| to_group_insights(insights, group_name))
            }
            _ => None,
        }))
    }
}

fn to_group_insights(insights: &Insights, group_name: String) -> GroupInsights {
    GroupInsights {
        group_id: insights.group,
        group_name,
        segment: segment_label(insights.group),
        info_level: insights.level,
        noise: margin_of_error_label(insights.noise),
        estimates: to_estimates(insights),
        network_influence: Influence {
            outgoing: insights.referrals_to.iter().copied().collect(),
            incoming: insights.referrals_from.iter().copied().collect(),
        },
        reputation_influence: Influence {
            outgoing: insights.reputation_to.iter().copied().collect(),
            incoming: insights.reputation_from.iter().copied().collect(),
        },
    }
}

fn to_estimates(insights: &Insights) -> Estimates {
    let company = insights.enterprise.as_ref();
    Estimates {
        willingness_to_pay: insights.willingness_to_pay,
        usage_volume: insights.usage_volume,
        quality_floor_q_min: insights.quality_floor,
        contract_lockin_aversion: insights.lockin_aversion,
        market_cap: insights.market_cap,
        annual_market_cap_growth_rate: insights.growth_rate,
        seat_range: company.map(|company| [company.min_seats, company.max_seats]),
        decision_rounds: company.map(|company| company.decision_rounds),
        avg_response_days: company.map(|company| company.response_days),
    }
}
