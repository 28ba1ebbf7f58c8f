//! Language of scripts and calculations.

/// The language of a script or calculation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// SQL statements, separated by `;`.
    Sql,
    /// Python code.
    Python,
}

impl Language {
    /// Detects the language of code. Code that starts with `#` is Python, because no SQL statement does.
    pub fn detect(code: &str) -> Language {
        match code.trim_start_matches('\u{feff}').trim_start().starts_with('#') {
            true => Language::Python,
            false => Language::Sql,
        }
    }
}

/// Returns a hint on how to mark Python code if unmarked code looks like Python. Otherwise, returns `None`.
pub fn python_marker_hint(code: &str) -> Option<&'static str> {
    let is_python = |line: &str| {
        let begins = ["import ", "def ", "class ", "print("].iter().any(|word| line.starts_with(word));
        let is_from_import = line.starts_with("from ") && line.contains(" import ");
        let is_block = line.starts_with("for ") && line.trim_end().ends_with(':');
        begins || is_from_import || is_block || line.contains("query(\"") || line.contains("query('")
    };
    let looks_like_python =
        Language::detect(code) == Language::Sql && code.lines().map(str::trim_start).any(is_python);
    looks_like_python.then_some("this looks like Python: let its first line be `# python`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_character_determines_the_language() {
        for code in ["# python\nprint(1)", "#!/usr/bin/env python3", "\n  # x", "\u{feff}#"] {
            assert_eq!(Language::detect(code), Language::Python, "{code}");
            assert_eq!(python_marker_hint(code), None, "{code}");
        }
        for code in ["SELECT 1", "", "-- # python\nSELECT 1", "print(1)\n# python"] {
            assert_eq!(Language::detect(code), Language::Sql, "{code}");
        }
    }

    #[test]
    fn unmarked_python_gets_a_hint() {
        for code in [
            "print('hello')",
            "import math",
            "x = 1\nfrom math import sqrt",
            "def f():\n    return 1",
            "for row in rows:\n  pass",
            "rows = query(\"SELECT 1\")",
        ] {
            assert!(python_marker_hint(code).is_some(), "{code}");
        }
        for code in
            ["SELECT 1", "SELECT day\nfrom ledger -- import", "SELECT 1 AS import_", "SELECT 'for all':"]
        {
            assert_eq!(python_marker_hint(code), None, "{code}");
        }
    }
}
