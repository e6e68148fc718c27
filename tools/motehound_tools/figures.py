"""The figures, each drawn from an output and returned as one SVG text with a sentence that says what it shows."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import matplotlib

matplotlib.use("svg")
import numpy as np
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.colors import LinearSegmentedColormap, PowerNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .field import concentration
from .metrics import errors, normalised
from .output import Output, Sweep
from .scenario import Array, Scenario

# Colours that stay apart for colour-blind readers (Okabe and Ito) and on paper.
TRUTH, TRACK, RAW, SECOND, QUIET = "#1b1f24", "#0072b2", "#d55e00", "#009e73", "#8a929c"
CLOUD = LinearSegmentedColormap.from_list("cloud", ["#ffffff", "#fdecc8", "#f9c978", "#ee9b3f", "#cf6a21", "#8f3d12"])

matplotlib.rcParams.update(
    {
        "svg.hashsalt": "motehound",  # the same data give the same bytes
        "font.size": 9.5,
        "axes.titlesize": 10,
        "axes.titleweight": "bold",
        "axes.edgecolor": "#b6bcc4",
        "axes.labelcolor": "#3b434d",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "#e6e9ed",
        "grid.linewidth": 0.7,
        "xtick.color": "#59626e",
        "ytick.color": "#59626e",
        "legend.frameon": False,
        "lines.solid_capstyle": "round",
    }
)


@dataclass(frozen=True)
class Picture:
    """A figure for the page: its heading, its SVG, what it says (also to a reader who cannot see it)."""

    title: str
    svg: str
    caption: str


def svg_text(figure: Figure, dpi: int = 110) -> str:
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={"Date": None, "Creator": None}, bbox_inches="tight", dpi=dpi)
    pyplot.close(figure)
    text = stream.getvalue()
    return text[text.index("<svg") :]


def metres(axes: Axes, scenario: Scenario | None, margin: float = 0.0) -> None:
    axes.set_aspect("equal")
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    axes.set_axisbelow(True)
    if scenario:
        axes.set_xlim(-margin, scenario.number("field.width_m") + margin)
        axes.set_ylim(-margin, scenario.number("field.height_m") + margin)


def draw_cloud(axes: Axes, scenario: Scenario, time: float, cells: int = 220) -> Any:
    """The concentration at `time` as a map; the dashed line is where it passes the tracker's threshold."""
    width, height = scenario.number("field.width_m"), scenario.number("field.height_m")
    x, y = (np.arange(cells) + 0.5) / cells * width, (np.arange(cells) + 0.5) / cells * height
    places = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    level = concentration(scenario, places, time).reshape(cells, cells)
    image = axes.imshow(
        level,
        extent=(0, width, 0, height),
        origin="lower",
        cmap=CLOUD,
        norm=PowerNorm(0.45, vmin=0.0, vmax=float(np.percentile(level, 99.8)) or 1.0),
        interpolation="bilinear",
        zorder=0,
    )
    threshold = scenario.number("tracker.chi")
    if level.min() < threshold < level.max():
        axes.contour(x, y, level, levels=[threshold], colors=QUIET, linewidths=0.8, linestyles="--", zorder=1)
    return image


def draw_ellipses(axes: Axes, track: dict[str, Array], every: int, colour: str, scale: float = 2.0) -> bool:
    """The stated covariances as ellipses of `scale` standard deviations, one in `every` estimates."""
    rows = np.flatnonzero(np.isfinite(track["cov_xx_m2"] + track["cov_xy_m2"] + track["cov_yy_m2"]))[::every]
    if not len(rows):
        return False
    covariance = np.empty((len(rows), 2, 2))
    covariance[:, 0, 0], covariance[:, 1, 1] = track["cov_xx_m2"][rows], track["cov_yy_m2"][rows]
    covariance[:, 0, 1] = covariance[:, 1, 0] = track["cov_xy_m2"][rows]
    values, vectors = np.linalg.eigh(covariance)
    size = 2.0 * scale * np.sqrt(np.maximum(values, 0.0))
    angle = np.degrees(np.arctan2(vectors[:, 1, 1], vectors[:, 0, 1]))
    ellipses = EllipseCollection(
        size[:, 1],
        size[:, 0],
        angle,
        units="xy",
        offsets=np.stack([track["x_m"][rows], track["y_m"][rows]], axis=-1),
        transOffset=axes.transData,
        facecolors=colour,
        edgecolors=colour,
        linewidths=0.7,
        zorder=3,
    )
    ellipses.set_alpha(0.28)
    axes.add_collection(ellipses)
    return True


