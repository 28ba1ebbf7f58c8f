//! The tools: every action and reading of the player, one file each (docs/interfaces/tools.md).
//!
//! A tool is data ([`Spec`]) and three small functions: what its arguments are now ([`Tool::current`]), what a
//! call would do ([`Tool::plan`], pure, so it also previews), and what it answers ([`Tool::answer`]). Adding a
//! tool touches one file and the list in `catalogue`.

mod arguments;
pub(crate) mod bounds;
pub(crate) mod catalogue;
pub(crate) mod describe;
mod notebook;
mod numbers;
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

use serde_json::{Map, Value};

pub use arguments::Arguments;
pub use catalogue::{CATALOGUE, ToolId, find};
pub use notebook::{Kept, Notebook, Task};
pub use numbers::Numbers;
pub use refusal::Refusal;
pub use spec::{Argument, ArgumentKind, Key, Kind, Module, Output, Range, Spec, When};
pub use surroundings::{ColumnDocument, Surroundings, TableDocument};
pub use time::{FORECAST_KEYS, Forecast, forecasts, rationale};
pub use view::{PublicPost, View};

use crate::notation::plain_numbers;
use crate::world::command::{Command, ResolvedCommand};
use crate::world::settings::Settings;

/// An action or reading of the player.
pub trait Tool: Sync {
    /// Everything there is to know about it.
    fn spec(&self) -> &'static Spec;

    /// The present values of its arguments, as a call would send them; empty where there are none.
    fn current(&self, _settings: &Settings) -> Map<String, Value> {
        Map::new()
    }

    /// What a call with these arguments would do.
    ///
    /// # Errors
    /// The refusals that its [`Spec`] lists, in the order of its checks.
    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal>;

    /// What the session has to do for an accepted call besides its effect on the world.
    fn task(&self, _view: &View<'_>, _arguments: &Arguments) -> Option<Task> {
        None
    }

    /// The settings family that a call leaves, as its row shows it: amounts are numbers with a decimal point.
    fn row(&self, _arguments: &Arguments, resolved: &ResolvedCommand) -> Option<Value> {
        match resolved {
            ResolvedCommand::Set(change) => change.family(),
            _ => None,
        }
    }

    /// The data of the answer, given what was decided.
    fn answer(&self, view: &View<'_>, arguments: &Arguments, resolved: &ResolvedCommand) -> Value;
}

/// A settings family as answers show it: whole numbers without a decimal point.
fn as_data(family: &impl serde::Serialize) -> Value {
    plain_numbers(serde_json::to_value(family).unwrap_or(Value::Null))
}

/// The settings family that a resolved leaves, as answers show it.
fn family_of(resolved: &ResolvedCommand) -> Value {
    match resolved {
        ResolvedCommand::Set(change) => plain_numbers(change.family().unwrap_or(Value::Null)),
        _ => Value::Null,
    }
}
