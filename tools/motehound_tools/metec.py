"""The page about the real leaks: `motehound replay` of every controlled release, with the example's settings and with others."""

from __future__ import annotations

import csv
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from matplotlib import pyplot
from matplotlib.ticker import FuncFormatter

from . import figures
from .command import ROOT
from .failure import Failure
from .output import read_table
from .scenario import Array

SCENARIO = ROOT / "examples/metec.yaml"
DENSITY_KGPM3 = 0.565  # as tools/convert_metec.py has it
LARGE_KGPH = 1.0  # the published figure of the rates is of releases above this
MIXING = (0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6)  # m; the rest of the tuning's check
VARIANTS = (
    *(("tracker.mixing_m", value) for value in ("0.15", "0.6")),
    *(("tracker.wind_sd_rad", value) for value in ("0", "0.1", "0.3", "0.4")),
    *(("tracker.background_quantile", value) for value in ("0.1", "0.3")),
    *(("tracker.background_ppmph", value) for value in ("0.6", "6")),
    *(("tracker.learn_s", value) for value in ("0", "1800")),
    *(("tracker.memory_s", value) for value in ("0", "7200")),
)


@dataclass(frozen=True)
class Release:
    """A controlled release, and what the replay made of it: the place at its end, and its rate."""

    name: str
    begin: str
    hours: float
    place: int
    group: str
    rate_kgph: float
    found: int  # 0: nothing
    ratio: float  # of the rate to the true one; NaN where nothing was found
    right_share: float  # of the minutes of the release
    error_m: float  # of the place at its end
    sd_m: float  # of the place, as stated: of x and y together

    @property
    def right(self) -> bool:
        return self.found == self.place


def candidates(folder: Path) -> Array:
    """[place][number, x, y]"""
    table = read_table(folder / "candidates.csv", ("place", "x_m", "y_m"))
    return np.stack([table["place"], table["x_m"], table["y_m"]], axis=-1)


