"""An experiment: a YAML file that names a scenario, settings, a grid of keys and seeds. docs/sweeps.md is its manual.

Every mistake in the file is told with its line and key, and what was expected there."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from .failure import Failure


def as_text(value: object) -> str:
    """A setting as the command takes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)) and math.isfinite(value):
        return str(int(value)) if isinstance(value, int) else repr(float(value))
    if isinstance(value, str):
        return str(value)
    raise ValueError("expected a number, a word, true or false")


def as_seeds(value: object) -> list[int]:
    """Seeds from `20` (0 to 19), a text such as `0-19,40`, or a list of them."""
    if isinstance(value, bool):
        raise ValueError("expected how many, a text such as 0-19, or a list")
    if isinstance(value, int) and value > 0:
        return list(range(value))
    parts = value.split(",") if isinstance(value, str) else value
    if not isinstance(parts, list) or not parts:
        raise ValueError("expected how many, a text such as 0-19, or a list")
    seeds: list[int] = []
    for part in parts:
        found = re.fullmatch(r"\s*(\d+)(?:-(\d+))?\s*", str(part))
        if not found or (found[2] and int(found[2]) < int(found[1])):
            raise ValueError(f"expected seeds such as 3 or 0-19, found '{part}'")
        seeds += range(int(found[1]), int(found[2] or found[1]) + 1)
    if len(set(seeds)) != len(seeds):
        raise ValueError("expected each seed once")
    return seeds


Text = Annotated[str, BeforeValidator(as_text)]
Settings = dict[str, Text]
Axis = Annotated[list[Text], Field(min_length=1)]
Seeds = Annotated[list[int], BeforeValidator(as_seeds)]


class Part(BaseModel):
    model_config = ConfigDict(extra="forbid")


class Quantity(Part):
    """A metric as it is drawn; of curves, what curves.py knows of a run over time."""

    metric: str
    name: str = ""
    scale: float = 1.0
    pool: Literal["mean", "rms", "median", "share"] = "mean"  # over the seeds


class Drawing(Part):
    """What the report draws of a panel. Axes that are neither `x` nor `lines` are averaged over."""

    title: str = ""
    # bars: one for each series, with every y as a part of it; curves: over the time of the runs
    kind: Literal["lines", "bars", "curves"] = "lines"
    x: str = ""  # of lines; the first axis
    lines: str = ""  # an axis with a line for each of its values
    label: str = ""  # of the upright axis, or of the bars
    log: bool = False  # lines over a logarithmic axis
    y: Annotated[list[Quantity], Field(min_length=1)]
    bounds: list[Quantity] = []


class Series(Part):
    name: str
    settings: Settings = {}


class Panel(Part):
    title: str = ""
    settings: Settings = {}
    series: list[Series] = []
    grid: dict[str, Axis] = {}
    seeds: Seeds = []
    draw: list[Drawing] = []


class Experiment(Panel):
    """What a panel does not say for itself is as the experiment says; settings add up. Without panels it is one itself."""

    scenario: str
    description: str = ""
    panels: list[Panel] = []


@dataclass(frozen=True)
class Point:
    """A series of a panel at one point of the grid: what is set, and with which seeds it is run."""

    panel: str
    series: str
    settings: dict[str, str]
    seeds: list[int]


def panels(experiment: Experiment) -> list[Panel]:
    """Each with all that it takes over from the experiment; one without a title where the experiment has none."""
    usual = [
        Drawing(label="RMSE, m", y=[Quantity(metric="position_rmse_m")], kind="lines" if experiment.grid else "bars")
    ]
    return [
        panel.model_copy(
            update={
                "settings": experiment.settings | panel.settings,
                "series": panel.series or experiment.series or [Series(name="")],
                "grid": panel.grid or experiment.grid,
                "seeds": panel.seeds or experiment.seeds,
                "draw": panel.draw or experiment.draw or usual,
            }
        )
        for panel in experiment.panels or [Panel()]
    ]


def points(experiment: Experiment) -> Iterator[Point]:
    """In the order of the table: panels, series, the axes, the last one fastest."""
    for panel in panels(experiment):
        for series in panel.series:
            for values in itertools.product(*panel.grid.values()):
                settings = panel.settings | series.settings | dict(zip(panel.grid, values))
                yield Point(panel.title, series.name, settings, panel.seeds)


def has_curves(experiment: Experiment) -> bool:
    return any(drawing.kind == "curves" for panel in panels(experiment) for drawing in panel.draw)


def keys(experiment: Experiment) -> list[str]:
    """Every key that differs between rows, in the order of the file."""
    found = [*experiment.grid, *(key for series in experiment.series for key in series.settings)]
    for panel in experiment.panels:
        found += [*panel.settings, *(key for series in panel.series for key in series.settings), *panel.grid]
    return list(dict.fromkeys(found))


