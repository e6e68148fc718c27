"""One self-contained HTML page from an output folder."""

from __future__ import annotations

import base64
import html
import json
import math
import re
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape

from . import cluster_figures, figures, output, ranged_figures, search_figures, sweep_figures, target_figures
from .failure import Failure
from .figures import Picture
from .output import Output, Sweep
from .sweep_figures import Table

MEANING = {
    "position_rmse_m": "root mean square error of the position, m",
    "position_median_m": "median error of the position, m",
    "position_p95_m": "95th percentile of the error, m",
    "raw_position_rmse_m": "root mean square error before the filter, m",
    "position_rmse_at_arrival_m": "error against the position at the estimated time of arrival, m",
    "tracked_share": "share of the samples that gave a position",
    "track_lost": "1 if the track was lost, 0 if not",
    "nees_median": "median normalised squared error of all states (exact: 1.39 of two, 2.37 of three, 3.36 of four)",
    "position_error_median_m": "gas: median error of the position that searches end with, m",
    "rate_error_median": "gas: the same of the rate of release, as a share of the true one",
    "error_over_crlb": "gas: root mean square of the position's error over its Cramér-Rao bound, where it was found",
    "success_50m": "gas: share of the searches that ended by themselves within 50 m",
    "success_10m": "gas: the same within 10 m",
    "converged": "gas: share that ended by themselves",
    "converged_wrong": "gas: share that ended by themselves elsewhere",
    "hops": "gas: heads of a search",
    "sensors_used": "gas: different sensors heard",
    "sensors_to_10m": "gas: the same until the error fell below 10 m for good",
    "crlb_m": "gas: Cramér-Rao bound of the position, m",
    "rate_crlb": "gas: the same of the rate of release, as a share of it",
    "anees": "mean normalised squared error of all states; their number is exact",
    "claimed_over_rmse": "root mean square error that the tracker claims over that which it has",
    "smse_m": "RMSE over the runs, added up over all instants with a position, m",
    "position_rmse_worst_m": "RMSE over the runs at the worst instant, m",
    **{f"local_position_rmse_m_{c}": f"RMSE of fixed cluster {c} by itself, m" for c in range(1, 5)},
    **{f"local_anees_{c}": f"mean normalised squared error of fixed cluster {c}; 4 is exact" for c in range(1, 5)},
    "rate_ratio": "last estimate of the rate of release over the true one",
    "ccrb_m": "Cramér-Rao bound along the run's own path, m",
    "estimates": "positions that the head reported",
    "localisation_error_rs": "mean error of the heads' positions, share of the sensing range",
    "sink_error_rs": "mean error of what the sink has, share of the sensing range",
    "rmse_over_pcrb": "RMSE over the posterior Cramér-Rao bound",
    "longest_gap_s": "longest time without a position within the sensing range of the target, s",
    "pcrb_m": "posterior Cramér-Rao bound of the RMSE, m",
    "clusters": "clusters formed after the first",
    "clusters_least": "least hand-overs in hindsight",
    "recoveries": "times that the target was found again after nobody knew of it",
    "reports_per_sample": "positions sent to the sink, by sampling instant",
    "reports_least": "least of them in hindsight",
    "asked_per_sample": "nodes that a head asked to sample, by sampling instant",
    "answered_per_sample": "of these such that measured the target",
    "energy_mj_hottest": "energy of the mote that used most, mJ",
    "energy_mj_per_sample": "energy used by all motes but the one on mains, by sampling instant, mJ",
    "frames_sent": "frames sent by all motes, every hop counted",
    "frames_sent_beacons": "of these beacons, which build the way to the head",
    "frames_sent_reports": "of these reports of readings",
    "frames_sent_requests": "of these requests of the head for readings",
    "frames_received": "receptions, one for each mote in range",
    "frames_sent_hellos": "of these hellos to the neighbours",
    "frames_sent_landmarks": "of these landmarks, which say where the head is",
    "frames_sent_syncs": "of these synchronisations of the clocks",
    "frames_duplicate": "receptions of a frame that the mote had before; its radio keeps them to itself",
    "frames_repeated": "of the frames sent those sent again for want of an acknowledgement",
    "frames_lost": "receptions that failed",
    **{f"frames_lost_{reason}": said for reason, said in figures.LOST_AT_SENDER.items()},
    "readings": "samples taken by all motes",
    "readings_refused": "samples out of range or out of time",
    "reports": "readings that a mote reported",
    "reports_asked": "of these reported because the head asked",
    "reports_no_route": "of these lost for want of a next hop",
    "measurements": "reports that reached the head in time",
    "measurements_late": "reports that reached the head too late",
    "measurements_overflowed": "reports that gave way to stronger ones for want of room",
    "delivery_share": "share of the reports that reached the head, in time or late",
    "clock_error_p99_ms": "99th percentile of the error of the motes' network time, ms",
    "lifetime_s": "until the first battery was empty, s",
    "lifetime_half_s": "until half of the batteries were empty, s",
    "motes_dead": "motes whose battery is empty at the end",
    "energy_mj": "energy used by all motes but the one on mains, mJ",
    **{f"energy_mj_{cause}": f"of this for {said}, mJ" for cause, (said, _) in figures.CAUSES.items()},
    **{f"energy_mj_per_sample_{cause}": f"of this for {said}, mJ" for cause, (said, _) in figures.CAUSES.items()},
    **{f"energy_mj_state_{state}": f"of this while {said}, mJ" for state, (said, _) in figures.STATES.items()},
    "position_error_m": "mean error of the position of single targets, m",
    "group_centroid_error_m": "mean error of the centroid of groups, m",
    "success": "1 if no target was lost, or taken for another in the end, and no two tracks became one, else 0",
    "identity_swaps": "exchanges of identifiers that would set right the tracks that are with each other's targets",
    "swaps_claimed": "of these between tracks that do not say that they cannot tell who is who",
    "unresolved": "1 if a target's track says so in the end, else 0",
    "longest_gap_m": "the largest distance that a target travels between two fixes, or after the last, m",
    "merge_delay_s": (
        "mean time from when two targets come together (a chain of steps within 20 m) until they are in one "
        "group, s"
    ),
    "split_delay_s": "the same from when they come apart (30 m) until they are not, s",
    "extent_bias_m": "mean of the extent, less the root mean square distance of the targets from their centroid, m",
    "mode_changes_per_min": "instants a minute at which a target becomes single, one of several or part of a group",
    "spurious_splits_per_min": (
        "instants a minute at which one loses targets that are together, of the time that targets are"
    ),
    "count_right": (
        "sound, ideal network: share of the sampling instants at which as many targets are followed as there "
        "are, those in groups with them"
    ),
    "apart_at_end": "1 if every target is followed by itself in the end (on the last 150 m of its way), else 0",
    "rmse_over_crlb": "position_rmse_m over fix_crlb_m",
    "messages_per_cluster": "calls to localise, answers, and those of competitions, by fix",
    "messages_per_cluster_all": (
        "the same and the announcements of heads, their hand-overs and reports of failure, by fix"
    ),
    "double_heads": "share of the fixes after which a second node was head of the same generation, for a while",
    "targets_founded": "times that nodes took what they heard for a new target",
    "fixes": "fixes, each of which begins a cluster",
    "fixes_prince": "of these by the node that the head had chosen",
    "fixes_regent": "of these by another in the place of a silent prince",
    "fixes_retried": "calls to localise that were sent again",
    "fixes_failed": "calls to localise that were given up",
    "watchdogs": "times that a head missed its successor",
    "relays": "reports of failure passed on",
    "awakes_repeated": "announcements of a head repeated for who had not heard them",
    "targets_given_up": "targets that their head, or who looked for them last, gave up",
    "targets_evicted": "times that a node's table had no room for a target, and the first that was to leave it went",
    "prince_refused": "messages with absurd content, or of no time about now",
    "groups_merged": "times that two targets went on as a group",
    "groups_split": "times that a group fell into parts",
    "fix_crlb_m": (
        "the Cramer-Rao bound of position_rmse_m for fixes from the samples of one instant, of all nodes that "
        "detect a target, m"
    ),
    "events": "that motes handled: readings, frames, alarms",
    "windows": "of simulated time that the motes were run through together",
}
HEADLINES = (
    ("position_median_m", "median error", "m"),
    ("position_p95_m", "95th percentile", "m"),
    ("position_rmse_m", "RMSE", "m"),
    ("tracked_share", "samples with a position", "%"),
    ("track_lost", "tracks lost", "%"),
    ("rmse_over_pcrb", "RMSE over its bound", ""),
    ("sink_error_rs", "mean error at the sink, of the sensing range", "%"),
    ("reports_per_sample", "reports a sample", ""),
    ("clusters", "clusters formed", ""),
    ("energy_mj_per_sample", "energy a sample", "mJ"),
    ("longest_gap_s", "longest without a position", "s"),
    ("nees_median", "median NEES (exact: 1.39)", ""),
)
HEADLINES_OF_SEARCHES = (
    ("success_50m", "searches that found the leak", "%"),
    ("converged_wrong", "ended, but farther off", "%"),
    ("position_error_median_m", "median error at the end", "m"),
    ("error_over_crlb", "error over its bound", ""),
    ("rate_error_median", "median error of the rate", "%"),
    ("nees_median", "median NEES (exact: 2.37)", ""),
    ("hops", "heads", ""),
    ("sensors_used", "sensors heard", ""),
    ("sensors_to_10m", "of these until 10 m", ""),
)
HEADLINES_OF_CLUSTERS = (
    ("position_rmse_m", "RMSE", "m"),
    ("rmse_over_pcrb", "RMSE over its bound", ""),
    ("position_rmse_worst_m", "RMSE at the worst instant", "m"),
    ("smse_m", "RMSE, sum over time", "m"),
    ("anees", "mean NEES (exact: 4)", ""),
    ("claimed_over_rmse", "claimed over true RMSE", ""),
)

