"""Runs the experiments xu_* and sets their figures beside what they should be, and beside what the paper claims."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from . import sweep, sweep_figures
from .command import ROOT
from .experiment import Panel, Quantity
from .report import natural
from .sweep_figures import Table
from .zhou import Claim, Figures, axis, markdown, percent, significant, verdict

RMSE, ANEES, CLAIMED, PCRB = "position_rmse_m", "anees", "claimed_over_rmse", "pcrb_m"
IMAGES = {  # file: experiment and the number of its figure
    "xu_fused": ("xu_fig4", 0),
    "xu_poor_start": ("xu_fig5", 1),
    "xu_starts": ("xu_fig5", 3),
    "xu_rates": ("xu_fig6", 0),
    "xu_rules": ("xu_fig7", 1),
    "xu_consistency": ("xu_fig7", 2),
    "xu_correlation": ("xu_correlation", 0),
    "xu_correlation_error": ("xu_correlation", 1),
    "xu_shared": ("xu_correlation", 2),
    "xu_loss": ("xu_reports", 0),
    "xu_real": ("xu_real", 0),
    "xu_real_loss": ("xu_real", 3),
}
CI, OPTIMAL, DETERMINANT = "CI by traces (Eq. 32)", "CI of least trace (Eq. 31)", "CI of least determinant"
SCI, ICI, EI, HIF, FEEDBACK = "split CI", "inverse CI", "ellipsoidal intersection", "HIF", "HIF with feedback"
NAIVE, CENTRAL = "naive", "one UKF with all sensors"
# RMSE after 10 s, SMSE, ANEES and claimed over true RMSE of an independent implementation, 1,000 runs
INDEPENDENT = {
    CI: (0.0541, 5.62, 2.40, 1.54),
    OPTIMAL: (0.0572, 5.9, 2.7, 1.33),
    DETERMINANT: (0.0616, 6.3, 2.9, 1.27),
    SCI: (0.0507, 5.23, 3.69, 1.04),
    ICI: (0.0545, 5.6, 3.1, 1.19),
    EI: (0.0573, 5.9, 4.0, 1.02),
    HIF: (0.0474, 4.92, 3.99, 1.00),
    FEEDBACK: (0.0474, 4.92, 3.99, 1.00),
    NAIVE: (0.0513, 5.31, 8.8, 0.82),
    CENTRAL: (0.0474, 4.92, 3.99, 1.00),
}
LOCAL = (0.179, 0.146, 0.119, 0.182)
WELL, POOR, SMALL, POORER, POOREST = (
    "(a) start known to 1 m and 0.2 m/s",
    "(b) start known to 10 m and 1 m/s",
    "(c) rings of 5 m, start as in (b)",
    "(e) start known to 20 m and 2 m/s",
    "(f) the same with rings of 5 m",
)
SEVERAL, SLOW, BUDGET, FAST = "several rates", "all slow", "one rate of as many samples", "all fast"
COMMON, SHARED, LOST, RARE = "(a) common noise", "(b) shared border sensors", "(a) lost reports", "(b) reports every 10 s"
AIR, MORE_LOSS = "(a) 5 % of the frames lost", "(b) the more is lost"


class Pooled(Figures):
    """Root mean squares and means over the seeds, as the paper pools its runs."""

    def rms(self, name: str, panel: str, series: str, metric: str = RMSE, **at: float) -> float:
        values = self.of(name, panel, series, metric, **at)
        return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")

    def claimed(self, name: str, panel: str, series: str) -> float:
        """What the estimates claim over what they have, as root mean squares over all runs."""
        rmse = self.of(name, panel, series, RMSE)
        claims = self.of(name, panel, series, CLAIMED) * rmse
        return float(np.sqrt(np.mean(claims**2) / np.mean(rmse**2))) if len(rmse) else float("nan")

    def smse(self, name: str, panel: str, series: str, curve: str = "error_m") -> float:
        """The root mean square error over the runs, added up over all report times."""
        return float(np.sum(self.tables[name].over_time(Panel(title=panel), series, Quantity(metric=curve))[1]))

    def worst(self, name: str, panel: str, series: str) -> float:
        time, value = self.tables[name].over_time(Panel(title=panel), series, Quantity(metric="error_m"))
        return float(np.max(value[time > 10.0])) if len(time) else float("nan")


@dataclass(frozen=True)
class Required:
    """A figure and what it must be."""

    what: str
    value: Callable[[Pooled], float]
    least: float
    most: float

    def row(self, figures: Pooled) -> list[str]:
        value = self.value(figures)
        if self.least == -np.inf:
            said = f"≤ {self.most:g}"
        elif self.most == np.inf:
            said = f"≥ {self.least:g}"
        else:
            said = f"{self.least:g} to {self.most:g}"
        return [self.what, significant(value, 4), said, verdict(self.least <= value <= self.most)]


def at_most(what: str, most: float, value: Callable[[Pooled], float]) -> Required:
    return Required(what, value, -np.inf, most)


def at_least(what: str, least: float, value: Callable[[Pooled], float]) -> Required:
    return Required(what, value, least, np.inf)


def near(what: str, middle: float, off: float, value: Callable[[Pooled], float]) -> Required:
    return Required(what, value, round(middle - off, 6), round(middle + off, 6))


def required() -> list[Required]:
    rule, one = ("xu_fig7", ""), ("xu_fig4", "", "")
    correlated = axis("sensor.noise_correlation", 0.6)
    rows = [
        near("CI: RMSE after 10 s, m", 0.0545, 0.0025, lambda f: f.rms(*rule, CI)),
        near("CI: SMSE, m", 5.64, 0.25, lambda f: f.smse(*rule, CI)),
        at_most("CI: RMSE at the worst time after 10 s, m", 0.1, lambda f: f.worst(*rule, CI)),
        at_most(
            "CI: RMSE over that of the best cluster",
            0.5,
            lambda f: f.rms(*one) / min(f.rms(*one, f"local_{RMSE}_{c}") for c in range(1, 5)),
        ),
        at_most("split CI: RMSE, m", 0.0520, lambda f: f.rms(*rule, SCI)),
        near("HIF: RMSE over one UKF's with all sensors", 1.0, 0.01, lambda f: f.rms(*rule, HIF) / f.rms(*rule, CENTRAL)),
        at_most(
            "HIF: RMSE over the posterior Cramér-Rao bound", 1.06, lambda f: f.rms(*rule, HIF) / f.rms(*rule, HIF, PCRB)
        ),
    ]
    for c in range(1, 5):
        rows.append(
            near(f"cluster {c}: ANEES", 4.0, 0.3, lambda f, c=c: f.mean(*one, f"local_anees_{c}"))  # type: ignore[misc]
        )
    return [
        *rows,
        near("CI: ANEES", 2.43, 0.15, lambda f: f.mean(*rule, CI, ANEES)),
        near("naive: ANEES", 9.0, 0.7, lambda f: f.mean(*rule, NAIVE, ANEES)),
        near("one UKF with all sensors: ANEES", 4.02, 0.25, lambda f: f.mean(*rule, CENTRAL, ANEES)),
        at_most("noise correlated by 0.6, CI: ANEES", 4, lambda f: f.mean("xu_correlation", COMMON, "CI", ANEES, **correlated)),
        at_least(
            "noise correlated by 0.6, one UKF: ANEES",
            5.5,
            lambda f: f.mean("xu_correlation", COMMON, CENTRAL, ANEES, **correlated),
        ),
        at_most(
            "start known to 10 m: SMSE of UKF-CI over EKF-CI",
            0.72,
            lambda f: f.smse("xu_fig5", POOR, "UKF-CI") / f.smse("xu_fig5", POOR, "EKF-CI"),
        ),
        near(
            "several rates over all slow: RMSE of CI",
            0.72,
            0.04,
            lambda f: f.rms("xu_fig6", "", SEVERAL) / f.rms("xu_fig6", "", SLOW),
        ),
        near(
            "several rates over all slow: RMSE of cluster 1",
            0.79,
            0.12,
            lambda f: (
                f.rms("xu_fig6", "", SEVERAL, f"local_{RMSE}_1") / f.rms("xu_fig6", "", SLOW, f"local_{RMSE}_1")
            ),
        ),
    ]


def rules(f: Pooled) -> list[list[str]]:
    """Every rule beside the independent implementation."""
    rows = []
    for name, (rmse, smse, anees, claimed) in INDEPENDENT.items():
        place = ("xu_fig7", "", name)
        measured = (f.rms(*place), f.smse(*place), f.mean(*place, ANEES), f.claimed(*place))
        told = [f"{m:.{d}f} ({w:.{d}f})" for m, w, d in zip(measured, (rmse, smse, anees, claimed), (4, 2, 2, 2))]
        rows.append([name, *told])
    bounds = [(PCRB, "posterior Cramér-Rao bound", 0.0466, 4.84), ("ccrb_m", "bound along the paths", 0.0475, 4.93)]
    for metric, name, rms, smse in bounds:
        found = f.rms("xu_fig4", "", "", metric), f.smse("xu_fig4", "", "", metric)
        rows.append([name, f"{found[0]:.4f} ({rms:.4f})", f"{found[1]:.2f} ({smse:.2f})", "", ""])
    return rows


def clusters(f: Pooled) -> list[list[str]]:
    rows = []
    for c in range(1, 5):
        rmse, bound = (f.rms("xu_fig4", "", "", metric) for metric in (f"local_{RMSE}_{c}", f"local_ccrb_m_{c}"))
        anees = f.mean("xu_fig4", "", "", f"local_anees_{c}")
        rows.append([f"cluster {c}", f"{rmse:.3f} ({LOCAL[c - 1]:.3f})", f"{bound:.3f}", f"{anees:.2f} (3.94 to 3.97)"])
    return rows


def ratio(values: tuple[float, float]) -> str:
    return f"{values[0]:.4f} against {values[1]:.4f} m"


def claims(f: Pooled) -> list[Claim]:
    local = [f.rms("xu_fig4", "", "", f"local_{RMSE}_{c}") for c in range(1, 5)]
    fused = f.rms("xu_fig4", "", "")
    worst, first = f.worst("xu_fig7", "", CI), f.tables["xu_fig7"].over_time(Panel(title=""), CI, Quantity(metric="error_m"))
    start = float(first[1][0])
    well, poor, small = (
        (f.rms("xu_fig5", panel, "UKF-CI"), f.rms("xu_fig5", panel, "EKF-CI")) for panel in (WELL, POOR, SMALL)
    )
    several, slow, budget, fast = (f.rms("xu_fig6", "", name) for name in (SEVERAL, SLOW, BUDGET, FAST))
    alone = [f.rms("xu_fig6", "", name, f"local_{RMSE}_1") for name in (SEVERAL, BUDGET)]
    anees, claimed = f.mean("xu_fig7", "", CI, ANEES), f.claimed("xu_fig7", "", CI)
    return [
        Claim(
            "the fused estimate is better than every cluster's",
            f"{fused:.4f} m against {min(local):.3f} to {max(local):.3f} m: {min(local) / fused:.1f} times better than the best",
            fused < min(local),
        ),
        Claim("its error is below 0.1 m", f"at most {worst:.3f} m after 10 s; {start:.3f} m at the first report", worst < 0.1),
        Claim(
            "unscented filters fuse to less error than extended ones",
            f"from a start known to 1 m {ratio(well)}, no difference; to 10 m {ratio(poor)}; to 10 m with rings of 5 m {ratio(small)}",
            None if poor[0] < poor[1] and abs(well[0] / well[1] - 1.0) < 0.02 else poor[0] < poor[1],
        ),
        Claim(
            "several rates are better than one",
            f"than all at the slowest by {percent(several, slow):.0f} %, with twice the samples; than one rate of as many samples by "
            f"{percent(several, budget):.0f} % (cluster 1 by itself: {percent(alone[0], alone[1]):+.0f} %); all at the fastest is better by "
            f"{percent(fast, several):.0f} %. It is the number of samples, not their rates, that counts",
            None,
        ),
        Claim(
            "covariance intersection is consistent",
            f"mean normalised squared error {anees:.2f} of 4: it claims {claimed:.2f} times the error that it has",
            anees < 4.0,
        ),
    ]


def findings(f: Pooled) -> list[list[str]]:
    """Beyond the paper, beside the independent implementation."""

    def anees(panel: str, series: str, key: str, values: tuple[float, ...]) -> str:
        return ", ".join(f"{f.mean('xu_correlation', panel, series, ANEES, **axis(key, v)):.1f}" for v in values)

    def lost(series: str) -> str:
        return ", ".join(f"{f.rms('xu_reports', LOST, series, **axis('fusion.report_loss', v)):.4f}" for v in (0.2, 0.5))

    def start(panel: str, names: tuple[str, ...]) -> str:
        return ", ".join(f"{f.rms('xu_fig5', panel, name):.3g}" for name in names)

    common, shared = ("sensor.noise_correlation", (0.1, 0.3, 0.6)), ("clusters.shared", (1.0, 3.0))
    error = {s: f.rms("xu_correlation", COMMON, s, **axis(common[0], 0.6)) for s in ("CI", "split CI", "HIF")}
    optimal, traces = f.rms("xu_fig7", "", OPTIMAL), f.rms("xu_fig7", "", CI)
    rare = f.rms("xu_reports", RARE, "HIF") / f.rms("xu_reports", RARE, CENTRAL)
    return [
        ["weights that make the trace least (Eq. 31) raise the error", f"by {100.0 * (optimal / traces - 1.0):.0f} %", "6 %"],
        ["common noise of correlation 0.1, 0.3, 0.6: ANEES of CI", anees(COMMON, "CI", *common), "2.5, 2.7, 2.9"],
        ["of split CI", anees(COMMON, "split CI", *common), "4.1, 4.6, 5.5"],
        ["of HIF", anees(COMMON, "HIF", *common), "4.5, 5.4, 6.8"],
        ["of naive fusion", anees(COMMON, "naive", *common), "9.5, 10.3, 11.6"],
        [
            "at 0.6: RMSE of CI, split CI, HIF, m",
            ", ".join(f"{value:.4f}" for value in error.values()),
            "0.0642, 0.0646, 0.0647",
        ],
        ["1 or 3 sensors of the next cluster heard too: ANEES of CI", anees(SHARED, "CI", *shared), "2.8, 3.0"],
        ["of HIF", anees(SHARED, "HIF", *shared), "5.2, 5.9"],
        ["20 or 50 % of the reports lost: RMSE of CI, m", lost("CI"), "0.0576, 0.0664"],
        ["of HIF, m", lost("HIF"), "0.0506, 0.0591"],
        ["reports every 10 s: HIF's RMSE over one UKF's", f"{rare:.3f}", "about 1"],
        ["... its ANEES", f"{f.mean('xu_reports', RARE, 'HIF', ANEES):.2f}", "4.7"],
        [
            "start known to 20 m and 2 m/s: RMSE of HIF, with feedback, one UKF, m",
            start(POORER, ("UKF-HIF", "UKF-HIF with feedback", CENTRAL)),
            "0.43, 0.104, 0.114",
        ],
        ["with rings of 5 m: of CI, HIF with feedback, m", start(POOREST, ("UKF-CI", "UKF-HIF with feedback")), "29, 0.109"],
    ]


def over_the_air(f: Pooled) -> list[list[str]]:
    rows = []
    for rule in ("CI", "split CI", "HIF", "HIF with feedback"):
        ideal, air = (("xu_real", AIR, f"{rule}, {mode}") for mode in ("ideal", "over the air"))
        rows.append(
            [
                rule,
                f"{f.rms(*ideal):.4f}",
                f"{f.rms(*air):.4f}",
                f"{f.mean(*ideal, ANEES):.2f}",
                f"{f.mean(*air, ANEES):.2f}",
                f"{100.0 * f.mean(*air, 'summaries_taken') / f.mean(*air, 'summaries'):.1f} %",
                f"{f.mean(*air, 'frames_sent'):,.0f}",
                f"{f.rms('xu_real', MORE_LOSS, rule, **axis('radio.loss', 0.4)):.4f}",
            ]
        )
    return rows


def page(tables: dict[str, Table]) -> str:
    figures = Pooled(tables)
    environment = Environment(
        loader=PackageLoader("motehound_tools"), undefined=StrictUndefined, keep_trailing_newline=True
    )
    return environment.get_template("xu.md.j2").render(
        version=tables["xu_fig4"].version,
        seeds=len(tables["xu_fig4"].experiment.seeds),
        runs=f"{sum(len(table.columns['seed']) for table in tables.values()):,}",
        required=markdown([row.row(figures) for row in required()]),
        rules=markdown(rules(figures)),
        clusters=markdown(clusters(figures)),
        claims=markdown([claim.row() for claim in claims(figures)]),
        findings=markdown(findings(figures)),
        over_the_air=markdown(over_the_air(figures)),
    )


def write(program: str | None, out: Path, file: Path, seeds: str | None) -> None:
    tables = {}
    for experiment in sorted((ROOT / "experiments").glob("xu_*.yaml"), key=natural):
        tables[experiment.stem] = Table.read(sweep.run(experiment, out / experiment.stem, seeds, named_program=program))
    images = file.parent / "images"
    images.mkdir(parents=True, exist_ok=True)
    for name, (experiment_name, which) in IMAGES.items():
        drawn = sweep_figures.pictures(tables[experiment_name])[which]
        (images / f"{name}.svg").write_text(drawn.picture.svg, encoding="utf-8")
    file.write_text(page(tables), encoding="utf-8")
