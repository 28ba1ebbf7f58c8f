//! Tests of the built program: pipes, scripts, files, archives, terminals, and comparisons of figures with recorded figures.

#[cfg(all(feature = "server", unix))]
mod agents;
mod audit;
mod classes;
#[cfg(feature = "server")]
mod conformance;
mod determinism;
mod exit_codes;
mod exports;
mod failures;
mod forged;
#[cfg(all(feature = "server", unix))]
mod frozen;
mod golden;
#[cfg(feature = "server")]
mod hostile_requests;
mod installation;
#[cfg(feature = "server")]
mod interfaces;
mod kept_runs;
#[cfg(feature = "server")]
mod known_differences;
mod laboratory;
#[cfg(unix)]
mod large_studies;
mod lessons;
mod own_runs;
mod plain;
#[cfg(feature = "server")]
mod python_client;
#[cfg(unix)]
mod python_scripts;
#[cfg(feature = "server")]
mod release_2;
#[cfg(feature = "server")]
mod release_2_commands;
#[cfg(feature = "server")]
mod release_history;
#[cfg(feature = "server")]
mod retries;
mod scenarios;
mod seeded_faults;
mod studies;
mod study_setup;
#[path = "../support/mod.rs"]
mod support;
#[cfg(unix)]
mod terminal;
mod transcripts;
mod viewer;
#[cfg(feature = "server")]
mod voice;
