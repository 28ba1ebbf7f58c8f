//! Opens eight streams in parallel on processors with AVX2.
//!
//! Opening a stream takes one block of BLAKE3 and one block of ChaCha8. Each block is computed in a chain of dependent
//! steps, which leaves the processor mostly idle. Each simulated day opens thousands of streams for a single draw
//! (bills, leads). Eight streams are therefore opened together, one per lane of a vector register, which takes a fifth
//! of the time. The fallback is [`super::Streams::open`]. Tests check that the batch and the fallback return the same
//! bits.
#![expect(unsafe_code, reason = "AVX2 intrinsics are unsafe; see the safety comments")]

use std::arch::x86_64::{
    __m256i, _mm256_add_epi32, _mm256_extract_epi32, _mm256_or_si256, _mm256_set_epi32, _mm256_set1_epi32,
    _mm256_slli_epi32, _mm256_srli_epi32, _mm256_xor_si256,
};

/// Number of streams per batch.
pub const LANES: usize = 8;

/// Key of a stream as 32-bit words.
pub type Key = [u32; 8];

/// First four words of the initial state of BLAKE3, which are part of every block.
const BLAKE3_INITIAL_STATE: [u32; 4] = [0x6a09_e667, 0xbb67_ae85, 0x3c6e_f372, 0xa54f_f53a];
/// The order of message words in each round of BLAKE3.
const BLAKE3_WORD_ORDER: [[usize; 16]; 7] = [
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15],
    [2, 6, 3, 10, 7, 0, 4, 13, 1, 11, 12, 5, 9, 14, 15, 8],
    [3, 4, 10, 12, 13, 2, 7, 14, 6, 5, 9, 0, 11, 15, 8, 1],
    [10, 7, 12, 9, 14, 3, 13, 15, 4, 0, 11, 2, 5, 8, 1, 6],
    [12, 13, 9, 11, 15, 10, 14, 8, 7, 2, 5, 3, 0, 1, 6, 4],
    [9, 14, 11, 5, 8, 12, 15, 1, 13, 3, 0, 10, 2, 6, 4, 7],
    [11, 15, 5, 0, 1, 9, 8, 6, 14, 10, 2, 12, 3, 4, 7, 13],
];
/// Flags of a keyed hash of a single block: chunk start, chunk end, root, keyed.
const BLAKE3_SINGLE_KEYED_BLOCK: u32 = 1 | 2 | 8 | 16;
const CHACHA_CONSTANTS: [u32; 4] = [0x6170_7865, 0x3320_646e, 0x7962_2d32, 0x6b20_6574];

/// Returns whether the processor supports AVX2.
pub fn is_available() -> bool {
    is_x86_feature_detected!("avx2")
}

/// Returns the stream keys of eight entities, or `None` if AVX2 is not [`is_available`].
pub fn keys<const KEYS: usize>(part: &[u8; 32], entities: &[[u64; KEYS]; LANES]) -> Option<[Key; LANES]> {
    // SAFETY: `is_available` checked that the processor supports AVX2.
    is_available().then(|| unsafe { keys_in_lanes(part, entities) })
}

/// Returns the first 64-bit words of the streams of eight entities, or `None` if AVX2 is not [`is_available`].
pub fn first_words<const KEYS: usize>(
    part: &[u8; 32],
    entities: &[[u64; KEYS]; LANES],
) -> Option<[u64; LANES]> {
    // SAFETY: `is_available` checked that the processor supports AVX2.
    is_available().then(|| unsafe { first_words_in_lanes(part, entities) })
}

#[target_feature(enable = "avx2")]
fn keys_in_lanes<const KEYS: usize>(part: &[u8; 32], entities: &[[u64; KEYS]; LANES]) -> [Key; LANES] {
    let mut keys = [[0u32; 8]; LANES];
    for (at, word) in hash_keys(part, entities).into_iter().enumerate() {
        for (key, number) in keys.iter_mut().zip(to_lanes(word)) {
            key[at] = number;
        }
    }
    keys
}

/// Returns the first 64-bit word of each stream, which is in the first ChaCha8 block of the stream.
#[target_feature(enable = "avx2")]
fn first_words_in_lanes<const KEYS: usize>(part: &[u8; 32], entities: &[[u64; KEYS]; LANES]) -> [u64; LANES] {
    let mut state = [splat(0); 16];
    state[4..12].copy_from_slice(&hash_keys(part, entities));
    for (word, constant) in state.iter_mut().zip(CHACHA_CONSTANTS) {
        *word = splat(constant);
    }
    for _ in 0..4 {
        chacha_quarter_round(&mut state, [0, 4, 8, 12]);
        chacha_quarter_round(&mut state, [1, 5, 9, 13]);
        chacha_quarter_round(&mut state, [2, 6, 10, 14]);
        chacha_quarter_round(&mut state, [3, 7, 11, 15]);
        chacha_quarter_round(&mut state, [0, 5, 10, 15]);
        chacha_quarter_round(&mut state, [1, 6, 11, 12]);
        chacha_quarter_round(&mut state, [2, 7, 8, 13]);
        chacha_quarter_round(&mut state, [3, 4, 9, 14]);
    }
    let low = to_lanes(_mm256_add_epi32(state[0], splat(CHACHA_CONSTANTS[0])));
    let high = to_lanes(_mm256_add_epi32(state[1], splat(CHACHA_CONSTANTS[1])));
    let mut words = [0; LANES];
    for lane in 0..LANES {
        words[lane] = u64::from(low[lane]) | u64::from(high[lane]) << 32;
    }
    words
}

