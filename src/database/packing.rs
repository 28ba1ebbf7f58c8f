//! Packed days: variable-length numbers, runs of ascending customers, and rows at places with kinds.

/// Maximum rows of a run, because reading one row unpacks all of them.
pub(super) const LONGEST_RUN: usize = 1024;

/// A run of a table: rows with ascending customer numbers.
pub(super) trait Run: Sized {
    /// The columns of a row besides day and customer.
    type Row: Copy + Default + Send + Sync;

    fn customers(&self) -> &[u32];
    fn row(&self, at: usize) -> Self::Row;
    fn pack(&self, packer: &mut Packer);
    /// Parses a run. Returns `None` if the bytes are invalid.
    fn unpack(unpacker: &mut Unpacker<'_>) -> Option<Self>;
}

/// A packed day of a table, as in the file: unpacked rows would take a multiple of the memory.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PackedDay {
    pub day: u32,
    bytes: Vec<u8>,
    runs: Vec<RunPlace>,
}

/// Position of a run in the bytes of its day, and its range of customers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RunPlace {
    begin: usize,
    /// Rows of the day before it.
    rows_before: usize,
    rows: usize,
    first_customer: u32,
    last_customer: u32,
}

impl RunPlace {
    /// Returns the place of a run that starts at a byte, after earlier runs.
    fn after(before: &[RunPlace], run: &impl Run, begin: usize) -> RunPlace {
        let customers = run.customers();
        RunPlace {
            begin,
            rows_before: before.last().map_or(0, |last| last.rows_before + last.rows),
            rows: customers.len(),
            first_customer: customers.first().copied().unwrap_or(u32::MAX),
            last_customer: customers.last().copied().unwrap_or(0),
        }
    }
}

impl PackedDay {
    pub fn pack<R: Run>(day: u32, rows: &[R]) -> PackedDay {
        let mut packer = Packer::default();
        packer.number(rows.len() as u64);
        let mut runs = Vec::with_capacity(rows.len());
        for run in rows {
            runs.push(RunPlace::after(&runs, run, packer.0.len()));
            run.pack(&mut packer);
        }
        packer.0.shrink_to_fit();
        PackedDay { day, bytes: packer.0, runs }
    }

    /// Parses the bytes of a day. Returns `None` if they are invalid.
    pub fn read<R: Run>(day: u32, bytes: Vec<u8>) -> Option<PackedDay> {
        let mut unpacker = Unpacker(&bytes);
        let mut runs = Vec::new();
        for _ in 0..unpacker.number()? {
            let begin = bytes.len() - unpacker.0.len();
            runs.push(RunPlace::after(&runs, &R::unpack(&mut unpacker)?, begin));
        }
        unpacker.0.is_empty().then_some(PackedDay { day, bytes, runs })
    }

    /// Returns the bytes in the file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the number of runs.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.runs.last().map_or(0, |last| last.rows_before + last.rows)
    }

    /// Returns the number of a row: day and position in the day.
    pub fn row_number(&self, run: usize, at: usize) -> i64 {
        let before = self.runs.get(run).map_or(0, |place| place.rows_before);
        i64::from(self.day) << 32 | (before + at + 1) as i64
    }

    /// Returns first and last customer of a run; the first is greater if it is empty.
    pub fn customers(&self, run: usize) -> (u32, u32) {
        let place = &self.runs[run];
        (place.first_customer, place.last_customer)
    }

    /// Returns whether a run may have a customer.
    pub fn may_hold(&self, run: usize, customer: f64) -> bool {
        let (first, last) = self.customers(run);
        (f64::from(first)..=f64::from(last)).contains(&customer)
    }

    /// Unpacks a run.
    pub fn open<R: Run>(&self, run: usize) -> Option<R> {
        let place = self.runs.get(run)?;
        R::unpack(&mut Unpacker(&self.bytes[place.begin..]))
    }
}

/// A set of kinds as bits.
pub(super) type Kinds = u32;

/// A packed day with rows at places from 0, each of a kind.
pub(super) trait PackedRows {
    fn day(&self) -> u32;
    /// Returns the number of the first row.
    fn first(&self) -> u64;
    /// Returns the number of rows.
    fn len(&self) -> u64;
    /// Returns the first place from `place` on with one of the kinds.
    fn next_among(&self, kinds: Kinds, place: u64) -> Option<u64>;
}

/// Writes variable-length numbers.
#[derive(Default)]
pub(super) struct Packer(Vec<u8>);

impl Packer {
    pub fn number(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// Returns the bytes.
    pub fn finish(self) -> Vec<u8> {
        self.0
    }

    pub fn float(&mut self, value: f64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    /// Writes ascending numbers as differences.
    pub fn ascending(&mut self, values: &[u32]) {
        self.number(values.len() as u64);
        let mut before = 0;
        for &value in values {
            self.number(u64::from(value - before));
            before = value;
        }
    }
}

/// Reads the output of a [`Packer`].
pub(super) struct Unpacker<'a>(&'a [u8]);

impl<'a> Unpacker<'a> {
    pub fn of(bytes: &'a [u8]) -> Unpacker<'a> {
        Unpacker(bytes)
    }

    /// Returns the remaining bytes.
    pub fn rest(&self) -> &'a [u8] {
        self.0
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (bytes, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(bytes)
    }

    pub fn number(&mut self) -> Option<u64> {
        let (mut value, mut shift) = (0u64, 0u32);
        loop {
            let (&byte, rest) = self.0.split_first()?;
            self.0 = rest;
            value |= u64::from(byte & 0x7f).checked_shl(shift)?;
            if byte < 0x80 {
                return Some(value);
            }
            shift += 7;
        }
    }

    pub fn small(&mut self) -> Option<u32> {
        u32::try_from(self.number()?).ok()
    }

    pub fn float(&mut self) -> Option<f64> {
        let (bytes, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(f64::from_le_bytes(*bytes))
    }

    pub fn ascending(&mut self) -> Option<Vec<u32>> {
        let mut before = 0u32;
        (0..self.number()?)
            .map(|_| {
                before = before.checked_add(self.small()?)?;
                Some(before)
            })
            .collect()
    }
}