def typical_run(output: Output) -> int:
    """The run whose error is the median one: neither the best nor the worst is shown as the example."""
    runs = output.runs["run"]
    score = output.runs.get("position_rmse_m", np.zeros(len(runs)))
    order = np.argsort(np.where(np.isfinite(score), score, np.inf), kind="stable")
    return int(runs[order[len(order) // 2]])


def field_picture(output: Output) -> Picture | None:
    """Of the first run, whose nodes are known."""
    scenario, nodes = output.scenario, output.nodes
    run = int(output.runs["run"][0])
    track = output.one_run(run)
    if scenario is None or nodes is None or not len(track["time_s"]):
        return None
    time = float(track["time_s"][int(0.6 * len(track["time_s"]))])
    figure, axes = pyplot.subplots(figsize=(5.6, 4.7))
    axes.grid(False)
    image = draw_cloud(axes, scenario, time)
    axes.scatter(nodes[:, 0], nodes[:, 1], s=2.2, color="#59626e", alpha=0.55, linewidths=0, label="nodes", zorder=2)
    past = scenario.route.position(np.linspace(0.0, time, 400))
    axes.plot(past[:, 0], past[:, 1], color=TRUTH, linewidth=1.4, label="path of the source", zorder=3)
    axes.plot(*past[-1], "o", color=TRUTH, markersize=6, markeredgecolor="white", label="source", zorder=4)
    now = track["time_s"] == time
    axes.plot(
        track["x_m"][now],
        track["y_m"][now],
        "x",
        color=TRACK,
        markersize=9,
        markeredgewidth=2,
        label="estimate",
        zorder=5,
    )
    metres(axes, scenario)
    bar = figure.colorbar(image, ax=axes, shrink=0.86, pad=0.02, extend="max")
    bar.set_label("concentration, g/m²")
    bar.outline.set_visible(False)
    axes.legend(
        loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=4, handletextpad=0.4, columnspacing=1.2, markerscale=1.3
    )
    return Picture(
        "Field",
        svg_text(figure),
        f"Concentration at t = {time:g} s of run {run}, integrated from the release along the true path; "
        f"{int(scenario.number('network.nodes')):,} nodes. "
        f"Dashed: the tracker's threshold of {scenario.number('tracker.chi'):g} g/m².",
    )


def track_picture(output: Output, run: int) -> Picture | None:
    track = output.one_run(run)
    if not len(track["time_s"]):
        return None
    figure, axes = pyplot.subplots(figsize=(5.2, 4.7))
    raw = np.isfinite(track["raw_x_m"])
    apart = raw & (np.hypot(track["raw_x_m"] - track["x_m"], track["raw_y_m"] - track["y_m"]) > 1e-6)
    if apart.any():
        axes.plot(
            track["raw_x_m"][raw],
            track["raw_y_m"][raw],
            ".",
            color=RAW,
            markersize=4,
            alpha=0.75,
            label="before the filter",
        )
    if np.isfinite(track["true_x_m"]).any():
        axes.plot(track["true_x_m"], track["true_y_m"], color=TRUTH, linewidth=2.6, alpha=0.85, label="truth")
    ellipses = draw_ellipses(axes, track, max(1, len(track["time_s"]) // 40), TRACK)
    axes.plot(
        track["x_m"],
        track["y_m"],
        "-",
        color=TRACK,
        linewidth=1.2,
        marker=".",
        markersize=3.5,
        label="estimate",
        zorder=4,
    )
    metres(axes, output.scenario)
    if not output.scenario:
        if output.nodes is not None:
            axes.plot(output.nodes[:, 0], output.nodes[:, 1], "^", color=QUIET, markersize=5, label="nodes", zorder=1)
        axes.margins(0.08)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, handletextpad=0.5, columnspacing=1.4)
    said = " Ellipses: two stated standard deviations." if ellipses else ""
    return Picture(
        "Track", svg_text(figure), f"Run {run}, the one of median error: {len(track['time_s'])} estimates.{said}"
    )


def plain_log(axes: Axes, which: str) -> None:
    """A logarithmic axis with numbers as one writes them."""
    axis = axes.xaxis if which == "x" else axes.yaxis
    (axes.set_xscale if which == "x" else axes.set_yscale)("log")
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
    if which == "y":  # where there is room for them
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))


INSTANTS = 400  # of a picture; more are put together


def over_time(track: dict[str, Array], values: Array) -> tuple[Array, Array]:
    """Times at which at least one estimate has a value, and the 5, 25, 50, 75, 95 % quantiles there [5][time]."""
    known = np.isfinite(values)
    times, index = np.unique(track["time_s"][known], return_inverse=True)
    together = 4 * len(times) // INSTANTS if len(times) > INSTANTS else 1
    times, index = times[::together] if together > 1 else times, index // together
    order = np.argsort(index, kind="stable")
    groups = np.split(values[known][order], np.cumsum(np.bincount(index))[:-1]) if len(times) else []
    return times, np.array([np.percentile(g, [5, 25, 50, 75, 95]) for g in groups]).reshape(-1, 5).T


def error_picture(output: Output) -> Picture | None:
    times, quantiles = over_time(output.track, errors(output.track))
    if not len(times):
        return None
    runs = len(output.runs["run"])
    figure, axes = pyplot.subplots(figsize=(6.4, 3.5))
    floor = max(float(np.min(quantiles[2])) * 0.2, 1e-4)
    if runs > 1:
        axes.fill_between(
            times,
            np.maximum(quantiles[0], floor),
            quantiles[4],
            color=TRACK,
            alpha=0.13,
            linewidth=0,
            label="5 to 95 % of runs",
        )
        axes.fill_between(
            times,
            np.maximum(quantiles[1], floor),
            quantiles[3],
            color=TRACK,
            alpha=0.25,
            linewidth=0,
            label="25 to 75 %",
        )
    axes.plot(
        times,
        np.maximum(quantiles[2], floor),
        color=TRACK,
        linewidth=1.6,
        label="estimate, median" if runs > 1 else "estimate",
    )
    raw_times, raw = over_time(output.track, errors(output.track, "raw_"))
    if len(raw_times) and not (len(raw_times) == len(times) and np.allclose(raw, quantiles)):
        axes.plot(raw_times, np.maximum(raw[2], floor), color=RAW, linewidth=1.0, label="before the filter, median")
    sink_times, sink = over_time(output.track, errors(output.track, "sink_"))
    if len(sink_times):
        axes.plot(sink_times, np.maximum(sink[2], floor), color=RAW, linewidth=1.0, label="at the sink, median")
    stated_times, stated = over_time(output.track, output.track["sd_m"])
    if len(stated_times):
        # The median of a plane error whose coordinates have this standard deviation.
        expected = stated[2] * np.sqrt(2.0 * np.log(2.0))
        axes.plot(
            stated_times, expected, color=SECOND, linewidth=1.1, linestyle=(0, (4, 2)), label="as stated by the tracker"
        )
    plain_log(axes, "y")
    axes.set_xlabel("time, s")
    axes.set_ylabel("error, m")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=3, columnspacing=1.4)
    band = f" over {runs} runs" if runs > 1 else ""
    return Picture(
        "Error against time",
        svg_text(figure),
        f"Distance of the estimate from the true position at the same instant{band}, on a logarithmic scale.",
    )


def distribution_picture(output: Output) -> Picture | None:
    """How often the error stays below a value, and whether the stated covariance is honest about it."""
    error = np.sort(errors(output.track)[np.isfinite(errors(output.track))])
    if len(error) < 2:
        return None
    nees = np.sort(normalised(output.track)[np.isfinite(normalised(output.track))])
    figure, panels = pyplot.subplots(1, 2 if len(nees) else 1, figsize=(6.4, 2.9), squeeze=False, layout="constrained")
    left = panels[0, 0]
    left.plot(np.maximum(error, 1e-4), np.arange(1, len(error) + 1) / len(error) * 100.0, color=TRACK, linewidth=1.6)
    plain_log(left, "x")
    left.set_xlabel("error, m")
    left.set_ylabel("share of estimates below, %")
    left.set_ylim(0, 100)
    left.set_title("Error")
    caption = (
        f"Left: share of the {len(error):,} estimates whose error is below a value."
        if len(nees)
        else f"Share of the {len(error):,} estimates whose error is below a value."
    )
    if len(nees):
        right = panels[0, 1]
        stated = 1.0 - np.exp(-nees / 2.0)  # chi-squared with two degrees of freedom
        actual = np.arange(1, len(nees) + 1) / len(nees)
        right.plot([0, 100], [0, 100], color=QUIET, linewidth=1.0, linestyle=(0, (4, 2)))
        right.plot(stated * 100.0, actual * 100.0, color=TRACK, linewidth=1.6)
        right.set_xlim(0, 100)
        right.set_ylim(0, 100)
        right.set_aspect("equal")
        right.set_xlabel("stated probability, %")
        right.set_ylabel("actual share inside, %")
        right.set_title("Stated uncertainty")
        caption += (
            " Right: how many errors lie inside the stated ellipse of a given probability; above the dashed line the "
            "tracker is more careful than it need be, below it too sure of itself."
        )
    return Picture("Distribution", svg_text(figure), caption)


# What the ledger's columns and rows stand for, and their colours.
STATES = {
    "sensing": ("sensing", "#e69f00"),
    "cpu": ("computing", "#cc79a7"),
    "transmit": ("transmitting", "#d55e00"),
    "receive": ("receiving", "#0072b2"),
    "listen": ("listening", "#a6c8de"),
    "sleep": ("sleeping", "#e1e5ea"),
}
CAUSES = {
    "localisation": ("sampling and computing", "#009e73"),
    "measuring": ("asking and answering", "#56b4e9"),
    "clustering": ("clusters", "#cc79a7"),
    "reporting": ("carrying reports", "#0072b2"),
    "routing": ("finding ways and neighbours", "#d55e00"),
    "time": ("keeping clocks together", "#e69f00"),
    "idle": ("waiting and sleeping", "#d5dae0"),
}
# Frames lost for any other reason are lost by a receiver.
LOST_AT_SENDER = {
    "busy": "frames given up because the channel was never free",
    "no_ack": "frames given up for want of an acknowledgement",
    "queue": "frames that the radio refused because it was full",
}


def stack(axes: Axes, parts: list[tuple[str, str, float]], title: str) -> None:
    """One bar of (name, colour, size), with a legend that gives each part's share."""
    total, left = sum(size for _, _, size in parts), 0.0
    for name, colour, size in parts:
        axes.barh([0], [size], left=left, color=colour, label=f"{name}, {100.0 * size / total:.2g} %", height=0.7)
        left += size
    axes.set_title(title, loc="left")
    axes.set_yticks([])
    axes.grid(False)
    axes.spines["left"].set_visible(False)
    axes.set_xlim(0, total)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.42), ncols=3, handlelength=1.0, columnspacing=1.2)


