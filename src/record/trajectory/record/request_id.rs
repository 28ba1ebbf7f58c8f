//! Request ids of clients, which prevent a retried request from being executed twice.

use serde::{Deserialize, Serialize};
use serde_json::Value;

const DIGEST_DIGITS: usize = 16;

/// A request id with a digest of the request's content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RequestId {
    /// Id that the client sent.
    #[serde(rename = "request_id")]
    pub id: String,
    /// First digits of the BLAKE3 hash of the tool name, a line feed, and the sent arguments as JSON without spaces and
    /// with sorted keys.
    #[serde(rename = "request_digest")]
    pub digest: String,
}

impl RequestId {
    /// Creates a request id for a call, with the digest of tool and arguments.
    pub fn new(id: &str, tool: &str, args: &Value) -> RequestId {
        let mut sorted = args.clone();
        sorted.sort_all_objects();
        let hash = blake3::hash(format!("{tool}\n{sorted}").as_bytes()).to_hex();
        RequestId { id: id.to_owned(), digest: hash[..DIGEST_DIGITS].to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn digest_ignores_key_order_only() {
        let digest = |tool: &str, args: &Value| RequestId::new("x", tool, args).digest;
        let first = digest("set_prices", &json!({ "A": 1, "B": { "c": [1, 2], "d": null } }));
        assert_eq!(first, digest("set_prices", &json!({ "B": { "d": null, "c": [1, 2] }, "A": 1 })));
        assert_ne!(first, digest("set_prices", &json!({ "A": 1, "B": { "c": [2, 1], "d": null } })));
        assert_ne!(first, digest("set_usage_quotas", &json!({ "A": 1, "B": { "c": [1, 2], "d": null } })));
    }
}
