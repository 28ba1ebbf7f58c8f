"""Recomputes the measures of docs/studies/measures.md and compares them with the tables of an export.

It shares no code with the program: it reads trajectory.jsonl, afterwards.jsonl and world.db out of the archives that
`novamind runs export --all --out FOLDER` or `novamind study collect` leaves, and the hidden yields from configs/world.
The exit code is 1 if anything differs.

    python3 recompute.py FOLDER CONFIGS/WORLD
"""

import collections
import csv
import datetime
import json
import math
import re
import sqlite3
import statistics
import sys
import tarfile
import tempfile
import tomllib
from pathlib import Path

BREAK = 600 * 10**9
HORIZONS = (7, 28, 84, 182)
ACTING = set(
    """set_prices set_model_tiers set_usage_quotas set_promotion set_daily_spend set_targeted_ad_spend set_ads_strength
    set_lead_promotion post_social_media set_targeted_ops_spend set_targeted_dev_spend start_research_project
    research_market research_group set_capacity_tier send_enterprise_deal reject_enterprise_deal""".split()
)
PLANNING = set(
    """if unless until otherwise because therefore expect plan should would might risk assume probably likely
    instead""".split()
)
BLANK = re.compile("[\t-\r \x85\xa0\u1680\u2000-\u200a\u2028\u2029\u202f\u205f\u3000]+")


def nanoseconds(at):
    whole, _, fraction = at.rstrip("Z").partition(".")
    moment = datetime.datetime.fromisoformat(whole + "+00:00")
    seconds = (moment - datetime.datetime(1970, 1, 1, tzinfo=datetime.timezone.utc)) // datetime.timedelta(seconds=1)
    return seconds * 10**9 + int(fraction.ljust(9, "0") or 0)


def seconds(span):
    return (span + 500_000) // 1_000_000 / 1000


def rounded(value):
    return math.floor(value * 1000 + 0.5) / 1000 if value >= 0 else -math.floor(-value * 1000 + 0.5) / 1000


def wording(text):
    words = [word for word in BLANK.split(text) if word]
    letters = "".join(sign if sign.isalpha() else " " for sign in text)
    bare = [word.lower() for word in letters.split()]
    return len(words), sum(word in PLANNING for word in bare), bare.count("if")


def week_of(day):
    return (day + 6) // 7


# Time.


class Time:
    """Classifies every moment of a run by the rules of docs/formats/trajectory.md#time."""

    def __init__(self, lines):
        self.set_back = 0
        self.place, self.pieces = [], []
        copied = max((at for at, line in enumerate(lines) if line["kind"] == "branch"), default=-1)
        where, state = 0, dict(sitting=None, stopped=False, idle=False, gone=False, other=False, asked=0)
        idle = []
        for at, line in enumerate(lines):
            if at:
                passed = nanoseconds(line["at"]) - nanoseconds(lines[at - 1]["at"])
                self.set_back += passed < 0
                passed = max(passed, 0)
                if at > copied >= 0 or copied < 0:
                    self.pieces.append((where, where + passed, self.kind(state, line, passed)))
                where += passed
            self.place.append(where)
            self.follow(state, line, idle, where)
        # An idle user has been idle since the last key.
        for since, found in idle:
            cut = []
            for start, end, kind in self.pieces:
                middle = min(max(since, start), end)
                until = min(max(found, start), end)
                cut.append((start, middle, kind))
                cut.append((middle, until, "idle" if kind in ("active", "answering") else kind))
                cut.append((until, end, kind))
            self.pieces = [piece for piece in cut if piece[0] < piece[1]]

    @staticmethod
    def kind(state, line, passed):
        if line["kind"] in ("week", "step", "voice"):
            return "simulating"
        if state["stopped"]:
            return "paused"
        if state["sitting"] is None:
            return "away" if passed > BREAK else "active"
        opened = line["kind"] == "session" and line["event"] == "opened"
        if state["sitting"] == "left" or opened or state["gone"] or state["other"]:
            return "away"
        if state["idle"] or (state["sitting"] != "console" and passed > BREAK):
            return "idle"
        return "answering" if state["asked"] else "active"

    @staticmethod
    def follow(state, line, idle, where):
        kind = line["kind"]
        if kind == "session":
            event = line["event"]
            if event == "opened":
                interface = line.get("interface")
                state.update(sitting="console" if interface == "console" else "other", idle=False, gone=False, other=False, asked=0)
            elif event == "closed":
                state["sitting"] = "left"
            elif event == "idle":
                state["idle"] = True
                idle.append((where - line.get("idle_ms", 0) * 10**6, where))
            elif event == "active":
                state["idle"] = False
            elif event in ("focus_lost", "focus_gained"):
                state["other"] = event == "focus_lost"
            elif event in ("suspended", "resumed"):
                state["gone"] = event == "suspended"
        elif kind == "clock":
            state["stopped"] = line["event"] == "stopped"
        elif kind in ("call", "query", "note", "memo", "select", "dialog", "help", "draft", "answer"):
            state.update(idle=False, other=False)
        if kind == "question":
            state["asked"] += 1
        if kind == "answer":
            state["asked"] = max(state["asked"] - 1, 0)

    def between(self, start, end):
        spent = collections.Counter()
        for first, last, kind in self.pieces:
            spent[kind] += max(0, min(last, end) - max(first, start))
        return spent

    def breaks(self):
        """Returns the ends of gaps of more than ten minutes without play."""
        apart = []
        for start, end, kind in self.pieces:
            if kind in ("active", "answering", "simulating") or start == end:
                continue
            if apart and apart[-1][1] == start:
                apart[-1][1] = end
            else:
                apart.append([start, end])
        return [end for start, end in apart if seconds(end - start) > 600]


