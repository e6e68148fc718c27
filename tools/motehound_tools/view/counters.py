"""The numbers beside the map, as HTML."""

from __future__ import annotations

import math

import numpy as np
from jinja2 import Environment, PackageLoader

from ..recording import Recording, Run
from . import targets
from .colours import colour_of
from .scene import Motes

TEMPLATE = Environment(loader=PackageLoader("motehound_tools"), autoescape=True).get_template("counters.html.j2")


def figures(run: Run, motes: Motes, time: float) -> list[tuple[str, str]]:
    """How the track and the motes are at this time."""
    estimates = run.track.until(time)
    errors = estimates["error"][np.isfinite(estimates["error"])]
    found = [("estimates", f"{len(estimates):,}")]
    if len(errors):
        if not targets.are_told_apart(run):
            found.append(("error now", f"{errors[-1]:.2f} m"))
        found.append(("error, RMS so far", f"{math.sqrt(np.mean(errors**2)):.2f} m"))
    kept = run.sink.until(time)["error"][-1:]
    if np.isfinite(kept).any():
        found.append(("error at the sink now", f"{kept[0]:.2f} m"))
    clusters = run.clusters.until(time)
    if len(clusters):
        found.append(("clusters", f"{len(clusters):,}"))
        if not targets.are_told_apart(run):
            found.append(("members now", f"{len(run.members[clusters['members'][-1]]):,}"))
    if len(run.motes):
        found.append(("energy spent", f"{np.nansum(motes.energy) / 1000.0:,.2f} J"))
    clock_errors = np.abs(motes.clock_error[np.isfinite(motes.clock_error)])
    if len(clock_errors):
        found.append(("clock error, 99th percentile", f"{np.percentile(clock_errors, 99):.3f} ms"))
    return found


def text(recording: Recording, run: Run, motes: Motes, time: float, on_screen: int) -> str:
    over = run.over and time >= run.end_s
    totals = {name: value for name, value in run.totals.items() if over and value and math.isfinite(value)}
    skipped = {"broken events": recording.broken, "events of other types": recording.unknown}
    return TEMPLATE.render(
        time=time,
        end=run.end_s,
        motes=len(motes.nodes),
        alive=int(motes.alive.sum()),
        frames=motes.frames_seen,
        on_screen=on_screen,
        figures=figures(run, motes, time),
        targets=targets.summary(run, time) if targets.are_told_apart(run) else [],
        kinds=[
            (kind, colour_of(kind), int(motes.sent_of_kind[number]))
            for kind, number in recording.kinds.items()
            if motes.sent_of_kind[number]
        ],
        totals=[(name.replace("_", " "), f"{value:,.6g}") for name, value in totals.items()],
        skipped=[(name, f"{count:,}") for name, count in skipped.items() if count],
    )
