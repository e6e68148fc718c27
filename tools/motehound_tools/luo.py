"""The published experiments: which runs they need and what their figures should be."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .metrics import errors
from .output import Output

LOW = {"sensor.relative_noise": "0.01", "sensor.additive_noise": "0.02"}
HIGH = {"sensor.relative_noise": "0.05", "sensor.additive_noise": "0"}
ALL = {"metrics.skip_first": "0"}  # the published figures of the paper's method count every estimate
ONE_HOP = {"radio.range_m": "120"}
PATHS = {"E1": "luo_exp1", "E2": "luo_exp2"}
GAP_START_S, GAP_S = 40.0, 20.0
FOUND_M = 1.0  # the source is found again when the error is below this


@dataclass(frozen=True)
class Case:
    """One call of the command."""

    path: str  # E1 or E2
    tracker: str
    settings: dict[str, str] = field(default_factory=dict, hash=False)

    @property
    def folder(self) -> str:
        said = "_".join(f"{key.rpartition('.')[2]}={value}" for key, value in sorted(self.settings.items()))
        return f"{self.path}_{self.tracker}" + (f"_{said}" if said else "")


@dataclass(frozen=True)
class Condition:
    """A row of the comparison: both trackers under the same settings."""

    label: str
    settings: dict[str, str]


CONDITIONS = (
    Condition("no noise", {}),
    Condition("1 % + 0.02 g/m²", LOW),
    Condition("5 %", HIGH),
    Condition("0.5 m/s", {**LOW, "source.speed_mps": "0.5"}),
    Condition("2 m/s", {**LOW, "source.speed_mps": "2"}),
    Condition("4 m/s", {**LOW, "source.speed_mps": "4"}),
    Condition("T = 0.5 s", {**LOW, "sensor.interval_s": "0.5"}),
    Condition("T = 2 s", {**LOW, "sensor.interval_s": "2"}),
    Condition("640 nodes", {**LOW, "network.nodes": "640"}),
    Condition("tracker's D 10 % low", {**LOW, "tracker.diffusion_m2ps": "0.9"}),
    Condition("tracker's D 10 % high", {**LOW, "tracker.diffusion_m2ps": "1.1"}),
    Condition("release varies by 40 %", {**LOW, "source.release_variation": "0.4"}),
    Condition("10 % of the readings lost", {**LOW, "sensor.loss": "0.1"}),
    Condition("30 % of the readings lost", {**LOW, "sensor.loss": "0.3"}),
    Condition("one hop, no report lost", {**LOW, **ONE_HOP}),
    Condition("one hop, 10 % of the frames lost", {**LOW, **ONE_HOP, "radio.loss": "0.1"}),
    Condition("one hop, 30 % of the frames lost", {**LOW, **ONE_HOP, "radio.loss": "0.3"}),
    Condition(
        "20 samples lost in a row",
        {**LOW, "sensor.outage_start_s": f"{GAP_START_S:g}", "sensor.outage_s": f"{GAP_S:g}"},
    ),
)


@dataclass(frozen=True)
class Requirement:
    """A metric of a case over all its estimates, and what it should be."""

    what: str
    case: Case
    metric: str
    said: str
    holds: Callable[[float], bool]


def figure(found: Output, metric: str) -> float:
    """The metric over all estimates of all runs; for lost tracks the number of runs."""
    if metric == "track_lost":
        return float(np.nansum(found.runs["track_lost"])) if "track_lost" in found.runs else math.nan
    return found.pooled(metric)


def near(what: str, case: Case, metric: str, wanted: float, within: float) -> Requirement:
    return Requirement(
        what, case, metric, f"{wanted:g} ± {within * 100.0:g} %", lambda v: abs(v / wanted - 1.0) <= within
    )


def at_most(what: str, case: Case, metric: str, limit: float) -> Requirement:
    return Requirement(what, case, metric, f"≤ {limit:g}", lambda v: v <= limit)


def paper_requirements() -> list[Requirement]:
    rows = []
    for path, least_squares, filtered, arrival in (("E1", 3.31, 3.53, 1.75), ("E2", 3.64, 4.10, 2.94)):
        case = Case(path, "luo", ALL)
        rows += [
            near(f"{path}: least squares, RMSE, m", case, "raw_position_rmse_m", least_squares, 0.08),
            near(f"{path}: filtered, RMSE, m", case, "position_rmse_m", filtered, 0.08),
            near(
                f"{path}: filtered against the time of arrival, RMSE, m",
                case,
                "position_rmse_at_arrival_m",
                arrival,
                0.12,
            ),
            Requirement(
                f"{path}: share of the samples with a position", case, "tracked_share", "≥ 0.97", lambda v: v >= 0.97
            ),
        ]
    for interval, wanted in (("0.5", 1.92), ("1", 3.53), ("2", 6.31), ("4", 10.9)):
        settings = ALL if interval == "1" else {**ALL, "sensor.interval_s": interval}
        rows.append(
            near(
                f"E1, T = {interval} s: filtered, RMSE, m", Case("E1", "luo", settings), "position_rmse_m", wanted, 0.15
            )
        )
    for nodes, wanted in ((640, 4.49), (960, 4.20), (1280, 4.10), (1920, 4.02)):
        settings = ALL if nodes == 1280 else {**ALL, "network.nodes": str(nodes)}
        rows.append(
            near(
                f"E2, {nodes:,} nodes: filtered, RMSE, m", Case("E2", "luo", settings), "position_rmse_m", wanted, 0.10
            )
        )
    for path, wanted in (("E1", 18.2), ("E2", 19.1)):
        case = Case(path, "luo", {**HIGH, **ALL})
        rows.append(
            near(f"{path}, 5 % noise and chi = 0.2: least squares, RMSE, m", case, "raw_position_rmse_m", wanted, 0.10)
        )
    return rows


def default_requirements() -> list[Requirement]:
    rows = []
    for path, label, noise, median, p95, rmse in (
        ("E1", "1 % + 0.02", LOW, 0.05, 0.17, 0.15),
        ("E2", "1 % + 0.02", LOW, 0.05, 0.34, 0.35),
        ("E1", "5 %", HIGH, 0.19, 0.55, 0.40),
        ("E2", "5 %", HIGH, 0.20, 0.70, 0.45),
    ):
        case = Case(path, "diffusion", noise)
        rows += [
            at_most(f"{path}, {label}: median error, m", case, "position_median_m", median),
            at_most(f"{path}, {label}: 95th percentile, m", case, "position_p95_m", p95),
            at_most(f"{path}, {label}: RMSE, m", case, "position_rmse_m", rmse),
            Requirement(f"{path}, {label}: runs lost", case, "track_lost", "0", lambda v: v == 0),
            Requirement(
                f"{path}, {label}: median NEES",
                case,
                "nees_median",
                "0.5 to 3 (exact: 1.39)",
                lambda v: 0.5 <= v <= 3.0,
            ),
        ]
    return rows


def samples_until_found(found: Output) -> list[float]:
    """For each run the samples after the gap until the error is below FOUND_M; infinite if it never is."""
    interval = found.scenario.number("sensor.interval_s") if found.scenario else 1.0
    last_silent = GAP_START_S + GAP_S - interval
    waits = []
    for run in found.runs["run"]:
        track = found.one_run(int(run))
        good = track["time_s"][(track["time_s"] > last_silent) & (errors(track) <= FOUND_M)]
        waits.append(round((float(good[0]) - last_silent) / interval) if len(good) else math.inf)
    return waits


def cases() -> list[Case]:
    """Every call that the page needs, each once."""
    wanted = [row.case for row in (*paper_requirements(), *default_requirements())]
    wanted += [
        Case(path, tracker, c.settings) for c in CONDITIONS for path in PATHS for tracker in ("diffusion", "luo")
    ]
    return list({case.folder: case for case in wanted}.values())
