//! Reads stored, deflated and Zstandard-compressed files from a zip archive, such as Inspect's `.eval` logs.

use std::io::Read;

use flate2::Crc;
use flate2::read::DeflateDecoder;
use ruzstd::decoding::StreamingDecoder;

const END_SIGNATURE: &[u8] = b"PK\x05\x06";
const END_64_SIGNATURE: &[u8] = b"PK\x06\x06";
const LOCATOR_64_SIGNATURE: &[u8] = b"PK\x06\x07";
const ENTRY_SIGNATURE: &[u8] = b"PK\x01\x02";
const FILE_SIGNATURE: &[u8] = b"PK\x03\x04";
/// Size of the end record without the comment, in bytes.
const END_RECORD_BYTES: usize = 22;
/// Size of the record that locates the 64-bit end record, in bytes.
const LOCATOR_BYTES: usize = 20;

/// A zip archive in memory.
pub(super) struct ZipArchive<'a> {
    bytes: &'a [u8],
    entries: Vec<Entry>,
}

/// A directory entry that describes a file in the archive.
struct Entry {
    name: String,
    method: u16,
    checksum: u32,
    compressed: u64,
    offset: u64,
}

impl<'a> ZipArchive<'a> {
    /// Returns whether the bytes begin with the signature of a zip archive.
    pub fn is_zip(bytes: &[u8]) -> bool {
        bytes.starts_with(FILE_SIGNATURE) || bytes.starts_with(END_SIGNATURE)
    }

    /// Reads the directory of an archive. Returns `None` if the directory is missing or damaged.
    pub fn open(bytes: &'a [u8]) -> Option<ZipArchive<'a>> {
        let end = end_record(bytes)?;
        let (mut count, mut at) = (u64::from(u16_at(bytes, end + 10)?), u64::from(u32_at(bytes, end + 16)?));
        if let Some(locator) =
            end.checked_sub(LOCATOR_BYTES).filter(|at| starts_with(bytes, *at, LOCATOR_64_SIGNATURE))
        {
            let end = to_usize(u64_at(bytes, locator + 8)?)?;
            if !starts_with(bytes, end, END_64_SIGNATURE) {
                return None;
            }
            (count, at) = (u64_at(bytes, end + 32)?, u64_at(bytes, end + 48)?);
        }
        let mut at = to_usize(at)?;
        let mut entries = Vec::new();
        for _ in 0..count {
            let (entry, next) = Entry::read(bytes, at)?;
            entries.push(entry);
            at = next;
        }
        Some(ZipArchive { bytes, entries })
    }

    /// Returns the file names in the order of the archive's directory.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|entry| entry.name.as_str())
    }

    /// Reads a file of at most `limit` bytes. If the name occurs several times, the last file is read.
    ///
    /// # Errors
    /// The file is missing, damaged, too large, or compressed by an unsupported method.
    pub fn read(&self, name: &str, limit: u64) -> Result<Vec<u8>, String> {
        let damaged = || format!("{name} in the archive is damaged");
        let entry = self.entries.iter().rfind(|entry| entry.name == name);
        let entry = entry.ok_or_else(|| format!("the archive has no {name}"))?;
        let data = self.data(entry).ok_or_else(damaged)?;
        let mut read = Vec::new();
        let mut decoder: Box<dyn Read> = match entry.method {
            0 => Box::new(data),
            8 => Box::new(DeflateDecoder::new(data)),
            93 => Box::new(Frames::new(data)),
            other => {
                return Err(format!(
                    "{name} in the archive is compressed by method {other}, which is not supported"
                ));
            }
        };
        decoder.by_ref().take(limit + 1).read_to_end(&mut read).map_err(|_| damaged())?;
        if read.len() as u64 > limit {
            return Err(format!("{name} in the archive has more than {limit} bytes"));
        }
        let mut checksum = Crc::new();
        checksum.update(&read);
        if checksum.sum() == entry.checksum { Ok(read) } else { Err(damaged()) }
    }

