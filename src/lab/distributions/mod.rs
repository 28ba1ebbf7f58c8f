//! Every random draw of the simulator, with its distribution and exact moments (docs/laboratory/laws-and-curves.md).

mod customers;
mod distribution;
mod histogram;
mod market;
mod product;
mod reference_draws;
mod report;
mod retention;
mod social;
mod world_draw;

#[cfg(test)]
mod completeness_tests;

pub use report::{all_distributions_report, distribution_report};
pub use world_draw::{DrawContext, WorldDraw};

/// Returns all draws of the simulator in the order of its parts.
pub fn world_draws() -> impl Iterator<Item = &'static WorldDraw> {
    let parts = [
        product::PRODUCT_DRAWS,
        customers::CUSTOMER_DRAWS,
        retention::RETENTION_DRAWS,
        market::MARKET_DRAWS,
        social::SOCIAL_DRAWS,
    ];
    parts.into_iter().flatten()
}
