//! The catalog of all tools, with lookup by name and code.

mod get_tool_documentation;

use std::fmt::Write;

use serde::Serialize;
use serde_json::{Map, Value};

use super::analytics::{GetSocialPosts, SetTargetedDevSpend, SetTargetedOpsSpend};
use super::calculations::{ListDailyCalculations, RegisterDailyCalculation, RemoveDailyCalculation};
use super::documentation::{DescribeTables, ListAllTables};
use super::enterprise::{RejectEnterpriseDeal, SendEnterpriseDeal};
use super::infrastructure::{GetCostInfo, SetCapacityTier};
use super::market::{GetGroupInsights, GetMarketOverview, ResearchGroup, ResearchMarket};
use super::marketing::{
    PostSocialMedia, SetAdsStrength, SetDailySpend, SetLeadPromotion, SetTargetedAdSpend,
};
use super::pricing::{SetModelTiers, SetPrices, SetPromotion, SetUsageQuotas};
use super::research::{ListResearchProjects, StartResearchProject};
use super::scripts::{DeleteScript, ListScripts, PythonExec, RegisterScript, RunScript};
use super::time::{GetVars, NextWeek, Query};
use super::tool_id::with_all_tools;
use super::{Arguments, PlannedCall, Rejection, Tool, ToolContext, ToolId, ToolKind, ToolModule, ToolSpec};
use get_tool_documentation::GetToolDocumentation;
use novamind_world::settings::Settings;

/// A tool with JSON arguments and an [`Answer`]. Unlike [`Tool`], the trait has no associated types, so that one list
/// can contain all tools.
pub trait AnyTool: Sync {
    /// Returns the specification of the tool.
    fn spec(&self) -> &'static ToolSpec;

    /// Returns the current values of the arguments in the notation of a call. The map is empty for tools without
    /// settings.
    fn current_arguments(&self, settings: &Settings) -> Map<String, Value>;

    /// Plans a call with these arguments, and returns its effect and result.
    ///
    /// # Errors
    /// The rejections that the tool's [`ToolSpec`] lists, in the order of the checks.
    fn plan(&self, view: &ToolContext<'_>, arguments: &Arguments) -> Result<PlannedCall<Answer>, Rejection>;
}

/// Defines the catalog and the type of results from the list of tool types.
macro_rules! catalogue {
    ($($tool:ident),* $(,)?) => {
        /// All tools, in display order.
        pub static CATALOGUE: [&dyn AnyTool; [$(ToolId::$tool),*].len()] = [$(&$tool),*];

        /// The result of any tool. An answer is serialized like the result type of its tool.
        #[derive(Debug, Clone, PartialEq, Serialize)]
        #[serde(untagged)]
        #[allow(missing_docs)] // The `ToolSpec` of each tool describes its variant.
        pub enum Answer {
            $($tool(<$tool as Tool>::Answer)),*
        }

        $(impl AnyTool for $tool {
            fn spec(&self) -> &'static ToolSpec {
                Tool::spec(self)
            }

            fn current_arguments(&self, settings: &Settings) -> Map<String, Value> {
                Tool::current_arguments(self, settings)
            }

            fn plan(&self, view: &ToolContext<'_>, arguments: &Arguments) -> Result<PlannedCall<Answer>, Rejection> {
                let args = self.parse_arguments(view, arguments)?;
                Ok(Tool::plan(self, view, args)?.map_answer(Answer::$tool))
            }
        })*
    };
}

with_all_tools!(catalogue);

impl ToolId {
    /// Returns the tool with this identifier.
    pub fn tool(self) -> &'static dyn AnyTool {
        CATALOGUE[self as usize]
    }

    /// Returns the specification of the tool with this identifier.
    pub fn spec(self) -> &'static ToolSpec {
        self.tool().spec()
    }

    /// Returns whether a call to the tool executes code immediately, which can be slow.
    pub fn executes_code(self) -> bool {
        matches!(self, ToolId::PythonExec | ToolId::RunScript)
    }

    /// Returns whether a request for the tool can have an id, so that a retry of the request is not executed twice.
    /// Reads and scripts need no id, because repeating them changes nothing.
    pub fn takes_request_id(self) -> bool {
        self.spec().kind != ToolKind::Read && !self.executes_code()
    }

    /// Returns all tools, in display order.
    pub fn all() -> impl Iterator<Item = ToolId> {
        CATALOGUE.iter().map(|tool| tool.spec().id)
    }
}