    fn data(&self, entry: &Entry) -> Option<&'a [u8]> {
        let at = to_usize(entry.offset)?;
        if !starts_with(self.bytes, at, FILE_SIGNATURE) {
            return None;
        }
        let begin =
            at + 30 + usize::from(u16_at(self.bytes, at + 26)?) + usize::from(u16_at(self.bytes, at + 28)?);
        self.bytes.get(begin..begin.checked_add(to_usize(entry.compressed)?)?)
    }
}

impl Entry {
    /// Reads an entry of the directory. Returns the entry, and the offset at which the next entry starts.
    fn read(bytes: &[u8], at: usize) -> Option<(Entry, usize)> {
        if !starts_with(bytes, at, ENTRY_SIGNATURE) {
            return None;
        }
        let length = |field: usize| u16_at(bytes, at + field).map(usize::from);
        let names = at + 46;
        let extras = names + length(28)?;
        let end = extras + length(30)?;
        let name = bytes.get(names..extras)?;
        // Sizes and offsets that are too large for their 32-bit fields are stored in the 64-bit extra field, in this
        // order.
        let mut large = extra_64(bytes.get(extras..end)?).chunks_exact(8);
        let mut field = |field: usize| -> Option<u64> {
            match u32_at(bytes, at + field)? {
                u32::MAX => large.next()?.try_into().map(u64::from_le_bytes).ok(),
                small => Some(small.into()),
            }
        };
        let (_size, compressed, offset) = (field(24)?, field(20)?, field(42)?);
        let entry = Entry {
            name: String::from_utf8_lossy(name).into_owned(),
            method: u16_at(bytes, at + 10)?,
            checksum: u32_at(bytes, at + 16)?,
            compressed,
            offset,
        };
        Some((entry, end + length(32)?))
    }
}

/// A reader that decompresses consecutive Zstandard frames.
struct Frames<'a> {
    rest: &'a [u8],
    current: Option<StreamingDecoder<&'a [u8], ruzstd::decoding::FrameDecoder>>,
}

impl<'a> Frames<'a> {
    fn new(data: &'a [u8]) -> Frames<'a> {
        Frames { rest: data, current: None }
    }
}

impl Read for Frames<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        loop {
            if let Some(decoder) = &mut self.current {
                let count = decoder.read(buffer)?;
                if count > 0 || buffer.is_empty() {
                    return Ok(count);
                }
                self.rest = decoder.get_ref();
                self.current = None;
            }
            if self.rest.is_empty() {
                return Ok(0);
            }
            self.current = Some(StreamingDecoder::new(self.rest).map_err(std::io::Error::other)?);
        }
    }
}

/// Returns the offset of the end record. It is followed by a comment, whose length it stores.
fn end_record(bytes: &[u8]) -> Option<usize> {
    let last = bytes.len().checked_sub(END_RECORD_BYTES)?;
    let first = last.saturating_sub(usize::from(u16::MAX));
    let is_end = |at: &usize| {
        let comment = u16_at(bytes, at + 20).map(usize::from);
        starts_with(bytes, *at, END_SIGNATURE) && comment == Some(bytes.len() - END_RECORD_BYTES - at)
    };
    (first..=last).rev().find(is_end)
}

/// Returns the data of the 64-bit extra field.
fn extra_64(mut extras: &[u8]) -> &[u8] {
    while let (Some(kind), Some(length)) = (u16_at(extras, 0), u16_at(extras, 2)) {
        let Some((data, rest)) = extras[4..].split_at_checked(length.into()) else { break };
        if kind == 1 {
            return data;
        }
        extras = rest;
    }
    &[]
}

fn starts_with(bytes: &[u8], at: usize, signature: &[u8]) -> bool {
    bytes.get(at..).is_some_and(|rest| rest.starts_with(signature))
}