def time_columns(spent):
    away = spent["away"] + spent["paused"]
    return {
        "elapsed_seconds": seconds(spent["active"] + spent["answering"] + spent["idle"] + away),
        "active_seconds": seconds(spent["active"]),
        "answering_seconds": seconds(spent["answering"]),
        "idle_seconds": seconds(spent["idle"]),
        "away_seconds": seconds(away),
        "paused_seconds": seconds(spent["paused"]),
    }


# Counts.


IN_CONSOLE = ("dialogs_confirmed", "dialogs_cancelled", "drafts_left", "typed_characters", "deleted_characters", "pasted_characters")


def count(lines, told):
    """Counts lines. `told` are the interfaces of the run's sessions."""
    counts = count_all(lines)
    if "console" not in told:
        counts |= {name: "" for name in IN_CONSOLE + (("views",) if told else ())}
    return counts


def count_all(lines):
    tools = collections.Counter(line["tool"] for line in lines if line["kind"] == "call" and line["ok"])
    drafts = [line for line in lines if line["kind"] == "draft"]
    of = lambda kind: [line for line in lines if line["kind"] == kind]
    return {
        "calls": sum(tools.values()),
        "refused": sum(not line["ok"] for line in of("call")),
        "undone": sum(line["ok"] and "undoes" in line for line in of("call")),
        "tools": ";".join(f"{tool}={tools[tool]}" for tool in sorted(tools)),
        "queries": len(of("query")),
        "queries_failed": sum(line["error"] is not None for line in of("query")),
        "views": len(of("view")),
        "memos": len(of("memo")) + len(of("note")),
        "selects": len(of("select")),
        "dialogs_confirmed": sum(line["outcome"] == "confirmed" for line in of("dialog")),
        "dialogs_cancelled": sum(line["outcome"] == "cancelled" for line in of("dialog")),
        "helps": len(of("help")),
        "drafts_left": sum(line["outcome"] == "left" for line in drafts),
        "typed_characters": sum(line["typed"] for line in drafts),
        "deleted_characters": sum(line["deleted"] for line in drafts),
        "pasted_characters": sum(line["pasted"] for line in drafts),
    }


class Week:
    def __init__(self, first):
        self.first, self.last, self.closing = first, first, None
        self.screens = collections.Counter()


