//! Access control. Requests must come from programs on this machine, name this machine as their host, and include the
//! token if a token is required.
//!
//! Web pages can send requests to loopback ports, but cannot choose the `Host` header, and their requests include an
//! `Origin` header.

use std::io;
use std::path::Path;

use axum::http::HeaderMap;
use axum::http::header::{AUTHORIZATION, HOST, ORIGIN};

use crate::request::{ApiResponse, ResponseStatus};
use novamind_record::error::RunError;

/// Checks that every request must pass.
#[derive(Debug, Clone)]
pub struct RequestGuard {
    /// Token that requests must send as `Authorization: Bearer`, if a token is required.
    pub token: Option<String>,
}

impl RequestGuard {
    /// Checks the headers of a request. Returns a rejection, or `None` if the request is allowed.
    pub fn rejection_for(&self, head: &HeaderMap) -> Option<ApiResponse> {
        let text = |name| head.get(name).map(|value| value.to_str().unwrap_or("?"));
        if head.get_all(HOST).iter().count() != 1 || !text(HOST).is_some_and(is_loopback) {
            let message =
                "a request needs exactly one Host header, which must be 127.0.0.1, localhost or [::1]";
            return Some(ApiResponse::invalid_request(ResponseStatus::Forbidden, "host", message));
        }
        let origin = text(ORIGIN).map(|origin| origin.split_once("://").map_or("?", |(_, place)| place));
        if !origin.is_none_or(is_loopback) {
            let message = "requests from web pages of other sites are rejected";
            return Some(ApiResponse::invalid_request(ResponseStatus::Forbidden, "origin", message));
        }
        let expected = self.token.as_deref()?;
        if constant_time_eq(text(AUTHORIZATION).and_then(bearer_token).unwrap_or_default(), expected) {
            return None;
        }
        let message = "requests must carry the token: Authorization: Bearer TOKEN";
        Some(ApiResponse::invalid_request(ResponseStatus::Unauthorized, "token", message))
    }
}

/// Returns the token of an `Authorization` header. The case of the scheme is ignored.
fn bearer_token(header: &str) -> Option<&str> {
    let (scheme, token) = header.split_once(' ')?;
    scheme.eq_ignore_ascii_case("bearer").then(|| token.trim_start_matches(' '))
}

/// Returns whether `HOST` or `HOST:PORT` is this machine.
fn is_loopback(host: &str) -> bool {
    let name = match host.strip_prefix("[::1]") {
        Some(rest) => return rest.is_empty() || is_port(rest),
        None => host.split_once(':').map_or(host, |(name, port)| if is_digits(port) { name } else { "" }),
    };
    name == "127.0.0.1" || name.eq_ignore_ascii_case("localhost")
}

fn is_port(text: &str) -> bool {
    text.strip_prefix(':').is_some_and(is_digits)
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Compares tokens in constant time, so that the duration does not reveal a correct prefix.
fn constant_time_eq(given: &str, expected: &str) -> bool {
    blake3::hash(given.as_bytes()) == blake3::hash(expected.as_bytes())
}

/// Generates a random token of 24 bytes.
///
/// # Errors
/// The system cannot generate random numbers.
pub fn new_token() -> Result<String, RunError> {
    let mut bytes = [0u8; 24];
    getrandom::fill(&mut bytes).map_err(|error| {
        RunError::io(Path::new("the random numbers of the system"))(io::Error::other(error))
    })?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(lines: &[(axum::http::HeaderName, &str)]) -> HeaderMap {
        lines.iter().map(|(name, value)| (name.clone(), value.parse().expect("a value"))).collect()
    }

    #[test]
    fn rejection_for_allows_only_this_machine_with_the_token() {
        let open = RequestGuard { token: None };
        for host in ["127.0.0.1", "127.0.0.1:80", "localhost:1", "LOCALHOST", "[::1]:9", "[::1]"] {
            assert_eq!(open.rejection_for(&head(&[(HOST, host)])), None, "{host}");
        }
        for host in [
            "",
            "example.org",
            "127.0.0.1.example.org",
            "localhost:",
            "localhost:80x",
            "[::1]x",
            "127.0.0.1@x",
        ] {
            let barred = open.rejection_for(&head(&[(HOST, host)])).map(|answer| answer.status);
            assert_eq!(barred, Some(ResponseStatus::Forbidden), "{host}");
        }
        assert!(open.rejection_for(&HeaderMap::new()).is_some());
        let mut twice = head(&[(HOST, "127.0.0.1")]);
        twice.append(HOST, "127.0.0.1".parse().expect("a value"));
        assert!(open.rejection_for(&twice).is_some());
        let page = |origin| head(&[(HOST, "127.0.0.1"), (ORIGIN, origin)]);
        assert!(open.rejection_for(&page("http://localhost:3000")).is_none());
        for origin in ["null", "https://example.org", "http://127.0.0.1.evil.net"] {
            assert!(open.rejection_for(&page(origin)).is_some(), "{origin}");
        }
        let closed = RequestGuard { token: Some("secret".to_owned()) };
        let carrying = |value| head(&[(HOST, "127.0.0.1"), (AUTHORIZATION, value)]);
        for value in ["Bearer secret", "bearer secret", "BEARER  secret"] {
            assert!(closed.rejection_for(&carrying(value)).is_none(), "{value}");
        }
        for value in ["Bearer secre", "Bearer ", "Bearer", "secret", "basic secret", "bearer Secret"] {
            let barred = closed.rejection_for(&carrying(value)).map(|answer| answer.status);
            assert_eq!(barred, Some(ResponseStatus::Unauthorized), "{value}");
        }
    }
}
