"""The command run once for each value of a key, each into its own folder; complete folders are left as they are."""

from __future__ import annotations

import json
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from . import command
from .failure import Failure


def is_complete(folder: Path, runs: int, seed: int, program: Path) -> bool:
    """Whether as many runs from this seed are there, whole as all files of the command, and younger than it."""
    try:
        if (folder / "summary.json").stat().st_mtime < program.stat().st_mtime:
            return False
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(summary, dict) and summary.get("runs") == runs and summary.get("seed") == seed


def progress(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
    )


def run(
    program: Path, scenario: str, key: str, values: list[str], runs: int, seed: int, out: Path, settings: dict[str, str]
) -> None:
    recipe = {"scenario": scenario, "key": key, "runs": runs, "seed": seed, "set": settings}
    out.mkdir(parents=True, exist_ok=True)
    note = out / "sweep.json"
    if note.exists() and json.loads(note.read_text(encoding="utf-8")) != recipe:
        raise Failure(f"{out}: holds a sweep with other settings; choose another folder")
    note.write_text(json.dumps(recipe, indent=2) + "\n", encoding="utf-8")
    console = Console(stderr=True)
    with progress(console) as bar:
        task = bar.add_task(key, total=len(values))
        for value in values:
            folder = out / f"{key}={value}"
            bar.update(task, description=folder.name)
            if not is_complete(folder, runs, seed, program):
                command.run(program, scenario, folder, runs, seed, {**settings, key: value})
            bar.advance(task)