def energy_picture(output: Output) -> Picture | None:
    """The motes' energy by state, by cause, and by cause without that for nothing."""
    total = output.statistic("energy_mj") / 1e3
    if not total > 0.0:
        return None

    def parts(prefix: str, names: dict[str, tuple[str, str]]) -> list[tuple[str, str, float]]:
        sizes = {name: output.statistic(prefix + name) / 1e3 for name in names}
        return [(name, names[name][1], size) for name, size in sizes.items() if size > 0.0]

    by_cause = parts("energy_mj_", CAUSES)
    for_something = [part for part in by_cause if part[0] != "idle"]
    bars = [(parts("energy_mj_state_", STATES), "By state, J"), (by_cause, "By cause, J")]
    if for_something and len(for_something) < len(by_cause):
        bars.append((for_something, "By cause, without idling, J"))
    figure, rows = pyplot.subplots(len(bars), 1, figsize=(6.4, 2.0 * len(bars)), squeeze=False, layout="constrained")
    figure.get_layout_engine().set(hspace=0.14)
    for axes, (bar, title) in zip(rows[:, 0], bars):
        stack(axes, bar, title)
    said = f"All motes but the one on mains used {total:,.{0 if total >= 100.0 else 2}f} J a run."
    lifetime = output.statistic("lifetime_s")
    if np.isfinite(lifetime):
        said += f" The first battery was empty after {lifetime:,.4g} s."
    return Picture("Energy", svg_text(figure), said)


