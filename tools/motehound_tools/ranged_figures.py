"""Figures of a ranged target: where it went over the whole run, and how it is followed from near."""

from __future__ import annotations

import numpy as np
from matplotlib import pyplot
from matplotlib.collections import LineCollection

from .figures import QUIET, RAW, TRACK, TRUTH, Picture, draw_ellipses, metres, svg_text
from .output import Output
from .scenario import Array

EXCERPT = 24  # samples
HEAD = "#e69f00"


def places(output: Output, ids: Array) -> tuple[Array, Array]:
    """Where nodes stand; NaN for what is no node."""
    assert output.nodes is not None
    known = np.isfinite(ids) & (ids >= 0) & (ids < len(output.nodes))
    found = np.full((len(ids), 2), np.nan)
    found[known] = output.nodes[ids[known].astype(int)]
    return found, known


def field_picture(output: Output) -> Picture | None:
    """Of the first run, whose nodes are known."""
    run = int(output.runs["run"][0])
    track = output.one_run(run)
    if output.scenario is None or output.nodes is None or not len(track["time_s"]):
        return None
    figure, axes = pyplot.subplots(figsize=(5.6, 5.4))
    axes.grid(False)
    axes.scatter(*output.nodes.T, s=3, color=QUIET, alpha=0.55, linewidths=0, label="nodes")
    heads, led = np.unique(track["head"][np.isfinite(track["head"])], return_counts=True)
    where, known = places(output, heads)
    if known.any():
        size = 4.0 + 150.0 * led[known] / max(led.sum(), 1) * len(led) / 40.0
        axes.scatter(*where[known].T, s=size, color=HEAD, alpha=0.8, linewidths=0, label="heads, by how long they led")
    axes.plot(track["true_x_m"], track["true_y_m"], color=TRUTH, linewidth=0.9, alpha=0.75, label="path of the target")
    sink = [output.scenario.number(f"network.sink_{axis}_m") for axis in "xy"]
    axes.plot(*sink, "s", color=TRACK, markersize=8, markeredgecolor="white", label="sink")
    metres(axes, output.scenario)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.11), ncols=2, handletextpad=0.4, columnspacing=1.2)
    hours = (track["time_s"][-1] - track["time_s"][0]) / 3600.0
    said = f" {len(heads):,} of the nodes were heads." if len(heads) else ""
    return Picture("Field", svg_text(figure), f"Run {run}: {hours:.3g} h among {len(output.nodes) - 1:,} nodes.{said}")


def excerpt_picture(output: Output) -> Picture | None:
    """The middle of the first run from near: what is localised, by whom, and what the sink has."""
    run = int(output.runs["run"][0])
    track = output.one_run(run)
    count = len(track["time_s"])
    if not count:
        return None
    first = max(0, (count - EXCERPT) // 2)
    track = {name: column[first : first + EXCERPT] for name, column in track.items()}
    figure, axes = pyplot.subplots(figsize=(5.6, 5.4))
    axes.plot(track["true_x_m"], track["true_y_m"], color=TRUTH, linewidth=2.6, alpha=0.85, label="truth")
    ellipses = draw_ellipses(axes, track, 1, TRACK)
    dots = {"marker": ".", "markersize": 4.5}
    axes.plot(track["x_m"], track["y_m"], color=TRACK, linewidth=1.2, label="estimate", zorder=4, **dots)
    if np.isfinite(track["sink_x_m"]).any():
        look = {"color": RAW, "linewidth": 1.0, "linestyle": (0, (3, 2))}
        axes.plot(track["sink_x_m"], track["sink_y_m"], label="what the sink has", zorder=3, **look, **dots)
    axes.set_aspect("equal")
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    x, y = axes.dataLim.intervalx, axes.dataLim.intervaly
    half = 0.62 * max(np.ptp(x), np.ptp(y))
    limits = (np.mean(x) - half, np.mean(x) + half, np.mean(y) - half, np.mean(y) + half)
    if output.nodes is not None:
        axes.scatter(*output.nodes.T, s=12, color=QUIET, alpha=0.7, linewidths=0, label="nodes", zorder=1)
        where, known = places(output, track["head"])
        if known.any():
            axes.scatter(*where[known].T, s=42, color=HEAD, marker="D", linewidths=0, label="heads", zorder=5)
            lines = np.stack([where, np.stack([track["x_m"], track["y_m"]], axis=-1)], axis=1)[known]
            axes.add_collection(LineCollection(list(lines), colors=HEAD, linewidths=0.6, alpha=0.55, zorder=2))
    axes.axis(limits)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.11), ncols=3, handletextpad=0.5, columnspacing=1.4)
    said = " Ellipses: two stated standard deviations." if ellipses else ""
    if output.nodes is not None:
        said += " Thin lines join each estimate with the head that made it."
    return Picture(
        "Track from near",
        svg_text(figure),
        f"Run {run} from {track['time_s'][0]:,.0f} to {track['time_s'][-1]:,.0f} s.{said}",
    )


def work_picture(output: Output) -> Picture | None:
    """What the clusters did beside the least that it could have been done with."""
    rows = [
        ("clusters", "clusters_least", "clusters formed", "least in hindsight"),
        ("reports_per_sample", "reports_least", "reports a sample", "least in hindsight"),
        ("position_rmse_m", "pcrb_m", "RMSE, m", "posterior Cramér-Rao bound"),
    ]
    known = [row for row in rows if all(np.isfinite(output.statistic(metric)) for metric in row[:2])]
    if not known:
        return None
    figure, panels = pyplot.subplots(1, len(known), figsize=(6.4, 2.6), squeeze=False, layout="constrained")
    for axes, (metric, bound, label, least) in zip(panels[0], known):
        values = [output.statistic(metric), output.statistic(bound)]
        spread = [output.statistic(metric, "std"), output.statistic(bound, "std")]
        axes.bar([0, 1], values, color=[TRACK, QUIET], width=0.66, yerr=spread, ecolor=TRUTH, capsize=3)
        axes.set_xticks([0, 1], ["measured", "bound"])
        axes.set_title(label)
        axes.grid(axis="x", visible=False)
        axes.set_axisbelow(True)
    said = "; ".join(f"{label}: {least}" for _, _, label, least in known)
    return Picture("Beside the bounds", svg_text(figure), f"Mean and standard deviation of the runs. Bounds - {said}.")
