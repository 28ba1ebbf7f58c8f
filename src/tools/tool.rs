//! What a tool does: reads its arguments, and plans what a call would change and answer.

use serde::Serialize;
use serde_json::{Map, Value};

use super::arguments::Arguments;
use super::planned::Planned;
use super::refusal::Refusal;
use super::spec::Spec;
use super::view::View;
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
