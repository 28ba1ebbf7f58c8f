//! The company data that tools read.

use std::borrow::Cow;

use super::session_context::{EmptyContext, SessionContext};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::settings::Settings;
use novamind_world::state::World;

/// A read-only view of the company. Tools must return only information that the player may know.
#[derive(Clone, Copy)]
pub struct ToolContext<'a> {
    world: &'a World,
    params: &'a Params,
    session: &'a dyn SessionContext,
    posts: &'a [PublicPost],
}

/// A post of an author other than the player.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct PublicPost {
    /// Number of the post, which is unique in the run.
    pub post: u32,
    /// Day on which the post was published.
    pub day: u32,
    /// Text of the post.
    pub content: String,
    /// Number of the player's post on which this post comments; `None` for other posts.
    pub own_post: Option<u32>,
    /// Group whose reaction a comment on the player's post expresses.
    #[serde(skip)]
    pub source_group: Option<Group>,
    /// Group of the author; `None` for the press.
    #[serde(skip)]
    pub written_by: Option<Group>,
    /// Name of the author's profile; `None` for authors without a name.
    #[serde(skip)]
    pub profile: Option<Cow<'static, str>>,
}

impl<'a> ToolContext<'a> {
    /// Returns a view of a simulator state with an empty session context.
    pub fn new(world: &'a World, params: &'a Params) -> ToolContext<'a> {
        ToolContext { world, params, session: &EmptyContext, posts: &[] }
    }

    /// Returns this view with the data of a session.
    pub fn with_session(self, session: &'a dyn SessionContext) -> ToolContext<'a> {
        ToolContext { session, ..self }
    }

    /// Returns the session data of the view.
    pub fn session(&self) -> &'a dyn SessionContext {
        self.session
    }

    /// Returns this view with the posts of other authors, in the order of their numbers.
    pub fn with_posts(self, posts: &'a [PublicPost]) -> ToolContext<'a> {
        ToolContext { posts, ..self }
    }

    /// Returns the posts of other authors, in the order of their numbers.
    pub fn posts(&self) -> &'a [PublicPost] {
        self.posts
    }

    /// Returns the decision day, which is the last simulated day.
    pub fn day(&self) -> u32 {
        self.world.day
    }

    /// Returns the company's cash in dollars.
    pub fn cash(&self) -> f64 {
        self.world.finance.cash
    }

    /// Returns the settings in force.
    pub fn settings(&self) -> &'a Settings {
        &self.world.settings
    }

    /// Returns the parameters. Tools must show only parameters that are known to agents.
    pub fn params(&self) -> &'a Params {
        self.params
    }

    /// Returns the complete simulator state.
    pub(super) fn world(&self) -> &'a World {
        self.world
    }

    /// Returns whether a group is known to the player.
    pub fn is_known(&self, group: Group) -> bool {
        self.world.market.is_known(group)
    }

    /// Returns the known groups in their fixed order.
    pub fn known_groups(&self) -> impl Iterator<Item = Group> + 'a {
        let world = self.world;
        Group::all().filter(|group| world.market.is_known(*group))
    }
}
