//! Tests of the console from the user's view: stories, pictures, sizes, random input.

mod behind;
mod classes;
mod company;
mod curve;
mod figures;
mod focus;
mod guide;
mod harness;
mod kin;
mod lessons;
mod looks;
mod monkey;
mod over;
mod overlay;
mod pictures;
mod record;
mod replay;
mod roles;
mod sizes;
mod stories;
#[path = "../support/mod.rs"]
mod support;
mod tasks;
mod visits;
mod why;
mod xray;
