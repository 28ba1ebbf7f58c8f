//! The inbox as packed days: in memory for queries, as blobs in the database file.
//!
//! If a lead is lost after its thread had two turns, the loss is reported again every day until the run ends. A large
//! company has millions of such rows. These losses are stored once per lead, in the order of the first report. Each
//! day stores the number of losses that it repeats.

use std::sync::Arc;

use super::packing::{KindSet, PackedRows, Packer, Unpacker};
use novamind_world::events::{LossCause, Notice};

/// Notification types in alphabetical order.
pub(super) const NOTICE_TYPES: [&str; 8] = [
    "deal_won",
    "group_research_complete",
    "large_customer_message",
    "lead_lost",
    "macro_economic_update",
    "market_discovery",
    "research_complete",
    "social_media",
];

/// Index of the type `lead_lost` in [`NOTICE_TYPES`].
pub(super) const LEAD_LOST_INDEX: u8 = 3;

/// Returns the index of a notice's type in [`NOTICE_TYPES`].
pub(super) fn type_index(notice: &Notice) -> u8 {
    NOTICE_TYPES.binary_search(&notice.kind()).map_or(LEAD_LOST_INDEX, |at| at as u8)
}

/// A lost lead that is reported again every day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RepeatedLoss {
    /// Customer number of the lost lead.
    pub customer: u32,
    /// Day of the unanswered message.
    pub message_day: u32,
    /// Side whose silence caused the loss.
    pub cause: LossCause,
}

impl RepeatedLoss {
    /// Returns the loss that a notice repeats, or `None` for other notices.
    pub fn from_notice(notice: &Notice) -> Option<RepeatedLoss> {
        let Notice::LeadLossRepeated { customer, cause, message_day, .. } = *notice else { return None };
        Some(RepeatedLoss { customer, message_day, cause })
    }

    /// Returns the text of the repeated notice.
    pub fn text(&self) -> String {
        let RepeatedLoss { customer, message_day, .. } = self;
        match self.cause {
            LossCause::Silence => format!(
                "Customer {customer} did not answer our offer of day {message_day}. The lead is lost; this \
                 repeats daily."
            ),
            LossCause::Unanswered => format!(
                "Customer {customer} got no answer to its message of day {message_day}. The lead is lost; this \
                 repeats daily."
            ),
        }
    }
}

/// The notices of a day.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct NoticeDay {
    pub day: u32,
    /// Row number of the day's first notice.
    pub first: u64,
    /// Number of losses that are repeated on this day. The repeated losses are the first losses in the run's list.
    pub repeats: u32,
    /// Number of notices before the repeated losses. Notices of later tool calls follow the repeated losses.
    pub before_repeats: u32,
    types: Vec<u8>,
    texts: PatternTexts,
}

impl NoticeDay {
    /// Returns an inbox day without notices.
    pub fn new(day: u32, first: u64) -> NoticeDay {
        NoticeDay { day, first, ..NoticeDay::default() }
    }

    /// Appends a notice that is not a repeated loss.
    pub fn push(&mut self, notice_type: u8, text: &str) {
        self.types.push(notice_type);
        self.texts.push(text);
    }

    /// Sets the number of repeated losses after the notices of the simulated day. Notices of later tool calls follow.
    pub fn set_repeats(&mut self, repeats: u32) {
        (self.before_repeats, self.repeats) = (self.types.len() as u32, repeats);
    }

    /// Returns the notice at a position of the day, counted from 0.
    pub fn notice_at(&self, place: u64) -> NoticeSlot {
        let (before, repeats) = (u64::from(self.before_repeats), u64::from(self.repeats));
        match place {
            place if place < before => NoticeSlot::Stored(place as usize),
            place if place < before + repeats => NoticeSlot::Repeated((place - before) as usize),
            place => NoticeSlot::Stored((place - repeats) as usize),
        }
    }

    /// Returns the type of a notice that is stored with the day.
    pub fn type_at(&self, at: usize) -> u8 {
        self.types[at]
    }

    /// Returns the text of a notice that is stored with the day.
    pub fn text_at(&self, at: usize) -> String {
        self.texts.get(at)
    }

