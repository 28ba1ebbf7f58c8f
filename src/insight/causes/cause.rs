//! Causes of a change, and their values in the two weeks.

use novamind_session::SettingChange;
use novamind_tools::ToolId;

/// A cause of a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Calls of a tool.
    Calls(ToolId),
    /// Parameter changes of a debug run.
    Parameters,
    /// Several tools with the smallest contributions.
    OtherCalls,
    /// One-time purchases that were paid in the week before.
    EarlierPurchases,
    /// All market inputs that are hidden from the player.
    Market,
    /// Competitor moves.
    Competitors,
    /// Drift of expectations and budgets.
    Drift,
    /// Channel yields.
    Yields,
    /// The economy.
    Economy,
    /// Demand surges.
    Surges,
    /// The day of the month.
    Calendar,
    /// Utilization, and outage draws.
    Service,
    /// Several inputs with the smallest contributions.
    OtherInputs,
}

impl Cause {
    /// Returns the display name.
    pub fn name(self) -> &'static str {
        match self {
            Cause::Calls(tool) => tool_call_name(tool),
            Cause::Parameters => "parameters",
            Cause::OtherCalls => "other decisions",
            Cause::EarlierPurchases => "last week's purchases",
            Cause::Market => "market",
            Cause::Competitors => "competitors",
            Cause::Drift => "drift",
            Cause::Yields => "channel yields",
            Cause::Economy => "economy",
            Cause::Surges => "demand surge",
            Cause::Calendar => "day of the month",
            Cause::Service => "load and outages",
            Cause::OtherInputs => "other inputs",
        }
    }

    /// Returns whether the cause is a decision of the player.
    #[cfg(test)]
    pub(crate) fn is_player_decision(self) -> bool {
        matches!(self, Cause::Calls(_) | Cause::Parameters | Cause::OtherCalls | Cause::EarlierPurchases)
    }
}

fn tool_call_name(tool: ToolId) -> &'static str {
    match tool {
        ToolId::SetPrices => "price",
        ToolId::SetModelTiers => "model tier",
        ToolId::SetUsageQuotas => "quota",
        ToolId::SetPromotion => "discount",
        ToolId::SetDailySpend => "daily spend",
        ToolId::SetTargetedAdSpend => "advertising",
        ToolId::SetAdsStrength => "in-app ads",
        ToolId::SetLeadPromotion => "lead discount",
        ToolId::SetTargetedOpsSpend => "targeted operations",
        ToolId::SetTargetedDevSpend => "targeted development",
        ToolId::SetCapacityTier => "capacity",
        ToolId::PostSocialMedia => "posts",
        ToolId::StartResearchProject => "R&D projects",
        ToolId::ResearchMarket => "market research",
        ToolId::ResearchGroup => "group studies",
        ToolId::SendEnterpriseDeal => "offers",
        ToolId::RejectEnterpriseDeal => "ended threads",
        other => other.name(),
    }
}

/// A difference in a cause between the two weeks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CauseDetail {
    /// A setting.
    Setting(SettingChange),
    /// An input of the world.
    Input(InputDetail),
    /// A number of occurrences, with the noun.
    Occurred(usize, &'static str),
}

/// An input of the world in two weeks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputDetail {
    /// Name of the input.
    pub name: &'static str,
    /// Value in the week before.
    pub old: f64,
    /// Value in the week.
    pub new: f64,
    /// Whether the value is a share.
    pub is_share: bool,
}
