//! The packed format of a day's rows: variable-length numbers, and runs of rows with ascending customers.

/// Maximum number of rows in a run. The number is limited because reading one row unpacks the whole run.
pub(super) const MAX_RUN_ROWS: usize = 1024;

/// A run of a table: rows with ascending customer numbers.
pub(super) trait RowRun: Sized {
    /// The columns of a row except day and customer.
    type Row: Copy + Default + Send + Sync;

    fn customers(&self) -> &[u32];
    fn row(&self, at: usize) -> Self::Row;
    fn pack(&self, packer: &mut Packer);
    /// Parses the bytes of a run. Returns `None` if the bytes are invalid.
    fn unpack(unpacker: &mut Unpacker<'_>) -> Option<Self>;
}

/// The rows of a table for one day, packed as in the database file. Unpacked rows would need several times the memory.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PackedDay {
    pub day: u32,
    bytes: Vec<u8>,
    runs: Vec<RunLocation>,
}

/// Position of a run in the bytes of its day, and its range of customers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RunLocation {
    begin: usize,
    /// Number of rows in earlier runs of the day.
    rows_before: usize,
    rows: usize,
    first_customer: u32,
    last_customer: u32,
}

impl RunLocation {
    /// Returns the location of a run that follows earlier runs and starts at this byte.
    fn after(before: &[RunLocation], run: &impl RowRun, begin: usize) -> RunLocation {
        let customers = run.customers();
        RunLocation {
            begin,
            rows_before: before.last().map_or(0, |last| last.rows_before + last.rows),
            rows: customers.len(),
            first_customer: customers.first().copied().unwrap_or(u32::MAX),
            last_customer: customers.last().copied().unwrap_or(0),
        }
    }
}

impl PackedDay {
    pub fn pack<R: RowRun>(day: u32, rows: &[R]) -> PackedDay {
        let mut packer = Packer::default();
        packer.push_number(rows.len() as u64);
        let mut runs = Vec::with_capacity(rows.len());
        for run in rows {
            runs.push(RunLocation::after(&runs, run, packer.0.len()));
            run.pack(&mut packer);
        }
        packer.0.shrink_to_fit();
        PackedDay { day, bytes: packer.0, runs }
    }

    /// Parses the stored bytes of a day. Returns `None` if the bytes are invalid.
    pub fn from_bytes<R: RowRun>(day: u32, bytes: Vec<u8>) -> Option<PackedDay> {
        let mut unpacker = Unpacker(&bytes);
        let mut runs = Vec::new();
        for _ in 0..unpacker.read_number()? {
            let begin = bytes.len() - unpacker.0.len();
            runs.push(RunLocation::after(&runs, &R::unpack(&mut unpacker)?, begin));
        }
        unpacker.0.is_empty().then_some(PackedDay { day, bytes, runs })
    }

    /// Returns the bytes that are stored in the database file.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Returns the number of runs in the day.
    pub fn run_count(&self) -> usize {
        self.runs.len()
    }

    /// Returns the number of rows in the day.
    pub fn row_count(&self) -> usize {
        self.runs.last().map_or(0, |last| last.rows_before + last.rows)
    }

    /// Returns the row number of a row, which combines the day and the position within the day.
    pub fn row_number(&self, run: usize, at: usize) -> i64 {
        let before = self.runs.get(run).map_or(0, |place| place.rows_before);
        i64::from(self.day) << 32 | (before + at + 1) as i64
    }

    /// Returns the first and last customer of a run. For an empty run, the first customer number is greater than the
    /// last.
    pub fn customer_range(&self, run: usize) -> (u32, u32) {
        let place = &self.runs[run];
        (place.first_customer, place.last_customer)
    }

    /// Returns whether a customer is within the customer range of a run.
    pub fn may_contain_customer(&self, run: usize, customer: f64) -> bool {
        let (first, last) = self.customer_range(run);
        (f64::from(first)..=f64::from(last)).contains(&customer)
    }

    /// Unpacks a run of the day. Returns `None` if its bytes are damaged.
    pub fn unpack_run<R: RowRun>(&self, run: usize) -> Option<R> {
        let place = self.runs.get(run)?;
        R::unpack(&mut Unpacker(&self.bytes[place.begin..]))
    }
}

/// A set of row kinds, one bit per kind.
pub(super) type KindSet = u32;

/// A packed day whose rows have a kind and a position, counted from 0.
pub(super) trait PackedRows {
    fn day(&self) -> u32;
    /// Returns the row number of the day's first row.
    fn first(&self) -> u64;
    /// Returns the number of rows in the day.
    fn len(&self) -> u64;
    /// Returns the position of the first row at or after `place` that has one of the kinds.
    fn next_of_kinds(&self, kinds: KindSet, place: u64) -> Option<u64>;
}

/// A writer of variable-length numbers, floats and bytes.
#[derive(Default)]
pub(super) struct Packer(Vec<u8>);

impl Packer {
    pub fn push_number(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    pub fn push_bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// Returns the packed bytes.
    pub fn finish(self) -> Vec<u8> {
        self.0
    }

    pub fn push_float(&mut self, value: f64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    /// Writes ascending numbers as differences.
    pub fn push_ascending(&mut self, values: &[u32]) {
        self.push_number(values.len() as u64);
        let mut before = 0;
        for &value in values {
            self.push_number(u64::from(value - before));
            before = value;
        }
    }
}

/// Reads the output of a [`Packer`].
pub(super) struct Unpacker<'a>(&'a [u8]);

impl<'a> Unpacker<'a> {
    pub fn new(bytes: &'a [u8]) -> Unpacker<'a> {
        Unpacker(bytes)
    }

    /// Returns the bytes that have not been read.
    pub fn remaining(&self) -> &'a [u8] {
        self.0
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn read_bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (bytes, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(bytes)
    }

    pub fn read_number(&mut self) -> Option<u64> {
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

    pub fn read_u32(&mut self) -> Option<u32> {
        u32::try_from(self.read_number()?).ok()
    }

    pub fn read_float(&mut self) -> Option<f64> {
        let (bytes, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(f64::from_le_bytes(*bytes))
    }

    pub fn read_ascending(&mut self) -> Option<Vec<u32>> {
        let mut before = 0u32;
        (0..self.read_number()?)
            .map(|_| {
                before = before.checked_add(self.read_u32()?)?;
                Some(before)
            })
            .collect()
    }
}
