"""The page from an output folder, and what is said when the folder is not one."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from conftest import write_output, write_targets
from logs import program

from motehound_tools import (
    command,
    curves,
    experiment,
    figures,
    metrics,
    output,
    search_figures,
    sweep,
    sweep_figures,
    target_figures,
)
from motehound_tools.failure import Failure
from motehound_tools.output import Output
from motehound_tools.report import number
from motehound_tools.scenario import Scenario

TOOLS = Path(__file__).resolve().parents[1]


def call(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "motehound_tools", *map(str, arguments)],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(TOOLS)},
    )


class Page(HTMLParser):
    """Checks that tags nest, and collects what the page shows."""

    EMPTY = {"meta", "img", "br", "link"}

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.images: list[dict[str, str | None]] = []
        self.links: list[str] = []
        self.text = ""
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in self.EMPTY:
            self.open.append(tag)
        given = dict(attrs)
        if tag == "img":
            self.images.append(given)
        self.links += [value or "" for name, value in attrs if name in ("src", "href")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def test_page_of_a_run(folder: Path) -> None:
    done = call("report", folder)
    assert done.returncode == 0, done.stderr
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    titles = [str(image["alt"]).partition(".")[0] for image in page.images]
    assert titles == ["Field", "Track", "Error against time", "Distribution"]
    assert all(link.startswith("data:image/svg+xml;base64,") for link in page.links)  # nothing is fetched
    assert "position_rmse_m" in page.text
    assert number(output.read(folder).statistic("position_rmse_m")) in page.text  # type: ignore[union-attr]


def test_page_of_a_run_with_boards(folder: Path) -> None:
    summary = json.loads((folder / "summary.json").read_text())
    board = {"node": 17, "board": "atmega128", "image": "images/atmega128/sensor_node", "arithmetic": "fixed", "events": 174, "cycles_mean": 5864.0}
    board |= {"cycles_max": 8110, "rate_hz": 7372800.0, "late": 0, "overlapped": 28, "ram_b": 4096, "ram_free_b": 2808}
    summary["boards"] = [board, {key: board[key] for key in board if not key.startswith("ram")}]
    (folder / "summary.json").write_text(json.dumps(summary))
    done = call("report", folder)
    assert done.returncode == 0, done.stderr
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    for said in ("Emulated boards", "atmega128, fixed", "sensor_node", "174", number(8110 / 7372.8), "2,808 of 4,096 B"):
        assert said in page.text


def titles_of(folder: Path) -> dict[str, str]:
    done = call("report", folder)
    assert done.returncode == 0, done.stderr
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    assert "1.39)" not in page.text.replace("(exact: 1.39 of two", "")  # what is exact of two states alone
    return {title: rest for title, _, rest in (str(image["alt"]).partition(". ") for image in page.images)}


@pytest.mark.parametrize("scenario", ["zhang_m", "xu_real"])
def test_page_of_searches_and_fixed_clusters(tmp_path: Path, scenario: str) -> None:
    told = [str(program()), "run", scenario, "--runs", "2", "--out", str(tmp_path / "out")]
    subprocess.run(told, capture_output=True, check=True)
    titles = titles_of(tmp_path / "out")
    if scenario.startswith("zhang"):
        heads = np.genfromtxt(tmp_path / "out" / "track.csv", delimiter=",", names=True)["run"] == 0
        assert f"Run 0: {heads.sum()} heads" in titles["The search"]
        assert {"Beside the bound", "Error against time"} < {*titles}
    else:
        assert titles["Field"] == "Run 0: 4 clusters of 3, 4, 5, 6 nodes."
        assert {"Error against time", "Stated uncertainty", "Distribution"} < {*titles}


def test_page_of_several_targets(tmp_path: Path) -> None:
    titles = titles_of(write_targets(tmp_path / "out"))
    assert {"Targets", "Heads", "Modes", "Error against time"} < {*titles}
    assert "18 of 24 hand-overs" in titles["Heads"]  # not after 6 s, when there is no prince, nor when they meet and part


def test_page_of_a_target_that_is_heard(tmp_path: Path) -> None:
    told = [str(program()), "run", "han_straight", "--set", "source.points=150,150; 350,350", "--out", str(tmp_path / "out")]
    subprocess.run(told, capture_output=True, check=True)
    titles = titles_of(tmp_path / "out")
    assert {"Targets", "Heads", "Error against time"} < {*titles} and "Modes" not in titles
    found = output.read(tmp_path / "out")
    assert isinstance(found, Output)
    (fate,) = target_figures.fates(found)
    assert (fate.runs, fate.found) == (1, 1) and fate.estimates == len(found.track["run"]) > 2
    known = target_figures.errors(found.track)
    assert fate.error_m == pytest.approx(float(known.mean()), abs=0.01)  # by truth.csv as by the truth beside each estimate


def test_fates_of_several_targets(tmp_path: Path) -> None:
    found = output.read(write_targets(tmp_path / "out"))
    assert isinstance(found, Output)
    low, middle, high = target_figures.fates(found)
    assert [(one.found, one.runs) for one in (low, middle, high)] == [(1, 2), (1, 1), (1, 1)]
    assert [(one.estimates, one.grouped) for one in (low, middle, high)] == [(10, 3), (10, 3), (10, 0)]
    assert all((one.lost, one.swapped, one.identifiers) == (0, 0, 1) for one in (low, middle, high))
    assert low.error_m == pytest.approx(2.0**0.5)
    tracks = found.track
    late = (tracks["target"] == 50) & (tracks["time_s"] > 4)
    tracks["x_m"][late], tracks["target"][late] = -999.0, 77.0  # as if never found again, and another far off
    tracks["number"][late] = np.nan
    ends = (tracks["target"] == 33) & (tracks["time_s"] == 20)
    tracks["y_m"][ends] = tracks["y_m"][(tracks["target"] == 16) & (tracks["time_s"] == 20)]
    low, middle, high = target_figures.fates(found)
    assert (low.swapped, middle.swapped, high.swapped, high.lost, high.estimates) == (0, 1, 0, 1, 2)


def test_mean_concentration_far_from_the_source_falls_with_the_inverse_of_the_distance_downwind() -> None:
    given = {"wind": {"direction_rad": 0.0, "speed_mps": 1.0}, "source": {"rate_mlps": 30.0, "mixing_m2ps": 30.0}}
    places, source = np.array([[450.0, 200.0], [250.0, 200.0]]), np.array([50.0, 200.0])
    ppm = search_figures.mean_ppm(Scenario(given, Path(".")), places, source)
    assert np.allclose(ppm, [3.9789e-4, 7.9577e-4], rtol=1e-4)  # 1 / (2 pi 400), 1 / (2 pi 200)


def test_chi_squared_of_three_states() -> None:
    for x, share in ((2.36597, 0.5), (7.81473, 0.95)):
        assert abs(search_figures.chi_squared_3(x) - share) < 1e-5


def test_same_folder_same_bytes(folder: Path) -> None:
    for name in ("a.html", "b.html"):
        assert call("report", folder, "--html", folder / name).returncode == 0
    assert (folder / "a.html").read_bytes() == (folder / "b.html").read_bytes()


def test_page_shows_the_network(folder: Path) -> None:
    summary = json.loads((folder / "summary.json").read_text())
    sizes = {
        "energy_mj": 3000.0,
        "energy_mj_routing": 1000.0,
        "energy_mj_idle": 2000.0,
        "energy_mj_state_listen": 2500.0,
        "energy_mj_state_transmit": 500.0,
        "lifetime_s": 77.0,
        "frames_sent": 9.0,
        "frames_received": 90.0,
        "frames_lost_collision": 12.0,
        "frames_lost_busy": 3.0,
        "frames_lost_jammed": 0.0,
    }
    for name, size in sizes.items():
        summary["metrics"][name] = {"mean": size, "std": 0.0, "median": size, "p95": size, "n": 3}
    (folder / "summary.json").write_text(json.dumps(summary))
    assert call("report", folder).returncode == 0
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    said = {str(image["alt"]).partition(".")[0]: str(image["alt"]) for image in page.images}
    assert "used 3.00 J a run" in said["Energy"] and "after 77 s" in said["Energy"]
    assert "9 frames were sent" in said["Frames lost"]
    found = output.read(folder)
    assert isinstance(found, output.Output)
    drawn = figures.losses_picture(found)
    assert drawn and "collision" in drawn.svg and "busy" in drawn.svg and "jammed" not in drawn.svg


def test_metrics_of_the_command_are_known() -> None:
    told = subprocess.run([str(program()), "list", "--metrics"], capture_output=True, text=True, check=True)
    names = [line.split()[0] for line in told.stdout.splitlines()]
    causes = [name.removeprefix("energy_mj_per_sample_") for name in names if name.startswith("energy_mj_per_sample_")]
    assert causes == list(figures.CAUSES) and {f"energy_mj_{cause}" for cause in causes} < {*names}
    states = [name.removeprefix("energy_mj_state_") for name in names if name.startswith("energy_mj_state_")]
    assert states == list(figures.STATES)
    lost = [name.removeprefix("frames_lost_") for name in names if name.startswith("frames_lost_")]
    assert {*figures.LOST_AT_SENDER} < {*lost}


def test_page_of_a_sweep(tmp_path: Path) -> None:
    for value in (0.5, 1, 10):
        folder = write_output(tmp_path / str(value), error_m=value / 3.0)
        scenario = json.loads((folder / "scenario.json").read_text())
        scenario["sweep"] = {"key": "sensor.interval_s", "values": ["0.5", "1", "10"]}
        (folder / "scenario.json").write_text(json.dumps(scenario))
    done = call("report", tmp_path, "--html", tmp_path / "page.html")
    assert done.returncode == 0, done.stderr
    page = Page((tmp_path / "page.html").read_text(encoding="utf-8"))
    assert str(page.images[0]["alt"]).startswith("Error against sampling interval")
    found = output.read(tmp_path)
    assert isinstance(found, output.Sweep) and found.values == [0.5, 1.0, 10.0]


def test_sweep_of_the_command_names_folders_by_value(tmp_path: Path) -> None:
    for value in ("640", "1280", "1920"):
        folder = write_output(tmp_path / value)
        scenario = json.loads((folder / "scenario.json").read_text())
        scenario["sweep"] = {"key": "network.nodes", "values": ["640", "1280", "1920"]}
        (folder / "scenario.json").write_text(json.dumps(scenario))
    found = output.read(tmp_path)
    assert isinstance(found, output.Sweep)
    assert found.key == "network.nodes" and found.values == [640.0, 1280.0, 1920.0]


@pytest.fixture
def swept(tmp_path: Path) -> Path:
    """A sweep of made-up runs: error = speed + noise of the seed, twice that for the second series."""
    program = tmp_path / "program"
    program.write_text(
        f"""#!{sys.executable}
