use serde::Serialize;

use super::super::arguments::Arguments;
use super::super::{Kind, Module, Output, Planned, Refusal, Spec, Tool, ToolId, View, When};
use super::{noise_label, segment};
use novamind_world::events::{Phase, Reading, Trend};
use novamind_world::identifiers::Group;

/// The tool `get_market_overview`.
pub struct GetMarketOverview;

static SPEC: Spec = Spec {
    id: ToolId::GetMarketOverview,
    code: "MKT",
    module: Module::Market,
    kind: Kind::Read,
    summary: "Show the known groups, the number of unknown ones, and the latest published index",
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
            doc: "by group_id; noise is the maximum error of estimates at that level",
        },
        Output { name: "undiscovered_count", kind: "integer", doc: "number of unknown groups" },
        Output {
            name: "macroeconomic",
            kind: "{pmi_value, pmi_trend, pmi_change, cycle_phase, description} or null",
            doc: "latest published index of the economy; null before day {macro.macro_pmi_publication_delay_days:+1}",
        },
    ],
    example: "{}",
};

/// Known groups and the economy.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MarketOverview {
    /// Known groups by identifier.
    pub known_groups: Vec<KnownGroup>,
    /// Number of unknown groups.
    pub undiscovered_count: usize,
    /// Latest published index; `None` before the first.
    pub macroeconomic: Option<Macroeconomy>,
}

/// A known group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KnownGroup {
    /// The group.
    pub group_id: Group,
    /// Name.
    pub group_name: String,
    /// Individual or Enterprise.
    pub segment: &'static str,
    /// Study level, 1 to 5.
    pub info_level: u8,
    /// Maximum error of estimates at that level, as text.
    pub noise: String,
}

/// A published index of the economy.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Macroeconomy {
    /// Index.
    pub pmi_value: f64,
    /// Trend.
    pub pmi_trend: Trend,
    /// Change since the previous reading.
    pub pmi_change: f64,
    /// Phase of the cycle.
    pub cycle_phase: Phase,
    /// Description.
    pub description: String,
}

impl Tool for GetMarketOverview {
    type Args = ();
    type Answer = MarketOverview;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, _: &Arguments) -> Result<(), Refusal> {
        Ok(())
    }

    fn plan(&self, view: &View<'_>, (): ()) -> Result<Planned<MarketOverview>, Refusal> {
        let mut known: Vec<Group> = view.known_groups().collect();
        known.sort_by_key(|group| group.id());
        let market = &view.world().market;
        Ok(Planned::reading(MarketOverview {
            known_groups: known.into_iter().map(|group| entry(group, view)).collect(),
            undiscovered_count: market.undiscovered().count(),
            macroeconomic: market.economy.published.map(|reading| economy(&reading, view)),
        }))
    }
}

fn entry(group: Group, view: &View<'_>) -> KnownGroup {
    let level = view.world().market.knowledge[group].level;
    KnownGroup {
        group_id: group,
        group_name: view.params().group(group).name.clone(),
        segment: segment(group),
        info_level: level,
        noise: noise_label(view.params().level(level).noise),
    }
}

fn economy(reading: &Reading, view: &View<'_>) -> Macroeconomy {
    Macroeconomy {
        pmi_value: reading.value,
        pmi_trend: reading.trend,
        pmi_change: reading.change,
        cycle_phase: reading.phase,
        description: view.surroundings().describe(reading),
    }
}
