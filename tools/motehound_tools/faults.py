"""Runs the scenarios faults_* through the command and sets side by side what each fault does to the track, the radio and the batteries."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from . import batch, output
from .metrics import errors, rms
from .output import Output
from .report import number
from .scenario import Array

FAULTS = {
    "none": "none",
    "loss": "30 % of the frames lost",
    "burst": "bursts of loss, a quarter of the time",
    "dead": "a fifth of the nodes die at 30 s",
    "reboot": "30 % of the nodes down from 30 to 40 s",
    "stuck": "a fifth of the sensors stuck",
    "spike": "a fifth of the sensors spike",
    "saturate": "30 % of the sensors saturate",
    "bias": "a fifth of the sensors biased",
    "partition": "head cut off from the source",
    "mute": "head mute",
    "jam": "source in a jammed zone",
}
RADIOS = ("ideal", "802154")
REASONS = {
    "collision": "collision",
    "random": "at random",
    "deaf": "deaf",
    "dead": "dead",
    "jammed": "jammed",
    "partition": "partition",
    "mute": "mute",
    "busy": "busy",
    "no_ack": "no ack",
}
LONGEST = 10  # samples for which the covariance may claim less than a third of the error
OVER_S = 75.0  # every passing fault has been over for at least 15 s

Read = Callable[[str, str], Output]  # by fault and radio


def error_after(found: Output) -> float:
    track = found.track
    return rms(errors(track)[(track["time_s"] >= OVER_S) & ~np.isnan(track["true_x_m"])])


def longest(found: Output) -> Array:
    return found.runs["overconfident_samples"]


def track_table(read: Read, radio: str) -> list[str]:
    lines = [
        "| fault | RMSE, m | median, m | RMSE from 75 s on, m | runs: mean ± sd | tracked | covered | longest overconfidence, samples | |",
        "|---|---:|---:|---:|---:|---:|---:|---:|---|",
    ]
    for fault, meaning in FAULTS.items():
        found = read(fault, radio)
        worst = float(np.nanmax(longest(found)))
        cells = [
            meaning,
            number(found.pooled("position_rmse_m")),
            number(found.pooled("position_median_m")),
            number(error_after(found)),
            f"{number(found.statistic('position_rmse_m'))} ± {number(found.statistic('position_rmse_m', 'std'))}",
            f"{100.0 * found.statistic('tracked_share'):.1f} %",
            f"{100.0 * found.statistic('covered_share'):.1f} %",
            f"{worst:.0f}",
            "pass" if worst <= LONGEST else "**miss**",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def radio_table(read: Read, radio: str) -> list[str]:
    lines = [
        "| fault | sent | received | " + " | ".join(REASONS.values()) + " | delivered | energy, J a mote |",
        "|---|---:|---:|" + "---:|" * len(REASONS) + "---:|---:|",
    ]
    for fault, meaning in FAULTS.items():
        found = read(fault, radio)
        counts = ["frames_sent", "frames_received", *(f"frames_lost_{reason}" for reason in REASONS)]
        nodes = found.scenario.number("network.nodes") if found.scenario else float("nan")
        cells = [
            meaning,
            *(f"{found.statistic(name):,.0f}" for name in counts),
            f"{100.0 * found.statistic('delivery_share'):.1f} %",
            f"{found.statistic('energy_mj') / 1e3 / nodes:.3f}",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return lines


def page(read: Read, runs: int) -> str:
    environment = Environment(
        loader=PackageLoader("motehound_tools"), undefined=StrictUndefined, keep_trailing_newline=True
    )
    return environment.get_template("faults.md.j2").render(
        version=read("none", RADIOS[0]).summary.get("version", "unknown"),
        runs=runs,
        tracks={radio: "\n".join(track_table(read, radio)) for radio in RADIOS},
        radios={radio: "\n".join(radio_table(read, radio)) for radio in RADIOS},
    )


def write(program: Path, out: Path, markdown: Path, runs: int) -> None:
    opened: dict[str, Output] = {}

    def read(fault: str, radio: str) -> Output:
        folder = f"{fault}_{radio}"
        if folder not in opened:
            found = output.read(out / f"runs={runs}" / folder)
            assert isinstance(found, Output)
            opened[folder] = found
        return opened[folder]

    calls = {
        f"{fault}_{radio}": (f"faults_{fault}", out / f"runs={runs}" / f"{fault}_{radio}", {"radio.profile": radio})
        for fault in FAULTS
        for radio in RADIOS
    }
    batch.folders(program, calls, runs)
    markdown.parent.mkdir(parents=True, exist_ok=True)
    markdown.write_text(page(read, runs), encoding="utf-8")
