"""Sweeps: the same table whatever happens on the way, and what is said of experiments that cannot be run."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pyarrow.csv
import pyarrow.parquet
import pytest

from motehound_tools import command, experiment, sweep
from motehound_tools.failure import Failure

TOOLS = Path(__file__).resolve().parents[1]
RUNS = 200
EXPERIMENT = """\
title: Luo against noise
scenario: luo_exp1
seeds: 0-19
settings: {network.nodes: 80, tracker.name: luo}
grid: {sensor.additive_noise: [0, 0.01, 0.02, 0.05, 0.1]}
series:
  - {name: one second, settings: {}}
  - {name: two seconds, settings: {sensor.interval_s: 2}}
"""


@pytest.fixture(scope="module")
def program() -> Path:
    try:
        return command.find(os.environ.get("MOTEHOUND"))
    except Failure as failure:
        pytest.skip(str(failure))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    made = tmp_path / "noise.yaml"
    made.write_text(EXPERIMENT)
    return made


def start(program: Path, file: Path, out: Path, *more: str) -> subprocess.Popen[str]:
    call = [sys.executable, "-m", "motehound_tools", "sweep", str(file), "--out", str(out), "--motehound", str(program)]
    environment = {**os.environ, "PYTHONPATH": str(TOOLS)}
    return subprocess.Popen(
        [*call, *more], env=environment, text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )


def finish(program: Path, file: Path, out: Path, *more: str) -> str:
    with start(program, file, out, *more) as process:
        told = process.communicate(timeout=120)[1]
    assert process.returncode == 0, told
    return told


def kill_in_the_middle(program: Path, file: Path, out: Path, *more: str) -> int:
    """Kill -9 when a third of the runs is there; how many were."""
    with start(program, file, out, *more) as process:
        while process.poll() is None and len(list(out.glob("runs/*.json"))) < RUNS // 3:
            time.sleep(0.005)
        process.send_signal(signal.SIGKILL)
        told = process.communicate()[1]
    assert process.returncode == -signal.SIGKILL, told
    return len(list(out.glob("runs/*.json")))


def tables(out: Path) -> tuple[bytes, bytes]:
    return (out / "table.csv").read_bytes(), (out / "table.parquet").read_bytes()


@pytest.fixture(scope="module")
def undisturbed(program: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("undisturbed")
    (folder / "noise.yaml").write_text(EXPERIMENT)
    finish(program, folder / "noise.yaml", folder / "out", "--jobs", "1")
    return folder / "out"


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A Dask cluster of two workers that cannot import these tools."""
    folder = tmp_path_factory.mktemp("cluster")
    note = folder / "scheduler.json"
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    dask = [sys.executable, "-m", "dask"]
    common = ["--scheduler-file", str(note), "--no-dashboard"]
    calls = [
        [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *common],
        *[[*dask, "worker", *common, "--nthreads", "1", "--no-nanny", "--host", "127.0.0.1"]] * 2,
    ]
    with (folder / "log").open("w") as log:
        begun = [subprocess.Popen(call, cwd=folder, env=environment, stdout=log, stderr=log) for call in calls]
        try:
            while not note.exists():
                assert begun[0].poll() is None, (folder / "log").read_text()
                time.sleep(0.05)
            yield json.loads(note.read_text())["address"]
        finally:
            for process in begun:
                process.kill()  # asked to end, a worker waits for a scheduler that may be gone
                process.wait()


@pytest.mark.sweep
def test_killed_and_started_again(program: Path, file: Path, tmp_path: Path, undisturbed: Path) -> None:
    there = kill_in_the_middle(program, file, tmp_path / "out", "--jobs", "2")
    assert RUNS // 3 <= there < RUNS
    assert not (tmp_path / "out" / "table.csv").exists()
    assert f"{there} of {RUNS} runs are there" in finish(program, file, tmp_path / "out")
    assert tables(tmp_path / "out") == tables(undisturbed)
    assert "runs are there" not in finish(program, file, tmp_path / "out")  # nothing is left to do
    assert tables(tmp_path / "out") == tables(undisturbed)


@pytest.mark.sweep
def test_killed_and_started_again_on_a_cluster(
    program: Path, file: Path, tmp_path: Path, undisturbed: Path, scheduler: str
) -> None:
    there = kill_in_the_middle(program, file, tmp_path / "out", "--scheduler", scheduler)
    assert RUNS // 3 <= there < RUNS
    finish(program, file, tmp_path / "out", "--scheduler", scheduler)
    assert tables(tmp_path / "out") == tables(undisturbed)


