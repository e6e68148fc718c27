"""Cramer-Rao bounds of fixed clusters that follow a target of white acceleration, over time: how well any estimator could
know its position from all ranges so far (Tichavsky, Muravchik and Nehorai, 1998).

    J(k + 1) = (F J(k)^-1 F' + Q)^-1 + E[H' R^-1 H]

The posterior bound has the expectation over many paths, the conditional one the ranges along the path of a run."""

from __future__ import annotations

import numpy as np

from .scenario import Array, Scenario

PATHS = 200


def noise_and_periods(scenario: Scenario) -> tuple[Array, Array]:
    """Of every node the variance of its ranges and the sampling instants between them."""
    variance: list[float] = []
    period: list[float] = []
    every, rates = int(scenario.number("clusters.every")), int(scenario.number("clusters.rates"))
    for size, of_cluster in zip(scenario.value("clusters.nodes"), scenario.value("clusters.range_variance_m2")):
        variance += [of_cluster] * int(size)
        period += [every * (1 + rates * i // int(size)) for i in range(int(size))]
    return np.array(variance), np.array(period)


def motion(scenario: Scenario) -> tuple[Array, Array, Array]:
    """F, Q and the start's covariance, of (x, vx, y, vy)."""
    step = scenario.number("sensor.interval_s")
    transition = np.kron(np.eye(2), [[1.0, step], [0.0, 1.0]])
    gain = np.kron(np.eye(2), [[step**2 / 2.0], [step]])
    acceleration = [scenario.number(f"target.acceleration_{axis}_mps2") ** 2 for axis in "xy"]
    start = [scenario.number("target.position_sd_m") ** 2, scenario.number("target.velocity_sd_mps") ** 2]
    return transition, gain @ np.diag(acceleration) @ gain.T, np.diag(start * 2)


def paths(scenario: Scenario, steps: int, count: int) -> Array:
    """Places [path][instant][x, y] of made-up targets."""
    transition, _, start = motion(scenario)
    step = scenario.number("sensor.interval_s")
    random = np.random.default_rng(0)
    mean = [scenario.number(f"target.{key}") for key in ("x_m", "vx_mps", "y_m", "vy_mps")]
    state = mean + random.standard_normal((count, 4)) * np.sqrt(np.diag(start))
    acceleration = np.array([scenario.number(f"target.acceleration_{axis}_mps2") for axis in "xy"])
    found = np.empty((count, steps + 1, 2))
    for k in range(steps + 1):
        found[:, k] = state[:, ::2]
        kick = random.standard_normal((count, 2)) * acceleration
        state = state @ transition.T
        state[:, ::2] += step**2 / 2.0 * kick
        state[:, 1::2] += step * kick
    return found


def bound(scenario: Scenario, nodes: Array, places: Array) -> Array:
    """Root of the position's bound, m, at every sampling instant of `places` [path][instant][x, y], which are averaged over."""
    transition, blur, covariance = motion(scenario)
    variance, period = noise_and_periods(scenario)
    found = np.empty(places.shape[1])
    for k in range(places.shape[1]):
        if k > 0:
            covariance = transition @ covariance @ transition.T + blur
            due = k % period == 0
            towards = places[:, k, None, :] - nodes[due]
            towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
            information = np.zeros((4, 4))
            information[::2, ::2] = np.einsum("pni,pnj,n->ij", towards, towards, 1.0 / variance[due]) / len(places)
            covariance = np.linalg.inv(np.linalg.inv(covariance) + information)
        found[k] = np.sqrt(covariance[0, 0] + covariance[2, 2])
    return found
