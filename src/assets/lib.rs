//! Bundled scenarios, lessons, themes, policies and grids: all files of their folders in `configs/`, embedded in the
//! program. A file that is added to one of these folders is bundled without a change to the code.

use include_dir::{Dir, include_dir};

/// Name and text of a bundled file.
pub type BundledFile = (&'static str, &'static str);

static SCENARIOS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/scenarios");
static THEMES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/themes");
static POLICIES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/policies");

static GRIDS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/grids");
static LESSONS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/lessons");
static LESSON_TEXTS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../assets/lessons");

/// Returns the bundled scenarios, sorted by name.
pub fn scenarios() -> Vec<BundledFile> {
    bundled_files(&SCENARIOS)
}

/// Returns the bundled themes, sorted by name.
pub fn themes() -> Vec<BundledFile> {
    bundled_files(&THEMES)
}

/// Returns the bundled policies, sorted by name.
pub fn policies() -> Vec<BundledFile> {
    bundled_files(&POLICIES)
}

/// Returns the bundled grids of policies, sorted by name.
pub fn grids() -> Vec<BundledFile> {
    bundled_files(&GRIDS)
}

/// Returns the name and the text of every bundled lesson, in course order.
pub fn lessons() -> Vec<BundledFile> {
    let mut lessons = bundled_files(&LESSONS);
    let place = |name: &str| LESSON_ORDER.iter().position(|text| *text == name).unwrap_or(LESSON_ORDER.len());
    lessons.sort_by_key(|(name, _)| place(name));
    lessons
}

/// Returns the Markdown texts of a bundled lesson.
pub fn lesson_texts(name: &str) -> Option<&'static str> {
    LESSON_TEXTS.get_file(format!("{name}.md"))?.contents_utf8()
}

/// Names of the lessons in course order.
const LESSON_ORDER: [&str; 12] = [
    "price-follows-quality",
    "price-of-the-quarter",
    "ladder",
    "unaffordable-customer",
    "list-price",
    "cheapest-dollar",
    "full-servers",
    "launch-day",
    "copied",
    "first-number",
    "ads-in-the-product",
    "capstone",
];

fn bundled_files(folder: &'static Dir<'static>) -> Vec<BundledFile> {
    let named = |file: &'static include_dir::File<'static>| {
        let name = file.path().file_name()?.to_str()?.strip_suffix(".toml")?;
        Some((name, file.contents_utf8()?))
    };
    folder.files().filter_map(named).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_in_configs_is_bundled() {
        for (folder, folder_files) in
            [("scenarios", scenarios()), ("themes", themes()), ("policies", policies()), ("grids", grids())]
        {
            let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").join(folder);
            let entries = std::fs::read_dir(path).expect("a folder").flatten();
            let mut file_names: Vec<String> =
                entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
            file_names.sort_unstable();
            let named: Vec<String> = folder_files.iter().map(|(name, _)| format!("{name}.toml")).collect();
            assert_eq!(named, file_names);
        }
    }
}
