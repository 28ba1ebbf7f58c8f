//! The rule by which release 2 decides which calls need a request id.

/// Returns whether a call of the tool needs a request id in release 2: every call that is not a read by its name.
pub fn needs_request_id(tool: &str) -> bool {
    !tool.starts_with("get_") && !tool.starts_with("list_")
}
