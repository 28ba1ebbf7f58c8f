//! Causes of a change, with their values in the two weeks.

use crate::counterfactual::suspended_setting::SuspendedSetting;
use novamind_session::SettingChange;
use novamind_tools::ToolId;

/// A cause of the change in a weekly figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The player's calls to one tool.
    Calls(ToolId),
    /// Parameter changes of a debug run.
    Parameters,
    /// The tools with the smallest contributions, merged into one cause.
    OtherCalls,
    /// One-time purchases that were paid for in the previous week.
    EarlierPurchases,
    /// A setting that continued in both weeks, whether or not the player changed the setting.
    Continued(SuspendedSetting),
    /// Market changes in the previous week that affect all days of the explained week.
    EarlierMarket,
    /// Number of individuals whose billing day fell in the week.
    RenewalsDue,
    /// Open issues of the individuals whose billing day fell in the week.
    IssuesAtRenewal,
    /// Number of enterprises whose billing day fell in the week.
    EnterpriseBillsDue,
    /// Usage of the subscribers, which determines the cost of compute.
    Usage,
    /// All hidden market inputs, merged into one cause.
    Market,
    /// Improvements by competitors.
    Competitors,
    /// Slow changes in customers' requirements and budgets.
    Drift,
    /// Changes in channel yields.
    Yields,
    /// Changes in the macroeconomic index.
    Economy,
    /// Demand surges of the market.
    Surges,
    /// The effect of the day of the month on leads.
    Calendar,
    /// Utilization and random outages of the service.
    Service,
    /// The world inputs with the smallest contributions, merged into one cause.
    OtherInputs,
}

impl Cause {
    /// Returns the display name of the cause.
    pub fn name(self) -> &'static str {
        match self {
            Cause::Calls(tool) => tool_call_name(tool),
            Cause::Parameters => "parameters",
            Cause::OtherCalls => "other decisions",
            Cause::EarlierPurchases => "last week's purchases",
            Cause::Continued(setting) => continued_name(setting),
            Cause::EarlierMarket => "market of the week before",
            Cause::RenewalsDue => "renewals due",
            Cause::IssuesAtRenewal => "issues at renewal",
            Cause::EnterpriseBillsDue => "enterprise bills due",
            Cause::Usage => "compute for usage",
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

fn continued_name(setting: SuspendedSetting) -> &'static str {
    match setting {
        SuspendedSetting::Development => "development as before",
        SuspendedSetting::Advertising => "advertising as before",
        SuspendedSetting::Operations => "operations as before",
        SuspendedSetting::Discounts => "discounts as before",
        SuspendedSetting::InAppAds => "in-app ads as before",
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

/// A detail of a cause: a value that differs between the two weeks, or a number of occurrences.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CauseDetail {
    /// A setting with different values in the two weeks.
    Setting(SettingChange),
    /// A world input with different values in the two weeks.
    Input(InputDetail),
    /// First and last day without the cause in the re-simulations that evaluate the cause.
    Removed {
        /// First day without the cause.
        first: u32,
        /// Last day without the cause.
        last: u32,
    },
    /// Number of individuals whose billing day fell in each week.
    RenewalsDue {
        /// Number of renewals in the previous week and in the explained week.
        bills: [u32; 2],
    },
    /// Share of the individuals due who had an open issue before their billing day.
    IssuesAtRenewal {
        /// Shares in the previous week and in the explained week, 0 to 1.
        shares: [f64; 2],
    },
    /// Outcome of the explained week's renewals in a simulation without the other causes.
    RenewalsCancelled {
        /// Number of renewals that were due.
        bills: u32,
        /// Number of individuals who cancelled.
        cancelled: u32,
    },
    /// Number and prices of the bills that were due in each week.
    BillsDue {
        /// Number of bills in the previous week and in the explained week.
        bills: [u32; 2],
        /// Monthly prices of these subscribers in the previous week and in the explained week, dollars.
        dollars: [f64; 2],
    },
    /// World inputs that unfinished runs do not show one by one.
    HiddenInputs,
    /// Number of occurrences and the noun for one occurrence, for example 3 and `call`.
    Occurrences(usize, &'static str),
}

/// The values of a world input in the two weeks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputDetail {
    /// Display name of the world input.
    pub name: &'static str,
    /// Value of the input in the previous week.
    pub old: f64,
    /// Value of the input in the explained week.
    pub new: f64,
    /// Whether the values are shares from 0 to 1.
    pub is_share: bool,
}
