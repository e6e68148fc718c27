"""The posterior Cramer-Rao bound of following the source: how well any unbiased tracker could do.

Unknown are the positions of the source at the sampling instants (straight in between) and ln mu, known is the rest.
Every reading of every node up to the instant counts (Luo, Eq. (1)-(2), exact), and a random acceleration of a stated
standard deviation is the prior of the path. The bound of instant l is the trace of the position's block of the inverse
information after l samples. It is evaluated along the one path of the scenario, so it is a yardstick rather than a
limit: a tracker whose prior fits that path better may come out below it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from .field import ages
from .scenario import Array, Scenario

ANYWHERE_SD_M = 1e3  # of a position of which nothing is known
START_SD_M = 3.0  # of the first position and, per interval, of the first step
RELEASE_SD_LN = 1.0  # of ln mu
BLOCK = 256  # nodes worked on at a time, so that they stay in the cache
FLOOR = 1e-3  # g/m2: standard deviation that every reading has at least


@dataclass(frozen=True)
class Bound:
    """sqrt(trace) of the position's bound, m, at every sampling instant after the first."""

    time: Array
    sd: Array
    heard: NDArray[
        np.bool_
    ]  # whether readings came at that instant; where none did, a tracker has no position to be judged by

    def rms(self, skip: int = 3) -> float:
        return float(np.sqrt(np.mean(self.sd[skip:][self.heard[skip:]] ** 2)))

    def median(self, skip: int = 3) -> float:
        return float(np.median(self.sd[skip:][self.heard[skip:]]))


def sensitivities(scenario: Scenario, nodes: Array, knots: Array, last: int) -> tuple[Array, Array]:
    """C at the nodes at the instant knots[last], and its derivatives [node][knot, axis] by the knots 0..last."""
    route, diffusion, time = scenario.route, scenario.number("source.diffusion_m2ps"), float(knots[last])
    age, weight = ages(scenario, time, np.union1d(route.breaks, knots[:last]))
    born = time - age
    origin = route.position(born)
    strength = weight * scenario.release(born) / (4.0 * np.pi * diffusion * age)
    # A point of the path between two knots moves with both of them, by linear interpolation.
    segment = np.clip(np.searchsorted(knots, born, side="right") - 1, 0, last - 1)
    share = (born - knots[segment]) / (knots[segment + 1] - knots[segment])
    starts = np.flatnonzero(np.diff(segment, prepend=-1))
    owner = segment[starts]
    level = np.empty(len(nodes))
    gradient = np.zeros((len(nodes), last + 1, 2))
    for first in range(0, len(nodes), BLOCK):
        rows = slice(first, first + BLOCK)
        offsets = [nodes[rows, None, axis] - origin[:, axis] for axis in (0, 1)]
        kernel = np.exp(-(offsets[0] ** 2 + offsets[1] ** 2) / (4.0 * diffusion * age)) * strength
        level[rows] = kernel.sum(axis=1)
        kernel /= 2.0 * diffusion * age
        for axis, offset in enumerate(offsets):
            pull = kernel * offset
            gradient[rows, owner + 1, axis] += np.add.reduceat(pull * share, starts, axis=1)
            gradient[rows, owner, axis] += np.add.reduceat(pull * (1.0 - share), starts, axis=1)
    return level, gradient


def reading_information(scenario: Scenario, level: Array) -> Array:
    """Fisher information about C of one reading at concentration C: mean and variance of the noise both tell of it."""
    relative = scenario.number("sensor.relative_noise")
    bits = int(scenario.number("sensor.adc_bits"))
    step = scenario.number("sensor.full_scale") / 2.0**bits if bits > 0 else 0.0
    floor = max(scenario.number("sensor.additive_noise"), step / np.sqrt(12.0))
    variance = (relative * level) ** 2 + max(floor, FLOOR) ** 2
    return 1.0 / variance + 2.0 * relative**4 * level**2 / variance**2


def motion_information(count: int, interval: float, acceleration: float | None) -> Array:
    """Information of the prior about one axis of the knots [count][count]; the start alone without `acceleration`."""
    information = np.eye(count) * ANYWHERE_SD_M**-2
    information[0, 0] = START_SD_M**-2
    if acceleration is not None:
        if count > 1:
            step = np.array([-1.0, 1.0]) / (START_SD_M * interval)
            information[:2, :2] += np.outer(step, step)
        bend = np.array([1.0, -2.0, 1.0]) / (acceleration * interval**2)
        for k in range(count - 2):
            information[k : k + 3, k : k + 3] += np.outer(bend, bend)
    return information


def bounds(scenario: Scenario, nodes: Array, accelerations: tuple[float | None, ...]) -> list[Bound]:
    """One bound for each standard deviation of the acceleration, m/s2 (None: no prior of the motion)."""
    interval = scenario.number("sensor.interval_s")
    knots: Array = np.arange(np.floor(scenario.route.end / interval + 1e-9) + 1.0, dtype=np.float64) * interval
    kept = 1.0 - scenario.number("sensor.loss")
    since_outage = knots - scenario.number("sensor.outage_start_s")
    heard = (since_outage < 0.0) | (since_outage >= scenario.number("sensor.outage_s"))
    size = 1 + 2 * len(knots)  # ln mu, then x and y of each knot
    information = np.zeros((size, size))
    information[0, 0] = RELEASE_SD_LN**-2
    variance = np.zeros((len(accelerations), len(knots)))
    for last in range(1, len(knots)):
        used = 1 + 2 * (last + 1)
        if heard[last]:
            level, gradient = sensitivities(scenario, nodes, knots, last)
            rows = np.concatenate([level[:, None], gradient.reshape(len(nodes), -1)], axis=1)
            rows *= np.sqrt(kept * reading_information(scenario, level))[:, None]
            information[:used, :used] += rows.T @ rows
        for which, acceleration in enumerate(accelerations):
            total = information[:used, :used].copy()
            prior = motion_information(last + 1, interval, acceleration)
            total[1::2, 1::2] += prior
            total[2::2, 2::2] += prior
            scale = 1.0 / np.sqrt(np.diag(total))  # unit diagonal: the digits are kept where there is no motion prior
            newest = np.zeros((used, 2))
            newest[-2, 0] = newest[-1, 1] = 1.0
            scaled = cho_factor(total * scale * scale[:, None] + 1e-13 * np.eye(used))
            solved = cho_solve(scaled, newest * scale[:, None]) * scale[:, None]
            variance[which, last] = solved[-2, 0] + solved[-1, 1]
    return [Bound(knots[1:], np.sqrt(v[1:]), heard[1:]) for v in variance]


YARDSTICKS: tuple[float | None, ...] = (None, 0.5, 0.05)


def over_deployments(scenario: Scenario, seeds: int) -> dict[str, dict[str, float]]:
    """Root mean square and median over the instants and the deployments 0 ... seeds - 1, by the acceleration prior."""
    each = [bounds(scenario, scenario.nodes(seed), YARDSTICKS) for seed in range(seeds)]
    found = {}
    for which, acceleration in enumerate(YARDSTICKS):
        of_all = [bound[which] for bound in each]
        found["none" if acceleration is None else f"{acceleration:g}"] = {
            "rms_m": float(np.sqrt(np.mean([b.rms() ** 2 for b in of_all]))),
            "median_m": float(np.mean([b.median() for b in of_all])),
        }
    return found
