"""Plays the scripts of eleven runs on new runs: in plain mode and with the Python client.

Both must end in the state that the script names.
"""
import json
import os
import re
import shlex
import subprocess
import sys

PROGRAM = os.environ["NOVAMIND"]


def novamind(*arguments, runs=None, text=None):
    environment = dict(os.environ, **({"NOVAMIND_RUNS": runs} if runs else {}))
    said = subprocess.run([PROGRAM, *arguments], input=text, text=True, capture_output=True, env=environment)
    if said.returncode != 0:
        sys.exit(f"{arguments}: {said.stderr}{said.stdout}")
    return said.stdout


def last_state(runs, run):
    with open(os.path.join(runs, run, "trajectory.jsonl"), encoding="utf-8") as file:
        states = [line["state_hash"] for line in map(json.loads, file) if line["kind"] == "week"]
    return states[-1]


def only_run(runs):
    (run,) = [run["id"] for run in json.loads(novamind("runs", "list", "--json", runs=runs))]
    return run


def in_plain_mode(script, runs):
    """Plays `play.txt` with the command in its second line."""
    with open(script, encoding="utf-8") as file:
        text = file.read()
    options = re.search(r"^# novamind play (.*) < THIS FILE$", text, re.MULTILINE).group(1)
    novamind("play", *shlex.split(options), runs=runs, text=text)
    return last_state(runs, only_run(runs))


def over_the_client(script, runs, client):
    """Plays `play.py` with the command in its first lines, on any free port."""
    with open(script, encoding="utf-8") as file:
        options = re.search(r"^ *novamind serve (--new .*) --port \d+$", file.read(), re.MULTILINE).group(1)
    server = subprocess.Popen(
        [PROGRAM, "serve", *shlex.split(options)], stdout=subprocess.PIPE, text=True, env=dict(os.environ, NOVAMIND_RUNS=runs)
    )
    told = json.loads(server.stdout.readline())
    environment = dict(os.environ, NOVAMIND_API_PORT=str(told["port"]), PYTHONPATH=client)
    said = subprocess.run([sys.executable, script], env=environment, text=True, capture_output=True)
    server.terminate()
    server.wait()
    if said.returncode != 0:
        sys.exit(f"{script}: {said.stderr}{said.stdout}")
    return last_state(runs, told["run"])


def main(work):
    client = os.path.join(work, "client")
    novamind("serve", "--client", client)
    runs = [run["id"] for run in json.loads(novamind("runs", "list", "--json"))]
    assert len(runs) == 11, runs
    for run in runs:
        out = os.path.join(work, f"script-{run}")
        novamind("runs", "export", run, "--format", "script", "--out", out)
        expected = last_state(os.environ["NOVAMIND_RUNS"], run)
        plain = in_plain_mode(os.path.join(out, "play.txt"), os.path.join(out, "plain"))
        python = over_the_client(os.path.join(out, "play.py"), os.path.join(out, "python"), client)
        assert plain == python == expected, (run, plain, python, expected)
    print(f"{len(runs)} runs: their scripts lead to their states, in plain mode and over the Python client")


main(sys.argv[1])
