"""What a recording keeps of the messages, and what of it is seen at a time."""

from __future__ import annotations

import math
import time
from pathlib import Path

import numpy as np
import pytest
from logs import clustered_run, frame, message, small_run, targets_run, track, write_log

from motehound_tools import recording
from motehound_tools.event_log import EventLog
from motehound_tools.recording import Recording, Table
from motehound_tools.view import scene, targets
from motehound_tools.view.colours import CLUSTER, TARGETS, TRACK, TRUTH


def taken(told: list) -> Recording:
    found = Recording("test")
    for _, one in told:
        found.take(one if isinstance(one, bytes) else one.encode())
    return found


def mote(time_s: float, node: int, energy: float, alive: bool = True, clock_error: float = math.nan) -> tuple:
    values = {"energy_mj": energy, "battery_left": 1.0 - energy / 100.0, "alive": alive, "clock_error_ms": clock_error}
    return "MOTE", message("motehound.mote_t", time_s=time_s, node=node, **values)


def test_table_is_in_order_of_time_whatever_the_order_of_arrival() -> None:
    random, table = np.random.default_rng(0), Table([("value", "f8")])
    times = random.permutation(500) / 10.0
    for count, one in enumerate(times):
        table.append((one, 2.0 * one))
        early = table.snapshot()
        assert len(early) == count + 1
    assert (table.snapshot()["time"] == np.sort(times)).all() and (early["value"] == 2.0 * early["time"]).all()
    assert len(table.until(10.0)) == 101
    assert table.between(10.0, 10.5)["time"] == pytest.approx([10.1, 10.2, 10.3, 10.4, 10.5])
    table.append((0.05, 0.0))
    assert len(early) == 500 and table.snapshot()["time"][1] == 0.05


def test_recording_of_a_small_run() -> None:
    found = taken(small_run())
    run = found.runs[0]
    assert (run.scenario, run.end_s, run.over, len(run.places)) == ("small", 20.0, True, 9)
    assert (len(run.frames), len(run.truth), len(run.track)) == (40, 20, 20)
    assert set(found.kinds) == {"beacon", "report"}
    assert run.track.snapshot()["error"] == pytest.approx(np.full(20, 5.0))
    assert (found.broken, found.unknown) == (0, 0)


def test_what_no_sender_writes_is_counted() -> None:
    odd = [("TRACK", track(value, 1.0, 1.0)) for value in (math.nan, -1.0, 1e300)]
    short = ("TRACK", track(1.0, 1.0, 1.0).encode()[:-1])
    foreign = ("OTHER", b"12345678901234567890")
    found = taken([*small_run(), *odd, short, foreign, ("HELLO", b"")])
    assert (found.broken, found.unknown) == (4, 1)
    assert found.runs[0].end_s == 20.0


def test_another_simulation_with_the_same_run_takes_its_place() -> None:
    found = taken([*small_run(seed=1), *small_run(seed=2, seconds=5)])
    assert (found.runs[0].seed, found.runs[0].end_s, len(found.runs[0].frames)) == (2, 5.0, 10)


def test_log_is_read_beside(tmp_path: Path) -> None:
    path = write_log(tmp_path / "a.lcm", [*small_run(0), *small_run(1)])
    path.write_bytes(path.read_bytes()[:-5])
    found = recording.of_log(path)
    for _ in range(200):
        if found.share >= 1.0 and found.broken:
            break
        time.sleep(0.01)
    assert (found.share, found.broken, sorted(found.runs)) == (1.0, 1, [0, 1])
    assert sum(1 for _ in EventLog(path)) == 2 * len(small_run()) - 1
    assert found.runs[0].over and not found.runs[1].over


def test_motes_know_the_past_in_both_directions() -> None:
    told = [*small_run(), mote(5.0, 3, 10.0), mote(5.0, 4, 20.0), mote(15.0, 3, 30.0, alive=False, clock_error=0.5)]
    found = taken(sorted(told, key=lambda one: one[1].time_s))
    motes = scene.Motes(found.runs[0])
    assert motes.spacing == 10.0
    motes.move(20.0)
    assert motes.sent.sum() == 40 and motes.sent_of_kind[found.kinds["beacon"]] == 20
    assert (motes.energy[3], motes.energy[4], motes.alive[3], motes.alive[4]) == (30.0, 20.0, False, True)
    assert motes.clock_error[3] == 0.5 and math.isnan(motes.clock_error[4])
    motes.move(6.0)
    assert (motes.energy[3], motes.alive[3], motes.frames_seen) == (10.0, True, 12)
    for moment in np.linspace(6.0, 20.0, 57):
        motes.move(moment)
    anew = scene.Motes(found.runs[0])
    anew.move(20.0)
    assert (anew.sent == motes.sent).all() and np.array_equal(anew.energy, motes.energy, equal_nan=True)


