//! Integration tests of the library: runs, records, tables, durability, and hidden state.

mod battery;
mod breakpoints;
mod classes;
mod curve;
mod debriefs;
mod difference;
mod durability;
mod enterprise;
mod faults;
mod hidden;
mod lesson_gates;
mod lessons;
mod notebook;
mod overrides;
#[cfg(unix)]
mod python_scripts;
mod queries;
mod request_ids;
mod session;
#[path = "../support/mod.rs"]
mod support;
mod tables;
mod undiscovered;
mod why;
mod wiring;
mod xray;
mod xray_views;