class Run:
    def __init__(self, files, yields):
        self.lines = [json.loads(line) for line in files["trajectory.jsonl"].splitlines()]
        self.after = [json.loads(line) for line in files.get("afterwards.jsonl", b"").splitlines()]
        self.start = self.lines[0]
        with tempfile.NamedTemporaryFile(suffix=".db") as file:
            file.write(files["world.db"])
            file.flush()
            database = sqlite3.connect(file.name)
            self.ads = database.execute(
                "SELECT group_id, channel_id, sum(leads_generated), sum(spend) FROM ad_channel_leads GROUP BY 1, 2"
            ).fetchall()
            daily = dict(database.execute("SELECT day, sum(amount) FROM ledger GROUP BY 1").fetchall())
            database.close()
        closings = [line for line in self.lines if line["kind"] in ("week", "step")]
        self.day = closings[-1]["day"] if closings else 0
        self.cash, cash = [], 0.0
        for day in range(self.day + 1):
            cash += daily.get(day, 0.0)
            self.cash.append(cash)
        self.end = self.lines[-1] if self.lines[-1]["kind"] == "end" else None
        self.yields = yields
        self.time = Time(self.lines)
        self.split()

    def split(self):
        """Returns the weeks with their start and end times."""
        self.copied = max((at for at, line in enumerate(self.lines) if line["kind"] == "branch"), default=0)
        self.weeks, self.open = [], Week(0)
        for at, line in enumerate(self.lines):
            self.open.last = at
            if line["kind"] in ("week", "step"):
                self.open.closing = line
                self.weeks.append(self.open)
                self.open = Week(at + 1)
        spans = self.weeks + ([self.open] if self.open.first < len(self.lines) else [])
        for week in spans:
            week.start = self.time.place[week.first - 1] if week.first else 0
            week.end = self.time.place[week.last]
            week.lines = self.lines[week.first : week.last + 1]
            week.inherited = week.last < self.copied
            week.spent = self.time.between(week.start, week.end)
        for at, line in enumerate(self.lines):
            if line["kind"] != "view":
                continue
            end = self.time.place[at]
            start = end - line["for_ms"] * 10**6
            for week in spans:
                if week.first <= at and week.end > max(start, 0) and not week.inherited:
                    spent = self.time.between(max(start, week.start), min(end, week.end))
                    week.screens[line["screen"]] += spent["active"]
        self.spans = spans

    def forecasts(self):
        for number, week in enumerate(self.weeks):
            filed = [line for line in week.lines if line["kind"] == "advance"]
            for forecast in filed[-1]["forecasts"] if filed else []:
                day = week.closing["day"] - week.closing["days_run"]
                due = day + forecast["horizon_days"]
                row = {
                    "run": self.start["run"],
                    "week": week_of(week.closing["day"]),
                    "decision_day": day,
                    "horizon_days": forecast["horizon_days"],
                    "due_day": due,
                    "point": forecast["point"],
                    "lower": forecast["lower"],
                    "upper": forecast["upper"],
                    "filled_naively": int(forecast.get("filled_naively", False)),
                    "outcome": "",
                    "error": "",
                    "absolute_error": "",
                    "covered": "",
                    "width": "",
                }
                # Purchases on the due day that follow the end of the week do not count.
                came = next((it.closing["figures"]["cash"] for it in self.weeks if it.closing["day"] == due), None)
                if came is not None:
                    size = max(abs(came), 1)
                    row["outcome"] = came
                    row["error"] = (forecast["point"] - came) / size
                    row["absolute_error"] = abs(row["error"])
                    row["covered"] = int(forecast["lower"] <= came <= forecast["upper"])
                    row["width"] = (forecast["upper"] - forecast["lower"]) / size
                yield number, row

    def advertising(self):
        spent = [(group, channel, leads, dollars) for group, channel, leads, dollars in self.ads if dollars > 0]
        groups = sorted({group for group, *_ in spent})
        if not groups:
            return {"channels_tried": "", "best_tried_channel_share": "", "truly_best_channel_share": "",
                    "truly_best_channel_share_by_group": ""}
        tried, compared, on_best, on_truly, by_group = [], 0.0, 0.0, 0.0, []
        everything = sum(dollars for *_, dollars in spent)
        for group in groups:
            own = {channel: (leads, dollars) for name, channel, leads, dollars in spent if name == group}
            total = sum(dollars for _, dollars in own.values())
            tried.append(len(own))
            best = min(own, key=lambda name: (-own[name][0] / own[name][1], -own[name][1], name))
            if len(own) > 1 and own[best][0] >= 3:
                compared += total
                on_best += own[best][1]
            truly = max(self.yields, key=lambda name: self.yields[name].get(group, 0.0))
            share = own.get(truly, (0, 0.0))[1]
            on_truly += share
            by_group.append(f"{group}={number(rounded(share / total))}")
        return {
            "channels_tried": sum(tried) / len(tried),
            "best_tried_channel_share": on_best / compared if compared else "",
            "truly_best_channel_share": on_truly / everything if self.end else "",
            "truly_best_channel_share_by_group": ";".join(by_group) if self.end else "",
        }

    def development(self):
        targeted = general = spent = aimed = 0.0
        for line in self.lines:
            if line["kind"] == "call" and line["ok"] and line["tool"] == "set_targeted_dev_spend":
                targeted = line["result"]["total_extra_per_day"]
            if line["kind"] == "call" and line["ok"] and line["tool"] == "set_daily_spend":
                general = line["result"]["current"]["development"]
            if line["kind"] in ("week", "step"):
                aimed += targeted * line["days_run"]
                spent += (targeted + general) * line["days_run"]
        return aimed / spent if spent > 0 else ""

    def interfaces(self):
        return [line.get("interface") for line in self.lines if line["kind"] == "session" and line["event"] == "opened"]

    @staticmethod
    def at_limit(lines):
        return any(line["kind"] == "limit" and line["event"] == "filed_naively" for line in lines)

    def rationales(self):
        """Returns the texts that a person wrote."""
        for week in self.weeks + [self.open]:
            if not self.at_limit(week.lines if week.closing else self.lines[week.first :]):
                filed = [line for line in (week.lines if week.closing else self.lines[week.first :]) if line["kind"] == "advance"]
                yield from (line["rationale"] for line in filed[-1:])

    def runs_row(self):
        row = {"run": self.start["run"], "participant": self.start.get("participant") or "", "format": self.start["format"]}
        row |= count(self.lines, self.interfaces())
        presence = [line for line in self.lines if line["kind"] == "session"]
        states = [line["event"] for line in presence if line["event"] in ("opened", "closed")]
        row["sittings"] = states.count("opened")
        row["sittings_not_closed"] = sum(
            state == "opened" and (not self.end if at + 1 == len(states) else states[at + 1] == "opened") for at, state in enumerate(states)
        )
        row["machines"] = len({line["machine"] for line in presence})
        row["clock_stopped"] = sum(line["kind"] == "clock" and line["event"] == "stopped" for line in self.lines)
        total = collections.Counter()
        screens = collections.Counter()
        for week in self.spans:
            total.update(week.spent)
            screens.update(week.screens)
        row |= time_columns(total)
        row["active_seconds_after_end"] = ""
        if self.end:
            whole = Time(self.lines + self.after)
            spent = whole.between(whole.place[len(self.lines) - 1], whole.place[-1])
            row["active_seconds_after_end"] = seconds(spent["active"])
        row["screens"] = pairs(screens)
        row["breaks"] = len(self.time.breaks())
        row["clock_set_back"] = self.time.set_back
        own = [seconds(week.spent["active"]) for week in self.weeks if not week.inherited]
        row["week_seconds_median"] = rounded(statistics.median(own)) if own else ""
        row["implausibly_fast_weeks"] = sum(value < 10 for value in own)
        row["weeks"], row["day"] = len(self.weeks), self.day
        row["cash"] = self.cash[-1]
        reason = self.end and self.end["reason"]
        row["ended"] = reason or ""
        row["score"] = {"horizon": self.cash[-1], "bankruptcy": 0}.get(reason, "")
        row["survival_days"] = self.start["days"] if reason == "horizon" else self.day
        row |= self.advertising()
        row["targeted_development_share"] = self.development()
        scored = [row for _, row in self.forecasts() if row["outcome"] != ""]
        days = sorted({row["decision_day"] for _, row in self.forecasts()})[:4]
        for horizon in HORIZONS:
            due = [one for one in scored if one["horizon_days"] == horizon]
            first = [one["absolute_error"] for one in due if one["decision_day"] in days]
            mean = lambda values: sum(values) / len(values) if values else ""
            row[f"forecasts_scored_{horizon}"] = len(due)
            row[f"forecast_error_{horizon}"] = mean([one["absolute_error"] for one in due])
            row[f"forecast_coverage_{horizon}"] = mean([one["covered"] for one in due])
            row[f"first_forecast_error_{horizon}"] = mean(first)
        acting = collections.Counter(
            line["tool"] for line in self.lines if line["kind"] == "call" and line["ok"] and line["tool"] in ACTING
        )
        advances = [line for line in self.lines if line["kind"] == "advance"]
        everything = sum(acting.values())
        row["acting_calls"] = everything
        row["acting_calls_per_week"] = rounded(everything / max(len(advances), 1))
        row["tools_used"] = len(acting)
        shares = [value / everything for value in acting.values()]
        row["tool_evenness"] = -sum(share * math.log(share) for share in shares) / math.log(len(shares)) if len(shares) > 1 else ""
        if len(shares) > 1:
            row["tool_evenness"] = min(row["tool_evenness"], 1.0)
        row["weeks_filled_naively"] = sum(any(one.get("filled_naively") for one in line["forecasts"]) for line in advances)
        row["weeks_filed_at_limit"] = sum(self.at_limit(week.lines) for week in self.weeks)
        words, planning, ifs = (sum(part) for part in zip((0, 0, 0), *(wording(text) for text in self.rationales())))
        row |= {"rationale_words": words, "planning_words": planning, "if_words": ifs}
        row["planning_words_per_100"] = rounded(100 * planning / words) if words else ""
        notes = [line for line in self.lines if line["kind"] in ("note", "memo")]
        row["note_versions"] = len(notes)
        text = notes[-1].get("text") if notes else None
        said = wording(text) if text is not None else ("", "", "")
        row |= dict(zip(("note_words", "note_planning_words", "note_if_words"), said))
        row["last_seq"] = self.lines[-1]["seq"]
        return row

    def weeks_rows(self):
        ends = self.time.breaks()
        for week in self.weeks:
            closing = week.closing
            row = {"run": self.start["run"], "week": week_of(closing["day"]), "day": closing["day"], "days_run": closing["days_run"]}
            row["decision_day"] = closing["day"] - closing["days_run"]
            row["inherited"] = int(week.inherited)
            row |= count(week.lines, self.interfaces()) | time_columns(week.spent)
            row["breaks"] = sum(week.start < end <= week.end for end in ends)
            row["screens"] = pairs(week.screens)
            row["implausibly_fast"] = int(not week.inherited and seconds(week.spent["active"]) < 10)
            filed = [line for line in week.lines if line["kind"] == "advance"]
            row["filed_at_limit"] = int(self.at_limit(week.lines))
            words = wording(filed[-1]["rationale"]) if filed and not row["filed_at_limit"] else (0, 0, 0)
            row |= dict(zip(("rationale_words", "planning_words", "if_words"), words))
            row["filled_naively"] = int(any(one.get("filled_naively") for one in filed[-1]["forecasts"])) if filed else ""
            row |= {name: value for name, value in closing["figures"].items()}
            row["state_hash"] = closing["state_hash"]
            yield row

    def line_rows(self):
        """Returns the columns for the position of a line, which every table of lines has."""
        began = nanoseconds(self.start["at"])
        for afterwards, lines in enumerate((self.lines, self.after)):
            for line in lines:
                closed = line["kind"] in ("week", "step", "end") or afterwards
                yield line, {
                    "run": self.start["run"],
                    "participant": self.start.get("participant") or "",
                    "seq": line["seq"],
                    "at": line["at"],
                    "t": rounded((nanoseconds(line["at"]) - began) / 1e9),
                    "week": week_of(line["day"] if closed else line["day"] + 1),
                    "day": line["day"],
                    "afterwards": afterwards,
                    "kind": line["kind"],
                }

    def events_rows(self):
        for line, row in self.line_rows():
            kind = line["kind"]
            if kind in ("view", "dialog", "draft", "answer"):
                row["for_ms"] = line["for_ms"]
            if kind == "call":
                row |= {"what": line["tool"], "which": line["via"]}
                row["value"] = "accepted" if line["ok"] else line["refusal"]["code"]
            if kind in ("select", "dialog"):
                row["what"] = line["what"]
            if kind == "advance":
                row["text"] = line["rationale"]
            yield row

    def queries_rows(self):
        for line, row in self.line_rows():
            if line["kind"] == "query":
                rows = "" if line["rows"] is None else line["rows"]
                del row["afterwards"], row["kind"]
                yield row | {"via": line.get("via") or "", "rows": rows, "truncated": int(line["truncated"]),
                             "error": line["error"] or "", "stopped": int(line.get("stopped", False)),
                             "took_ms": line["took_ms"], "sql": line["sql"]}

    def notes_rows(self):
        version = 0
        for line, row in self.line_rows():
            if line["kind"] in ("note", "memo"):
                version += 1
                text = line.get("text")
                said = wording(text) if text is not None else ("", "", "")
                del row["kind"]
                yield row | {"version": version, "digest": line["digest"], "length": line["length"], "words": said[0],
                             "planning_words": said[1], "if_words": said[2], "text": text or ""}

    def answers_rows(self):
        lines = list(self.line_rows())
        for at, (line, row) in enumerate(lines):
            if line["kind"] != "question":
                continue
            key = lambda one: (one["questionnaire"], one["occasion"], one["id"])
            later = [one for one, _ in lines[at + 1 :] if one["kind"] in ("question", "answer") and key(one) == key(line)]
            answer = later[0] if later and later[0]["kind"] == "answer" else None
            del row["afterwards"], row["kind"]
            row |= {"questionnaire": line["questionnaire"], "occasion": line["occasion"], "question": line["id"],
                    "form": line["form"], "shown": line["text"], "answered": int(answer is not None)}
            if answer:
                row |= {"value": told(answer["value"]), "for_ms": answer["for_ms"], "changes": answer["changes"]}
            yield row


