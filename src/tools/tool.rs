//! The trait that all tools implement.

use serde::Serialize;
use serde_json::{Map, Value};

use super::arguments::Arguments;
use super::planned_call::PlannedCall;
use super::rejection::Rejection;
use super::spec::ToolSpec;
use super::tool_context::ToolContext;
use novamind_world::settings::Settings;

/// A tool of the player.
pub trait Tool: Sync {
    /// The type of the parsed and checked arguments.
    type Args;
    /// The type of the result, which is serialized to the data of the response.
    type Answer: Serialize;

    /// Returns the specification of the tool.
    fn spec(&self) -> &'static ToolSpec;

    /// Returns the current values of the arguments in the notation of a call. The map is empty for tools without
    /// settings.
    fn current_arguments(&self, _settings: &Settings) -> Map<String, Value> {
        Map::new()
    }

    /// Parses the arguments of a call.
    ///
    /// # Errors
    /// The rejections in the [`ToolSpec`] that depend only on the arguments and the player's knowledge.
    fn parse_arguments(&self, view: &ToolContext<'_>, arguments: &Arguments)
    -> Result<Self::Args, Rejection>;

    /// Plans a call with these arguments, and returns its effect and result.
    ///
    /// # Errors
    /// The remaining rejections in the [`ToolSpec`], in the order of the checks.
    fn plan(&self, view: &ToolContext<'_>, args: Self::Args) -> Result<PlannedCall<Self::Answer>, Rejection>;
}
