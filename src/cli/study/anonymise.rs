//! `novamind study anonymize`: writes the tables of a study without data that identifies participants.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::runs::to_csv;
use crate::cli::{Failure, print};
use crate::record::files::create_private_file;
use crate::report::anonymization::{AnonymizedTables, Anonymizer, LINK_COLUMNS, NamedTable, TextHandling};
use crate::report::pluralize;
use crate::report::tables::table_headings;

#[derive(Debug, Args)]
pub struct Options {
    /// Folder with the tables of `study collect` or `runs export --all`
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// New folder for the anonymous tables
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// File with the secret that determines new names; a missing file is created. The table of old and new names is
    /// written next to this file. Keep both files
    #[arg(long, value_name = "FILE")]
    secret: PathBuf,
    /// Leave out columns with the lengths of texts that people wrote
    #[arg(long)]
    mask: bool,
    /// More columns to leave out of every table, for example `seed,condition`
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',')]
    without: Vec<String>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let links_path = options.secret.with_extension("links.csv");
    let inside = |path: &Path| path.parent().is_some_and(|folder| folder == options.out);
    if inside(&options.secret) {
        return Err(Failure::usage("the secret must not be in the output folder"));
    }
    let tables = table_headings()
        .iter()
        .map(|(name, _)| read_table(&options.folder, name))
        .collect::<Result<Vec<_>, _>>()?;
    let secret = read_or_create_secret(&options.secret)?;
    let texts = if options.mask { TextHandling::Masked } else { TextHandling::Dropped };
    let mut anonymiser = Anonymizer::new(secret, texts, options.without.clone());
    anonymiser.check_omitted_columns().map_err(Failure::usage)?;
    let AnonymizedTables { tables: made, links, smallest_group } =
        anonymiser.anonymize(&tables).map_err(Failure::unreadable)?;
    let failed =
        |path: &Path, error: &std::io::Error| Failure::failed(format!("{}: {error}", path.display()));
    if options.out.exists() {
        let message = format!(
            "{} already exists: its files could be published by mistake; give a new folder with --out",
            options.out.display()
        );
        return Err(Failure::failed(message));
    }
    std::fs::create_dir_all(&options.out).map_err(|error| failed(&options.out, &error))?;
    for (name, rows) in &made {
        let path = options.out.join(format!("{name}.csv"));
        std::fs::write(&path, to_csv(rows)?).map_err(|error| failed(&path, &error))?;
    }
    let mut rows = vec![LINK_COLUMNS.map(str::to_owned).to_vec()];
    rows.extend(links.iter().map(|link| {
        let cells = [
            &link.participant,
            &link.new_participant,
            &link.run,
            &link.new_run,
            &link.last_hash,
            &link.original,
        ];
        cells.map(Clone::clone).to_vec()
    }));
    let text = to_csv(&rows)?;
    // The table of old and new names, like the secret, can identify participants.
    let _ = std::fs::remove_file(&links_path);
    create_private_file(&links_path)
        .and_then(|mut file| file.write_all(text.as_bytes()))
        .map_err(|error| failed(&links_path, &error))?;
    let smallest_group_note = smallest_group.map_or(String::new(), |(size, values)| {
        format!(
            "the smallest group of sessions with the same seed and condition has {size} ({values}); to leave these \
             columns out, add --without seed,condition\n"
        )
    });
    print(&format!(
        "the anonymized tables of {} are in {}; keep {} and {}, but do not publish them\n{smallest_group_note}",
        pluralize(links.len() as u32, "run"),
        options.out.display(),
        options.secret.display(),
        links_path.display()
    ))
}

fn read_table(folder: &Path, name: &str) -> Result<NamedTable, Failure> {
    let path = folder.join(format!("{name}.csv"));
    let wrong = |error: csv::Error| Failure::unreadable(format!("{}: {error}", path.display()));
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(&path).map_err(wrong)?;
    let rows = reader.records().map(|row| Ok(row.map_err(wrong)?.iter().map(str::to_owned).collect()));
    Ok((name.to_owned(), rows.collect::<Result<Vec<_>, Failure>>()?))
}

/// Reads the secret of 64 hexadecimal digits from a file, or creates the file with a new secret.
fn read_or_create_secret(path: &Path) -> Result<[u8; 32], Failure> {
    let failed = |error: std::io::Error| Failure::failed(format!("{}: {error}", path.display()));
    match std::fs::read_to_string(path) {
        Ok(text) => {
            let hash = blake3::Hash::from_hex(text.trim()).map_err(|_| {
                Failure::usage(format!("{}: a secret has 64 hexadecimal digits", path.display()))
            })?;
            Ok(*hash.as_bytes())
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let mut secret = [0; 32];
            getrandom::fill(&mut secret).map_err(|error| {
                Failure::failed(format!("the system returned no random numbers ({error})"))
            })?;
            let text = format!("{}\n", blake3::Hash::from_bytes(secret).to_hex());
            create_private_file(path).and_then(|mut file| file.write_all(text.as_bytes())).map_err(failed)?;
            Ok(secret)
        }
        Err(error) => Err(failed(error)),
    }
}
