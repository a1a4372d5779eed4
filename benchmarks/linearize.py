"""Fourier coefficients of many ragged walks: ``python -m benchmarks.linearize [--short]``.

This project beside numpy, scikit-fda and scipy, with the frequency known; and beside an FFT with Gauss-Newton steps,
with the frequency unknown. One core for all of them.
"""

import argparse
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks import _measure, _peers
from benchmarks._synthetic import ANKLES, random_coefficients, random_walk
from eigenwalker.motion import fit_harmonics
from eigenwalker.motion.phase import find_stride

_RATE = 120.0
_OURS = "eigenwalker"
_FDA = "scikit-fda to_basis"
_READING = "sum of one large array"


class _Walks(NamedTuple):
    channels: list[NDArray[np.float64]]
    frequencies: list[float]

    @property
    def bytes_per_walk(self) -> float:
        """Mean size of a walk."""
        return sum(walk.nbytes for walk in self.channels) / len(self.channels)


def main() -> None:
    """Print both tables and the targets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="300 walks instead of 10,000")
    short = parser.parse_args().short
    with threadpool_limits(1):
        print(_measure.describe_machine(("numpy", "scipy", "scikit-learn", "numba", "scikit-fda")))
        print("One core for every row: all pools limited to 1 thread by threadpoolctl.")
        megabytes = 256 if short else 1024
        one, two = (_measure.read_bandwidth(n_cores, megabytes=megabytes) for n_cores in (1, 2))
        print(f"Read bandwidth, best of 5: {one / 1e9:.1f} GB/s on one core, {two / 1e9:.1f} GB/s on two")
        walks = _make_walks(300 if short else 10_000)
        n_frames = [len(walk) for walk in walks.channels]
        print(
            f"Walks: {len(n_frames)}, {min(n_frames)} to {max(n_frames)} frames, 45 channels, float64, "
            f"{walks.bytes_per_walk * len(n_frames) / 1e9:.2f} GB"
        )
        n_rounds = 3 if short else 9
        targets = _known_frequency(walks, megabytes, n_rounds) + _unknown_frequency(walks, n_rounds)
    _measure.print_targets(targets)


def _make_walks(n_walks: int) -> _Walks:
    random = np.random.default_rng(0)
    frequencies = random.uniform(0.8, 1.1, n_walks)
    channels = []
    for frequency in frequencies:
        times = np.arange(random.integers(400, 801)) / _RATE
        channels.append(random_walk(random, random_coefficients(random), 2 * np.pi * frequency * times, 0.001))
    return _Walks(channels, frequencies.tolist())


def _portions(walks: _Walks, n_walks: int, fit: Callable[[int], object]) -> Callable[[int], int]:
    """Return a function for `interleaved` that fits the next `n_walks` walks in each round."""
    n_walks = min(n_walks, len(walks.channels))

    def run(turn: int) -> int:
        for position in range(turn * n_walks, (turn + 1) * n_walks):
            fit(position % len(walks.channels))
        return n_walks

    return run


def _known_frequency(walks: _Walks, megabytes: int, n_rounds: int) -> list[tuple[str, str, bool | None]]:
    # How many walks a round: the slower, the fewer.
    peers = {
        _OURS: (lambda *walk: fit_harmonics(*walk, 2), 2000),
        "numpy lstsq": (_peers.fit_by_lstsq, 1000),
        "numpy matmul, 5 x 5 normal equations": (_peers.fit_by_normal_equations, 2000),
        "scipy curve_fit a channel": (_peers.fit_by_curve_fit, 2),
    }
    missing = []
    try:
        peers[_FDA] = (_peers.make_fit_by_scikit_fda(), 100)
    except Exception as error:  # whatever a peer's import raises is the reason its row gives
        missing.append([_FDA, f"did not import: {error}", *[""] * 5])

    def fitted(fit: Callable, position: int) -> NDArray[np.float64]:
        return fit(walks.channels[position], _RATE, walks.frequencies[position])

    functions = {
        name: _portions(walks, count, lambda at, fit=fit: fitted(fit, at)) for name, (fit, count) in peers.items()
    }
    seconds = _measure.interleaved(functions | {_READING: _reading(walks, megabytes)}, n_rounds)
    ratios = {name: _measure.ratio(seconds, name, _OURS) for name in seconds}
    shares = {name: 1 / _measure.ratio(seconds, name, _READING) for name in seconds}
    rows, errors = [], {}
    for name, (fit, count) in peers.items():
        checked = range(min(count, 200, len(walks.channels)))
        errors[name] = max(np.abs(fitted(fit, at) - fitted(_peers.fit_by_lstsq, at)).max() for at in checked)
        n_walks = str(min(count, len(walks.channels)))
        rows.append([*_row(name, n_walks, walks, seconds, shares, ratios), f"{errors[name]:.1e}"])
    rows.append([*_row(_READING, "", walks, seconds, shares, ratios), ""])
    _measure.print_table(
        f"Known frequency, 2 harmonics, median of {n_rounds} rounds",
        ["", "walks a round", "µs a walk", "GB/s", "of bandwidth", "time / ours", "most off lstsq, m"],
        rows + missing,
    )
    print("curve_fit: on so few walks that its time for all of them is an extrapolation.")
    fda = ratios.get(_FDA)
    return [
        ("at least 8 times as fast as lstsq", f"{ratios['numpy lstsq']:.1f}", ratios["numpy lstsq"] >= 8),
        ("at least 20 times as fast as scikit-fda", f"{fda or 0:.1f}", None if fda is None else fda >= 20),
        ("at least 45 % of one core's read bandwidth", f"{shares[_OURS]:.1%}", shares[_OURS] >= 0.45),
        ("within 1e-9 m of lstsq", f"{errors[_OURS]:.1e}", errors[_OURS] <= 1e-9),
    ]


def _reading(walks: _Walks, megabytes: int) -> Callable[[int], float]:
    """Return a function for `interleaved` that reads as many bytes as so many walks have, and does nothing else."""
    large = np.ones(megabytes * 131072)

    def run(turn: int) -> float:
        _measure.sum_values(large)
        return large.nbytes / walks.bytes_per_walk

    return run


def _row(name: str, n_walks: str, walks: _Walks, seconds: dict, shares: dict, ratios: dict) -> list[str]:
    median = float(np.median(seconds[name]))
    read = walks.bytes_per_walk / median / 1e9
    return [name, n_walks, f"{median * 1e6:.1f}", f"{read:.2f}", f"{shares[name]:.1%}", f"{ratios[name]:.1f}"]


def _unknown_frequency(walks: _Walks, n_rounds: int) -> list[tuple[str, str, bool | None]]:
    def ours(at: int) -> float:
        channels = walks.channels[at]
        frequency = find_stride(channels, _RATE, ANKLES)
        fit_harmonics(channels, _RATE, frequency, 2)
        return frequency

    def all_channels(at: int) -> float:
        return after_fft(at, _peers.frequency_by_fft(walks.channels[at], _RATE, n_harmonics=4))

    def reference_only(at: int) -> float:
        reference = walks.channels[at] @ ANKLES
        return after_fft(at, _peers.frequency_by_fft(reference[:, np.newaxis], _RATE))

    def after_fft(at: int, start: float) -> float:
        frequency = _peers.refine_by_gauss_newton(walks.channels[at], _RATE, start)
        _peers.fit_by_normal_equations(walks.channels[at], _RATE, frequency)
        return frequency

    slow = "FFT of all channels, Gauss-Newton"
    functions = {
        _OURS: (ours, 2000),
        slow: (all_channels, 100),
        "FFT of left minus right, Gauss-Newton": (reference_only, 100),
    }
    seconds = _measure.interleaved(
        {name: _portions(walks, count, run) for name, (run, count) in functions.items()}, n_rounds
    )
    checked = range(min(300, len(walks.channels)))
    truth = np.array([walks.frequencies[at] for at in checked])
    mine = np.array([ours(at) for at in checked])
    rows, ratios = [], {}
    for name, (run, count) in functions.items():
        found = np.array([run(at) for at in checked])
        ratios[name] = _measure.ratio(seconds, name, _OURS)
        rows.append(
            [
                name,
                str(min(count, len(walks.channels))),
                f"{np.median(seconds[name]) * 1e6:.0f}",
                f"{ratios[name]:.1f}",
                f"{np.sqrt(np.mean((found - truth) ** 2)):.2e}",
                f"{np.abs(found - truth).max():.1e}",
                f"{np.abs(found - mine).max():.1e}",
            ]
        )
    _measure.print_table(
        f"Unknown frequency: found with 4 harmonics, then 2 fitted; median of {n_rounds} rounds",
        ["", "walks a round", "µs a walk", "time / ours", "rms error, Hz", "largest", "most off ours, Hz"],
        rows,
    )
    return [("at least 10 times as fast as FFT and Gauss-Newton", f"{ratios[slow]:.1f}", ratios[slow] >= 10)]


if __name__ == "__main__":
    main()
