"""The page about targets that are heard, from made-up tables."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from motehound_tools import experiment, han
from motehound_tools.command import ROOT
from motehound_tools.sweep_figures import Table, pictures

NAMES = (
    *(han.FIX, han.GROUP, han.LOST, han.SUCCESS, han.GAP, han.MESSAGES, han.ALL, han.SWAPS),
    *("rmse_over_crlb", "fix_crlb_m", "double_heads", "unresolved", "swaps_claimed", "extent_bias_m"),
    *("spurious_splits_per_min", "count_right", "merge_delay_s", "split_delay_s", "apart_at_end", "mode_changes_per_min"),
)


def made_up(file: Path) -> Table:
    """Every metric is 1 and 3 of the two seeds."""
    wanted = experiment.read(file, seeds="0-1")
    rows = [(point, seed) for point in experiment.points(wanted) for seed in point.seeds]
    columns: dict[str, list[float | str | None]] = {
        "panel": [point.panel for point, _ in rows],
        "series": [point.series for point, _ in rows],
        "seed": [seed for _, seed in rows],
    }
    for key in experiment.keys(wanted):
        found = [point.settings.get(key) for point, _ in rows]
        columns[key] = [float(text) if text and re.fullmatch(r"[\d.]+", text) else text for text in found]
    for name in NAMES:
        columns[name] = [(1.0, 3.0)[seed] for _, seed in rows]
    return Table(file.parent, wanted, "test", columns)


@pytest.fixture(scope="module")
def tables() -> dict[str, Table]:
    return {file.stem: made_up(file) for file in (ROOT / "experiments").glob("han_*.yaml")}


def test_every_figure_is_found(tables: dict[str, Table]) -> None:
    figures = han.Targets(tables)
    for row in han.required():
        expected = 0.0 if "saves" in row.what else 2.0
        assert row.value(figures) == pytest.approx(expected), row.what  # type: ignore[arg-type]
    drawn = {name: pictures(table) for name, table in tables.items()}
    for name, (of, which) in han.IMAGES.items():
        assert len(drawn[of]) > which, name
    assert han.draw_energy(figures, han.MESSAGES, with_formulas=True).startswith("<svg")


def test_page_has_no_hole(tables: dict[str, Table]) -> None:
    page = han.page(tables)
    lines = [line for line in page.splitlines() if line.startswith("|")]
    assert len(lines) > 70 and not re.search(r"\bnan\b", page)
    assert any("prince: messages a fix | 2.000 | 3.25 to 3.75 | **miss**" in line for line in lines)
    assert any("two 20 m apart, joint fit: success | 2.000 | ≥ 0.75 | pass" in line for line in lines)
    assert any(line.startswith("| 0.999 | 2.00 (3.00; 3.55) | 2.00 (6.00; 6.40) | 2.00 (5.00; 4.91) |") for line in lines)


def test_formulas_are_those_of_the_thesis() -> None:
    at_one = [han.FORMULAS[series](1.0) for series in (han.PRINCE, han.COMPETITION, han.TIMESTAMP)]
    at_zero = [han.FORMULAS[series](0.0) for series in (han.PRINCE, han.COMPETITION, han.TIMESTAMP)]
    assert at_one == [3.0, 6.0, 5.0] and at_zero == [4.0, 4.0, 4.0]
