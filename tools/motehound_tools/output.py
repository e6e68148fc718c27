"""An output folder of the command (summary.json, runs.csv, track.csv, nodes.csv, scenario.json), or a sweep of them."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .failure import Failure
from .scenario import Array, Scenario

TRACK_COLUMNS = ("run", "target", "time_s", "x_m", "y_m", "raw_x_m", "raw_y_m", "sd_m", "true_x_m", "true_y_m")
OPTIONAL_COLUMNS = (
    *("vx_mps", "vy_mps", "cov_xx_m2", "cov_xy_m2", "cov_yy_m2", "measurements", "arrival_time_s"),
    *("head", "sink_x_m", "sink_y_m", "states", "rate", "true_rate", "number", "mode", "members", "extent_m"),
    *("of_0", "of_1", "of_2", "of_3"),
)
STATISTICS = ("mean", "std", "median", "p95", "n")


def read_table(file: Path, required: tuple[str, ...], optional: tuple[str, ...] = ()) -> dict[str, Array]:
    """Columns of a CSV file of numbers; empty fields become NaN, absent optional columns are all NaN."""
    try:
        with file.open(newline="", encoding="utf-8") as stream:
            rows = csv.reader(stream)
            header = next(rows, [])
            missing = [name for name in required if name not in header]
            if missing:
                raise Failure(f"{file}:1: the column `{missing[0]}` is missing")
            values = np.full((0, len(header)), np.nan)
            parsed: list[list[float]] = []
            for row in rows:
                if len(row) != len(header):
                    raise Failure(f"{file}:{rows.line_num}: {len(row)} fields, expected {len(header)}")
                try:
                    parsed.append([float(field) if field else np.nan for field in row])
                except ValueError:
                    bad = next(name for name, field in zip(header, row) if field and not _is_number(field))
                    raise Failure(f"{file}:{rows.line_num}: `{bad}` is not a number") from None
            if parsed:
                values = np.array(parsed)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise Failure(f"{file}: {reason}") from None
    table = {name: values[:, index] for index, name in enumerate(header)}
    for name in optional:
        table.setdefault(name, np.full(len(values), np.nan))
    return table


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


@dataclass(frozen=True)
class Output:
    """What one call of the command left behind."""

    folder: Path
    summary: dict[str, Any]
    runs: dict[str, Array]
    track: dict[str, Array]
    nodes: Array | None  # [node][x, y] of the first run
    scenario: Scenario | None

    @staticmethod
    def read(folder: Path) -> Output:
        if not folder.is_dir():
            raise Failure(f"{folder}: no such folder")
        file = folder / "summary.json"
        try:
            summary = json.loads(file.read_text(encoding="utf-8"))
        except OSError as error:
            raise Failure(
                f"{file}: {error.strerror}; expected an output folder of `motehound run` or of `tools/sweep`"
            ) from None
        except ValueError as error:
            raise Failure(f"{file}: not JSON: {error}") from None
        if not isinstance(summary, dict) or not isinstance(summary.get("metrics"), dict):
            raise Failure(f"{file}: expected an object with `metrics`")
        for name, entry in summary["metrics"].items():
            if not isinstance(entry, dict) or any(key not in entry for key in STATISTICS):
                raise Failure(f"{file}: `{name}` needs {', '.join(STATISTICS)}")
        if not isinstance(summary.get("pooled", {}), dict):
            raise Failure(f"{file}: `pooled` is not an object")
        track = read_table(folder / "track.csv", TRACK_COLUMNS, OPTIONAL_COLUMNS)
        runs = read_table(folder / "runs.csv", ("run", "seed"))
        described = folder / "scenario.json"
        placed = folder / "nodes.csv"
        nodes = None
        if placed.exists():
            table = read_table(placed, ("node", "x_m", "y_m"))
            nodes = np.stack([table["x_m"], table["y_m"]], axis=-1)
        return Output(folder, summary, runs, track, nodes, Scenario.read(described) if described.exists() else None)

    def statistic(self, metric: str, which: str = "mean") -> float:
        """A statistic over the runs, NaN where the metric does not apply."""
        found = self.summary["metrics"].get(metric, {}).get(which)
        return float(found) if isinstance(found, (int, float)) else float("nan")

    def pooled(self, metric: str) -> float:
        """Over the estimates of all runs together where that makes sense, otherwise the mean over the runs."""
        found = self.summary.get("pooled", {}).get(metric)
        return float(found) if isinstance(found, (int, float)) else self.statistic(metric)

    def one_run(self, run: int) -> dict[str, Array]:
        chosen = self.track["run"] == run
        return {name: column[chosen] for name, column in self.track.items()}

    @property
    def is_ranged(self) -> bool:
        """Whether the motes of a simulation measure how far the target is."""
        return bool(self.scenario) and self.scenario.sections.get("sensor", {}).get("quantity") == "range"

    @property
    def is_search(self) -> bool:
        """Whether the motes of a simulation measure a gas that the wind brings from a leak."""
        return bool(self.scenario) and self.scenario.sections.get("sensor", {}).get("quantity") == "gas"

    @property
    def is_heard(self) -> bool:
        """Whether the motes of a simulation hear their targets."""
        return bool(self.scenario) and self.scenario.sections.get("sensor", {}).get("quantity") == "sound"

    @property
    def is_fixed(self) -> bool:
        """Whether fixed clusters follow the target of a simulation."""
        return bool(self.scenario) and self.scenario.sections.get("network", {}).get("protocol") == "fixed"

    @property
    def skip_first(self) -> int:
        return int(self.scenario.number("metrics.skip_first")) if self.scenario else 0


@dataclass(frozen=True)
class Sweep:
    """Outputs that differ in one key, in the order of its values."""

    folder: Path
    key: str
    values: list[float]
    outputs: list[Output]


def read(folder: Path) -> Output | Sweep:
    """The folder of one call, or of one with --sweep: a sub-folder for each value, named after it."""
    if not folder.is_dir():
        raise Failure(f"{folder}: no such folder")
    parts = [child for child in sorted(folder.iterdir()) if (child / "summary.json").exists()]
    if (folder / "summary.json").exists() or not parts:
        return Output.read(folder)
    try:
        parts.sort(key=_swept_value)
    except ValueError:
        raise Failure(f"{folder}: the sub-folders of a sweep are named after its values, numbers") from None
    outputs = [Output.read(part) for part in parts]
    keys = {_swept_key(one) for one in outputs}
    if len(keys) != 1:
        raise Failure(f"{folder}: the sub-folders vary several keys: {', '.join(sorted(keys))}")
    return Sweep(folder, keys.pop(), [_swept_value(part) for part in parts], outputs)


def _swept_value(folder: Path) -> float:
    return float(folder.name)


def _swept_key(one: Output) -> str:
    return str(one.scenario.value("sweep.key")) if one.scenario else "value"
