#!/usr/bin/env python3
"""follow_workers.py [URL]: listens to the workers of a run (docs/workers.md) and tells, when the run is over, what each was asked and what
it answered. Needs the package `lcm` and the program lcm-gen; ends with the run, or after 30 s of silence (environment: SECONDS_OF_SILENCE)."""

import importlib
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import lcm

TYPES = Path(__file__).resolve().parent.parent / "lcm_types" / "motehound_worker.lcm"

with tempfile.TemporaryDirectory() as folder:
    subprocess.run(["lcm-gen", "-p", "--ppath", folder, str(TYPES)], check=True, stdout=subprocess.DEVNULL)
    sys.path.insert(0, folder)
    motehound = importlib.import_module("motehound")

asked: dict[int, Counter] = {}  # by worker: how often what
seen: set[tuple[int, int]] = set()  # requests by worker and number, answers by worker and minus number
over = False


def count(worker: int, number: int, what: str, size: int = 0) -> bool:
    """False if this has come before: the datagram was sent again."""
    counter = asked.setdefault(worker, Counter())
    again = (worker, number) in seen
    seen.add((worker, number))
    counter[what] += 1
    counter["again"] += again
    return not again


def on_request(channel: str, data: bytes) -> None:
    kind = channel.rsplit("_", 1)[1]
    message = getattr(motehound, f"worker_{kind.lower()}_t").decode(data)
    if count(message.worker, message.number, kind.lower()) and kind == "WINDOW":
        asked[message.worker]["events"] += message.count


def on_done(channel: str, data: bytes) -> None:
    message = motehound.worker_done_t.decode(data)
    if count(message.worker, -message.number, "answers"):
        asked[message.worker]["actions"] += message.count
        asked[message.worker]["frames"] += sum(action.kind == 0 for action in message.actions)


def on_release(channel: str, data: bytes) -> None:
    global over
    motehound.worker_release_t.decode(data)
    over = True


bus = lcm.LCM(sys.argv[1] if len(sys.argv) > 1 else "udpm://239.255.76.67:7667?ttl=0")
for channel, handler in {
    "MOTEHOUND_WORKER_[0-9a-f]{16}_(ASSIGN|MOTES|WINDOW|COUNT)": on_request,
    "MOTEHOUND_WORKER_DONE": on_done,
    "MOTEHOUND_WORKER_RELEASE": on_release,
}.items():
    bus.subscribe(channel, handler).set_queue_capacity(0)
print("listening", flush=True)
heard, patience = time.monotonic(), float(os.environ.get("SECONDS_OF_SILENCE", 30))
while not over and time.monotonic() - heard < patience:
    if bus.handle_timeout(200):
        heard = time.monotonic()
COLUMNS = "assign", "motes", "window", "events", "answers", "actions", "frames", "count", "again"
print(f"{'worker':16}", *(f"{name:>8}" for name in COLUMNS))
for worker, counter in sorted(asked.items()):
    print(f"{worker:016x}", *(f"{counter[name]:8}" for name in COLUMNS))
