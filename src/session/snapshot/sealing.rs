//! Sealing of snapshots: the state of a run is encrypted and authenticated, so that neither `strings` nor a parser can
//! read hidden state (docs/formats/snapshot.md#sealing).
//!
//! Keys are derived from the first line of the trajectory and, in a study, from a secret of the experimenter. The
//! nonce is a keyed hash of the plain bytes, so that no two states of a run have the same key stream. The tag is a
//! keyed hash of nonce and sealed bytes.

use std::fmt;

/// Context string that separates the keys of snapshots from other keys that BLAKE3 derives.
const KEY_CONTEXT: &str = "novamind 2026-11 sealed state of a run";
const CHUNK_BYTES: usize = 1 << 12;
/// Size of a nonce, a tag or a key, in bytes.
const KEY_BYTES: usize = 32;

/// The secret part of the keys that seal snapshots.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct SealKey {
    study_secret: Option<[u8; KEY_BYTES]>,
}

impl SealKey {
    /// Creates a seal key from the secret of a study. Snapshots can then be unsealed only with this secret.
    pub fn with_study_secret(secret: &[u8; KEY_BYTES]) -> SealKey {
        SealKey { study_secret: Some(*secret) }
    }

    pub(super) fn has_secret(&self) -> bool {
        self.study_secret.is_some()
    }

    /// Derives the keys of a run from the hash of the first line of its trajectory.
    pub(super) fn derive_run_keys(&self, first_line: &str) -> RunKeys {
        let mut hasher = blake3::Hasher::new_derive_key(KEY_CONTEXT);
        hasher.update(first_line.as_bytes());
        if let Some(secret) = &self.study_secret {
            hasher.update(secret);
        }
        let mut keys = [0; 3 * KEY_BYTES];
        hasher.finalize_xof().fill(&mut keys);
        let key = |at: usize| std::array::from_fn(|byte| keys[at * KEY_BYTES + byte]);
        RunKeys { nonce: key(0), stream: key(1), tag: key(2) }
    }
}

impl fmt::Debug for SealKey {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(if self.study_secret.is_some() { "SealKey(of a study)" } else { "SealKey(of the run)" })
    }
}

pub(super) struct RunKeys {
    nonce: [u8; KEY_BYTES],
    stream: [u8; KEY_BYTES],
    tag: [u8; KEY_BYTES],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Envelope {
    nonce: [u8; KEY_BYTES],
    tag: [u8; KEY_BYTES],
}

impl Envelope {
    pub(super) const LENGTH_BYTES: usize = 2 * KEY_BYTES;

    pub(super) fn to_bytes(self) -> [u8; Envelope::LENGTH_BYTES] {
        std::array::from_fn(|at| if at < KEY_BYTES { self.nonce[at] } else { self.tag[at - KEY_BYTES] })
    }

    pub(super) fn from_bytes(bytes: &[u8; Envelope::LENGTH_BYTES]) -> Envelope {
        let part = |from: usize| std::array::from_fn(|at| bytes[from + at]);
        Envelope { nonce: part(0), tag: part(KEY_BYTES) }
    }
}

impl RunKeys {
    /// Encrypts header and state in place and returns the nonce and the tag.
    pub(super) fn seal(&self, header: &mut [u8], state: &mut [u8]) -> Envelope {
        let mut hasher = blake3::Hasher::new_keyed(&self.nonce);
        let nonce = *hasher.update(header).update(state).finalize().as_bytes();
        self.apply_key_stream(&nonce, 0, header);
        self.apply_key_stream(&nonce, header.len(), state);
        Envelope { nonce, tag: *self.compute_tag(&nonce, &[header, state]).as_bytes() }
    }

    /// Decrypts the bytes in place and returns true if the tag is valid. Otherwise, leaves the bytes unchanged and
    /// returns false.
    pub(super) fn open(&self, envelope: &Envelope, sealed: &mut [u8]) -> bool {
        // Hashes are compared in constant time.
        let genuine = self.compute_tag(&envelope.nonce, &[sealed]) == blake3::Hash::from_bytes(envelope.tag);
        if genuine {
            self.apply_key_stream(&envelope.nonce, 0, sealed);
        }
        genuine
    }

