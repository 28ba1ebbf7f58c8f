//! `novamind host links`: creates links and codes of participants.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::open_folder;
use crate::cli::{Failure, print};
use crate::host::AuditEvent;
use crate::record::error::RunError;
use crate::record::files::create_private_file;

#[derive(Debug, Args)]
pub struct Options {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// File to write: label, link and code of each participant. The host keeps only digests, so keep this file
    #[arg(long, value_name = "FILE")]
    csv: PathBuf,
    /// Address of the host in links, for example https://play.example.org; saved for later links [default: the saved address]
    #[arg(long, value_name = "URL")]
    url: Option<String>,
    /// Replace the links and codes of these participants; their earlier ones become invalid
    #[arg(long, value_name = "LABEL", num_args = 1..)]
    renew: Vec<String>,
    /// Replace the links and codes of all participants
    #[arg(long, conflicts_with = "renew")]
    renew_all: bool,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let mut folder = open_folder(&options.folder)?;
    if let Some(url) = &options.url {
        check_url(url)?;
        folder.save_settings(Some(url.trim_end_matches('/').to_owned()), None)?;
    }
    let url = folder.url().unwrap_or("http://127.0.0.1:7420").to_owned();
    let all: Vec<String> = folder.labels().map(str::to_owned).collect();
    let existing: BTreeSet<String> = folder.access().labels()?.into_iter().collect();
    if let Some(unknown) = options.renew.iter().find(|label| !all.contains(label)) {
        return Err(Failure::usage(format!("{unknown} is not a label of this study; nothing was written")));
    }
    let is_wanted = |label: &String| match (options.renew_all, options.renew.is_empty()) {
        (true, _) => true,
        (false, true) => !existing.contains(label),
        (false, false) => options.renew.contains(label),
    };
    let labels: Vec<String> = all.into_iter().filter(is_wanted).collect();
    if labels.is_empty() {
        return Err(Failure::failed(
            "all participants have links, and the host keeps only digests of them; nothing was written. Use --renew LABEL \
             or --renew-all to replace links",
        ));
    }
    // The file is created first: if it cannot be written, earlier links stay valid.
    let file = &options.csv;
    let mut out = create_private_file(file)
        .map_err(|error| Failure::failed(format!("{}: {error}; no links were created", file.display())))?;
    let issued = folder.access().issue(&labels)?;
    let mut text = "label,link,code\n".to_owned();
    for one in &issued {
        text += &format!("{},{url}/s/{},{}\n", one.label, one.token, one.code);
    }
    out.write_all(text.as_bytes()).and_then(|()| out.sync_all()).map_err(RunError::io(file))?;
    folder.audit().append(&AuditEvent::LinksIssued { labels })?;
    print(&format!("wrote {} links and codes to {}\n", issued.len(), file.display()))
}

fn check_url(url: &str) -> Result<(), Failure> {
    let host = url.strip_prefix("https://").or_else(|| url.strip_prefix("http://"));
    let is_plain = |text: &str| !text.is_empty() && !text.contains(['"', ',', '\n', ' ', '?', '#']);
    match host {
        Some(host) if is_plain(host) => Ok(()),
        _ => Err(Failure::usage(format!("{url:?} is not an address such as https://play.example.org"))),
    }
}
