//! Color themes: bundled themes and themes of the user.

use novamind_record::folder::configuration::Configuration;
use novamind_tui::theme::Theme;

/// Returns a theme by name. A file of the user takes precedence over a bundled theme.
///
/// # Errors
/// There is no theme with this name, or its file is invalid.
pub fn find_theme(name: &str, configuration: &Configuration) -> Result<Theme, String> {
    let parameter_source =
        configuration.read_file(format!("themes/{name}.toml")).map_err(|error| error.to_string())?;
    if let Some(source) = parameter_source {
        return Theme::parse(name, &source.text).map_err(|problem| format!("{}: {problem}", source.name));
    }
    Theme::bundled(name).ok_or_else(|| {
        let texts = configuration.toml_names("themes");
        let known: Vec<&str> = bundled_names().chain(texts.iter().map(String::as_str)).collect();
        format!("there is no theme {name}; choose from {}", known.join(", "))
    })
}

/// Returns all themes that can be parsed, the bundled themes first. Invalid files of the user are omitted, and
/// [`find_theme`] reports their errors.
pub fn all_themes(configuration: &Configuration) -> Vec<Theme> {
    let texts = configuration.toml_names("themes");
    let others = texts.iter().map(String::as_str).filter(|text| bundled_names().all(|name| name != *text));
    bundled_names().chain(others).filter_map(|name| find_theme(name, configuration).ok()).collect()
}

fn bundled_names<'a>() -> impl Iterator<Item = &'a str> {
    novamind_assets::themes().into_iter().map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_theme_error_lists_the_known_themes() {
        let problem = find_theme("pink", &Configuration::bundled()).expect_err("no theme");
        assert!(problem.contains("dark, high-contrast, light, mono"), "{problem}");
    }
}
