"""Figures of several targets that are heard: which is where, who is taken for whom, who follows it, and what became of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from .figures import QUIET, TRUTH, Picture, metres, plain_log, svg_text
from .metrics import errors
from .output import Output, read_table
from .scenario import Array

COLOURS = ("#d6246e", "#00a58e", "#e8710a", "#3b6fe0", "#8d5bd6", "#7a6a00", "#8c564b", "#59626e")
MODES = ("single", "sparse", "group")
LOST_M = 150.0  # a target that goes on for so long without an estimate is lost
WIDTH = 6.2  # inches, of a map
EXTENTS = 12  # circles of each group, at most
POINTS, BINS = 4000, 30  # of the errors, and of their median
PLACES = ("x_m", "y_m")

Table = dict[str, Array]


def truths(output: Output) -> Table | None:
    file = output.folder / "truth.csv"
    return read_table(file, ("run", "time_s", "target", *PLACES)) if file.exists() else None


def watches(output: Output) -> Table | None:
    file = output.folder / "watch.csv"
    columns = ("run", "time_s", "target", "number", "head", "prince", *PLACES)
    return read_table(file, columns) if file.exists() else None


def where(table: Table, chosen: Array) -> Table:
    return {name: column[chosen] for name, column in table.items()}


def numbers(track: Table) -> dict[float, int]:
    """Of one run: the true target that each identifier was first taken for."""
    known = np.isfinite(track["number"])
    found: dict[float, int] = {}
    for identifier, number in zip(track["target"][known], track["number"][known]):
        found.setdefault(float(identifier), int(number))
    return found


def members(track: Table, row: int) -> list[float]:
    """The identifiers that an estimate is of: its own, or those of its group."""
    if not track["members"][row] > 1:
        return [float(track["target"][row])]
    return [float(track[f"of_{i}"][row]) for i in range(4) if np.isfinite(track[f"of_{i}"][row])]


def pieces(track: Table, identifier: float) -> list[Table]:
    """The estimates of one identifier, parted where its target was in the group of another."""
    mine = where(track, track["target"] == identifier)
    elsewhere = np.any([track[f"of_{i}"] == identifier for i in range(4)], axis=0) & (track["target"] != identifier)
    joined = np.searchsorted(np.sort(track["time_s"][elsewhere]), mine["time_s"], "right")
    return [where(mine, part) for part in np.split(np.arange(len(joined)), np.flatnonzero(np.diff(joined)) + 1)]


def is_scattered(output: Output) -> bool:
    return output.scenario is not None and output.scenario.value("source.path") == "scattered"


def colour(number: float) -> str:
    return COLOURS[int(number) % len(COLOURS)] if np.isfinite(number) and number >= 0 else QUIET


def _legend(figure: Figure, shown: list[Line2D]) -> None:
    figure.legend(handles=shown, loc="outside lower center", ncols=4, handletextpad=0.5, columnspacing=1.3)


def _ground(axes: Axes, output: Output) -> None:
    axes.grid(False)
    if output.nodes is not None:
        axes.scatter(*output.nodes.T, s=1.8, color="#b6bcc4", linewidths=0, zorder=1)
    metres(axes, output.scenario)


def _close(axes: Axes, true: Table) -> None:
    """No more of the field than what the targets crossed, and some air."""
    low = np.array([true[axis].min() for axis in PLACES])
    high = np.array([true[axis].max() for axis in PLACES])
    room = 0.08 * float((high - low).max()) + 40.0
    axes.set_xlim(low[0] - room, high[0] + room)
    axes.set_ylim(low[1] - room, high[1] + room)
    wide, tall = high - low + 2.0 * room
    axes.figure.set_size_inches(WIDTH, float(np.clip(WIDTH * tall / wide + 0.6, 2.4, 7.0)))


def _draw_truth(axes: Axes, true: Table, grey: bool = False) -> None:
    for number in np.unique(true["target"]):
        mine = where(true, true["target"] == number)
        axes.plot(mine["x_m"], mine["y_m"], color="#c3c9d1" if grey else colour(number), alpha=0.35, linewidth=5, zorder=2)


def field_picture(output: Output) -> Picture | None:
    """Of the first run, whose nodes are known."""
    true = truths(output)
    run = int(output.runs["run"][0])
    if true is None or not (true["run"] == run).any():
        return None
    true, track = where(true, true["run"] == run), output.one_run(run)
    figure, axes = pyplot.subplots(figsize=(WIDTH, WIDTH), layout="constrained")
    _ground(axes, output)
    if is_scattered(output):
        return _scattered_picture(figure, axes, true, track, run)
    _draw_truth(axes, true)
    taken = numbers(track)
    groups = 0
    for identifier in np.unique(track["target"]):
        mine = where(track, track["target"] == identifier)
        shade = colour(taken.get(float(identifier), -1))
        for part in pieces(track, identifier):
            axes.plot(part["x_m"], part["y_m"], color=shade, linewidth=1.1, marker=".", markersize=4, zorder=4)
        grouped = np.flatnonzero((mine["members"] > 1) & np.isfinite(mine["extent_m"]))
        groups += len(grouped)
        for row in grouped[:: max(1, len(grouped) // EXTENTS)]:
            place = (mine["x_m"][row], mine["y_m"][row])
            axes.add_patch(
                Circle(place, mine["extent_m"][row], fill=False, color=shade, linestyle="--", linewidth=1.0, zorder=3)
            )
        if len(mine["x_m"]):
            text = {"fontsize": 7.5, "color": shade, "xytext": (3, 4), "textcoords": "offset points", "zorder": 5}
            axes.annotate(f"{identifier:.0f}", (mine["x_m"][0], mine["y_m"][0]), **text)
    _close(axes, true)
    shown = [
        Line2D([], [], color=QUIET, alpha=0.35, linewidth=5, label="true path"),
        Line2D([], [], color=QUIET, linewidth=1.1, marker=".", label="estimates"),
        Line2D([], [], color="#b6bcc4", marker="o", markersize=3, linewidth=0, label="motes"),
    ]
    shown += [Line2D([], [], color=QUIET, linestyle="--", label="extent of a group")] if groups else []
    _legend(figure, shown)
    count = len(np.unique(true["target"]))
    said = "the target and the estimates of it, with the identifier that the network gave it."
    if count > 1:
        said = (
            f"{count} targets, each in its colour, and the estimates in the colour of the target they were first taken for, "
            "with the identifier that the network gave it: a line of one colour on a path of another was exchanged."
        )
    return Picture("Targets", svg_text(figure), f"Run {run}: {said}")


def _scattered_picture(figure: Figure, axes: Axes, true: Table, track: Table, run: int) -> Picture:
    axes.scatter(true["x_m"], true["y_m"], s=12, color=TRUTH, linewidths=0, zorder=3)
    known = np.isfinite(track["true_x_m"])
    ends = [np.stack([track[f"{end}x_m"][known], track[f"{end}y_m"][known]], axis=-1) for end in ("true_", "")]
    axes.add_collection(LineCollection(list(np.stack(ends, axis=1)), colors=COLOURS[0], linewidths=1.0, zorder=4))
    axes.scatter(track["x_m"], track["y_m"], s=9, marker="x", color=COLOURS[0], linewidths=0.9, zorder=4)
    _legend(
        figure,
        [
            Line2D([], [], color=TRUTH, marker="o", markersize=4, linewidth=0, label="targets"),
            Line2D([], [], color=COLOURS[0], marker="x", markersize=4, linewidth=1.0, label="estimates, their errors"),
            Line2D([], [], color="#b6bcc4", marker="o", markersize=3, linewidth=0, label="motes"),
        ],
    )
    return Picture(
        "Targets",
        svg_text(figure),
        f"Run {run}: {len(true['x_m']):,} targets at places of their own, one after the other, of which {int(known.sum()):,} were located.",
    )


def heads_picture(output: Output) -> Picture | None:
    """Who led each target, one after the other, in the first run."""
    true, told = truths(output), watches(output)
    run = int(output.runs["run"][0])
    if true is None or told is None or output.nodes is None or not (told["run"] == run).any():
        return None
    true, told = where(true, true["run"] == run), where(told, told["run"] == run)
    taken = numbers(told)
    figure, axes = pyplot.subplots(figsize=(WIDTH, WIDTH), layout="constrained")
    _ground(axes, output)
    _draw_truth(axes, true, grey=True)
    handed = chosen = 0
    for identifier in np.unique(told["target"]):
        mine = where(told, told["target"] == identifier)
        known = (mine["head"] >= 0) & (mine["head"] < len(output.nodes))
        mine = where(mine, known)
        if not known.any():
            continue
        shade = colour(taken.get(float(identifier), -1))
        heads = output.nodes[mine["head"].astype(int)]
        as_told = np.concatenate([[False], mine["head"][1:] == mine["prince"][:-1]])
        handed += len(heads) - 1
        chosen += int(as_told.sum())
        axes.plot(*heads.T, color=shade, linewidth=1.0, zorder=3)
        mark = {"marker": "D", "s": 30, "linewidths": 1.2, "zorder": 4}
        axes.scatter(*heads[as_told].T, color=shade, **mark)
        axes.scatter(*heads[~as_told].T, facecolors="white", edgecolors=shade, **mark)
    _close(axes, true)
    _legend(
        figure,
        [
            Line2D([], [], color="#c3c9d1", linewidth=5, label="true path"),
            Line2D([], [], color=QUIET, marker="D", markersize=5, linewidth=1.0, label="head, as chosen before"),
            Line2D([], [], color=QUIET, marker="D", markersize=5, linewidth=1.0, markerfacecolor="white", label="any other"),
        ],
    )
    return Picture(
        "Heads",
        svg_text(figure),
        f"Run {run}: the nodes that led a target, one after the other, in its colour. {chosen} of {handed} hand-overs went to "
        "the prince that the head before had chosen; open marks are heads that began, or came by an exception or a competition.",
    )


def modes_picture(output: Output) -> Picture | None:
    """By which identifier and how each was followed over time, in the first run."""
    run = int(output.runs["run"][0])
    track = output.one_run(run)
    identifiers = np.unique(track["target"])
    if is_scattered(output) or not 1 < len(identifiers) <= 16:
        return None
    taken = numbers(track)
    looks = {"single": 2.0, "sparse": 5.0, "group": 11.0}
    figure, axes = pyplot.subplots(figsize=(6.4, 1.1 + 0.32 * len(identifiers)))
    for level, identifier in enumerate(identifiers):
        shade = colour(taken.get(float(identifier), -1))
        for part in pieces(track, identifier):
            begin, end = part["time_s"][:-1], part["time_s"][1:]
            for mode, width in enumerate(looks.values()):
                lines = [[(begin[i], level), (end[i], level)] for i in np.flatnonzero(part["mode"][:-1] == mode)]
                axes.add_collection(LineCollection(lines, colors=shade, linewidths=width, capstyle="butt"))
            axes.plot(part["time_s"], np.full(len(part["time_s"]), level), "|", color=TRUTH, markersize=4, alpha=0.5)
    axes.set_yticks(range(len(identifiers)), [f"{identifier:.0f}" for identifier in identifiers])
    axes.set_ylim(len(identifiers) - 0.5, -0.5)
    axes.margins(x=0.02)
    axes.grid(axis="y", visible=False)
    axes.set_xlabel("time, s")
    shown = [
        Line2D([], [], color=QUIET, linewidth=width, solid_capstyle="butt", label=mode) for mode, width in looks.items()
    ]
    axes.legend(handles=shown, loc="upper center", bbox_to_anchor=(0.5, 1.0 + 0.45 / len(identifiers)), ncols=3)
    return Picture(
        "Modes",
        svg_text(figure),
        f"Run {run}: how each target was followed under its identifier, and when it was located (ticks). A group goes on under the "
        "lowest identifier of its targets.",
    )


def error_picture(output: Output) -> Picture | None:
    """Of all runs, whose estimates come at any time."""
    error = errors(output.track)
    known = np.flatnonzero(np.isfinite(error))
    if not len(known):
        return None
    time, number = output.track["time_s"][known], output.track["number"][known]
    error = np.maximum(error[known], 1e-2)
    figure, axes = pyplot.subplots(figsize=(6.4, 3.8), layout="constrained")
    shown = []
    few = slice(None, None, max(1, len(known) // POINTS))
    for target in [*np.unique(number[np.isfinite(number)]), np.nan]:
        mine = number[few] == target if np.isfinite(target) else ~np.isfinite(number[few])
        if mine.any():
            look = {"color": colour(target), "marker": "o", "markersize": 3, "linewidth": 0}
            axes.plot(time[few][mine], error[few][mine], alpha=0.6, markeredgewidth=0, **look)
            shown.append(Line2D([], [], label=f"target {target:.0f}" if np.isfinite(target) else "group", **look))
    shown = shown if len(shown) <= len(COLOURS) else []
    edges = np.linspace(time.min(), time.max() + 1e-9, BINS + 1)
    groups = [error[(time >= low) & (time < high)] for low, high in zip(edges, edges[1:])]
    middle = [(float(low + high) / 2.0, float(np.median(g))) for low, high, g in zip(edges, edges[1:], groups) if len(g)]
    axes.plot(*zip(*middle), color=TRUTH, linewidth=1.6)
    shown.append(Line2D([], [], color=TRUTH, linewidth=1.6, label="median"))
    plain_log(axes, "y")
    axes.set_xlabel("time, s")
    axes.set_ylabel("error, m")
    _legend(figure, shown)
    runs = len(output.runs["run"])
    return Picture(
        "Error against time",
        svg_text(figure),
        f"Distance of the estimates of {runs} run{'s' if runs > 1 else ''} from the target that they are compared with at the same "
        "instant (groups: from the middle of their targets), on a logarithmic scale.",
    )


@dataclass
class Fate:
    """What became of one true target over all runs."""

    number: int
    runs: int = 0  # in which it was there
    found: int = 0
    lost: int = 0
    swapped: int = 0
    identifiers: int = 0
    estimates: int = 0
    grouped: int = 0  # estimates of groups that it was in
    error_m: float = float("nan")  # mean


def fates(output: Output) -> list[Fate]:
    true = truths(output)
    if true is None or is_scattered(output):
        return []
    found = {int(number): Fate(int(number)) for number in np.unique(true["target"])}
    errors: dict[int, list[float]] = {number: [] for number in found}
    for run in output.runs["run"]:
        there, track = where(true, true["run"] == run), output.one_run(int(run))
        taken = numbers(track)
        paths = {number: where(there, there["target"] == number) for number in found}
        told: dict[int, list[int]] = {number: [] for number in found}  # rows of each target's estimates
        for row in range(len(track["time_s"])):
            for number in {taken[one] for one in members(track, row) if one in taken}:
                if number in told:
                    told[number].append(row)
        for number, fate in found.items():
            path, rows = paths[number], told[number]
            if not len(path["time_s"]):
                continue
            fate.runs += 1
            if not rows:
                continue
            alone = [row for row in rows if not track["members"][row] > 1]
            fate.found += 1
            fate.lost += way_after(path, track["time_s"][rows[-1]]) > LOST_M
            fate.identifiers += sum(1 for one in taken.values() if one == number)
            fate.estimates += len(rows)
            fate.grouped += len(rows) - len(alone)
            fate.swapped += bool(alone) and is_nearer_another(paths, number, track, alone[-1])
            errors[number] += [distance(path, track, row) for row in alone]
    for number, fate in found.items():
        known = np.array(errors[number])
        known = known[np.isfinite(known)]
        fate.error_m = float(known.mean()) if len(known) else float("nan")
    return list(found.values())


def way_after(path: Table, time: float) -> float:
    """Metres that a target still goes after a time."""
    later = path["time_s"] >= time
    return float(np.hypot(np.diff(path["x_m"][later]), np.diff(path["y_m"][later])).sum())


def distance(path: Table, track: Table, row: int) -> float:
    """Of an estimate from a target, between two rows of its path on the line that joins them; NaN where it is not there."""
    time = track["time_s"][row]
    if not len(path["time_s"]) or not path["time_s"][0] - 1e-6 <= time <= path["time_s"][-1] + 1e-6:
        return float("nan")
    x, y = (np.interp(time, path["time_s"], path[axis]) for axis in PLACES)
    return float(np.hypot(track["x_m"][row] - x, track["y_m"][row] - y))


def is_nearer_another(paths: dict[int, Table], number: int, track: Table, row: int) -> bool:
    away = {target: distance(path, track, row) for target, path in paths.items()}
    return any(one < away[number] for one in away.values())
