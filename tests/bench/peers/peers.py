#!/usr/bin/env python3
"""One step of a particle filter, or of an unscented Kalman filter, with FilterPy and with Stone Soup, as particle_step.c and ukf_step.c do it with Motehound.

    peers.py particle | ukf

Particle: the target walks in the plane; 200 particles of two coordinates. A step: each particle moves by a random amount, is weighed by eight ranges with Gaussian errors,
the weighted mean is taken, and the set is resampled systematically. FilterPy gives the resampling, the rest is NumPy over all particles at once, as its
documentation does it; Stone Soup gives all of it, with one measurement of eight dimensions.

UKF: the same target, slower, 4 states (nearly constant velocity), a prediction by sigma points and an update with 4 ranges at once, with the same weights everywhere. Both
libraries give all of it but the two models.

Prints a line of JSON for each: microseconds of processor time a step, and
the root mean square error, by which one sees that all do the same.
"""
import datetime
import json
import sys
import time
from importlib.metadata import version

import numpy as np

STEPS, WARM, REPEATS = 2000, 100, 3


class Scene:
    """A target that goes round, and stations around it that measure their ranges to it."""

    def __init__(self, stations, sd_m, turn_rad):
        angles = 2 * np.pi * np.arange(stations) / stations
        self.stations = 40.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        self.sd_m, self.turn_rad = sd_m, turn_rad

    def truth(self, step):
        return 10 * np.array([np.cos(self.turn_rad * step), np.sin(self.turn_rad * step)])

    def ranges(self, step, random):
        return np.hypot(*(self.stations - self.truth(step)).T) + self.sd_m * random.standard_normal(len(self.stations))


def measured(scene, begin):
    """Best of equal runs: whatever else the machine does only adds to the time."""
    best, square = float("inf"), 0.0
    for repeat in range(REPEATS):
        random = np.random.default_rng(repeat)
        np.random.seed(repeat)
        step = begin()
        squares, spent = [], 0.0
        for n in range(STEPS):
            ranges = scene.ranges(n, random)
            began = time.process_time()
            mean = step(n, ranges)
            if n >= WARM:
                spent += time.process_time() - began
                squares.append(np.sum((mean - scene.truth(n)) ** 2))
        best, square = min(best, spent / (STEPS - WARM)), np.mean(squares)
    return {"us_per_step": round(1e6 * best, 2), "rmse_m": round(float(square) ** 0.5, 3)}


PARTICLES, STEP_SD_M = 200, 3.0
WALK = Scene(stations=8, sd_m=5.0, turn_rad=0.2)


def filterpy_particle_step():
    from filterpy.monte_carlo import systematic_resample

    particles = WALK.truth(0) + STEP_SD_M * np.random.standard_normal((PARTICLES, 2))

    def step(_, ranges):
        nonlocal particles
        particles += STEP_SD_M * np.random.standard_normal((PARTICLES, 2))
        distances = np.hypot(particles[:, :1] - WALK.stations[:, 0], particles[:, 1:] - WALK.stations[:, 1])
        sums = np.sum((ranges - distances) ** 2, axis=1)
        weights = np.exp((sums.min() - sums) / (2 * WALK.sd_m**2))
        weights /= weights.sum()
        mean = weights @ particles
        particles = particles[systematic_resample(weights)]
        return mean

    return step


def stonesoup_particle_step():
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
        ndim_meas = len(WALK.stations)

        def function(self, state, noise=False, **_):
            places = np.asarray(state.state_vector)[self.mapping, :]
            return StateVectors(np.hypot(*(places[:, None, :] - WALK.stations.T[:, :, None])))

    model = Ranges(ndim_state=2, mapping=(0, 1), noise_covar=CovarianceMatrix(WALK.sd_m**2 * np.eye(len(WALK.stations))))
    predictor = ParticlePredictor(CombinedLinearGaussianTransitionModel([RandomWalk(STEP_SD_M**2)] * 2))
    updater = ParticleUpdater(model, SystematicResampler())
    start = datetime.datetime(2000, 1, 1)
    places = WALK.truth(0)[:, None] + STEP_SD_M * np.random.standard_normal((2, PARTICLES))
    state = ParticleState(StateVectors(places), weight=np.full(PARTICLES, 1 / PARTICLES), timestamp=start)

    def step(n, ranges):
        nonlocal state
        time_of = start + datetime.timedelta(seconds=n + 1)
        prediction = predictor.predict(state, timestamp=time_of)
        state = updater.update(SingleHypothesis(prediction, Detection(StateVector(ranges), timestamp=time_of, measurement_model=model)))
        return np.asarray(state.mean, dtype=float).ravel()

    return step


