"""Exports eleven runs of policies and of plain mode. atif validates the trajectories, and Inspect's own tools list, read and tabulate the
logs. An archive that Inspect writes from one of them is imported."""
import json
import os
import subprocess
import sys

import pandas
from atif import Trajectory
from inspect_ai.analysis import evals_df, messages_df, samples_df
from inspect_ai.log import list_eval_logs, read_eval_log, write_eval_log

PROGRAM = os.environ["NOVAMIND"]
POLICIES = ["P0", "P1a", "P1b", "P2", "P4", "baseline", "enterprise-led"]
PLAYS = [
    "set_prices A=12 B=25\nset_prices A=-1\nquery SELECT SUM(amount) AS cash FROM ledger\nnext \"why\" naive\nundo\nnext \"on\" naive\n",
    "memo If it goes well, wait.\nnext \"nothing\" naive\n",
    "post_social_media content=\"Hello\"\nquery SELECT nothing\nresearch_market\nnext \"look\" naive\n",
]


def novamind(*arguments, text=None, runs=None):
    environment = dict(os.environ, **({"NOVAMIND_RUNS": runs} if runs else {}))
    said = subprocess.run([PROGRAM, *arguments], input=text, text=True, capture_output=True, env=environment)
    if said.returncode != 0:
        sys.exit(f"{arguments}: {said.stderr}{said.stdout}")
    return said.stdout


def score_by_the_rules(shown):
    """Returns the cash of the last day, 0 after a bankruptcy, or None for an unfinished run."""
    return {None: None, "horizon": shown["cash"], "bankruptcy": 0}[shown["ended"]]


def check_trajectory(run, file, log):
    with open(file, encoding="utf-8") as opened:
        trajectory = Trajectory.model_validate(json.load(opened))
    calls = sum(len(step.tool_calls or []) for step in trajectory.steps)
    tools = sum(message.role == "tool" for message in log.samples[0].messages)
    assert calls == tools, (run, calls, tools)


def check_tables(logs, runs):
    """Checks Inspect's tables of a folder of logs."""
    listed = list_eval_logs(logs, filter=lambda header: header.eval.task == "novamind")
    assert sorted(own.task_id for own in listed) == sorted(runs), listed
    evals = evals_df(logs, quiet=True).set_index("task_id")
    samples = samples_df(logs, quiet=True).set_index("id")
    messages = messages_df(logs, quiet=True)
    for own in listed:
        run, log = own.task_id, read_eval_log(own)
        score = score_by_the_rules(runs[run])
        for value in (evals.loc[run, "score_headline_value"], samples.loc[run, "score_cash"]):
            assert (None if pandas.isna(value) else float(value)) == score, (run, value, score)
        assert (evals.loc[run, "status"] == "started") == (score is None), run
        in_table = messages[messages["eval_id"] == log.eval.eval_id]
        assert list(in_table["message_id"]) == [message.id for message in log.samples[0].messages], run


def check_import(log, state, work):
    """Checks that Inspect's own archive of a log is imported as a run in the same state."""
    archive = os.path.join(work, "log.eval")
    write_eval_log(log, archive)
    said = novamind("runs", "import", "--transcript", archive, runs=os.path.join(work, "imported"))
    assert f"state {state}" in said, said


def main(work):
    for policy in POLICIES:
        novamind("run", "--policy", policy, "--seed", "3", "--days", "42", "--save")
    novamind("run", "--policy", "P0", "--seed", "3", "--days", "14", "--cash", "500", "--save")
    for seed, play in enumerate(PLAYS):
        novamind("play", "--plain", "--seed", str(seed), "--days", "28", text=play)
    runs = [run["id"] for run in json.loads(novamind("runs", "list", "--json"))]
    assert len(runs) == 11, runs
    runs = {run: json.loads(novamind("runs", "show", run, "--json")) for run in runs}
    assert {run["ended"] for run in runs.values()} == {None, "horizon", "bankruptcy"}, runs
    logs = os.path.join(work, "logs")
    for run in runs:
        file = os.path.join(work, f"{run}.atif.json")
        novamind("runs", "export", run, "--format", "atif", "--out", file)
        novamind("runs", "export", run, "--format", "inspect", "--out", logs)
        (own,) = [own for own in list_eval_logs(logs) if own.task_id == run]
        check_trajectory(run, file, read_eval_log(own))
    check_tables(logs, runs)
    for own in list_eval_logs(logs):
        if runs[own.task_id]["ended"] == "horizon":
            check_import(read_eval_log(own), runs[own.task_id]["state_hash"], work)
            break
    print(f"{len(runs)} runs: atif validates their trajectories, inspect_ai lists, reads and tabulates their logs")


main(sys.argv[1])