HEADLINES_OF_TARGETS = (
    ("position_error_m", "mean error", "m"),
    ("rmse_over_crlb", "RMSE over the bound of one fix", ""),
    ("success", "runs that kept all targets apart", "%"),
    ("track_lost", "runs that lost a target", "%"),
    ("identity_swaps", "identifiers exchanged a run", ""),
    ("unresolved", "runs that end with doubts who is who", "%"),
    ("group_centroid_error_m", "mean error of groups", "m"),
    ("merge_delay_s", "until a group is one", "s"),
    ("split_delay_s", "until its parts are", "s"),
    ("messages_per_cluster", "messages for a position", ""),
    ("messages_per_cluster_all", "with hand-overs and wake-ups", ""),
    ("longest_gap_m", "longest way without a position", "m"),
    ("double_heads", "generations with two heads", "%"),
)

OF_SEVERAL = ("success", "identity_swaps", "unresolved")

FACTS_OF_CONCENTRATIONS = (
    ("speed", "source", "speed_mps", " m/s"),
    ("relative noise", "sensor", "relative_noise", ""),
    ("additive noise", "sensor", "additive_noise", " g/m²"),
)
FACTS_OF_RANGES = (
    ("density", "network", "density", ""),
    ("noise of a range", "sensor", "range_noise_m", " m"),
    ("sensing range", "sensor", "range_m", " m"),
    ("election", "protocol", "election", ""),
    ("network", "network", "protocol", ""),
)
FACTS_OF_SEARCHES = (
    ("release", "source", "rate_mlps", " mL/s"),
    ("wind", "wind", "speed_mps", " m/s"),
    ("noise of a sample", "sensor", "noise_ppm", " ppm"),
    ("network", "network", "protocol", ""),
)
FACTS_OF_TARGETS = (
    ("ways", "source", "path", ""),
    ("targets", "target", "count", ""),
    ("speed", "source", "speed_mps", " m/s"),
    ("sensing range", "sensor", "range_m", " m"),
    ("election", "protocol", "election", ""),
    ("separation", "tracker", "separation", ""),
    ("groups", "tracker", "groups", ""),
    ("network", "network", "protocol", ""),
)
FACTS_OF_CLUSTERS = (
    ("rule", "fusion", "rule", ""),
    ("reports every", "fusion", "report_s", " s"),
    ("network", "network", "protocol", ""),
)


