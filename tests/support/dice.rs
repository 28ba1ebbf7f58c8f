//! Chance of the tests: a small generator of our own, for tests must not depend on a crate's stream of numbers.

/// A stream of numbers.
pub struct Dice(u64);

impl Dice {
    /// The stream of a seed.
    pub fn new(seed: u64) -> Dice {
        Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    /// The stream of a test; `NOVAMIND_TEST_SEED` names another. The seed is printed, and seen when the test fails.
    pub fn of_test(name: &str) -> Dice {
        let seed = std::env::var("NOVAMIND_TEST_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
        println!("{name}: NOVAMIND_TEST_SEED={seed}");
        Dice::new(seed)
    }

    /// A number below `sides`.
    pub fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % sides
    }

    /// One of some things.
    pub fn pick<'a, T>(&mut self, things: &'a [T]) -> &'a T {
        &things[self.roll(things.len())]
    }
}
