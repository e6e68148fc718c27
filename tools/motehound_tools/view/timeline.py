"""The run as a whole: traffic and error over time, and where in it the page is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import ColumnDataSource, LinearAxis, Range1d, Span
from bokeh.plotting import figure

from ..recording import Run
from . import scene
from .colours import BLUE, INK, ink


class Timeline:
    def __init__(self, tapped: Callable[[float], None]) -> None:
        self.figure = plot = figure(
            name="timeline",
            sizing_mode="stretch_both",
            toolbar_location=None,
            tools="",
            x_range=Range1d(0.0, 1.0),
            y_range=Range1d(0.0, 1.0),
            y_axis_label="frames/s",
        )
        # Two points from the start: Bokeh hangs drawing steps through none.
        self.traffic = ColumnDataSource({"time": [0.0, 1.0], "rate": [0.0, 0.0]}, name="traffic")
        self.error = ColumnDataSource({"xs": [], "ys": [], "color": []}, name="error")
        plot.varea_step("time", 0, "rate", step_mode="center", source=self.traffic, fill_color=BLUE, fill_alpha=0.35)
        plot.extra_y_ranges = {"error": Range1d(0.0, 1.0)}
        plot.add_layout(LinearAxis(y_range_name="error", axis_label="error, m"), "right")
        plot.multi_line("xs", "ys", source=self.error, y_range_name="error", line_color="color", line_width=1.5)
        self.cursor = Span(location=0.0, dimension="height", line_color=INK, line_width=2)
        plot.add_layout(self.cursor)
        plot.on_event(Tap, lambda event: tapped(event.x))
        ink(plot)

    def draw(self, run: Run, end: float) -> None:
        lines: dict[str, Any] = scene.timeline(run)
        self.traffic.data, self.error.data = lines["traffic"], lines["error"]
        error = np.concatenate([[], *lines["error"]["ys"]])
        self.figure.x_range.end = end
        self.figure.y_range.end = 1.1 * float(lines["traffic"]["rate"].max(initial=1.0))
        high = float(np.nanpercentile(error, 99)) if len(error) else 1.0
        self.figure.extra_y_ranges["error"].end = 1.1 * max(high, 1e-3)
