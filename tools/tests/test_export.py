"""What went into a log comes out of each format: how many messages, and what they say."""

from __future__ import annotations

import base64
import csv
import importlib.util
import json
import math
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import lcm
import pytest
from logs import message, simulated, small_run, track, write_log
from mcap.reader import make_reader

from motehound_tools import export, messages
from motehound_tools.failure import Failure


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def topics(path: Path) -> dict[str, list[dict[str, Any]]]:
    found: dict[str, list[dict[str, Any]]] = {}
    with path.open("rb") as stream:
        for _, channel, message in make_reader(stream, validate_crcs=True).iter_messages():
            found.setdefault(channel.topic, []).append(json.loads(message.data) | {"log_time": message.log_time})
    return found


def test_csv_has_every_message_and_value(tmp_path: Path) -> None:
    told = small_run()
    tally = export.write(write_log(tmp_path / "a.lcm", told), "csv", tmp_path / "out")
    assert str(tally) == f"{len(told)} messages on 6 channels"
    for channel in ("RUN_BEGIN", "NODE", "TRUTH", "FRAME", "TRACK", "RUN_END"):
        rows = table(tmp_path / "out" / f"MOTEHOUND_{channel}.csv")
        sent = [one for name, one in told if name == channel]
        assert len(rows) == len(sent)
        for row, one in zip(rows, sent):
            assert float(row["log_time_s"]) == one.time_s
            for name in one.__slots__:
                value = getattr(one, name)
                if name == "data":
                    assert bytes.fromhex(row["data_hex"]) == value[: one.length]
                elif isinstance(value, str):
                    assert row[name] == value
                elif isinstance(value, (list, tuple)):
                    assert [float(row[f"{name}_{index}"]) for index in range(len(value))] == list(value)
                else:
                    assert float(row[export.UNITS.get(name, name)]) == value
    kinds = [row["kind"] for row in table(tmp_path / "out" / "MOTEHOUND_FRAME.csv")]
    assert kinds.count("beacon") == kinds.count("report") == 20


def test_csv_has_a_cluster_without_members(tmp_path: Path) -> None:
    clusters = [
        message("motehound.cluster_t", time_s=float(len(members)), head=7, count=len(members), members=members)
        for members in ([], [3, 5])
    ]
    export.write(write_log(tmp_path / "a.lcm", [("CLUSTER", one) for one in clusters]), "csv", tmp_path / "out")
    rows = table(tmp_path / "out" / "MOTEHOUND_CLUSTER.csv")
    assert [(row["head"], row["count"], row["members"]) for row in rows] == [("7", "0", ""), ("7", "2", "3"), ("7", "2", "5")]


def test_mcap_has_every_message_and_value(tmp_path: Path) -> None:
    told = small_run()
    export.write(write_log(tmp_path / "a.lcm", told), "mcap", tmp_path / "a.mcap")
    found = topics(tmp_path / "a.mcap")
    for channel, sent in found.items():
        assert len(sent) == sum(f"MOTEHOUND_{name}" == channel for name, _ in told)
    assert sum(map(len, found.values())) == len(told)
    frames = [message for name, message in told if name == "FRAME"]
    assert [base64.b64decode(row["data"]) for row in found["MOTEHOUND_FRAME"]] == [frame.data for frame in frames]
    assert [row["log_time"] for row in found["MOTEHOUND_FRAME"]] == [round(frame.time_s * 1e9) for frame in frames]
    assert [row["x_m"] for row in found["MOTEHOUND_TRACK"]] == [one.x_m for name, one in told if name == "TRACK"]


