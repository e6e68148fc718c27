"""Runs the experiments han_* and sets their figures beside what they should be, and beside what the thesis claims."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined
from matplotlib import pyplot

from . import sweep, sweep_figures
from .command import ROOT
from .figures import svg_text
from .report import natural
from .sweep_figures import COLOURS, Table
from .xu import Required, at_least, at_most
from .zhou import Claim, Figures, axis, markdown, percent, significant

IMAGES = {  # file: experiment and the number of its figure
    "han_table21": ("han_table21", 0),
    "han_error": ("han_energy", 2),
    "han_turn": ("han_turn", 0),
    "han_gap": ("han_turn", 1),
    "han_loss": ("han_loss", 0),
    "han_loss_messages": ("han_loss", 1),
    "han_sparse": ("han_sparse", 0),
    "han_sparse_error": ("han_sparse", 1),
    "han_three": ("han_sparse", 2),
    "han_crossing": ("han_sparse", 4),
    "han_group": ("han_group", 0),
}
FIX, GROUP, LOST, SUCCESS, GAP = "position_error_m", "group_centroid_error_m", "track_lost", "success", "longest_gap_m"
MESSAGES, ALL, SWAPS = "messages_per_cluster", "messages_per_cluster_all", "identity_swaps"
NOISY, ADDITIVE, CLEAN = "(a) a source that is noise itself", "(b) purely additive noise, 1,089 nodes", "(c) no noise"
PAIR, THREE, CROSSING, BOUNCE = "(a) two side by side", "(b) three side by side", "(c) crossing", "(d) nearly meeting, 10 m"
RING, LANES, STAY = "(a) three on a ring", "(b) three come together and part", "(c) two, 23 m apart"
ONE, TWO = "(a) one target", "(b) two, 40 m apart"
NONE, SHARES, WIDE, JOINT = "not told apart", "shares as published", "shares within 3 R", "joint fit"
PRINCE, COMPETITION, TIMESTAMP = "prince", "competition", "timestamp"
GUARDED, BARE = "with all guards", "published rules alone"
SPACING, ANGLE, CELLS, LOSS = "target.spacing_m", "target.turn_deg", "network.grid", "radio.loss"
# share of the field that three nodes cover, by cells along a side
COVERAGE = {23: 0.549, 24: 0.649, 25: 0.738, 26: 0.815, 28: 0.921, 30: 0.974, 34: 0.999, 40: 1.0}
# Table 2-1: the thesis, and an independent simulation of it with a source that is noise itself
TABLE_2_1 = {
    "centroid of three": (9.47, 9.34),
    "DM 4, cases": (4.94, 5.42),
    "DM 8, cases": (3.68, 4.00),
    "DM 40, cases": (3.15, 3.33),
    "DM 4": (None, 5.13),
    "DM 8": (None, 3.76),
    "DM 40": (None, 3.14),
    "DM 8, five": (None, 2.71),
    "likelihood": (None, 2.60),
    "default": (None, 1.82),
}
# (2-16), (2-14), (2-15): messages of a fix where three nodes hear the target with probability p, else two
FORMULAS = {PRINCE: lambda p: 4 - p * p, COMPETITION: lambda p: 2 * (2 + p), TIMESTAMP: lambda p: 4 + p}
INDEPENDENT = {  # p: prince, competition, timestamp; election and location messages of an independent simulation
    24: (5.21, 8.28, 10.64),
    25: (4.60, 7.46, 9.20),
    26: (4.20, 7.08, 7.47),
    28: (3.76, 6.58, 5.93),
    34: (3.55, 6.40, 4.91),
    40: (3.53, 6.49, 4.86),
}


class Targets(Figures):
    def fix(self, series: str, metric: str = FIX, panel: str = NOISY) -> float:
        return self.mean("han_table21", panel, series, metric)

    def energy(self, series: str, metric: str = MESSAGES, cells: int = 34) -> float:
        return self.mean("han_energy", "", series, metric, **axis(CELLS, cells))

    def first_lost(self, cells: int) -> float:
        return float(np.mean(self.of("han_energy", "", PRINCE, LOST, **axis(CELLS, cells))[:20]))

    def sparse(self, panel: str, series: str, metric: str, spacing_m: float) -> float:
        return self.mean("han_sparse", panel, series, metric, **axis(SPACING, spacing_m))

    def turn(self, series: str, metric: str, degrees: float) -> float:
        return self.mean("han_turn", "", series, metric, **axis(ANGLE, degrees))

    def loss(self, metric: str, share: float, series: str = GUARDED) -> float:
        return self.mean("han_loss", "", series, metric, **axis(LOSS, share))

    def ring(self, metric: str) -> float:
        return self.mean("han_group", RING, "members", metric, **axis(SPACING, 10))

    def lanes(self, metric: str) -> float:
        return self.mean("han_group", LANES, "members", metric)

    def saved(self, other: str) -> float:
        return percent(self.energy(PRINCE), self.energy(other))


def between(what: str, least: float, most: float, value: object) -> Required:
    return Required(what, value, least, most)  # type: ignore[arg-type]


def required() -> list[Required]:
    fixes = [("centroid of three", 9.34, 0.4)]
    fixes += [("DM 4, cases", 5.42, 0.28), ("DM 8, cases", 4.00, 0.20), ("DM 40, cases", 3.33, 0.20)]
    fixes += [("DM 4", 5.13, 0.26), ("DM 8", 3.76, 0.19), ("DM 40", 3.14, 0.19)]
    rows = [
        between(f"{name}: error of a fix, m", round(m - off, 2), round(m + off, 2), lambda f, n=name: f.fix(n))
        for name, m, off in fixes
    ]
    return [
        *rows,
        between("default: error of a fix, m", 1.70, 1.97, lambda f: f.fix("default")),
        between("default: over the Cramér-Rao bound of all nodes", 0.95, 1.15, lambda f: f.fix("default", "rmse_over_crlb")),
        between("prince: messages a fix", 3.25, 3.75, lambda f: f.energy(PRINCE)),
        between("competition: messages a fix", 6.0, 6.75, lambda f: f.energy(COMPETITION)),
        between("timestamp: messages a fix", 4.6, 5.3, lambda f: f.energy(TIMESTAMP)),
        between("prince saves against competition, %", 44, 55, lambda f: f.saved(COMPETITION)),
        between("prince saves against timestamps, %", 28, 42, lambda f: f.saved(TIMESTAMP)),
        between("prince: error of a fix, m", 3.1, 4.1, lambda f: f.energy(PRINCE, FIX)),
        at_most("straight way, 34 cells a side: lost, first 20 runs", 0, lambda f: f.first_lost(34)),
        at_most("straight way, 26 cells a side: lost, first 20 runs", 0, lambda f: f.first_lost(26)),
        at_most("straight way, 26 cells a side: lost, all runs", 0.05, lambda f: f.energy(PRINCE, LOST, 26)),
        at_most("turn of 90 degrees: lost", 0, lambda f: f.turn(GUARDED, LOST, 90)),
        at_most("turn of 90 degrees: longest gap, m", 95, lambda f: f.turn(GUARDED, GAP, 90)),
        at_most("turn of 150 degrees: lost", 0, lambda f: f.turn(GUARDED, LOST, 150)),
        at_most("turn of 150 degrees: longest gap, m", 105, lambda f: f.turn(GUARDED, GAP, 150)),
        at_least("turn of 90 degrees, published rules alone: lost", 0.55, lambda f: f.turn(BARE, LOST, 90)),
        at_least("turn of 150 degrees, published rules alone: lost", 0.55, lambda f: f.turn(BARE, LOST, 150)),
        at_most("20 % of the frames lost: targets lost", 0.05, lambda f: f.loss(LOST, 0.2)),
        at_most("20 % of the frames lost: messages a fix", 7.7, lambda f: f.loss(MESSAGES, 0.2)),
        at_most("20 % of the frames lost: fixes with two heads", 0.025, lambda f: f.loss("double_heads", 0.2)),
        at_least("two 60 m apart, shares as published: success", 0.85, lambda f: f.sparse(PAIR, SHARES, SUCCESS, 60)),
        at_least("two 30 m apart, joint fit: success", 0.90, lambda f: f.sparse(PAIR, JOINT, SUCCESS, 30)),
        between("two 30 m apart, joint fit: error, m", 1.5, 2.4, lambda f: f.sparse(PAIR, JOINT, FIX, 30)),
        at_least("two 20 m apart, joint fit: success", 0.75, lambda f: f.sparse(PAIR, JOINT, SUCCESS, 20)),
        at_least("three 40 m apart, joint fit: success", 0.90, lambda f: f.sparse(THREE, JOINT, SUCCESS, 40)),
        at_most(
            "crossing at 90 degrees, joint fit: exchanged",
            0.1,
            lambda f: f.mean("han_sparse", CROSSING, JOINT, SWAPS, **axis(ANGLE, 90)),
        ),
        at_least(
            "nearly meeting at 40 degrees, joint fit: told that it cannot tell",
            0.95,
            lambda f: f.mean("han_sparse", BOUNCE, JOINT, "unresolved", **axis(ANGLE, 40)),
        ),
        between("three on a ring of 10 m: error of the centroid, m", 1.2, 2.3, lambda f: f.ring(GROUP)),
        between("three on a ring of 10 m: bias of the extent, m", -6.5, 6.5, lambda f: f.ring("extent_bias_m")),
        at_most("three on a ring of 10 m: spurious splits a minute", 0.1, lambda f: f.ring("spurious_splits_per_min")),
        at_least("three on a ring of 10 m: count right", 0.95, lambda f: f.ring("count_right")),
        at_most("lanes: merged after, s", 7.5, lambda f: f.lanes("merge_delay_s")),
        at_most("lanes: split after, s", 7.5, lambda f: f.lanes("split_delay_s")),
        at_least("lanes: three tracks in the end", 0.95, lambda f: f.lanes("apart_at_end")),
        at_most(
            "two 23 m apart: changes of mode a minute",
            0.8,
            lambda f: f.mean("han_group", STAY, "members", "mode_changes_per_min"),
        ),
        at_most("802.15.4, 10 % lost, asleep: one target lost", 0.02, lambda f: f.mean("han_real", ONE, "default", LOST, **axis(LOSS, 0.1))),
        at_most("802.15.4, 10 % lost, asleep: two exchanged", 0.05, lambda f: f.mean("han_real", TWO, "default", SWAPS, **axis(LOSS, 0.1))),
    ]


def said(value: float | None, digits: int = 3) -> str:
    return "–" if value is None or not np.isfinite(value) else significant(value, digits)


def fixes(f: Targets) -> list[list[str]]:
    return [
        [name, said(thesis), said(other), *(said(f.fix(name, FIX, panel)) for panel in (NOISY, ADDITIVE, CLEAN))]
        for name, (thesis, other) in TABLE_2_1.items()
    ]


def energies(f: Targets) -> list[list[str]]:
    rows = []
    for cells, p in COVERAGE.items():
        row = [f"{p:.3f}"]
        for i, series in enumerate((PRINCE, COMPETITION, TIMESTAMP)):
            other = INDEPENDENT[cells][i] if cells in INDEPENDENT else None
            row += [f"{said(f.energy(series, MESSAGES, cells))} ({said(FORMULAS[series](p))}; {said(other)})"]
        rows.append(row + [said(f.energy(series, ALL, cells)) for series in (PRINCE, COMPETITION, TIMESTAMP)])
    return rows


def real(f: Targets) -> list[list[str]]:
    rows = []
    for panel in (ONE, TWO, "(c) two, 120 m apart"):
        for share in (0, 0.1, 0.2):
            at = axis(LOSS, share)
            values = [f.mean("han_real", panel, "default", metric, **at) for metric in (LOST, SWAPS, FIX, MESSAGES)]
            rows.append([panel.partition(") ")[2], f"{100 * share:g} %", *(said(v) for v in values)])
    return rows


def claims(f: Targets) -> list[Claim]:
    all_but = [percent(f.energy(PRINCE, ALL), f.energy(other, ALL)) for other in (COMPETITION, TIMESTAMP)]
    thin, dense = f.energy(COMPETITION, MESSAGES, 24), f.energy(COMPETITION)
    return [
        Claim(
            "where three nodes hear the target, the prince saves 50 % against competition and 40 % against timestamps",
            f"{f.saved(COMPETITION):.0f} % and {f.saved(TIMESTAMP):.0f} %; counting announcements, hand-overs and failures, "
            f"which every protocol sends, {all_but[0]:.0f} % and {all_but[1]:.0f} %",
            None,
        ),
        Claim(
            "competition gets cheaper as the coverage falls, (2-14)",
            f"{thin:.2f} messages a fix at a coverage of 0.65, {dense:.2f} at 1: attempts that fail, which it leaves out, cost more",
            thin < dense,
        ),
        Claim(
            "the exception finds targets that turn",
            f"with the published rules alone {100 * f.turn(BARE, LOST, 90):.0f} % are lost at 90 degrees and "
            f"{100 * f.turn(BARE, LOST, 150):.0f} % at 150; with all guards {100 * f.turn(GUARDED, LOST, 90):.0f} % "
            f"and {100 * f.turn(GUARDED, LOST, 150):.0f} %",
            f.turn(BARE, LOST, 90) < 0.1,
        ),
        Claim(
            "targets can be told apart by their shares in the energy",
            f"success {f.sparse(PAIR, SHARES, SUCCESS, 60):.2f} at 60 m, {f.sparse(PAIR, SHARES, SUCCESS, 40):.2f} at 40 m; the joint "
            f"fit {f.sparse(PAIR, JOINT, SUCCESS, 40):.2f} at 40 m, {f.sparse(PAIR, JOINT, SUCCESS, 20):.2f} at 20 m",
            None,
        ),
    ]


def draw_energy(f: Targets, metric: str, with_formulas: bool) -> str:
    """Fig. 2-13 and 2-14: messages over the share of the field that three nodes cover."""
    figure, axes = pyplot.subplots(figsize=(6.2, 3.7))
    p = np.array(list(COVERAGE.values()))
    for colour, series in zip(COLOURS, (PRINCE, COMPETITION, TIMESTAMP)):
        axes.plot(p, [f.energy(series, metric, cells) for cells in COVERAGE], "o-", color=colour, ms=4, label=series)
        if with_formulas:
            axes.plot(p, FORMULAS[series](p), "--", color=colour, lw=1, label=f"{series}, formula")
    axes.set_xlabel("share of the field that three nodes cover")
    axes.set_ylabel("messages a fix")
    axes.set_ylim(bottom=0)
    axes.legend(fontsize=8)
    return svg_text(figure)


def page(tables: dict[str, Table]) -> str:
    figures = Targets(tables)
    environment = Environment(
        loader=PackageLoader("motehound_tools"), undefined=StrictUndefined, keep_trailing_newline=True
    )
    return environment.get_template("han.md.j2").render(
        version=tables["han_table21"].version,
        runs=f"{sum(len(table.columns['seed']) for table in tables.values()):,}",
        required=markdown([one.row(figures) for one in required()]),  # type: ignore[arg-type]
        fixes=markdown(fixes(figures)),
        energies=markdown(energies(figures)),
        claims=markdown([claim.row() for claim in claims(figures)]),
        real=markdown(real(figures)),
    )


def write(program: str | None, out: Path, file: Path, seeds: str | None) -> None:
    tables = {}
    for experiment in sorted((ROOT / "experiments").glob("han_*.yaml"), key=natural):
        tables[experiment.stem] = Table.read(sweep.run(experiment, out / experiment.stem, seeds, named_program=program))
    images = file.parent / "images"
    images.mkdir(parents=True, exist_ok=True)
    for name, (experiment_name, which) in IMAGES.items():
        drawn = sweep_figures.pictures(tables[experiment_name])[which]
        (images / f"{name}.svg").write_text(drawn.picture.svg, encoding="utf-8")
    figures = Targets(tables)
    (images / "han_fig2_13.svg").write_text(draw_energy(figures, MESSAGES, True), encoding="utf-8")
    (images / "han_fig2_14.svg").write_text(draw_energy(figures, ALL, False), encoding="utf-8")
    file.write_text(page(tables), encoding="utf-8")
