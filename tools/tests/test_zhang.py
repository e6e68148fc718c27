"""The page about searches for a leak, from made-up tables."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from motehound_tools import experiment, sweep_figures, zhang
from motehound_tools.command import ROOT
from motehound_tools.sweep_figures import Table, pictures

NAMES = (
    *(zhang.FOUND, zhang.WRONG, zhang.ENDED, zhang.ERROR, zhang.RATE, "hops", "sensors_used", "sensors_to_10m"),
    *("error_over_crlb", "nees_median", "crlb_m", "rate_crlb", "frames_sent", "frames_sent_hand_overs"),
    *("searches_resumed", "searches_sent_for", "tokens_refused"),
)
BY_SEED = (1.0, 2.0, 9.0)


def made_up(file: Path) -> Table:
    """Every metric is 1, 2 and 9 of the three seeds."""
    wanted = experiment.read(file, seeds="0-2")
    rows = [(point, seed) for point in experiment.points(wanted) for seed in point.seeds]
    columns: dict[str, list[float | str | None]] = {
        "panel": [point.panel for point, _ in rows],
        "series": [point.series for point, _ in rows],
        "seed": [seed for _, seed in rows],
    }
    for key in experiment.keys(wanted):
        found = [point.settings.get(key) for point, _ in rows]
        columns[key] = [float(text) if text and text.replace(".", "").isdigit() else text for text in found]
    for name in NAMES:
        columns[name] = [BY_SEED[seed] for _, seed in rows]
    over: dict[str, list[object]] = {name: [] for name in ("panel", "series", "seed", "curve", "time_s", "value")}
    return Table(file.parent, wanted, "test", columns, over)


@pytest.fixture(scope="module")
def tables() -> dict[str, Table]:
    return {file.stem: made_up(file) for file in (ROOT / "experiments").glob("zhang_*.yaml")}


def test_every_figure_is_found_and_pooled(tables: dict[str, Table]) -> None:
    figures = zhang.Searches(tables)
    for row in zhang.required():
        assert np.isfinite(row.value(figures)), row.what  # type: ignore[arg-type]
    drawn = {name: pictures(table) for name, table in tables.items()}
    for name, (of, which) in zhang.IMAGES.items():
        assert len(drawn[of]) > which, name
    ended, found, error, rate, heads, sensors, over_bound, nees, to_10m = figures.of_search(zhang.GOOD, zhang.UKF)
    assert (ended, found, heads, sensors) == (4.0, 4.0, 4.0, 4.0)
    assert (error, rate, nees, to_10m) == (2.0, 2.0, 2.0, 2.0)
    assert over_bound == pytest.approx(np.sqrt(86.0 / 3.0))
    assert drawn["zhang_fig6"][0].numbers[0][1] == "2"  # a median, without a spread


def test_page_has_no_hole(tables: dict[str, Table]) -> None:
    page = zhang.page(tables)
    lines = [line for line in page.splitlines() if line.startswith("|")]
    assert len(lines) > 55 and not re.search(r"\bnan\b", page)
    assert any("good sensors, UKF: success | 4.000 | ≥ 0.95 | pass" in line for line in lines)
    assert any("good sensors, UKF: heads | 4.000 | 6.6 to 7.4 | **miss**" in line for line in lines)


def test_a_median_is_no_mean() -> None:
    middle, spread = sweep_figures.summarised([np.array([1.0, 2.0, 9.0])], "median")
    assert middle[0] == 2.0 and np.isnan(spread[0])
    assert sweep_figures.summarised([np.array([1.0, 2.0, 9.0])], "mean")[0][0] == 4.0