def test_mcap_schema_is_the_type(tmp_path: Path) -> None:
    export.write(write_log(tmp_path / "a.lcm", small_run()), "mcap", tmp_path / "a.mcap")
    with (tmp_path / "a.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    schema = {one.name: json.loads(one.data) for one in summary.schemas.values()}["motehound.frame_t"]
    assert schema["properties"]["time_s"] == {"type": "number"}
    assert schema["properties"]["sender"] == {"type": "integer"}
    assert schema["properties"]["data"] == {"type": "string", "contentEncoding": "base64"}


def test_unknown_types_are_counted_and_kept_raw_in_mcap(tmp_path: Path) -> None:
    told = [*small_run(), ("OTHER", b"12345678 of another project")]
    log = write_log(tmp_path / "a.lcm", told)
    assert export.write(log, "csv", tmp_path / "out").unknown == 1
    assert not (tmp_path / "out" / "OTHER.csv").exists()
    assert export.write(log, "mcap", tmp_path / "a.mcap").unknown == 1
    with (tmp_path / "a.mcap").open("rb") as stream:
        raw = [(c.message_encoding, m.data) for _, c, m in make_reader(stream).iter_messages(topics=["OTHER"])]
    assert raw == [("x-lcm", b"12345678 of another project")]


def test_broken_messages_are_counted_and_skipped(tmp_path: Path) -> None:
    short = ("MOTEHOUND_TRACK", track(1.0, 2.0, 3.0).encode()[:-1])
    log = write_log(tmp_path / "a.lcm", [*small_run(), short])
    log.write_bytes(log.read_bytes()[:-3])
    write_log(tmp_path / "b.lcm", [*small_run(), short, *small_run()])
    assert export.write(log, "csv", tmp_path / "out").broken == 1
    tally = export.write(tmp_path / "b.lcm", "mcap", tmp_path / "b.mcap")
    assert (tally.broken, tally.channels.total()) == (1, 2 * len(small_run()))


def test_arrays_of_variable_length_become_rows(tmp_path: Path) -> None:
    totals = {"names": ["energy_mj", "lifetime_s"], "values": [12.5, math.nan]}
    told = message("motehound.totals_t", time_s=3.0, run=2, count=2, **totals)
    log = write_log(tmp_path / "a.lcm", [("TOTALS", told)])
    export.write(log, "csv", tmp_path / "out")
    rows = table(tmp_path / "out" / "MOTEHOUND_TOTALS.csv")
    assert [(row["run"], row["names"], row["values"]) for row in rows] == [
        ("2", "energy_mj", "12.5"),
        ("2", "lifetime_s", "nan"),
    ]
    export.write(log, "mcap", tmp_path / "a.mcap")
    (found,) = topics(tmp_path / "a.mcap")["MOTEHOUND_TOTALS"]
    assert (found["names"], found["values"]) == (totals["names"], [12.5, None])


def test_not_a_number_and_a_damaged_time_are_written(tmp_path: Path) -> None:
    log = tmp_path / "a.lcm"
    stream = lcm.EventLog(str(log), "w")
    for time_us, x in ((1, math.nan), (2**62, 1.0), (-5, 1.0)):
        stream.write_event(time_us, "MOTEHOUND_TRACK", track(1.0, x, 1.0).encode())
    stream.close()
    export.write(log, "mcap", tmp_path / "a.mcap")
    export.write(log, "csv", tmp_path / "out")
    assert {row["x_m"] for row in topics(tmp_path / "a.mcap")["MOTEHOUND_TRACK"]} == {None, 1.0}
    assert [row["x_m"] for row in table(tmp_path / "out" / "MOTEHOUND_TRACK.csv")] == ["nan", "1.0", "1.0"]


def test_nothing_half_written_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log = write_log(tmp_path / "a.lcm", small_run())
    (tmp_path / "a.mcap").write_text("mine")

    def refuse(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(export, "json_value", refuse)
    with pytest.raises(Failure, match="a.mcap: cannot write: No space left on device"):
        export.write(log, "mcap", tmp_path / "a.mcap")
    assert (tmp_path / "a.mcap").read_text() == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.lcm", "a.mcap"]
    with pytest.raises(Failure, match="no folder"):
        export.write(log, "csv", tmp_path / "no" / "out")


def test_simulators_log(tmp_path: Path) -> None:
    log = simulated(tmp_path / "run", "--set", "network.nodes=200", "--set", "radio.range_m=20")
    export.write(log, "csv", tmp_path / "out")
    export.write(log, "mcap", tmp_path / "a.mcap")
    ours = table(tmp_path / "out" / "MOTEHOUND_TRACK.csv")
    its = table(tmp_path / "run" / "track.csv")
    assert len(ours) == len(its) > 10
    for name in ("time_s", "x_m", "cov_xy_m2", "vx_mps"):
        assert [float(row[name]) for row in ours] == pytest.approx([float(row[name]) for row in its], rel=1e-9)
    frames = table(tmp_path / "out" / "MOTEHOUND_FRAME.csv")
    assert len(frames) == float(table(tmp_path / "run" / "runs.csv")[0]["frames_sent"])
    assert "unknown" not in {row["kind"] for row in frames}
    read = {event.channel for event in lcm.EventLog(str(log), "r")}
    assert set(topics(tmp_path / "a.mcap")) == read == {path.stem for path in (tmp_path / "out").iterdir()}


@pytest.mark.skipif(importlib.util.find_spec("rerun") is None, reason="rerun is not installed (tools/setup rerun)")
def test_rerun_has_every_estimate(tmp_path: Path) -> None:
    export.write(write_log(tmp_path / "a.lcm", [*small_run(0), *small_run(1)]), "rerun", tmp_path / "a.rrd")
    call = [sys.executable, "-m", "rerun", "rrd"]
    subprocess.run([*call, "verify", str(tmp_path / "a.rrd")], check=True, capture_output=True)
    printed = subprocess.run(
        [*call, "print", str(tmp_path / "a.rrd")], check=True, capture_output=True, text=True
    ).stdout
    count: Counter[str] = Counter()
    for rows, branch in re.findall(r"with (\d+) rows .* - (/\S+) -", printed):
        count[branch] += int(rows)
    for run in (0, 1):
        assert [count[f"/run_{run}/{name}"] for name in ("motes", "truth_0", "track_0", "track_0/ellipse")] == [
            1,
            20,
            20,
            20,
        ]


def test_every_type_has_a_schema_and_survives_json() -> None:
    for one in messages.types().values():
        json.dumps(export.json_schema(one))
        json.dumps(export.json_value(one()), allow_nan=False)


def test_command_says_what_is_wrong_in_one_line(tmp_path: Path) -> None:
    call = [
        sys.executable,
        "-m",
        "motehound_tools",
        "export",
        str(tmp_path / "no.lcm"),
        "--to",
        "csv",
        str(tmp_path / "out"),
    ]
    done = subprocess.run(call, capture_output=True, text=True)
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr == f"motehound_tools: {tmp_path / 'no.lcm'}: cannot read: No such file or directory\n"
