//! `novamind tools`: the catalog of tools.

use clap::Args;
use serde_json::json;

use super::{Failure, print};
use crate::tools::describe::{ToolDocument, document};
use crate::tools::{CATALOGUE, Numbers, catalogue, describe, find};

#[derive(Debug, Args)]
pub struct Options {
    /// Show the manual of this tool
    name: Option<String>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let numbers = Numbers::shipped();
    let text = match (&options.name, options.json) {
        (None, false) => catalogue::overview(),
        (None, true) => {
            let all: Vec<ToolDocument> =
                CATALOGUE.iter().map(|tool| document(tool.spec(), &numbers)).collect();
            format!("{:#}\n", json!(all))
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
                format!("{:#}\n", json!(document(tool.spec(), &numbers)))
            } else {
                describe::manual(tool.spec(), &numbers)
            }
        }
    };
    print(&text)
}
