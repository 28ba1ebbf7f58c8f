//! A small random number generator, because tests must not depend on the random stream of a crate.

/// A random number generator.
pub struct Dice(u64);

impl Dice {
    /// Creates a generator with a seed.
    pub fn new(seed: u64) -> Dice {
        Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    /// Creates a generator for a test. `NOVAMIND_TEST_SEED` sets a different seed. The seed is printed, so it is
    /// visible if the test fails.
    pub fn for_test(name: &str) -> Dice {
        let seed = std::env::var("NOVAMIND_TEST_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
        println!("{name}: NOVAMIND_TEST_SEED={seed}");
        Dice::new(seed)
    }

    /// Returns a random number below `sides`.
    pub fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % sides
    }

    /// Returns a randomly selected value.
    pub fn pick<'a, T>(&mut self, things: &'a [T]) -> &'a T {
        &things[self.roll(things.len())]
    }
}
