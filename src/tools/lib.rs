//! The tools of the player, one file each (docs/interfaces/tools.md).
//!
//! A tool has data ([`Spec`]), typed arguments, a typed result, and three functions. [`Tool::current`] returns the current
//! values of its arguments, [`Tool::read`] parses the JSON of a call, and [`Tool::plan`] returns the effect and the result of a
//! call without applying it, also for previews. Callers that know only the name of a tool use [`AnyTool`] of the `catalogue`. A
//! new tool needs one file and an entry in the lists of `tool_id` and `catalogue`.
//!
//! Modules from bottom to top: `refusal`, `numbers`, `tool_id`, `notebook`; `spec`, `planned`, `surroundings`, `view`; `arguments`,
//! `bounds`, `describe`, `keeping`, `tool`; the families of tools (`pricing` to `time`); `catalogue`.

mod arguments;
pub mod bounds;
pub mod catalogue;
pub mod describe;
mod keeping;
mod notebook;
mod numbers;
mod planned;
mod refusal;
mod spec;
mod surroundings;
mod tool;
mod tool_id;
mod view;

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

pub use analytics::{GetSocialPosts, PostLimit, SocialPost};
pub use arguments::Arguments;
pub use catalogue::{Answer, AnyTool, CATALOGUE, find};
pub use enterprise::{highest_named, readdressed};
pub use infrastructure::{CapacityTierFacts, GetCostInfo, ModelTierFacts, PriceList};
pub use market::{
    DiscoveryAttempt, Estimates, GetGroupInsights, GetMarketOverview, GroupInsights, Influence,
    MarketOverview, OrderedStudy,
};
pub use notebook::{Kept, Notebook, NotebookChange};
pub use numbers::Numbers;
pub use planned::{Planned, Reply, Script, ScriptOutput};
pub use refusal::{DealResult, DealResults, Refusal};
pub use research::{ListResearchProjects, ResearchProjects, ResearchTierFacts};
pub use scripts::{Language, hint_at_python};
pub use spec::{Argument, ArgumentKind, Key, Kind, Module, Output, REMARK, Range, Spec, When};
pub use surroundings::{ColumnDocument, Surroundings, TableDocument};
pub use time::{FORECAST_KEYS, Forecast, forecasts, rationale};
pub use tool::Tool;
pub use tool_id::ToolId;
pub use view::{PublicPost, View};
