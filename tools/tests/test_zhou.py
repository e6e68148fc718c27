"""The page about the ranged target, from made-up tables."""

from __future__ import annotations

from pathlib import Path

import pytest

from motehound_tools import experiment, zhou
from motehound_tools.command import ROOT
from motehound_tools.sweep_figures import Table, pictures


def made_up(file: Path, value: float) -> Table:
    """Every metric is `value`, for PFTL half of that."""
    wanted = experiment.read(file, seeds="0-1")
    points = list(experiment.points(wanted))
    rows = [(point, seed) for point in points for seed in point.seeds]
    columns: dict[str, list[float | str | None]] = {
        "panel": [point.panel for point, _ in rows],
        "series": [point.series for point, _ in rows],
        "seed": [seed for _, seed in rows],
    }
    for key in experiment.keys(wanted):
        found = [point.settings.get(key) for point, _ in rows]
        columns[key] = [float(text) if text and text.replace(".", "").isdigit() else text for text in found]
    names = ("localisation_error_rs", "sink_error_rs", "reports_per_sample", "rmse_over_pcrb", "pcrb_m", "clusters")
    energies = ["energy_mj_per_sample", *(f"energy_mj_per_sample_{cause}" for cause in zhou.CAUSES)]
    for name in (*names, *energies, "clusters_least", "longest_gap_s", "recoveries", "energy_mj_hottest"):
        columns[name] = [value / 2.0 if point.series == "PFTL" else value for point, _ in rows]
    return Table(file.parent, wanted, "test", columns)


@pytest.fixture(scope="module")
def tables() -> dict[str, Table]:
    return {file.stem: made_up(file, 0.05) for file in (ROOT / "experiments").glob("zhou_*.yaml")}


def test_every_figure_is_found(tables: dict[str, Table]) -> None:
    figures = zhou.Figures(tables)
    for row in (*zhou.reproduced(), *zhou.default()):
        assert len(figures.of(*row.place, row.metric, **row.at)) == 2, row.what
    for name, (of, which) in zhou.IMAGES.items():
        assert len(pictures(tables[of])) > which, name


def test_page_has_no_hole(tables: dict[str, Table]) -> None:
    page = zhou.page(tables)
    lines = [line for line in page.splitlines() if line.startswith("|")]
    assert len(lines) > 100 and "nan" not in page and "–" not in "".join(lines)
    # everything is 0.05: at most 0.05 holds, 0.0540 does not
    assert any("SACX, 10 mph: localised | 0.05000 ± 0 | ≤ 0.056 | pass" in line for line in lines)
    assert any("PFTL, 4 mph: localised | 0.02500 ± 0 | 0.054 ± 4 % | **miss**" in line for line in lines)
    assert any("at 4 mph PFTL is nearly 50 %" in line and "at the sink 50 and 50 %" in line for line in lines)
    assert any("without 10 s" in line and "| 2 of 2 | all | pass" in line for line in lines)


def test_verdicts(tables: dict[str, Table]) -> None:
    place = ("zhou_fig8", "(c) clusters", "SAC")
    at = {"target__speed_mph": 10}
    figures = zhou.Figures(tables)
    assert zhou.Wanted("", place, "clusters", 0.052, 0.05, at).row(figures)[-1] == "pass"
    assert zhou.Wanted("", place, "clusters", 0.056, 0.05, at).row(figures)[-1] == "**miss**"
    assert zhou.Wanted("", place, "clusters", 0.049, None, at).row(figures)[-1] == "**miss**"
    assert zhou.Wanted("", place, "clusters", 0.05, None, at, 2.0).row(figures)[1:] == ["0.1000 ± 0", "≤ 0.05", "**miss**"]
