"""A page on localhost that shows a recording as it plays, served and drawn by Bokeh."""

from __future__ import annotations

import html
import logging
import math
import os
import signal
import socket
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.application import Application
from bokeh.application.handlers.function import FunctionHandler
from bokeh.document import Document
from bokeh.events import Tap
from bokeh.models import (
    ColorBar,
    ColumnDataSource,
    Div,
    HoverTool,
    LinearAxis,
    LinearColorMapper,
    Range1d,
    Select,
    Slider,
    Span,
    Toggle,
    WheelZoomTool,
)
from bokeh.palettes import Viridis256
from bokeh.plotting import figure
from bokeh.server.server import Server
from jinja2 import Environment, PackageLoader

from . import scene
from .failure import Failure
from .recording import Recording, Run

ADDRESS = "127.0.0.1"
TICK_S = 0.05
SLOW_TICKS = 6  # what is read rather than watched changes every so many ticks
LINGER_S = 0.4  # on the clock on the wall, a frame stays visible for so long
SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0)
CATCH_UP = 0.15  # of the distance to the newest time, at every tick that follows

# IBM's palette for all eyes; the map's own colours are viridis without its ends, which one of the two backgrounds would swallow
KIND_COLOURS = {
    "report": "#648fff",
    "route": "#648fff",
    "face": "#fe6100",
    "request": "#ffb000",
    "sync": "#b07cf7",
    "beacon": "#9aa7b8",
    "hello": "#9aa7b8",
    "landmark": "#9aa7b8",
}
OTHER_COLOUR = "#b07cf7"
TRACK, TRUTH, DEAD, INK, FAINT = "#dc267f", "#8a97a8", "#fe6100", "#8a97a8", "rgba(138, 151, 168, 0.18)"
MAP_COLOURS = Viridis256[36:240]
WIDGETS = """
:host { font: inherit; color: var(--ink); --bokeh-base-font: var(--font); }
.bk-btn, .bk-input { font: inherit; color: var(--ink); background-color: var(--raised); border: 1px solid var(--line); border-radius: 8px; }
.bk-btn:hover { background-color: var(--line); }
.bk-btn.bk-active { background: var(--accent); border-color: var(--accent); color: #fff; box-shadow: none; }
.bk-input option { color: #1b2430; }
label, .bk-slider-title { color: var(--quiet); font-size: 12px; }
.noUi-target { background: var(--line); border: 0; box-shadow: none; }
.noUi-connect { background: var(--accent) !important; }
.noUi-handle { border: 0 !important; border-radius: 50% !important; background: var(--accent) !important; box-shadow: 0 0 0 3px var(--page) !important; }
.noUi-handle::before, .noUi-handle::after { display: none; }
"""


def colour_of(kind: str) -> str:
    return KIND_COLOURS.get(kind, OTHER_COLOUR)


def argument(doc: Document, name: str) -> str | None:
    given = doc.session_context.request.arguments.get(name) if doc.session_context else None
    return given[0].decode("utf-8", "replace") if given else None


def number(text: str | None, otherwise: float) -> float:
    try:
        value = float(text or "")
    except ValueError:
        return otherwise
    return value if math.isfinite(value) else otherwise


