"""What becomes of a run over time, from its output folder, for the figures of sweeps.

`error_m` is the error of its positions; of fixed clusters `local_error_m_1` ... is that of each cluster by itself, `pcrb_m` the
posterior Cramer-Rao bound and `ccrb_m` the one along the run's own path."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from . import fixed_bound
from .output import Output, read_table
from .scenario import Array

NAMES = ("error_m", *(f"local_error_m_{cluster}" for cluster in range(1, 9)), "pcrb_m", "ccrb_m")

Curves = dict[str, list[tuple[float, float]]]  # (time, value) by name


def curve(time: Array, value: Array) -> list[tuple[float, float]]:
    known = np.isfinite(value)
    return [(float(t), float(v)) for t, v in zip(time[known], value[known])]


def errors(track: dict[str, Array]) -> Array:
    return np.hypot(track["x_m"] - track["true_x_m"], track["y_m"] - track["true_y_m"])


def bounds(out: Output) -> Curves:
    """Of fixed clusters; the target's places between estimates are interpolated."""
    if not out.scenario or out.nodes is None or out.scenario.value("network.protocol") != "fixed":
        return {}
    step = out.scenario.number("sensor.interval_s")
    steps = round(out.scenario.number("source.duration_s") / step)
    time = step * np.arange(steps + 1)
    told = out.track["time_s"]
    place = np.stack([np.interp(time, told, out.track[f"true_{axis}_m"]) for axis in "xy"], axis=-1)
    places = {"pcrb_m": fixed_bound.paths(out.scenario, steps, fixed_bound.PATHS), "ccrb_m": place[None]}
    chosen = np.isin(np.round(time / step), np.round(told / step))
    return {
        name: curve(time[chosen], fixed_bound.bound(out.scenario, out.nodes[:-1], where)[chosen])
        for name, where in places.items()
    }


def of(folder: Path) -> Curves:
    """Of the one run in the folder."""
    out = Output.read(folder)
    found = {"error_m": curve(out.track["time_s"], errors(out.track))}
    if (folder / "local.csv").exists():
        local = read_table(folder / "local.csv", ("cluster", "time_s", "x_m", "y_m", "true_x_m", "true_y_m"))
        for cluster in np.unique(local["cluster"]):
            rows = {name: column[local["cluster"] == cluster] for name, column in local.items()}
            found[f"local_error_m_{int(cluster) + 1}"] = curve(rows["time_s"], errors(rows))
    return found | bounds(out)
