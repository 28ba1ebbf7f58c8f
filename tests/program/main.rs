//! Tests of the built program: pipes, scripts, files, archives, terminals, and its figures compared with recorded ones.

#[cfg(all(feature = "server", unix))]
mod agents;
mod audited;
mod classes;
#[cfg(feature = "server")]
mod conformance;
mod determinism;
#[cfg(feature = "server")]
mod doors;
mod edges;
mod exports;
mod forged;
#[cfg(all(feature = "server", unix))]
mod frozen;
mod golden;
mod hardship;
#[cfg(feature = "server")]
mod hostile;
#[cfg(feature = "server")]
mod known_differences;
mod laboratory;
#[cfg(unix)]
mod large_studies;
mod lessons;
mod looking;
mod own_runs;
mod plain;
mod planted;
mod preparation;
#[cfg(feature = "server")]
mod python_client;
#[cfg(unix)]
mod python_scripts;
#[cfg(feature = "server")]
mod retries;
mod scenarios;
mod studies;
#[path = "../support/mod.rs"]
mod support;
#[cfg(unix)]
mod terminal;
mod transcripts;
#[cfg(feature = "server")]
mod voice;
