//! Access of participants: links for browsers, and codes for ssh. The host folder contains only digests of both.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::files::{read_if_exists, write_private_atomically};
use novamind_study::CodeDigest;

/// Name of the file with the digests of tokens and codes.
const ACCESS_FILE: &str = "access.json";
/// Characters of codes, without characters that look alike.
const CODE_CHARACTERS: &[u8; 31] = b"abcdefghijkmnpqrstuvwxyz2345678";
/// Number of characters of each of the two parts of a code.
const CODE_PART_LENGTH: usize = 5;

/// The tokens and codes of the participants of a host folder. Every check reads the file, so new links are valid at once.
#[derive(Debug, Clone)]
pub struct Access {
    path: PathBuf,
}

/// Digests of the secrets of a participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
struct AccessEntry {
    /// BLAKE3 digest of the token of the link, in hexadecimal digits.
    token: String,
    /// Salted digest of the code.
    code: CodeDigest,
}

/// The link token and the code of a participant. The host cannot show them again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Credentials {
    /// Label of the participant.
    pub label: String,
    /// Token of the participant's link: 128 random bits in hexadecimal digits.
    pub token: String,
    /// Code of the participant, for ssh.
    pub code: String,
}

impl Access {
    /// Returns the access of the participants of a host folder.
    pub(crate) fn of_folder(host_folder: &Path) -> Access {
        Access { path: host_folder.join(ACCESS_FILE) }
    }

    /// Returns the label of the participant with this link token, or `None` if no participant has it.
    pub fn label_for_token(&self, token: &str) -> Option<String> {
        let digest = token_digest(token);
        let entries = self.read().ok()?;
        entries.into_iter().find(|(_, entry)| entry.token == digest).map(|(label, _)| label)
    }

    /// Returns whether the code is the code of this participant. The check takes some time, to slow down guessing.
    pub fn accepts_code(&self, label: &str, code: &str) -> bool {
        let entries = self.read().unwrap_or_default();
        match entries.get(label) {
            Some(entry) => entry.code.matches(code.trim()),
            None => {
                // The same work as for a label of the study, so that the time does not show which labels exist.
                let _ = CodeDigest::from_code(code, "none");
                false
            }
        }
    }

    /// Returns the labels that have a link and a code.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn labels(&self) -> Result<Vec<String>, RunError> {
        Ok(self.read()?.into_keys().collect())
    }

    /// Creates a token and a code for each label. They replace earlier ones, which become invalid.
    ///
    /// # Errors
    /// The system provides no random numbers, or the file cannot be read or written. Then earlier links stay valid.
    pub fn issue(&self, labels: &[String]) -> Result<Vec<Credentials>, RunError> {
        let mut entries = self.read()?;
        let mut issued = Vec::new();
        for label in labels {
            let token = random_text::<16>()?;
            let code = random_code()?;
            let salt = random_text::<8>()?;
            let entry =
                AccessEntry { token: token_digest(&token), code: CodeDigest::from_code(&code, &salt) };
            entries.insert(label.clone(), entry);
            issued.push(Credentials { label: label.clone(), token, code });
        }
        let text = serde_json::to_vec_pretty(&entries).unwrap_or_default();
        write_private_atomically(&self.path, &text)?;
        Ok(issued)
    }

    fn read(&self) -> Result<BTreeMap<String, AccessEntry>, RunError> {
        let Some(bytes) = read_if_exists(&self.path)? else { return Ok(BTreeMap::new()) };
        serde_json::from_slice(&bytes)
            .map_err(|error| RunError::InvalidRequest(format!("{}: {error}", self.path.display())))
    }
}

fn token_digest(token: &str) -> String {
    blake3::Hash::from_bytes(blake3::derive_key("novamind link token", token.as_bytes())).to_hex().to_string()
}

/// Returns a code of two parts. It has 49 random bits.
fn random_code() -> Result<String, RunError> {
    let mut code = String::new();
    while code.len() < 2 * CODE_PART_LENGTH {
        // Larger values are skipped, so that every character is equally probable.
        let drawn = random_bytes::<1>()?[0] & 31;
        code.extend(CODE_CHARACTERS.get(usize::from(drawn)).map(|character| char::from(*character)));
    }
    code.insert(CODE_PART_LENGTH, '-');
    Ok(code)
}

fn random_bytes<const COUNT: usize>() -> Result<[u8; COUNT], RunError> {
    let mut bytes = [0; COUNT];
    getrandom::fill(&mut bytes).map_err(|error| {
        RunError::InvalidRequest(format!(
            "the system provides no random numbers: {error}; nothing was written"
        ))
    })?;
    Ok(bytes)
}

/// Returns random bytes as hexadecimal digits.
///
/// # Errors
/// The system provides no random numbers.
pub(crate) fn random_text<const BYTES: usize>() -> Result<String, RunError> {
    Ok(random_bytes::<BYTES>()?.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issued_tokens_and_codes_are_accepted_and_not_stored() {
        let folder = tempfile::tempdir().expect("a folder");
        let access = Access::of_folder(folder.path());
        let issued = access.issue(&["P01".to_owned(), "P02".to_owned()]).expect("issued");
        let [one, two] = issued.as_slice() else { panic!("two participants") };
        assert_eq!(access.label_for_token(&one.token).as_deref(), Some("P01"));
        assert_eq!(access.label_for_token(&two.token).as_deref(), Some("P02"));
        assert!(access.accepts_code("P01", &one.code) && !access.accepts_code("P02", &one.code));
        assert!(!access.accepts_code("P03", &one.code) && !access.accepts_code("P01", ""));
        assert_eq!(access.label_for_token(""), None);
        let stored = std::fs::read_to_string(folder.path().join(ACCESS_FILE)).expect("a file");
        for secret in [&one.token, &one.code, &two.token, &two.code] {
            assert!(!stored.contains(secret.as_str()));
        }
        assert_eq!((one.token.len(), one.code.len()), (32, 11));
    }

    #[test]
    fn renewed_links_replace_earlier_ones() {
        let folder = tempfile::tempdir().expect("a folder");
        let access = Access::of_folder(folder.path());
        let first = access.issue(&["P01".to_owned(), "P02".to_owned()]).expect("issued");
        let second = access.issue(&["P01".to_owned()]).expect("issued");
        assert_eq!(access.label_for_token(&first[0].token), None);
        assert!(!access.accepts_code("P01", &first[0].code));
        assert_eq!(access.label_for_token(&second[0].token).as_deref(), Some("P01"));
        assert_eq!(access.label_for_token(&first[1].token).as_deref(), Some("P02"));
    }
}