def headlines(results: Output) -> tuple[tuple[str, str, str], ...]:
    if results.is_search:
        return HEADLINES_OF_SEARCHES
    if results.is_heard:
        alone = results.scenario and results.scenario.sections.get("target", {}).get("count") == 1
        return tuple(head for head in HEADLINES_OF_TARGETS if not (alone and head[0] in OF_SEVERAL))
    return HEADLINES_OF_CLUSTERS if results.is_fixed else HEADLINES


def facts_of_kind(results: Output) -> tuple[tuple[str, str, str, str], ...]:
    if results.is_search:
        return FACTS_OF_SEARCHES
    if results.is_heard:
        return FACTS_OF_TARGETS
    if results.is_fixed:
        return FACTS_OF_CLUSTERS
    return FACTS_OF_RANGES if results.is_ranged else FACTS_OF_CONCENTRATIONS


def number(value: object) -> str:
    """Three significant digits, without exponents for the sizes that occur."""
    if not isinstance(value, (int, float)) or not math.isfinite(value):
        return "–"
    if value == int(value) and abs(value) < 1e9:
        return f"{int(value):,}"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:,.{min(digits, 6)}f}"


def as_image(picture: Picture) -> str:
    """The figure as an <img> with its SVG inside: nothing is fetched, and ids of one cannot touch another's."""
    data = base64.b64encode(picture.svg.encode()).decode()
    alternative = html.escape(f"{picture.title}. {picture.caption}", quote=True)
    return f'<img src="data:image/svg+xml;base64,{data}" alt="{alternative}">'


