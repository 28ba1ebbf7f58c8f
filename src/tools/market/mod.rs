//! Tools for the discovery of groups and for market studies.

mod get_group_insights;
mod get_market_overview;
mod research_group;
mod research_market;

use serde_json::Value;

pub use get_group_insights::{Estimates, GetGroupInsights, GroupInsights, Influence};
pub use get_market_overview::{GetMarketOverview, MarketOverview};
pub use research_group::{OrderedStudy, ResearchGroup};
pub use research_market::{DiscoveryAttempt, ResearchMarket};

use super::arguments::{Arguments, wrong_type_rejection};
use super::rejection::Rejection;
use super::tool_context::ToolContext;
use novamind_world::identifiers::Group;

fn parse_group_argument(arguments: &Arguments, view: &ToolContext<'_>) -> Result<Group, Rejection> {
    let given = arguments.get("group_id").unwrap_or(&Value::Null);
    let id = given.as_str().ok_or_else(|| wrong_type_rejection("group_id", "text, for instance S1"))?;
    Group::parse(id).filter(|group| view.is_known(*group)).ok_or_else(|| not_discovered_rejection(id, view))
}

fn not_discovered_rejection(id: &str, view: &ToolContext<'_>) -> Rejection {
    let known: Vec<&str> = view.known_groups().map(Group::id).collect();
    let message = format!(
        "group {id} is not known yet; the known groups are {}; research_market finds others",
        known.join(", ")
    );
    Rejection::for_field("group_id", "group_not_discovered", message)
}

fn segment_label(group: Group) -> &'static str {
    if group.is_enterprise() { "Enterprise" } else { "Individual" }
}

/// Formats the margin of error of a study level, for example ±40%.
fn margin_of_error_label(noise: f64) -> String {
    format!("\u{b1}{:.0}%", noise * 100.0)
}
