"""The page about fixed clusters, from made-up tables; curves over time, from a run of the simulator."""

from __future__ import annotations

import csv
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from logs import program

from motehound_tools import curves, experiment, sweep, xu
from motehound_tools.command import ROOT
from motehound_tools.failure import Failure
from motehound_tools.sweep_figures import Table, pictures

NAMES = (
    *(xu.RMSE, xu.ANEES, xu.CLAIMED, xu.PCRB, "ccrb_m", "frames_sent", "summaries", "summaries_taken"),
    *(f"{name}_{c}" for c in range(1, 5) for name in ("local_position_rmse_m", "local_anees", "local_ccrb_m")),
)
CURVES = ("error_m", "pcrb_m", "ccrb_m", *(f"local_error_m_{c}" for c in range(1, 5)))


def made_up(file: Path, value: float) -> Table:
    """Every metric is `value`, of seed 1 seven times that; curves likewise, at 1, 2 ... 100 s."""
    wanted = experiment.read(file, seeds="0-1")
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
        columns[name] = [value * (7.0 if seed else 1.0) for _, seed in rows]
    over: dict[str, list[object]] = {name: [] for name in ("panel", "series", "seed", "curve", "time_s", "value")}
    for point, seed in rows if experiment.has_curves(wanted) else []:
        for curve in CURVES:
            for second in range(1, 101):
                row = (point.panel, point.series, seed, curve, float(second), value * (7.0 if seed else 1.0))
                for name, cell in zip(over, row):
                    over[name].append(cell)
    return Table(file.parent, wanted, "test", columns, over)


@pytest.fixture(scope="module")
def tables() -> dict[str, Table]:
    return {file.stem: made_up(file, 0.01) for file in (ROOT / "experiments").glob("xu_*.yaml")}


def test_every_figure_is_found_and_pooled(tables: dict[str, Table]) -> None:
    figures = xu.Pooled(tables)
    for row in xu.required():
        assert np.isfinite(row.value(figures)), row.what
    drawn = {name: pictures(table) for name, table in tables.items()}
    for name, (of, which) in xu.IMAGES.items():
        assert len(drawn[of]) > which, name
    assert figures.rms("xu_fig7", "", xu.CI) == pytest.approx(0.05)  # of 0.01 and 0.07
    assert figures.mean("xu_fig7", "", xu.CI, xu.ANEES) == pytest.approx(0.04)
    assert figures.smse("xu_fig7", "", xu.CI) == pytest.approx(5.0)
    fused = drawn["xu_fig4"][0]
    assert fused.head[:2] == ["time, s", "fused"] and fused.numbers[0][1] == "0.05"


def test_page_has_no_hole(tables: dict[str, Table]) -> None:
    page = xu.page(tables)
    lines = [line for line in page.splitlines() if line.startswith("|")]
    assert len(lines) > 60 and not re.search(r"\bnan\b", page)
    assert any("CI: RMSE after 10 s, m | 0.05000 | 0.052 to 0.057 | **miss**" in line for line in lines)
    assert any("split CI: RMSE, m | 0.05000 | ≤ 0.052 | pass" in line for line in lines)


def test_curves_of_a_run(tmp_path: Path) -> None:
    out = tmp_path / "out"
    subprocess.run([str(program()), "run", "xu_nominal", "--out", str(out)], check=True, stdout=subprocess.DEVNULL)
    found = {name: np.array(pairs) for name, pairs in curves.of(out).items()}
    with (out / "runs.csv").open(newline="", encoding="utf-8") as stream:
        (told,) = csv.DictReader(stream)

    def rms(name: str) -> float:
        late = found[name][found[name][:, 0] > 10.0, 1]
        return float(np.sqrt(np.mean(late**2)))

    assert set(found) == set(CURVES) and all(len(pairs) == 100 for pairs in found.values())
    assert rms("error_m") == pytest.approx(float(told["position_rmse_m"]), rel=1e-6)
    assert float(np.sum(found["error_m"][:, 1])) == pytest.approx(float(told["smse_m"]), rel=1e-6)
    assert rms("local_error_m_3") == pytest.approx(float(told["local_position_rmse_m_3"]), rel=1e-6)
    # computed a second time here, the posterior bound over other paths
    assert rms("ccrb_m") == pytest.approx(float(told["ccrb_m"]), rel=1e-4)
    assert rms("pcrb_m") == pytest.approx(float(told["pcrb_m"]), rel=2e-3)


@pytest.mark.sweep
def test_sweep_over_time(tmp_path: Path) -> None:
    file = tmp_path / "small.yaml"
    drawing = "draw: [{kind: curves, y: [{metric: error_m}], bounds: [{metric: pcrb_m, name: bound}]}]\n"
    file.write_text("scenario: xu_nominal\nseeds: 0-2\n")
    out = sweep.run(file, tmp_path / "out", named_program=str(program()))
    assert not (out / "curves.parquet").exists() and not Table.read(out).curves
    file.write_text("scenario: xu_nominal\nseeds: 0-2\n" + drawing)
    out = sweep.run(file, tmp_path / "out", named_program=str(program()))  # the records have no curves yet
    (drawn,) = pictures(Table.read(out))
    assert drawn.head == ["time, s", "error_m", "bound"] and "3 seeds" in drawn.picture.caption
    file.write_text("scenario: xu_nominal\nseeds: 0-2\ngrid: {fusion.report_s: [1, 2]}\n" + drawing)
    with pytest.raises(Failure, match="small.yaml:4: draw\\[0\\]: expected no grid"):
        experiment.read(file)
