"""The figures of a sweep's table, as its experiment asks for them."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet
from matplotlib import pyplot
from matplotlib.axes import Axes

from .experiment import Drawing, Experiment, Panel, Quantity, panels
from .failure import Failure
from .figures import AXIS_NAMES, QUIET, Picture, plain_log, svg_text
from .scenario import Array

COLOURS = ("#e69f00", "#cc79a7", "#009e73", "#0072b2", "#d55e00", "#56b4e9", "#8a7000", "#4d4d4d")
MARKERS, STYLES = "osD^vP", ("-", (0, (4, 2)), (0, (1, 1.5)))


@dataclass(frozen=True)
class Table:
    """A sweep's table and what it is of."""

    folder: Path
    experiment: Experiment
    version: str
    columns: dict[str, list[float | str | None]]
    curves: dict[str, list[Any]] = field(default_factory=dict)  # of experiments that draw some

    @staticmethod
    def read(folder: Path) -> Table:
        try:
            manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
            columns = pyarrow.parquet.read_table(folder / "table.parquet").to_pydict()
            experiment = Experiment.model_validate(manifest["experiment"])
            over_time = folder / "curves.parquet"
            curves = pyarrow.parquet.read_table(over_time).to_pydict() if over_time.exists() else {}
            return Table(folder, experiment, manifest["recipe"]["program"]["version"], columns, curves)
        except (OSError, ValueError, KeyError) as error:
            raise Failure(f"{folder}: expected the manifest.json and table.parquet of a sweep: {error}") from None

    def rows(self, panel: Panel, **wanted: str) -> list[int]:
        """Numbers of the rows of a panel where columns have these values, numbers by value."""
        chosen = []
        for row, title in enumerate(self.columns["panel"]):
            if title == panel.title and all(same(self.columns[key][row], value) for key, value in wanted.items()):
                chosen.append(row)
        return chosen

    def by_seed(self, rows: list[int], quantity: Quantity) -> Array:
        """The quantity of each seed, the mean over its rows; empty where the metric does not apply."""
        if quantity.metric not in self.columns:
            raise Failure(
                f"{self.folder / 'table.parquet'}: no metric `{quantity.metric}`; `motehound list --metrics` names them"
            )
        of_seed: dict[float | str | None, list[float]] = {}
        for row in rows:
            value = self.columns[quantity.metric][row]
            if value is not None:
                of_seed.setdefault(self.columns["seed"][row], []).append(float(value) * quantity.scale)
        return np.array([np.mean(values) for values in of_seed.values()])


    def over_time(self, panel: Panel, series: str, quantity: Quantity) -> tuple[Array, Array]:
        """Time, and the quantity's root mean square over the seeds at it."""
        rows = zip(*(self.curves.get(name, []) for name in ("panel", "series", "curve", "time_s", "value")))
        squares: dict[float, list[float]] = {}
        for title, of_series, name, time, value in rows:
            if (title, of_series, name) == (panel.title, series, quantity.metric):
                squares.setdefault(round(time, 6), []).append((value * quantity.scale) ** 2)
        time = np.array(sorted(squares))
        return time, np.array([np.sqrt(np.mean(squares[t])) for t in time])


def same(cell: float | str | None, value: str) -> bool:
    return cell == value or (isinstance(cell, float) and cell == float(value))


@dataclass(frozen=True)
class Line:
    """What is drawn as one line, or as one part of the bars: means and standard deviations over the seeds."""

    name: str
    look: tuple[int, int]  # colour, style
    x: list[str]
    mean: Array
    sd: Array


def axis_name(key: str) -> str:
    return AXIS_NAMES.get(key, key)


def short_name(key: str) -> str:
    return axis_name(key).partition(",")[0]


def unit(key: str) -> str:
    return axis_name(key).partition(",")[2]


def pooled(values: Array, pool: str) -> float:
    if not len(values):
        return float("nan")
    if pool == "median":
        return float(np.median(values))
    return float(np.sqrt(np.mean(values**2)) if pool == "rms" else np.mean(values))


def summarised(values: list[Array], pool: str) -> tuple[Array, Array]:
    mean = np.array([pooled(v, pool) for v in values])
    sd = np.array([np.std(v, ddof=1) if len(v) > 1 else 0.0 for v in values])
    if pool in ("median", "share"):  # of which a standard deviation says nothing
        sd[:] = np.nan
    return mean, sd


