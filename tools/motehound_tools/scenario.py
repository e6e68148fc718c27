"""The scenario of a run as the command writes it beside its results (`scenario.json`): the parts that a picture or a
bound needs, the path of the source and the places of the nodes."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .failure import Failure

Array = NDArray[np.float64]


def splitmix64(seed: int, count: int) -> Array:
    """The first `count` numbers in [0, 1) of the SplitMix64 stream that starts at `seed`."""
    with np.errstate(over="ignore"):
        z = np.uint64(seed) + np.arange(1, count + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        z = z ^ (z >> np.uint64(31))
    return (z >> np.uint64(11)).astype(np.float64) * 2.0**-53


class Route:
    """Where the source is at any time: pieces between `breaks`, each straight or an arc, at constant speed."""

    def __init__(self, kind: str, points: list[dict[str, float]], speed: float, duration: float) -> None:
        self.kind = kind
        self.corners = np.array([[p["x_m"], p["y_m"]] for p in points], dtype=np.float64)
        self.speed = speed
        if kind == "still":
            self.breaks = np.array([0.0, duration])
            self.top_speed = 0.0
        elif kind == "arcs":
            chord = self.corners[1] - self.corners[0]
            self._radius = float(np.hypot(*chord)) / (4.0 * np.sin(np.pi / 4.0))
            self._heading = float(np.arctan2(chord[1], chord[0])) - np.pi / 4.0
            quarter = self._radius * np.pi / 2.0 / speed
            self.breaks = np.array([0.0, quarter, 2.0 * quarter])
            self.top_speed = speed
        elif kind == "waypoints":
            legs = np.hypot(*np.diff(self.corners, axis=0).T)
            factors = np.array([p.get("speed_factor", 1.0) for p in points[1:]])
            self.breaks = np.concatenate([[0.0], np.cumsum(legs / (factors * speed))])
            self.top_speed = float(np.max(factors)) * speed
        else:
            raise Failure(f"source.path: `{kind}` is not one of waypoints, arcs, still")

    @property
    def end(self) -> float:
        return float(self.breaks[-1])

    def position(self, time: Array) -> Array:
        """[time][x, y]; held at the ends."""
        t = np.clip(np.asarray(time, dtype=np.float64), 0.0, self.end)
        if self.kind == "still":
            return np.broadcast_to(self.corners[0], (*t.shape, 2)).copy()
        if self.kind == "waypoints":
            return np.stack([np.interp(t, self.breaks, self.corners[:, axis]) for axis in (0, 1)], axis=-1)
        r, h = self._radius, self._heading
        turn = t * self.speed / r
        first = np.minimum(turn, np.pi / 2.0)
        second = np.maximum(turn - np.pi / 2.0, 0.0)
        x = r * (np.sin(h + first) - np.sin(h)) + r * (np.sin(h + np.pi / 2.0) - np.sin(h + np.pi / 2.0 - second))
        y = r * (np.cos(h) - np.cos(h + first)) + r * (np.cos(h + np.pi / 2.0 - second) - np.cos(h + np.pi / 2.0))
        return self.corners[0] + np.stack([x, y], axis=-1)


@dataclass(frozen=True)
class Scenario:
    """Members are the sections of the file; `value("source.speed_mps")` reads a key by its path."""

    sections: dict[str, Any]
    folder: Path

    @staticmethod
    def read(file: Path) -> Scenario:
        try:
            sections = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise Failure(f"{file}: expected the scenario as JSON: {error}") from None
        if not isinstance(sections, dict):
            raise Failure(f"{file}: expected an object with the scenario's sections")
        return Scenario(sections, file.parent)

    def value(self, key: str) -> Any:
        found: Any = self.sections
        for part in key.split("."):
            if not isinstance(found, dict) or part not in found:
                raise Failure(f"{self.folder / 'scenario.json'}: the key `{key}` is missing")
            found = found[part]
        return found

    def number(self, key: str) -> float:
        found = self.value(key)
        if isinstance(found, bool) or not isinstance(found, (int, float)):
            raise Failure(f"{self.folder / 'scenario.json'}: `{key}` is `{found}`, expected a number")
        return float(found)

    @property
    def route(self) -> Route:
        points = self.value("source.points")
        kind = str(self.value("source.path"))
        least = 1 if kind == "still" else 2
        if not isinstance(points, list) or len(points) < least:
            raise Failure(f"{self.folder / 'scenario.json'}: `source.points` needs at least {least} points")
        return Route(kind, points, self.number("source.speed_mps"), self.number("source.duration_s"))

    def release(self, time: Array) -> Array:
        """mu at these times, g/s."""
        shape = 1.0 + self.number("source.release_variation") * np.sin(
            2.0 * np.pi * time / max(self.number("source.release_period_s"), 1e-9)
        )
        return self.number("source.release_gps") * shape

    def nodes(self, seed: int) -> Array:
        """[node][x, y] of the uniform deployment with this seed."""
        layout = self.value("network.layout")
        if layout != "uniform":
            raise Failure(f"network.layout: `{layout}` is not drawn from a seed here; expected uniform")
        size = np.array([self.number("field.width_m"), self.number("field.height_m")])
        return splitmix64(seed, 2 * int(self.number("network.nodes"))).reshape(-1, 2) * size