def losses_picture(output: Output) -> Picture | None:
    """Frames lost, by reason, where the ones at a receiver count receptions and the others frames."""
    columns = [name for name in output.summary["metrics"] if name.startswith("frames_lost_")]
    lost = {name.removeprefix("frames_lost_"): output.statistic(name) for name in columns}
    known = {reason: count for reason, count in lost.items() if count > 0.0}
    if not known:
        return None
    figure, axes = pyplot.subplots(figsize=(6.4, 0.8 + 0.34 * len(known)), layout="constrained")
    names = [reason.replace("_", " ") for reason in known]
    colours = [RAW if reason in LOST_AT_SENDER else TRACK for reason in known]
    bars = axes.barh(names, list(known.values()), color=colours, height=0.65)
    axes.bar_label(bars, labels=[f"{count:,.0f}" for count in known.values()], padding=4)
    axes.invert_yaxis()
    axes.set_axisbelow(True)
    axes.margins(x=0.14)
    axes.grid(axis="y", visible=False)
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axes.set_xlabel("lost, mean of the runs")
    received, sent = output.statistic("frames_received"), output.statistic("frames_sent")
    return Picture(
        "Frames lost",
        svg_text(figure),
        "Blue: receptions that failed, one for each mote that a frame did not reach. Orange: frames that their sender gave "
        f"up. Beside them {sent:,.0f} frames were sent and {received:,.0f} receptions succeeded.",
    )


