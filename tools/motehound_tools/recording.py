"""Everything that LCM told of some runs, in tables by simulated time, while it still arrives.

One thread takes messages, others read: a table's snapshot stays as it is whatever is appended later.
"""

from __future__ import annotations

import math
import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from . import messages
from .event_log import EventLog
from .failure import Failure

GROUP_MAX = 4  # targets in a group
TIME_MAX_S = 1e9  # beyond it a time is damage


class Table:
    """Rows with a field `time`, in order of time for whoever reads."""

    def __init__(self, fields: list[tuple[str, str]]) -> None:
        self._rows = np.zeros(64, dtype=[("time", "f8"), *fields])
        self._count = 0
        self._ordered = True
        self._snapshot = self._rows[:0]

    def __len__(self) -> int:
        return self._count

    def append(self, row: tuple[Any, ...]) -> None:
        if self._count == len(self._rows):
            grown = np.zeros(2 * self._count, self._rows.dtype)
            grown[: self._count] = self._rows
            self._rows = grown
        self._rows[self._count] = row
        if self._count and row[0] < self._rows["time"][self._count - 1]:
            self._ordered = False
        self._count += 1

    def snapshot(self) -> np.ndarray:
        count = self._count
        if len(self._snapshot) != count:
            rows = self._rows[:count]
            self._snapshot = rows if self._ordered else rows[np.argsort(rows["time"], kind="stable")]
        return self._snapshot

    def until(self, time_s: float) -> np.ndarray:
        rows = self.snapshot()
        return rows[: np.searchsorted(rows["time"], time_s, "right")]

    def between(self, after_s: float, until_s: float) -> np.ndarray:
        rows = self.snapshot()
        first, last = np.searchsorted(rows["time"], (after_s, until_s), "right")
        return rows[first:last]


class Run:
    def __init__(self, number: int) -> None:
        self.number = number
        self.scenario = ""
        self.seed: int | None = None
        self.end_s = 0.0  # the newest time that was told
        self.over = False
        self.totals: dict[str, float] = {}
        self.places: dict[int, tuple[float, float]] = {}
        self.frames = Table([("sender", "i4"), ("destination", "i4"), ("kind", "u1")])
        self.truth = Table([("target", "i4"), ("present", "?"), ("x", "f8"), ("y", "f8")])
        self.targets = 0  # that there truly are
        self.numbers: dict[int, int] = {}  # the true target that each one followed was first taken for
        self.track = Table(
            [
                *((name, "i4") for name in ("target", "mode", "members", "flags", "head")),
                ("of", "i4", (GROUP_MAX,)),
                *((name, "f8") for name in ("x", "y", "xx", "xy", "yy", "extent", "true_x", "true_y", "error")),
            ]
        )
        self.watch = Table(
            [
                *((name, "i4") for name in ("target", "head", "prince", "members")),
                *((name, "f8") for name in ("prince_s", "x", "y", "vx", "vy", "sd", "extent")),
            ]
        )
        self.sink = Table([("x", "f8"), ("y", "f8"), ("error", "f8")])  # what the sink has of the target
        self.clusters = Table([("track", "i4"), ("head", "i4"), ("members", "i4")])  # the last: which entry of the next
        self.members: list[tuple[int, ...]] = []
        self.motes = Table([("node", "i4"), ("energy", "f8"), ("battery", "f8"), ("alive", "?"), ("clock_error", "f8")])


