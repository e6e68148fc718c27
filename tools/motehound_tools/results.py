"""Runs the published experiments through the command and sets their figures beside what they should be."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from . import batch, bound, output
from .luo import (
    CONDITIONS,
    FOUND_M,
    LOW,
    ONE_HOP,
    PATHS,
    Case,
    Requirement,
    cases,
    default_requirements,
    figure,
    paper_requirements,
    samples_until_found,
)
from .failure import Failure
from .output import Output
from .report import number

Read = Callable[[Case], Output]
Bounds = dict[str, dict[str, dict[str, float]]]  # by bounded(), as bound.over_deployments gives them


def cell(found: Output, metric: str) -> str:
    return number(figure(found, metric))


def spread(found: Output, metric: str) -> str:
    return f"{number(found.statistic(metric, 'mean'))} ± {number(found.statistic(metric, 'std'))}"


def verdict(held: bool) -> str:
    return "pass" if held else "**miss**"


def requirement_table(rows: list[Requirement], read: Read) -> list[str]:
    lines = ["| figure | measured | runs: mean ± sd | required | |", "|---|---:|---:|---:|---|"]
    for row in rows:
        found = read(row.case)
        of_runs = "" if row.metric == "track_lost" else spread(found, row.metric)
        held = verdict(row.holds(figure(found, row.metric)))
        lines.append(f"| {row.what} | {cell(found, row.metric)} | {of_runs} | {row.said} | {held} |")
    return lines


def comparison_table(read: Read, bounds: Bounds) -> list[str]:
    lines = [
        "| path | condition | median | p95 | RMSE | runs: mean ± sd | NEES | lost "
        "| `luo` RMSE | `luo` lost | bound 0.5 | bound 0.05 |",
        "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for condition in CONDITIONS:
        for path in PATHS:
            ours, paper = (read(Case(path, tracker, condition.settings)) for tracker in ("diffusion", "luo"))
            limit = bounds.get(bounded(Case(path, "diffusion", condition.settings)))
            limits = [number(limit[prior]["rms_m"]) if limit else "–" for prior in ("0.5", "0.05")]
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
                *limits,
            ]
            lines.append("| " + " | ".join(cells) + " |")
    return lines


def frames_table(read: Read) -> list[str]:
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


def loss_table(read: Read) -> list[str]:
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
                f"| {path}: median error with 10 % of the {label} lost, as a multiple of the one without "
                f"| {number(ratio)} | ≤ 2 | {verdict(ratio <= 2.0)} |"
            )
        waits = samples_until_found(read(Case(path, "diffusion", CONDITIONS[-1].settings)))
        worst, middle = max(waits), float(np.median(waits))
        lines.append(
            f"| {path}: samples after the gap until the error is below {FOUND_M:g} m, "
            f"worst run (median {number(middle)}) | {number(worst) if math.isfinite(worst) else 'never'} "
            f"| ≤ 10 | {verdict(worst <= 10)} |"
        )
    return lines


def bounded(case: Case) -> str:
    """What of a case the bound depends on: the world and its sensors, neither the tracker nor the radio."""
    world = {k: v for k, v in case.settings.items() if k.partition(".")[0] in ("source", "network", "sensor")}
    return Case(case.path, "bound", world).folder


def bounds_of(out: Path, read: Read, seeds: int, advance: Callable[[], None]) -> Bounds:
    """The bound of every noisy condition, each kept in a file beside the runs."""
    found: Bounds = {}
    for condition in CONDITIONS:
        for path in PATHS:
            case = Case(path, "diffusion", condition.settings)
            name = bounded(case)
            advance()
            if not condition.settings or name in found:
                continue
            kept = out / "bounds" / f"{name}_seeds={seeds}.json"
            if not kept.exists():
                scenario = read(case).scenario
                if scenario is None:
                    raise Failure(f"{read(case).folder}/scenario.json: No such file")
                kept.parent.mkdir(parents=True, exist_ok=True)
                kept.write_text(json.dumps(bound.over_deployments(scenario, seeds), indent=2) + "\n", encoding="utf-8")
            found[name] = json.loads(kept.read_text(encoding="utf-8"))
    return found


def page(read: Read, bounds: Bounds, runs: int, bound_seeds: int) -> str:
    environment = Environment(
        loader=PackageLoader("motehound_tools"), undefined=StrictUndefined, keep_trailing_newline=True
    )
    clean = bounds[bounded(Case("E1", "diffusion", LOW))]["none"]
    return environment.get_template("results.md.j2").render(
        version=read(Case("E1", "diffusion", LOW)).summary.get("version", "unknown"),
        runs=runs,
        bound_seeds=bound_seeds,
        paper="\n".join(requirement_table(paper_requirements(), read)),
        default="\n".join(requirement_table(default_requirements(), read)),
        comparison="\n".join(comparison_table(read, bounds)),
        losses="\n".join(loss_table(read)),
        frames="\n".join(frames_table(read)),
        free_rms=number(clean["rms_m"]),
        free_median=number(clean["median_m"]),
    )


def write(program: Path, out: Path, markdown: Path, runs: int) -> None:
    bound_seeds = 4 if runs >= 50 else 1
    opened: dict[str, Output] = {}

    def read(case: Case) -> Output:
        if case.folder not in opened:
            found = output.read(out / f"runs={runs}" / case.folder)
            assert isinstance(found, Output)
            opened[case.folder] = found
        return opened[case.folder]

    calls = {
        case.folder: (
            PATHS[case.path],
            out / f"runs={runs}" / case.folder,
            {**case.settings, "tracker.name": case.tracker},
        )
        for case in cases()
    }
    batch.folders(program, calls, runs)
    with batch.progress("bounds", len(CONDITIONS) * len(PATHS)) as advance:
        bounds = bounds_of(out, read, bound_seeds, advance)
    markdown.parent.mkdir(parents=True, exist_ok=True)
    markdown.write_text(page(read, bounds, runs, bound_seeds), encoding="utf-8")
