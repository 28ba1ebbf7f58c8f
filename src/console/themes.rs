//! Themes of the user and bundled themes.

use novamind_record::folder::configuration::Configuration;
use novamind_tui::theme::Theme;

/// Returns a theme by name. A file of the user takes precedence over a bundled theme.
///
/// # Errors
/// There is no theme of this name, or its file is invalid.
pub fn find(name: &str, configuration: &Configuration) -> Result<Theme, String> {
    let own = configuration.file(format!("themes/{name}.toml")).map_err(|error| error.to_string())?;
    if let Some(source) = own {
        return Theme::parse(name, &source.text).map_err(|problem| format!("{}: {problem}", source.name));
    }
    Theme::bundled(name).ok_or_else(|| {
        let own = configuration.names("themes");
        let known: Vec<&str> = bundled().chain(own.iter().map(String::as_str)).collect();
        format!("there is no theme {name}; there are {}", known.join(", "))
    })
}

/// Returns every theme that can be parsed, the bundled ones first. An invalid file of the user is left out; [`find`]
/// reports what is wrong with it.
pub fn all(configuration: &Configuration) -> Vec<Theme> {
    let own = configuration.names("themes");
    let others = own.iter().map(String::as_str).filter(|own| bundled().all(|name| name != *own));
    bundled().chain(others).filter_map(|name| find(name, configuration).ok()).collect()
}

fn bundled<'a>() -> impl Iterator<Item = &'a str> {
    novamind_assets::themes().into_iter().map(|(name, _)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_theme_names_the_known_ones() {
        let problem = find("pink", &Configuration::shipped()).expect_err("no theme");
        assert!(problem.contains("dark, high-contrast, light, mono"), "{problem}");
    }
}