class Page:
    """One browser's view: where it is in time, and the models that it sees."""

    def __init__(self, doc: Document, recording: Recording, live: bool) -> None:
        self.doc, self.recording, self.live = doc, recording, live
        self.run: Run | None = None
        self.motes: scene.Motes | None = None
        self.time = 0.0
        self.wanted_time = max(0.0, number(argument(doc, "time"), 0.0))
        self.wanted_run = argument(doc, "run")
        self.ticks = 0
        self.clock = clock.monotonic()
        self.touched = 0.0  # when the slider was last moved by hand
        self.slid = 0.0  # where this program put the slider last
        self.setting = False  # a widget is being set by this program
        self.drawn: dict[str, Any] = {}
        self.build()
        self.place()
        self.tick()
        doc.add_periodic_callback(self.tick, round(TICK_S * 1000))

    # models

    def source(self, name: str, *columns: str) -> ColumnDataSource:
        made = ColumnDataSource({column: [] for column in columns}, name=name)
        self.sources[name] = made
        return made

    def build(self) -> None:
        self.sources: dict[str, ColumnDataSource] = {}
        self.build_map()
        self.build_timeline()
        widget = {"stylesheets": [WIDGETS], "sizing_mode": "stretch_width"}
        playing = argument(self.doc, "play") != "0" and not self.live
        self.play = Toggle(
            label="Pause" if playing else "Play", active=playing, name="play", width=90, stylesheets=[WIDGETS]
        )
        self.follow = Toggle(
            label="Live", active=self.live, name="follow", width=90, visible=self.live, stylesheets=[WIDGETS]
        )
        speeds = [(str(speed), f"{speed:g} × real time") for speed in SPEEDS]
        self.speed = Select(value="1.0", options=speeds, name="speed", width=140, stylesheets=[WIDGETS])
        self.slider = Slider(start=0.0, end=1.0, value=0.0, step=0.01, show_value=False, name="slider", **widget)
        self.runs = Select(options=[], name="runs", **widget)
        self.shade = Select(
            title="Motes are coloured by",
            options=[
                ("sent", "frames sent"),
                ("battery", "battery left"),
                ("energy", "energy spent"),
                ("clock_error", "clock error"),
            ],
            value="sent",
            name="shade",
            **widget,
        )
        self.chosen_shade = argument(self.doc, "shade")
        self.shown_shade = ""
        self.counters = Div(name="counters", sizing_mode="stretch_width", stylesheets=[WIDGETS])
        self.status = Div(name="status", stylesheets=[WIDGETS])
        self.changed(self.play, "active", lambda _: self.played())
        self.changed(self.slider, "value", self.seek)
        self.changed(self.runs, "value", self.choose)
        self.changed(self.shade, "value", self.choose_shade)

    def build_map(self) -> None:
        self.map = plot = figure(
            name="map",
            match_aspect=True,
            sizing_mode="stretch_both",
            output_backend="canvas",
            toolbar_location="right",
            toolbar_inner=True,
            tools="pan,reset,save,box_zoom",
            x_axis_label="x, m",
            y_axis_label="y, m",
        )
        # What moves is drawn on a figure of its own over the motes, which are many and seldom change.
        self.over = over = figure(
            name="over",
            sizing_mode="stretch_both",
            toolbar_location=None,
            tools="",
            x_range=Range1d(0.0, 1.0),
            y_range=Range1d(0.0, 1.0),
        )
        for one in (plot, over):
            one.min_border_left, one.min_border_right, one.min_border_top, one.min_border_bottom = 65, 85, 8, 48
        for edge in ("start", "end"):
            plot.x_range.js_link(edge, over.x_range, edge)
            plot.y_range.js_link(edge, over.y_range, edge)
        over.axis.visible = over.grid.visible = False
        wheel = WheelZoomTool()
        plot.add_tools(wheel)
        plot.toolbar.active_scroll = wheel
        plot.toolbar.logo = None
        plot.toolbar.autohide = True
        self.ink(plot)
        self.ink(over)
        self.mapper = LinearColorMapper(palette=MAP_COLOURS, low=0.0, high=1.0, nan_color="#8a97a8")
        motes = plot.scatter(
            "x",
            "y",
            source=self.source("motes", "x", "y", "node", "value", "sent", "battery", "energy", "clock_error"),
            size=6,
            color={"field": "value", "transform": self.mapper},
            line_color="rgba(60, 70, 85, 0.35)",
            line_width=0.5,
            alpha=0.75,
        )
        self.mote_glyph = motes.glyph
        dead = plot.scatter(
            "x", "y", source=self.source("dead", "x", "y", "node"), marker="x", size=9, line_color=DEAD, line_width=2
        )
        rings = over.circle(
            "x", "y", radius="radius", source=self.source("rings", "x", "y", "radius", "alpha", "color"),
            fill_color="color", fill_alpha=0.04, line_color="color", line_alpha="alpha", line_width=1.5,
        )  # fmt: skip
        arcs = over.quadratic(
            "x0", "y0", "x1", "y1", "cx", "cy",
            source=self.source("arcs", "x0", "y0", "x1", "y1", "cx", "cy", "alpha", "color"),
            line_color="color", line_alpha="alpha", line_width=1.8,
        )  # fmt: skip
        pulses = over.scatter(
            "x",
            "y",
            source=self.source("pulses", "x", "y", "alpha", "color"),
            size=7,
            color="color",
            line_color=None,
            alpha="alpha",
        )
        truth = over.line(
            "x", "y", source=self.source("truth", "x", "y"), line_color=TRUTH, line_width=5, line_alpha=0.55
        )
        here = over.scatter(
            "x", "y", source=self.source("here", "x", "y"), size=18, fill_color=None, line_color=TRUTH, line_width=3
        )
        path = over.multi_line("xs", "ys", source=self.source("paths", "xs", "ys"), line_color=TRACK, line_width=2)
        ellipse = over.patches(
            "xs",
            "ys",
            source=self.source("ellipses", "xs", "ys"),
            fill_color=TRACK,
            fill_alpha=0.15,
            line_color=TRACK,
            line_width=1.5,
        )
        head = over.scatter(
            "x",
            "y",
            source=self.source("heads", "x", "y", "error"),
            size=10,
            color=TRACK,
            line_color="white",
            line_width=1.5,
        )
        plot.x_range.renderers = plot.y_range.renderers = [motes]
        plot.x_range.range_padding = plot.y_range.range_padding = 0.1
        layers = {
            "motes": (motes,), "dead": (dead,), "unicasts": (arcs, pulses), "broadcasts": (rings,), "truth": (truth, here),
            "track": (path, ellipse, head),
        }  # fmt: skip
        for name, renderers in layers.items():
            for renderer in renderers:
                renderer.tags = [name]  # the page's legend hides and shows them
        self.colour_bar = ColorBar(
            color_mapper=self.mapper,
            title="frames sent",
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
        tips = [
            ("mote", "@node"),
            ("place", "@x{0.0}, @y{0.0} m"),
            ("frames sent", "@sent{0,0}"),
            ("battery left", "@battery{0 %}"),
            ("energy spent", "@energy{0,0.0} mJ"),
            ("clock error", "@clock_error{0.000} ms"),
        ]
        plot.add_tools(HoverTool(renderers=[motes], tooltips=tips))

    def build_timeline(self) -> None:
        self.chart = plot = figure(
            name="timeline",
            sizing_mode="stretch_both",
            toolbar_location=None,
            tools="",
            x_range=Range1d(0.0, 1.0),
            y_range=Range1d(0.0, 1.0),
            y_axis_label="frames/s",
        )
        self.ink(plot)
        self.source("traffic", "time", "rate").data = {
            "time": [0.0, 1.0],
            "rate": [0.0, 0.0],
        }  # Bokeh never ends to draw steps of nothing
        plot.varea_step(
            "time", 0, "rate", step_mode="center", source=self.sources["traffic"], fill_color="#648fff", fill_alpha=0.35
        )
        plot.extra_y_ranges = {"error": Range1d(0.0, 1.0)}
        right = LinearAxis(y_range_name="error", axis_label="error, m")
        plot.add_layout(right, "right")
        self.ink(plot)
        plot.line(
            "time",
            "error",
            source=self.source("error", "time", "error"),
            y_range_name="error",
            line_color=TRACK,
            line_width=1.5,
        )
        self.cursor = Span(location=0.0, dimension="height", line_color=INK, line_width=2)
        plot.add_layout(self.cursor)
        plot.on_event(Tap, lambda event: self.seek(event.x))

    @staticmethod
    def ink(plot: Any) -> None:
        """Colours that both backgrounds bear."""
        plot.background_fill_color = plot.border_fill_color = plot.outline_line_color = None
        plot.grid.grid_line_color = FAINT
        plot.axis.axis_line_color = plot.axis.major_tick_line_color = FAINT
        plot.axis.minor_tick_line_color = None
        plot.axis.major_label_text_color = plot.axis.axis_label_text_color = INK
        plot.axis.axis_label_text_font_style = "normal"

    def place(self) -> None:
        self.doc.title = "Motehound"
        self.doc.template = Environment(loader=PackageLoader("motehound_tools"), autoescape=True).get_template(
            "view.html.j2"
        )
        self.doc.template_variables.update(
            name=self.recording.name,
            live=self.live,
            colours={
                "track": TRACK,
                "truth": TRUTH,
                "dead": DEAD,
                "unicasts": KIND_COLOURS["report"],
                "broadcasts": KIND_COLOURS["beacon"],
                "motes": MAP_COLOURS[80],
            },
        )
        for root in (
            self.map,
            self.over,
            self.chart,
            self.play,
            self.follow,
            self.speed,
            self.slider,
            self.runs,
            self.shade,
            self.counters,
            self.status,
        ):
            self.doc.add_root(root)

    # what the user does

    def changed(self, model: Any, name: str, act: Callable[[Any], None]) -> None:
        """Calls `act` with the new value, unless it was this program that set it."""
        model.on_change(name, lambda attr, old, new: None if self.setting else act(new))

    def seek(self, time: float) -> None:
        if abs(time - self.slid) < self.slider.step:
            return  # the browser's echo of what it was told
        self.touched = clock.monotonic()
        self.time = min(max(0.0, time), self.end())
        self.follow.active = False

    def choose(self, value: str) -> None:
        if not value or (self.run is not None and value == str(self.run.number)):
            return
        self.follow.active = False
        self.show(self.recording.runs[int(value)])
        self.time = 0.0

    def choose_shade(self, value: str) -> None:
        if value == self.shown_shade:
            return
        self.chosen_shade = value
        self.drawn.pop("shade", None)

    def played(self) -> None:
        self.play.label = "Pause" if self.play.active else "Play"
        if self.play.active:
            self.follow.active = False
            if self.time >= self.end() and self.run is not None and self.run.over:
                self.time = 0.0

    # what time does

    def end(self) -> float:
        return self.run.end_s if self.run else 0.0

    def show(self, run: Run) -> None:
        self.run, self.motes = run, None
        self.drawn.clear()

    def advance(self) -> float:
        """Moves the time, and returns how fast it goes, in simulated seconds a second."""
        now = clock.monotonic()
        passed, self.clock = min(now - self.clock, 0.5), now
        speed = float(self.speed.value)
        if self.wanted_time and (
            self.end() >= self.wanted_time or (self.run is not None and self.recording.share >= 1.0)
        ):
            self.time, self.wanted_time = min(self.wanted_time, self.end()), 0.0
        if self.follow.active:
            newest = self.recording.runs.get(self.recording.newest)
            if newest is not None and newest is not self.run:
                self.show(newest)
                self.time = 0.0
            ahead = self.end() - self.time
            step = min(ahead, max(passed, CATCH_UP * ahead))
            self.time += step
            return max(1.0, step / TICK_S)
        if self.play.active and self.run is not None and not self.wanted_time:
            self.time = min(self.time + speed * passed, self.end())
            if self.time >= self.end() and self.run.over and self.recording.share >= 1.0:
                self.play.active = False
        return speed

    def tick(self) -> None:
        runs = self.recording.runs
        if (
            self.run is not None
            and runs.get(self.run.number) is not self.run
            and self.run.number in runs
            and not self.follow.active
        ):
            self.show(runs[self.run.number])
        if self.run is None and runs:
            wanted = int(self.wanted_run) if (self.wanted_run or "").isdigit() else min(runs)
            if wanted in runs:
                self.show(runs[wanted])
            elif self.recording.share >= 1.0:
                self.show(runs[min(runs)])
        speed = self.advance()
        self.doc.hold("combine")
        self.setting = True
        try:
            self.draw(speed)
        finally:
            self.setting = False
            self.doc.unhold()
        self.ticks += 1

    # drawing

    def put(self, name: str, data: dict[str, Any]) -> None:
        self.sources[name].data = data

    def draw(self, speed: float) -> None:
        slow = self.ticks % SLOW_TICKS == 0
        if slow:
            self.draw_widgets()
        run = self.run
        if run is None:
            return
        if self.motes is None or len(self.motes.nodes) != len(run.places):
            self.motes = scene.Motes(run)
            self.draw_places()
        time = self.time
        self.slider.end = max(run.end_s, 1.0)
        if self.clock - self.touched > 0.4:
            self.slid = self.slider.value = round(min(time, self.slider.end), 2)
        if self.drawn.get("time") != (time, len(run.frames)):
            self.drawn["time"] = (time, len(run.frames))
            self.cursor.location = time
            colours = np.array([colour_of(kind) for kind in self.recording.kinds] or [OTHER_COLOUR])
            self.air = scene.frames_in_air(run, self.motes, time, LINGER_S * speed, colours)
            for name, data in self.air.items():
                if (
                    len(next(iter(data.values())))
                    or self.sources[name].data
                    and len(next(iter(self.sources[name].data.values())))
                ):
                    self.put(name, data)
            path, here = scene.truth(run, time)
            self.put("truth", path)
            self.put("here", {"x": [here[0]], "y": [here[1]]} if here else {"x": [], "y": []})
            found = scene.track(run, time)
            self.heads = found["heads"]
            for name, data in found.items():
                self.put(name, data)
        if slow:
            self.draw_slow()

    def draw_widgets(self) -> None:
        options = [
            (str(n), f"Run {n}" + (f" · seed {r.seed}" if r.seed is not None else ""))
            for n, r in sorted(self.recording.runs.items())
        ]
        if self.runs.options != options:
            self.runs.options = options
        if self.run is not None:
            self.runs.value = str(self.run.number)
        share = self.recording.share
        if not self.recording.runs:
            text = (
                "Waiting for a run on the bus"
                if self.live
                else "Reading the log"
                if share < 1.0
                else "No run in this log"
            )
        elif not self.run.places if self.run else False:
            text = "The motes of this run were told before this page listened: start the view first"
        else:
            text = f"Reading the log, {share:.0%}" if share < 1.0 else ""
        if self.status.text != text:
            self.status.text = text

    def draw_places(self) -> None:
        motes = self.motes
        if motes is None or not len(motes.nodes):
            return
        self.mote_glyph.size = float(np.clip(230.0 / math.sqrt(len(motes.nodes)), 2.5, 11.0))
        empty = np.full(len(motes.nodes), np.nan)
        self.put("motes", {"x": motes.xy[:, 0], "y": motes.xy[:, 1], "node": motes.nodes}
                 | dict.fromkeys(("value", "sent", "battery", "energy", "clock_error"), empty))  # fmt: skip
        self.drawn.pop("shade", None)

    def draw_slow(self) -> None:
        run, motes = self.run, self.motes
        assert run is not None and motes is not None
        motes.move(self.time)
        grown = (run.end_s, len(run.frames), len(run.track))
        if self.drawn.get("timeline") != grown:
            self.drawn["timeline"] = grown
            self.chart.x_range.end = self.slider.end
            for name, data in (lines := scene.timeline(run)).items():
                self.put(name, data)
            self.chart.y_range.end = 1.1 * float(lines["traffic"]["rate"].max(initial=1.0))
            error = lines["error"]["error"]
            self.chart.extra_y_ranges["error"].end = (
                1.1 * max(1e-3, float(np.percentile(error, 99))) if len(error) else 1.0
            )
        self.draw_shade()
        self.draw_counters()

    def draw_shade(self) -> None:
        motes = self.motes
        assert motes is not None and self.run is not None
        has_told = len(self.run.motes) > 0
        shade = self.chosen_shade or (
            "battery" if has_told and np.nanmin(motes.battery, initial=1.0) < 1.0 else "energy" if has_told else "sent"
        )
        state = (shade, motes.frames_seen, motes.told_seen)
        if self.drawn.get("shade") == state or not len(motes.nodes):
            return
        self.drawn["shade"] = state
        if shade not in ("sent", "battery", "energy", "clock_error"):
            shade = "sent"
        self.shade.value = self.shown_shade = shade
        columns = {name: getattr(motes, name) for name in ("sent", "battery", "energy", "clock_error")}
        value = np.abs(columns[shade]) if shade == "clock_error" else columns[shade]
        changed = {name: column.copy() for name, column in columns.items() if name == "sent" or len(self.run.motes)}
        self.sources["motes"].data.update(changed, value=value.copy())
        known = value[np.isfinite(value)]
        low, high = np.percentile(known, (1, 99)) if len(known) and shade != "battery" else (0.0, 1.0)
        low = float(low) if shade == "energy" else 0.0  # who listens all the time spends much alike
        self.mapper.low, self.mapper.high = low, max(float(high), low + 1e-9)
        titles = {
            "sent": "frames sent",
            "battery": "battery left",
            "energy": "energy, mJ",
            "clock_error": "clock error, ms",
        }
        self.colour_bar.title = titles[shade]
        dead = ~motes.alive
        self.put("dead", {"x": motes.xy[dead, 0], "y": motes.xy[dead, 1], "node": motes.nodes[dead]})

    def draw_counters(self) -> None:
        run, motes, recording = self.run, self.motes, self.recording
        assert run is not None and motes is not None
        alive = int(motes.alive.sum())
        in_air = sum(len(data["color"]) for data in self.air.values() if "radius" in data or "x0" in data)
        estimates = run.track.until(self.time)
        errors = estimates["error"][np.isfinite(estimates["error"])]
        rows: list[tuple[str, str]] = []
        if len(errors):
            rows += [
                ("error now", f"{errors[-1]:.2f} m"),
                ("error, RMS so far", f"{math.sqrt(np.mean(errors**2)):.2f} m"),
            ]
        rows.append(("estimates", f"{len(estimates):,}"))
        if len(run.motes):
            rows.append(("energy spent", f"{np.nansum(motes.energy) / 1000.0:,.2f} J"))
            finite = np.abs(motes.clock_error[np.isfinite(motes.clock_error)])
            if len(finite):
                rows.append(("clock error, 99th percentile", f"{np.percentile(finite, 99):.3f} ms"))
        kinds = [
            f'<tr><td><i style="background:{colour_of(kind)}"></i>{html.escape(kind)}</td><td>{motes.sent_of_kind[index]:,}</td></tr>'
            for kind, index in recording.kinds.items()
            if index < 256 and motes.sent_of_kind[index]
        ]
        faults = [
            (name, n)
            for name, n in (("broken events", recording.broken), ("events of other types", recording.unknown))
            if n
        ]
        totals = (
            [
                (name.replace("_", " "), f"{value:,.6g}")
                for name, value in run.totals.items()
                if value and math.isfinite(value)
            ]
            if run.over and self.time >= run.end_s
            else []
        )

        def table(pairs: list[tuple[str, str]]) -> str:
            return "".join(
                f"<tr><td>{html.escape(name)}</td><td>{html.escape(str(value))}</td></tr>" for name, value in pairs
            )

        text = f"""<style>{COUNTERS_CSS}</style>
<div class="big"><b>{self.time:,.2f}</b> s <span>of {run.end_s:,.1f} s</span></div>
<div class="tiles"><div><b>{alive:,}</b>motes{f" of {len(motes.alive):,}" if alive < len(motes.alive) else ""}</div>
<div><b>{motes.frames_seen:,}</b>frames</div><div><b>{in_air:,}</b>on screen</div></div>
<table>{table(rows)}</table><h3>Frames sent, by kind</h3><table>{"".join(kinds)}</table>
{f"<h3>Totals of the run</h3><table>{table(totals)}</table>" if totals else ""}
{f"<h3>Skipped</h3><table>{table([(n, f"{v:,}") for n, v in faults])}</table>" if faults else ""}"""
        if self.counters.text != text:
            self.counters.text = text
        name = run.scenario or Path(recording.name).name
        self.doc.title = (
            f"{name} · run {run.number} · {self.time:.1f} s · {len(motes.nodes)} motes · {motes.frames_seen} frames"
        )


COUNTERS_CSS = """
:host, div { font-family: var(--font); }
.big { font-size: 14px; color: var(--quiet); margin-bottom: 12px; }
.big b { font-size: 34px; font-weight: 650; color: var(--ink); font-variant-numeric: tabular-nums; letter-spacing: -0.02em; }
.tiles { display: grid; grid-template-columns: repeat(3, 1fr); gap: 8px; margin-bottom: 14px; }
.tiles div { background: var(--raised); border-radius: 8px; padding: 8px 10px; color: var(--quiet); font-size: 12px; }
.tiles b { display: block; color: var(--ink); font-size: 17px; font-weight: 600; font-variant-numeric: tabular-nums; }
h3 { font-size: 11px; letter-spacing: .06em; text-transform: uppercase; color: var(--quiet); font-weight: 600; margin: 16px 0 4px; }
table { width: 100%; border-collapse: collapse; font-size: 13px; }
td { padding: 3px 0; border-bottom: 1px solid var(--line); color: var(--ink); }
td:last-child { text-align: right; font-variant-numeric: tabular-nums; }
i { display: inline-block; width: 9px; height: 9px; border-radius: 50%; margin-right: 8px; }
"""


def serve(recording: Recording, live: bool, port: int) -> None:
    """Until it is interrupted."""
    for noisy in ("bokeh", "tornado"):
        logging.getLogger(noisy).setLevel(logging.ERROR)
    application = Application(FunctionHandler(lambda doc: Page(doc, recording, live) and None))
    try:
        with socket.create_server((ADDRESS, port)) as free:
            port = free.getsockname()[1]
        origins = [f"{host}:{port}" for host in ("localhost", ADDRESS)]
        server = Server({"/": application}, address=ADDRESS, port=port, allow_websocket_origin=origins)
    except OSError as error:
        raise Failure(f"port {port}: cannot listen on it: {os.strerror(error.errno)}; --port names another") from error
    print(f"http://localhost:{port}/", flush=True)
    server.start()
    signal.signal(signal.SIGTERM, lambda *_: server.io_loop.add_callback_from_signal(server.io_loop.stop))
    try:
        server.io_loop.start()
    except KeyboardInterrupt:
        pass
