//! The list of all tools, from which the identifiers and the catalog are built.

use serde::{Deserialize, Serialize};
use strum::{AsRefStr, Display, EnumString, IntoStaticStr};

/// Calls a macro with the types of all tools, in display order.
macro_rules! with_all_tools {
    ($macro:ident) => {
        $macro! {
            SetPrices,
            SetModelTiers,
            SetUsageQuotas,
            SetPromotion,
            SetDailySpend,
            SetTargetedAdSpend,
            SetAdsStrength,
            SetLeadPromotion,
            PostSocialMedia,
            GetSocialPosts,
            SetTargetedOpsSpend,
            SetTargetedDevSpend,
            StartResearchProject,
            ListResearchProjects,
            ResearchMarket,
            ResearchGroup,
            GetMarketOverview,
            GetGroupInsights,
            SetCapacityTier,
            GetCostInfo,
            SendEnterpriseDeal,
            RejectEnterpriseDeal,
            NextWeek,
            PythonExec,
            RegisterDailyCalculation,
            RemoveDailyCalculation,
            ListDailyCalculations,
            ListAllTables,
            DescribeTables,
            GetToolDocumentation,
            RegisterScript,
            RunScript,
            ListScripts,
            DeleteScript,
            Query,
            GetVars,
        }
    };
}
pub(super) use with_all_tools;

macro_rules! identifiers {
    ($($tool:ident),* $(,)?) => {
        /// The identifier of a tool. The serialized form is the name of the tool, for example `set_prices`.
        #[derive(
            Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, AsRefStr, Display,
            EnumString, IntoStaticStr,
        )]
        #[serde(rename_all = "snake_case")]
        #[strum(serialize_all = "snake_case")]
        #[allow(missing_docs)] // The `ToolSpec` of each tool describes its variant.
        pub enum ToolId {
            $($tool),*
        }
    };
}

with_all_tools!(identifiers);

impl ToolId {
    /// Returns the name of the tool.
    pub fn name(self) -> &'static str {
        self.into()
    }
}
