#!/usr/bin/env python3
"""Measures a host with many participants: time from key to frame, bytes, and memory.

    python3 -m pip install websockets
    tests/bench/hosted_load.py NOVAMIND --clients 50 --seconds 240

The script creates a study, starts the host, and connects one client per participant. Each client presses a key every two
seconds and plays a week every two minutes. Times are measured in this script, so they include its own delays.
"""

import argparse
import asyncio
import csv
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import tempfile
import time

import websockets

WEEK_KEYS = ["n", "\r", "load", "\r", "f", "\r"]
ACTION_SECONDS, WEEK_SECONDS = 2, 120
STUDY = 'name = "load"\ntitle = "A company"\n[seeds]\nplan = "secret"\ncount = 1\n[practice]\noffer = "none"\n'


class Client:
    """One participant: counts bytes and measures the time until the first frame after a key."""

    def __init__(self, label, socket):
        self.label, self.socket, self.number = label, socket, 0
        self.received, self.sent, self.text = 0, 0, ""
        self.frame = asyncio.Event()
        self.latencies, self.key_bytes, self.week_bytes = [], [], []

    async def read(self):
        async for message in self.socket:
            self.received += len(message) if isinstance(message, bytes) else len(message.encode())
            if isinstance(message, bytes):
                self.text = (self.text + message.decode(errors="replace"))[-200_000:]
                self.frame.set()
                await self.send({"type": "displayed", "bytes": self.displayed(message)})
            elif json.loads(message)["type"] == "alive":
                await self.send({"type": "alive"})
            elif json.loads(message)["type"] == "closed":
                raise SystemExit(f"{self.label}: {message}")

    def displayed(self, message):
        self.shown = getattr(self, "shown", 0) + len(message)
        return self.shown

    async def send(self, message):
        text = json.dumps(message)
        self.sent += len(text)
        await self.socket.send(text)

    async def press(self, key, counts=True):
        """Presses a key and waits for its first frame."""
        self.frame.clear()
        self.number += 1
        before, start = self.received, time.perf_counter()
        await self.send({"type": "input", "number": self.number, "text": key})
        try:
            await asyncio.wait_for(self.frame.wait(), 5)
        except asyncio.TimeoutError:
            return  # The key did not change the screen.
        if counts:
            self.latencies.append(time.perf_counter() - start)
            await asyncio.sleep(0.5)
            self.key_bytes.append(self.received - before)

    async def start(self):
        """Agrees to the consent text and starts the session."""
        for _ in range(40):
            if re.search("SESSION|Action needed", re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", self.text)):
                return
            for key in ["\x1b[F", "y", "\r"]:
                await self.press(key, counts=False)
                await asyncio.sleep(0.3)
        raise SystemExit(f"{self.label}: the session does not start")

    async def week(self):
        before = self.received
        for key in WEEK_KEYS:
            await self.press(key, counts=False)
            await asyncio.sleep(0.3)
        await asyncio.sleep(3)
        await self.press("\r", counts=False)
        self.week_bytes.append(self.received - before)

    async def play(self, seconds, draw):
        await asyncio.sleep(draw.random() * ACTION_SECONDS)
        start, next_week = time.monotonic(), time.monotonic() + draw.random() * WEEK_SECONDS
        while time.monotonic() - start < seconds:
            if time.monotonic() >= next_week:
                next_week += WEEK_SECONDS
                await self.week()
            begin = time.monotonic()
            await self.press(draw.choice("1234567890"))
            await asyncio.sleep(max(0, ACTION_SECONDS - (time.monotonic() - begin)))


def memory_of_children(host):
    """Returns the proportional set size in MB of the host and of each session process."""
    sizes = {}
    for folder in pathlib.Path("/proc").iterdir():
        if not folder.name.isdigit():
            continue
        try:
            parent = int((folder / "stat").read_text().rsplit(")", 1)[1].split()[1])
            if int(folder.name) == host or parent == host:
                line = re.search(r"^Pss:\s+(\d+)", (folder / "smaps_rollup").read_text(), re.M)
                sizes[int(folder.name)] = int(line[1]) / 1024
        except (OSError, TypeError):
            continue
    return sizes.pop(host, 0), sorted(sizes.values())


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else float("nan")


async def run(options):
    program = str(pathlib.Path(options.program).resolve())
    folder = pathlib.Path(tempfile.mkdtemp(prefix="novamind-load-")) / "load"
    command = lambda *arguments: subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL)
    command("study", "new", folder)
    for file in (folder / "questions").iterdir():
        file.unlink()
    (folder / "study.toml").write_text(STUDY)
    command("study", "assign", folder, "--participants", str(options.clients))
    command("study", "key", folder)
    command("host", "links", folder, "--csv", folder / "links.csv")
    host = subprocess.Popen([program, "--study", folder, "host", "--listen", "127.0.0.1:0"], stdout=subprocess.PIPE, text=True)
    try:
        address = next(match[1] for line in host.stdout if (match := re.search(r"http://(127\.0\.0\.1:\d+)", line)))
        rows = list(csv.DictReader((folder / "links.csv").open()))
        clients = []
        for row in rows:
            headers = {"Cookie": "novamind-session=" + row["link"].rsplit("/", 1)[1]}
            socket = await websockets.connect(
                f"ws://{address}/socket", origin=f"http://{address}", additional_headers=headers, max_size=None, compression=None
            )
            client = Client(row["label"], socket)
            hello = {"type": "hello", "label": row["label"], "client": "load", "resume": False, "columns": 120, "rows": 40}
            await client.send(hello)
            clients.append(client)
        readers = [asyncio.create_task(client.read()) for client in clients]
        for client in clients:
            await client.start()
        busy = lambda: sum(os.sysconf("SC_CLK_TCK") ** -1 * int(x) for x in pathlib.Path(f"/proc/{host.pid}/stat").read_text().rsplit(")", 1)[1].split()[11:13])
        cpu, start = busy(), time.monotonic()
        await asyncio.gather(*(client.play(options.seconds, random.Random(client.label)) for client in clients))
        cpu, elapsed = busy() - cpu, time.monotonic() - start
        own, sizes = memory_of_children(host.pid)
        latencies = [1000 * value for client in clients for value in client.latencies]
        keys = [value for client in clients for value in client.key_bytes]
        weeks = [value for client in clients for value in client.week_bytes]
        print(f"clients                  {len(clients)}, sessions {len(sizes)}")
        print(f"keys measured            {len(latencies)}, weeks {len(weeks)}")
        print(f"key to first frame, ms   p50 {percentile(latencies, 0.5):.1f}, p99 {percentile(latencies, 0.99):.1f}, max {max(latencies):.1f}")
        print(f"bytes per key            p50 {percentile(keys, 0.5)}, p99 {percentile(keys, 0.99)}")
        print(f"bytes per week           p50 {percentile(weeks, 0.5)}, p99 {percentile(weeks, 0.99)}")
        print(f"bytes per second, all    {sum(client.received for client in clients) / elapsed:.0f}")
        print(f"memory, MB               host {own:.0f}, session p50 {percentile(sizes, 0.5):.0f}, max {max(sizes):.0f}")
        print(f"CPU of the host          {100 * cpu / elapsed:.1f} % of one core")
        for reader in readers:
            reader.cancel()
    finally:
        host.send_signal(signal.SIGTERM)
        host.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--clients", type=int, default=50)
    parser.add_argument("--seconds", type=int, default=240)
    asyncio.run(run(parser.parse_args()))


main()
