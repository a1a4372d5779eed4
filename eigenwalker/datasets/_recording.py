"""From a walker to a recording: strides that vary, a way over the floor, and noise."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eigenwalker.datasets._walker import Walker, walker_markers

__all__ = ["record_on_floor", "record_on_treadmill"]

_TIMING_WANDER = 0.010  # strides, slow
_TIMING_JITTER = 0.005  # strides, from stride to stride
_ARM_TIMING = 0.012  # strides, of the arms against the legs
_LEG_AMPLITUDE, _ARM_AMPLITUDE = 0.02, 0.10
_SPEED_WANDER = 0.025  # relative, of walks over the floor
_CURVATURE, _HEADING_WANDER = 0.006, 0.015  # radians per metre, radians
_SLOW, _QUICK = (0.04, 0.2), (0.2, 0.8)  # hertz
_RAMP, _RAMP_SHARE = 1.2, 0.12  # seconds of speeding up, at most this share of the recording
_START_SPEED = 0.35  # of the steady speed


class _Drift(NamedTuple):
    """A smooth random course: a sum of sines, so that it depends neither on duration nor on frame rate."""

    frequencies: NDArray[np.float64]
    phases: NDArray[np.float64]
    amplitudes: NDArray[np.float64]

    def __call__(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.sin(2 * np.pi * np.outer(times, self.frequencies) + self.phases) @ self.amplitudes

    def rate(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the derivative in time."""
        angles = 2 * np.pi * np.outer(times, self.frequencies) + self.phases
        return np.cos(angles) @ (2 * np.pi * self.frequencies * self.amplitudes)


def _drift(rng: np.random.Generator, rms: float, band: tuple[float, float], n_sines: int = 5) -> _Drift:
    frequencies = np.exp(rng.uniform(np.log(band[0]), np.log(band[1]), n_sines))
    amplitudes = rng.rayleigh(rms / np.sqrt(n_sines), n_sines)
    return _Drift(frequencies, rng.uniform(0, 2 * np.pi, n_sines), amplitudes)


def record_on_treadmill(
    walker: Walker, times: NDArray[np.float64], rng: np.random.Generator, boost: NDArray[np.float64] | float = 1.0
) -> NDArray[np.float64]:
    """Return markers in place, shape (n_frames, 15, 3), over strides that vary.

    Parameters
    ----------
    walker : Walker
        From `make_walker`.
    times : ndarray of shape (n_frames,)
        In seconds.
    rng : numpy.random.Generator
        For the strides.
    boost : float or ndarray of shape (n_frames,), default 1.0
        Factor on all excursions, for a walker who is slower or faster than usual.
    """
    start = rng.random()
    wander, jitter = _drift(rng, _TIMING_WANDER, _SLOW), _drift(rng, _TIMING_JITTER, _QUICK)
    arm_timing = _drift(rng, _ARM_TIMING, _QUICK)
    legs_vary, arms_vary = _drift(rng, _LEG_AMPLITUDE, _QUICK), _drift(rng, _ARM_AMPLITUDE, _QUICK)
    legs = start + walker.frequency * times + wander(times) + jitter(times)
    # On a belt that does not change, quicker strides are shorter ones.
    quicker = (wander.rate(times) + jitter.rate(times)) / walker.frequency
    leg_amplitude = boost * (1 - quicker) * (1 + legs_vary(times))
    arm_amplitude = boost * (1 + arms_vary(times))
    return walker_markers(walker, legs, legs + arm_timing(times), leg_amplitude, arm_amplitude)


def record_on_floor(
    walker: Walker,
    times: NDArray[np.float64],
    strides_rng: np.random.Generator,
    path_rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Return markers of a walker who crosses a floor, shape (n_frames, 15, 3).

    The walk speeds up, follows a gently bent path in some direction at a nearly steady speed, and slows down. Speed
    changes by step length and cadence in equal parts.

    Parameters
    ----------
    walker : Walker
        From `make_walker`.
    times : ndarray of shape (n_frames,)
        In seconds, evenly spaced.
    strides_rng, path_rng : numpy.random.Generator
        For the strides and for the path.
    """
    heading = path_rng.uniform(-np.pi, np.pi)
    bend = _CURVATURE * path_rng.standard_normal()
    speed, turn = _drift(path_rng, _SPEED_WANDER, _SLOW), _drift(path_rng, _HEADING_WANDER, _SLOW)
    pace = _ramps(times) * (1 + speed(times))
    boost = np.sqrt(pace)
    markers = record_on_treadmill(walker, _cumulated(boost, times), strides_rng, boost)
    distance = walker.stride_length * walker.frequency * _cumulated(pace, times)
    angle = heading + bend * distance + turn(times)
    course = np.column_stack((np.cos(angle), np.sin(angle)))
    steps = np.diff(distance)[:, np.newaxis] * (course[1:] + course[:-1]) / 2
    way = np.vstack((np.zeros(2), np.cumsum(steps, axis=0)))
    leftward = np.column_stack((-course[:, 1], course[:, 0]))
    over_floor = markers[:, :, :1] * course[:, np.newaxis] + markers[:, :, 1:2] * leftward[:, np.newaxis]
    return np.concatenate((over_floor + way[:, np.newaxis], markers[:, :, 2:]), axis=2)


def _ramps(times: NDArray[np.float64]) -> NDArray[np.float64]:
    length = min(_RAMP, _RAMP_SHARE * times[-1])
    from_ends = np.minimum(times, times[-1] - times) / length
    share = np.clip(from_ends, 0.0, 1.0)
    return _START_SPEED + (1 - _START_SPEED) * share**2 * (3 - 2 * share)


def _cumulated(rate: NDArray[np.float64], times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integrate over time by trapezoids, from zero."""
    return np.concatenate(([0.0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(times))))
