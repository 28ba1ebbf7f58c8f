#!/usr/bin/env python3
"""Plants small errors and counts how many of them the default test suite notices.

    tests/planted/plant.py                    all errors, the whole suite
    tests/planted/plant.py --only 3,17,40     some of them
    tests/planted/plant.py --house session    those of one house
    tests/planted/plant.py --check            only see whether every error still finds its place
    tests/planted/plant.py -- --lib           what follows -- goes to `cargo test`

All errors go into one copy of the repository, each behind a switch, so that one build serves them all: the
expression that `errors.toml` marks with « » becomes `(if planted(7) { WRONG } else { RIGHT })`, and the environment
variable NOVAMIND_PLANTED says which number is wrong. What is asked of the text of the sources (tests/tidy.rs) is left
out, because the copy is not as tidy.
"""

import argparse
import collections
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = pathlib.Path(__file__).with_name("errors.toml")
COPIED = ["Cargo.toml", "Cargo.lock", "build.rs", "clippy.toml", "rustfmt.toml", "README.md"]
COPIED += ["assets", "configs", "docs", "src", "tests"]
# Seconds after which a suite that hangs counts as having noticed.
LONGEST = 1200
SWITCH = '''//! Which planted error is made.

/// Whether this error is made.
pub fn planted(number: u32) -> bool {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    let read = || std::env::var("NOVAMIND_PLANTED").ok().and_then(|text| text.parse().ok()).unwrap_or(0);
    *CHOSEN.get_or_init(read) == number
}
'''


def errors():
    with open(LIST, "rb") as file:
        listed = tomllib.load(file)["error"]
    return [dict(error, number=number) for number, error in enumerate(listed, 1)]


def plant(text, error):
    """The text with the error behind its switch."""
    place = error["place"]
    before, rest = place.split("«")
    right, after = rest.split("»")
    found = text.count(before + right + after)
    if found != 1:
        sys.exit(f"error {error['number']}, {error['file']}: its place is there {found} times: {place}")
    choice = f"(if crate::planted::planted({error['number']}) {{ {error['wrong']} }} else {{ {right} }})"
    return text.replace(before + right + after, before + choice + after)


def copy(folder, planted):
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name)
        elif source.exists():
            shutil.copy(source, folder / name)
    # It asks for tidy sources, which a copy full of switches is not.
    for name in folder.glob("tests/tidy*"):
        name.unlink() if name.is_file() else shutil.rmtree(name)
    for error in planted:
        path = folder / error["file"]
        path.write_text(plant(path.read_text(), error))
    for crate in {crate_of(folder, error) for error in planted}:
        (crate / "planted.rs").write_text(SWITCH)
        library = next(crate / name for name in ["lib.rs", "mod.rs"] if (crate / name).exists())
        library.write_text(library.read_text() + "\n#[doc(hidden)]\npub mod planted;\n")


def crate_of(folder, error):
    """The folder with the sources of the crate in which an error is made."""
    for parent in (folder / error["file"]).parents:
        if (parent / "Cargo.toml").exists():
            return parent / "src" if parent == folder else parent


def cargo(folder, arguments, number, target):
    environment = dict(os.environ, NOVAMIND_PLANTED=str(number), CARGO_TARGET_DIR=str(target), RUSTFLAGS="-Awarnings")
    command = [os.environ.get("CARGO", "cargo"), "test", *arguments]
    try:
        return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return None


def first_failure(run):
    if run is None:
        return "it does not end"
    for line in run.stdout.splitlines():
        if line.startswith("test ") and line.rstrip().endswith("FAILED"):
            return line.split()[1]
    return "it does not run"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="numbers of errors, separated by commas")
    parser.add_argument("--house", help="errors of one house")
    parser.add_argument("--check", action="store_true", help="only see whether every error finds its place")
    parser.add_argument("--target", default=ROOT / "target/planted", type=pathlib.Path, help="folder of the build")
    parser.add_argument("tests", nargs="*", help="arguments of cargo test, after --")
    options = parser.parse_args()

    listed = errors()
    chosen = [error for error in listed if not options.house or error["house"] == options.house]
    if options.only:
        wanted = {int(number) for number in options.only.split(",")}
        chosen = [error for error in chosen if error["number"] in wanted]

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        copy(folder, listed)
        if options.check:
            print(f"{len(listed)} errors find their places")
            return
        built = cargo(folder, ["--no-run"], 0, options.target)
        if built is None or built.returncode != 0:
            sys.exit("the copy does not build:\n" + (built.stderr[-4000:] if built else "no end"))
        clean = cargo(folder, options.tests, 0, options.target)
        if clean is None or clean.returncode != 0:
            sys.exit(f"the suite fails without an error: {first_failure(clean)}")
        score = collections.defaultdict(lambda: [0, 0])
        for error in chosen:
            run = cargo(folder, options.tests, error["number"], options.target)
            noticed = run is None or run.returncode != 0
            score[error["house"]][0] += noticed
            score[error["house"]][1] += 1
            by = first_failure(run) if noticed else "NOBODY"
            print(f"{error['number']:>3}  {error['house']:<8}  {error['what']}: noticed by {by}", flush=True)
    print()
    for house, (noticed, of) in sorted(score.items()):
        print(f"{house:<8}  {noticed} of {of}")
    noticed, of = (sum(pair[at] for pair in score.values()) for at in (0, 1))
    print(f"all       {noticed} of {of}: {100 * noticed / max(of, 1):.0f} %")


if __name__ == "__main__":
    main()