import sys, pathlib
if sys.argv[1] == "--version":
    print("made up 1")
elif sys.argv[1] == "list":
    print("source.speed_mps 1 a number 0 to 100")
    print("tracker.name luo one of luo/diffusion")
else:
    given = dict(zip(sys.argv[2::2], sys.argv[3::2]))
    settings = dict(word.split("=") for word in sys.argv if "=" in word)
    error = (float(settings["source.speed_mps"]) + int(sys.argv[sys.argv.index("--seed") + 1])) * (2 if settings["tracker.name"] == "luo" else 1)
    out = pathlib.Path(sys.argv[sys.argv.index("--out") + 1])
    out.mkdir()
    (out / "runs.csv").write_text(f"run,seed,position_rmse_m,least_m,nothing\\n0,0,{{error}},1,\\n")
"""
    )
    program.chmod(0o755)
    (tmp_path / "speed.yaml").write_text(
        """
title: Error against speed
scenario: luo_exp1
seeds: 3
grid: {source.speed_mps: [1, 4, 9]}
series: [{name: Luo, settings: {tracker.name: luo}}, {name: default, settings: {tracker.name: diffusion}}]
draw:
  - title: lines
    label: RMSE, m
    y: [{metric: position_rmse_m}]
    bounds: [{name: least, metric: least_m, scale: 0.5}]
  - {title: bars, kind: bars, y: [{metric: position_rmse_m}]}
  - {title: nothing to draw, y: [{metric: nothing}]}