    /// Returns the bytes that are stored in the database file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        for number in [self.first, self.repeats.into(), self.before_repeats.into(), self.types.len() as u64] {
            packer.push_number(number);
        }
        packer.push_bytes(&self.types);
        self.texts.pack(&mut packer);
        packer.finish()
    }

    /// Parses the stored bytes of a day. Returns `None` if the bytes are invalid.
    pub fn from_bytes(day: u32, bytes: &[u8]) -> Option<NoticeDay> {
        let mut unpacker = Unpacker::new(bytes);
        let first = unpacker.read_number()?;
        let (repeats, before) = (unpacker.read_u32()?, unpacker.read_u32()?);
        let count = unpacker.read_u32()?;
        let types = unpacker.read_bytes(count as usize)?.to_vec();
        let texts = PatternTexts::unpack(&mut unpacker, count)?;
        let sound = types.iter().all(|number| usize::from(*number) < NOTICE_TYPES.len()) && before <= count;
        (sound && unpacker.is_empty()).then_some(NoticeDay {
            day,
            first,
            repeats,
            before_repeats: before,
            types,
            texts,
        })
    }
}

impl PackedRows for NoticeDay {
    fn day(&self) -> u32 {
        self.day
    }

    fn first(&self) -> u64 {
        self.first
    }

    fn len(&self) -> u64 {
        self.types.len() as u64 + u64::from(self.repeats)
    }

    fn next_of_kinds(&self, kinds: KindSet, mut place: u64) -> Option<u64> {
        while place < self.len() {
            match self.notice_at(place) {
                NoticeSlot::Repeated(_) if kinds & (1 << LEAD_LOST_INDEX) != 0 => return Some(place),
                NoticeSlot::Repeated(_) => place = u64::from(self.before_repeats) + u64::from(self.repeats),
                NoticeSlot::Stored(at) if kinds & (1 << self.types[at]) != 0 => return Some(place),
                NoticeSlot::Stored(_) => place += 1,
            }
        }
        None
    }
}

/// A notice of a day, stored with the day or repeated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoticeSlot {
    /// Index of a notice that is stored with the day.
    Stored(usize),
    /// Index of a repeated loss in the run's list.
    Repeated(usize),
}

/// Texts of a day, each stored as a pattern and the numbers that fill the pattern.
#[derive(Debug, Clone, PartialEq, Default)]
struct PatternTexts {
    /// Distinct texts in which each number is replaced by [`NUMBER_PLACEHOLDER`].
    patterns: Vec<String>,
    /// Offset of each text in `packed`.
    starts: Vec<u32>,
    /// Pattern index and numbers of each text, packed.
    packed: Vec<u8>,
}

/// Placeholder for a number in a pattern. No text contains this character.
const NUMBER_PLACEHOLDER: char = '\u{0}';
/// Maximum number of digits in a number. With the leading 1, the number fits into 64 bits.
const MAX_DIGITS: usize = 18;

impl PatternTexts {
    fn push(&mut self, text: &str) {
        let (pattern, numbers) = split_numbers(text);
        let known = self.patterns.iter().position(|known_pattern| *known_pattern == pattern);
        let at = known.unwrap_or_else(|| {
            self.patterns.push(pattern);
            self.patterns.len() - 1
        });
        self.starts.push(self.packed.len() as u32);
        let mut packer = Packer::default();
        packer.push_number(at as u64);
        numbers.into_iter().for_each(|number| packer.push_number(number));
        self.packed.extend(packer.finish());
    }

    fn get(&self, at: usize) -> String {
        let mut unpacker = Unpacker::new(&self.packed[self.starts[at] as usize..]);
        let pattern = unpacker.read_u32().and_then(|at| self.patterns.get(at as usize));
        let mut text = String::new();
        for letter in pattern.map_or("", String::as_str).chars() {
            match letter {
                // Omit the first digit, a 1 that preserves leading zeros.
                NUMBER_PLACEHOLDER => text.push_str(&unpacker.read_number().unwrap_or(1).to_string()[1..]),
                letter => text.push(letter),
            }
        }
        text
    }

    fn pack(&self, packer: &mut Packer) {
        packer.push_number(self.patterns.len() as u64);
        for pattern in &self.patterns {
            packer.push_number(pattern.len() as u64);
            packer.push_bytes(pattern.as_bytes());
        }
        packer.push_bytes(&self.packed);
    }

