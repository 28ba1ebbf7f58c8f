//! Named random streams, from which the world makes all random draws.
//!
//! The key of a ChaCha8 stream is a hash of the run seed, the part and the entity keys. Streams are independent: a
//! draw in one stream never affects another stream, and work can be distributed among threads. Two runs with the same
//! seed have the same draws regardless of the players' decisions (`docs/mechanics/randomness.md`).
//!
//! Each continuous draw uses exactly one 64-bit word, so the draws of a customer's traits have fixed positions. Normal
//! variates are computed by the inverse distribution function (Wichura's algorithm AS 241), which needs one word, no
//! rejection, and at most one logarithm.

mod numpy_stream;
mod quantile;
#[cfg_attr(not(target_arch = "x86_64"), path = "random/no_simd_streams.rs")]
mod simd_streams;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

pub use numpy_stream::NumpyStream;
pub use quantile::inverse_normal;

macro_rules! parts {
    ($($(#[$doc:meta])* $name:ident = $text:literal,)*) => {
        /// A part of the world that makes random draws. Each variant documents the entity keys of its streams.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[repr(usize)]
        pub enum Part { $($(#[$doc])* $name,)* }

        impl Part {
            /// All parts, in the order of their variants.
            pub const ALL: &'static [Part] = &[$(Part::$name,)*];


            /// Returns the name of the part. The keys of the part's streams are derived from this name.
            pub fn name(self) -> &'static str {
                match self { $(Part::$name => $text,)* }
            }
        }
    };
}

parts! {
    /// (day): outage, downtime, latency and error rate of the service.
    Service = "service",
    /// (day): daily noise of the shared quality.
    QualityNoise = "quality_noise",
    /// (tier, earlier starts): duration and gain of an R&D project.
    Research = "research",
    /// (group, n, day): usage rate of a billing period.
    UsageRate = "usage_rate",
    /// (day, pool kind, pool, group): selection of the support issues that are resolved.
    IssueResolution = "issue_resolution",
    /// (day, group, block): selection of the subscribers who open a support issue.
    IssueOpening = "issue_opening",
    /// (group, month): rate of involuntary churn.
    InvoluntaryMu = "involuntary_mu",
    /// (day, group, block): selection of the subscribers whose payment fails permanently.
    InvoluntaryRoll = "involuntary_roll",
    /// (day, group, n, thread): amount of reputation damage. The thread is 0 for individuals.
    ReputationEvent = "reputation_event",
    /// (group, n): traits and profile of a customer.
    Traits = "traits",
    /// (group, n): source of the customer.
    LeadSource = "lead_source",
    /// (group, n): error in judging quality at the first decision.
    LeadNoise = "lead_noise",
    /// (day, group): number of leads.
    LeadCount = "lead_count",
    /// (group, month): monthly change in the channel yields.
    LeadRateDrift = "lead_rate_drift",
    /// (attempt): success of market research, and the discovered group.
    MarketResearch = "market_research",
    /// (group, level, field): error of an estimate.
    Insight = "insight",
    /// (day): occurrence, duration and factor of a demand surge.
    Surge = "surge",
    /// (day): daily step of the hidden PMI.
    Macro = "macro",
    /// (day): occurrence and gain of a competitor event, and the copied shares of the quality banks.
    CompetitorEvent = "competitor_event",
    /// (thread, turn): days until an enterprise replies to an offer.
    ReplyDelay = "reply_delay",
    /// (group, n): error of an enterprise in judging quality in its first negotiation.
    NegotiationNoise = "negotiation_noise",
    /// (day, group, n): whether an enterprise requests a different plan.
    PlanChange = "plan_change",
    /// (day): estimated gain, names, points of view and engagement in posts about competitors.
    CompetitorPosts = "competitor_posts",
    /// (day): rounds and engagement of posts about the economy. Day 0 determines the first round.
    MacroPosts = "macro_posts",
    /// (day): authors of customers' posts, then tone and engagement of each post.
    CustomerPosts = "customer_posts",
    /// (post, group): views of a post of the player.
    CeoViews = "ceo_views",
    /// (post, group): author of a comment, and its engagement.
    CeoReply = "ceo_reply",
    /// (post): wording of a post. The draws never affect the numbers of the world.
    Voice = "voice",
    /// (group, n): profile name of a customer.
    PersonaTemplate = "persona_template",
}

/// The random streams of one run.
#[derive(Debug, Clone)]
pub struct Streams {
    seed: u64,
    keys: PartKeys,
    /// Last day with the original keys of the run, and these keys. `None` if no draws were replaced.
    original: Option<(u32, PartKeys)>,
}

type PartKeys = Vec<[u8; 32]>;

impl Streams {
    /// Creates the streams of a run with this seed.
    pub fn new(seed: u64) -> Self {
        Streams { seed, keys: part_keys("novamind random streams, version 1", &[seed]), original: None }
    }

    /// Returns the streams of the same run with different draws after `last_own_day`. Equal salts result in equal
    /// draws. Draws of earlier days stay the same if they are read with [`Streams::open_for_day`].
    pub fn redrawn_after(&self, salt: u64, last_own_day: u32) -> Self {
        let keys = part_keys("novamind random streams, redrawn, version 1", &[self.seed, salt]);
        let original = self.original.clone().unwrap_or_else(|| (last_own_day, self.keys.clone()));
        Streams { seed: self.seed, keys, original: Some(original) }
    }

    /// Returns the seed from which these streams are derived.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Opens the stream of a part for up to four entity keys. Equal arguments always return the same stream.
    pub fn open<const KEYS: usize>(&self, part: Part, entity: [u64; KEYS]) -> Stream {
        Stream::from_key(self.key(part, entity))
    }

    /// Opens the stream of a value that is drawn on `day` and read again on later days. If draws were replaced only
    /// after `day`, the stream has the original keys.
    pub fn open_for_day<const KEYS: usize>(&self, day: u32, part: Part, entity: [u64; KEYS]) -> Stream {
        let keys = match &self.original {
            Some((last, bytes)) if day <= *last => bytes,
            _ => &self.keys,
        };
        Stream::from_key(stream_key(&keys[part as usize], entity))
    }

    fn key<const KEYS: usize>(&self, part: Part, entity: [u64; KEYS]) -> StreamKey {
        stream_key(&self.keys[part as usize], entity)
    }

    /// Returns the stream keys of a part for many entities. [`Stream::from_key`] opens a key's stream, which equals
    /// the stream of [`Streams::open`].
    pub fn keys<const KEYS: usize>(&self, part: Part, entities: &[[u64; KEYS]]) -> Vec<StreamKey> {
        map_in_lanes(
            entities,
            |entity| self.key(part, entity),
            |some| {
                simd_streams::keys(&self.keys[part as usize], some)
                    .map(|keys| keys.map(StreamKey::from_words))
            },
        )
    }

    /// Returns the first word of each entity's stream, for streams with a single draw.
    pub fn first_words<const KEYS: usize>(&self, part: Part, entities: &[[u64; KEYS]]) -> Vec<Word> {
        map_in_lanes(
            entities,
            |entity| self.open(part, entity).word(),
            |some| simd_streams::first_words(&self.keys[part as usize], some).map(|words| words.map(Word)),
        )
    }
}

fn part_keys(context: &str, numbers: &[u64]) -> PartKeys {
    let key = |part: &Part| {
        let mut hasher = blake3::Hasher::new_derive_key(context);
        for number in numbers {
            hasher.update(&number.to_le_bytes());
        }
        hasher.update(part.name().as_bytes()).finalize().into()
    };
    Part::ALL.iter().map(key).collect()
}

fn stream_key<const KEYS: usize>(part: &[u8; 32], entity: [u64; KEYS]) -> StreamKey {
    const { assert!(KEYS <= 4) };
    let mut bytes = [0u8; 32];
    for (slot, key) in bytes.chunks_exact_mut(8).zip(entity) {
        slot.copy_from_slice(&key.to_le_bytes());
    }
    StreamKey(*blake3::keyed_hash(part, &bytes[..8 * KEYS]).as_bytes())
}

/// Processes entities in batches of eight if the processor supports batches. The remainder is processed one by one.
fn map_in_lanes<E: Copy, R>(
    entities: &[E],
    single: impl Fn(E) -> R,
    eight: impl Fn(&[E; simd_streams::LANES]) -> Option<[R; simd_streams::LANES]>,
) -> Vec<R> {
    let mut results = Vec::with_capacity(entities.len());
    let (eights, last) = entities.as_chunks();
    for some in eights {
        match eight(some) {
            Some(found) => results.extend(found),
            None => results.extend(some.iter().copied().map(&single)),
        }
    }
    results.extend(last.iter().copied().map(single));
    results
}

/// The ChaCha8 key of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StreamKey([u8; 32]);

impl StreamKey {
    fn from_words(words: simd_streams::Key) -> StreamKey {
        let mut bytes = [0u8; 32];
        for (bytes, word) in bytes.chunks_exact_mut(4).zip(words) {
            bytes.copy_from_slice(&word.to_le_bytes());
        }
        StreamKey(bytes)
    }
}

/// A word of 64 random bits: one draw of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word(u64);

impl Word {
    /// Draws a uniform number in [0, 1), with 53 random bits.
    #[inline]
    pub fn uniform(self) -> f64 {
        (self.0 >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Draws a uniform number in [low, high).
    #[inline]
    pub fn between(self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Draws a standard normal variate.
    #[inline]
    pub fn standard_normal(self) -> f64 {
        let middle = (self.0 >> 11) as f64 + 0.5;
        inverse_normal(middle * (1.0 / (1u64 << 53) as f64))
    }
}

/// An open random stream. Dropping the stream discards its position.
#[derive(Debug, Clone)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// Opens the stream with this key at its start.
    pub fn from_key(key: StreamKey) -> Stream {
        Stream(ChaCha8Rng::from_seed(key.0))
    }

    /// Returns the next word of 64 random bits.
    pub fn word(&mut self) -> Word {
        Word(self.0.next_u64())
    }

    /// Draws a uniform number in [0, 1), with 53 random bits.
    pub fn uniform(&mut self) -> f64 {
        self.word().uniform()
    }

    /// Draws a uniform number in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.word().between(low, high)
    }

    /// Draws a uniform integer in low..=high. The bias of the multiplication is below 2^-32.
    pub fn integer(&mut self, low: u32, high: u32) -> u32 {
        let span = u64::from(high - low) + 1;
        low + ((u128::from(self.0.next_u64()) * u128::from(span)) >> 64) as u32
    }

    /// Draws a uniform index below `length`, which must not be 0.
    pub fn index(&mut self, length: usize) -> usize {
        ((u128::from(self.0.next_u64()) * length as u128) >> 64) as usize
    }

    /// Returns true with probability `p`.
    pub fn bernoulli(&mut self, p: f64) -> bool {
        self.uniform() < p
    }

    /// Draws a standard normal variate.
    pub fn standard_normal(&mut self) -> f64 {
        self.word().standard_normal()
    }

    /// Draws a normal variate with this mean and standard deviation.
    pub fn normal(&mut self, mean: f64, std: f64) -> f64 {
        mean + std * self.standard_normal()
    }

    /// Draws an exponential variate with this mean.
    pub fn exponential(&mut self, mean: f64) -> f64 {
        -mean * libm::log1p(-self.uniform())
    }

    /// Draws a log-normal variate: the exponential of a normal variate.
    pub fn log_normal(&mut self, mu: f64, sigma: f64) -> f64 {
        libm::exp(self.normal(mu, sigma))
    }

    /// Draws a Poisson variate. Returns 0 if the mean is not positive.
    pub fn poisson(&mut self, mean: f64) -> u64 {
        if mean < 10.0 {
            poisson_by_inversion(mean, self.uniform())
        } else {
            poisson_by_rejection(mean, self)
        }
    }

    /// Fills a slice with 32-bit words of the stream, for blocks in which each customer has a fixed position.
    pub fn fill(&mut self, words: &mut [u32]) {
        const WORDS_PER_CHUNK: usize = 64;
        let mut bytes = [0u8; 4 * WORDS_PER_CHUNK];
        for words in words.chunks_mut(WORDS_PER_CHUNK) {
            let bytes = &mut bytes[..4 * words.len()];
            self.0.fill_bytes(bytes);
            for (word, four) in words.iter_mut().zip(bytes.chunks_exact(4)) {
                *word = u32::from_le_bytes([four[0], four[1], four[2], four[3]]);
            }
        }
    }
}

/// Returns true with probability `p`, decided by a word of [`Stream::fill`] with a resolution of 2^-32.
#[inline]
pub fn bernoulli_from_word(word: u32, p: f64) -> bool {
    f64::from(word) < p * 4_294_967_296.0
}

fn poisson_by_inversion(mean: f64, u: f64) -> u64 {
    if mean <= 0.0 {
        return 0;
    }
    let (mut count, mut term) = (0u64, libm::exp(-mean));
    let mut below = term;
    // For means below 10, the probability of a value above 200 is below the precision of f64.
    while u >= below && count < 200 {
        count += 1;
        term *= mean / count as f64;
        below += term;
    }
    count
}

/// Draws a Poisson variate by transformed rejection with squeeze (Hörmann 1993, algorithm PTRS), which is exact for
/// means of 10 and above.
fn poisson_by_rejection(mean: f64, stream: &mut Stream) -> u64 {
    let (root, log_mean) = (mean.sqrt(), libm::log(mean));
    let b = 0.931 + 2.53 * root;
    let a = -0.059 + 0.024_83 * b;
    let inverse_alpha = 1.123_9 + 1.132_8 / (b - 3.4);
    let v_r = 0.927_7 - 3.622_4 / (b - 2.0);
    loop {
        let u = stream.uniform() - 0.5;
        let v = stream.uniform();
        let us = 0.5 - u.abs();
        let k = ((2.0 * a / us + b) * u + mean + 0.43).floor();
        if us >= 0.07 && v <= v_r {
            return k as u64;
        }
        if k < 0.0 || (us < 0.013 && v > us) {
            continue;
        }
        let accept = libm::log(v) + libm::log(inverse_alpha) - libm::log(a / (us * us) + b);
        if accept <= -mean + k * log_mean - libm::lgamma(k + 1.0) {
            return k as u64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(draws: impl Iterator<Item = f64>) -> (f64, f64) {
        let values: Vec<f64> = draws.collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance =
            values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / values.len() as f64;
        (mean, variance.sqrt())
    }

    #[test]
    fn streams_are_equal_only_for_equal_keys() {
        let streams = Streams::new(42);
        let first = |streams: &Streams, part, keys| streams.open(part, keys).uniform();
        assert_eq!(first(&streams, Part::Traits, [0, 1]), first(&Streams::new(42), Part::Traits, [0, 1]));
        assert_ne!(first(&streams, Part::Traits, [0, 1]), first(&streams, Part::Traits, [0, 2]));
        assert_ne!(first(&streams, Part::Traits, [0, 1]), first(&streams, Part::LeadNoise, [0, 1]));
        assert_ne!(first(&streams, Part::Traits, [0, 1]), first(&Streams::new(43), Part::Traits, [0, 1]));
    }

    #[test]
    fn batch_opening_matches_single_opening() {
        let streams = Streams::new(42);
        for count in [0, 1, 7, 8, 9, 100] {
            let entities: Vec<[u64; 3]> = (0..count).map(|n| [n, n << 33 | 5, u64::MAX - n]).collect();
            let singly = entities.iter().map(|keys| streams.open(Part::UsageRate, *keys));
            let first: Vec<Word> = singly.clone().map(|mut stream| stream.word()).collect();
            assert_eq!(streams.first_words(Part::UsageRate, &entities), first);
            let together = streams.keys(Part::UsageRate, &entities).into_iter().map(Stream::from_key);
            for (mut one, mut other) in together.zip(singly) {
                assert!((0..40).all(|_| one.word() == other.word()));
            }
        }
        let single = streams.open(Part::Macro, [77]).word();
        assert_eq!(streams.first_words(Part::Macro, &[[77]]), [single]);
        let four = streams.open(Part::Macro, [1, 2, 3, 4]).word();
        assert_eq!(streams.first_words(Part::Macro, &[[1, 2, 3, 4]]), [four]);
    }

    #[test]
    fn fill_matches_the_words_of_the_stream() {
        let stream = Streams::new(5).open(Part::IssueOpening, [1, 2, 3]);
        let mut words = [0; 1000];
        stream.clone().fill(&mut words);
        let mut singly = stream;
        assert!(words.iter().all(|word| *word == singly.0.next_u32()));
    }

    #[test]
    fn first_bits_of_streams_never_change() {
        // These bits must never change, because every recorded run depends on them.
        let mut stream = Streams::new(42).open(Part::Macro, [1]);
        assert_eq!(stream.uniform().to_bits(), FIRST_UNIFORM);
        assert_eq!(stream.standard_normal().to_bits(), SECOND_NORMAL);
    }

    #[test]
    fn redrawn_streams_keep_earlier_draws() {
        let streams = Streams::new(42);
        let first = |streams: &Streams| streams.open(Part::Macro, [1]).word();
        let [one, same, other] =
            [(1, 30), (1, 30), (2, 30)].map(|(salt, day)| streams.redrawn_after(salt, day));
        assert_eq!(first(&one), first(&same));
        assert_ne!(first(&one), first(&other));
        assert_ne!(first(&one), first(&streams));
        let since = |streams: &Streams, day| streams.open_for_day(day, Part::InvoluntaryMu, [3, 1]).word();
        assert_eq!(since(&one, 30), since(&streams, 30));
        assert_ne!(since(&one, 31), since(&streams, 31));
        assert_eq!(since(&streams, 31), streams.open(Part::InvoluntaryMu, [3, 1]).word());
        // A second replacement of draws keeps the original keys of earlier days.
        assert_eq!(since(&one.redrawn_after(7, 60), 30), since(&streams, 30));
    }

    const FIRST_UNIFORM: u64 = 4604554976407843933;
    const SECOND_NORMAL: u64 = 4603890776221144754;

    #[test]
    fn continuous_draws_match_their_moments() {
        let mut stream = Streams::new(1).open(Part::Service, [0]);
        let (mean, std) = moments((0..200_000).map(|_| stream.normal(3.0, 2.0)));
        assert!((mean - 3.0).abs() < 0.02 && (std - 2.0).abs() < 0.02, "{mean} {std}");
        let (mean, std) = moments((0..200_000).map(|_| stream.exponential(1.5)));
        assert!((mean - 1.5).abs() < 0.015 && (std - 1.5).abs() < 0.02, "{mean} {std}");
    }

    #[test]
    fn poisson_draws_match_their_moments() {
        let mut stream = Streams::new(2).open(Part::LeadCount, [0]);
        for expected in [0.3, 4.0, 9.99, 10.0, 57.5, 1200.0] {
            let (mean, std) = moments((0..100_000).map(|_| stream.poisson(expected) as f64));
            let standard_error = (expected / 100_000.0).sqrt();
            assert!((mean - expected).abs() < 4.5 * standard_error, "mean of {expected}: {mean}");
            assert!((std / expected.sqrt() - 1.0).abs() < 0.015, "standard deviation of {expected}: {std}");
        }
        assert_eq!(stream.poisson(0.0), 0);
        assert_eq!(stream.poisson(-1.0), 0);
    }

    #[test]
    fn integer_is_uniform_including_both_ends() {
        let mut stream = Streams::new(3).open(Part::Surge, [0]);
        let mut counts = [0u32; 8];
        for _ in 0..80_000 {
            counts[stream.integer(3, 10) as usize - 3] += 1;
        }
        assert!(counts.iter().all(|count| (9_500..10_500).contains(count)), "{counts:?}");
    }

    #[test]
    fn bernoulli_from_word_matches_its_probability() {
        assert!(!bernoulli_from_word(0, 0.0));
        assert!(bernoulli_from_word(0, 1e-9));
        assert!(bernoulli_from_word(u32::MAX, 1.0));
        assert!(bernoulli_from_word(u32::MAX / 2, 0.5) && !bernoulli_from_word(u32::MAX / 2 + 1, 0.5));
    }
}
