"""Colours that all eyes tell apart, on a light background as on a dark one."""

from __future__ import annotations

from typing import Any

from bokeh.palettes import Viridis256

# IBM's colour-blind safe palette
BLUE, VIOLET, MAGENTA, ORANGE, AMBER, GREY = "#648fff", "#b07cf7", "#dc267f", "#fe6100", "#ffb000", "#9aa7b8"
TEAL = "#12a594"
TRACK, TRUTH, DEAD, CLUSTER, SINK = MAGENTA, "#8a97a8", ORANGE, AMBER, BLUE
TARGETS = (MAGENTA, TEAL, ORANGE, BLUE, VIOLET)  # by number of the target; TRACK where there is only one
INK, FAINT = "#8a97a8", "rgba(138, 151, 168, 0.18)"
MAP = Viridis256[36:240]  # without the ends, which one of the two backgrounds would swallow
KINDS = {
    "report": BLUE,
    "route": BLUE,
    "face": ORANGE,
    "request": AMBER,
    "ask": AMBER,
    "answer": BLUE,
    "alert": ORANGE,
    "awake": AMBER,
    "locate": AMBER,
    "sound": BLUE,
    "detection": BLUE,
    "fail": ORANGE,
    "position": MAGENTA,
    "sync": VIOLET,
    "beacon": GREY,
    "hello": GREY,
    "landmark": GREY,
}


def colour_of(kind: str) -> str:
    """Of frames of one kind."""
    return KINDS.get(kind, VIOLET)


def ink(plot: Any) -> None:
    plot.background_fill_color = plot.border_fill_color = plot.outline_line_color = None
    plot.grid.grid_line_color = FAINT
    plot.axis.axis_line_color = plot.axis.major_tick_line_color = FAINT
    plot.axis.minor_tick_line_color = None
    plot.axis.major_label_text_color = plot.axis.axis_label_text_color = INK
    plot.axis.axis_label_text_font_style = "normal"
