"""What there is to see of a run at one time: columns ready to be drawn."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from ..recording import Run
from .colours import CLUSTER
from .targets import TRAIL_S, colour, gaps, watched

POINTS_MAX = 2000  # of a line of the timeline
FRAMES_MAX = 1500  # drawn at once; the newest ones
BEND = 0.18  # of an arc, as a share of its length


class Motes:
    """The motes of a run, and what each has told and sent until a time that moves."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.nodes = np.array(sorted(run.places), dtype=np.int64)
        self.xy = np.array([run.places[node] for node in self.nodes]).reshape(-1, 2)
        self.spacing = 1.0
        if len(self.nodes) > 1:
            nearest = cKDTree(self.xy).query(self.xy, k=2)[0][:, 1]
            self.spacing = max(float(np.median(nearest)), 1e-6)
        self.reset()

    def reset(self) -> None:
        count = len(self.nodes)
        self.time = -1.0
        self.frames_seen = self.told_seen = 0
        self.sent = np.zeros(count)
        self.sent_of_kind = np.zeros(256, dtype=np.int64)
        self.energy, self.battery, self.clock_error = (np.full(count, np.nan) for _ in range(3))
        self.alive = np.ones(count, dtype=bool)

    def index(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where these nodes are in the arrays, and which of them are known at all."""
        if not len(self.nodes):
            return np.zeros(len(nodes), dtype=np.int64), np.zeros(len(nodes), dtype=bool)
        at = np.minimum(np.searchsorted(self.nodes, nodes), len(self.nodes) - 1)
        return at, self.nodes[at] == nodes

    def move(self, time: float) -> None:
        """Forward costs what happened since; backward begins anew."""
        if time < self.time:
            self.reset()
        self.time = time
        frames = self.run.frames.until(time)
        at, known = self.index(frames["sender"][self.frames_seen :])
        self.sent += np.bincount(at[known], minlength=len(self.nodes))
        self.sent_of_kind += np.bincount(frames["kind"][self.frames_seen :], minlength=256)
        self.frames_seen = len(frames)
        told = self.run.motes.until(time)
        new = told[self.told_seen :]
        at, known = self.index(new["node"])
        at, new = at[known], new[known]
        for name in ("energy", "battery", "alive", "clock_error"):
            getattr(self, name)[at] = new[name]  # of several, the last stays
        self.told_seen = len(told)


def frames_in_air(
    run: Run, motes: Motes, time: float, linger: float, colours: np.ndarray
) -> dict[str, dict[str, np.ndarray]]:
    """Frames that went on the air within `linger` before: an arc to the addressee, a ring around who broadcasts. They
    fade over that time; on the air they are much shorter."""
    frames = run.frames.between(time - linger, time)[-FRAMES_MAX:]
    sender, known = motes.index(frames["sender"])
    frames, sender = frames[known], sender[known]
    destination, addressed = motes.index(frames["destination"])
    age = np.clip((time - frames["time"]) / linger, 0.0, 1.0)
    colour = colours[frames["kind"]]
    alpha = (1.0 - age) ** 1.5
    begin, end = motes.xy[sender[addressed]], motes.xy[destination[addressed]]
    across = (end - begin)[:, ::-1] * (-1.0, 1.0)
    middle = (begin + end) / 2.0 + BEND * across
    share = np.minimum(1.0, 1.6 * age[addressed])[:, None]  # of the way that its pulse has gone
    pulse = (1 - share) ** 2 * begin + 2 * share * (1 - share) * middle + share**2 * end
    ring = ~addressed
    centre = motes.xy[sender[ring]]
    return {
        "arcs": {
            **dict(zip(("x0", "y0"), begin.T)),
            **dict(zip(("cx", "cy"), middle.T)),
            **dict(zip(("x1", "y1"), end.T)),
            "alpha": 0.75 * alpha[addressed],
            "color": colour[addressed],
        },
        "pulses": {"x": pulse[:, 0], "y": pulse[:, 1], "alpha": np.sqrt(alpha[addressed]), "color": colour[addressed]},
        "rings": {
            "x": centre[:, 0],
            "y": centre[:, 1],
            "radius": motes.spacing * (0.4 + 1.8 * np.sqrt(age[ring])),
            "alpha": alpha[ring],
            "color": colour[ring],
        },
    }


def clusters(run: Run, time: float) -> dict[str, dict[str, list]]:
    """Of the newest cluster the head, the members and a spoke from it to each of them; where targets are watched, of each one's
    newest all but the head, which is drawn as such."""
    head: dict[str, list] = {"x": [], "y": []}
    members: dict[str, list] = {"x": [], "y": [], "color": []}
    spokes: dict[str, list] = {"xs": [], "ys": [], "color": []}
    rows = run.clusters.until(time)
    shown = [(rows[-1], CLUSTER)] if len(rows) and not len(run.watch) else []
    for watch in watched(run, time):
        mine = rows[rows["track"] == watch["target"]]
        shown += [(mine[-1], colour(run, watch["target"]))] if len(mine) else []
    for row, shade in shown:
        middle = run.places.get(int(row["head"]))
        if middle is not None and shade == CLUSTER:
            head["x"].append(middle[0])
            head["y"].append(middle[1])
        for member in run.members[row["members"]]:
            place = run.places.get(member)
            if place is None:
                continue
            for columns, values in ((members, place), (spokes, tuple(zip(middle, place)) if middle else None)):
                if values is not None:
                    for field, value in zip(columns, (*values, shade)):
                        columns[field].append(value)
    return {"head": head, "members": members, "spokes": spokes}


def sink_view(run: Run, time: float) -> dict[str, dict[str, np.ndarray]]:
    """Where the sink has the target, and has had it."""
    rows = run.sink.between(time - TRAIL_S, time)
    return {"sink_path": {"x": rows["x"], "y": rows["y"]}, "sink": {"x": rows["x"][-1:], "y": rows["y"][-1:]}}


def timeline(run: Run, bins: int = 240) -> dict[str, dict[str, np.ndarray]]:
    """Over the whole run: frames a second, and the error of each estimate."""
    end = max(run.end_s, 1e-3)
    count, edges = np.histogram(run.frames.snapshot()["time"], bins=bins, range=(0.0, end))
    tracks = run.track.snapshot()
    tracks = tracks[np.isfinite(tracks["error"])]
    lines: dict[str, list] = {"xs": [], "ys": [], "color": []}
    for target in np.unique(tracks["target"]):
        known, between = tracks[tracks["target"] == target], gaps(tracks, target)
        every = max(1, len(known) // POINTS_MAX)
        lines["xs"].append(np.insert(known["time"], between, np.nan)[::every])
        lines["ys"].append(np.insert(known["error"], between, np.nan)[::every])
        lines["color"].append(colour(run, target))
    return {
        "traffic": {"time": (edges[1:] + edges[:-1]) / 2.0, "rate": count / (edges[1] - edges[0])},
        "error": lines,
    }