INTERVAL_S, INTENSITY = 0.5, 0.02
ALPHA, BETA, KAPPA = 0.5, 2.0, -1.0
FLIGHT = Scene(stations=4, sd_m=0.15, turn_rad=0.05)


def filterpy_ukf_step():
    from filterpy.common import Q_continuous_white_noise
    from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

    F = np.kron(np.eye(2), np.array([[1, INTERVAL_S], [0, 1]]))
    stations = FLIGHT.stations

    def hx(x):
        return np.hypot(x[0] - stations[:, 0], x[2] - stations[:, 1])

    ukf = UnscentedKalmanFilter(dim_x=4, dim_z=len(stations), dt=INTERVAL_S, hx=hx, fx=lambda x, dt: F @ x,
                                points=MerweScaledSigmaPoints(4, ALPHA, BETA, KAPPA))
    ukf.x = np.array([10.0, 0, 0, 1])
    ukf.R *= FLIGHT.sd_m**2
    ukf.Q = Q_continuous_white_noise(2, INTERVAL_S, INTENSITY, block_size=2)

    def step(_, ranges):
        ukf.predict()
        ukf.update(ranges)
        return ukf.x[[0, 2]]

    return step


def stonesoup_ukf_step():
    from stonesoup.models.measurement.nonlinear import NonLinearGaussianMeasurement
    from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
    from stonesoup.predictor.kalman import UnscentedKalmanPredictor
    from stonesoup.types.array import CovarianceMatrix, StateVector, StateVectors
    from stonesoup.types.detection import Detection
    from stonesoup.types.hypothesis import SingleHypothesis
    from stonesoup.types.state import GaussianState
    from stonesoup.updater.kalman import UnscentedKalmanUpdater

    stations = FLIGHT.stations

    class Ranges(NonLinearGaussianMeasurement):
        ndim_meas = len(stations)

        def function(self, state, noise=False, **_):
            places = np.asarray(state.state_vector, dtype=float)[self.mapping, :]
            return StateVectors(np.hypot(*(places[:, None, :] - stations.T[:, :, None])))

    model = Ranges(ndim_state=4, mapping=(0, 2), noise_covar=CovarianceMatrix(FLIGHT.sd_m**2 * np.eye(len(stations))))
    predictor = UnscentedKalmanPredictor(CombinedLinearGaussianTransitionModel([ConstantVelocity(INTENSITY)] * 2), alpha=ALPHA, beta=BETA, kappa=KAPPA)
    updater = UnscentedKalmanUpdater(model, alpha=ALPHA, beta=BETA, kappa=KAPPA)
    start = datetime.datetime(2000, 1, 1)
    state = GaussianState(StateVector([10.0, 0, 0, 1]), np.eye(4), timestamp=start)

    def step(n, ranges):
        nonlocal state
        time_of = start + datetime.timedelta(seconds=INTERVAL_S * (n + 1))
        prediction = predictor.predict(state, timestamp=time_of)
        state = updater.update(SingleHypothesis(prediction, Detection(StateVector(ranges), timestamp=time_of, measurement_model=model)))
        return np.asarray(state.mean, dtype=float).ravel()[[0, 2]]

    return step


STEPS_OF = {"particle": (WALK, filterpy_particle_step, stonesoup_particle_step), "ukf": (FLIGHT, filterpy_ukf_step, stonesoup_ukf_step)}


def main():
    scene, *begins = STEPS_OF[sys.argv[1]]
    for name, package, begin in zip(("FilterPy", "Stone Soup"), ("filterpy", "stonesoup"), begins):
        print(json.dumps({"name": name, "version": version(package), **measured(scene, begin)}), flush=True)


main()