impl Answer {
    /// Converts the result to JSON, for the trajectory and for clients.
    pub fn to_json(&self) -> Value {
        serde_json::to_value(self).unwrap_or(Value::Null)
    }
}

/// Finds a tool by its case-sensitive name. The name can include the module, for example `pricing.set_prices`.
pub fn find(name: &str) -> Option<&'static dyn AnyTool> {
    CATALOGUE.into_iter().find(|tool| {
        let spec = tool.spec();
        spec.name() == name
            || name
                .split_once('.')
                .is_some_and(|(module, rest)| module == spec.module.id() && rest == spec.name())
    })
}

/// Finds a tool by its code, ignoring case.
pub fn find_code(code: &str) -> Option<&'static dyn AnyTool> {
    CATALOGUE.into_iter().find(|tool| tool.spec().code.eq_ignore_ascii_case(code.trim()))
}

/// Returns a text that lists all tools, one per line, grouped by module.
pub fn list_by_module() -> String {
    let mut text = String::new();
    for module in ToolModule::ALL {
        let _ = writeln!(text, "{}", module.id());
        for spec in CATALOGUE.iter().map(|tool| tool.spec()).filter(|spec| spec.module == module) {
            let _ = writeln!(text, "  {:<5} {:<26} {}", spec.code, spec.name(), spec.summary);
        }
    }
    text
}

/// Returns up to three names of tools that are similar to an unknown name.
pub fn similar_tools(name: &str) -> Vec<&'static str> {
    novamind_base::similar_names(name, CATALOGUE.iter().map(|tool| tool.spec().name()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn find_accepts_names_with_and_without_module() {
        assert_eq!(find("set_prices").map(|tool| tool.spec().name()), Some("set_prices"));
        assert_eq!(find("pricing.set_prices").map(|tool| tool.spec().name()), Some("set_prices"));
        assert!(find("marketing.set_prices").is_none());
        assert!(find("Set_Prices").is_none());
        assert_eq!(similar_tools("set_price")[0], "set_prices");
    }

    /// The 34 tools that agents know, and two additional read-only tools.
    const EXPECTED_TOOLS: &str = "\
        set_prices set_model_tiers set_usage_quotas set_promotion set_daily_spend set_targeted_ad_spend \
        set_ads_strength set_lead_promotion post_social_media get_social_posts set_targeted_ops_spend \
        set_targeted_dev_spend start_research_project list_research_projects research_market research_group \
        get_market_overview get_group_insights set_capacity_tier get_cost_info send_enterprise_deal \
        reject_enterprise_deal next_week python_exec register_daily_calculation remove_daily_calculation \
        list_daily_calculations list_all_tables describe_tables get_tool_documentation register_script \
        run_script list_scripts delete_script query get_vars";

    #[test]
    fn catalogue_has_34_benchmark_tools_and_two_reads() {
        let mut texts: Vec<&str> = CATALOGUE.iter().map(|tool| tool.spec().name()).collect();
        let mut expected: Vec<&str> = EXPECTED_TOOLS.split(' ').collect();
        texts.sort_unstable();
        expected.sort_unstable();
        assert_eq!(texts, expected);
    }

    #[test]
    fn tool_id_matches_its_tool_and_parses_from_its_name() {
        for (at, tool) in CATALOGUE.iter().enumerate() {
            let id = tool.spec().id;
            assert_eq!((id as usize, id.name().parse()), (at, Ok(id)), "{id}");
            assert_eq!(serde_json::json!(id), id.name(), "{id}");
        }
    }

    #[test]
    fn tool_codes_are_short_uppercase_and_unique() {
        let mut codes: Vec<&str> = CATALOGUE.iter().map(|tool| tool.spec().code).collect();
        for code in &codes {
            assert!(
                (3..=5).contains(&code.len()) && code.bytes().all(|it| it.is_ascii_uppercase()),
                "{code}"
            );
        }
        codes.sort_unstable();
        codes.dedup();
        assert_eq!(codes.len(), CATALOGUE.len());
        assert_eq!(find_code(" prc ").map(|tool| tool.spec().name()), Some("set_prices"));
        assert!(find_code("PR").is_none() && find_code("set_prices").is_none());
    }

    #[test]
    fn tool_names_are_unique_and_examples_are_json() {
        let mut names: Vec<&str> = CATALOGUE.iter().map(|tool| tool.spec().name()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), CATALOGUE.len());
        for tool in CATALOGUE {
            let example = serde_json::from_str::<serde_json::Value>(tool.spec().example);
            assert!(example.is_ok_and(|value| value.is_object()), "{}", tool.spec().name());
        }
    }
}
