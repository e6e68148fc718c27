"""Runs the experiments zhang_* and sets their figures beside what they should be, and beside what the paper claims."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from . import sweep, sweep_figures
from .command import ROOT
from .report import natural
from .scenario import Array
from .sweep_figures import Table
from .xu import Required, at_least, at_most
from .zhou import Claim, Figures, axis, markdown, significant

IMAGES = {  # file: experiment and the number of its figure
    "zhang_good": ("zhang_fig4", 0),
    "zhang_fair": ("zhang_fig4", 1),
    "zhang_bad": ("zhang_fig4", 2),
    "zhang_sensors": ("zhang_fig5", 0),
    "zhang_error": ("zhang_fig6", 0),
    "zhang_error_fair": ("zhang_fig6", 3),
    "zhang_consistency": ("zhang_fig6", 1),
    "zhang_rate": ("zhang_fig7", 0),
    "zhang_air": ("zhang_air", 0),
    "zhang_wind": ("zhang_air", 2),
    "zhang_radio": ("zhang_air", 4),
    "zhang_loss": ("zhang_real", 2),
    "zhang_dead": ("zhang_real", 4),
}
GOOD, FAIR, BAD = "(a) good sensors, 3e-6", "(b) fair sensors, 1e-4", "(c) bad sensors, 1.73e-3"
AIR = "(a) wind taken for 25 % too strong and 10 degrees off"
EKF, UKF, BETTER, SMALL, DEFAULT = "EKF", "UKF", "UKF, α = 0.5, β = 2", "small", "default"
FOUND, WRONG, ENDED, ERROR, RATE = "success_50m", "converged_wrong", "converged", "position_error_median_m", "rate_error_median"
# ended, found, median error m, median error of the rate, heads, sensors, error over bound, NEES, sensors to 10 m
# of an independent implementation, 100 deployments
INDEPENDENT: dict[tuple[str, str], tuple[float, ...]] = {
    (GOOD, EKF): (0.986, 0.428, 113, 0.45, 10.7, 32, 4.7, 2e5, 35),
    (GOOD, UKF): (1, 0.993, 0.184, 0.0012, 7.0, 36, 1.8, 3.2, 19),
    (GOOD, BETTER): (1, 0.998, 0.158, 0.0011, 6.9, 36, 1.3, 2.9, 19),
    (GOOD, SMALL): (1, 1, 0.375, 0.0015, 5.7, 33, 1.06, 2.4, 13),
    (GOOD, DEFAULT): (1, 1, 0.351, 0.0014, 5.8, 34, 1.02, 2.2, 13),
    (FAIR, EKF): (0.993, 0.821, 2.7, 0.034, 12.3, 43, 3.1, 41, 38),
    (FAIR, UKF): (1, 0.960, 0.85, 0.0125, 10.9, 44, 2.0, 4.6, 37),
    (FAIR, BETTER): (1, 0.975, 0.68, 0.0106, 10.9, 44, 1.7, 3.6, 36),
    (FAIR, SMALL): (1, 0.979, 0.55, 0.0085, 11.5, 53, 1.4, 3.1, 42),
    (FAIR, DEFAULT): (1, 1, 0.477, 0.0071, 12.0, 55, 1.03, 2.5, 42),
    (BAD, EKF): (0.996, 0.38, 99, 0.40, 17, 44),
    (BAD, UKF): (0.958, 0.36, 138, 0.49, 27, 44),
    (BAD, BETTER): (0.992, 0.40, 93, 0.37, 19, 44),
    (BAD, DEFAULT): (0.80, 0.80, 3.5, 0.063, 32, 68, 1.1, 2.6),
}


class Searches(Figures):
    """Shares, means and medians over the searches."""

    def median(self, name: str, panel: str, series: str, metric: str, **at: float) -> float:
        values = self.known(name, panel, series, metric, **at)
        return float(np.median(values)) if len(values) else float("nan")

    def known(self, name: str, panel: str, series: str, metric: str, **at: float) -> Array:
        values = self.of(name, panel, series, metric, **at)
        return values[np.isfinite(values)]

    def over_bound(self, panel: str, series: str) -> float:
        """Root mean square over the searches that succeed, each at most 5."""
        values = self.known("zhang_fig4", panel, series, "error_over_crlb")
        return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")

    def found(self, panel: str, series: str) -> float:
        return self.mean("zhang_fig4", panel, series, FOUND)

    def of_search(self, panel: str, series: str) -> list[float]:
        """In the order of INDEPENDENT."""
        place = ("zhang_fig4", panel, series)
        means = [self.mean(*place, metric) for metric in (ENDED, FOUND)]
        medians = [self.median(*place, metric) for metric in (ERROR, RATE)]
        counts = [self.mean(*place, metric) for metric in ("hops", "sensors_used")]
        last = [self.over_bound(panel, series), self.median(*place, "nees_median"), self.median(*place, "sensors_to_10m")]
        return [*means, *medians, *counts, *last]


def between(what: str, least: float, most: float, value: object) -> Required:
    return Required(what, value, least, most)  # type: ignore[arg-type]


def required() -> list[Required]:
    rows = [
        at_least("good sensors, UKF: success", 0.95, lambda f: f.found(GOOD, UKF)),
        between("good sensors, EKF: success", 0.30, 0.53, lambda f: f.found(GOOD, EKF)),
        at_least("good sensors: UKF less EKF", 0.40, lambda f: f.found(GOOD, UKF) - f.found(GOOD, EKF)),
        at_least("fair sensors, UKF: success", 0.88, lambda f: f.found(FAIR, UKF)),
        between("fair sensors, EKF: success", 0.70, 0.90, lambda f: f.found(FAIR, EKF)),
        between("good sensors, UKF: sensors until 10 m, median", 17, 21, lambda f: f.of_search(GOOD, UKF)[8]),
        at_least("good sensors, EKF: sensors until 10 m, median", 30, lambda f: f.of_search(GOOD, EKF)[8]),
        between("good sensors, UKF: heads", 6.6, 7.4, lambda f: f.of_search(GOOD, UKF)[4]),
    ]
    for name, panel, least, most in (("good", GOOD, 0.25, 0.47), ("fair", FAIR, 0.30, 0.70)):
        rows += [
            at_least(f"{name} sensors, default: success", 0.99, lambda f, p=panel: f.found(p, DEFAULT)),
            between(f"{name} sensors, default: error over the bound", 0.9, 1.2, lambda f, p=panel: f.over_bound(p, DEFAULT)),
            between(f"{name} sensors, default: median NEES", 2.0, 2.9, lambda f, p=panel: f.of_search(p, DEFAULT)[7]),
            between(f"{name} sensors, default: median error, m", least, most, lambda f, p=panel: f.of_search(p, DEFAULT)[2]),
        ]
    wrong = axis("source.fluctuation", 0.3)
    return [
        *rows,
        at_least("bad sensors, default: success", 0.60, lambda f: f.found(BAD, DEFAULT)),
        at_most("bad sensors, default: ended, but wrong", 0.03, lambda f: f.mean("zhang_fig4", BAD, DEFAULT, WRONG)),
        at_least("other air than it thinks, default: success", 0.97, lambda f: f.mean("zhang_air", AIR, DEFAULT, FOUND, **wrong)),
        *(
            at_most(
                f"{name} sensors, {series}: what 10 % of frame loss changes",
                0.03,
                lambda f, p=panel, s=series: abs(
                    f.mean("zhang_real", p, s, FOUND, **axis("radio.loss", 0.1))
                    - f.mean("zhang_real", p, s, FOUND, **axis("radio.loss", 0))
                ),
            )
            for name, panel in (("good", GOOD), ("fair", FAIR))
            for series in (UKF, SMALL, DEFAULT)
        ),
    ]


def both(measured: float, other: float | None) -> str:
    if not np.isfinite(measured):
        return "–"
    said = f"{measured:.1e}" if measured >= 1e4 else significant(measured, 3)
    return said if other is None else f"{said} ({other:g})"


def searches(f: Searches) -> list[list[str]]:
    rows = []
    for panel in (GOOD, FAIR, BAD):
        for series in (EKF, UKF, BETTER, SMALL, DEFAULT):
            other = INDEPENDENT.get((panel, series), ())
            values = f.of_search(panel, series)
            cells = [both(v, other[i] if i < len(other) else None) for i, v in enumerate(values)]
            rows.append([panel.partition("sensors, ")[2], series, *cells])
    return rows


def claims(f: Searches) -> list[Claim]:
    """The paper's claims in its order."""
    ended = {s: [f.mean("zhang_fig4", p, s, ENDED) for p in (GOOD, FAIR, BAD)] for s in (UKF, EKF)}
    right = {s: [f.found(p, s) for p in (GOOD, FAIR, BAD)] for s in (UKF, EKF)}
    means = {s: [f.mean("zhang_fig4", p, s, ERROR) for p in (GOOD, FAIR, BAD)] for s in (UKF, EKF)}
    rates = {s: [f.median("zhang_fig4", p, s, RATE) for p in (GOOD, FAIR, BAD)] for s in (UKF, EKF)}
    sensors = {s: f.of_search(GOOD, s)[8] for s in (UKF, EKF)}
    heads = {s: f.of_search(GOOD, s)[4] for s in (UKF, EKF)}
    after = axis("protocol.heads_max", 8)
    late = {s: f.median("zhang_fig6", GOOD, s, ERROR, **after) for s in (UKF, EKF, DEFAULT)}

    def said(values: dict[str, list[float]], form: str) -> str:
        return "; ".join(f"{s} " + ", ".join(format(v, form) for v in of) for s, of in values.items())

    return [
        Claim(
            "the UKF succeeds more often (a search succeeds that ends within five minutes)",
            f"with good, fair and bad sensors by that account {said(ended, '.3f')}; ended and right {said(right, '.3f')}",
            None,
        ),
        Claim(
            "the mean error of the UKF is smaller",
            f"m, of all searches with good, fair and bad sensors: {said(means, '.3g')}",
            None if means[UKF][2] > means[EKF][2] and means[UKF][0] < means[EKF][0] else means[UKF][0] < means[EKF][0],
        ),
        Claim(
            "so is that of the rate of release",
            f"medians, share of the rate: {said(rates, '.2g')}",
            None if rates[UKF][2] > rates[EKF][2] else rates[UKF][0] < rates[EKF][0],
        ),
        Claim(
            "the UKF uses fewer nodes, and its way is shorter",
            f"good sensors: {sensors[UKF]:.0f} sensors until the error stays below 10 m and {heads[UKF]:.1f} heads in all, the EKF "
            f"{sensors[EKF]:.0f} and {heads[EKF]:.1f}",
            sensors[UKF] < sensors[EKF] and heads[UKF] < heads[EKF],
        ),
        Claim(
            "after some 20 nodes the UKF's estimate changes little",
            f"{sensors[UKF]:.0f} nodes, median (the default {f.of_search(GOOD, DEFAULT)[8]:.0f})",
            17 <= sensors[UKF] <= 23,
        ),
        Claim(
            "the EKF converges slowly, to a larger error",
            f"after 8 heads the median error is {late[EKF]:.3g} m, the UKF's {late[UKF]:.2g} m, the default's {late[DEFAULT]:.2g} m",
            late[EKF] > 10 * late[UKF],
        ),
    ]


