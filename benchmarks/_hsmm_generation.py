"""Generating the channels of a gait model, a part of `benchmarks.hsmm`.

54 channels from means and variances of static, delta and second delta, for 10 s and 100 s of 60 frames/s: this project
beside scipy's banded solver and nnmnkwii's, a channel after the other. nnmnkwii takes no dynamics from the first and
last two frames; here it is asked for with infinite variances.
"""

import tracemalloc
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solveh_banded

from benchmarks import _measure
from benchmarks._findings import Row
from benchmarks._tables import print_table
from eigenwalker.hsmm.features import WINDOWS
from eigenwalker.hsmm.generation import generate_trajectory, normal_equations
from eigenwalker.hsmm.global_variance import GlobalVariance, generate_with_variance

__all__ = ["compare_generation", "make_nnmnkwii", "make_states"]

_N_CHANNELS = 54
_OURS, _EXACT = "eigenwalker", "eigenwalker, global variance"
_SOLVEH, _HALVES = "scipy solveh_banded", "scipy solveh_banded, even and odd frames apart"
_NNMNKWII = "nnmnkwii mlpg"
_WANTED = {(600, _SOLVEH): 4, (600, _NNMNKWII): 5}
_WANTED_OF_LONG = 0.5  # no cliff: a frame of 100 s takes at most twice as long as one of 10 s
_BOUND = 1e-10  # radians


def compare_generation(n_rounds: int) -> list[Row]:
    """Print a table for each length, and return the rows of both, and of a long one beside a short one."""
    return [*_compare(600, 3 * n_rounds), *_compare(6000, n_rounds), _compare_lengths(10 * n_rounds)]


def make_states(n_frames: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return means and variances of states of 6 frames, shape (n_frames, 162), without dynamics at both ends."""
    random = np.random.default_rng(0)
    scales = np.repeat([0.1, 0.02, 0.005], _N_CHANNELS)  # radians, and radians a frame and a frame squared
    means = np.repeat(random.normal(size=(n_frames // 6, len(scales))) * scales, 6, axis=0)
    variances = np.repeat(random.uniform(0.1, 0.5, (n_frames // 6, len(scales))) * scales**2, 6, axis=0)
    variances[:2, _N_CHANNELS:] = variances[-2:, _N_CHANNELS:] = np.inf
    return means, variances


def generate_by_scipy(means: NDArray[np.float64], variances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the same from scipy's solver for the band of 4 that W'PW has; the system is set up as ours is."""
    bands, right, step = normal_equations(means, variances)
    trajectory = np.empty_like(right)
    lower = np.zeros((step * (bands.shape[1] - 1) + 1, len(right)))
    for channel in range(right.shape[1]):
        for band in range(bands.shape[1]):  # [k, j] is A[j + k, j]
            lower[band * step, : len(right) - band * step] = bands[band * step :, band, channel]
        trajectory[:, channel] = solveh_banded(lower, right[:, channel], lower=True, check_finite=False)
    return trajectory


def generate_by_halves(means: NDArray[np.float64], variances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the same from scipy's solver with two systems of half the size and half the band, as ours uses it."""
    bands, right, step = normal_equations(means, variances)
    trajectory = np.empty_like(right)
    for start in range(step):
        part, values = bands[start::step], right[start::step]
        lower = np.zeros((bands.shape[1], len(values)))
        for channel in range(right.shape[1]):
            for band in range(bands.shape[1]):
                lower[band, : len(values) - band] = part[band:, band, channel]
            trajectory[start::step, channel] = solveh_banded(lower, values[:, channel], lower=True, check_finite=False)
    return trajectory


def make_nnmnkwii() -> Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]:
    """Return generation by nnmnkwii, which is imported here."""
    from nnmnkwii.paramgen import mlpg

    windows = [(len(window) // 2, len(window) // 2, np.array(window)) for window in WINDOWS]
    return lambda means, variances: mlpg(means, variances, windows)


def _compare(n_frames: int, n_rounds: int) -> list[Row]:
    """Print times, errors and peak memory for one length, and return a row for each peer."""
    means, variances = make_states(n_frames)
    functions = {_OURS: generate_trajectory, _SOLVEH: generate_by_scipy, _HALVES: generate_by_halves}
    found, missing = _measure.try_peers({_NNMNKWII: make_nnmnkwii})
    functions |= found
    plain = generate_by_scipy(means, variances)
    target = GlobalVariance(1.3 * plain.var(axis=0), (0.2 * plain.var(axis=0)) ** 2)
    n_calls = max(1, 6000 // n_frames)

    def several(function: Callable) -> Callable[[int], int]:
        return lambda turn: len([function(means, variances) for _ in range(n_calls)])

    seconds = _measure.interleaved({name: several(function) for name, function in functions.items()}, n_rounds)
    # By itself: it gives so much memory back to the system that whoever comes next has to ask for it again.
    functions[_EXACT] = lambda means, variances: generate_with_variance(means, variances, target)
    seconds |= _measure.interleaved({_EXACT: several(functions[_EXACT])}, n_rounds)
    rows = []
    for name, function in functions.items():
        error = "" if name == _EXACT else f"{np.abs(function(means, variances) - plain).max():.1e}"
        median, peak = np.median(seconds[name]), _peak_bytes(function, means, variances) / means.nbytes
        ratio = _measure.ratio(seconds, name, _OURS)
        rows.append([name, f"{median * 1e3:.2f}", f"{ratio:.1f}", error, f"{peak:.1f}"])
    print_table(
        f"{n_frames} frames, {_N_CHANNELS} channels, {means.nbytes / 1e6:.1f} MB of means; "
        f"median of {n_rounds} rounds of {n_calls}",
        ["", "ms", "time / ours", "most off solveh_banded, rad", "peak memory / means"],
        rows + [[name, reason, "", "", ""] for name, reason in missing.items()],
    )
    ours = generate_trajectory(means, variances)
    return [
        _measure.beside(
            f"HSMM generation, {n_frames} frames",
            seconds,
            _OURS,
            peer,
            wanted=_WANTED.get((n_frames, peer)),
            error=float(np.abs(ours - functions[peer](means, variances)).max()) if peer in functions else None,
            bound=_BOUND,
            unit="rad",
            note=missing.get(peer, ""),
        )
        for peer in (_SOLVEH, _NNMNKWII)
    ]


def _compare_lengths(n_rounds: int) -> Row:
    """Return the row of a frame of 100 s beside one of 10 s, both of them in turns."""
    short, long = make_states(600), make_states(6000)
    jobs = {"ours, 10 s": lambda turn: len([generate_trajectory(*short) for _ in range(10)]) * 600}
    jobs["100 s"] = lambda turn: len(generate_trajectory(*long))
    seconds = _measure.interleaved(jobs, n_rounds)
    return _measure.beside("HSMM generation of 100 s, a frame", seconds, "100 s", "ours, 10 s", wanted=_WANTED_OF_LONG)


def _peak_bytes(function: Callable, *arguments: NDArray[np.float64]) -> int:
    """Return the largest memory held during a call beside the arguments, scratch arrays of compiled code included."""
    tracemalloc.start()
    function(*arguments)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak
