//! Every distribution of the simulator with its exact moments (docs/laboratory/laws-and-curves.md).

mod customers;
mod exhibit;
mod histogram;
mod law;
mod market;
mod product;
mod reference;
mod retention;
mod social;
mod world_draw;

#[cfg(test)]
mod complete;

pub use exhibit::{all_laws, one_law};
pub use world_draw::{Luck, WorldDraw};

/// Returns all draws of the simulator in the order of its parts.
pub fn world_draws() -> impl Iterator<Item = &'static WorldDraw> {
    let parts = [product::DRAWS, customers::DRAWS, retention::DRAWS, market::DRAWS, social::DRAWS];
    parts.into_iter().flatten()
}
