"""A recording for rerun: every run a branch of its own, over the simulated time."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from . import messages
from .failure import Failure

TIMELINE = "time"
AIR_S = 0.1  # frames that begin within so long are shown together
MOTE_M, SOURCE_M = 0.3, 0.6
QUIET, TRUTH, TRACK = (140, 148, 160), (0, 158, 115), (0, 114, 178)
KINDS = {"beacon": (140, 148, 160), "report": (0, 114, 178), "request": (230, 159, 0)}
OTHER = (204, 121, 167)
CLUSTER = (230, 159, 0)
EMPTY, FULL = np.array([68, 1, 84]), np.array([253, 231, 37])  # the ends of viridis
DEAD = (213, 94, 0)


def circle(track: Any, deviations: float = 2.0) -> np.ndarray:
    """The ellipse of so many standard deviations around an estimate, closed."""
    values, vectors = np.linalg.eigh([[track.cov_xx_m2, track.cov_xy_m2], [track.cov_xy_m2, track.cov_yy_m2]])
    angle = np.linspace(0.0, 2.0 * math.pi, 49)
    unit = np.sqrt(np.maximum(values, 0.0))[:, None] * np.array([np.cos(angle), np.sin(angle)])
    x, y = deviations * vectors @ unit
    return np.column_stack((track.x_m + x, track.y_m + y, np.zeros_like(x)))


class Writer:
    def __init__(self, out: Path) -> None:
        try:
            import rerun
        except ImportError:
            raise Failure("rerun: its package is not installed; tools/setup rerun does it (about 750 MB)") from None
        self.rerun = rerun
        self.stream = rerun.RecordingStream("motehound")
        self.stream.save(str(out))
        self.stream.log("/", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        self.places: dict[int, dict[int, tuple[float, float, float]]] = defaultdict(dict)
        self.shown: set[int] = set()
        self.air: dict[tuple[int, str], list[np.ndarray]] = defaultdict(list)
        self.air_began = 0.0
        self.motes: dict[int, dict[int, Any]] = defaultdict(dict)  # newest motehound.mote_t of each mote
        self.motes_time: dict[int, float] = {}

    def at(self, time_s: float) -> None:
        self.stream.set_time(TIMELINE, duration=time_s)

    def log(self, run: int, path: str, what: Any, static: bool = False) -> None:
        self.stream.log(f"run_{run}/{path}", what, static=static)

    def take(self, message: Any) -> None:
        kind = type(message).__name__
        time_s = getattr(message, "time_s", math.nan)
        if not math.isfinite(time_s):
            return
        if kind in ("frame_t", "run_end_t"):
            self.land(time_s, kind == "run_end_t")
        take = getattr(self, kind, None)
        if take is not None:
            if kind != "node_t":
                self.show(message.run)
            take(message)

    def node_t(self, node: Any) -> None:
        self.places[node.run][node.node] = (node.x_m, node.y_m, node.z_m)

    def show(self, run: int) -> None:
        """The motes, once: they are told before all that needs them."""
        if run in self.shown or not self.places[run]:
            return
        self.shown.add(run)
        places = np.array(list(self.places[run].values()))
        self.log(run, "motes", self.rerun.Points3D(places, radii=MOTE_M, colors=QUIET), static=True)

    def truth_t(self, truth: Any) -> None:
        self.at(truth.time_s)
        places = [(truth.x_m, truth.y_m, 0.0)] if truth.present else []
        self.log(truth.run, f"truth_{truth.target}", self.rerun.Points3D(places, radii=SOURCE_M, colors=TRUTH))

    def track_t(self, track: Any) -> None:
        self.at(track.time_s)
        branch = f"track_{track.target}" if track.head != messages.SINK else f"sink_{track.target}"
        place = (track.x_m, track.y_m, 0.0)
        self.log(track.run, branch, self.rerun.Points3D([place], radii=SOURCE_M, colors=TRACK))
        self.log(track.run, f"{branch}/ellipse", self.rerun.LineStrips3D([circle(track)], colors=TRACK))
        if track.true_known:
            error = math.hypot(track.x_m - track.true_x_m, track.y_m - track.true_y_m)
            self.log(track.run, f"{branch}/error_m", self.rerun.Scalars(error))

    def cluster_t(self, cluster: Any) -> None:
        self.at(cluster.time_s)
        places = self.places[cluster.run]
        asked = [places[node] for node in cluster.members if node in places]
        head = places.get(cluster.head)
        spokes = [np.array((head, place)) for place in asked] if head else []
        self.log(cluster.run, "cluster", self.rerun.LineStrips3D(spokes, colors=CLUSTER))

    def watch_t(self, watch: Any) -> None:
        self.at(watch.time_s)
        places = self.places[watch.run]
        way = [places[node] for node in (watch.head, watch.prince) if node in places]
        self.log(watch.run, f"track_{watch.target}/watch", self.rerun.LineStrips3D([way] if len(way) > 1 else [], colors=CLUSTER))

    def frame_t(self, frame: Any) -> None:
        places = self.places[frame.run]
        sender, destination = places.get(frame.sender), places.get(frame.destination)
        if sender is not None:
            self.air[frame.run, messages.radio_kind(frame)].append(np.array((sender, destination or sender)))

    def land(self, time_s: float, end: bool) -> None:
        """What is in the air is shown and forgotten once it has been there long enough."""
        if not end and 0.0 <= time_s - self.air_began < AIR_S:
            return
        self.at(self.air_began)
        for (run, kind), frames in self.air.items():
            colour = KINDS.get(kind, OTHER)
            links = [frame for frame in frames if (frame[0] != frame[1]).any()]
            self.log(run, f"air/{kind}", self.rerun.LineStrips3D(links, colors=colour))
            senders = [frame[0] for frame in frames]
            self.log(run, f"air/{kind}/senders", self.rerun.Points3D(senders, radii=1.5 * MOTE_M, colors=colour))
            frames.clear()
        self.air_began = time_s

    def mote_t(self, mote: Any) -> None:
        if self.motes_time.get(mote.run, mote.time_s) != mote.time_s:
            self.energy(mote.run)
        self.motes_time[mote.run] = mote.time_s
        self.motes[mote.run][mote.node] = mote

    def energy(self, run: int) -> None:
        known = [(self.places[run][node], mote) for node, mote in self.motes[run].items() if node in self.places[run]]
        if not known:
            return
        self.at(self.motes_time[run])
        colours = [DEAD if not m.alive else EMPTY + np.clip(m.battery_left, 0, 1) * (FULL - EMPTY) for _, m in known]
        points = self.rerun.Points3D([place for place, _ in known], radii=MOTE_M, colors=np.array(colours, np.uint8))
        self.log(run, "battery", points)
        self.log(run, "energy_mj", self.rerun.Scalars(sum(mote.energy_mj for _, mote in known)))

    def run_end_t(self, end: Any) -> None:
        self.energy(end.run)
        self.at(end.time_s)

    def close(self) -> None:
        for run in self.places:
            self.show(run)
        self.land(0.0, True)
        self.stream.disconnect()


def write(out: Path, every: Iterable[Any]) -> None:
    writer = Writer(out)
    for message in every:
        writer.take(message)
    writer.close()