class Source:
    """Where in the file what was read from it stands."""

    def __init__(self, file: Path, data: Any) -> None:
        self.file, self.data = file, data

    def failure(self, path: tuple[str | int, ...], said: str) -> Failure:
        line, node = 1, self.data
        for part in path:
            try:
                line = (node.lc.key(part) if isinstance(node, dict) else node.lc.item(part))[0] + 1
                node = node[part]
            except (KeyError, IndexError, AttributeError, TypeError):
                break
        name = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path).lstrip(".")
        return Failure(f"{self.file}:{line}: {name or 'the experiment'}: {said}")


def _expectation(error: dict[str, Any]) -> str:
    if error["type"] == "missing":
        return "expected, but absent"
    if error["type"] == "extra_forbidden":
        return "no such key of an experiment"
    said = str(error["msg"])
    said = (
        said.removeprefix("Value error, ").replace("Input should be", "expected").replace("Input should", "expected to")
    )
    return said[0].lower() + said[1:]


def _check_names(experiment: Experiment, source: Source) -> None:
    """What hangs together between the parts: axes that are drawn exist, and names and titles tell the rows apart."""
    titles: list[str] = []
    for index, panel in enumerate(panels(experiment)):
        at: tuple[str | int, ...] = ("panels", index) if experiment.panels else ()
        if panel.title in titles:
            raise source.failure((*at, "title"), f"expected a title for each panel, found '{panel.title}' again")
        titles.append(panel.title)
        names = [series.name for series in panel.series]
        if len(set(names)) != len(names):
            raise source.failure((*at, "series"), "expected a name for each series, found one twice")
        if not panel.seeds:
            raise source.failure((*at, "seeds"), "expected, but absent")
        for number, drawing in enumerate(panel.draw):
            place = (*at, "draw", number)
            for key, axis in (("x", drawing.x), ("lines", drawing.lines)):
                if axis and axis not in panel.grid:
                    known = ", ".join(panel.grid) or "none"
                    raise source.failure((*place, key), f"expected an axis of the grid ({known}), found '{axis}'")
            if drawing.kind == "lines" and not panel.grid:
                raise source.failure(place, "expected a grid to draw lines over, or kind: bars")
            if drawing.kind == "curves" and panel.grid:
                raise source.failure(place, "expected no grid, because curves are drawn over time")


def _settings(experiment: Experiment) -> Iterator[tuple[tuple[str | int, ...], str, str]]:
    """(place in the file, key, value) of all that is set."""
    parts: list[tuple[tuple[str | int, ...], Panel]] = [((), experiment)]
    parts += [(("panels", i), panel) for i, panel in enumerate(experiment.panels)]
    for at, part in parts:
        for key, value in part.settings.items():
            yield (*at, "settings", key), key, value
        for i, series in enumerate(part.series):
            for key, value in series.settings.items():
                yield (*at, "series", i, "settings", key), key, value
        for key, values in part.grid.items():
            for i, value in enumerate(values):
                yield (*at, "grid", key, i), key, value


def allows(expected: str, value: str) -> bool:
    """Whether a value is what `motehound list --keys` says of its key; what is not said there the run itself checks."""
    number = re.match(r"a (whole )?number (\S+) to (\S+?)(?:;|$)", expected)
    if number:
        try:
            return float(number[2]) <= float(value) <= float(number[3]) and not (number[1] and float(value) % 1)
        except ValueError:
            return False
    words = re.match(r"one of (\S+?)(?:;|$)", expected)
    if words:
        return value in words[1].split("/")
    return value in ("true", "false") if expected.startswith("true or false") else True


def read(file: Path, known_keys: dict[str, str] | None = None, seeds: str | None = None) -> Experiment:
    """`known_keys`: of each key of the command what its values are, as it says it itself; None: not checked."""
    try:
        data = YAML().load(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise Failure(f"{file}: {error.strerror if isinstance(error, OSError) else 'not UTF-8'}") from None
    except YAMLError as error:
        mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
        line = f":{mark.line + 1}" if mark else ""
        raise Failure(f"{file}{line}: {getattr(error, 'problem', None) or error}".splitlines()[0]) from None
    source = Source(file, data)
    if not isinstance(data, dict):
        raise Failure(f"{file}:1: expected an experiment: `scenario`, `seeds`, `grid` ...")
    try:
        experiment = Experiment.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        path = tuple(part for part in first["loc"] if part != "[key]")
        raise source.failure(path, _expectation(first)) from None  # type: ignore[arg-type]
    if seeds is not None:
        try:
            experiment.seeds = as_seeds(seeds)
        except ValueError as error:
            raise Failure(f"--seeds {seeds}: {error}") from None
        for panel in experiment.panels:
            panel.seeds = []
    if known_keys is not None:
        for path, key, value in _settings(experiment):
            if key not in known_keys:
                raise source.failure(path, "no such key; `motehound list --keys` names them")
            if not allows(known_keys[key], value):
                raise source.failure(path, f"expected {known_keys[key]}; found '{value}'")
    _check_names(experiment, source)
    return experiment