"""
    )
    return sweep.run(tmp_path / "speed.yaml", tmp_path / "sweeps" / "speed", named_program=str(program))


def test_figures_of_a_sweep(swept: Path) -> None:
    table = sweep_figures.Table.read(swept)
    over_speed, over_series = sweep_figures.pictures(table)
    assert over_speed.head == ["speed of the source, m/s", "Luo", "default", "least"]
    # seeds 0, 1, 2: the mean is one more than the speed, the standard deviation one
    assert over_speed.numbers == [
        ["1", "4 ± 2", "2 ± 1", "0.5 ± 0"],
        ["4", "10 ± 2", "5 ± 1", "0.5 ± 0"],
        ["9", "20 ± 2", "10 ± 1", "0.5 ± 0"],
    ]
    assert over_series.numbers == [["Luo", "11.33 ± 2"], ["default", "5.667 ± 1"]]
    assert "over every speed of the source" in over_series.picture.caption


def test_page_of_a_sweep_of_an_experiment(swept: Path) -> None:
    for folder in (swept, swept.parent):
        done = call("report", folder)
        assert done.returncode == 0, done.stderr
        page = Page((folder / "report.html").read_text(encoding="utf-8"))
        assert [str(image["alt"]).partition(".")[0] for image in page.images] == ["lines", "bars"]
        assert "Error against speed" in page.text and "10 ± 2" in page.text


def test_sweep_without_its_table(swept: Path) -> None:
    (swept / "table.parquet").unlink()
    done = call("report", swept)
    assert done.returncode == 1 and "expected the manifest.json and table.parquet of a sweep" in done.stderr
    assert done.stderr.count("\n") == 1


def test_drawing_of_an_unknown_metric(swept: Path) -> None:
    manifest = json.loads((swept / "manifest.json").read_text())
    manifest["experiment"]["draw"] = [{"y": [{"metric": "rmse"}]}]
    (swept / "manifest.json").write_text(json.dumps(manifest))
    done = call("report", swept)
    assert done.returncode == 1 and "no metric `rmse`" in done.stderr


EXPERIMENTS = sorted((TOOLS.parent / "experiments").glob("*.yaml"))


@pytest.mark.parametrize("file", EXPERIMENTS, ids=lambda file: file.stem)
def test_experiments_of_this_repository(file: Path) -> None:
    try:
        program = command.find(os.environ.get("MOTEHOUND"))
    except Failure as failure:
        pytest.skip(str(failure))
    wanted = experiment.read(file, command.keys(program))
    metrics_known = command.metrics(program)
    for panel in experiment.panels(wanted):
        for drawing in panel.draw:
            known = set(curves.NAMES) if drawing.kind == "curves" else metrics_known
            assert {quantity.metric for quantity in (*drawing.y, *drawing.bounds)} <= known


def test_page_of_clusters(tmp_path: Path) -> None:
    try:
        program = command.find(os.environ.get("MOTEHOUND"))
    except Failure as failure:
        pytest.skip(str(failure))
    command.run(program, "zhou_nominal", tmp_path / "out", 2, 0, {"source.duration_s": "600"})
    assert call("report", tmp_path / "out").returncode == 0
    page = Page((tmp_path / "out" / "report.html").read_text(encoding="utf-8"))
    titles = [str(image["alt"]).partition(".")[0] for image in page.images]
    assert titles == ["Field", "Track from near", "Error against time", "Distribution", "Beside the bounds", "Energy"]
    assert "clusters formed" in page.text and "noise of a range" in page.text
    found = output.read(tmp_path / "out")
    assert isinstance(found, output.Output)
    times, quantiles = figures.over_time(found.track, metrics.errors(found.track))
    assert len(times) == 301 and quantiles.shape == (5, 301)  # every instant for itself
    later = {name: np.concatenate([column, column]) for name, column in found.track.items()}
    later["time_s"][len(later["time_s"]) // 2 :] += 1000.0
    times, quantiles = figures.over_time(later, metrics.errors(later))
    assert len(times) == len(quantiles[0]) == 101  # six put together


def test_page_without_scenario_and_truth(folder: Path) -> None:
    (folder / "scenario.json").unlink()
    lines = (folder / "track.csv").read_text().splitlines()
    blind = [lines[0]] + [",".join([*line.split(",")[:8], "", "", *line.split(",")[10:]]) for line in lines[1:]]
    (folder / "track.csv").write_text("\n".join(blind) + "\n")
    assert call("report", folder).returncode == 0
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    assert [str(image["alt"]).partition(".")[0] for image in page.images] == ["Track"]


def test_page_without_estimates(folder: Path) -> None:
    (folder / "track.csv").write_text((folder / "track.csv").read_text().splitlines()[0] + "\n")
    assert call("report", folder).returncode == 0
    assert "no estimate" in Page((folder / "report.html").read_text(encoding="utf-8")).text


def _no_folder(folder: Path) -> Path:
    return folder / "absent"


def _no_summary(folder: Path) -> Path:
    (folder / "summary.json").unlink()
    return folder


def _broken_summary(folder: Path) -> Path:
    (folder / "summary.json").write_text("{")
    return folder


def _summary_without_statistics(folder: Path) -> Path:
    (folder / "summary.json").write_text(json.dumps({"metrics": {"position_rmse_m": {"mean": 1}}}))
    return folder


def _missing_column(folder: Path) -> Path:
    text = (folder / "track.csv").read_text()
    (folder / "track.csv").write_text(text.replace("raw_x_m", "other", 1))
    return folder


def _short_row(folder: Path) -> Path:
    with (folder / "track.csv").open("a") as stream:
        stream.write("1,2\n")
    return folder


def _word_for_number(folder: Path) -> Path:
    lines = (folder / "track.csv").read_text().splitlines()
    fields = lines[2].split(",")
    fields[3] = "here"
    lines[2] = ",".join(fields)
    (folder / "track.csv").write_text("\n".join(lines) + "\n")
    return folder


def _scenario_without_field(folder: Path) -> Path:
    (folder / "scenario.json").write_text('{"metrics": {"skip_first": 3}}')
    return folder


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (_no_folder, "no such folder"),
        (_no_summary, "summary.json: No such file"),
        (_broken_summary, "summary.json: not JSON"),
        (_summary_without_statistics, "`position_rmse_m` needs mean, std"),
        (_missing_column, "track.csv:1: the column `raw_x_m` is missing"),
        (_short_row, "2 fields, expected 31"),
        (_word_for_number, "track.csv:3: `x_m` is not a number"),
        (_scenario_without_field, "scenario.json: the key `field.width_m` is missing"),
    ],
)
def test_malformed_folder(folder: Path, spoil: Callable[[Path], Path], said: str) -> None:
    done = call("report", spoil(folder))
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1 and said in done.stderr
    assert not list(folder.glob("*.html*"))


def test_page_that_cannot_be_written(folder: Path) -> None:
    done = call("report", folder, "--html", folder / "absent" / "page.html")
    assert done.returncode == 1 and done.stderr.count("\n") == 1 and "cannot be written" in done.stderr


def test_recomputed_metrics_of_a_known_track(folder: Path) -> None:
    # Two targets of two estimates, 3 m and 4 m off along the axes; the covariance says 1 m and 2 m.
    track = {name: np.zeros(4) for name in (*output.TRACK_COLUMNS, *output.OPTIONAL_COLUMNS)}
    track["target"] = np.array([0.0, 1.0, 0.0, 1.0])
    track["x_m"] = np.array([3.0, 3.0, 0.0, 0.0])
    track["y_m"] = np.array([0.0, 0.0, 4.0, 4.0])
    track["cov_xx_m2"] += 1.0
    track["cov_yy_m2"] += 4.0
    assert metrics.order_in_track(track).tolist() == [0, 0, 1, 1]
    assert metrics.errors(track).tolist() == [3, 3, 4, 4]
    assert metrics.normalised(track).tolist() == [9, 9, 4, 4]
    assert metrics.rms(metrics.errors(track)) == pytest.approx(np.sqrt(12.5))


def test_complete_folders_are_recognised(folder: Path) -> None:
    program = Path(__file__)
    assert command.is_complete(folder, 3, 0, program)
    assert not command.is_complete(folder, 4, 0, program)
    assert not command.is_complete(folder / "absent", 3, 0, program)
    os.utime(folder / "summary.json", (1, 1))
    assert not command.is_complete(folder, 3, 0, program)  # older than the program


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0474, "0.0474"), (3.5312, "3.53"), (18.24, "18.2"), (1234.0, "1,234"), (float("nan"), "–"), (0, "0")],
)
def test_numbers_as_they_are_written(value: float, text: str) -> None:
    assert number(value) == text
