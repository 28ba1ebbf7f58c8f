//! The trait of tools.

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
    /// Parsed and checked arguments.
    type Args;
    /// Result; its JSON is the data of the response.
    type Answer: Serialize;

    /// Returns the specification.
    fn spec(&self) -> &'static ToolSpec;

    /// Returns the current values of the arguments in the notation of a call; empty for tools without settings.
    fn current_arguments(&self, _settings: &Settings) -> Map<String, Value> {
        Map::new()
    }

    /// Parses the arguments of a call.
    ///
    /// # Errors
    /// The first rejections that its [`ToolSpec`] lists: those that follow from the arguments and the player's knowledge.
    fn read(&self, view: &ToolContext<'_>, arguments: &Arguments) -> Result<Self::Args, Rejection>;

    /// Returns the effect and the result of a call with these arguments.
    ///
    /// # Errors
    /// The other rejections, in the order of its checks.
    fn plan(&self, view: &ToolContext<'_>, args: Self::Args) -> Result<PlannedCall<Self::Answer>, Rejection>;
}
