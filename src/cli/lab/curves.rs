//! `novamind lab curves`: draws participation curves.

use clap::Args;

use super::output::OutputOptions;
use super::world::WorldOptions;
use crate::cli::{Context, Failure};
use crate::lab::curves::{all_curves_report, group_curve_report};
use crate::world::identifiers::Group;

#[derive(Debug, Args)]
pub struct Options {
    /// Draw only this group, with the variation among its customers
    #[arg(value_name = "GROUP")]
    group: Option<String>,
    #[command(flatten)]
    world: WorldOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let params = options.world.params(context)?;
    let Some(id) = &options.group else { return options.output.show(&all_curves_report(&params)) };
    let group = Group::parse(id).ok_or_else(|| {
        let all: Vec<&str> = Group::all().map(Group::id).collect();
        Failure::usage(format!("there is no group {id}; the groups are {}", all.join(", ")))
    })?;
    options.output.show(&group_curve_report(group, &params))
}
