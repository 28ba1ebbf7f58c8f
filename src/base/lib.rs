//! What every layer uses and what knows nothing of companies: notation of numbers, statistics of small samples, and the
//! search for a known name that resembles an unknown one.

mod nearest;
pub mod notation;
pub mod statistics;

pub use nearest::nearest;
