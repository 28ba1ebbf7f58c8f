# Loads the tables of a study (docs/studies/tables.md) with the types that columns.csv defines; base R only.
#
#   Rscript load.R FOLDER            prints a line for each run
#   source("load.R"); study <- tables("FOLDER"); study$runs
#
# Missing values are NA. The ' that prevents the interpretation of a text as a formula is removed.

names_of_tables <- c("runs", "weeks", "forecasts", "queries", "events", "answers", "notes",
                     "visits")
whole <- c("count", "day", "days", "number", "bytes")
real <- c("dollars", "dollars a month", "share", "seconds", "milliseconds", "minutes", "per week", "per 100 words", "per group", "units")

typed <- function(cells, unit) {
  if (unit == "0 or 1") return(cells == "1")
  # Seeds can be larger than an integer.
  if (unit %in% c(whole, real)) return(as.numeric(cells))
  sub("^'(\\s*[=+@-])", "\\1", cells)
}

table_of <- function(folder, name) {
  columns <- read.csv(file.path(folder, "columns.csv"), colClasses = "character", encoding = "UTF-8")
  columns <- columns[columns$table == name, ]
  cells <- read.csv(file.path(folder, paste0(name, ".csv")), colClasses = "character", na.strings = "",
                    check.names = FALSE, encoding = "UTF-8")
  for (at in seq_len(nrow(columns))) {
    column <- columns$column[at]
    cells[[column]] <- typed(cells[[column]], columns$unit[at])
  }
  cells
}

tables <- function(folder) {
  setNames(lapply(names_of_tables, function(name) table_of(folder, name)), names_of_tables)
}

arguments <- commandArgs(trailingOnly = TRUE)
if (sys.nframe() == 0 && length(arguments) == 1) {
  runs <- table_of(arguments[1], "runs")
  shown <- runs[, c("run", "participant", "day", "cash", "active_seconds", "calls", "truly_best_channel_share")]
  write.table(shown, sep = "\t", row.names = FALSE, col.names = FALSE, quote = FALSE, na = "")
}
