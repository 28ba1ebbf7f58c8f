//! The tools: every action and reading of the player, one file each (docs/interfaces/tools.md).
//!
//! A tool is data ([`Spec`]), its typed arguments and its typed answer, and three small functions: what its arguments are
//! now ([`Tool::current`]), what the JSON of a call says ([`Tool::read`]), and what the call would do and say
//! ([`Tool::plan`], pure, so it also previews). JSON is read once and written once. Who knows a tool only by its name
//! takes it from the `catalogue` as [`AnyTool`]. Adding a tool touches one file and the list in `catalogue`.

mod arguments;
pub mod bounds;
pub mod catalogue;
mod deal_results;
pub mod describe;
mod keeping;
mod notebook;
mod numbers;
mod plain;
mod planned;
mod refusal;
mod spec;
mod surroundings;
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

use serde::Serialize;
use serde_json::{Map, Value};

pub use analytics::{GetSocialPosts, PostLimit, SocialPost};
pub use arguments::Arguments;
pub use catalogue::{Answer, CATALOGUE, ToolId, find};
pub use deal_results::{DealResult, DealResults};
pub use enterprise::{highest_named, readdressed};
pub use infrastructure::{CapacityTierFacts, GetCostInfo, ModelTierFacts, PriceList};
pub use market::{
    DiscoveryAttempt, Estimates, GetGroupInsights, GetMarketOverview, GroupInsights, Influence,
    MarketOverview, OrderedStudy,
};
pub use notebook::{Kept, Notebook, NotebookChange};
pub use numbers::Numbers;
pub use planned::{Planned, Reply, Script, ScriptOutput};
pub use refusal::Refusal;
pub use research::{ListResearchProjects, ResearchProjects, ResearchTierFacts};
pub use scripts::{Language, hint_at_python};
pub use spec::{Argument, ArgumentKind, Key, Kind, Module, Output, REMARK, Range, Spec, When};
pub use surroundings::{ColumnDocument, Surroundings, TableDocument};
pub use time::{FORECAST_KEYS, Forecast, forecasts, rationale};
pub use view::{PublicPost, View};

use novamind_world::settings::Settings;

/// An action or reading of the player.
pub trait Tool: Sync {
    /// Its arguments, read and checked.
    type Args;
    /// What it answers; its JSON is the data of the answer.
    type Answer: Serialize;

    /// Everything there is to know about it.
    fn spec(&self) -> &'static Spec;

    /// The present values of its arguments, as a call would send them; empty where there are none.
    fn current(&self, _settings: &Settings) -> Map<String, Value> {
        Map::new()
    }

    /// Reads the arguments of a call.
    ///
    /// # Errors
    /// The first refusals that its [`Spec`] lists: what a look at the arguments, and at what the player knows, shows.
    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<Self::Args, Refusal>;

    /// What a call with these arguments would do and say.
    ///
    /// # Errors
    /// The other refusals, in the order of its checks.
    fn plan(&self, view: &View<'_>, args: Self::Args) -> Result<Planned<Self::Answer>, Refusal>;
}

/// A tool of which only the name is known: its arguments are JSON, and its answer is one of all.
pub trait AnyTool: Sync {
    /// Everything there is to know about it.
    fn spec(&self) -> &'static Spec;

    /// The present values of its arguments, as a call would send them; empty where there are none.
    fn current(&self, settings: &Settings) -> Map<String, Value>;

    /// What a call with these arguments would do and say.
    ///
    /// # Errors
    /// The refusals that its [`Spec`] lists, in the order of its checks.
    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Planned<Answer>, Refusal>;
}
