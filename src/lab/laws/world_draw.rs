//! A draw of the world: what it is, its law under the parameters in force, and how the world itself makes it.

use super::law::Law;
use novamind_base::nearest;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::random::{Part, Streams};

/// What the world draws with.
#[derive(Debug)]
pub struct Luck {
    /// Parameters in force.
    pub params: Params,
    /// Streams.
    pub streams: Streams,
}

impl Luck {
    /// The luck of a seed.
    pub fn of(params: Params, seed: u64) -> Luck {
        Luck { params, streams: Streams::new(seed) }
    }
}

/// What a draw is made for each of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Nothing: it is one.
    One,
    /// Groups.
    Groups,
    /// Groups of individuals.
    Individuals,
    /// Groups of companies.
    Companies,
    /// R&D tiers.
    ResearchTiers,
}

impl Family {
    /// Names of its members with their numbers: positions of groups, numbers of tiers.
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

/// A draw of the world.
#[derive(Debug)]
pub struct WorldDraw {
    /// Name.
    pub name: &'static str,
    /// What is drawn, with its unit.
    pub what: &'static str,
    /// Part whose streams it is drawn from.
    pub part: Part,
    /// What it is drawn for each of.
    pub family: Family,
    /// Parameters it follows from.
    pub keys: &'static [&'static str],
    /// Files below `src/world` that draw it, with how many draws of theirs it covers.
    pub sites: &'static [(&'static str, usize)],
    /// Its law for a member of the family.
    pub law: fn(&Params, usize) -> Law,
    /// Its n-th draw for a member, by the functions of the world.
    pub draw: fn(&Luck, usize, u64) -> f64,
}

impl WorldDraw {
    /// The draw of a name.
    ///
    /// # Errors
    /// There is none: the names that look most like it.
    pub fn find(name: &str) -> Result<&'static WorldDraw, Vec<&'static str>> {
        let found = super::world_draws().find(|own| own.name == name);
        found.ok_or_else(|| nearest(name, super::world_draws().map(|own| own.name)))
    }

    /// The first so many draws for a member.
    pub fn draws(&self, luck: &Luck, member: usize, count: u64) -> Vec<f64> {
        (1..=count).map(|n| (self.draw)(luck, member, n)).collect()
    }
}

/// The group at a position.
pub(super) fn group_at(position: usize) -> Group {
    Group::at(position).unwrap_or_else(|| Group::all().next().expect("there are groups"))
}
