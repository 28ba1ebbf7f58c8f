//! A small random generator, because tests must not depend on the stream of a crate.

/// A random generator.
pub struct Dice(u64);

impl Dice {
    /// Creates the generator of a seed.
    pub fn new(seed: u64) -> Dice {
        Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    /// Creates the generator of a test; `NOVAMIND_TEST_SEED` sets another seed. The seed is printed and visible if the test fails.
    pub fn for_test(name: &str) -> Dice {
        let seed = std::env::var("NOVAMIND_TEST_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
        println!("{name}: NOVAMIND_TEST_SEED={seed}");
        Dice::new(seed)
    }

    /// Returns a number below `sides`.
    pub fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % sides
    }

    /// Returns one of the values.
    pub fn pick<'a, T>(&mut self, things: &'a [T]) -> &'a T {
        &things[self.roll(things.len())]
    }
}