def replay(
    program: Path, recording: Path, out: Path, settings: tuple[tuple[str, str], ...] = (), on_grid: bool = False
) -> None:
    call = [str(program), "replay", "--scenario", str(SCENARIO), "--out", str(out)]
    for what in ("nodes", "readings", "truth", *(() if on_grid else ("candidates",))):
        call += [f"--{what}", str(recording / f"{what}.csv")]
    for key, value in settings:
        call += ["--set", f"{key}={value}"]
    done = subprocess.run(call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        raise Failure(lines[-1] if lines else f"{program}: exit status {done.returncode}")


def read(row: dict[str, str], recording: Path, out: Path) -> Release:
    """What became of the release that is `row` of releases.csv."""
    places, place = candidates(recording), int(row["place"])
    track = read_table(out / "track.csv", ("time_s", "x_m", "y_m", "sd_m", "true_x_m", "true_y_m", "rate", "true_rate"))
    known = np.isfinite(track["true_x_m"])
    minutes = read_table(recording / "truth.csv", ("time_s",))["time_s"]
    expected = (minutes[-1] - minutes[0]) / 60.0 + 1.0
    off = np.hypot(track["x_m"][:, None] - places[:, 1], track["y_m"][:, None] - places[:, 2])
    found = places[np.argmin(off, axis=1), 0].astype(int)
    error = np.hypot(track["x_m"] - track["true_x_m"], track["y_m"] - track["true_y_m"])
    last = np.flatnonzero(known)[-1:]
    return Release(
        row["release"],
        row["begin_utc"].replace("T", " "),
        float(row["hours"]),
        place,
        row["name"],
        float(row["rate_mlps"]) * 3.6e-3 * DENSITY_KGPM3,
        int(found[last[0]]) if len(last) else 0,
        float(track["rate"][last[0]] / track["true_rate"][last[0]]) if len(last) else float("nan"),
        float(np.sum(found[known] == place) / expected),
        float(error[last[0]]) if len(last) else float("nan"),
        float(np.sqrt(2.0) * track["sd_m"][last[0]]) if len(last) else float("nan"),
    )


def replay_all(
    program: Path, recordings: Path, out: Path, settings: tuple[tuple[str, str], ...] = (), on_grid: bool = False
) -> list[Release]:
    try:
        with (recordings / "releases.csv").open(newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
    except OSError as error:
        raise Failure(f"{error.filename}: {error.strerror}") from None
    found = []
    for row in rows:
        recording = recordings / row["release"]
        replay(program, recording, out, settings, on_grid)
        found.append(read(row, recording, out))
    return found


def right(releases: list[Release]) -> int:
    return sum(release.right for release in releases)


def ratios(releases: list[Release], least_kgph: float = 0.0) -> Array:
    return np.array([release.ratio for release in releases if release.rate_kgph >= least_kgph])


def mixing_for(of: Array) -> float:
    """The mixing length with which the median ratio would be 1; of[mixing][release]."""
    medians = np.log(np.median(of, axis=1))
    return float(np.exp(np.interp(0.0, medians, np.log(MIXING))))


def ratio_at(of: Array, mixing: float) -> Array:
    """Of each release, between those that were replayed."""
    return np.array([np.exp(np.interp(np.log(mixing), np.log(MIXING), np.log(row))) for row in of.T])


def cross_checks(of: Array) -> list[list[str]]:
    """The mixing length chosen on some releases, judged on the others."""
    count = of.shape[1]
    order = np.arange(count)
    splits = (
        ("the first half of the week", "the second", order < count // 2),
        ("the second half", "the first", order >= count // 2),
        ("every other release", "the others", order % 2 == 0),
        ("those others", "the first of them", order % 2 == 1),
    )
    rows = []
    for chosen, judged, mask in splits:
        mixing = mixing_for(of[:, mask])
        rows.append([chosen, f"{mixing:.2f}", judged, f"{np.median(ratio_at(of[:, ~mask], mixing)):.2f}"])
    alone = [mixing_for(np.delete(of, one, axis=1)) for one in range(count)]
    each = [ratio_at(of[:, one : one + 1], alone[one])[0] for one in range(count)]
    rows.append(["all but one, in turn", f"{min(alone):.2f} to {max(alone):.2f}", "that one", f"{np.median(each):.2f}"])
    return rows


def markdown(rows: list[list[str]]) -> str:
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def group_of(releases: list[Release], place: int) -> str:
    return next((release.group for release in releases if release.place == place), f"place {place}" if place else "none")


def picture(releases: list[Release], recording: Path) -> str:
    """The site, and the rates beside the true ones."""
    places = candidates(recording)
    nodes = read_table(recording / "nodes.csv", ("x_m", "y_m"))
    figure, (site, rates) = pyplot.subplots(1, 2, figsize=(9.6, 4.4))
    site.scatter(nodes["x_m"], nodes["y_m"], marker="^", s=34, color=figures.QUIET, label="sensor", zorder=3)
    colours = dict(zip(places[:, 0].astype(int), (figures.TRUTH, figures.TRACK, figures.RAW, figures.SECOND, "#cc79a7")))
    for number, x, y in places:
        name = group_of(releases, int(number))
        ours = [release for release in releases if release.place == number]
        site.scatter([x], [y], s=70, color=colours[int(number)], zorder=3)
        label = f"{name}\n{sum(one.right for one in ours)} of {len(ours)} found"
        site.annotate(label, (x, y), (0, 8), textcoords="offset points", ha="center", fontsize=8.5)
        for one, marker in ((True, "o"), (False, "x")):
            chosen = [release for release in ours if release.right == one]
            true = np.array([release.rate_kgph for release in chosen])
            estimated = true * np.array([release.ratio for release in chosen])
            rates.scatter(true, estimated, color=colours[int(number)], marker=marker, s=34, zorder=3)
    site.set(xlabel="east, m", ylabel="north, m", aspect="equal", ylim=(-60, 52))
    site.legend(loc="lower center")
    ends = np.array([0.15, 30.0])
    rates.fill_between(ends, ends / 2.0, ends * 2.0, color=figures.QUIET, alpha=0.18, linewidth=0)
    rates.plot(ends, ends, color=figures.QUIET, linewidth=1)
    rates.set(xscale="log", yscale="log", xlim=(0.3, 10), ylim=ends, xlabel="true rate, kg/h", ylabel="estimated rate, kg/h")
    for axis in (rates.xaxis, rates.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    rates.annotate("within a factor of two", (0.34, 0.22), fontsize=8.5, color="#59626e")
    figure.tight_layout()
    return figures.svg_text(figure)


def page(releases: list[Release], on_grid: list[Release], variants: list[list[str]], checks: list[list[str]]) -> str:
    all_ratios, large = ratios(releases), ratios(releases, LARGE_KGPH)
    rows = [
        [
            str(number),
            release.begin,
            f"{release.hours:.1f}",
            release.group,
            f"{release.rate_kgph:.2f}",
            group_of(releases, release.found) if release.right else f"**{group_of(releases, release.found)}**",
            f"{release.rate_kgph * release.ratio:.2f}",
            f"{release.ratio:.2f}",
            f"{100 * release.right_share:.0f} %",
        ]
        for number, release in enumerate(releases, 1)
    ]
    environment = Environment(
        loader=PackageLoader("motehound_tools"), undefined=StrictUndefined, keep_trailing_newline=True
    )
    return environment.get_template("metec.md.j2").render(
        count=len(releases),
        right=right(releases),
        median=f"{np.median(all_ratios):.2f}",
        halves=" and ".join(f"{np.median(half):.2f}" for half in (all_ratios[: len(releases) // 2], all_ratios[len(releases) // 2 :])),
        within_two=int(np.sum((all_ratios > 0.5) & (all_ratios < 2.0))),
        within_three=int(np.sum((all_ratios > 1.0 / 3.0) & (all_ratios < 3.0))),
        large=len(large),
        large_band=" to ".join(f"{value:+.0f} %" for value in 100.0 * (np.quantile(large, (0.05, 0.95)) - 1.0)),
        large_inside=int(np.sum((large > 0.51) & (large < 1.79))),
        minutes=f"{100 * np.mean([release.right_share for release in releases]):.0f}",
        grid_error=f"{np.median([release.error_m for release in on_grid]):.0f}",
        grid_worst=f"{max(release.error_m for release in on_grid):.0f}",
        grid_sd=f"{np.median([release.sd_m for release in on_grid]):.0f}",
        grid_right=right(on_grid),
        grid_median=f"{np.median(ratios(on_grid)):.2f}",
        releases=markdown(rows),
        variants=markdown(variants),
        checks=markdown(checks),
    )


def write(program: Path, data: Path, out: Path, file: Path) -> None:
    recordings = out / "recordings"
    converted = subprocess.run(
        [sys.executable, ROOT / "tools/convert_metec.py", data, recordings], stderr=subprocess.PIPE, text=True
    )
    if converted.returncode:
        raise Failure(converted.stderr.strip())
    releases = replay_all(program, recordings, out / "replay")
    on_grid = replay_all(program, recordings, out / "variant", on_grid=True)
    variants = []
    for key, value in VARIANTS:
        other = replay_all(program, recordings, out / "variant", ((key, value),))
        variants.append([f"`{key}` {value}", str(right(other)), f"{np.median(ratios(other)):.2f}"])
    by_mixing = [
        ratios(replay_all(program, recordings, out / "variant", (("tracker.mixing_m", str(mixing)),))) for mixing in MIXING
    ]
    images = file.parent / "images"
    images.mkdir(parents=True, exist_ok=True)
    (images / "metec.svg").write_text(picture(releases, recordings / releases[0].name), encoding="utf-8")
    file.write_text(page(releases, on_grid, variants, cross_checks(np.array(by_mixing))), encoding="utf-8")