def test_frames_in_the_air_go_from_their_sender_to_who_they_are_for() -> None:
    told = [one for one in small_run() if one[0] != "FRAME"]
    told += [("FRAME", frame(10.0, 0, 8, "mh.report_t")), ("FRAME", frame(10.2, 4)), ("FRAME", frame(10.2, 99, 0))]
    run = taken(told).runs[0]
    colours = np.array(["#111111", "#222222"])
    seen = scene.frames_in_air(run, scene.Motes(run), 10.2, 0.4, colours)
    assert [seen["arcs"][name].tolist() for name in ("x0", "y0", "x1", "y1")] == [[0.0], [0.0], [20.0], [20.0]]
    assert (seen["rings"]["x"].tolist(), seen["rings"]["y"].tolist()) == ([10.0], [10.0])
    assert (seen["arcs"]["color"].tolist(), seen["rings"]["color"].tolist()) == (["#111111"], ["#222222"])
    along = [
        scene.frames_in_air(run, scene.Motes(run), 10.0 + age, 0.4, colours)["pulses"]["x"] for age in (0.0, 0.1, 0.3)
    ]
    assert along[0] == 0.0 < along[1] < along[2] == pytest.approx(20.0)
    assert len(scene.frames_in_air(run, scene.Motes(run), 10.41, 0.4, colours)["arcs"]["x0"]) == 0


def test_track_and_truth_at_a_time() -> None:
    run = taken(small_run()).runs[0]
    found = targets.tracks(run, 7.5)
    assert (found["heads"]["x"], found["heads"]["y"]) == ([7.0], [7.0]) and len(found["paths"]["xs"][0]) == 8
    assert (found["heads"]["color"], found["heads"]["label"]) == ([TRACK], [""]) and not found["extents"]["x"]
    x, y = found["ellipses"]["xs"][0] - 7.0, found["ellipses"]["ys"][0] - 7.0
    assert (x / 4.0) ** 2 + (y / 2.0) ** 2 == pytest.approx(np.ones_like(x))  # two standard deviations of 2 and 1 m
    found = targets.truths(run, 7.5)
    assert (found["here"]["x"], found["here"]["y"]) == ([10.5], [3.5]) and len(found["truth"]["xs"][0]) == 9
    assert found["truth"]["color"] == [TRUTH]
    assert targets.tracks(run, 19.0 + 6.0)["heads"]["x"] == []  # long past the last estimate
    assert targets.truths(run, 25.0)["here"]["x"] == []
    assert targets.watches(run, 7.5)["princes"]["x"] == [] and targets.summary(run, 7.5)[0][1] == "0, single"


def test_every_target_has_its_colour_and_a_group_its_extent() -> None:
    run = taken(targets_run()).runs[0]
    assert run.targets == 3 and run.numbers == {16: 0, 33: 1, 50: 2}
    apart, together, after = (targets.tracks(run, time) for time in (9.5, 12.5, 16.5))
    assert apart["heads"]["label"] == ["16", "33", "50"] and apart["heads"]["color"] == list(TARGETS[:3])
    assert together["heads"]["label"] == ["16 ×2", "50"] and together["paths"]["color"] == list(TARGETS[:3])
    assert (together["extents"]["radius"], together["extents"]["y"]) == ([6.0], [61.0]) and not apart["extents"]["x"]
    assert after["heads"]["label"] == ["16 ?", "33 ?", "50"]
    middle = after["paths"]["xs"][1]  # of 33, which the group interrupts
    assert middle[:4].tolist() == [19.0, 39.0, 59.0, 79.0] and np.isnan(middle[4]) and middle[5:].tolist() == [159.0]
    true = targets.truths(run, 9.5)
    assert true["truth"]["color"] == true["here"]["color"] == list(TARGETS[:3])
    assert true["here"]["x"] == [95.0] * 3 and true["here"]["y"] == pytest.approx([53.75, 66.25, 140.0])
    assert [told for _, *told, _ in targets.summary(run, 12.5)] == [
        ["group of 2: 16, 33", "head 42, prince 43"],
        ["50, single", "head 90, prince 91"],
    ]
    assert [error for *_, error in targets.summary(run, 12.5)] == ["1.41 m"] * 2
    error = scene.timeline(run)["error"]
    assert error["color"] == list(TARGETS[:3]) and [len(ys) for ys in error["ys"]] == [10, 8, 10]


def test_each_target_has_its_cluster() -> None:
    told = targets_run()
    asked = [(4.0, 16, 24, [25, 26]), (4.0, 50, 86, [87]), (4.5, 16, 24, [25])]
    for time_s, target, head, members in asked:
        cluster = {"track": target, "head": head, "count": len(members), "members": members}
        told.append(("CLUSTER", message("motehound.cluster_t", time_s=time_s, **cluster)))
    run = taken(told).runs[0]
    seen = scene.clusters(run, 4.2)
    assert seen["members"]["color"] == seen["spokes"]["color"] == [TARGETS[0]] * 2 + [TARGETS[2]]
    assert seen["members"]["x"] == [20.0, 40.0, 60.0] and seen["head"]["x"] == []
    assert scene.clusters(run, 4.6)["members"]["color"] == [TARGETS[0], TARGETS[2]]


