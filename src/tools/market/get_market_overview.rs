use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{
    EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId, ToolKind, ToolModule,
    ToolSpec,
};
use super::{margin_of_error_label, segment_label};
use novamind_world::events::{Phase, Reading, Trend};
use novamind_world::identifiers::Group;

/// The tool `get_market_overview`, which returns the known groups and the latest published PMI.
pub struct GetMarketOverview;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::GetMarketOverview,
    code: "MKT",
    module: ToolModule::Market,
    kind: ToolKind::Read,
    summary: "Show the known groups, the number of unknown ones, and the latest published index",
    arguments: &[],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Never,
    effect: "",
    cost: "nothing",
    written_tables: &[],
    rejection_codes: &[],
    result_fields: &[
        ResultField {
            name: "known_groups",
            kind: "list of {group_id, group_name, segment, info_level, noise}",
            description: "by group_id; noise is the maximum error of estimates at that level",
        },
        ResultField { name: "undiscovered_count", kind: "integer", description: "number of unknown groups" },
        ResultField {
            name: "macroeconomic",
            kind: "{pmi_value, pmi_trend, pmi_change, cycle_phase, description} or null",
            description: "latest published index of the economy; null before day {macro.macro_pmi_publication_delay_days:+1}",
        },
    ],
    example: "{}",
};

/// An overview of the known groups and the economy.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MarketOverview {
    /// Known groups, ordered by identifier.
    pub known_groups: Vec<KnownGroup>,
    /// Number of groups that are not discovered yet.
    pub undiscovered_count: usize,
    /// Latest published PMI; `None` before the first publication.
    pub macroeconomic: Option<Macroeconomy>,
}

/// A known group, with its study level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownGroup {
    /// Identifier of the known group.
    pub group_id: Group,
    /// Name of the known group.
    pub group_name: String,
    /// Segment of the group: Individual or Enterprise.
    pub segment: &'static str,
    /// Study level, 1 to 5.
    pub info_level: u8,
    /// Margin of error at the group's study level, as text, for example `±40%`.
    pub noise: String,
}

/// A published PMI with its interpretation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Macroeconomy {
    /// Value of the PMI; 50 is neutral.
    pub pmi_value: f64,
    /// Trend of the economy that the value indicates.
    pub pmi_trend: Trend,
    /// Change in the PMI since the previous publication.
    pub pmi_change: f64,
    /// Phase of the economic cycle.
    pub cycle_phase: Phase,
    /// Description of the economy in words.
    pub description: String,
}

impl Tool for GetMarketOverview {
    type Args = ();
    type Answer = MarketOverview;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, _: &Arguments) -> Result<(), Rejection> {
        Ok(())
    }

    fn plan(&self, view: &ToolContext<'_>, (): ()) -> Result<PlannedCall<MarketOverview>, Rejection> {
        let mut known: Vec<Group> = view.known_groups().collect();
        known.sort_by_key(|group| group.id());
        let market = &view.world().market;
        Ok(PlannedCall::read_only(MarketOverview {
            known_groups: known.into_iter().map(|group| to_known_group(group, view)).collect(),
            undiscovered_count: market.undiscovered().count(),
            macroeconomic: market.economy.published.map(|reading| to_macroeconomy(&reading, view)),
        }))
    }
}

fn to_known_group(group: Group, view: &ToolContext<'_>) -> KnownGroup {
    let level = view.world().market.knowledge[group].level;
    KnownGroup {
        group_id: group,
        group_name: view.params().group(group).name.clone(),
        segment: segment_label(group),
        info_level: level,
        noise: margin_of_error_label(view.params().study_level(level).noise),
    }
}

fn to_macroeconomy(reading: &Reading, view: &ToolContext<'_>) -> Macroeconomy {
    Macroeconomy {
        pmi_value: reading.value,
        pmi_trend: reading.trend,
        pmi_change: reading.change,
        cycle_phase: reading.phase,
        description: view.session().describe_economy(reading),
    }
}
