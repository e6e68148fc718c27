#!/usr/bin/env python3
"""One step of a particle filter with FilterPy and with Stone Soup, as tests/bench/peers/particle_step.c does it with Motehound.

The target walks in the plane; 200 particles of two coordinates. A step: each particle moves by a random amount, is weighed by eight ranges with Gaussian errors,
the weighted mean is taken, and the set is resampled systematically. FilterPy gives the resampling, the rest is NumPy over all particles at once, as its
documentation does it; Stone Soup gives all of it, with one measurement of eight dimensions. Prints a line of JSON for each: microseconds of processor time a step, and
the root mean square error, by which one sees that all do the same.
"""
import datetime
import json
import time
from importlib.metadata import version

import numpy as np

PARTICLES, STATIONS, STEPS, WARM = 200, 8, 2000, 100
SD_M, STEP_SD_M, RADIUS_M = 5.0, 3.0, 40.0
REPEATS = 3

angles = 2 * np.pi * np.arange(STATIONS) / STATIONS
stations = RADIUS_M * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def truth(step):
    return np.array([10 * np.cos(0.2 * step), 10 * np.sin(0.2 * step)])


def ranges_at(step, random):
    return np.hypot(*(stations - truth(step)).T) + SD_M * random.standard_normal(STATIONS)


def measured(begin):
    """Best of equal runs: whatever else the machine does only adds to the time."""
    best, square = float("inf"), 0.0
    for repeat in range(REPEATS):
        random = np.random.default_rng(repeat)
        np.random.seed(repeat)
        step = begin()
        squares, spent = [], 0.0
        for n in range(STEPS):
            ranges = ranges_at(n, random)
            began = time.process_time()
            mean = step(n, ranges)
            if n >= WARM:
                spent += time.process_time() - began
                squares.append(np.sum((mean - truth(n)) ** 2))
        best, square = min(best, spent / (STEPS - WARM)), np.mean(squares)
    return {"us_per_step": round(1e6 * best, 1), "rmse_m": round(float(square) ** 0.5, 2)}


def filterpy_step():
    from filterpy.monte_carlo import systematic_resample

    particles = truth(0) + STEP_SD_M * np.random.standard_normal((PARTICLES, 2))

    def step(_, ranges):
        nonlocal particles
        particles += STEP_SD_M * np.random.standard_normal((PARTICLES, 2))
        distances = np.hypot(particles[:, :1] - stations[:, 0], particles[:, 1:] - stations[:, 1])
        sums = np.sum((ranges - distances) ** 2, axis=1)
        weights = np.exp((sums.min() - sums) / (2 * SD_M**2))
        weights /= weights.sum()
        mean = weights @ particles
        particles = particles[systematic_resample(weights)]
        return mean

    return step


def stonesoup_step():
    from stonesoup.base import Property
    from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
    from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, RandomWalk
    from stonesoup.predictor.particle import ParticlePredictor
    from stonesoup.resampler.particle import SystematicResampler
    from stonesoup.types.array import CovarianceMatrix, StateVector, StateVectors
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import ParticleState
    from stonesoup.updater.particle import ParticleUpdater

    class Ranges(NonLinearGaussianMeasurement):
        ndim_meas = STATIONS

        def function(self, state, noise=False, **_):
            places = np.asarray(state.state_vector)[self.mapping, :]
            return StateVectors(np.hypot(*(places[:, None, :] - stations.T[:, :, None])))

    model = Ranges(ndim_state=2, mapping=(0, 1), noise_covar=CovarianceMatrix(SD_M**2 * np.eye(STATIONS)))
    predictor = ParticlePredictor(CombinedLinearGaussianTransitionModel([RandomWalk(STEP_SD_M**2)] * 2))
    updater = ParticleUpdater(model, SystematicResampler())
    start = datetime.datetime(2000, 1, 1)
    places = truth(0)[:, None] + STEP_SD_M * np.random.standard_normal((2, PARTICLES))
    state = ParticleState(StateVectors(places), weight=np.full(PARTICLES, 1 / PARTICLES), timestamp=start)

    def step(n, ranges):
        nonlocal state
        time_of = start + datetime.timedelta(seconds=n + 1)
        prediction = predictor.predict(state, timestamp=time_of)
        state = updater.update(SingleHypothesis(prediction, Detection(StateVector(ranges), timestamp=time_of, measurement_model=model)))
        return np.asarray(state.mean, dtype=float).ravel()

    return step


def main():
    for name, package, begin in (("FilterPy", "filterpy", filterpy_step), ("Stone Soup", "stonesoup", stonesoup_step)):
        print(json.dumps({"name": name, "version": version(package), **measured(begin)}), flush=True)


main()
