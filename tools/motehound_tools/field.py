"""The concentration of a moving line source (Luo, Eq. (1)-(2)), integrated over the age of what was released.

Written independently of the simulator, so that each checks the other.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from .scenario import Array, Scenario

_FINE, _COARSE = np.polynomial.legendre.leggauss(6), np.polynomial.legendre.leggauss(3)
_YOUNGEST_S = 1e-7  # less age than this adds nothing off the source point


def ages(scenario: Scenario, time: float, breaks: Array) -> tuple[Array, Array]:
    """Nodes and weights of a Gauss rule over the ages (0, time].

    Panels end at `breaks` (times, such as corners of the path) and are short beside the age itself and beside the age
    in which the source leaves its own cloud behind, so that each panel's integrand is smooth.
    """
    diffusion = scenario.number("source.diffusion_m2ps")
    speed = max(scenario.route.top_speed, 1e-9)
    period = scenario.number("source.release_period_s") if scenario.number("source.release_variation") else np.inf
    edges = [_YOUNGEST_S]
    ends = np.unique(time - breaks[breaks < time - _YOUNGEST_S])
    for end in np.unique(np.concatenate([ends, [time]])):
        while edges[-1] < end:
            age = edges[-1]
            step = min(age, 3.0 * np.sqrt(diffusion * age) / speed, period / 8.0)
            edges.append(end if age + 1.2 * step > end else age + step)
    points, weights = [], []
    for start, end in pairwise(edges):
        half = (end - start) / 2.0
        smooth = 5.0 * half < min(start, np.sqrt(diffusion * start) / speed, period / 8.0)
        rule = _COARSE if smooth else _FINE
        points.append(start + half + half * rule[0])
        weights.append(half * rule[1])
    return np.concatenate(points), np.concatenate(weights)


def concentration(scenario: Scenario, places: Array, time: float) -> Array:
    """C at `places` ([n][x, y]) and `time`, g/m2."""
    if time <= _YOUNGEST_S:
        return np.zeros(len(places))
    route, diffusion = scenario.route, scenario.number("source.diffusion_m2ps")
    age, weight = ages(scenario, time, route.breaks)
    born = time - age
    present = born <= route.end
    age, weight, born = age[present], weight[present], born[present]
    origin = route.position(born)
    strength = weight * scenario.release(born) / (4.0 * np.pi * diffusion * age)
    total = np.zeros(len(places))
    for start in range(0, len(places), 4096):  # bounds the memory of the places x ages table
        block = places[start : start + 4096]
        distance2 = (block[:, None, 0] - origin[:, 0]) ** 2 + (block[:, None, 1] - origin[:, 1]) ** 2
        total[start : start + 4096] = np.exp(-distance2 / (4.0 * diffusion * age)) @ strength
    return total
