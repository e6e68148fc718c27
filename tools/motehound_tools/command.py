"""The command `motehound`: where it is and how a run of it is started."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

from .failure import Failure

ROOT = Path(__file__).resolve().parents[2]


def find(named: str | None) -> Path:
    """The program that was named, or $MOTEHOUND, or this checkout's build, or the first on the PATH."""
    for wanted in (named, os.environ.get("MOTEHOUND")):
        if wanted:
            path = shutil.which(wanted)
            if path is None:
                raise Failure(f"{wanted}: no such program")
            return Path(path)
    # The builds of tools/demo and of the developer, then those with another compiler or sanitizers.
    for pattern in ("build/run/motehound", "build/host/motehound"), ("build/host*/motehound",):
        built = [path for one in pattern for path in ROOT.glob(one) if path.is_file() and os.access(path, os.X_OK)]
        if built:
            return max(built, key=lambda path: path.stat().st_mtime)
    installed = shutil.which("motehound")
    if installed:
        return Path(installed)
    raise Failure("motehound: not found in build/run, build/host or on the PATH; build it or name it with --motehound")


def run(
    program: Path, scenario: str, out: Path, runs: int, seed: int, settings: dict[str, str], jobs: int | None = None
) -> None:
    """One `motehound run` into `out`."""
    call = [str(program), "run", scenario, "--runs", str(runs), "--seed", str(seed), "--out", str(out)]
    if jobs:
        call += ["--jobs", str(jobs)]
    for key, value in settings.items():
        call += ["--set", f"{key}={value}"]
    out.parent.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        raise Failure(lines[-1] if lines else f"{program}: exit status {done.returncode}")


def is_complete(folder: Path, runs: int, seed: int, program: Path) -> bool:
    """Whether as many runs from this seed are there, whole as all files of the command, and younger than it."""
    try:
        if (folder / "summary.json").stat().st_mtime < program.stat().st_mtime:
            return False
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(summary, dict) and summary.get("runs") == runs and summary.get("seed") == seed


def listed(program: Path, what: str) -> list[str]:
    """The lines of `motehound list`."""
    try:
        told = subprocess.run([str(program), "list", what], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise Failure(f"{program}: {error}") from None
    return told.stdout.splitlines()


def keys(program: Path) -> dict[str, str]:
    """Of every key of a scenario what its values are, as the program words it."""
    return {line.split(None, 2)[0]: line.split(None, 2)[2] for line in listed(program, "--keys")}


def metrics(program: Path) -> set[str]:
    return {line.split()[0] for line in listed(program, "--metrics")}