def test_heads_princes_and_where_they_expect_the_target() -> None:
    run = taken(targets_run()).runs[0]
    seen = targets.watches(run, 4.5)
    assert [seen["watch_heads"][axis] for axis in "xy"] == [[40.0] * 3, [40.0, 80.0, 140.0]]
    assert [seen["princes"][axis] for axis in "xy"] == [[60.0] * 3, [40.0, 80.0, 140.0]]
    assert [list(xs) for xs in seen["ways"]["xs"]] == [[40.0, 60.0]] * 3
    assert (seen["expected"]["x"], seen["expected"]["y"][2]) == ([44.0] * 3, 141.0)
    x, y = (np.asarray(seen["areas"][axis][2]) for axis in ("xs", "ys"))  # a band of 2 x 2 m from (39, 141) on for 1.5 s
    assert (x.min(), x.max(), y.min(), y.max()) == pytest.approx((35.0, 58.0, 137.0, 145.0))
    alone = targets.watches(run, 6.5)
    assert alone["princes"]["x"] == [] and len(alone["watch_heads"]["x"]) == 3
    assert max(alone["areas"]["xs"][2]) == pytest.approx(59.0 + 10.0 * targets.AHEAD_S + 4.0)
    x, y = (np.asarray(targets.watches(run, 12.5)["areas"][axis][0]) for axis in ("xs", "ys"))
    assert (y.min(), y.max()) == pytest.approx((51.0, 71.0))  # of a group the extent besides
    assert targets.watches(run, 10.5)["watch_heads"]["color"] == [TARGETS[0], TARGETS[2]]  # 33 is in the group
    assert targets.watches(run, 20.0 + 1.5 + targets.HELD_S + 0.1)["areas"]["xs"] == []
    silent = [told for told in targets_run() if told[0] != "WATCH"]
    watch = {"target": 50, "number": 2, "head": 85, "prince": 86, "prince_s": 4.0, "sd_m": math.nan}
    unsure = taken([*silent, ("WATCH", message("motehound.watch_t", time_s=2.0, **watch))]).runs[0]
    (told,) = targets.watched(unsure, 2.5)
    assert told["sd"] == pytest.approx((5.0 / 2.0) ** 0.5)  # as its estimate, of 2 m and 1 m
    still = run.watch.until(0.0 + 2.0)[-1].copy()
    still["vx"] = 0.0
    assert np.hypot(targets.area(still)[0] - still["x"], targets.area(still)[1] - still["y"]) == pytest.approx(4.0)


def test_what_the_sink_has_is_no_estimate_of_a_head() -> None:
    run = taken([("TRACK", track(1.0, 5.0, 6.0, head=7)), ("SINK", track(1.0, 4.0, 6.5, head=-1))]).runs[0]
    assert run.track.snapshot()["x"].tolist() == [5.0]
    assert (run.sink.snapshot()["x"].tolist(), run.sink.snapshot()["y"].tolist()) == ([4.0], [6.5])


def test_clusters_and_what_the_sink_has_at_a_time() -> None:
    run = taken(clustered_run()).runs[0]
    motes = scene.Motes(run)
    assert len(run.track) == 20 and len(run.sink) == 18  # what the sink has is not a track of its own
    first, second = scene.clusters(run, 9.9), scene.clusters(run, 10.0)
    assert [first["head"][axis] for axis in "xy"] == [[10.0], [10.0]]
    assert [second["head"][axis] for axis in "xy"] == [[20.0], [20.0]]
    assert [first["members"][axis] for axis in "xy"] == [[10.0, 0.0], [0.0, 10.0]]
    assert first["spokes"]["xs"] == [(10.0, 10.0), (10.0, 0.0)] and first["spokes"]["color"] == [CLUSTER] * 2
    assert not scene.clusters(taken(small_run()).runs[0], 5.0)["head"]["x"]
    assert not len(scene.sink_view(run, 1.9)["sink"]["x"])
    seen = scene.sink_view(run, 7.5)
    assert seen["sink"]["x"].tolist() == [6.0] and len(seen["sink_path"]["x"]) == 6


def test_timeline_counts_every_frame() -> None:
    run = taken(small_run()).runs[0]
    lines = scene.timeline(run)
    assert lines["traffic"]["rate"].sum() * (20.0 / 240) == pytest.approx(40)
    assert [list(line) for line in lines["error"]["ys"]] == [pytest.approx([5.0] * 20)]
