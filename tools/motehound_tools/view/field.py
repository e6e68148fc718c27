"""The map: motes below, and over them what moves, on a figure of its own, for the motes are many and seldom change."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from bokeh.core.properties import value as literal
from bokeh.models import ColorBar, ColumnDataSource, HoverTool, LinearColorMapper, Range1d, WheelZoomTool
from bokeh.plotting import figure

from ..recording import Run
from . import scene, targets
from .colours import CLUSTER, DEAD, INK, MAP, SINK, ink

SHADES = {
    "sent": ("frames sent", "frames sent"),
    "battery": ("battery left", "battery left"),
    "energy": ("energy spent", "energy, mJ"),
    "clock_error": ("clock error", "clock error, ms"),
}
TIPS = [
    ("mote", "@node"),
    ("place", "@x{0.0}, @y{0.0} m"),
    ("frames sent", "@sent{0,0}"),
    ("battery left", "@battery{0 %}"),
    ("energy spent", "@energy{0,0.0} mJ"),
    ("clock error", "@clock_error{0.000} ms"),
]
AWAKE, ASLEEP = 0.75, 0.3  # how opaque a mote is; with clusters, or several targets, most sleep
FONT = "Inter, 'Segoe UI', system-ui, 'Helvetica Neue', Arial, sans-serif"
OUTLINE = "rgba(255, 255, 255, 0.65)"
MARGINS = {
    "min_border_left": 65,
    "min_border_right": 85,
    "min_border_top": 8,
    "min_border_bottom": 48,
}  # wider than axes


class Field:
    def __init__(self) -> None:
        self.sources: dict[str, ColumnDataSource] = {}
        self.motes_figure = self._motes_figure()
        self.moving_figure = self._moving_figure()
        for edge in ("start", "end"):
            for axis in ("x_range", "y_range"):
                getattr(self.motes_figure, axis).js_link(edge, getattr(self.moving_figure, axis), edge)

    def _source(self, name: str, columns: str) -> ColumnDataSource:
        self.sources[name] = ColumnDataSource({column: [] for column in columns.split()}, name=name)
        return self.sources[name]

    def _motes_figure(self) -> Any:
        plot = figure(
            name="map",
            match_aspect=True,
            sizing_mode="stretch_both",
            toolbar_location="right",
            toolbar_inner=True,
            tools="pan,reset,save,box_zoom",
            x_axis_label="x, m",
            y_axis_label="y, m",
            **MARGINS,
        )
        ink(plot)
        wheel = WheelZoomTool()
        plot.add_tools(wheel)
        plot.toolbar.active_scroll = wheel
        plot.toolbar.logo = None
        plot.toolbar.autohide = True
        self.mapper = LinearColorMapper(palette=MAP, low=0.0, high=1.0, nan_color=INK)
        motes = plot.scatter(
            "x",
            "y",
            source=self._source("motes", "x y node value sent battery energy clock_error"),
            color={"field": "value", "transform": self.mapper},
            line_color="rgba(60, 70, 85, 0.35)",
            line_width=0.5,
            alpha=AWAKE,
            tags=["motes"],
        )
        self.mote = motes.glyph
        dead = self._source("dead", "x y")
        plot.scatter("x", "y", source=dead, marker="x", size=9, line_color=DEAD, line_width=2, tags=["dead"])
        plot.x_range.renderers = plot.y_range.renderers = [motes]
        plot.x_range.range_padding = plot.y_range.range_padding = 0.1
        plot.add_tools(HoverTool(renderers=[motes], tooltips=TIPS))
        self.colour_bar = ColorBar(
            color_mapper=self.mapper,
            width=10,
            height=180,
            location=(0, 0),
            major_label_text_color=INK,
            title_text_color=INK,
            title_text_font_style="normal",
            background_fill_alpha=0.0,
            major_tick_line_color=INK,
            bar_line_color=None,
        )
        plot.add_layout(self.colour_bar, "right")
        return plot

    def _moving_figure(self) -> Any:
        """Tags name the layers that the page's legend hides and shows."""
        plot = figure(
            name="over",
            sizing_mode="stretch_both",
            toolbar_location=None,
            tools="",
            x_range=Range1d(0.0, 1.0),
            y_range=Range1d(0.0, 1.0),
            **MARGINS,
        )
        ink(plot)
        plot.axis.visible = plot.grid.visible = False
        line = {"line_color": "color", "line_alpha": "alpha"}
        rings = self._source("rings", "x y radius alpha color")
        plot.circle(
            "x",
            "y",
            radius="radius",
            source=rings,
            fill_color="color",
            fill_alpha=0.04,
            line_width=1.5,
            tags=["broadcasts"],
            **line,
        )
        arcs = self._source("arcs", "x0 y0 x1 y1 cx cy alpha color")
        plot.quadratic("x0", "y0", "x1", "y1", "cx", "cy", source=arcs, line_width=1.8, tags=["unicasts"], **line)
        pulses = self._source("pulses", "x y alpha color")
        plot.scatter("x", "y", source=pulses, size=7, color="color", line_color=None, alpha="alpha", tags=["unicasts"])
        truth = {"line_color": "color", "tags": ["truth"]}
        paths = self._source("truth", "xs ys color")
        plot.multi_line("xs", "ys", source=paths, line_width=5, line_alpha=0.55, **truth)
        here = self._source("here", "x y color")
        plot.scatter("x", "y", source=here, size=18, fill_color=None, line_width=3, **truth)
        self._watches(plot)
        cluster = {"line_color": "color", "tags": ["cluster"]}
        spokes = self._source("spokes", "xs ys color")
        plot.multi_line("xs", "ys", source=spokes, line_alpha=0.6, line_width=1.2, **cluster)
        members = self._source("members", "x y color")
        plot.scatter("x", "y", source=members, size=9, fill_color="color", fill_alpha=0.5, line_width=1.5, **cluster)
        head = {"source": self._source("head", "x y"), "size": 15, "marker": "diamond", "line_width": 2}
        plot.scatter("x", "y", fill_color=CLUSTER, line_color=CLUSTER, tags=["cluster"], **head)
        sink = {"line_color": SINK, "tags": ["sink"]}
        path = self._source("sink_path", "x y")
        plot.line("x", "y", source=path, line_width=1.5, line_dash=[5, 3], **sink)
        place = self._source("sink", "x y")
        plot.scatter("x", "y", source=place, size=13, marker="cross", line_width=3, **sink)
        self._tracks(plot)
        return plot

    def _watches(self, plot: Any) -> None:
        """How the nodes around targets stand: where these are expected, the heads and the princes that are to be the next ones."""
        watch = {"line_color": "color", "tags": ["watch"]}
        areas = self._source("areas", "xs ys color")
        plot.patches(
            "xs", "ys", source=areas, fill_color="color", fill_alpha=0.12, line_dash=[3, 3], line_alpha=0.7, **watch
        )
        plot.multi_line("xs", "ys", source=self._source("ways", "xs ys color"), line_dash=[2, 3], **watch)
        expected = self._source("expected", "x y color")
        plot.scatter("x", "y", source=expected, size=11, marker="cross", line_width=2, **watch)
        mark = {"fill_color": "color", "line_color": OUTLINE, "line_width": 1.0, "tags": ["watch"]}
        heads = self._source("watch_heads", "x y color")
        plot.scatter("x", "y", source=heads, size=16, marker="diamond", **mark)
        princes = self._source("princes", "x y color")
        plot.scatter("x", "y", source=princes, size=19, marker="star", **mark)

    def _tracks(self, plot: Any) -> None:
        track = {"line_color": "color", "tags": ["track"]}
        paths = self._source("paths", "xs ys color")
        plot.multi_line("xs", "ys", source=paths, line_width=2, **track)
        ellipses = self._source("ellipses", "xs ys color")
        plot.patches("xs", "ys", source=ellipses, fill_color="color", fill_alpha=0.15, line_width=1.5, **track)
        group = {"line_color": "color", "tags": ["group"]}
        extents = self._source("extents", "x y radius color")
        plot.circle(
            "x", "y", radius="radius", source=extents, fill_color=None, line_width=2.5, line_dash=[8, 4], **group
        )
        heads = self._source("heads", "x y color label")
        plot.scatter("x", "y", source=heads, size=10, fill_color="color", line_color="white", tags=["track"])
        plot.text(
            "x",
            "y",
            text="label",
            source=heads,
            x_offset=13,
            y_offset=-11,
            text_color="color",
            text_font_size="12px",
            text_font_style="bold",
            text_font=literal(FONT),
            tags=["track"],
        )

    def place(self, motes: scene.Motes) -> None:
        """Motes where they stand, of which nothing else is known yet."""
        count = len(motes.nodes)
        self.mote.size = float(np.clip(230.0 / math.sqrt(max(count, 1)), 2.5, 11.0))
        unknown = np.full(count, np.nan)
        places = {"x": motes.xy[:, 0], "y": motes.xy[:, 1], "node": motes.nodes, "value": unknown}
        self.sources["motes"].data = places | dict.fromkeys(SHADES, unknown)

    def shade(self, motes: scene.Motes, shade: str, told: bool) -> None:
        """Colours the motes by what is known of them; `told`: they have told of their energy."""
        columns = {name: getattr(motes, name) for name in SHADES if told or name == "sent"}
        value = np.abs(getattr(motes, shade))
        self.sources["motes"].data.update({name: column.copy() for name, column in columns.items()}, value=value)
        known = value[np.isfinite(value)]
        low, high = np.percentile(known, (1, 99)) if len(known) and shade != "battery" else (0.0, 1.0)
        low = float(low) if shade == "energy" else 0.0  # who listens all the time spends much alike
        self.mapper.low, self.mapper.high = low, float(high) if high > low else low + 1.0
        self.colour_bar.title = SHADES[shade][1]
        dead = motes.xy[~motes.alive]
        self.sources["dead"].data = {"x": dead[:, 0], "y": dead[:, 1]}

    def move(self, run: Run, motes: scene.Motes, time: float, linger: float, colours: np.ndarray) -> int:
        """Everything that moves, as it is at this time; how many frames that shows."""
        frames = scene.frames_in_air(run, motes, time, linger, colours)
        self.mote.fill_alpha = ASLEEP if len(run.clusters) or targets.are_told_apart(run) else AWAKE
        layers = frames | targets.truths(run, time) | targets.tracks(run, time) | targets.watches(run, time)
        layers |= scene.clusters(run, time) | scene.sink_view(run, time)
        for name, data in layers.items():
            if _rows(data) or _rows(self.sources[name].data):
                self.sources[name].data = data
        return _rows(frames["arcs"]) + _rows(frames["rings"])


def _rows(data: Any) -> int:
    return len(next(iter(data.values())))
