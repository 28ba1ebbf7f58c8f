//! `novamind tools`: the catalogue.

use clap::Args;
use serde_json::Value;

use super::{Failure, print};
use crate::tools::{CATALOGUE, Numbers, catalogue, describe, find};

/// Options of `tools`.
#[derive(Debug, Args)]
pub struct Options {
    /// Show everything about this tool.
    name: Option<String>,
    /// Print as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<(), Failure> {
    let numbers = Numbers::shipped();
    let text = match (&options.name, options.json) {
        (None, false) => describe::overview(),
        (None, true) => {
            let all: Value = CATALOGUE.iter().map(|tool| describe::as_json(*tool, &numbers)).collect();
            format!("{all:#}\n")
        }
        (Some(name), json) => {
            let tool = find(name).or_else(|| catalogue::find_code(name)).ok_or_else(|| {
                Failure::usage(match catalogue::nearest(name) {
                    near if near.is_empty() => {
                        format!("there is no tool {name}; `novamind tools` lists them")
                    }
                    near => format!("there is no tool {name}; did you mean {}?", near.join(" or ")),
                })
            })?;
            if json {
                format!("{:#}\n", describe::as_json(tool, &numbers))
            } else {
                describe::manual(tool.spec(), &numbers)
            }
        }
    };
    print(&text)
}