@pytest.mark.sweep
def test_table_and_manifest(program: Path, undisturbed: Path) -> None:
    table = pyarrow.parquet.read_table(undisturbed / "table.parquet")
    assert table.num_rows == RUNS
    assert table.column_names[:5] == ["panel", "series", "sensor.additive_noise", "sensor.interval_s", "seed"]
    assert table.column("seed").to_pylist() == list(range(20)) * 10
    assert set(table.column("sensor.additive_noise").to_pylist()) == {0, 0.01, 0.02, 0.05, 0.1}
    assert pyarrow.csv.read_csv(undisturbed / "table.csv").num_rows == RUNS
    manifest = json.loads((undisturbed / "manifest.json").read_text())
    assert len(manifest["runs"]) == RUNS and manifest["recipe"]["program"]["version"] == sweep.version(program)
    for one in manifest["runs"]:
        assert manifest["begun"] <= one["started"] <= one["ended"] <= manifest["ended"]
    # one of them by hand
    chosen = table.slice(23, 1).to_pylist()[0]
    alone = undisturbed.parent / "alone"
    settings = {"network.nodes": "80", "tracker.name": "luo", "sensor.additive_noise": "0.01"}
    command.run(program, "luo_exp1", alone, 1, 3, settings)
    header, row = (line.split(",") for line in (alone / "runs.csv").read_text().splitlines())
    assert chosen["seed"] == 3
    for name, text in zip(header[2:], row[2:]):
        assert chosen[name] == (float(text) if text else None)


def small(file: Path, **changes: str) -> Path:
    text = EXPERIMENT.replace("0-19", "0-1").replace("[0, 0.01, 0.02, 0.05, 0.1]", "[0]")
    for old, new in changes.items():
        text = text.replace(old, new)
    file.write_text(text)
    return file


