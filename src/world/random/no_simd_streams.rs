//! Fallback for `simd_streams.rs` on processors without AVX2: streams are opened one by one.

/// Number of streams per batch.
pub const LANES: usize = 8;

/// Key of a stream as 32-bit words.
pub type Key = [u32; 8];

/// Returns `None`, because this build does not support batches.
pub fn keys<const KEYS: usize>(_: &[u8; 32], _: &[[u64; KEYS]; LANES]) -> Option<[Key; LANES]> {
    None
}

/// Returns `None`, because this build does not support batches.
pub fn first_words<const KEYS: usize>(_: &[u8; 32], _: &[[u64; KEYS]; LANES]) -> Option<[u64; LANES]> {
    None
}
