"""The page of results, from made-up runs; and the command's own figures, checked against its track."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from conftest import write_output

from motehound_tools import command, luo, metrics, output, results
from motehound_tools.failure import Failure


def test_every_case_has_its_own_folder() -> None:
    every = luo.cases()
    assert len({case.folder for case in every}) == len(every)
    assert {case.path for case in every} == {"E1", "E2"}


def test_verdicts() -> None:
    case = luo.Case("E1", "luo")
    about = luo.near("", case, "position_rmse_m", 3.5, 0.1)
    assert about.holds(3.84) and about.holds(3.16) and not about.holds(3.86) and not about.holds(3.14)
    assert luo.at_most("", case, "position_rmse_m", 0.4).holds(0.4)
    assert not luo.at_most("", case, "position_rmse_m", 0.4).holds(float("nan"))


def test_page_of_made_up_runs(tmp_path: Path) -> None:
    found = output.read(write_output(tmp_path / "one", error_m=0.3))
    assert isinstance(found, output.Output)
    limit = {
        "none": {"rms_m": 0.7, "median_m": 0.1},
        "0.5": {"rms_m": 0.1765, "median_m": 0.1},
        "0.05": {"rms_m": 0.05, "median_m": 0.05},
    }
    bounds = {results.bounded(luo.Case("E1", "diffusion", luo.LOW)): limit}
    page = results.page(lambda case: found, bounds, 3, 1)
    tables = [line for line in page.splitlines() if line.startswith("|")]
    for line in tables:
        assert line.count("|") in {5, 6, 9, 13}  # no cell is missing
    assert any("E1 | 1 % + 0.02" in line and "0.176" in line for line in tables)
    assert sum("**miss**" in line for line in tables) > 0  # the made-up errors are not those of the paper's method


@pytest.fixture(scope="module", params=["diffusion", "luo"])
def simulated(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> output.Output:
    try:
        program = command.find(os.environ.get("MOTEHOUND"))
    except Failure as failure:
        pytest.skip(str(failure))
    folder = tmp_path_factory.mktemp("simulated") / "out"
    settings = {**luo.LOW, "source.speed_mps": "2", "network.nodes": "640", "tracker.name": request.param}
    command.run(program, "luo_exp1", folder, 3, 7, settings)
    found = output.read(folder)
    assert isinstance(found, output.Output)
    return found


@pytest.mark.parametrize("run", [0, 1, 2])
def test_recorder_agrees_with_its_track(simulated: output.Output, run: int) -> None:
    again = metrics.recompute(simulated, run)
    assert {"position_rmse_m", "raw_position_rmse_m", "position_rmse_at_arrival_m"} <= set(again)
    row = simulated.runs["run"] == run
    for name, value in again.items():
        assert simulated.runs[name][row][0] == pytest.approx(value, rel=1e-4, abs=1e-5), name


def test_true_positions_are_the_route(simulated: output.Output) -> None:
    assert simulated.scenario is not None
    track = simulated.track
    there = simulated.scenario.route.position(track["time_s"])
    assert track["true_x_m"] == pytest.approx(there[:, 0], abs=1e-3)
    assert track["true_y_m"] == pytest.approx(there[:, 1], abs=1e-3)


def test_nodes_are_the_published_deployment(simulated: output.Output) -> None:
    assert simulated.scenario is not None and simulated.nodes is not None
    assert simulated.nodes[:640] == pytest.approx(simulated.scenario.nodes(7), abs=1e-3)  # behind them the sink
