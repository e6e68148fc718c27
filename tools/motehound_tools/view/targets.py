"""What there is to see of the targets of a run at one time: where they are, are believed to be, and who is to follow them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..recording import Run
from .colours import TARGETS, TRUTH

TRAIL_S = 600.0  # of the paths behind the targets
STALE = 5  # sampling intervals after which an estimate is no longer where the target is
HELD_S = 10.0  # after its prince was to take over, or was told to be none, a head that nothing more is heard of is forgotten
AHEAD_S = 5.0  # a head without a prince expects its target for so long
ANGLES = np.linspace(0.0, 2.0 * np.pi, 49)
SD = 2.0  # standard deviations that ellipses and predicted areas reach out
MODES = ("single", "sparse", "group")
UNRESOLVED = 512  # MH_ESTIMATE_UNRESOLVED

Columns = dict[str, list]


def colour(run: Run, target: int) -> str:
    """Of a target that is followed: that of the true target it was first taken for."""
    return TARGETS[run.numbers.get(int(target), int(target) >> 4) % len(TARGETS)]


def are_told_apart(run: Run) -> bool:
    """Whether there are several targets, or a protocol that names each."""
    return run.targets > 1 or len(run.watch) > 0


def name(target: int) -> str:
    return str(int(target) & 0xFFFFFFFF)


def truths(run: Run, time: float) -> dict[str, Columns]:
    """The paths so far and where the targets are now, between two samples on the line that joins them."""
    past, coming = run.truth.between(time - TRAIL_S, time), run.truth.between(time, np.inf)
    paths: Columns = {"xs": [], "ys": [], "color": []}
    here: Columns = {"x": [], "y": [], "color": []}
    for target in np.unique(past["target"]):
        mine = past[(past["target"] == target) & past["present"]]
        if not len(mine):
            continue
        path = np.stack([mine["x"], mine["y"]])
        shade = TRUTH if run.targets < 2 else TARGETS[target % len(TARGETS)]
        after = coming[: 2 * run.targets]
        now = _now(mine[-1], after[after["target"] == target][:1], time)
        if now is not None:
            path = np.append(path, now[:, None], axis=1)
            here["x"].append(now[0])
            here["y"].append(now[1])
            here["color"].append(shade)
        paths["xs"].append(path[0])
        paths["ys"].append(path[1])
        paths["color"].append(shade)
    return {"truth": paths, "here": here}


def _now(last: np.void, after: np.ndarray, time: float) -> np.ndarray | None:
    begin = np.array([last["x"], last["y"]])
    if not len(after):
        return begin if time - last["time"] < 1.0 else None
    if not after["present"][0]:
        return None
    share = (time - last["time"]) / max(float(after["time"][0] - last["time"]), 1e-9)
    return begin + share * (np.array([after["x"][0], after["y"][0]]) - begin)


def newest(run: Run, time: float) -> Iterator[tuple[np.ndarray, np.void]]:
    """The estimates of every target that is still followed, and the last of them. A target in a group is followed as that."""
    rows = run.track.between(time - TRAIL_S, time)
    last = {target: rows[rows["target"] == target] for target in np.unique(rows["target"])}
    grouped: dict[int, float] = {}
    for target, mine in last.items():
        for member in mine[-1]["of"] if mine[-1]["members"] > 1 else ():
            if member != target:
                grouped[int(member)] = max(grouped.get(int(member), 0.0), float(mine[-1]["time"]))
    for target, mine in last.items():
        interval = float(np.median(np.diff(mine["time"][-STALE:]))) if len(mine) > 1 else 1.0
        told = float(mine[-1]["time"])
        if time - told <= STALE * interval and grouped.get(int(target), -1.0) < told:
            yield mine, mine[-1]


def gaps(rows: np.ndarray, target: int) -> np.ndarray:
    """Before which of its estimates a target was in the group of another."""
    elsewhere = rows["time"][(rows["of"] == target).any(axis=1) & (rows["target"] != target)]
    times = rows["time"][rows["target"] == target]
    return np.flatnonzero(np.diff(np.searchsorted(elsewhere, times, "right"))) + 1


def tracks(run: Run, time: float) -> dict[str, Columns]:
    """Of every target the path of the estimates, the newest of them, its ellipse and what it is called; of a group its extent."""
    rows = run.track.between(time - TRAIL_S, time)
    paths: Columns = {"xs": [], "ys": [], "color": []}
    for target in np.unique(rows["target"]):
        mine = rows[rows["target"] == target]
        between = gaps(rows, target)
        paths["xs"].append(np.insert(mine["x"], between, np.nan))
        paths["ys"].append(np.insert(mine["y"], between, np.nan))
        paths["color"].append(colour(run, target))
    ellipses: Columns = {"xs": [], "ys": [], "color": []}
    heads: Columns = {"x": [], "y": [], "error": [], "color": [], "label": []}
    extents: Columns = {"x": [], "y": [], "radius": [], "color": []}
    for _, last in newest(run, time):
        shade = colour(run, last["target"])
        for field in ("x", "y", "error"):
            heads[field].append(float(last[field]))
        heads["color"].append(shade)
        heads["label"].append(label(last) if are_told_apart(run) else "")
        if last["members"] > 1:
            for field, value in zip(extents, (last["x"], last["y"], last["extent"], shade)):
                extents[field].append(value)
        covariance = np.array([[last["xx"], last["xy"]], [last["xy"], last["yy"]]])
        if np.isfinite(covariance).all():
            values, vectors = np.linalg.eigh(covariance)
            around = SD * np.sqrt(np.maximum(values, 0.0))[:, None] * np.array([np.cos(ANGLES), np.sin(ANGLES)])
            x, y = vectors @ around
            ellipses["xs"].append(last["x"] + x)
            ellipses["ys"].append(last["y"] + y)
            ellipses["color"].append(shade)
    return {"paths": paths, "ellipses": ellipses, "heads": heads, "extents": extents}


def label(last: np.void) -> str:
    """The identifier, or those of a group, and ? where they may have been exchanged."""
    members = [member for member in last["of"] if member] if last["members"] > 1 else []
    said = f"{name(last['target'])} ×{last['members']}" if members else name(last["target"])
    return said + (" ?" if last["flags"] & UNRESOLVED else "")


def watched(run: Run, time: float) -> list[np.void]:
    """Of every target what its newest head has told, while it counts. Where it does not say how sure it is, that is as its estimate."""
    rows = run.watch.between(time - TRAIL_S, time)
    followed = {int(last["target"]): last for _, last in newest(run, time)}
    found = []
    for target in np.unique(rows["target"]):
        last = rows[rows["target"] == target][-1].copy()
        until = max(float(last["prince_s"]) if last["prince"] >= 0 else 0.0, float(last["time"])) + HELD_S
        if time <= until and int(target) in followed:
            estimate = followed[int(target)]
            if not np.isfinite(last["sd"]):
                last["sd"] = np.sqrt(np.nan_to_num(estimate["xx"] + estimate["yy"]) / 2.0)
            found.append(last)
    return found


def area(last: np.void) -> np.ndarray:
    """[x, y][point]: where a head expects its target until the prince takes over, a band of two standard deviations and the extent."""
    width = max(SD * float(last["sd"]) + float(last["extent"]), 1e-3)
    velocity = np.array([last["vx"], last["vy"]])
    speed = float(np.hypot(*velocity))
    begin = np.array([last["x"], last["y"]])
    if speed == 0.0:
        return begin[:, None] + width * np.array([np.cos(ANGLES), np.sin(ANGLES)])
    ahead = float(last["prince_s"] - last["time"]) if last["prince"] >= 0 else AHEAD_S
    end = begin + max(ahead, 0.0) * velocity
    around = np.arctan2(velocity[1], velocity[0]) + ANGLES - np.pi / 2.0
    cap = width * np.array([np.cos(around), np.sin(around)])
    half = len(ANGLES) // 2 + 1
    return np.concatenate([end[:, None] + cap[:, :half], begin[:, None] + cap[:, half - 1 :]], axis=1)


def watches(run: Run, time: float) -> dict[str, Columns]:
    """Of every target its head, its prince, the way between them, the predicted area and the predicted place."""
    heads: Columns = {"x": [], "y": [], "color": []}
    princes: Columns = {"x": [], "y": [], "color": []}
    expected: Columns = {"x": [], "y": [], "color": []}
    ways: Columns = {"xs": [], "ys": [], "color": []}
    areas: Columns = {"xs": [], "ys": [], "color": []}
    for last in watched(run, time):
        shade = colour(run, last["target"])
        places = [run.places.get(int(last[role])) for role in ("head", "prince")]
        for columns, place in zip((heads, princes), places):
            if place is not None:
                for field, value in zip(columns, (*place, shade)):
                    columns[field].append(value)
        for field, value in zip(areas, (*area(last), shade)):
            areas[field].append(value)
        passed = time - float(last["time"])
        now = (last["x"] + passed * last["vx"], last["y"] + passed * last["vy"], shade)
        for field, value in zip(expected, now):
            expected[field].append(value)
        if places[0] is not None and places[1] is not None:
            for field, value in zip(ways, (*zip(*places), shade)):
                ways[field].append(value)
    return {"watch_heads": heads, "princes": princes, "ways": ways, "areas": areas, "expected": expected}


def summary(run: Run, time: float) -> list[tuple[str, str, str, str]]:
    """Of every target that is followed: its colour, what it is called and how it is followed, by whom, its error."""
    heads = {int(last["target"]): last for last in watched(run, time)}
    found = []
    for _, last in newest(run, time):
        watch = heads.get(int(last["target"]))
        members = [name(member) for member in last["of"] if member] if last["members"] > 1 else []
        said = [f"group of {last['members']}: {', '.join(members)}" if members else name(last["target"])]
        said += [MODES[last["mode"]]] if 0 <= last["mode"] < len(MODES) and not members else []
        said += ["unresolved"] if last["flags"] & UNRESOLVED else []
        who = [] if watch is None else [f"head {name(watch['head'])}"]
        who += [f"prince {name(watch['prince'])}"] if watch is not None and watch["prince"] >= 0 else []
        error = f"{last['error']:.2f} m" if np.isfinite(last["error"]) else "–"
        found.append((colour(run, last["target"]), ", ".join(said), ", ".join(who), error))
    return found