def lines(table: Table, panel: Panel, drawing: Drawing) -> list[Line]:
    x = drawing.x or next(iter(panel.grid))
    found = []
    of = [drawing.lines] if drawing.lines else []
    values = panel.grid[drawing.lines] if drawing.lines else [""]
    names = [series.name for series in panel.series] or [""]
    for (s, series), (v, value), (q, quantity) in itertools.product(
        enumerate(names), enumerate(values), enumerate(drawing.y)
    ):
        fixed = {"series": series} | dict.fromkeys(of, value)
        points = [table.by_seed(table.rows(panel, **fixed, **{x: at}), quantity) for at in panel.grid[x]]
        said = [
            series if len(names) > 1 else "",
            f"{short_name(drawing.lines)} {value}{unit(drawing.lines)}" if of else "",
            (quantity.name or quantity.metric) if len(drawing.y) > 1 else "",
        ]
        look = (v, s) if of else (s, q)
        name = ", ".join(part for part in said if part)
        found.append(Line(name, look, panel.grid[x], *summarised(points, quantity.pool)))
    for index, bound in enumerate(drawing.bounds):
        points = [table.by_seed(table.rows(panel, **{x: at}), bound) for at in panel.grid[x]]
        found.append(Line(bound.name or bound.metric, (-1, index), panel.grid[x], *summarised(points, bound.pool)))
    return [line for line in found if np.isfinite(line.mean).any()]


def bars(table: Table, panel: Panel, drawing: Drawing) -> list[Line]:
    names = [series.name for series in panel.series] or [""]
    parts = []
    for index, quantity in enumerate(drawing.y):
        values = [table.by_seed(table.rows(panel, series=name), quantity) for name in names]
        parts.append(Line(quantity.name or quantity.metric, (index, 0), names, *summarised(values, quantity.pool)))
    return [part for part in parts if np.isfinite(part.mean).any()]


def draw_lines(axes: Axes, found: list[Line], x: str, log: bool) -> None:
    at = np.array([float(value) for value in found[0].x])
    for line in found:
        colour, style = line.look
        if colour < 0:
            axes.plot(at, line.mean, color=QUIET, linewidth=1.4, linestyle=STYLES[style + 1], label=line.name, zorder=1)
            continue
        marker = MARKERS[(colour + style) % len(MARKERS)]
        look = {"color": COLOURS[colour % len(COLOURS)], "linestyle": STYLES[style % len(STYLES)], "marker": marker}
        face = look["color"] if style == 0 else "white"
        axes.errorbar(
            at,
            line.mean,
            line.sd,
            **look,
            markersize=5,
            markerfacecolor=face,
            capsize=2.5,
            linewidth=1.6,
            label=line.name,
        )
    if (at > 0).all() and at.max() / at.min() > 20.0:
        plain_log(axes, "x")
    axes.set_xticks(at, [f"{value:g}" for value in at])
    if log:
        plain_log(axes, "y")
    else:
        axes.set_ylim(bottom=0.0)
    axes.set_xlabel(axis_name(x))
    columns = 2 if max(len(line.name) for line in found) > 14 else 3
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.19), ncols=columns, columnspacing=1.4)


def draw_bars(axes: Axes, parts: list[Line]) -> None:
    names = parts[0].x
    left = np.zeros(len(names))
    for part in parts:
        colour = COLOURS[part.look[0] % len(COLOURS)] if len(parts) > 1 else COLOURS[3]
        axes.barh(names, np.nan_to_num(part.mean), left=left, color=colour, height=0.66, label=part.name)
        left += np.nan_to_num(part.mean)
    # The parts of a stack are not independent of each other, so only a single part shows its spread.
    if len(parts) == 1:
        axes.errorbar(parts[0].mean, names, xerr=parts[0].sd, fmt="none", ecolor="#1b1f24", capsize=3, linewidth=1.2)
        left = left + np.nan_to_num(parts[0].sd)
    totals = sum(np.nan_to_num(part.mean) for part in parts)
    for name, total, end in zip(names, np.atleast_1d(totals), left):
        axes.annotate(f"{total:.3g}", (end, name), (5, 0), textcoords="offset points", va="center", color="#3b434d")
    axes.invert_yaxis()
    axes.set_axisbelow(True)
    axes.grid(axis="y", visible=False)
    axes.margins(x=0.12)
    axes.set_xlim(left=0.0)
    if len(parts) > 1:
        axes.legend(loc="upper center", bbox_to_anchor=(0.45, -0.19), ncols=2, columnspacing=1.4)


