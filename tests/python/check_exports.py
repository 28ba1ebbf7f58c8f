"""Ten runs, of policies and of plain mode, as trajectories that atif validates and logs that inspect_ai reads."""
import json
import os
import subprocess
import sys

from atif import Trajectory
from inspect_ai.log import read_eval_log

PROGRAM = os.environ["NOVAMIND"]
POLICIES = ["P0", "P1a", "P1b", "P2", "P4", "baseline", "enterprise-led"]
PLAYS = [
    "set_prices A=12 B=25\nset_prices A=-1\nquery SELECT SUM(amount) AS cash FROM ledger\nnext \"why\" naive\nundo\nnext \"on\" naive\n",
    "memo If it goes well, wait.\nnext \"nothing\" naive\n",
    "post_social_media content=\"Hello\"\nquery SELECT nothing\nresearch_market\nnext \"look\" naive\n",
]


def novamind(*arguments, text=None):
    said = subprocess.run([PROGRAM, *arguments], input=text, text=True, capture_output=True)
    if said.returncode != 0:
        sys.exit(f"{arguments}: {said.stderr}{said.stdout}")
    return said.stdout


def main(work):
    for policy in POLICIES:
        novamind("run", "--policy", policy, "--seed", "3", "--days", "42", "--save")
    for seed, play in enumerate(PLAYS):
        novamind("play", "--plain", "--seed", str(seed), "--days", "28", text=play)
    runs = [run["id"] for run in json.loads(novamind("runs", "list", "--json"))]
    assert len(runs) == 10, runs
    for run in runs:
        atif, inspect = os.path.join(work, f"{run}.atif.json"), os.path.join(work, f"{run}.json")
        novamind("runs", "export", run, "--format", "atif", "--out", atif)
        novamind("runs", "export", run, "--format", "inspect", "--out", inspect)
        with open(atif, encoding="utf-8") as file:
            trajectory = Trajectory.model_validate(json.load(file))
        log = read_eval_log(inspect)
        cash = trajectory.final_metrics.extra["cash"]
        assert log.results.scores[0].metrics["value"].value == cash, run
        calls = sum(len(step.tool_calls or []) for step in trajectory.steps)
        tools = sum(message.role == "tool" for message in log.samples[0].messages)
        assert calls == tools, (run, calls, tools)
    print(f"{len(runs)} runs: atif validates their trajectories, inspect_ai reads their logs")


main(sys.argv[1])
