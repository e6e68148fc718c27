"""Figures of a search for a source of gas: how it walked, and how its end compares with the bound."""

from __future__ import annotations

import math

import numpy as np
from matplotlib import pyplot

from .figures import QUIET, RAW, SECOND, TRACK, TRUTH, Picture, draw_ellipses, metres, plain_log, svg_text
from .output import Output
from .ranged_figures import HEAD, places
from .scenario import Array, Scenario

SUCCESS_M = 50.0
SURE_M = 30.0  # larger ellipses would hide the rest


def mean_ppm(scenario: Scenario, at: Array, source: Array) -> Array:
    """Mean concentration at places [...][x, y] (Zhang, Eq. (1)), within 1 m of the source as at 1 m."""
    towards = scenario.number("wind.direction_rad")
    mixing = scenario.number("source.mixing_m2ps")
    offset = at - source
    distance = np.maximum(np.hypot(offset[..., 0], offset[..., 1]), 1.0)
    along = offset @ np.array([np.cos(towards), np.sin(towards)])
    decay = np.exp(-scenario.number("wind.speed_mps") / (2.0 * mixing) * (distance - along))
    return np.asarray(scenario.number("source.rate_mlps") / (2.0 * np.pi * mixing * distance) * decay)


def walk_picture(output: Output) -> Picture | None:
    """Of the first run, whose nodes are known."""
    scenario, run = output.scenario, int(output.runs["run"][0])
    track = output.one_run(run)
    count = len(track["time_s"])
    if scenario is None or output.nodes is None or not count:
        return None
    figure, axes = pyplot.subplots(figsize=(5.6, 5.2))
    axes.grid(False)
    source = np.array([track["true_x_m"][-1], track["true_y_m"][-1]])
    x = np.linspace(0.0, scenario.number("field.width_m"), 200)
    y = np.linspace(0.0, scenario.number("field.height_m"), 200)
    ppm = mean_ppm(scenario, np.stack(np.meshgrid(x, y), axis=-1), source)
    if ppm.max() > 0.0:
        levels = ppm.max() * 10.0 ** np.arange(-4.0, 0.1, 0.5)
        axes.contour(x, y, ppm, levels=levels, colors=QUIET, linewidths=0.6, alpha=0.6, zorder=0)
    axes.scatter(*output.nodes.T, s=7, color=QUIET, linewidths=0, label="nodes", zorder=1)
    where, known = places(output, track["head"])
    axes.plot(*where[known].T, color=HEAD, linewidth=1.1, alpha=0.8, zorder=2)
    axes.scatter(*where[known].T, s=34, color=HEAD, linewidths=0, label="heads, numbered", zorder=3)
    for number in np.flatnonzero(known):
        axes.annotate(str(number + 1), where[number], (4, 4), textcoords="offset points", fontsize=7.5, color=TRUTH)
    axes.plot(track["x_m"], track["y_m"], ".-", color=TRACK, linewidth=0.9, markersize=4, label="estimates", zorder=4)
    sure = track["sd_m"] < SURE_M
    ellipses = draw_ellipses(axes, {name: column[sure] for name, column in track.items()}, 1, TRACK)
    axes.plot(*source, "*", color=RAW, markersize=13, markeredgecolor="white", label="source", zorder=5)
    metres(axes, scenario)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=4, handletextpad=0.4, columnspacing=1.2)
    error = math.hypot(track["x_m"][-1] - source[0], track["y_m"][-1] - source[1])
    said = f" It stated a standard deviation of {track['sd_m'][-1]:.2g} m a coordinate." if sure[-1] else ""
    said += f" Ellipses: two stated standard deviations, where one is below {SURE_M:g} m." if ellipses else ""
    return Picture(
        "The search",
        svg_text(figure),
        f"Run {run}: {count} heads, the last estimate is {error:.2g} m from the source.{said} "
        "Lines: equal mean concentration, half a power of ten apart.",
    )


def chi_squared_3(x: float) -> float:
    """Share of a chi-squared distribution with three degrees of freedom below x."""
    return math.erf(math.sqrt(x / 2.0)) - math.sqrt(2.0 * x / math.pi) * math.exp(-x / 2.0)


def bound_picture(output: Output) -> Picture | None:
    """Where each search ended beside its bound, and whether what it stated of position and rate is honest."""
    none = np.full(len(output.runs["run"]), np.nan)
    error, bound = output.runs.get("position_error_median_m", none), output.runs.get("crlb_m", none)
    known = np.isfinite(error) & np.isfinite(bound)
    if not known.any():
        return None
    nees = np.sort(output.runs.get("nees_median", none)[known & np.isfinite(output.runs.get("nees_median", none))])
    states = output.track["states"][np.isfinite(output.track["states"])]
    judged = len(nees) > 1 and len(states) > 0 and bool((states == 3).all())
    figure, panels = pyplot.subplots(1, 2 if judged else 1, figsize=(6.4, 3.1), squeeze=False, layout="constrained")
    left = panels[0, 0]
    near = known & (error < SUCCESS_M)
    ends = np.array([min(bound[known].min(), error[known].min()), max(bound[known].max(), error[known].max())])
    left.plot(ends, ends, color=QUIET, linewidth=1.0, linestyle=(0, (4, 2)), label="bound")
    left.plot(bound[near], error[near], ".", color=TRACK, markersize=5, alpha=0.7, label="within 50 m")
    if (known & ~near).any():
        left.plot(bound[known & ~near], error[known & ~near], ".", color=RAW, markersize=5, label="farther off")
    plain_log(left, "x")
    plain_log(left, "y")
    left.set_xlabel("Cramér-Rao bound, m")
    left.set_ylabel("error at the end, m")
    left.legend(fontsize=8)
    caption = f"Error of {int(known.sum())} searches over the Cramér-Rao bound of the samples that each heard."
    if judged:
        right = panels[0, 1]
        stated = [100.0 * chi_squared_3(value) for value in nees]
        right.plot([0, 100], [0, 100], color=QUIET, linewidth=1.0, linestyle=(0, (4, 2)))
        right.plot(stated, np.arange(1, len(nees) + 1) / len(nees) * 100.0, color=SECOND, linewidth=1.6)
        right.set_xlim(0, 100)
        right.set_ylim(0, 100)
        right.set_aspect("equal")
        right.set_xlabel("stated probability, %")
        right.set_ylabel("actual share inside, %")
        caption += (
            " Right: how many ends lie inside the stated ellipsoid of position and rate; "
            f"median NEES {np.median(nees):.2f} (exact: 2.37). Below the dashed line the tracker is too sure of itself."
        )
    return Picture("Beside the bound", svg_text(figure), caption)