fn to_usize(number: u64) -> Option<usize> {
    usize::try_from(number).ok().filter(|at| *at <= isize::MAX as usize)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..at.checked_add(2)?)?.try_into().map(u16::from_le_bytes).ok()
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at.checked_add(4)?)?.try_into().map(u32::from_le_bytes).ok()
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..at.checked_add(8)?)?.try_into().map(u64::from_le_bytes).ok()
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::DeflateEncoder;

    use super::*;

    const TEXT: &[u8] = b"the same text, the same text, the same text";

    fn deflated(text: &[u8]) -> Vec<u8> {
        let mut encoder = DeflateEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(text).expect("written");
        encoder.finish().expect("written")
    }

    /// Creates an archive of files with these names, compression methods and contents.
    fn archive(files: &[(&str, u16, &[u8])]) -> Vec<u8> {
        let (mut bytes, mut directory) = (Vec::new(), Vec::new());
        for (name, method, content) in files {
            let data = if *method == 8 { deflated(content) } else { content.to_vec() };
            let mut checksum = Crc::new();
            checksum.update(content);
            let mut common = vec![20, 0, 0, 0];
            common.extend(method.to_le_bytes());
            common.extend([0; 4]);
            for number in [checksum.sum(), data.len() as u32, content.len() as u32] {
                common.extend(number.to_le_bytes());
            }
            common.extend((name.len() as u16).to_le_bytes());
            common.extend([0; 2]);
            directory.extend([ENTRY_SIGNATURE, &[20, 0], &common[..], &[0; 10]].concat());
            directory.extend((bytes.len() as u32).to_le_bytes());
            directory.extend(name.as_bytes());
            bytes.extend([FILE_SIGNATURE, &common[..], name.as_bytes(), &data[..]].concat());
        }
        let at = bytes.len() as u32;
        bytes.extend(&directory);
        bytes.extend([END_SIGNATURE, &[0; 4]].concat());
        bytes.extend((files.len() as u16).to_le_bytes().repeat(2));
        bytes.extend((directory.len() as u32).to_le_bytes());
        bytes.extend(at.to_le_bytes());
        bytes.extend([0; 2]);
        bytes
    }

    #[test]
    fn files_are_read_with_every_compression_method() {
        let bytes = archive(&[
            ("stored", 0, TEXT),
            ("deflated", 8, TEXT),
            ("other", 12, TEXT),
            ("stored", 0, b"later"),
        ]);
        assert!(ZipArchive::is_zip(&bytes));
        let archive = ZipArchive::open(&bytes).expect("an archive");
        assert_eq!(archive.names().collect::<Vec<_>>(), ["stored", "deflated", "other", "stored"]);
        assert_eq!(archive.read("deflated", 1000).as_deref(), Ok(TEXT));
        assert_eq!(archive.read("stored", 1000).as_deref(), Ok(&b"later"[..]));
        for (name, limit, words) in [
            ("deflated", 10, "more than 10 bytes"),
            ("other", 1000, "method 12"),
            ("nothing", 1000, "has no nothing"),
        ] {
            let problem = archive.read(name, limit).expect_err(words);
            assert!(problem.contains(words), "{problem}");
        }
    }

    #[test]
    fn damaged_archives_are_rejected_or_read_correctly() {
        let bytes = archive(&[("stored", 0, TEXT), ("deflated", 8, TEXT)]);
        let read = |bytes: &[u8]| {
            let archive = ZipArchive::open(bytes)?;
            ["stored", "deflated"].map(|name| archive.read(name, 1000).ok()).into_iter().flatten().next_back()
        };
        for end in 0..bytes.len() {
            assert_eq!(ZipArchive::open(&bytes[..end]).map(|_| ()), None, "{end}");
        }
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1 << bit;
                assert!(read(&damaged).is_none_or(|text| text == TEXT), "{at}");
            }
        }
    }
}
