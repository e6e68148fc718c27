"""The README's picture: one noisy crossing, followed by the paper's method and by the default tracker."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import pyplot

from . import command, figures, output
from .failure import Failure
from .metrics import errors, rms
from .output import Output

SCENARIO = "luo_exp2"
SEED = 0
NOISE = {"sensor.relative_noise": "0.01", "sensor.additive_noise": "0.02"}
SHARE = 0.8  # of the crossing, at which the cloud is drawn


def one_run(program: Path, out: Path, tracker: str) -> Output:
    folder = out / tracker
    if not (folder / "summary.json").exists():
        command.run(program, SCENARIO, folder, 1, SEED, {**NOISE, "tracker.name": tracker})
    found = output.read(folder)
    if not isinstance(found, Output) or found.scenario is None or found.nodes is None or not len(found.track["run"]):
        raise Failure(f"{folder}: expected one run with its scenario and at least one estimate")
    return found


def write(program: Path, out: Path, image: Path) -> None:
    ours, paper = one_run(program, out, "diffusion"), one_run(program, out, "luo")
    scenario, nodes = ours.scenario, ours.nodes
    assert scenario is not None and nodes is not None
    time = np.floor(SHARE * scenario.route.end)
    path = scenario.route.position(np.linspace(0.0, scenario.route.end, 1200))
    figure, axes = pyplot.subplots(figsize=(6.6, 6.2))
    axes.grid(False)
    figures.draw_cloud(axes, scenario, float(time), cells=160)
    axes.scatter(
        nodes[:, 0], nodes[:, 1], s=2.0, color=figures.QUIET, alpha=0.7, linewidths=0, rasterized=True, zorder=2
    )
    axes.plot(path[:, 0], path[:, 1], color=figures.TRUTH, linewidth=4.0, alpha=0.9, label="true path", zorder=3)
    for found, colour, name in (
        (paper, figures.RAW, "luo, the published method"),
        (ours, figures.TRACK, "diffusion, the default"),
    ):
        label = f"{name}: RMSE {rms(errors(found.track)[found.skip_first :]):.2f} m"
        axes.plot(
            found.track["x_m"],
            found.track["y_m"],
            "-",
            color=colour,
            linewidth=1.2,
            marker=".",
            markersize=4,
            label=label,
            zorder=4,
        )
    head = scenario.route.position(np.array(time))
    axes.plot(*head, "o", color="white", markeredgecolor=figures.TRUTH, markeredgewidth=1.8, markersize=9, zorder=5)
    axes.annotate("source", (head[0], head[1]), xytext=(8, 8), textcoords="offset points", weight="bold", zorder=6)
    figures.metres(axes, scenario)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.09), ncols=1, fontsize=9.5)
    axes.set_title(f"{len(nodes):,} motes, cloud at t = {time:g} s", loc="left", color="#3b434d")
    image.parent.mkdir(parents=True, exist_ok=True)
    image.write_text(figures.svg_text(figure), encoding="utf-8")
