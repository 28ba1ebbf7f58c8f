//! Definition of a draw: description, distribution under the current parameters, and the simulator's function for it.

use super::law::Law;
use novamind_base::nearest;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::random::{Part, Streams};

/// Parameters and streams of the draws.
#[derive(Debug)]
pub struct Luck {
    /// Current parameters.
    pub params: Params,
    /// Random streams.
    pub streams: Streams,
}

impl Luck {
    /// Creates the parameters and streams of a seed.
    pub fn of(params: Params, seed: u64) -> Luck {
        Luck { params, streams: Streams::new(seed) }
    }
}

/// The family of items that have separate draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// A single draw.
    One,
    /// Groups.
    Groups,
    /// Groups of individuals.
    Individuals,
    /// Groups of enterprises.
    Companies,
    /// R&D tiers.
    ResearchTiers,
}

impl Family {
    /// Returns the members: positions of groups or numbers of tiers, with names.
    pub fn members(self, params: &Params) -> Vec<(usize, String)> {
        let groups = |wanted: &dyn Fn(&Group) -> bool| {
            let own = Group::all().filter(|group| wanted(group));
            own.map(|group| (group.index(), group.id().to_owned())).collect()
        };
        match self {
            Family::One => vec![(0, String::new())],
            Family::Groups => groups(&|_| true),
            Family::Individuals => groups(&|group| !group.is_enterprise()),
            Family::Companies => groups(&|group| group.is_enterprise()),
            Family::ResearchTiers => {
                let own = params.research_tier.iter();
                own.map(|law| (usize::from(law.tier), format!("tier {}", law.tier))).collect()
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
    pub what: &'static str,
    /// Part of the simulator whose streams it uses.
    pub part: Part,
    /// Family.
    pub family: Family,
    /// Parameters that it depends on.
    pub keys: &'static [&'static str],
    /// Files below `src/world` that draw it, with the number of draws.
    pub sites: &'static [(&'static str, usize)],
    /// Distribution for a member of the family.
    pub law: fn(&Params, usize) -> Law,
    /// Returns the n-th draw for a member with the simulator's functions.
    pub draw: fn(&Luck, usize, u64) -> f64,
}

impl WorldDraw {
    /// Returns the draw with a name.
    ///
    /// # Errors
    /// Returns the most similar names if there is none.
    pub fn find(name: &str) -> Result<&'static WorldDraw, Vec<&'static str>> {
        let found = super::world_draws().find(|own| own.name == name);
        found.ok_or_else(|| nearest(name, super::world_draws().map(|own| own.name)))
    }

    /// Returns the first draws for a member.
    pub fn draws(&self, luck: &Luck, member: usize, count: u64) -> Vec<f64> {
        (1..=count).map(|n| (self.draw)(luck, member, n)).collect()
    }
}

/// Returns the group at a position.
pub(super) fn group_at(position: usize) -> Group {
    Group::at(position).unwrap_or_else(|| Group::all().next().expect("there are groups"))
}
