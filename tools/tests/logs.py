"""Small LCM logs with known contents, and one of the simulator."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

import lcm
import pytest

from motehound_tools import command, messages
from motehound_tools.failure import Failure

BEACON = "mh.beacon_t"


def message(name: str, **fields: Any) -> Any:
    made = messages.named(name)()
    for field, value in fields.items():
        assert hasattr(made, field), field
        setattr(made, field, value)
    return made


def frame(time_s: float, sender: int, destination: int = -1, kind: str = BEACON, run: int = 0) -> Any:
    inner = message(kind).encode() + b"\x12\x34"  # a check sum, which nobody here reads
    data = inner.ljust(127, b"\0")
    return message(
        "motehound.frame_t",
        time_s=time_s,
        run=run,
        sender=sender,
        destination=destination,
        length=len(inner),
        data=data,
    )


def track(time_s: float, x: float, y: float, run: int = 0, **more: Any) -> Any:
    known = {"true_known": True, "true_x_m": x + 3.0, "true_y_m": y - 4.0}
    cov = {"cov_xx_m2": 4.0, "cov_xy_m2": 0.0, "cov_yy_m2": 1.0, "states": 2}
    return message("motehound.track_t", time_s=time_s, run=run, x_m=x, y_m=y, **(known | cov | more))


def small_run(run: int = 0, nodes: int = 9, seconds: int = 20, seed: int = 0) -> list[tuple[str, Any]]:
    """A square of motes, one beacon and one report a second, a track along the diagonal."""
    side = round(nodes**0.5)
    found: list[tuple[str, Any]] = [
        ("RUN_BEGIN", message("motehound.run_begin_t", run=run, seed=seed, scenario="small", version="test"))
    ]
    for node in range(nodes):
        place = {"x_m": 10.0 * (node % side), "y_m": 10.0 * (node // side)}
        found.append(("NODE", message("motehound.node_t", run=run, node=node, **place)))
    for second in range(seconds):
        time = float(second)
        place = {"x_m": time + 3.0, "y_m": time - 4.0}
        found.append(("TRUTH", message("motehound.truth_t", time_s=time, run=run, present=True, **place)))
        found.append(("FRAME", frame(time + 0.25, second % nodes, run=run)))
        found.append(("FRAME", frame(time + 0.5, 1 + second % (nodes - 1), 0, "mh.report_t", run=run)))
        found.append(("TRACK", track(time, time, time, run=run)))
    found.append(("RUN_END", message("motehound.run_end_t", time_s=float(seconds), run=run, frames_received=7)))
    return found


def clustered_run() -> list[tuple[str, Any]]:
    """The same, followed by two clusters: mote 4 asks 1 and 3 from the start, 8 asks 5 and 7 from 10 s on."""
    found = small_run()
    for second in range(2, 20):
        found.append(("SINK", track(float(second), second - 1.0, second - 1.0, head=-1)))
    for time, head, members in ((0.0, 4, [1, 3]), (10.0, 8, [5, 7])):
        found.append(
            ("CLUSTER", message("motehound.cluster_t", time_s=time, head=head, is_new=True, count=2, members=members))
        )
    begin, rest = found[:10], found[10:]
    return begin + sorted(rest, key=lambda told: told[1].time_s)


SIDE, SPACING_M = 12, 20.0  # of the motes of targets_run


def at(target: int, time_s: float) -> tuple[float, float]:
    """Three targets from left to right at 10 m/s: the lower two come together until 12 s and part again."""
    apart = max(8.0, abs(time_s - 12.0) * 5.0) if target < 2 else 60.0
    return 10.0 * time_s, 60.0 + (-apart, apart, apart + 20.0)[target] / (2.0 if target < 2 else 1.0)


def nearest(x: float, y: float) -> int:
    return SIDE * min(SIDE - 1, max(0, round(y / SPACING_M))) + min(SIDE - 1, max(0, round(x / SPACING_M)))


def targets_run(seconds: int = 22) -> list[tuple[str, Any]]:
    """Targets 16, 33 and 50; the first two are the group 16 from 10 s to 14 s. Every 2 s each has a new head, whose prince is the next."""
    found: list[tuple[str, Any]] = [("RUN_BEGIN", message("motehound.run_begin_t", seed=4, scenario="three", version="test"))]
    for node in range(SIDE * SIDE):
        place = {"x_m": SPACING_M * (node % SIDE), "y_m": SPACING_M * (node // SIDE)}
        found.append(("NODE", message("motehound.node_t", node=node, **place)))
    for second in range(seconds):
        time = float(second)
        for target in range(3):
            x, y = at(target, time)
            place = {"x_m": x, "y_m": y, "vx_mps": 10.0}
            found.append(("TRUTH", message("motehound.truth_t", time_s=time, target=target, present=True, **place)))
        if second % 2 or second == 0:
            continue
        together = 10 <= second <= 14
        for identifier, number in ((16, 0), (33, 1), (50, 2)):
            if identifier == 33 and together:
                continue
            x, y = at(number, time)
            group: dict[str, Any] = {"mode": 0 if number == 2 else 1, "members": 1, "number": number}
            if identifier == 16 and together:
                x, y = x, 60.0
                group = {"mode": 2, "members": 2, "number": -1, "of": [16, 33, 0, 0], "extent_m": 6.0}
            flags = 512 if second > 14 and number < 2 else 0
            head = nearest(x, y)
            prince = -1 if second == 6 else nearest(x + 20.0, y)
            known = {"target": identifier, "head": head}
            watch = {"x_m": x - 1.0, "y_m": y + 1.0, "vx_mps": 10.0, "sd_m": 2.0, "prince": prince, "prince_s": time + 1.5}
            watch |= {name: value for name, value in group.items() if name in ("number", "members", "extent_m")}
            found.append(("FRAME", frame(time, head)))
            found.append(("TRACK", track(time, x - 1.0, y + 1.0, flags=flags, true_x_m=x, true_y_m=y, **known, **group)))
            found.append(("WATCH", message("motehound.watch_t", time_s=time, **known, **watch)))
    found.append(("RUN_END", message("motehound.run_end_t", time_s=float(seconds))))
    return found


def write_log(path: Path, told: list[tuple[str, Any]]) -> Path:
    log = lcm.EventLog(str(path), "w", overwrite=True)
    last = 0
    for channel, one in told:
        if isinstance(one, bytes):
            log.write_event(last, channel, one)
            continue
        last = round(one.time_s * 1e6)
        log.write_event(last, f"MOTEHOUND_{channel}", one.encode())
    log.close()
    return path


def program() -> Path:
    try:
        return command.find(os.environ.get("MOTEHOUND"))
    except Failure as failure:
        pytest.skip(str(failure))


def simulated(folder: Path, *settings: str, runs: int = 1) -> Path:
    """The log of luo_exp1."""
    call = [str(program()), "run", "luo_exp1", "--log", "--out", str(folder), "--runs", str(runs)]
    subprocess.run([*call, *settings], check=True, stdout=subprocess.DEVNULL)
    return folder / "events.lcm"
