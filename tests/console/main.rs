//! The console as a person meets it: stories, sizes, random keys.

mod guide;
mod harness;
mod monkey;
mod sizes;
mod stories;
