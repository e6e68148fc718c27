"""A small output folder by the command's contract, made from a known track."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from logs import targets_run
from motehound_tools import metrics, output
from motehound_tools.scenario import Scenario


def sections(**changes: Any) -> dict[str, Any]:
    """Luo's first experiment; `changes` are `section__key=value`."""
    made: dict[str, Any] = {
        "name": "small",
        "description": "A small made-up scenario",
        "field": {"width_m": 80.0, "height_m": 80.0},
        "source": {
            "path": "arcs",
            "points": [{"x_m": 0.0, "y_m": 0.0, "speed_factor": 1.0}, {"x_m": 38.0, "y_m": 78.0, "speed_factor": 1.0}],
            "speed_mps": 1.0,
            "duration_s": 0.0,
            "release_gps": 100.0,
            "release_variation": 0.0,
            "release_period_s": 60.0,
            "diffusion_m2ps": 1.0,
        },
        "network": {"nodes": 320, "layout": "uniform", "file": ""},
        "sensor": {
            "interval_s": 1.0,
            "relative_noise": 0.01,
            "additive_noise": 0.02,
            "adc_bits": 0,
            "full_scale": 64.0,
            "loss": 0.0,
            "outage_start_s": 0.0,
            "outage_s": 0.0,
        },
        "tracker": {"name": "diffusion", "chi": 0.2},
        "metrics": {"skip_first": 3, "lost_m": 5.0, "lost_samples": 5},
    }
    for path, value in changes.items():
        section, key = path.split("__")
        made[section][key] = value
    return made


def scenario(**changes: Any) -> Scenario:
    return Scenario(sections(**changes), Path("."))


def write_output(folder: Path, runs: int = 3, samples: int = 20, error_m: float = 0.3) -> Path:
    folder.mkdir(parents=True)
    given = sections()
    (folder / "scenario.json").write_text(json.dumps(given))
    route = Scenario(given, folder).route
    places = Scenario(given, folder).nodes(0)
    (folder / "nodes.csv").write_text("node,x_m,y_m\n" + "".join(f"{i},{x},{y}\n" for i, (x, y) in enumerate(places)))
    random = np.random.default_rng(1)
    columns = [*output.TRACK_COLUMNS, *output.OPTIONAL_COLUMNS]
    with (folder / "track.csv").open("w", newline="") as stream:
        table = csv.writer(stream)
        table.writerow(columns)
        for run in range(runs):
            for time in 10.0 + np.arange(samples):
                true = route.position(np.array(time))
                x, y = true + error_m * random.standard_normal(2)
                raw = true + 3.0 * error_m * random.standard_normal(2)
                table.writerow(
                    [run, 0, time, x, y, *raw, error_m, *true, 0.5, 0.5, error_m**2, 0.0, error_m**2, 12, time - 1.0]
                    + ["", "", "", 2, 0.0, 0.0, 0, 0, 0, "", "", "", "", ""]
                )
    (folder / "runs.csv").write_text("run,seed\n" + "".join(f"{run},{run}\n" for run in range(runs)))
    (folder / "summary.json").write_text(
        json.dumps({"scenario": "small", "seed": 0, "runs": runs, "version": "test", "metrics": {}})
    )
    # The summary is filled from the track itself: what is tested here is the page, not these numbers.
    found = output.read(folder)
    assert isinstance(found, output.Output)
    each = [metrics.recompute(found, run) for run in range(runs)]
    summary = {
        name: {
            "mean": float(np.mean([m[name] for m in each])),
            "std": float(np.std([m[name] for m in each])),
            "median": float(np.median([m[name] for m in each])),
            "p95": float(np.percentile([m[name] for m in each], 95)),
            "n": runs,
        }
        for name in each[0]
    }
    (folder / "runs.csv").write_text(
        "run,seed,"
        + ",".join(summary)
        + "\n"
        + "".join(f"{r},{r}," + ",".join(str(v) for v in each[r].values()) + "\n" for r in range(runs))
    )
    (folder / "summary.json").write_text(
        json.dumps({"scenario": "small", "seed": 0, "runs": runs, "version": "test", "metrics": summary})
    )
    return folder


def write_targets(folder: Path) -> Path:
    """The same of three targets that are heard, from the messages of logs.targets_run, and a second run in which nothing was found."""
    told = [one for _, one in targets_run()]
    folder.mkdir(parents=True)

    def write(name: str, kind: str, fields: dict[str, Any]) -> None:
        with (folder / name).open("w", newline="") as stream:
            table = csv.writer(stream)
            table.writerow(["run", *fields])
            for one in told:
                if type(one).__name__ == kind:
                    table.writerow([0, *(read(one) if callable(read) else getattr(one, read) for read in fields.values())])

    def known(value: float) -> Any:
        return value if value >= 0 else ""

    plain = {name: name for name in ("time_s", "target", "x_m", "y_m")}
    columns: dict[str, Any] = {name: lambda one: "" for name in (*output.TRACK_COLUMNS[1:], *output.OPTIONAL_COLUMNS)}
    columns |= plain | {name: name for name in ("raw_x_m", "raw_y_m", "true_x_m", "true_y_m", "head", "mode", "members")}
    columns |= {f"of_{i}": lambda one, i=i: one.of[i] or "" for i in range(4)}
    columns |= {"number": lambda one: known(one.number), "extent_m": lambda one: one.extent_m or ""}
    write("track.csv", "track_t", columns)
    write("truth.csv", "truth_t", plain)
    write("watch.csv", "watch_t", plain | {"number": lambda one: known(one.number), "head": "head", "prince": lambda one: known(one.prince)})
    write("nodes.csv", "node_t", {name: name for name in ("node", "x_m", "y_m")})
    given = sections(sensor__quantity="sound", source__path="scripted", field__width_m=220.0, field__height_m=220.0)
    (folder / "scenario.json").write_text(json.dumps(given))
    with (folder / "truth.csv").open("a") as stream:
        stream.write("1,0,0,0,0\n1,20,0,200,0\n")
    (folder / "runs.csv").write_text("run,seed\n0,0\n1,1\n")
    (folder / "summary.json").write_text(json.dumps({"scenario": "three", "seed": 0, "runs": 2, "version": "test", "metrics": {}}))
    return folder


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_output(tmp_path / "out")