def draw_curves(axes: Axes, table: Table, panel: Panel, drawing: Drawing) -> list[tuple[str, Array, Array]]:
    """What is drawn: names, times and values."""
    found = []
    for (s, series), (q, quantity) in itertools.product(enumerate(panel.series), enumerate(drawing.y)):
        time, value = table.over_time(panel, series.name, quantity)
        said = [series.name if len(panel.series) > 1 else "", quantity.name if len(drawing.y) > 1 else ""]
        name = ", ".join(part for part in said if part) or quantity.name or quantity.metric
        colour, style = (s, q) if len(panel.series) > 1 else (q, 0)
        look = {"color": COLOURS[colour % len(COLOURS)], "linestyle": STYLES[style % len(STYLES)]}
        if len(time):
            axes.plot(time, value, linewidth=1.6, label=name, **look)
            found.append((name, time, value))
    for index, bound in enumerate(drawing.bounds):
        time, value = table.over_time(panel, panel.series[0].name, bound)
        if len(time):
            style = STYLES[1 + index % (len(STYLES) - 1)]
            axes.plot(time, value, color=QUIET, linewidth=1.4, linestyle=style, label=bound.name, zorder=1)
            found.append((bound.name, time, value))
    if drawing.log:
        plain_log(axes, "y")
    else:
        axes.set_ylim(bottom=0.0)
    axes.set_xlabel("time, s")
    axes.set_ylabel(drawing.label)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.19), ncols=2, columnspacing=1.4)
    return found


def drawn_curves(table: Table, panel: Panel, drawing: Drawing) -> Drawn | None:
    figure, axes = pyplot.subplots(figsize=(6.2, 3.7))
    found = draw_curves(axes, table, panel, drawing)
    if not found:
        pyplot.close(figure)
        return None
    title = ": ".join(part for part in (panel.title, drawing.title) if part)
    caption = f"Root mean square over {len(panel.seeds)} seeds."
    times = found[0][1][:: max(1, len(found[0][1]) // 10)]
    numbers = [[f"{t:g}", *(f"{np.interp(t, time, value):.4g}" for _, time, value in found)] for t in times]
    return Drawn(Picture(title, svg_text(figure), caption), ["time, s", *(name for name, _, _ in found)], numbers)


@dataclass(frozen=True)
class Drawn:
    """A figure with its numbers: a head and rows of text."""

    picture: Picture
    head: list[str]
    numbers: list[list[str]]


def number(mean: float, sd: float) -> str:
    if not np.isfinite(mean):
        return "–"
    return f"{mean:.4g} ± {sd:.2g}" if np.isfinite(sd) else f"{mean:.4g}"


def drawn(table: Table, panel: Panel, drawing: Drawing) -> Drawn | None:
    if drawing.kind == "curves":
        return drawn_curves(table, panel, drawing)
    is_lines = drawing.kind == "lines"
    x = drawing.x or next(iter(panel.grid), "") if is_lines else ""
    found = (lines if is_lines else bars)(table, panel, drawing)
    if not found:
        return None
    height = 3.7 if is_lines else 1.0 + 0.42 * len(found[0].x)
    figure, axes = pyplot.subplots(figsize=(6.2, height))
    if is_lines:
        draw_lines(axes, found, x, drawing.log)
        axes.set_ylabel(drawing.label)
    else:
        draw_bars(axes, found)
        axes.set_xlabel(drawing.label)
    averaged = [short_name(key) for key in panel.grid if key not in (x, drawing.lines)]
    pools = {quantity.pool for quantity in drawing.y}
    pool = {"rms": "Root mean square over", "median": "Median of", "share": "Share of"}.get(*pools, "Mean of") if len(pools) == 1 else "Mean of"
    caption = f"{pool} {len(panel.seeds)} seeds"
    if averaged:
        caption += f", and over every {', '.join(averaged[:-1]) + ' and ' if averaged[1:] else ''}{averaged[-1]}"
    if (is_lines or len(found) == 1) and not pools & {"median", "share"}:
        caption += "; the error bars are the standard deviation over the seeds" if len(panel.seeds) > 1 else ""
    title = ": ".join(part for part in (panel.title, drawing.title) if part)
    head = [axis_name(x) if is_lines else "series", *(line.name or drawing.label for line in found)]
    numbers = [
        [value, *(number(line.mean[row], line.sd[row]) for line in found)] for row, value in enumerate(found[0].x)
    ]
    return Drawn(Picture(title, svg_text(figure), caption + "."), head, numbers)


def pictures(table: Table) -> list[Drawn]:
    every = [drawn(table, panel, drawing) for panel in panels(table.experiment) for drawing in panel.draw]
    return [one for one in every if one]
