"""The error figures, computed again from track.csv, independently of the command's recorder."""

from __future__ import annotations

import numpy as np

from .output import Output
from .scenario import Array


def order_in_track(track: dict[str, Array]) -> Array:
    """0, 1, 2 ... within each run and target, in the order of the file."""
    position = np.zeros(len(track["run"]))
    seen: dict[tuple[float, float], int] = {}
    for row, owner in enumerate(zip(track["run"], track["target"])):
        position[row] = seen.get(owner, 0)
        seen[owner] = int(position[row]) + 1
    return position


def errors(track: dict[str, Array], prefix: str = "") -> Array:
    """Distance of each estimate (`raw_`: of each unfiltered one) from the truth, m; NaN where either is absent."""
    return np.hypot(track[f"{prefix}x_m"] - track["true_x_m"], track[f"{prefix}y_m"] - track["true_y_m"])


def normalised(track: dict[str, Array]) -> Array:
    """Normalised squared error of each position by the covariance it states."""
    dx, dy = track["x_m"] - track["true_x_m"], track["y_m"] - track["true_y_m"]
    xx, xy, yy = track["cov_xx_m2"], track["cov_xy_m2"], track["cov_yy_m2"]
    with np.errstate(divide="ignore", invalid="ignore"):
        return (yy * dx**2 - 2.0 * xy * dx * dy + xx * dy**2) / (xx * yy - xy**2)


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")


def recompute(output: Output, run: int) -> dict[str, float]:
    """The metrics of one run that follow from its track and scenario alone."""
    track = output.one_run(run)
    late = order_in_track(track) >= output.skip_first
    counted = {name: column[late] for name, column in track.items()}
    error = errors(counted)
    error = error[np.isfinite(error)]
    raw = errors(counted, "raw_")
    result = {
        "position_rmse_m": rms(error),
        "position_median_m": float(np.median(error)) if len(error) else float("nan"),
        "position_p95_m": float(np.percentile(error, 95)) if len(error) else float("nan"),
        "raw_position_rmse_m": rms(raw[np.isfinite(raw)]),
    }
    nees = normalised(counted)
    nees = nees[np.isfinite(nees)]
    if len(nees) and not (counted["states"] > 2).any():  # track.csv has the position's covariance alone
        result["nees_median"] = float(np.median(nees))
    arrival = counted["arrival_time_s"]
    known = np.isfinite(arrival)
    if output.scenario and known.any():
        there = output.scenario.route.position(arrival[known])
        result["position_rmse_at_arrival_m"] = rms(
            np.hypot(counted["x_m"][known] - there[:, 0], counted["y_m"][known] - there[:, 1])
        )
    return result
