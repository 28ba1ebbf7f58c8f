//! What can have changed a figure, and by how much it changed itself.

use novamind_session::Change;
use novamind_tools::ToolId;

/// A cause of a change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Calls of a tool.
    Calls(ToolId),
    /// Parameters that were set in a debug run.
    Parameters,
    /// Several tools whose calls did least.
    OtherCalls,
    /// What was bought in the week before, and was paid then.
    EarlierPurchases,
    /// Everything about the market that the player cannot see.
    Market,
    /// Moves of rivals.
    Rivals,
    /// Drift of expectations and budgets.
    Drift,
    /// What channels bring.
    Yields,
    /// The economy.
    Economy,
    /// Demand surges.
    Surges,
    /// The day of the month.
    Calendar,
    /// Load of the service, and luck with outages.
    Service,
    /// Several inputs that did least.
    OtherInputs,
}

impl Cause {
    /// Name in lists.
    pub fn name(self) -> &'static str {
        match self {
            Cause::Calls(tool) => name_of_calls(tool),
            Cause::Parameters => "parameters",
            Cause::OtherCalls => "other decisions",
            Cause::EarlierPurchases => "last week's purchases",
            Cause::Market => "market",
            Cause::Rivals => "rivals",
            Cause::Drift => "drift",
            Cause::Yields => "channel yields",
            Cause::Economy => "economy",
            Cause::Surges => "demand surge",
            Cause::Calendar => "day of the month",
            Cause::Service => "load and outages",
            Cause::OtherInputs => "other inputs",
        }
    }

    /// Whether it is something the player decided.
    pub fn is_own(self) -> bool {
        matches!(self, Cause::Calls(_) | Cause::Parameters | Cause::OtherCalls | Cause::EarlierPurchases)
    }
}

fn name_of_calls(tool: ToolId) -> &'static str {
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

/// What differs about a cause from the week before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Detail {
    /// A setting.
    Setting(Change),
    /// An input of the world.
    Input(InputDetail),
    /// Something happened so many times; its noun.
    Happened(usize, &'static str),
}

/// An input of the world in two weeks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputDetail {
    /// What it is.
    pub name: &'static str,
    /// The week before.
    pub old: f64,
    /// The week.
    pub new: f64,
    /// Whether it is a share.
    pub is_share: bool,
}
