//! Tests of the console from the user's view: scenarios, snapshots, window sizes and random input.

mod classes;
mod company;
mod curve;
mod figures;
mod focus;
mod harness;
mod hosted;
mod keys;
mod lessons;
mod monkey;
mod overlay;
mod participant_sessions;
mod picture_checks;
mod pictures;
mod record;
mod related_runs;
mod replay;
mod roles;
mod run_end;
mod scenarios;
mod sizes;
mod stale_database;
#[path = "../support/mod.rs"]
mod support;
mod tables;
mod tasks;
mod tour;
mod validity;
mod what_if;
mod why;
mod xray;