def figure(results: Output, metric: str, unit: str) -> str:
    return number(results.pooled(metric) * (100.0 if unit == "%" else 1.0))


def headline(results: Output) -> list[tuple[str, str, str]]:
    """(label, value, unit) of the figures that are said first."""
    known = [head for head in headlines(results) if math.isfinite(results.pooled(head[0]))]
    return [(label, figure(results, metric, unit), unit) for metric, label, unit in known]


def statistics(results: Output) -> list[dict[str, str]]:
    rows = []
    for name, entry in results.summary["metrics"].items():
        row = {key: number(entry[key]) for key in output.STATISTICS}
        pooled = results.summary.get("pooled", {}).get(name)
        of_these = f"of these by reason `{name.removeprefix('frames_lost_')}`" if name.startswith("frames_lost_") else ""
        rows.append({"name": name, "meaning": MEANING.get(name, of_these), "pooled": number(pooled), **row})
    return rows


def boards(results: Output) -> list[dict[str, str]]:
    """How the emulated boards did, if motes lived on some."""
    rows = []
    for board in results.summary.get("boards", []):
        mean, longest = (number(1e3 * board[key] / board["rate_hz"]) for key in ("cycles_mean", "cycles_max"))
        whole = {key: f"{board[key]:,}" for key in ("events", "late", "overlapped")}
        ram = f"{board['ram_free_b']:,} of {board['ram_b']:,} B" if "ram_b" in board else "–"
        kind = f"{board['board']}, {board['arithmetic']}"
        image = board["image"].rpartition("/")[2]
        rows.append({"node": str(board["node"]), "kind": kind, "image": image, "mean": mean, "longest": longest, "ram": ram, **whole})
    return rows


def facts(results: Output, varied: str) -> list[tuple[str, str]]:
    """What was run, in words; without the key that a sweep varies."""
    runs = len(results.runs["run"])
    said = [("runs", f"{runs:,}"), ("first seed", str(results.summary.get("seed", "–")))]
    if results.scenario:
        scenario = results.scenario.sections
        for label, section, key, unit in (
            ("tracker", "tracker", "name", ""),
            ("nodes", "network", "nodes", ""),
            ("layout", "network", "layout", ""),
            ("sampling interval", "sensor", "interval_s", " s"),
            *facts_of_kind(results),
        ):
            if key in scenario.get(section, {}) and f"{section}.{key}" != varied:
                value = scenario[section][key]
                if (section, key) == ("network", "nodes") and scenario[section].get("layout") == "strat":
                    value = scenario[section]["grid"] ** 2
                if (section, key) == ("network", "protocol") and scenario[section].get("ideal"):
                    value += ", ideal"
                said.append((label, f"{value:g}{unit}" if isinstance(value, (int, float)) else f"{value}{unit}"))
    return said


def pictures(results: Output) -> list[Picture]:
    if not len(results.track["run"]):
        return []
    if results.is_search:
        drawn = [search_figures.walk_picture(results), search_figures.bound_picture(results)]
        drawn += [figures.error_picture(results)]
        return [picture for picture in drawn if picture]
    if results.is_heard:
        drawn = [target_figures.field_picture(results), target_figures.heads_picture(results)]
        drawn += [target_figures.modes_picture(results), target_figures.error_picture(results)]
        drawn += [figures.distribution_picture(results)]
        return [picture for picture in drawn if picture]
    if results.is_fixed:
        drawn = [cluster_figures.field_picture(results), cluster_figures.error_picture(results)]
        drawn += [cluster_figures.consistency_picture(results), figures.distribution_picture(results)]
        return [picture for picture in drawn if picture]
    if results.is_ranged:
        drawn = [ranged_figures.field_picture(results), ranged_figures.excerpt_picture(results)]
    else:
        drawn = [figures.field_picture(results), figures.track_picture(results, figures.typical_run(results))]
    drawn += [figures.error_picture(results), figures.distribution_picture(results), ranged_figures.work_picture(results)]
    return [picture for picture in drawn if picture]