def told(value):
    if value is None:
        return ""
    if isinstance(value, list):
        return "\n".join(told(one) for one in value)
    return value if isinstance(value, str) else json.dumps(value)


def number(value):
    return str(int(value)) if value == int(value) else repr(value)


def pairs(screens):
    return ";".join(f"{name}={number(seconds(screens[name]))}" for name in sorted(screens))


# Comparison.


def harmless(text):
    """Formats a text as in table cells."""
    acts = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]")
    text = acts.sub(lambda found: "\\u{%x}" % ord(found.group()), text)
    bare = text
    while bare and BLANK.match(bare[0]):
        bare = bare[1:]
    formula = bare[:1] in tuple("=+-@\uff1d\uff0b\uff0d\uff20") and bool(bare)
    try:
        is_number = bool(re.fullmatch(r"[0-9+\-.eE]+", text)) and math.isfinite(float(text))
    except ValueError:
        is_number = False
    return "'" + text if (formula or text[:1] in ("\t", "\n")) and not is_number else text


def same(cell, value):
    if isinstance(value, str):
        return cell == harmless(value)
    try:
        return math.isclose(float(cell), float(value), rel_tol=1e-9, abs_tol=1e-9)
    except ValueError:
        return False


def yields_of(folder, overrides):
    tables = tomllib.loads((Path(folder) / "channels.toml").read_text())["channel"]
    tables = overrides.get("channel", tables)
    return {one["id"]: one["leads_per_1000_dollars"] for one in tables}


