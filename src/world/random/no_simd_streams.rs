//! For processors without the registers of `simd_streams.rs`: streams are opened one by one.

/// Streams that would be opened together.
pub const LANES: usize = 8;

/// Key of a stream, as the words of its bytes.
pub type Key = [u32; 8];

/// None: nothing is done side by side here.
pub fn keys<const KEYS: usize>(_: &[u8; 32], _: &[[u64; KEYS]; LANES]) -> Option<[Key; LANES]> {
    None
}

/// None: nothing is done side by side here.
pub fn first_words<const KEYS: usize>(_: &[u8; 32], _: &[[u64; KEYS]; LANES]) -> Option<[u64; LANES]> {
    None
}
