//! The tool that a call names, which may not exist.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use novamind_tools::ToolId;

/// Maximum length of a recorded unknown name, in characters. Longer names are truncated and end with an ellipsis.
const MAX_NAME_CHARACTERS: usize = 128;

/// The tool that a call names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CalledTool {
    /// A tool of the benchmark.
    Known(ToolId),
    /// A name that is not the name of a tool.
    Unknown(String),
}

impl CalledTool {
    /// Returns the called tool for an unknown name. Truncates long names.
    pub fn from_unknown_name(name: &str) -> CalledTool {
        let is_long = name.chars().nth(MAX_NAME_CHARACTERS).is_some();
        CalledTool::Unknown(match is_long {
            true => name.chars().take(MAX_NAME_CHARACTERS - 1).chain(['…']).collect(),
            false => name.to_owned(),
        })
    }

    /// Returns the name of the called tool, known or unknown.
    pub fn name(&self) -> &str {
        match self {
            CalledTool::Known(tool) => tool.name(),
            CalledTool::Unknown(name) => name,
        }
    }

    /// Returns the called tool, or `None` if no tool has this name.
    pub fn tool_id(&self) -> Option<ToolId> {
        match self {
            CalledTool::Known(tool) => Some(*tool),
            CalledTool::Unknown(_) => None,
        }
    }
}

impl From<ToolId> for CalledTool {
    fn from(tool: ToolId) -> CalledTool {
        CalledTool::Known(tool)
    }
}

impl PartialEq<ToolId> for CalledTool {
    fn eq(&self, other: &ToolId) -> bool {
        self.tool_id() == Some(*other)
    }
}

impl fmt::Display for CalledTool {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl Serialize for CalledTool {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for CalledTool {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<CalledTool, D::Error> {
        let name = String::deserialize(deserializer)?;
        Ok(name.parse().map_or(CalledTool::Unknown(name), CalledTool::Known))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_names_are_truncated() {
        let name = "ä".repeat(MAX_NAME_CHARACTERS);
        assert_eq!(CalledTool::from_unknown_name(&name).name(), name);
        let cut = CalledTool::from_unknown_name(&format!("{name}b"));
        assert_eq!(cut.name().chars().count(), MAX_NAME_CHARACTERS);
        assert!(cut.name().ends_with("ä…") && cut.tool_id().is_none());
    }
}