def over_the_air(f: Searches) -> list[list[str]]:
    rows = []
    for name, panel in (("good", GOOD), ("fair", FAIR)):
        for series in (EKF, UKF, SMALL, DEFAULT):
            ideal = f.found(panel, series)
            losses = [f.mean("zhang_real", panel, series, FOUND, **axis("radio.loss", p)) for p in (0, 0.1, 0.3)]
            frames = f.mean("zhang_real", panel, series, "frames_sent", **axis("radio.loss", 0.1))
            tokens = f.mean("zhang_real", panel, series, "frames_sent_hand_overs", **axis("radio.loss", 0.1))
            rows.append([name, series, f"{ideal:.3f}", *(f"{v:.3f}" for v in losses), f"{frames:,.0f}", f"{tokens:,.0f}"])
    return rows


def deaths(f: Searches) -> list[list[str]]:
    rows = []
    for share in (0.1, 0.2, 0.3):
        place = ("zhang_real", "(c) nodes die, fair sensors", DEFAULT)
        at = axis("faults.dead_share", share)
        metrics = (FOUND, WRONG, "searches_resumed", "searches_sent_for", "tokens_refused")
        values = [f.mean(*place, metric, **at) for metric in metrics]
        rows.append([f"{100 * share:.0f} %", *(f"{v:.2f}" for v in values)])
    return rows


