"""The table of faults, from made-up runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import write_output

from motehound_tools import faults, output


@pytest.mark.parametrize(("longest", "verdict"), [(10.0, "pass"), (11.0, "**miss**")])
def test_page_of_made_up_runs(tmp_path: Path, longest: float, verdict: str) -> None:
    found = output.read(write_output(tmp_path / "one", error_m=0.3))
    assert isinstance(found, output.Output)
    found.runs["overconfident_samples"] = np.full(len(found.runs["run"]), longest)
    page = faults.page(lambda fault, radio: found, 3)
    rows = [line for line in page.splitlines() if line.startswith("| a fifth of the sensors stuck")]
    assert len(rows) == 4
    assert [verdict in row for row in rows] == [True, False, True, False]


def test_every_scenario_has_a_row() -> None:
    scenarios = Path(__file__).resolve().parents[2] / "host_sim" / "scenarios"
    named = {file.stem.removeprefix("faults_") for file in scenarios.glob("faults_*.yaml")}
    assert named == {*faults.FAULTS, "soak"}
