//! The only access to hidden state: looks, what a look shows, and the run simulated again beside itself.
//!
//! Every function that shows hidden state needs a [`Look`](look::Look). A look exists only after it was permitted and recorded.

pub(crate) mod look;
pub(crate) mod shadow;
