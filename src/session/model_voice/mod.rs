//! A language model that lends the public its voice: asking it, recording what it says, and going on without it
//! (docs/interfaces/voice.md).
//!
//! Its scores of the player's posts are inputs of the world, so their line is in the trajectory before they count. Its words
//! stand beside the world: nothing that is simulated reads them.

mod endpoint;
pub(crate) mod speaker;
#[cfg(all(any(test, feature = "test-kit"), feature = "server"))]
pub(crate) mod stub;
