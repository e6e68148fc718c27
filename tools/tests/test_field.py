"""The field and the bound against closed forms and independent integration."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import scenario
from scipy.integrate import quad
from scipy.special import exp1

from motehound_tools import bound, field
from motehound_tools.scenario import splitmix64


def test_splitmix64_known_stream() -> None:
    # First outputs of the generator's published reference for the state 1234567.
    known = [6457827717110365317, 3203168211198807973, 9817491932198370423]
    assert splitmix64(1234567, 3) == pytest.approx([(z >> 11) * 2.0**-53 for z in known], rel=0, abs=0)


def test_arcs_reach_the_end_with_the_length_of_two_quarter_circles() -> None:
    route = scenario().route
    assert route.position(np.array(route.end)) == pytest.approx([38.0, 78.0], abs=1e-12)
    radius = np.hypot(38.0, 78.0) / (4.0 * np.sin(np.pi / 4.0))
    assert route.end == pytest.approx(np.pi * radius)
    step = np.diff(route.position(np.linspace(0.0, route.end, 2001)), axis=0)
    assert np.hypot(*step.T) == pytest.approx(route.end / 2000.0, rel=1e-5)


def test_still_source_is_an_exponential_integral() -> None:
    still = scenario(source__path="still", source__duration_s=50.0)
    places = np.array([[0.5, 0.0], [3.0, 4.0], [0.0, 12.0]])
    r2 = (places**2).sum(axis=1)
    expected = 100.0 / (4.0 * np.pi) * exp1(r2 / (4.0 * 40.0))
    assert field.concentration(still, places, 40.0) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("variation", [0.0, 0.4])
def test_moving_source_equals_adaptive_quadrature(variation: float) -> None:
    moving = scenario(source__speed_mps=2.0, source__release_variation=variation)
    time = 33.0
    head = moving.route.position(np.array(time))
    places = head + np.array([[0.3, 0.1], [-2.0, 1.0], [4.0, -6.0]])

    def integrand(age: float, place: np.ndarray) -> float:
        offset = place - moving.route.position(np.array(time - age))
        strength = float(moving.release(np.array(time - age))) / (4.0 * np.pi * age)
        return strength * float(np.exp(-(offset @ offset) / (4.0 * age)))

    edges = [0.0, 1e-3, 0.01, 0.1, 0.5, 1, 2, 4, 6, 9, 12, 16, 20, 26, time]
    for place, found in zip(places, field.concentration(moving, places, time)):
        parts = [quad(integrand, a, b, args=(place,), epsrel=1e-10)[0] for a, b in zip(edges, edges[1:])]
        assert found == pytest.approx(sum(parts), rel=1e-7)


def test_sensitivities_are_derivatives_of_the_concentration() -> None:
    moving = scenario()
    nodes = moving.nodes(0)
    knots = np.arange(31.0)
    level, gradient = bound.sensitivities(moving, nodes, knots, 30)
    assert level == pytest.approx(field.concentration(moving, nodes, 30.0), rel=1e-6, abs=1e-6)
    # Moving every knot alike moves the whole path, so the field at a node changes as if the node moved the other way.
    step = 1e-4
    for axis in (0, 1):
        shift = np.zeros(2)
        shift[axis] = step
        change = field.concentration(moving, nodes - shift, 30.0) - field.concentration(moving, nodes + shift, 30.0)
        assert gradient[:, :, axis].sum(axis=1) == pytest.approx(change / (2.0 * step), rel=1e-5, abs=1e-5)


def test_motion_information_is_what_a_kalman_filter_knows() -> None:
    # Positions measured with unit variance at every step, second differences of standard deviation a T^2: the variance
    # of the newest position from the information of all knots must be that of the filter run step by step.
    interval, acceleration, count = 2.0, 0.05, 12
    prior = bound.motion_information(count, interval, acceleration)
    smoothed = np.linalg.inv(prior + np.eye(count))[-1, -1]
    start = bound.START_SD_M
    # State: newest and previous position.
    p = np.array([[start**2 + (start * interval) ** 2, start**2], [start**2, start**2]])
    h0, h1 = np.array([[0.0, 1.0]]), np.array([[1.0, 0.0]])
    for h in (h0, h1):
        p = p - p @ h.T @ h @ p / (h @ p @ h.T + 1.0)
    move = np.array([[2.0, -1.0], [1.0, 0.0]])
    for _ in range(count - 2):
        p = move @ p @ move.T + np.diag([(acceleration * interval**2) ** 2, 0.0])
        p = p - p @ h1.T @ h1 @ p / (h1 @ p @ h1.T + 1.0)
    assert smoothed == pytest.approx(p[0, 0], rel=1e-5)


def test_information_of_a_reading() -> None:
    # Additive noise alone: the inverse variance; relative noise alone: the variance of the score, 1/(mC)^2 + 2/C^2.
    level = np.array([0.5, 3.0])
    additive = scenario(sensor__relative_noise=0.0, sensor__additive_noise=0.1)
    assert bound.reading_information(additive, level) == pytest.approx([100.0, 100.0])
    relative = scenario(sensor__relative_noise=0.05, sensor__additive_noise=0.0)
    expected = 1.0 / (0.05 * level) ** 2 + 2.0 / level**2
    assert bound.reading_information(relative, level) == pytest.approx(expected, rel=1e-2)


def test_bound_falls_with_less_noise_and_a_firmer_prior() -> None:
    few = {"network__nodes": 320, "source__speed_mps": 4.0}
    noisy, quiet = scenario(sensor__relative_noise=0.05, **few), scenario(sensor__relative_noise=0.01, **few)
    loose, firm = bound.bounds(quiet, quiet.nodes(3), (0.5, 0.05))
    assert firm.rms() < loose.rms() < bound.bounds(noisy, noisy.nodes(3), (0.5,))[0].rms()


def test_bound_grows_through_an_outage() -> None:
    gap = scenario(network__nodes=320, source__speed_mps=4.0, sensor__outage_start_s=10.0, sensor__outage_s=6.0)
    (found,) = bound.bounds(gap, gap.nodes(3), (0.5,))
    during = found.sd[(found.time >= 10.0) & (found.time < 16.0)]
    assert (np.diff(during) > 0.0).all()
    assert found.sd[found.time == 17.0] < 0.5 * during[-1]
    assert (found.heard == ((found.time < 10.0) | (found.time >= 16.0))).all()