/// Returns the keyed BLAKE3 hash of each entity's keys. The hash is the key of the entity's stream.
#[target_feature(enable = "avx2")]
#[inline]
fn hash_keys<const KEYS: usize>(part: &[u8; 32], entities: &[[u64; KEYS]; LANES]) -> [__m256i; 8] {
    let mut message = [splat(0); 16];
    for at in 0..KEYS {
        let (mut low, mut high) = ([0; LANES], [0; LANES]);
        for (lane, entity) in entities.iter().enumerate() {
            (low[lane], high[lane]) = (entity[at] as u32, (entity[at] >> 32) as u32);
        }
        (message[2 * at], message[2 * at + 1]) = (from_lanes(low), from_lanes(high));
    }
    let mut state = [splat(0); 16];
    for (word, bytes) in state.iter_mut().zip(part.chunks_exact(4)) {
        *word = splat(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    }
    for (word, start) in state[8..].iter_mut().zip(BLAKE3_INITIAL_STATE) {
        *word = splat(start);
    }
    state[14] = splat(8 * KEYS as u32);
    state[15] = splat(BLAKE3_SINGLE_KEYED_BLOCK);
    for order in BLAKE3_WORD_ORDER {
        blake3_mix(&mut state, [0, 4, 8, 12], message[order[0]], message[order[1]]);
        blake3_mix(&mut state, [1, 5, 9, 13], message[order[2]], message[order[3]]);
        blake3_mix(&mut state, [2, 6, 10, 14], message[order[4]], message[order[5]]);
        blake3_mix(&mut state, [3, 7, 11, 15], message[order[6]], message[order[7]]);
        blake3_mix(&mut state, [0, 5, 10, 15], message[order[8]], message[order[9]]);
        blake3_mix(&mut state, [1, 6, 11, 12], message[order[10]], message[order[11]]);
        blake3_mix(&mut state, [2, 7, 8, 13], message[order[12]], message[order[13]]);
        blake3_mix(&mut state, [3, 4, 9, 14], message[order[14]], message[order[15]]);
    }
    let mut key = [splat(0); 8];
    for (at, word) in key.iter_mut().enumerate() {
        *word = _mm256_xor_si256(state[at], state[at + 8]);
    }
    key
}

#[target_feature(enable = "avx2")]
#[inline]
fn blake3_mix(state: &mut [__m256i; 16], [a, b, c, d]: [usize; 4], first: __m256i, second: __m256i) {
    state[a] = _mm256_add_epi32(_mm256_add_epi32(state[a], state[b]), first);
    state[d] = rotate_left::<16, 16>(_mm256_xor_si256(state[d], state[a]));
    state[c] = _mm256_add_epi32(state[c], state[d]);
    state[b] = rotate_left::<20, 12>(_mm256_xor_si256(state[b], state[c]));
    state[a] = _mm256_add_epi32(_mm256_add_epi32(state[a], state[b]), second);
    state[d] = rotate_left::<24, 8>(_mm256_xor_si256(state[d], state[a]));
    state[c] = _mm256_add_epi32(state[c], state[d]);
    state[b] = rotate_left::<25, 7>(_mm256_xor_si256(state[b], state[c]));
}

#[target_feature(enable = "avx2")]
#[inline]
fn chacha_quarter_round(state: &mut [__m256i; 16], [a, b, c, d]: [usize; 4]) {
    state[a] = _mm256_add_epi32(state[a], state[b]);
    state[d] = rotate_left::<16, 16>(_mm256_xor_si256(state[d], state[a]));
    state[c] = _mm256_add_epi32(state[c], state[d]);
    state[b] = rotate_left::<12, 20>(_mm256_xor_si256(state[b], state[c]));
    state[a] = _mm256_add_epi32(state[a], state[b]);
    state[d] = rotate_left::<8, 24>(_mm256_xor_si256(state[d], state[a]));
    state[c] = _mm256_add_epi32(state[c], state[d]);
    state[b] = rotate_left::<7, 25>(_mm256_xor_si256(state[b], state[c]));
}

#[target_feature(enable = "avx2")]
#[inline]
fn rotate_left<const LEFT: i32, const RIGHT: i32>(word: __m256i) -> __m256i {
    const { assert!(LEFT + RIGHT == 32) };
    _mm256_or_si256(_mm256_slli_epi32::<LEFT>(word), _mm256_srli_epi32::<RIGHT>(word))
}

/// Returns a vector with the same word in every lane.
#[target_feature(enable = "avx2")]
#[inline]
fn splat(word: u32) -> __m256i {
    _mm256_set1_epi32(word.cast_signed())
}

/// Returns a vector with one of the words in each lane.
#[target_feature(enable = "avx2")]
#[inline]
fn from_lanes(words: [u32; LANES]) -> __m256i {
    let [a, b, c, d, e, f, g, h] = words.map(u32::cast_signed);
    _mm256_set_epi32(h, g, f, e, d, c, b, a)
}

#[target_feature(enable = "avx2")]
#[inline]
fn to_lanes(word: __m256i) -> [u32; LANES] {
    [
        _mm256_extract_epi32::<0>(word),
        _mm256_extract_epi32::<1>(word),
        _mm256_extract_epi32::<2>(word),
        _mm256_extract_epi32::<3>(word),
        _mm256_extract_epi32::<4>(word),
        _mm256_extract_epi32::<5>(word),
        _mm256_extract_epi32::<6>(word),
        _mm256_extract_epi32::<7>(word),
    ]
    .map(i32::cast_unsigned)
}
