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
_N_ROUNDS = 7


class _Walks(NamedTuple):
    channels: list[NDArray[np.float64]]
    frequencies: NDArray[np.float64]

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
        bandwidth = _measure.read_bandwidth(1, megabytes=megabytes)
        both = _measure.read_bandwidth(2, megabytes=megabytes)
        print(f"Read bandwidth: {bandwidth / 1e9:.1f} GB/s on one core, {both / 1e9:.1f} GB/s on two")
        walks = _make_walks(300 if short else 10_000)
        n_frames = [len(walk) for walk in walks.channels]
        print(
            f"Walks: {len(n_frames)}, {min(n_frames)} to {max(n_frames)} frames, 45 channels, float64, "
            f"{walks.bytes_per_walk * len(n_frames) / 1e9:.2f} GB"
        )
        targets = _known_frequency(walks, bandwidth) + _unknown_frequency(walks)
    _measure.print_targets(targets)


def _make_walks(n_walks: int) -> _Walks:
    random = np.random.default_rng(0)
    frequencies = random.uniform(0.8, 1.1, n_walks)
    channels = []
    for frequency in frequencies:
        times = np.arange(random.integers(400, 801)) / _RATE
        channels.append(random_walk(random, random_coefficients(random), 2 * np.pi * frequency * times, 0.001))
    return _Walks(channels, frequencies)


def _portions(walks: _Walks, n_walks: int, fit: Callable[[int], object]) -> Callable[[int], int]:
    """Return a function for `interleaved` that fits the next `n_walks` walks in each round."""
    n_walks = min(n_walks, len(walks.channels))

    def run(turn: int) -> int:
        for position in range(turn * n_walks, (turn + 1) * n_walks):
            fit(position % len(walks.channels))
        return n_walks

    return run


def _known_frequency(walks: _Walks, bandwidth: float) -> list[tuple[str, str, bool | None]]:
    # How many walks a round: the slower, the fewer.
    peers = {
        _OURS: (lambda *walk: fit_harmonics(*walk, 2), len(walks.channels)),
        "numpy lstsq": (_peers.fit_by_lstsq, 1000),
        "numpy matmul, 5 x 5 normal equations": (_peers.fit_by_normal_equations, 2000),
        "scipy curve_fit a channel": (_peers.fit_by_curve_fit, 2),
    }
    missing = []
    try:
        peers["scikit-fda to_basis"] = (_peers.make_fit_by_scikit_fda(), 40)
    except Exception as error:  # whatever a peer's import raises is the reason its row gives
        missing.append(["scikit-fda to_basis", f"did not import: {error}", "", "", "", "", ""])

    def fitted(fit: Callable, position: int) -> NDArray[np.float64]:
        return fit(walks.channels[position], _RATE, walks.frequencies[position])

    seconds = _measure.interleaved(
        {name: _portions(walks, count, lambda at, fit=fit: fitted(fit, at)) for name, (fit, count) in peers.items()},
        _N_ROUNDS,
    )
    rows, ratios, errors = [], {}, {}
    for name, (fit, count) in peers.items():
        checked = range(min(count, 200, len(walks.channels)))
        errors[name] = max(np.abs(fitted(fit, at) - fitted(_peers.fit_by_lstsq, at)).max() for at in checked)
        ratios[name] = _measure.ratio(seconds, name, _OURS)
        median = float(np.median(seconds[name]))
        read = walks.bytes_per_walk / median
        rows.append(
            [
                name,
                str(min(count, len(walks.channels))),
                f"{median * 1e6:.1f}",
                f"{read / 1e9:.2f}",
                f"{read / bandwidth:.1%}",
                f"{ratios[name]:.1f}",
                f"{errors[name]:.1e}",
            ]
        )
    _measure.print_table(
        f"Known frequency, 2 harmonics, median of {_N_ROUNDS} rounds",
        ["", "walks a round", "µs a walk", "GB/s", "of bandwidth", "time / ours", "most off lstsq, m"],
        rows + missing,
    )
    print("curve_fit: on so few walks that its time for all of them is an extrapolation.")
    share = walks.bytes_per_walk / float(np.median(seconds[_OURS])) / bandwidth
    fda = ratios.get("scikit-fda to_basis")
    return [
        ("at least 8 times as fast as lstsq", f"{ratios['numpy lstsq']:.1f}", ratios["numpy lstsq"] >= 8),
        ("at least 20 times as fast as scikit-fda", f"{fda or 0:.1f}", fda and fda >= 20),
        ("at least 45 % of one core's read bandwidth", f"{share:.1%}", share >= 0.45),
        ("within 1e-9 m of lstsq", f"{errors[_OURS]:.1e}", errors[_OURS] <= 1e-9),
    ]


def _unknown_frequency(walks: _Walks) -> list[tuple[str, str, bool | None]]:
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
        slow: (all_channels, 300),
        "FFT of left minus right, Gauss-Newton": (reference_only, 300),
    }
    seconds = _measure.interleaved(
        {name: _portions(walks, count, run) for name, (run, count) in functions.items()}, _N_ROUNDS
    )
    checked = range(min(300, len(walks.channels)))
    truth = walks.frequencies[checked]
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
        f"Unknown frequency: found with 4 harmonics, then 2 fitted; median of {_N_ROUNDS} rounds",
        ["", "walks a round", "µs a walk", "time / ours", "rms error, Hz", "largest", "most off ours, Hz"],
        rows,
    )
    return [("at least 10 times as fast as FFT and Gauss-Newton", f"{ratios[slow]:.1f}", ratios[slow] >= 10)]


if __name__ == "__main__":
    main()
