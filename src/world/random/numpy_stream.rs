//! NumPy's default random generator, which reproduces the released simulator's errors of estimates exactly: PCG64 (M.
//! E. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
//! Generation", 2014), seeded through NumPy's `SeedSequence`.

/// A generator equivalent to `numpy.random.default_rng(seed)`.
pub struct NumpyStream {
    state: u128,
    increment: u128,
}

const MULTIPLIER: u128 = 0x2360_ed05_1fc6_5da4_4385_df64_9fcc_f645;

impl NumpyStream {
    /// Creates a generator from a 32-bit seed.
    pub fn new(seed: u32) -> NumpyStream {
        let words = seed_words(seed);
        let half = |at: usize| u128::from(words[at]) | u128::from(words[at + 1]) << 32;
        let (start, increment) = (half(0) << 64 | half(2), half(4) << 64 | half(6));
        let mut stream = NumpyStream { state: 0, increment: increment << 1 | 1 };
        stream.step();
        stream.state = stream.state.wrapping_add(start);
        stream.step();
        stream
    }

    fn step(&mut self) {
        self.state = self.state.wrapping_mul(MULTIPLIER).wrapping_add(self.increment);
    }

    /// Returns the next random number, uniform in [0, 1).
    pub fn next_f64(&mut self) -> f64 {
        self.step();
        let (high, low) = ((self.state >> 64) as u64, self.state as u64);
        let word = (high ^ low).rotate_right((self.state >> 122) as u32);
        (word >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Returns the eight words that `SeedSequence` generates. The seed is mixed into a pool of four words, and the pool is
/// then hashed.
fn seed_words(seed: u32) -> [u32; 8] {
    let fold = |value: u32| value ^ value >> 16;
    let mut factor: u32 = 0x43b0_d7e5;
    let mut hash = |value: u32| {
        let value = value ^ factor;
        factor = factor.wrapping_mul(0x931e_8875);
        fold(value.wrapping_mul(factor))
    };
    let mut pool = [seed, 0, 0, 0].map(&mut hash);
    for from in 0..4 {
        for to in (0..4).filter(|to| *to != from) {
            let (kept, added) = (pool[to].wrapping_mul(0xca01_f9dd), hash(pool[from]));
            pool[to] = fold(kept.wrapping_sub(added.wrapping_mul(0x4973_f715)));
        }
    }
    let mut factor: u32 = 0x8b51_f9dd;
    std::array::from_fn(|at| {
        let value = pool[at % 4] ^ factor;
        factor = factor.wrapping_mul(0x58f3_8ded);
        fold(value.wrapping_mul(factor))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numpy_stream_matches_released_insight_draws() {
        let recorded = include_str!("../../../tests/data/insight_noise.csv");
        assert_eq!(recorded.lines().count(), 10);
        for line in recorded.lines() {
            let (name, numbers) = line.split_once(',').expect("a name and its draws");
            let letters: [u8; 4] = name.as_bytes().try_into().expect("four letters");
            let mut stream = NumpyStream::new(u32::from_le_bytes(letters) & 0x7fff_ffff);
            for number in numbers.split(',') {
                assert_eq!(stream.next_f64(), number.parse::<f64>().expect("a number"), "{name}");
            }
        }
    }
}
