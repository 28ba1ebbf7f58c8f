#!/usr/bin/env python3
"""Applies one mutation at a time in a copy of the repository and counts how many the test suite detects.

    tests/planted/plant.py                        all mutants, the whole suite
    tests/planted/plant.py --only 3,17,40         some mutants
    tests/planted/plant.py --crate novamind-world the mutants of one crate
    tests/planted/plant.py --stages own,library   some of the stages
    tests/planted/plant.py --check                only check that each place still exists
    tests/planted/plant.py -- --skip pictures     arguments after -- go to every test program

All mutants go into one copy, each behind a switch, so that one build contains them all. The expression that `errors.toml`
marks with « » becomes `(if planted(7) { WRONG } else { RIGHT })`; the environment variable NOVAMIND_PLANTED selects
the wrong one. Tests of the source text (tests/tidy) are skipped, because the switches would fail them.

Stages run in the order of STAGES, each with the mutants that no earlier stage detected. A test program is stopped at its
first failure. The failing test counts if it fails a second time and passes without the mutant.
"""

import argparse
import collections
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import threading
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIST = pathlib.Path(__file__).with_name("errors.toml")
COPIED = ["Cargo.toml", "Cargo.lock", "clippy.toml", "rustfmt.toml", "README.md", "assets", "configs", "docs", "src", "tests"]
# Unit tests of the crate with the mutant, integration tests, everything else.
STAGES = ["own", "library", "program", "console", "study", "others"]
# Seconds without a finished test after which a test program counts as hanging.
LONGEST = 1200
SWITCH = '''//! The switch that activates a mutant.

/// Returns whether the mutant with this number is active.
pub fn planted(number: u32) -> bool {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    let read = || std::env::var("NOVAMIND_PLANTED").ok().and_then(|text| text.parse().ok()).unwrap_or(0);
    *CHOSEN.get_or_init(read) == number
}
'''


def listed():
    with open(LIST, "rb") as file:
        errors = tomllib.load(file)["error"]
    return [dict(error, number=number) for number, error in enumerate(errors, 1)]


def manifest_of(path):
    """Returns the manifest of the crate of a source file."""
    return next(folder / "Cargo.toml" for folder in path.parents if (folder / "Cargo.toml").exists())


def crate_of(path):
    """Returns the name of the crate of a source file."""
    return tomllib.loads(manifest_of(path).read_text())["package"]["name"]


def plant(texts, error):
    """Puts the mutant behind its switch. Its place is searched in all sources, regardless of line breaks."""
    before, right, after = re.split("[«»]", error["place"])
    parts = [r"\s+".join(re.escape(word) for word in part.split(" ")) for part in (before, right, after)]
    pattern = re.compile("({})({})({})".format(*parts))
    found = [path for path, text in texts.items() for _ in pattern.finditer(text)]
    if len(found) != 1:
        sys.exit(f"error {error['number']}: its place is there {len(found)} times: {error['place']}")
    error["crate"] = crate_of(found[0])
    base = "crate" if error["crate"] == "novamind-base" else "novamind_base"
    switch = f"{base}::planted::planted({error['number']})"
    wrong = lambda match: f"{match[1]}(if {switch} {{ {error['wrong']} }} else {{ {match[2]} }}){match[3]}"
    texts[found[0]] = pattern.sub(wrong, texts[found[0]])


def sources(errors):
    """Returns the sources with mutants, by path."""
    original = {path: path.read_text() for path in sorted((ROOT / "src").rglob("*.rs"))}
    texts = dict(original)
    for error in errors:
        plant(texts, error)
    changed = {path: text for path, text in texts.items() if text != original[path]}
    base = ROOT / "src/base"
    # Every crate with a mutant needs the crate of the switch.
    for manifest in {manifest_of(path) for path in changed}:
        text = manifest.read_text()
        if manifest.parent not in (ROOT, base) and "novamind-base.workspace" not in text:
            changed[manifest] = text.replace("[dependencies]\n", "[dependencies]\nnovamind-base.workspace = true\n", 1)
    library = base / "lib.rs"
    return changed | {base / "planted.rs": SWITCH, library: texts[library] + "\n#[doc(hidden)]\npub mod planted;\n"}