    fn compute_tag(&self, nonce: &[u8; KEY_BYTES], pieces: &[&[u8]]) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new_keyed(&self.tag);
        hasher.update(nonce);
        for piece in pieces {
            hasher.update(piece);
        }
        hasher.finalize()
    }

    /// Encrypts or decrypts bytes by XOR with the key stream of a nonce, starting at offset `from`. Uses only this
    /// thread, because the database writer calls this function while a simulation on all other threads may wait for the
    /// writer.
    fn apply_key_stream(&self, nonce: &[u8; KEY_BYTES], from: usize, bytes: &mut [u8]) {
        let mut stream = blake3::Hasher::new_keyed(&self.stream).update(nonce).finalize_xof();
        stream.set_position(from as u64);
        let mut keys = [0; CHUNK_BYTES];
        for piece in bytes.chunks_mut(CHUNK_BYTES) {
            let keys = &mut keys[..piece.len()];
            stream.fill(keys);
            piece.iter_mut().zip(keys).for_each(|(byte, key)| *byte ^= *key);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = "7c1f0d0a2b4e6f8091a3b5c7d9ebfd0f2143658799abbccddeef00112233445566";

    fn plain_state() -> (Vec<u8>, Vec<u8>) {
        let state = (0..30 * CHUNK_BYTES + 777).map(|at| (at % 251) as u8).collect();
        (b"header".to_vec(), state)
    }

    #[test]
    fn sealed_state_opens_only_with_the_same_keys() {
        let (mut header, mut state) = plain_state();
        let whole = [header.clone(), state.clone()].concat();
        let keys = SealKey::default().derive_run_keys(LINE);
        let envelope = keys.seal(&mut header, &mut state);
        let sealed = [header, state].concat();
        assert_eq!(Envelope::from_bytes(&envelope.to_bytes()), envelope);
        let opened = |keys: &RunKeys, envelope: &Envelope, sealed: &[u8]| {
            let mut bytes = sealed.to_vec();
            let genuine = keys.open(envelope, &mut bytes);
            assert!(genuine || bytes == sealed, "invalid bytes stay sealed");
            genuine.then_some(bytes)
        };
        assert_eq!(opened(&keys, &envelope, &sealed).as_deref(), Some(whole.as_slice()));
        let study = SealKey::with_study_secret(&[7; 32]);
        for other in [SealKey::default().derive_run_keys("another line"), study.derive_run_keys(LINE)] {
            assert_eq!(opened(&other, &envelope, &sealed), None);
        }
        for at in [0, 5, 6, sealed.len() / 2, sealed.len() - 1] {
            let mut changed = sealed.clone();
            changed[at] ^= 1;
            assert_eq!(opened(&keys, &envelope, &changed), None, "byte {at}");
        }
        for at in 0..Envelope::LENGTH_BYTES {
            let mut changed = envelope.to_bytes();
            changed[at] ^= 1;
            assert_eq!(
                opened(&keys, &Envelope::from_bytes(&changed), &sealed),
                None,
                "byte {at} of the envelope"
            );
        }
        assert_eq!(opened(&keys, &envelope, &sealed[..sealed.len() - 1]), None);
    }

    #[test]
    fn sealed_bytes_contain_no_repeated_block() {
        let keys = SealKey::default().derive_run_keys(LINE);
        let seal = |first: u8| {
            let (mut header, mut state) = (vec![first], vec![0; 20 * CHUNK_BYTES]);
            let envelope = keys.seal(&mut header, &mut state);
            (envelope, state)
        };
        let (one, two) = (seal(1), seal(2));
        assert_ne!(one.0.nonce, two.0.nonce);
        // Sealed zeros equal the key stream, which must not repeat a block.
        let mut blocks: Vec<&[u8]> =
            [&one.1, &two.1].into_iter().flat_map(|bytes| bytes.chunks(32)).collect();
        let count = blocks.len();
        blocks.sort_unstable();
        blocks.dedup();
        assert_eq!(blocks.len(), count);
        assert_eq!(seal(1), one, "equal states result in equal files");
        assert_eq!(
            format!("{:?}", SealKey::with_study_secret(&[9; 32])),
            "SealKey(of a study)",
            "a secret is not printed"
        );
    }
}
