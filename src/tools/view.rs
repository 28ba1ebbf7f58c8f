//! What a tool may look at when it is planned.

use std::borrow::Cow;

use super::surroundings::{Nothing, Surroundings};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::settings::Settings;
use novamind_world::state::World;

/// A read-only look at the company. A tool turns it into what a player may know, never more.
#[derive(Clone, Copy)]
pub struct View<'a> {
    world: &'a World,
    params: &'a Params,
    surroundings: &'a dyn Surroundings,
    posts: &'a [PublicPost],
}

/// A post of somebody else than the player, as tools show it.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct PublicPost {
    /// Running number.
    pub post: u32,
    /// Day.
    pub day: u32,
    /// Text.
    pub content: String,
    /// Number of the player's post it comments on.
    pub own_post: Option<u32>,
    /// Group whose mood such a comment speaks for.
    #[serde(skip)]
    pub source_group: Option<Group>,
    /// Group of its author; none for the press.
    #[serde(skip)]
    pub written_by: Option<Group>,
    /// Name of the author's profile.
    #[serde(skip)]
    pub profile: Option<Cow<'static, str>>,
}

impl<'a> View<'a> {
    /// A look at a world.
    pub fn new(world: &'a World, params: &'a Params) -> View<'a> {
        View { world, params, surroundings: &Nothing, posts: &[] }
    }

    /// The same look, with what a session has besides the world.
    pub fn within(self, surroundings: &'a dyn Surroundings) -> View<'a> {
        View { surroundings, ..self }
    }

    /// Words, tables, and what is kept with the run.
    pub fn surroundings(&self) -> &'a dyn Surroundings {
        self.surroundings
    }

    /// The same look with the posts of others, in the order of their numbers.
    pub fn with_posts(self, posts: &'a [PublicPost]) -> View<'a> {
        View { posts, ..self }
    }

    /// Posts of others, in the order of their numbers.
    pub fn posts(&self) -> &'a [PublicPost] {
        self.posts
    }

    /// Decision day: the last simulated day.
    pub fn day(&self) -> u32 {
        self.world.day
    }

    /// Cash, in dollars.
    pub fn cash(&self) -> f64 {
        self.world.finance.cash
    }

    /// Settings in force.
    pub fn settings(&self) -> &'a Settings {
        &self.world.settings
    }

    /// Parameters of the world; a tool shows only what agents are told too.
    pub fn params(&self) -> &'a Params {
        self.params
    }

    /// The world itself, for tools whose answers are made from its state.
    pub(super) fn world(&self) -> &'a World {
        self.world
    }

    /// Whether a group has been discovered.
    pub fn knows(&self, group: Group) -> bool {
        self.world.market.is_known(group)
    }

    /// Discovered groups in their fixed order.
    pub fn known_groups(&self) -> impl Iterator<Item = Group> + 'a {
        let world = self.world;
        Group::all().filter(|group| world.market.is_known(*group))
    }
}
