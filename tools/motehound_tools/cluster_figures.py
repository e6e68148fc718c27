"""Figures of fixed clusters: who is in which, what joining their tracks gains, and whether it is honest."""

from __future__ import annotations

import numpy as np
from matplotlib import pyplot

from . import fixed_bound
from .curves import errors
from .figures import QUIET, RAW, TRACK, TRUTH, Picture, metres, plain_log, svg_text
from .output import Output, read_table
from .scenario import Array

COLOURS = ("#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#f0e442", "#d55e00", "#8c564b", "#7f7f7f")


def field_picture(output: Output) -> Picture | None:
    """Of the first run."""
    run = int(output.runs["run"][0])
    track = output.one_run(run)
    if output.scenario is None or output.nodes is None or not len(track["time_s"]):
        return None
    figure, axes = pyplot.subplots(figsize=(5.6, 5.4))
    axes.grid(False)
    first = 0
    sizes = [int(size) for size in output.scenario.value("clusters.nodes")]
    for cluster, size in enumerate(sizes):
        nodes = output.nodes[first : first + size]
        colour = COLOURS[cluster % len(COLOURS)]
        axes.scatter(*nodes.T, s=30, color=colour, linewidths=0, label=f"cluster {cluster + 1}", zorder=2)
        first += size
    axes.plot(track["true_x_m"], track["true_y_m"], color=TRUTH, linewidth=2.4, alpha=0.8, label="path of the target")
    axes.plot(track["x_m"], track["y_m"], ".", color=TRACK, markersize=3, label="fused", zorder=3)
    sink = [output.scenario.number(f"network.sink_{axis}_m") for axis in "xy"]
    axes.plot(*sink, "s", color=TRACK, markersize=8, markeredgecolor="white", label="sink")
    metres(axes, output.scenario)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.11), ncols=4, handletextpad=0.4, columnspacing=1.2)
    said = ", ".join(map(str, sizes))
    return Picture("Field", svg_text(figure), f"Run {run}: {len(sizes)} clusters of {said} nodes.")


def rms_over_time(table: dict[str, Array]) -> tuple[Array, Array]:
    """Times, and the root mean square over the runs there."""
    error = errors(table)
    known = np.isfinite(error)
    times, index = np.unique(table["time_s"][known], return_inverse=True)
    return times, np.sqrt(np.bincount(index, error[known] ** 2) / np.bincount(index))


def error_picture(output: Output) -> Picture | None:
    times, fused = rms_over_time(output.track)
    if output.scenario is None or not len(times):
        return None
    figure, axes = pyplot.subplots(figsize=(6.4, 3.8))
    if (output.folder / "local.csv").exists():
        local = read_table(output.folder / "local.csv", ("cluster", "time_s", "x_m", "y_m", "true_x_m", "true_y_m"))
        for cluster in np.unique(local["cluster"]):
            rows = {name: column[local["cluster"] == cluster] for name, column in local.items()}
            colour = COLOURS[int(cluster) % len(COLOURS)]
            label = f"cluster {int(cluster) + 1} by itself"
            axes.plot(*rms_over_time(rows), color=colour, linewidth=1.0, label=label)
    axes.plot(times, fused, color=TRACK, linewidth=1.8, label="fused")
    if output.nodes is not None:
        step = output.scenario.number("sensor.interval_s")
        steps = round(output.scenario.number("source.duration_s") / step)
        paths = fixed_bound.paths(output.scenario, steps, fixed_bound.PATHS)
        bound = fixed_bound.bound(output.scenario, output.nodes[:-1], paths)
        look = {"color": TRUTH, "linewidth": 1.2, "linestyle": (0, (4, 2))}
        axes.plot(times, np.interp(times, step * np.arange(steps + 1), bound), label="posterior bound", **look)
    plain_log(axes, "y")
    axes.set_xlabel("time, s")
    axes.set_ylabel("RMSE, m")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=3, columnspacing=1.4)
    runs = len(output.runs["run"])
    return Picture(
        "Error against time",
        svg_text(figure),
        f"Root mean square error of the position over {runs} run{'s' if runs > 1 else ''}, of what the sink makes of "
        "all clusters and of each by itself, and the posterior Cramér-Rao bound of all ranges.",
    )


def consistency_picture(output: Output) -> Picture | None:
    """Mean normalised squared errors, of four states."""
    rows = [("fused", "anees")] + [(f"cluster {c}", f"local_anees_{c}") for c in range(1, 5)]
    known = [(label, output.pooled(metric)) for label, metric in rows if np.isfinite(output.pooled(metric))]
    if not known:
        return None
    figure, axes = pyplot.subplots(figsize=(6.4, 2.6), layout="constrained")
    colours = [TRACK if label == "fused" else QUIET for label, _ in known]
    bars = axes.bar([label for label, _ in known], [value for _, value in known], color=colours, width=0.62)
    axes.bar_label(bars, fmt="%.2f", padding=2)
    axes.axhline(4.0, color=RAW, linewidth=1.2, linestyle=(0, (4, 2)), label="exact: 4")
    axes.margins(y=0.15)
    axes.grid(axis="x", visible=False)
    axes.set_axisbelow(True)
    axes.set_ylabel("mean NEES")
    axes.legend(loc="lower right")
    return Picture(
        "Stated uncertainty",
        svg_text(figure),
        "Mean normalised squared error of position and velocity: 4 is exact, less is careful, more is too sure of "
        "itself.",
    )
