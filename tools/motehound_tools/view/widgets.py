"""What the user turns and presses, in the colours of the page."""

from __future__ import annotations

from bokeh.models import Div, Select, Slider, Toggle

from .field import SHADES

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0)
STYLE = """
:host { font: inherit; color: var(--ink); --bokeh-base-font: var(--font); }
.bk-btn, .bk-input { font: inherit; color: var(--ink); background-color: var(--raised); border: 1px solid var(--line);
  border-radius: 8px; }
.bk-btn:hover { background-color: var(--line); }
.bk-btn.bk-active { background: var(--accent); border-color: var(--accent); color: #fff; box-shadow: none; }
.bk-input option { color: #1b2430; }
label { color: var(--quiet); font-size: 12px; }
.noUi-target { background: var(--line); border: 0; box-shadow: none; }
.noUi-connect { background: var(--accent) !important; }
.noUi-handle { border: 0 !important; border-radius: 50% !important; background: var(--accent) !important;
  box-shadow: 0 0 0 3px var(--page) !important; }
.noUi-handle::before, .noUi-handle::after { display: none; }
"""


class Widgets:
    def __init__(self, live: bool, playing: bool) -> None:
        style = {"stylesheets": [STYLE]}
        wide = style | {"sizing_mode": "stretch_width"}
        speeds = [(str(speed), f"{speed:g} × real time") for speed in SPEEDS]
        shades = [(name, label) for name, (label, _) in SHADES.items()]
        self.play = Toggle(label="Pause" if playing else "Play", active=playing, name="play", width=90, **style)
        self.follow = Toggle(label="Live", active=live, visible=live, name="follow", width=90, **style)
        self.speed = Select(value="1.0", options=speeds, name="speed", width=140, **style)
        self.slider = Slider(start=0.0, end=1.0, value=0.0, step=0.01, show_value=False, name="slider", **wide)
        self.runs = Select(options=[], name="runs", **wide)
        self.shade = Select(title="Motes are coloured by", options=shades, value="sent", name="shade", **wide)
        self.counters = Div(name="counters", **wide)
        self.status = Div(name="status", **style)

    def all(self) -> list:
        return list(vars(self).values())
