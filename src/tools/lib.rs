//! The tools of the player, with one file per tool (docs/interfaces/tools.md).
//!
//! A tool has a specification ([`ToolSpec`]), typed arguments, a typed result, and three functions.
//! [`Tool::current_arguments`] returns the current values of the arguments. [`Tool::parse_arguments`] parses the JSON
//! of a call. [`Tool::plan`] returns the effect and the result of a call without applying the call, so that calls can
//! be previewed. Callers that know only the name of a tool use [`AnyTool`] of the `catalogue`. To add a tool, add a
//! file, and add the tool to the lists in `tool_id` and `catalogue`.
//!
//! Modules from bottom to top: `rejection`, `parameter_numbers`, `tool_id`, `notebook`; `spec`, `planned_call`,
//! `session_context`, `tool_context`; `arguments`, `limits`, `describe`, `stored_code`, `tool`; the families of tools
//! (`pricing` to `time`); `catalogue`.

mod arguments;
pub mod catalogue;
pub mod describe;
pub mod limits;
mod notebook;
mod parameter_numbers;
mod planned_call;
mod rejection;
mod session_context;
mod spec;
mod stored_code;
mod tool;
mod tool_context;
mod tool_id;

mod analytics;
mod calculations;
mod documentation;
mod enterprise;
mod infrastructure;
mod market;
mod marketing;
mod pricing;
mod research;
mod scripts;
mod time;

#[cfg(test)]
mod tests;

pub use analytics::{GetSocialPosts, PostAuthor, PostLimit, SocialPost, with_release_2_text};
pub use arguments::Arguments;
pub use catalogue::{Answer, AnyTool, CATALOGUE, find};
pub use enterprise::{highest_customer, remap_customers};
pub use infrastructure::{CapacityTierFacts, GetCostInfo, ModelTierFacts, PriceList};
pub use market::{
    DiscoveryAttempt, Estimates, GetGroupInsights, GetMarketOverview, GroupInsights, Influence,
    MarketOverview, OrderedStudy,
};
pub use notebook::{Notebook, NotebookChange, NotebookSection};
pub use parameter_numbers::ParameterNumbers;
pub use planned_call::{PlannedCall, Reply, Script, ScriptOutput};
pub use rejection::{DealResult, DealResults, Rejection};
pub use research::{ListResearchProjects, ResearchProjects, ResearchTierFacts};
pub use scripts::{Language, python_marker_hint};
pub use session_context::{ColumnDocument, SessionContext, TableDocument};
pub use spec::{
    Argument, ArgumentKind, EffectTiming, MapKey, NumberRange, REMARK_TYPE, ResultField, ToolKind,
    ToolModule, ToolSpec,
};
pub use time::{FORECAST_KEYS, Forecast, parse_forecasts, parse_rationale};
pub use tool::Tool;
pub use tool_context::{PublicPost, ToolContext};
pub use tool_id::ToolId;
