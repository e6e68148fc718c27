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
LATE = 0.75  # of the crossing, after which the instant of the picture is chosen


def one_run(program: Path, out: Path, tracker: str) -> Output:
    folder = out / tracker
    if not (folder / "summary.json").exists():
        command.run(program, SCENARIO, folder, 1, SEED, {**NOISE, "tracker.name": tracker})
    found = output.read(folder)
    if not isinstance(found, Output) or found.scenario is None or found.nodes is None or not len(found.track["run"]):
        raise Failure(f"{folder}: expected one run with its scenario and at least one estimate")
    return found


def typical_instant(found: Output, after: float) -> float:
    """The time after `after` at which the error is nearest to that of the whole run."""
    error = errors(found.track)
    unlike = np.abs(error - rms(error[found.skip_first :]))
    return float(found.track["time_s"][np.argmin(np.where(found.track["time_s"] >= after, unlike, np.inf))])


def write(program: Path, out: Path, image: Path) -> None:
    ours, paper = one_run(program, out, "diffusion"), one_run(program, out, "luo")
    scenario, nodes = ours.scenario, ours.nodes
    assert scenario is not None and nodes is not None
    time = typical_instant(paper, LATE * scenario.route.end)
    until = {found.folder.name: found.track["time_s"] <= time for found in (ours, paper)}
    path = scenario.route.position(np.linspace(0.0, time, 1200))
    head = path[-1]
    figure, axes = pyplot.subplots(figsize=(6.6, 6.4))
    axes.grid(False)
    figures.draw_cloud(axes, scenario, time, cells=120)
    close = axes.inset_axes(
        (0.61, 0.66, 0.38, 0.33), xlim=head[0] + np.array([-3.5, 6.5]), ylim=head[1] + np.array([-7.0, 1.9])
    )
    close.set(xticks=[], yticks=[], aspect="equal", title="")
    close.grid(False)
    for spine in close.spines.values():
        spine.set(visible=True, color=figures.QUIET)
    axes.indicate_inset_zoom(close, edgecolor=figures.QUIET)
    for view, size in ((axes, 1.0), (close, 2.2)):
        view.scatter(
            nodes[:, 0],
            nodes[:, 1],
            s=2.0 * size**2,
            color=figures.QUIET,
            alpha=0.7,
            linewidths=0,
            rasterized=True,
            zorder=2,
        )
        view.plot(
            path[:, 0], path[:, 1], color=figures.TRUTH, linewidth=3.0 * size, alpha=0.85, label="true path", zorder=3
        )
        for found, colour, name in (
            (paper, figures.RAW, "luo, the published method"),
            (ours, figures.TRACK, "diffusion, the default"),
        ):
            x, y = (found.track[c][until[found.folder.name]] for c in ("x_m", "y_m"))
            label = f"{name}: RMSE {rms(errors(found.track)[found.skip_first :]):.2f} m"
            view.plot(
                x,
                y,
                color=colour,
                linewidth=1.1 * size,
                marker="." if view is close else "",
                markersize=8,
                label=label,
                zorder=4,
            )
            view.plot(x[-1], y[-1], "o", color=colour, markeredgecolor="white", markersize=5.0 * size, zorder=6)
        view.plot(
            *head, "o", color="none", markeredgecolor=figures.TRUTH, markeredgewidth=1.4, markersize=9 * size, zorder=7
        )
    lag = (paper.track["x_m"][until["luo"]][-1], paper.track["y_m"][until["luo"]][-1])
    close.annotate("source", (head[0], head[1]), xytext=(14, 4), textcoords="offset points", weight="bold")
    close.annotate("luo", lag, xytext=(12, -8), textcoords="offset points", weight="bold", color=figures.RAW)
    figures.metres(axes, scenario)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.09), ncols=1, fontsize=9.5)
    motes = int(scenario.number("network.nodes"))
    axes.set_title(f"{motes:,} motes, cloud and tracks at t = {time:g} s", loc="left", color="#3b434d")
    image.parent.mkdir(parents=True, exist_ok=True)
    image.write_text(figures.svg_text(figure, dpi=60), encoding="utf-8")
