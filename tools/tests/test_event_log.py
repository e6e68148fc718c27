"""Damaged logs: what is whole is read, what is not is counted."""

from __future__ import annotations

from pathlib import Path

import lcm
import numpy as np
import pytest
from logs import small_run, write_log

from motehound_tools import messages
from motehound_tools.event_log import HEADER, SYNC, EventLog
from motehound_tools.failure import Failure


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return write_log(tmp_path / "small.lcm", small_run())


def test_reads_what_lcm_reads(log: Path) -> None:
    ours = EventLog(log)
    found = [(event.channel, event.time_us, event.data) for event in ours]
    assert found == [(event.channel, event.timestamp, event.data) for event in lcm.EventLog(str(log), "r")]
    assert len(found) == len(small_run()) and ours.broken == 0 and ours.share == 1.0


def test_cut_off_anywhere_keeps_all_events_before(log: Path, tmp_path: Path) -> None:
    whole, cut = log.read_bytes(), tmp_path / "cut.lcm"
    ends = [position for position in range(1, len(whole) + 1) if whole.startswith(SYNC, position)] + [len(whole)]
    for size in np.random.default_rng(0).integers(HEADER.size, len(whole), 200):
        cut.write_bytes(whole[:size])
        ours = EventLog(cut)
        assert sum(1 for _ in ours) == sum(end <= size for end in ends)
        assert ours.broken == (0 if size in ends else 1)


@pytest.mark.parametrize("offset, bytes_", [(0, b"\0"), (20, b"\xff"), (24, b"\x7f"), (26, b"\x01"), (28, b"\xff\xfe")])
def test_a_broken_header_costs_at_most_two_events(log: Path, tmp_path: Path, offset: int, bytes_: bytes) -> None:
    whole = bytearray(log.read_bytes())
    starts = [position for position in range(len(whole)) if whole.startswith(SYNC, position)]
    begin = starts[40] + offset
    whole[begin : begin + len(bytes_)] = bytes_
    log.write_bytes(whole)
    ours = EventLog(log)
    assert len(small_run()) - 2 <= sum(1 for _ in ours) < len(small_run())
    assert 1 <= ours.broken <= 2


def test_random_damage_never_raises(log: Path, tmp_path: Path) -> None:
    random, whole, bad = np.random.default_rng(1), np.frombuffer(log.read_bytes(), np.uint8), tmp_path / "bad.lcm"
    for _ in range(100):
        damaged = whole.copy()
        places = random.integers(0, len(whole), 40)
        damaged[places] = random.integers(0, 256, len(places))
        bad.write_bytes(damaged.tobytes())
        for event in EventLog(bad):
            try:
                messages.decode(event.data)
            except messages.Broken:
                pass


@pytest.mark.parametrize("content", [b"", b"x" * 1000])
def test_what_is_no_log_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "none.lcm"
    path.write_bytes(content)
    with pytest.raises(Failure, match="expected an LCM event log"):
        EventLog(path)
    with pytest.raises(Failure, match="cannot read"):
        EventLog(tmp_path / "absent.lcm")
    with pytest.raises(Failure, match="cannot read"):
        EventLog(tmp_path)
