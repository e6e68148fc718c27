"""Many calls of the command: at the same time, with progress, stopped by the first that fails."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from . import command

Result = TypeVar("Result")

TELL_S = 15.0  # where no terminal shows a bar, a line this often


def processors() -> int:
    return len(os.sched_getaffinity(0))


@contextmanager
def progress(description: str, total: int) -> Iterator[Callable[[], None]]:
    """A bar with the time left, or lines now and then where the output is no terminal; call what it gives for each that is done."""
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
    )
    with Progress(*columns, TimeRemainingColumn(), console=console, disable=not console.is_terminal) as bar:
        shown = bar.add_task(description, total=total)
        begin = told = time.monotonic()
        done = 0

        def advance() -> None:
            nonlocal told, done
            done += 1
            bar.advance(shown)
            now = time.monotonic()
            if not console.is_terminal and (now - told >= TELL_S or done == total):
                left = timedelta(seconds=round((now - begin) / done * (total - done)))
                console.print(f"{description}: {done} of {total}, {left} left")
                told = now

        yield advance


def local(jobs: int | None) -> Executor:
    """Threads, each of which waits for one process of the command."""
    return ThreadPoolExecutor(jobs or processors())


def each(
    pool: Executor, function: Callable[..., Result], calls: dict[str, tuple[Any, ...]], description: str
) -> Iterator[tuple[str, Result]]:
    """function(*arguments) of every call, by name, in the order in which they end. An exception cancels what has not begun."""
    with progress(description, len(calls)) as advance:
        futures = {pool.submit(function, *arguments): name for name, arguments in calls.items()}
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
                advance()
        except BaseException:
            for future in futures:
                future.cancel()
            raise


def folders(program: Path, calls: dict[str, tuple[str, Path, dict[str, str]]], runs: int) -> None:
    """`motehound run` of (scenario, folder, settings) from seed 0 for every call whose folder is not complete."""
    missing = {
        name: (program, scenario, folder, runs, 0, settings)
        for name, (scenario, folder, settings) in calls.items()
        if not command.is_complete(folder, runs, 0, program)
    }
    with local(None) as pool:
        for _ in each(pool, command.run, missing, program.name):
            pass
