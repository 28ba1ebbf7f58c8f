//! The definition of a random draw: description, distribution under the current parameters, and the simulator function
//! that draws.

use super::distribution::DrawDistribution;
use novamind_base::similar_names;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::random::{Part, Streams};

/// The parameters and random streams that draws use.
#[derive(Debug)]
pub struct DrawContext {
    /// Parameters that determine the distributions.
    pub params: Params,
    /// Random streams of the seed.
    pub streams: Streams,
}

impl DrawContext {
    /// Creates the context from parameters and a seed.
    pub fn new(params: Params, seed: u64) -> DrawContext {
        DrawContext { params, streams: Streams::new(seed) }
    }
}

/// The items for which a draw is made separately.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawFamily {
    /// No family; the draw is made once.
    Single,
    /// One draw for each customer group.
    Groups,
    /// One draw for each group of individuals.
    Individuals,
    /// One draw for each group of enterprises.
    Enterprises,
    /// One draw for each R&D tier.
    ResearchTiers,
}

impl DrawFamily {
    /// Returns the members of the family: the position of each group or the number of each tier, with its name.
    pub fn members(self, params: &Params) -> Vec<(usize, String)> {
        let groups = |wanted: &dyn Fn(&Group) -> bool| {
            let chosen = Group::all().filter(|group| wanted(group));
            chosen.map(|group| (group.index(), group.id().to_owned())).collect()
        };
        match self {
            DrawFamily::Single => vec![(0, String::new())],
            DrawFamily::Groups => groups(&|_| true),
            DrawFamily::Individuals => groups(&|group| !group.is_enterprise()),
            DrawFamily::Enterprises => groups(&|group| group.is_enterprise()),
            DrawFamily::ResearchTiers => {
                let tiers = params.research_tier.iter();
                tiers
                    .map(|research_tier| {
                        (usize::from(research_tier.tier), format!("tier {}", research_tier.tier))
                    })
                    .collect()
            }
        }
    }
}

/// A random draw of the simulator.
#[derive(Debug)]
pub struct WorldDraw {
    /// Unique name of the draw, for example `post_clock`.
    pub name: &'static str,
    /// Description of the draw, with its unit.
    pub description: &'static str,
    /// Part of the simulator whose random streams the draw uses.
    pub part: Part,
    /// Items for which the draw is made separately.
    pub family: DrawFamily,
    /// Parameters on which the distribution depends.
    pub parameters: &'static [&'static str],
    /// Files below `src/world` that contain the draw, each with the number of its occurrences.
    pub source_files: &'static [(&'static str, usize)],
    /// Function that returns the distribution for a member of the family.
    pub distribution: fn(&Params, usize) -> DrawDistribution,
    /// Function that makes the n-th draw for a member of the family by calling the simulator's code.
    pub draw: fn(&DrawContext, usize, u64) -> f64,
}

impl WorldDraw {
    /// Returns the draw with the given name.
    ///
    /// # Errors
    /// Returns the most similar names if no draw has this name.
    pub fn find(name: &str) -> Result<&'static WorldDraw, Vec<&'static str>> {
        let found = super::world_draws().find(|world_draw| world_draw.name == name);
        found.ok_or_else(|| similar_names(name, super::world_draws().map(|draw| draw.name)))
    }

    /// Returns the first `count` draws for a member of the family.
    pub fn draws(&self, context: &DrawContext, member: usize, count: u64) -> Vec<f64> {
        (1..=count).map(|n| (self.draw)(context, member, n)).collect()
    }
}

/// Returns the group at a position in the list of groups.
pub(super) fn group_at(position: usize) -> Group {
    Group::at(position).unwrap_or_else(|| Group::all().next().expect("there are groups"))
}
