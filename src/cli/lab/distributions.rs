//! `novamind lab distributions`: every probability distribution of the simulator.

use clap::Args;

use super::output::OutputOptions;
use super::world::WorldOptions;
use crate::cli::{Context, Failure};
use crate::lab::distributions::{DrawContext, WorldDraw, all_distributions_report, distribution_report};

#[derive(Debug, Args)]
pub struct Options {
    /// Show only this distribution, with its histogram
    #[arg(value_name = "NAME")]
    name: Option<String>,
    /// Group or R&D tier [default: the first]
    #[arg(long, value_name = "MEMBER", requires = "name")]
    of: Option<String>,
    /// Number of draws of each distribution
    #[arg(long, default_value = "100000", value_name = "N", value_parser = clap::value_parser!(u64).range(2..=10_000_000))]
    draws: u64,
    /// Seed of the draws
    #[arg(long, default_value = "1", value_name = "N")]
    seed: u64,
    #[command(flatten)]
    world: WorldOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let params = options.world.params(context)?;
    let luck = DrawContext::new(params, options.seed);
    let Some(name) = &options.name else {
        return options.output.show(&all_distributions_report(&luck, options.draws));
    };
    let world_draw = find_distribution(name)?;
    let member = find_group_or_tier(world_draw, options.of.as_deref(), &luck)?;
    options.output.show(&distribution_report(world_draw, (member.0, &member.1), &luck, options.draws))
}

fn find_distribution(name: &str) -> Result<&'static WorldDraw, Failure> {
    WorldDraw::find(name).map_err(|near| {
        let help = match near.is_empty() {
            true => "`novamind lab distributions` lists all distributions".to_owned(),
            false => format!("did you mean {}?", near.join(" or ")),
        };
        Failure::usage(format!("there is no distribution {name}; {help}"))
    })
}

fn find_group_or_tier(
    world_draw: &WorldDraw,
    wanted: Option<&str>,
    luck: &DrawContext,
) -> Result<(usize, String), Failure> {
    let members = world_draw.family.members(&luck.params);
    let Some(wanted) = wanted else {
        return members
            .into_iter()
            .next()
            .ok_or_else(|| Failure::usage("these parameters do not use this distribution"));
    };
    let is_wanted = |(number, name): &(usize, String)| {
        name == wanted || (name.starts_with("tier") && number.to_string() == wanted)
    };
    members.iter().find(|member| is_wanted(member)).cloned().ok_or_else(|| {
        let names: Vec<&str> =
            members.iter().map(|(_, name)| name.as_str()).filter(|name| !name.is_empty()).collect();
        Failure::usage(match names.is_empty() {
            true => format!("{} is the same for all groups and tiers: leave out --of", world_draw.name),
            false => format!("--of must be one of {}", names.join(", ")),
        })
    })
}