class Recording:
    """Give every event's data to `take`."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.runs: dict[int, Run] = {}
        self.kinds: dict[str, int] = {}  # of frames, and the number that stands for each
        self.newest = 0  # the run that was told of last
        self.share = 1.0  # of a log, read so far
        self.broken = 0
        self.unknown = 0

    def take(self, data: bytes) -> None:
        if not data:  # a greeting, which says nothing
            return
        try:
            message = messages.decode(data)
        except messages.Broken:
            self.broken += 1
            return
        if message is None:
            self.unknown += 1
            return
        told = getattr(self, f"_{type(message).__name__}", None)
        if told is None:  # ours, but nothing to see
            return
        if not 0.0 <= message.time_s <= TIME_MAX_S:
            self.broken += 1
            return
        if message.run not in self.runs:
            self.runs[message.run] = Run(message.run)
        run = self.runs[message.run]
        self.newest = message.run
        run.end_s = max(run.end_s, message.time_s)
        told(run, message)

    def _run_begin_t(self, run: Run, begin: Any) -> None:
        if run.over:  # the same number again: another simulation on the bus
            run = self.runs[begin.run] = Run(begin.run)
        run.scenario, run.seed = begin.scenario, begin.seed

    def _node_t(self, run: Run, node: Any) -> None:
        if math.isfinite(node.x_m) and math.isfinite(node.y_m):
            run.places[node.node] = (node.x_m, node.y_m)

    def _frame_t(self, run: Run, frame: Any) -> None:
        kind = self.kinds.setdefault(messages.radio_kind(frame), len(self.kinds))
        run.frames.append((frame.time_s, frame.sender, frame.destination, kind))

    def _truth_t(self, run: Run, truth: Any) -> None:
        run.truth.append((truth.time_s, truth.target, truth.present, truth.x_m, truth.y_m))
        run.targets = max(run.targets, truth.target + 1)

    def _track_t(self, run: Run, track: Any) -> None:
        true = (track.true_x_m, track.true_y_m) if track.true_known else (math.nan, math.nan)
        error = math.hypot(track.x_m - true[0], track.y_m - true[1])
        if track.head == messages.SINK:
            run.sink.append((track.time_s, track.x_m, track.y_m, error))
            return
        covariance = (track.cov_xx_m2, track.cov_xy_m2, track.cov_yy_m2)
        if track.number >= 0:
            run.numbers.setdefault(track.target, track.number)
        how = (track.mode, track.members, track.flags, track.head, tuple(track.of))
        place = (track.x_m, track.y_m, *covariance, track.extent_m)
        run.track.append((track.time_s, track.target, *how, *place, *true, error))

    def _watch_t(self, run: Run, watch: Any) -> None:
        if watch.number >= 0:
            run.numbers.setdefault(watch.target, watch.number)
        who = (watch.target, watch.head, watch.prince, watch.members)
        place = (watch.x_m, watch.y_m, watch.vx_mps, watch.vy_mps, watch.sd_m, watch.extent_m)
        run.watch.append((watch.time_s, *who, watch.prince_s, *place))

    def _cluster_t(self, run: Run, cluster: Any) -> None:
        run.members.append(tuple(cluster.members))
        run.clusters.append((cluster.time_s, cluster.track, cluster.head, len(run.members) - 1))

    def _mote_t(self, run: Run, mote: Any) -> None:
        run.motes.append((mote.time_s, mote.node, mote.energy_mj, mote.battery_left, mote.alive, mote.clock_error_ms))

    def _totals_t(self, run: Run, totals: Any) -> None:
        run.totals.update(zip(totals.names, totals.values))

    def _run_end_t(self, run: Run, end: Any) -> None:
        run.over = True
        run.totals.update(frames_received=end.frames_received, frames_lost=end.frames_lost)


def of_log(path: Path) -> Recording:
    """The recording of a log, read by a thread of its own."""
    log = EventLog(path)
    recording = Recording(str(path))
    recording.share = 0.0

    def read() -> None:
        for event in log:
            recording.take(event.data)
            recording.share = log.share
        recording.broken += log.broken
        recording.share = 1.0

    threading.Thread(target=read, daemon=True, name="log").start()
    return recording


@contextmanager
def quiet() -> Iterator[None]:
    """Without LCM's own lines on standard error."""
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def of_bus(url: str) -> Recording:
    """The recording of what is on the bus from now on, taken by a thread of its own."""
    import lcm

    try:
        with quiet():
            bus = lcm.LCM(url)
    except (RuntimeError, ValueError) as error:
        example = "udpm://239.255.76.67:7667?ttl=0 (which needs a multicast route)"
        raise Failure(f"--bus {url}: expected a URL that LCM serves, such as {example}") from error
    recording = Recording(url)
    heard = bus.subscribe("MOTEHOUND_(?!WORKER_).*", lambda _, data: recording.take(data))
    heard.set_queue_capacity(0)  # without limit: a simulation tells faster than it is drawn

    def follow() -> None:
        while True:
            bus.handle()

    threading.Thread(target=follow, daemon=True, name="bus").start()
    return recording
