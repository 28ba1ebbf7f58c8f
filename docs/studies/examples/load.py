"""Loads the tables of a study (docs/studies/tables.md) with the types that columns.csv defines.

    python3 load.py FOLDER            prints a line for each run
    from load import tables           tables("FOLDER") returns data frames if pandas is installed, otherwise lists of dicts

Missing values are None, or NaN in data frames. The `'` that prevents the interpretation of a text as a formula is removed.
"""

import csv
import sys
from pathlib import Path

try:
    import pandas
except ImportError:
    pandas = None

NAMES = ("runs", "weeks", "forecasts", "queries", "events", "answers", "notes", "visits")
WHOLE = {"count", "day", "days", "number", "bytes"}
REAL = {"dollars", "dollars a month", "share", "seconds", "milliseconds", "minutes", "per week", "per 100 words", "per group", "units"}


def columns(folder):
    """Returns the rows of columns.csv by table and column."""
    with open(Path(folder) / "columns.csv", newline="", encoding="utf-8") as file:
        return {(row["table"], row["column"]): row for row in csv.DictReader(file)}


def value(text, unit):
    """Converts a cell according to its unit."""
    if text == "":
        return None
    if unit == "0 or 1":
        return text == "1"
    if unit in WHOLE:
        return int(text)
    if unit in REAL:
        return float(text)
    return text[1:] if text[0] == "'" and text[1:].lstrip()[:1] in tuple("=+-@") else text


def rows(folder, name):
    """Returns a table as a list of dicts."""
    known = columns(folder)
    with open(Path(folder) / f"{name}.csv", newline="", encoding="utf-8") as file:
        table = csv.DictReader(file)
        return [{column: value(cell, known[name, column]["unit"]) for column, cell in row.items()} for row in table]


def tables(folder):
    """Returns all tables by name."""
    loaded = {name: rows(folder, name) for name in NAMES}
    if pandas is None:
        return loaded
    known = columns(folder)
    heads = {name: [column for table, column in known if table == name] for name in NAMES}
    return {name: pandas.DataFrame(loaded[name], columns=heads[name]) for name in NAMES}


if __name__ == "__main__":
    for run in rows(sys.argv[1], "runs"):
        cells = ("run", "participant", "day", "cash", "active_seconds", "calls", "truly_best_channel_share")
        print("\t".join("" if run[name] is None else str(run[name]) for name in cells))