def copy(folder, changed):
    """Replaces the copy. Modification times are kept, so that cargo builds only the differences from the last copy."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in COPIED:
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy2)(source, folder / name)
    (folder / "tests/tidy/main.rs").write_text("")
    newest = max(path.stat().st_mtime for path in (LIST, pathlib.Path(__file__)))
    for path, text in changed.items():
        place = folder / path.relative_to(ROOT)
        place.write_text(text)
        time = max(newest, path.stat().st_mtime if path.exists() else 0)
        os.utime(place, (time, time))


class Program:
    """A test program that cargo built."""

    def __init__(self, built):
        self.path, self.folder = built["executable"], pathlib.Path(built["manifest_path"]).parent
        self.crate = tomllib.loads((self.folder / "Cargo.toml").read_text())["package"]["name"]
        self.test = built["target"]["name"] if "test" in built["target"]["kind"] else None
        self.skipped = []

    def belongs_to(self, stage, crate):
        if self.test:
            return stage == (self.test if self.test in STAGES else "others")
        return stage == ("own" if self.crate == crate else "others")

    def first_failure(self, number, arguments):
        """Returns the name of the first failing test, or `None` if all pass."""
        environment = dict(os.environ, NOVAMIND_PLANTED=str(number), CARGO_MANIFEST_DIR=str(self.folder))
        run = subprocess.Popen(
            [self.path, *arguments], cwd=self.folder, env=environment, text=True, errors="replace",
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True,
        )
        stop = lambda: os.killpg(run.pid, signal.SIGKILL)
        failed = None
        lines = iter(run.stdout.readline, "")
        while failed is None:
            timer = threading.Timer(LONGEST, stop)
            timer.start()
            line = next(lines, None)
            timer.cancel()
            if line is None:
                break
            match = re.match(r"test (\S+).* FAILED$", line)
            failed = match and match[1]
        if failed:
            stop()
        run.stdout.close()
        return failed or ("(the program stops)" if run.wait() else None)

    def notices(self, number, arguments):
        """Returns the name of a test that fails because of the mutant, or `None`."""
        while True:
            skips = [word for name in self.skipped for word in ("--skip", name)]
            failed = self.first_failure(number, [*arguments, *skips])
            if failed is None or failed.startswith("("):
                return failed
            if self.first_failure(number, ["--exact", failed]) and not self.first_failure(0, ["--exact", failed]):
                return failed
            print(f"     {failed} does not depend on the error and is skipped", flush=True)
            self.skipped.append(failed)


def build(folder, target):
    command = [os.environ.get("CARGO", "cargo"), "test", "--no-run", "--message-format=json"]
    environment = dict(os.environ, CARGO_TARGET_DIR=str(target))
    run = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, stderr=subprocess.PIPE)
    messages = [json.loads(line) for line in run.stdout.splitlines() if line.startswith("{")]
    if run.returncode != 0:
        texts = [message["message"]["rendered"] for message in messages if message["reason"] == "compiler-message"]
        sys.exit("the copy does not build:\n" + "".join(text for text in texts if text.startswith("error")) + run.stderr[-2000:])
    artifacts = [message for message in messages if message["reason"] == "compiler-artifact"]
    return [Program(built) for built in artifacts if built["executable"] and built["profile"]["test"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", help="numbers of errors, separated by commas")
    parser.add_argument("--crate", help="errors of one crate")
    parser.add_argument("--stages", default=",".join(STAGES), help="stages, separated by commas")
    parser.add_argument("--check", action="store_true", help="only test that each error finds its place")
    parser.add_argument("--folder", default=ROOT / "target/planted", type=pathlib.Path, help="folder of copy and build")
    parser.add_argument("arguments", nargs="*", help="arguments of the test programs, after --")
    options = parser.parse_args()

    errors = listed()
    changed = sources(errors)
    if options.check:
        print(f"{len(errors)} errors find their places")
        return
    wanted = {int(number) for number in options.only.split(",")} if options.only else {error["number"] for error in errors}
    left = [error for error in errors if error["number"] in wanted and options.crate in (None, error["crate"])]
    total = collections.Counter(error["crate"] for error in left)
    copy(options.folder / "copy", changed)
    programs = build(options.folder / "copy", options.folder / "build")
    for stage in options.stages.split(","):
        print(f"stage {stage}: {len(left)} errors", flush=True)
        unnoticed = []
        for error in left:
            chosen = [program for program in programs if program.belongs_to(stage, error["crate"])]
            by = next(filter(None, (program.notices(error["number"], options.arguments) for program in chosen)), None)
            print(f"{error['number']:>3}  {error['crate']}: {by or '-'}", flush=True)
            unnoticed += [] if by else [error]
        left = unnoticed
    missed = collections.Counter(error["crate"] for error in left)
    for crate, count in sorted(total.items()):
        print(f"{crate:<20} {count - missed[crate]} of {count}")
    print(f"{'all':<20} {total.total() - missed.total()} of {total.total()}")
    for error in left:
        print(f"not noticed: {error['number']:>3}  {error['place']}  →  {error['wrong']}")


if __name__ == "__main__":
    main()