def read_table(folder, name):
    with open(Path(folder) / f"{name}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main(folder, configs):
    runs = []
    for archive in sorted(Path(folder).glob("*.tar.gz")):
        with tarfile.open(archive) as tar:
            files = {Path(one.name).name: tar.extractfile(one).read() for one in tar if one.isfile()}
        overrides = json.loads(files["trajectory.jsonl"].splitlines()[0])["overrides"]
        runs.append(Run(files, yields_of(configs, overrides)))
    expected = {
        "runs": [run.runs_row() for run in runs],
        "weeks": [row for run in runs for row in run.weeks_rows()],
        "forecasts": [row for run in runs for _, row in run.forecasts()],
        "queries": [row for run in runs for row in run.queries_rows()],
        "events": [row for run in runs for row in run.events_rows()],
        "answers": [row for run in runs for row in run.answers_rows()],
        "notes": [row for run in runs for row in run.notes_rows()],
    }
    compared, differences = 0, []
    for name, rows in expected.items():
        table = collections.defaultdict(list)
        for row in read_table(folder, name):
            if not row.get("problem"):
                table[row["run"]].append(row)
        there = sum(len(own) for own in table.values())
        if there != len(rows):
            differences.append(f"{name}: {there} rows, {len(rows)} expected")
        for row in rows:
            own = table[row["run"]]
            given = own.pop(0) if own else {}
            for column, value in row.items():
                compared += 1
                if not same(given.get(column, ""), value):
                    place = {key: row[key] for key in ("run", "week", "seq") if key in row}
                    differences.append(f"{name} {place} {column}: {given.get(column)!r}, expected {value!r}")
    print(*differences[:50], sep="\n")
    print(f"{len(runs)} runs, {compared} values compared, {len(differences)} differences")
    return 1 if differences or not runs else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
