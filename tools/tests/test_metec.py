"""The page about the real leaks, from a made-up recording and a stand-in for the command."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motehound_tools import metec
from motehound_tools.failure import Failure

NODES = "node,x_m,y_m,z_m\n1,0,0,2\n2,10,0,2\n"
CANDIDATES = "place,x_m,y_m\n1,0,0\n2,30,0\n"
TRUTH = "time_s,x_m,y_m,rate_mlps\n600,1,0,100\n1200,1,0,100\n"
TRACK = "run,target,time_s,x_m,y_m,raw_x_m,raw_y_m,sd_m,true_x_m,true_y_m,rate,true_rate\n"
ROW = {"release": "7", "begin_utc": "2022-05-09T17:49", "hours": "2.00", "place": "1", "name": "Tank", "rate_mlps": "491.6"}


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    for name, text in (("nodes", NODES), ("candidates", CANDIDATES), ("truth", TRUTH), ("readings", "")):
        (tmp_path / f"{name}.csv").write_text(text)
    return tmp_path


def track(path: Path, *rows: tuple[float, float, float, float | None]) -> None:
    """time, x, rate, true rate"""
    lines = [
        f"0,0,{time},{x},0,{x},0,3,{1 if true else ''},{0 if true else ''},{rate},{true if true else ''}"
        for time, x, rate, true in rows
    ]
    (path / "track.csv").write_text(TRACK + "\n".join(lines) + "\n")


def test_the_answer_is_the_last_of_the_release(recording: Path) -> None:
    minutes = [(60.0 * i, 30.0 if i < 13 else 0.0, 25.0 if i == 20 else 7.0, 100.0) for i in range(10, 21)]
    track(recording, (540.0, 0.0, 9.0, None), *minutes, (1260.0, 30.0, 9.0, None))
    release = metec.read(ROW, recording, recording)
    assert release.right and release.ratio == 0.25
    assert release.rate_kgph == pytest.approx(1.0, rel=1e-3)
    assert release.right_share == pytest.approx(8 / 11)
    assert release.error_m == 1.0 and release.sd_m == pytest.approx(3.0 * np.sqrt(2.0))


def test_a_release_without_an_answer_is_not_right(recording: Path) -> None:
    track(recording, (540.0, 0.0, 9.0, None))
    release = metec.read(ROW, recording, recording)
    assert not release.right and np.isnan(release.ratio) and release.right_share == 0.0


def test_mixing_chosen_on_the_others() -> None:
    # the rate goes with the mixing length: right for one half at 0.2 m, for the other at 0.4 m
    right_at = np.array([0.2] * 4 + [0.4] * 4)
    of = np.array(metec.MIXING)[:, None] / right_at
    assert metec.mixing_for(of[:, :4]) == pytest.approx(0.2)
    assert metec.ratio_at(of, 0.3) == pytest.approx(0.3 / right_at, rel=0.02)
    first, second, *_ = metec.cross_checks(of)
    assert first[1:2] + first[3:] == ["0.20", "0.50"] and second[1:2] + second[3:] == ["0.40", "2.00"]


def test_page_has_no_hole(recording: Path) -> None:
    releases = [
        metec.Release(str(i), "2022-05-09 17:49", 2.0, 1 + i % 2, ("Tank", "Shed")[i % 2], 0.5 + i, 1, 0.8 + 0.1 * i, 0.9, 2.0 * i, 3.0)
        for i in range(6)
    ]
    page = metec.page(releases, releases, [["`a.b` 1", "3", "1.00"]], metec.cross_checks(np.ones((len(metec.MIXING), 6))))
    assert "**3 of 6 releases are put at the right group**" in page and "nan" not in page
    assert "| 2 | 2022-05-09 17:49 | 2.0 | Shed | 1.50 | **Tank** | 1.35 | 0.90 | 90 % |" in page
    assert "wrong by 5 m in the\nmedian of the releases and by 10 m at worst" in page
    assert metec.picture(releases, recording).startswith("<svg")


def test_an_error_of_the_command_is_one_line(recording: Path) -> None:
    program = recording / "motehound"
    program.write_text("#!/bin/sh\necho 'readings.csv:1: no' >&2\nexit 1\n")
    program.chmod(0o755)
    with pytest.raises(Failure, match="^readings.csv:1: no$"):
        metec.replay(program, recording, recording / "out")
    with pytest.raises(Failure, match="releases.csv: No such file"):
        metec.replay_all(program, recording, recording / "out")
