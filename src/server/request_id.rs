//! The rule by which release 2 decides which calls need a request id.

/// Returns whether calls of the tool need a request id in release 2. They do unless the name of the tool marks it as a
/// read.
pub fn needs_request_id(tool: &str) -> bool {
    !tool.starts_with("get_") && !tool.starts_with("list_")
}
