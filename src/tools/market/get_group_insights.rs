use indexmap::IndexMap;
use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{
    Argument, ArgumentKind, Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When,
};
use super::{group_argument, noise_label, not_discovered, segment};
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::identifiers::Group;
use novamind_world::market::insights::Insights;

/// The tool `get_group_insights`.
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
        Output {
            name: "info_level",
            kind: "integer",
            doc: "study level, 1 to {group_research.max_target_level}",
        },
        Output { name: "noise", kind: "text", doc: "maximum error of the estimates" },
        Output {
            name: "estimates",
            kind: "{willingness_to_pay, usage_volume, quality_floor_q_min, contract_lockin_aversion, market_cap, \
                   annual_market_cap_growth_rate}, for enterprises also {seat_range, decision_rounds, \
                   avg_response_days}",
            doc: "means of the group: $/month, units/day (per seat for enterprises), quality, customers, share per year, \
                  days; budget, required quality and market as of the last study",
        },
        Output {
            name: "network_influence",
            kind: "{outgoing, incoming}: map group -> number",
            doc: "leads per subscriber and day from the group to known groups, and from them to it",
        },
        Output {
            name: "reputation_influence",
            kind: "{outgoing, incoming}: map group -> number",
            doc: "weight of its reputation for known groups, and of theirs for it, 0 to 1",
        },
    ],
    example: r#"{"group_id": "S1"}"#,
};

/// Estimates of a group as of its last study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupInsights {
    /// The group.
    pub group_id: Group,
    /// Name.
    pub group_name: String,
    /// Individual or Enterprise.
    pub segment: &'static str,
    /// Study level, 1 to 5.
    pub info_level: u8,
    /// Maximum error of the estimates, as text.
    pub noise: String,
    /// Estimated means.
    pub estimates: Estimates,
    /// Leads per subscriber and day from the group to known groups, and from them to it.
    pub network_influence: Influence,
    /// Weights of its reputation for known groups, and of theirs for it.
    pub reputation_influence: Influence,
}

/// Estimated means of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimates {
    /// Budget, dollars per month; per seat for enterprises.
    pub willingness_to_pay: f64,
    /// Usage, units per day; per seat for enterprises.
    pub usage_volume: f64,
    /// Lowest quality that a customer accepts.
    pub quality_floor_q_min: f64,
    /// Aversion to long contracts.
    pub contract_lockin_aversion: f64,
    /// Market cap in individuals or enterprises.
    pub market_cap: u64,
    /// Growth of the market as a share per year.
    pub annual_market_cap_growth_rate: f64,
    /// Seats of the smallest and the largest enterprise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seat_range: Option<[u64; 2]>,
    /// Turns that an enterprise accepts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decision_rounds: Option<u64>,
    /// Days until an enterprise replies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub avg_response_days: Option<f64>,
}

/// Influence of a group and on a group, highest first.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Influence {
    /// On other groups.
    pub outgoing: IndexMap<Group, f64>,
    /// Of other groups.
    pub incoming: IndexMap<Group, f64>,
}

impl Tool for GetGroupInsights {
    type Args = Group;
    type Answer = GroupInsights;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<Group, Refusal> {
        group_argument(arguments, view)
    }

    fn plan(&self, view: &View<'_>, group: Group) -> Result<Planned<GroupInsights>, Refusal> {
        if !view.knows(group) {
            return Err(not_discovered(group.id(), view));
        }
        let group_name = view.params().group(group).name.clone();
        Ok(Planned::drawing(Command::ReadInsights(group), move |resolved| match resolved {
            ResolvedCommand::ReadInsights(insights) => {
                insights.as_ref().map(|insights| told(insights, group_name))
            }
            _ => None,
        }))
    }
}

fn told(insights: &Insights, group_name: String) -> GroupInsights {
    GroupInsights {
        group_id: insights.group,
        group_name,
        segment: segment(insights.group),
        info_level: insights.level,
        noise: noise_label(insights.noise),
        estimates: estimates(insights),
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

fn estimates(insights: &Insights) -> Estimates {
    let company = insights.company.as_ref();
    Estimates {
        willingness_to_pay: insights.willingness_to_pay,
        usage_volume: insights.usage_volume,
        quality_floor_q_min: insights.quality_floor,
        contract_lockin_aversion: insights.lockin_aversion,
        market_cap: insights.market_cap,
        annual_market_cap_growth_rate: insights.growth_rate,
        seat_range: company.map(|company| [company.seats_least, company.seats_most]),
        decision_rounds: company.map(|company| company.decision_rounds),
        avg_response_days: company.map(|company| company.response_days),
    }
}
