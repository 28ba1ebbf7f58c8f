//! A language model as voice: requests, recording and fallback (docs/interfaces/voice.md).
//!
//! The model's scores for the player's posts are inputs to the world, so they are recorded in the trajectory before
//! they take effect. The model's texts do not affect the simulation.

pub(crate) mod client;
mod endpoint;
#[cfg(all(any(test, feature = "test-kit"), feature = "server"))]
pub(crate) mod stub;
