//! Bundled scenarios, lessons, themes, policies and grids: all files of their folders in `configs/`, embedded in the program. A new
//! file needs no code.

use include_dir::{Dir, include_dir};

/// Name and text of a file.
pub type BundledFile = (&'static str, &'static str);

static SCENARIOS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/scenarios");
static THEMES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/themes");
static POLICIES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/policies");

static GRIDS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/grids");
static LESSONS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../configs/lessons");
static LESSON_TEXTS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../assets/lessons");

/// Returns the scenarios, by name.
pub fn scenarios() -> Vec<BundledFile> {
    bundled_files(&SCENARIOS)
}

/// Returns the themes, by name.
pub fn themes() -> Vec<BundledFile> {
    bundled_files(&THEMES)
}

/// Returns the policies, by name.
pub fn policies() -> Vec<BundledFile> {
    bundled_files(&POLICIES)
}

/// Returns the grids of policies, by name.
pub fn grids() -> Vec<BundledFile> {
    bundled_files(&GRIDS)
}

/// Returns the lessons, by name, in the order of the course.
pub fn lessons() -> Vec<BundledFile> {
    let mut lessons = bundled_files(&LESSONS);
    let place = |name: &str| LESSON_ORDER.iter().position(|text| *text == name).unwrap_or(LESSON_ORDER.len());
    lessons.sort_by_key(|(name, _)| place(name));
    lessons
}

/// Returns the texts of a lesson.
pub fn lesson_texts(name: &str) -> Option<&'static str> {
    LESSON_TEXTS.get_file(format!("{name}.md"))?.contents_utf8()
}

/// The lessons in the order of the course.
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
        for (folder, held) in
            [("scenarios", scenarios()), ("themes", themes()), ("policies", policies()), ("grids", grids())]
        {
            let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").join(folder);
            let entries = std::fs::read_dir(path).expect("a folder").flatten();
            let mut there: Vec<String> =
                entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
            there.sort_unstable();
            let named: Vec<String> = held.iter().map(|(name, _)| format!("{name}.toml")).collect();
            assert_eq!(named, there);
        }
    }
}
