//! The fallback for processors without AVX2 (see `simd_streams.rs`): streams are opened one by one.

/// Streams per batch.
pub const LANES: usize = 8;

/// Key of a stream as 32-bit words.
pub type Key = [u32; 8];

/// Returns `None`, because batches are not supported.
pub fn keys<const KEYS: usize>(_: &[u8; 32], _: &[[u64; KEYS]; LANES]) -> Option<[Key; LANES]> {
    None
}

/// Returns `None`, because batches are not supported.
pub fn first_words<const KEYS: usize>(_: &[u8; 32], _: &[[u64; KEYS]; LANES]) -> Option<[u64; LANES]> {
    None
}