    fn unpack(unpacker: &mut Unpacker<'_>, count: u32) -> Option<PatternTexts> {
        let mut patterns = Vec::new();
        for _ in 0..unpacker.read_number()? {
            let length = unpacker.read_u32()?;
            patterns.push(std::str::from_utf8(unpacker.read_bytes(length as usize)?).ok()?.to_owned());
        }
        let numbers: Vec<usize> =
            patterns.iter().map(|pattern| pattern.matches(NUMBER_PLACEHOLDER).count()).collect();
        let (rest, mut begins) = (unpacker.remaining(), Vec::new());
        for _ in 0..count {
            begins.push((rest.len() - unpacker.remaining().len()) as u32);
            for _ in 0..*numbers.get(unpacker.read_u32()? as usize)? {
                (unpacker.read_number()? > 0).then_some(())?;
            }
        }
        let packed = rest[..rest.len() - unpacker.remaining().len()].to_vec();
        Some(PatternTexts { patterns, starts: begins, packed })
    }
}

/// Splits a text into a pattern and numbers. A 1 is prefixed to the digits of each number.
fn split_numbers(text: &str) -> (String, Vec<u64>) {
    let (mut pattern, mut numbers, mut rest) = (String::new(), Vec::new(), text);
    while let Some(letter) = rest.chars().next() {
        let digits = rest.bytes().take(MAX_DIGITS).take_while(u8::is_ascii_digit).count();
        match digits {
            0 => {
                pattern.extend(Some(letter).filter(|letter| *letter != NUMBER_PLACEHOLDER));
                rest = &rest[letter.len_utf8()..];
            }
            digits => {
                let value = rest[..digits].bytes().fold(1, |all, digit| all * 10 + u64::from(digit - b'0'));
                numbers.push(value);
                pattern.push(NUMBER_PLACEHOLDER);
                rest = &rest[digits..];
            }
        }
    }
    (pattern, numbers)
}

/// The inbox of a run: the notices of each day, and the losses that days repeat.
#[derive(Debug, Clone, Default)]
pub(super) struct Inbox {
    /// Days with notices, in order.
    pub days: Arc<Vec<Arc<NoticeDay>>>,
    /// Repeated losses, in the order of the first report.
    pub losses: Arc<Vec<RepeatedLoss>>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn notice_texts_round_trip(texts in proptest::collection::vec("[a-zé $.,0-9]{0,40}", 0..20), repeats in 0u32..9) {
            let mut day = NoticeDay::new(7, 40);
            texts.iter().for_each(|text| day.push(2, text));
            day.set_repeats(repeats);
            day.push(LEAD_LOST_INDEX, "007 of 99999999999999999999");
            let read = NoticeDay::from_bytes(7, &day.to_bytes());
            prop_assert_eq!(read.as_ref(), Some(&day));
            for (at, text) in texts.iter().enumerate() {
                prop_assert_eq!(&day.text_at(at), text);
            }
            prop_assert_eq!(day.text_at(texts.len()), "007 of 99999999999999999999");
            prop_assert_eq!(day.len(), texts.len() as u64 + u64::from(repeats) + 1);
        }

        #[test]
        fn damaged_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            if let Some(day) = NoticeDay::from_bytes(1, &bytes) {
                (0..day.types.len()).for_each(|at| drop(day.text_at(at)));
            }
        }
    }

    #[test]
    fn notice_types_are_sorted() {
        assert!(NOTICE_TYPES.is_sorted());
        assert_eq!(NOTICE_TYPES[usize::from(LEAD_LOST_INDEX)], Notice::LeadSilent.kind());
        assert_eq!(type_index(&Notice::EnterpriseLead), 2);
    }

    #[test]
    fn repeated_losses_follow_day_notices_and_precede_call_notices() {
        let mut day = NoticeDay::new(9, 1);
        day.push(2, "a");
        day.push(LEAD_LOST_INDEX, "b");
        day.set_repeats(2);
        day.push(5, "c");
        let places: Vec<NoticeSlot> = (0..day.len()).map(|place| day.notice_at(place)).collect();
        assert_eq!(
            places,
            [
                NoticeSlot::Stored(0),
                NoticeSlot::Stored(1),
                NoticeSlot::Repeated(0),
                NoticeSlot::Repeated(1),
                NoticeSlot::Stored(2)
            ]
        );
        let of_type = |number: u8| {
            let next = |place: &u64| day.next_of_kinds(1 << number, place + 1);
            std::iter::successors(day.next_of_kinds(1 << number, 0), next).collect::<Vec<_>>()
        };
        assert_eq!(
            (of_type(2), of_type(LEAD_LOST_INDEX), of_type(5), of_type(0)),
            (vec![0], vec![1, 2, 3], vec![4], vec![])
        );
    }
}