def target_rows(results: Output) -> list[dict[str, str]]:
    """What became of each target, of runs that have some to tell apart."""
    if not results.is_heard:
        return []
    return [
        {
            "number": str(fate.number),
            "colour": target_figures.colour(fate.number),
            "found": f"{fate.found} of {fate.runs}",
            "lost": str(fate.lost),
            "swapped": str(fate.swapped),
            "identifiers": number(fate.identifiers / fate.found if fate.found else math.nan),
            "estimates": f"{fate.estimates:,}",
            "grouped": number(100.0 * fate.grouped / fate.estimates if fate.estimates else math.nan),
            "error": number(fate.error_m),
        }
        for fate in target_figures.fates(results)
    ]


def network_pictures(results: Output) -> list[Picture]:
    drawn = [figures.energy_picture(results), figures.losses_picture(results)]
    return [picture for picture in drawn if picture]


def environment() -> Environment:
    return Environment(
        loader=PackageLoader("motehound_tools"),
        autoescape=select_autoescape(["html", "j2"]),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def render_sweeps(folders: list[Path]) -> str:
    described = []
    for folder in folders:
        table = Table.read(folder)
        said = table.experiment
        described.append(
            {
                "name": folder.name,
                "title": said.title or folder.name,
                "description": said.description,
                "scenario": said.scenario,
                "settings": said.settings,
                "runs": len(table.columns["seed"]),
                "version": table.version,
                "drawn": sweep_figures.pictures(table),
            }
        )
    return environment().get_template("sweeps.html.j2").render(sweeps=described, as_image=as_image)


def render(found: Output | Sweep) -> str:
    first = found.outputs[0] if isinstance(found, Sweep) else found
    sweep = found if isinstance(found, Sweep) else None
    columns = [head for head in headlines(first) if math.isfinite(first.pooled(head[0]))]
    across = figures.sweep_picture(sweep) if sweep else None
    middle = sweep.outputs[len(sweep.outputs) // 2] if sweep else first
    return environment().get_template("report.html.j2").render(
        name=str(first.summary.get("scenario", "motehound")),
        description=str(first.scenario.sections.get("description", "")) if first.scenario else "",
        version=str(first.summary.get("version", "unknown")),
        facts=facts(middle, sweep.key if sweep else ""),
        headline=headline(middle),
        sweep=sweep,
        across=across,
        swept=[
            {"value": f"{value:g}", "cells": [figure(o, metric, unit) for metric, _, unit in columns]}
            for value, o in zip(sweep.values, sweep.outputs)
        ]
        if sweep
        else [],
        columns=columns,
        middle_value=f"{sweep.values[len(sweep.values) // 2]:g}" if sweep else "",
        pictures=pictures(middle),
        targets=target_rows(middle),
        lost_m=number(target_figures.LOST_M),
        network=network_pictures(middle),
        statistics=statistics(middle),
        boards=boards(middle),
        has_pooled=bool(middle.summary.get("pooled")),
        scenario=json.dumps(middle.scenario.sections, indent=2) if middle.scenario else "",
        as_image=as_image,
    )


def natural(folder: Path) -> list[str | int]:
    """Figure 9 comes before figure 10."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", folder.name)]


def sweeps_in(folder: Path) -> list[Path]:
    """The folder itself if it is one of tools/sweep, else those in it."""
    if not folder.is_dir() or (folder / "summary.json").exists():
        return []
    if (folder / "manifest.json").exists():
        return [folder]
    return sorted((child for child in folder.iterdir() if (child / "table.parquet").exists()), key=natural)


def write(folder: Path, page: Path) -> None:
    """Render first, then put the page in place, so that a failure leaves no half of it."""
    swept = sweeps_in(folder)
    text = render_sweeps(swept) if swept else render(output.read(folder))
    part = page.with_name(page.name + ".part")
    try:
        part.write_text(text, encoding="utf-8")
        part.replace(page)
    except OSError as error:
        raise Failure(f"{page}: cannot be written: {error.strerror}") from None
