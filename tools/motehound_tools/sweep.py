"""The runs of an experiment, on this machine or on a Dask cluster, and the table of their results.

OUT/manifest.json says what was run with which program, when and where; OUT/runs/ID.json is one finished run, there as a
whole or not at all, so that a sweep which was interrupted in any way goes on where it stopped. When all runs are there,
OUT/table.csv and OUT/table.parquet are written from them in the order of the experiment: their bytes depend on nothing else."""

from __future__ import annotations

import csv
import fcntl
import hashlib
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import pyarrow
import pyarrow.csv
import pyarrow.parquet

from . import batch, command, curves, experiment
from .experiment import Experiment
from .failure import Failure

DASK_TIMEOUT_S = 20
CANNOT = "cannot"  # of a record in place of results: why there are none


def now() -> str:
    return datetime.now(timezone.utc).isoformat(timespec="milliseconds")


def fingerprint(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def perform(
    program: str,
    expected: str,
    scenario: str,
    scratch: str | None,
    settings: dict[str, str],
    seed: int,
    over_time: bool = False,
) -> dict[str, Any]:
    """One run, on any machine that has the program at this path or on its PATH: its record, or why there is none."""
    host = socket.gethostname()
    found = shutil.which(program) or shutil.which("motehound")
    if found is None:
        return {CANNOT: f"{host}: neither {program} nor a motehound on the PATH"}
    if fingerprint(Path(found)) != expected:
        return {CANNOT: f"{host}: {found} is another build than the sweep's; expected the same program on all machines"}
    started = now()
    with tempfile.TemporaryDirectory(prefix="motehound-", dir=scratch) as folder:
        out = Path(folder) / "out"
        try:
            command.run(Path(found), scenario, out, 1, seed, settings)
        except Failure as failure:
            return {CANNOT: f"{' '.join(f'{key}={value}' for key, value in settings.items())}, seed {seed}: {failure}"}
        with (out / "runs.csv").open(newline="", encoding="utf-8") as stream:
            (results,) = csv.DictReader(stream)
        more = {"curves": curves.of(out)} if over_time else {}
    metrics = {name: float(text) if text else None for name, text in results.items() if name not in ("run", "seed")}
    told = {"seed": seed, "settings": settings, "host": host, "started": started, "ended": now(), "metrics": metrics}
    return told | more


def put(file: Path, write: Any) -> None:
    """Let `write` fill a file that appears whole or not at all, even if the machine stops."""
    part = file.with_name(f".{file.name}.part")
    with part.open("wb") as stream:
        write(stream)
        stream.flush()
        os.fsync(stream.fileno())
    part.replace(file)


def put_json(file: Path, content: object) -> None:
    put(file, lambda stream: stream.write((json.dumps(content, indent=1) + "\n").encode()))


def get_json(file: Path) -> dict[str, Any] | None:
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


@contextmanager
def owned(out: Path) -> Iterator[None]:
    """Nobody else works in this folder at the same time; the lock goes with the process."""
    out.mkdir(parents=True, exist_ok=True)
    with (out / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise Failure(f"{out}: another sweep is at work in this folder") from None
        yield


class Sent:
    """A function that is pickled with all of this package that it uses: who receives it does not need the package."""

    def __init__(self, function: Callable[..., Any]) -> None:
        import cloudpickle

        import motehound_tools

        cloudpickle.register_pickle_by_value(motehound_tools)
        self.function, self.packed, self.unpack = function, cloudpickle.dumps(function), cloudpickle.loads
        cloudpickle.unregister_pickle_by_value(motehound_tools)

    def __call__(self, *arguments: Any) -> Any:
        return self.function(*arguments)

    def __reduce__(self) -> tuple[Callable[[bytes], Any], tuple[bytes]]:
        return self.unpack, (self.packed,)


def cluster(address: str) -> Executor:
    """The workers of a Dask cluster."""
    import distributed

    try:
        client = distributed.Client(address, timeout=DASK_TIMEOUT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise Failure(f"--scheduler {address}: no Dask scheduler answers: {error}") from None
    if not client.scheduler_info()["workers"]:
        print(f"{address}: no workers yet; they may come at any time", file=sys.stderr)
    return client.get_executor(pure=False)


def version(program: Path) -> str:
    try:
        told = subprocess.run([str(program), "--version"], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise Failure(f"{program}: {error}") from None
    return told.stdout.strip()


def scenario_of(wanted: Experiment, file: Path) -> str:
    """A file beside the experiment's, else a name that the program knows."""
    beside = file.parent / wanted.scenario
    return str(beside.resolve()) if beside.is_file() else wanted.scenario


def recipe(wanted: Experiment, scenario: str, program: Path) -> dict[str, Any]:
    """All that decides on the runs but for their seeds: what must stay the same for a folder to go on with."""
    file = Path(scenario)
    return {
        "program": {"version": version(program), "sha256": fingerprint(program)},
        "scenario": {"name": wanted.scenario, "sha256": fingerprint(file) if file.is_file() else ""},
        "points": [[point.panel, point.series, point.settings] for point in experiment.points(wanted)],
    }


def check_unchanged(out: Path, before: dict[str, Any], after: dict[str, Any]) -> None:
    differences = {
        "program": "another build of the program",
        "scenario": "another scenario",
        "points": "other settings",
    }
    for part, what in differences.items():
        if before.get(part) != after[part]:
            raise Failure(f"{out}: holds runs of {what}; choose another folder with --out, or delete this one")


def identity(settings: dict[str, str], seed: int) -> str:
    """The name of a run within a sweep."""
    return hashlib.sha256(json.dumps([sorted(settings.items()), seed]).encode()).hexdigest()[:20]


def column(values: list[Any]) -> pyarrow.Array:
    """Numbers where all are numbers, otherwise text; what is absent is null."""
    try:
        return pyarrow.array([None if v is None or v == "" else float(v) for v in values], pyarrow.float64())
    except ValueError:
        return pyarrow.array(values, pyarrow.string())


def table(wanted: Experiment, records: dict[str, dict[str, Any]]) -> pyarrow.Table:
    """A row for each panel, series, point of the grid and seed: what was set, then every metric."""
    rows = [(point, seed) for point in experiment.points(wanted) for seed in point.seeds]
    metrics = [records[identity(point.settings, seed)]["metrics"] for point, seed in rows]
    names = dict.fromkeys(name for of_run in metrics for name in of_run)
    columns = {
        "panel": pyarrow.array([point.panel for point, _ in rows], pyarrow.string()),
        "series": pyarrow.array([point.series for point, _ in rows], pyarrow.string()),
        **{key: column([point.settings.get(key) for point, _ in rows]) for key in experiment.keys(wanted)},
        "seed": pyarrow.array([seed for _, seed in rows], pyarrow.int64()),
        **{name: column([of_run.get(name) for of_run in metrics]) for name in names},
    }
    return pyarrow.table(columns)


def curves_table(wanted: Experiment, records: dict[str, dict[str, Any]]) -> pyarrow.Table:
    """A row for each value over time: panel, series, seed, name, time, value. Of experiments that draw curves."""
    rows = [
        (point.panel, point.series, seed, name, *pair)
        for point in experiment.points(wanted)
        for seed in point.seeds
        for name, pairs in records[identity(point.settings, seed)]["curves"].items()
        for pair in pairs
    ]
    names = ("panel", "series", "seed", "curve", "time_s", "value")
    return pyarrow.table(dict(zip(names, map(list, zip(*rows)))))


def run(
    file: Path,
    out: Path | None = None,
    seeds: str | None = None,
    jobs: int | None = None,
    scheduler: str | None = None,
    named_program: str | None = None,
) -> Path:
    """Run what is missing of the experiment and write its table; the table's folder."""
    program = command.find(named_program).resolve()
    wanted = experiment.read(file, command.keys(program), seeds)
    out = out or Path("out") / file.stem
    scenario = scenario_of(wanted, file)
    made_of = recipe(wanted, scenario, program)
    with owned(out):
        before = get_json(out / "manifest.json")
        if (out / "runs").exists():
            check_unchanged(out, before["recipe"] if before else {}, made_of)
        manifest = {
            "begun": before["begun"] if before else now(),
            "ended": None,
            "experiment": wanted.model_dump(exclude_defaults=True),
            "recipe": made_of,
            "runs": [],
        }
        put_json(out / "manifest.json", manifest)
        needed = {
            identity(point.settings, seed): (point.settings, seed)
            for point in experiment.points(wanted)
            for seed in point.seeds
        }
        over_time = experiment.has_curves(wanted)
        what = (str(program), made_of["program"]["sha256"], scenario, over_time)
        records = finish(out, needed, what, jobs, scheduler)
        made = table(wanted, records)
        put(out / "table.csv", lambda stream: pyarrow.csv.write_csv(made, stream))
        put(out / "table.parquet", lambda stream: pyarrow.parquet.write_table(made, stream))
        if over_time:
            over = curves_table(wanted, records)
            put(out / "curves.parquet", lambda stream: pyarrow.parquet.write_table(over, stream))
        told = ("seed", "settings", "host", "started", "ended")
        manifest["runs"] = [{"id": name, **{key: records[name][key] for key in told}} for name in needed]
        manifest["ended"] = max(records[name]["ended"] for name in needed)
        put_json(out / "manifest.json", manifest)
    return out


def finish(
    out: Path,
    needed: dict[str, tuple[dict[str, str], int]],
    what: tuple[str, str, str, bool],
    jobs: int | None,
    scheduler: str | None,
) -> dict[str, dict[str, Any]]:
    """The records of all needed runs of `what`: program, its fingerprint, scenario, and whether curves are wanted. Those that are not in the folder are run, all settings with the first seed first."""
    folder, scratch = out / "runs", out / "scratch"
    folder.mkdir(exist_ok=True)
    kept = {name: get_json(folder / f"{name}.json") for name in needed}
    program, expected, scenario, over_time = what
    records = {name: record for name, record in kept.items() if record and (not over_time or "curves" in record)}
    missing = sorted((name for name in needed if name not in records), key=lambda name: needed[name][1])
    if records and missing:
        print(f"{out}: {len(records)} of {len(needed)} runs are there", file=sys.stderr)
    if not missing:
        return records
    for stale in ("table.csv", "table.parquet", "curves.parquet"):
        (out / stale).unlink(missing_ok=True)
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(exist_ok=True)  # runs that a killed sweep left behind may still write there
    pool = cluster(scheduler) if scheduler else batch.local(jobs)
    function = Sent(perform) if scheduler else perform
    place = None if scheduler else str(scratch)
    with pool:
        calls = {name: (program, expected, scenario, place, *needed[name], over_time) for name in missing}
        try:
            for name, record in batch.each(pool, function, calls, out.name):
                if CANNOT in record:
                    raise Failure(record[CANNOT])
                put_json(folder / f"{name}.json", record)
                records[name] = record
        except Exception as error:
            if isinstance(error, Failure) or not scheduler:
                raise
            raise Failure(f"--scheduler {scheduler}: {type(error).__name__}: {error}".splitlines()[0]) from error
    shutil.rmtree(scratch, ignore_errors=True)
    return records
