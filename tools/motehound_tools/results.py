"""The published experiments, run through the command, and the page that sets their figures beside what they should be."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console

from . import bound, command, output
from .failure import Failure
from .metrics import errors
from .output import Output
from .report import number
from .sweep import is_complete, progress

LOW = {"sensor.relative_noise": "0.01", "sensor.additive_noise": "0.02"}
HIGH = {"sensor.relative_noise": "0.05", "sensor.additive_noise": "0"}
ALL = {"metrics.skip_first": "0"}  # the published figures of the paper's method count every estimate
ONE_HOP = {"radio.range_m": "120"}
PATHS = {"E1": "luo_exp1", "E2": "luo_exp2"}
GAP_START_S, GAP_S, FOUND_M = 40.0, 20.0, 1.0

Limits = dict[str, dict[str, dict[str, float]]]  # by the folder of a case, as bound.over_deployments gives them


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


def cell(found: Output, metric: str) -> str:
    return number(figure(found, metric))


def spread(found: Output, metric: str) -> str:
    return f"{number(found.statistic(metric, 'mean'))} ± {number(found.statistic(metric, 'std'))}"


def verdict(held: bool) -> str:
    return "pass" if held else "**miss**"


def requirement_table(rows: list[Requirement], read: Callable[[Case], Output]) -> list[str]:
    lines = ["| figure | measured | runs: mean ± sd | required | |", "|---|---:|---:|---:|---|"]
    for row in rows:
        found = read(row.case)
        of_runs = "" if row.metric == "track_lost" else spread(found, row.metric)
        held = verdict(row.holds(figure(found, row.metric)))
        lines.append(f"| {row.what} | {cell(found, row.metric)} | {of_runs} | {row.said} | {held} |")
    return lines


def comparison_table(read: Callable[[Case], Output], limits: Limits) -> list[str]:
    lines = [
        "| path | condition | median | p95 | RMSE | runs: mean ± sd | NEES | lost | `luo` RMSE | `luo` lost | bound 0.5 | bound 0.05 |",
        "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for condition in CONDITIONS:
        for path in PATHS:
            ours, paper = (read(Case(path, tracker, condition.settings)) for tracker in ("diffusion", "luo"))
            limit = limits.get(Case(path, "diffusion", condition.settings).folder)
            bounds = [number(limit[prior]["rms_m"]) if limit else "–" for prior in ("0.5", "0.05")]
            cells = [
                path,
                condition.label,
                cell(ours, "position_median_m"),
                cell(ours, "position_p95_m"),
                cell(ours, "position_rmse_m"),
                spread(ours, "position_rmse_m"),
                cell(ours, "nees_median"),
                cell(ours, "track_lost"),
                cell(paper, "position_rmse_m"),
                cell(paper, "track_lost"),
                *bounds,
            ]
            lines.append("| " + " | ".join(cells) + " |")
    return lines


def frames_table(read: Callable[[Case], Output]) -> list[str]:
    columns = (
        "frames_sent",
        "frames_sent_beacons",
        "frames_sent_reports",
        "frames_sent_requests",
        "reports",
        "reports_asked",
    )
    lines = [
        "| path | tracker | frames | beacons | reports, every hop | requests | reports made | of these asked for |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    for path in PATHS:
        for tracker in ("diffusion", "luo"):
            found = read(Case(path, tracker, LOW))
            means = [found.statistic(column) for column in columns]
            cells = [f"{mean:,.0f}" if math.isfinite(mean) else "–" for mean in means]
            lines.append(f"| {path} | `{tracker}` | " + " | ".join(cells) + " |")
    return lines


def loss_lines(read: Callable[[Case], Output]) -> list[str]:
    """What the loss of readings and reports does to the median, and how soon the source is found after a gap."""
    lines = ["| figure | measured | required | |", "|---|---:|---:|---|"]
    for path in PATHS:
        for label, base, lossy in (
            ("readings", LOW, {**LOW, "sensor.loss": "0.1"}),
            ("frames of one hop", {**LOW, **ONE_HOP}, {**LOW, **ONE_HOP, "radio.loss": "0.1"}),
        ):
            with_loss, without = (figure(read(Case(path, "diffusion", s)), "position_median_m") for s in (lossy, base))
            ratio = with_loss / without
            lines.append(
                f"| {path}: median error with 10 % of the {label} lost, as a multiple of the one without | {number(ratio)} | ≤ 2 | "
                f"{verdict(ratio <= 2.0)} |"
            )
        waits = samples_until_found(read(Case(path, "diffusion", CONDITIONS[-1].settings)))
        worst, middle = max(waits), float(np.median(waits))
        lines.append(
            f"| {path}: samples after the gap until the error is below {FOUND_M:g} m, worst run (median {number(middle)}) | "
            f"{number(worst) if math.isfinite(worst) else 'never'} | ≤ 10 | {verdict(worst <= 10)} |"
        )
    return lines


def cases() -> list[Case]:
    """Every call that the page needs, each once."""
    wanted = [row.case for row in (*paper_requirements(), *default_requirements())]
    wanted += [
        Case(path, tracker, c.settings) for c in CONDITIONS for path in PATHS for tracker in ("diffusion", "luo")
    ]
    return list({case.folder: case for case in wanted}.values())


def limits_of(out: Path, read: Callable[[Case], Output], seeds: int, advance: Callable[[str], None]) -> Limits:
    """The bound of every noisy condition, kept in a file beside the runs. Lost frames are not in its model."""
    found: Limits = {}
    for condition in CONDITIONS:
        for path in PATHS:
            case = Case(path, "diffusion", condition.settings)
            advance(f"bound {case.folder}")
            if not condition.settings or "radio.loss" in condition.settings:
                continue
            kept = out / "bounds" / f"{case.folder}_seeds={seeds}.json"
            if not kept.exists():
                scenario = read(case).scenario
                if scenario is None:
                    raise Failure(f"{out / case.folder}: scenario.json is missing")
                kept.parent.mkdir(parents=True, exist_ok=True)
                kept.write_text(json.dumps(bound.over_deployments(scenario, seeds), indent=2) + "\n", encoding="utf-8")
            found[case.folder] = json.loads(kept.read_text(encoding="utf-8"))
    return found


def page(read: Callable[[Case], Output], limits: Limits, runs: int, bound_seeds: int) -> str:
    version = str(read(Case("E1", "diffusion", LOW)).summary.get("version", "unknown"))
    clean = limits[Case("E1", "diffusion", LOW).folder]
    lines = [
        "# Results: the diffusion experiments",
        "",
        f"Written by `python -m motehound_tools results` with motehound {version}: {runs} runs each, seeds 0 to {runs - 1}. Nothing here is "
        "typed by hand; the same command writes it again.",
        "",
        "E1 is two arcs from (0, 0) to (38, 78) m, E2 the path of seven waypoints; 1,280 nodes uniform on 80 m x 80 m, T = 1 s, 1 m/s, "
        "D = 1 m²/s and 100 g/s unless a row says otherwise. Errors are distances between the estimate and the true position at the sampling "
        "instant, over all estimates of all runs together; `mean ± sd` is over the runs.",
        "",
        "## The paper's method (`luo`)",
        "",
        "Noiseless, every estimate counted. The required figures are those of an independent implementation of the paper.",
        "",
        *requirement_table(paper_requirements(), read),
        "",
        "The error grows with the sampling interval as the paper says, and hardly shrinks with more nodes: most of it is lag, because the "
        "increment of Eq. (8) takes for the newest release what is largely older release still spreading. The last rows are the price of "
        "choosing nodes by a fixed threshold: with 5 % noise the old, large readings pass it by chance and the method collapses.",
        "",
        "## The default tracker (`diffusion`)",
        "",
        "The first three estimates of a track are left out.",
        "",
        *requirement_table(default_requirements(), read),
        "",
        "## Under other conditions",
        "",
        "Noise is 1 % + 0.02 g/m² from the fourth condition on. A run is lost when the error exceeds 5 m in 5 successive estimates. The "
        "bounds are posterior Cramer-Rao bounds (root mean square, "
        f"{bound_seeds} deployments) with every reading of every node known and a random acceleration of 0.5 or 0.05 m/s² as the prior of "
        "the path; the paths turn with about 0.03 m/s² between corners, so a tracker can come out below the first. Where a row changes only "
        "what the tracker believes, the bound is that of the true values; where the release varies, that of a tracker that knows how.",
        "",
        *comparison_table(read, limits),
        "",
        f"Without any prior of the motion the bound of E1 at 1 % + 0.02 g/m² is {number(clean['none']['rms_m'])} m, its median "
        f"{number(clean['none']['median_m'])} m.",
        "",
        "## Lost readings and reports",
        "",
        *loss_lines(read),
        "",
        "## What asking costs",
        "",
        "Frames of a whole run, 1 % + 0.02 g/m², mean over the runs. The default tracker's head asks the nodes near the predicted position "
        "for their readings, silent or not; the paper's does not.",
        "",
        *frames_table(read),
        "",
    ]
    return "\n".join(lines)


def write(program: Path, out: Path, markdown: Path, runs: int) -> None:
    bound_seeds = 4 if runs >= 50 else 1
    console = Console(stderr=True)
    every = cases()
    opened: dict[str, Output] = {}

    def read(case: Case) -> Output:
        if case.folder not in opened:
            found = output.read(out / f"runs={runs}" / case.folder)
            assert isinstance(found, Output)
            opened[case.folder] = found
        return opened[case.folder]

    with progress(console) as bar:
        task = bar.add_task("", total=len(every) + len(CONDITIONS) * len(PATHS))

        def advance(description: str) -> None:
            bar.update(task, advance=1, description=description)

        for case in every:
            folder = out / f"runs={runs}" / case.folder
            bar.update(task, description=case.folder)
            if not is_complete(folder, runs, 0):
                command.run(program, PATHS[case.path], folder, runs, 0, {**case.settings, "tracker.name": case.tracker})
            advance(case.folder)
        limits = limits_of(out, read, bound_seeds, advance)
    markdown.parent.mkdir(parents=True, exist_ok=True)
    markdown.write_text(page(read, limits, runs, bound_seeds), encoding="utf-8")