def test_other_settings_are_refused_and_more_seeds_are_not(program: Path, file: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    sweep.run(small(file), out, named_program=str(program))
    first = {one.name: one.stat().st_mtime_ns for one in out.glob("runs/*")}
    assert len(first) == 4
    with pytest.raises(Failure, match="out: holds runs of other settings; choose another folder with --out"):
        sweep.run(small(file, two_seconds="", interval_s="adc_bits"), out, named_program=str(program))
    sweep.run(small(file), out, seeds="0-2", named_program=str(program))
    second = {one.name: one.stat().st_mtime_ns for one in out.glob("runs/*")}
    assert len(second) == 6 and first.items() <= second.items()
    sweep.run(small(file), out, named_program=str(program))
    assert pyarrow.parquet.read_table(out / "table.parquet").num_rows == 4


def test_a_torn_record_is_run_again(program: Path, file: Path, tmp_path: Path) -> None:
    out = sweep.run(small(file), tmp_path / "out", named_program=str(program))
    before = tables(out)
    torn = next(iter(out.glob("runs/*")))
    torn.write_bytes(torn.read_bytes()[:40])
    sweep.run(small(file), out, named_program=str(program))
    assert tables(out) == before


def test_a_run_that_fails_is_told(program: Path, file: Path, tmp_path: Path) -> None:
    file.write_text("scenario: luo_exp1\nseeds: 1\ngrid: {network.layout: [uniform, file]}\n")
    with pytest.raises(Failure, match="^network.layout=file, seed 0: .*network.file"):
        sweep.run(file, tmp_path / "out", named_program=str(program))
    assert len(list(tmp_path.glob("out/runs/*.json"))) <= 1 and not (tmp_path / "out" / "table.csv").exists()


def test_another_build_or_none_on_a_worker(program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    other = sweep.perform(str(program), "0" * 64, "luo_exp1", None, {}, 0)
    assert "another build than the sweep's" in other[sweep.CANNOT]
    expected = sweep.fingerprint(program)
    monkeypatch.setenv("PATH", str(tmp_path))
    none = sweep.perform(str(tmp_path / "motehound"), expected, "luo_exp1", None, {}, 0)
    assert "nor a motehound on the PATH" in none[sweep.CANNOT]
    (tmp_path / "motehound").symlink_to(program)  # not where the sweep has it, but on the PATH
    found = sweep.perform("/nowhere/motehound", expected, "luo_exp1", None, {"network.nodes": "80"}, 5)
    assert found["seed"] == 5 and found["metrics"]["estimates"] is not None


def test_two_sweeps_in_one_folder(program: Path, file: Path, tmp_path: Path) -> None:
    with sweep.owned(tmp_path / "out"), pytest.raises(Failure, match="another sweep is at work"):
        sweep.run(small(file), tmp_path / "out", named_program=str(program))


def test_no_scheduler(program: Path, file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep, "DASK_TIMEOUT_S", 1)
    with pytest.raises(Failure, match="--scheduler tcp://127.0.0.1:9: no Dask scheduler answers"):
        sweep.run(small(file), tmp_path / "out", scheduler="tcp://127.0.0.1:9", named_program=str(program))


KEYS = {
    "sensor.interval_s": "a number 0.01 to 3600; between samples",
    "network.nodes": "a whole number 4 to 1000000; sensor nodes",
    "tracker.name": "one of diffusion/luo/range",
    "tracker.nonlinear": "true or false; luo",
    "name": "UTF-8 text of at most 100 bytes",
}
GOOD = """\
scenario: luo_exp1
seeds: 3
grid:
  sensor.interval_s: [1, 2]
  network.nodes: [100, 200]
panels:
  - title: (a)
    draw: [{x: network.nodes, lines: sensor.interval_s, y: [{metric: position_rmse_m}]}]
  - title: (b)
    settings: {tracker.nonlinear: true}
    series: [{name: default, settings: {tracker.name: diffusion}}]
    grid: {network.nodes: [50]}
    seeds: [4, 7-8]
"""


def test_points(tmp_path: Path) -> None:
    (tmp_path / "good.yaml").write_text(GOOD)
    points = list(experiment.points(experiment.read(tmp_path / "good.yaml", KEYS)))
    assert [(p.panel, p.series, p.settings, p.seeds) for p in points] == [
        ("(a)", "", {"sensor.interval_s": "1", "network.nodes": "100"}, [0, 1, 2]),
        ("(a)", "", {"sensor.interval_s": "1", "network.nodes": "200"}, [0, 1, 2]),
        ("(a)", "", {"sensor.interval_s": "2", "network.nodes": "100"}, [0, 1, 2]),
        ("(a)", "", {"sensor.interval_s": "2", "network.nodes": "200"}, [0, 1, 2]),
        (
            "(b)",
            "default",
            {"tracker.nonlinear": "true", "tracker.name": "diffusion", "network.nodes": "50"},
            [4, 7, 8],
        ),
    ]
    assert [p.seeds for p in experiment.points(experiment.read(tmp_path / "good.yaml", KEYS, "9,11-12"))] == [
        [9, 11, 12]
    ] * 5


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("scenario: luo_exp1\n", "", ":1: scenario: expected, but absent"),
        ("seeds: 3", "sedes: 3", ":2: sedes: no such key of an experiment"),
        ("seeds: 3", "seeds: 3-1", ":2: seeds: expected seeds such as 3 or 0-19, found '3-1'"),
        ("seeds: 3", "seeds: [1, 1]", ":2: seeds: expected each seed once"),
        ("seeds: 3", "seeds: 3\nseeds: 4", ':3: found duplicate key "seeds"'),
        ("seeds: 3\n", "", ":6: panels[0].seeds: expected, but absent"),
        ("[1, 2]", "[1, 2", ":5: "),
        ("[1, 2]", "1", ":4: grid.sensor.interval_s: expected a valid list"),
        ("[1, 2]", "[]", ":4: grid.sensor.interval_s: list should have at least 1 item"),
        ("[1, 2]", "[1, {a: 2}]", ":4: grid.sensor.interval_s[1]: expected a number, a word, true or false"),
        ("[1, 2]", "[1, 9999]", ":4: grid.sensor.interval_s[1]: expected a number 0.01 to 3600"),
        ("[100, 200]", "[100, 2.5]", ":5: grid.network.nodes[1]: expected a whole number 4 to 1000000"),
        ("[100, 200]", "[100, many]", "found 'many'"),
        ("  network.nodes", "  network.node", ":5: grid.network.node[0]: no such key; `motehound list --keys`"),
        (
            "tracker.nonlinear: true",
            "tracker.nonlinear: 1",
            ":10: panels[1].settings.tracker.nonlinear: expected true or false",
        ),
        (
            "diffusion}",
            "kalman}",
            ":11: panels[1].series[0].settings.tracker.name: expected one of diffusion/luo/range",
        ),
        ("title: (b)", "title: (a)", ":9: panels[1].title: expected a title for each panel, found '(a)' again"),
        (
            "x: network.nodes",
            "x: network.node",
            ":8: panels[0].draw[0].x: expected an axis of the grid (sensor.interval_s",
        ),
        ("y: [{metric: position_rmse_m}]", "y: []", ":8: panels[0].draw[0].y: list should have at least 1 item"),
        ("{x:", "{kind: pie, x:", ":8: panels[0].draw[0].kind: expected 'lines', 'bars' or 'curves'"),
    ],
)
def test_bad_experiments(tmp_path: Path, old: str, new: str, said: str) -> None:
    assert old in GOOD
    file = tmp_path / "bad.yaml"
    file.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(Failure, match=f"^{re.escape(str(file))}.*{re.escape(said)}") as failure:
        experiment.read(file, KEYS)
    assert "\n" not in str(failure.value)


@pytest.mark.parametrize("text", ["", "- a", "word", "{", "\x00"])
def test_files_that_are_no_experiment(tmp_path: Path, text: str) -> None:
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(Failure, match="bad.yaml"):
        experiment.read(tmp_path / "bad.yaml")


def test_absent_file(tmp_path: Path) -> None:
    with pytest.raises(Failure, match="absent.yaml: No such file"):
        experiment.read(tmp_path / "absent.yaml")
