//! Definition of a draw: description, distribution under the current parameters, and the simulator's function for it.

use super::distribution::DrawDistribution;
use novamind_base::similar_names;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::random::{Part, Streams};

/// Parameters and streams of the draws.
#[derive(Debug)]
pub struct DrawContext {
    /// Current parameters.
    pub params: Params,
    /// Random streams.
    pub streams: Streams,
}

impl DrawContext {
    /// Creates the parameters and streams of a seed.
    pub fn new(params: Params, seed: u64) -> DrawContext {
        DrawContext { params, streams: Streams::new(seed) }
    }
}

/// The family of items that have separate draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawFamily {
    /// A single draw.
    Single,
    /// Groups.
    Groups,
    /// Groups of individuals.
    Individuals,
    /// Groups of enterprises.
    Enterprises,
    /// R&D tiers.
    ResearchTiers,
}

impl DrawFamily {
    /// Returns the members: positions of groups or numbers of tiers, with names.
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
    /// Name.
    pub name: &'static str,
    /// Description with unit.
    pub description: &'static str,
    /// Part of the simulator whose streams it uses.
    pub part: Part,
    /// Family.
    pub family: DrawFamily,
    /// Parameters that it depends on.
    pub parameters: &'static [&'static str],
    /// Files below `src/world` that draw it, with the number of draws.
    pub source_files: &'static [(&'static str, usize)],
    /// Distribution for a member of the family.
    pub distribution: fn(&Params, usize) -> DrawDistribution,
    /// Returns the n-th draw for a member with the simulator's functions.
    pub draw: fn(&DrawContext, usize, u64) -> f64,
}

impl WorldDraw {
    /// Returns the draw with a name.
    ///
    /// # Errors
    /// Returns the most similar names if there is none.
    pub fn find(name: &str) -> Result<&'static WorldDraw, Vec<&'static str>> {
        let found = super::world_draws().find(|world_draw| world_draw.name == name);
        found.ok_or_else(|| similar_names(name, super::world_draws().map(|draw| draw.name)))
    }

    /// Returns the first draws for a member.
    pub fn draws(&self, luck: &DrawContext, member: usize, count: u64) -> Vec<f64> {
        (1..=count).map(|n| (self.draw)(luck, member, n)).collect()
    }
}

/// Returns the group at a position.
pub(super) fn group_at(position: usize) -> Group {
    Group::at(position).unwrap_or_else(|| Group::all().next().expect("there are groups"))
}
