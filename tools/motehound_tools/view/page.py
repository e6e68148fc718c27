"""One browser's view of a recording: where in time it is, and what it therefore shows."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from bokeh.document import Document
from jinja2 import Environment, PackageLoader

from ..recording import Recording, Run
from . import counters, scene
from .colours import CLUSTER, DEAD, GREY, KINDS, MAP, SINK, TRACK, TRUTH, colour_of
from .field import SHADES, Field
from .timeline import Timeline
from .widgets import Widgets

TEMPLATE = Environment(loader=PackageLoader("motehound_tools"), autoescape=True).get_template("view.html.j2")
SWATCHES = {
    "motes": MAP[80],
    "dead": DEAD,
    "unicasts": KINDS["report"],
    "broadcasts": GREY,
    "truth": TRUTH,
    "track": TRACK,
    "group": TRACK,
    "watch": TRACK,
    "cluster": CLUSTER,
    "sink": SINK,
}
TICK_S = 0.05
SLOW_TICKS = 6  # what is read rather than watched changes every so many ticks
LINGER_S = 0.4  # on the clock on the wall, a frame stays visible for so long
CATCH_UP = 0.15  # of the distance to the newest time, at every tick that follows
HANDS_OFF_S = 0.4  # since the slider was last moved by hand, before it moves by itself again


class Page:
    """The address may say run=N, time=SECONDS, play=0, shade=sent|battery|energy|clock_error, and theme=dark|light."""

    def __init__(self, doc: Document, recording: Recording, live: bool) -> None:
        asked = doc.session_context.request.arguments if doc.session_context else {}
        self.asked = {name: values[0].decode("utf-8", "replace") for name, values in asked.items()}
        self.doc, self.recording, self.live = doc, recording, live
        self.run: Run | None = None
        self.motes: scene.Motes | None = None
        self.time = 0.0
        self.wanted_time = wanted_time(self.asked.get("time", ""))  # until that much has been read
        self.chosen_shade = self.asked.get("shade")
        self.on_screen = 0  # frames
        self.ticks = 0
        self.clock = clock.monotonic()
        self.touched = 0.0  # when the slider was last moved by hand
        self.told: dict[str, Any] = {}  # what this program set each widget to last
        self.drawn: dict[str, Any] = {}  # what the drawn state was made from
        self.field = Field()
        self.timeline = Timeline(self.seek)
        self.widgets = Widgets(live, playing=not live and self.asked.get("play") != "0")
        self.on("play", "active", self.play)
        self.on("slider", "value", self.seek)
        self.on("runs", "value", self.choose)
        self.on("shade", "value", self.choose_shade)
        doc.title = "Motehound"
        doc.template = TEMPLATE
        doc.template_variables.update(name=recording.name, swatches=SWATCHES)
        for root in (self.field.motes_figure, self.field.moving_figure, self.timeline.figure, *self.widgets.all()):
            doc.add_root(root)
        self.tick()
        doc.add_periodic_callback(self.tick, round(TICK_S * 1000))

    # the user

    def on(self, name: str, attribute: str, act: Callable[[Any], None]) -> None:
        """Calls `act` with a widget's new value, unless it is a browser's echo of what this program set."""

        def changed(attr: str, old: Any, new: Any) -> None:
            if new != self.told.get(name):
                act(new)

        getattr(self.widgets, name).on_change(attribute, changed)

    def set(self, name: str, value: Any) -> None:
        self.told[name] = value
        getattr(self.widgets, name).value = value

    def seek(self, time: float) -> None:
        self.touched = clock.monotonic()
        self.time = min(max(0.0, time), self.end())
        self.widgets.follow.active = False

    def choose(self, value: str) -> None:
        if value.isdigit() and int(value) in self.recording.runs:
            self.told["runs"] = value
            self.widgets.follow.active = False
            self.show(self.recording.runs[int(value)])

    def choose_shade(self, value: str) -> None:
        self.chosen_shade = self.told["shade"] = value

    def play(self, playing: bool) -> None:
        self.widgets.play.label = "Pause" if playing else "Play"
        if playing:
            self.widgets.follow.active = False
            if self.run is not None and self.run.over and self.time >= self.end():
                self.time = 0.0

    # time

    def end(self) -> float:
        return self.run.end_s if self.run else 0.0

    def show(self, run: Run) -> None:
        self.run, self.motes, self.time = run, None, 0.0
        self.drawn.clear()

    def pick(self) -> None:
        """The run to show: the newest when following, else the one that was asked for, or its successor in number."""
        runs, whole = self.recording.runs, self.recording.share >= 1.0
        if not runs:
            return
        if self.widgets.follow.active:
            wanted = runs.get(self.recording.newest)
        elif self.run is not None:
            wanted = runs.get(self.run.number)
        else:
            asked = self.asked.get("run", "")
            wanted = runs.get(int(asked)) if asked.isdigit() else None
            wanted = wanted or (runs[min(runs)] if whole or not asked else None)
        if wanted is not None and wanted is not self.run:
            self.show(wanted)

    def advance(self) -> float:
        """Moves the time. Returns how fast it goes, in simulated seconds a second."""
        now = clock.monotonic()
        passed, self.clock = min(now - self.clock, 0.5), now
        speed, ahead, whole = float(self.widgets.speed.value), self.end() - self.time, self.recording.share >= 1.0
        if self.widgets.follow.active:
            step = min(ahead, max(passed, CATCH_UP * ahead))
            self.time += step
            return max(1.0, step / TICK_S)
        if self.run is None:
            return speed
        if self.wanted_time:
            if self.wanted_time <= self.end() or whole:
                self.time, self.wanted_time = min(self.wanted_time, self.end()), 0.0
        elif self.widgets.play.active:
            self.time += min(ahead, speed * passed)
            if self.time >= self.end() and self.run.over and whole:
                self.widgets.play.active = False
        return speed

    def tick(self) -> None:
        self.doc.hold("combine")
        try:
            self.pick()
            speed = self.advance()
            slow = self.ticks % SLOW_TICKS == 0
            if slow:
                self.draw_choice()
            if self.run is not None:
                self.draw(self.run, speed, slow)
        finally:
            self.doc.unhold()
        self.ticks += 1

    # drawing

    def new(self, name: str, made_from: Any) -> bool:
        """Whether something must be drawn anew, since what it was made from has changed."""
        changed = self.drawn.get(name) != made_from
        self.drawn[name] = made_from
        return changed

    def draw(self, run: Run, speed: float, slow: bool) -> None:
        if self.motes is None or len(self.motes.nodes) != len(run.places):
            self.motes = scene.Motes(run)
            self.field.place(self.motes)
            self.drawn.clear()
        slider = self.widgets.slider
        slider.end = max(run.end_s, 1.0)
        if self.clock - self.touched > HANDS_OFF_S:
            self.set("slider", round(min(self.time, slider.end), 2))
        known = [len(table) for table in (run.frames, run.track, run.watch, run.sink, run.clusters)]
        if self.new("moving", (self.time, *known)):
            colours = np.array([colour_of(kind) for kind in self.recording.kinds] or [GREY])
            self.on_screen = self.field.move(run, self.motes, self.time, LINGER_S * speed, colours)
            self.timeline.cursor.location = self.time
        if slow:
            self.draw_slow(run, self.motes)

    def draw_slow(self, run: Run, motes: scene.Motes) -> None:
        motes.move(self.time)
        if self.new("timeline", (run.end_s, len(run.frames), len(run.track))):
            self.timeline.draw(run, self.widgets.slider.end)
        told = len(run.motes) > 0
        drained = told and np.nanmin(motes.battery, initial=1.0) < 1.0
        shade = (
            self.chosen_shade if self.chosen_shade in SHADES else "battery" if drained else "energy" if told else "sent"
        )
        if len(motes.nodes) and self.new("shade", (shade, motes.frames_seen, motes.told_seen)):
            self.set("shade", shade)
            self.field.shade(motes, shade, told)
        if self.new("counters", text := counters.text(self.recording, run, motes, self.time, self.on_screen)):
            self.widgets.counters.text = text
        name = run.scenario or Path(self.recording.name).name
        where = f"{name} · run {run.number} · {self.time:.1f} s"
        self.doc.title = f"{where} · {len(motes.nodes)} motes · {motes.frames_seen} frames"

    def draw_choice(self) -> None:
        options = [
            (str(number), f"Run {number}" + ("" if run.seed is None else f" · seed {run.seed}"))
            for number, run in sorted(self.recording.runs.items())
        ]
        if self.widgets.runs.options != options:
            self.widgets.runs.options = options
        if self.run is not None:
            self.set("runs", str(self.run.number))
        status = self.status()
        if self.widgets.status.text != status:
            self.widgets.status.text = status

    def status(self) -> str:
        """What the user waits for, if anything."""
        if self.recording.share < 1.0:
            return f"Reading the log, {self.recording.share:.0%}"
        if not self.recording.runs:
            return "Waiting for a run on the bus" if self.live else "No run in this log"
        if self.run is not None and not self.run.places:
            return "This run told where its motes are before the page listened: start the view first"
        return ""


def wanted_time(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        return 0.0
    return max(0.0, value) if math.isfinite(value) else 0.0