def page(tables: dict[str, Table]) -> str:
    figures = Searches(tables)
    environment = Environment(
        loader=PackageLoader("motehound_tools"), undefined=StrictUndefined, keep_trailing_newline=True
    )
    return environment.get_template("zhang.md.j2").render(
        version=tables["zhang_fig4"].version,
        seeds=len(tables["zhang_fig4"].experiment.seeds),
        runs=f"{sum(len(table.columns['seed']) for table in tables.values()):,}",
        required=markdown([one.row(figures) for one in required()]),  # type: ignore[arg-type]
        searches=markdown(searches(figures)),
        claims=markdown([claim.row() for claim in claims(figures)]),
        over_the_air=markdown(over_the_air(figures)),
        deaths=markdown(deaths(figures)),
    )


def write(program: str | None, out: Path, file: Path, seeds: str | None) -> None:
    tables = {}
    for experiment in sorted((ROOT / "experiments").glob("zhang_*.yaml"), key=natural):
        tables[experiment.stem] = Table.read(sweep.run(experiment, out / experiment.stem, seeds, named_program=program))
    images = file.parent / "images"
    images.mkdir(parents=True, exist_ok=True)
    for name, (experiment_name, which) in IMAGES.items():
        drawn = sweep_figures.pictures(tables[experiment_name])[which]
        (images / f"{name}.svg").write_text(drawn.picture.svg, encoding="utf-8")
    file.write_text(page(tables), encoding="utf-8")