AXIS_NAMES = {
    "sensor.interval_s": "sampling interval, s",
    "network.nodes": "nodes",
    "source.speed_mps": "speed of the source, m/s",
    "sensor.relative_noise": "relative noise of a reading",
    "sensor.additive_noise": "additive noise of a reading, g/m²",
    "sensor.loss": "share of readings lost",
    "radio.loss": "share of frames lost",
    "tracker.chi": "threshold, g/m²",
    "tracker.particles": "particles",
    "tracker.tolerance_m": "error tolerance, m",
    "target.speed_mph": "speed, mph",
    "target.count": "targets",
    "target.spacing_m": "between targets, m",
    "target.turn_deg": "turn, degrees",
    "network.grid": "cells along the field, each with a node",
    "network.density": "density",
    "sensor.range_noise_m": "noise of a range, m",
    "sensor.noise_correlation": "correlation of the noise",
    "target.position_sd_m": "standard deviation of the start, m",
    "fusion.report_s": "between reports, s",
    "fusion.report_loss": "share of reports lost",
    "clusters.shared": "nodes shared with the next cluster",
}


def sweep_picture(sweep: Sweep) -> Picture | None:
    name = AXIS_NAMES.get(sweep.key, sweep.key)
    values = np.array(sweep.values)
    figure, axes = pyplot.subplots(figsize=(6.4, 3.6))
    middle = np.array([o.statistic("position_rmse_m", "mean") for o in sweep.outputs])
    spread = np.array([o.statistic("position_rmse_m", "std") for o in sweep.outputs])
    if not np.isfinite(middle).any():
        pyplot.close(figure)
        return None
    axes.errorbar(
        values,
        middle,
        spread,
        color=TRACK,
        marker="o",
        markersize=4.5,
        capsize=3,
        linewidth=1.6,
        label="estimate, RMSE (mean and sd of runs)",
    )
    for metric, colour, text in (
        ("position_median_m", SECOND, "estimate, median"),
        ("raw_position_rmse_m", RAW, "before the filter, RMSE"),
        ("position_rmse_at_arrival_m", QUIET, "against the time of arrival, RMSE"),
    ):
        line = np.array([o.statistic(metric) for o in sweep.outputs])
        if np.isfinite(line).any() and not np.allclose(line, middle, equal_nan=True):
            axes.plot(values, line, color=colour, marker="o", markersize=3.5, linewidth=1.2, label=text)
    if (values > 0).all() and values.max() / values.min() >= 4.0:
        plain_log(axes, "x")
        axes.set_xticks(values, [f"{v:g}" for v in values])
    else:
        axes.set_xticks(values)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(name)
    axes.set_ylabel("error, m")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=2, columnspacing=1.4)
    return Picture(
        f"Error against {name.split(',')[0]}",
        svg_text(figure),
        f"Error of {len(sweep.outputs[0].runs['run'])} runs at each value of {sweep.key}.",
    )
