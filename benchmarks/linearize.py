"""Fourier coefficients of many ragged walks: ``python -m benchmarks.linearize [--short]``.

This project beside numpy, scikit-fda and scipy, with the frequency known; and beside an FFT with Gauss-Newton steps,
with the frequency unknown. One core for all of them.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks import _measure, _peers
from benchmarks._command import run
from benchmarks._findings import Row
from benchmarks._machine import describe_machine
from benchmarks._synthetic import ANKLES, random_coefficients, random_walk
from benchmarks._tables import print_table
from eigenwalker.motion import fit_harmonics
from eigenwalker.motion.phase import find_stride

_RATE = 120.0
_OURS = "eigenwalker"
_LSTSQ, _NORMAL, _CURVE = "numpy lstsq", "numpy matmul, 5 x 5 normal equations", "scipy curve_fit a channel"
_FDA, _READING = "scikit-fda to_basis", "sum of one large array"
_SEARCH, _REFERENCE = "FFT of all channels, Gauss-Newton", "FFT of left minus right, Gauss-Newton"
_WANTED = {_LSTSQ: 8, _FDA: 20, _READING: 0.45, _SEARCH: 10}
_BOUNDS = {_LSTSQ: 1e-9}  # metres


class _Walks(NamedTuple):
    channels: list[NDArray[np.float64]]
    frequencies: list[float]

    @property
    def bytes_per_walk(self) -> float:
        """Mean size of a walk."""
        return sum(walk.nbytes for walk in self.channels) / len(self.channels)


def findings(*, short: bool) -> list[Row]:
    """Print both tables, and return a row for each peer."""
    with threadpool_limits(1):
        print(describe_machine(("numpy", "scipy", "scikit-learn", "numba", "scikit-fda")))
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
        return [*_known_frequency(walks, megabytes, n_rounds), *_unknown_frequency(walks, n_rounds)]


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

    def portion(turn: int) -> int:
        for position in range(turn * n_walks, (turn + 1) * n_walks):
            fit(position % len(walks.channels))
        return n_walks

    return portion


def _known_frequency(walks: _Walks, megabytes: int, n_rounds: int) -> list[Row]:
    # How many walks a round: the slower, the fewer.
    peers = {
        _OURS: (lambda *walk: fit_harmonics(*walk, 2), 2000),
        _LSTSQ: (_peers.fit_by_lstsq, 1000),
        _NORMAL: (_peers.fit_by_normal_equations, 2000),
        _CURVE: (_peers.fit_by_curve_fit, 2),
    }
    fda, missing = _measure.try_peers({_FDA: _peers.make_fit_by_scikit_fda})
    peers |= {name: (fit, 100) for name, fit in fda.items()}

    def fitted(name: str, position: int) -> NDArray[np.float64]:
        return peers[name][0](walks.channels[position], _RATE, walks.frequencies[position])

    functions = {
        name: _portions(walks, count, lambda at, name=name: fitted(name, at)) for name, (_, count) in peers.items()
    }
    seconds = _measure.interleaved(functions | {_READING: _reading(walks, megabytes)}, n_rounds)
    errors = {}
    for name, (_, count) in peers.items():
        checked = range(min(count, 200, len(walks.channels)))
        errors[name] = max(float(np.abs(fitted(name, at) - fitted(_OURS, at)).max()) for at in checked)
    counts = {name: str(min(count, len(walks.channels))) for name, (_, count) in peers.items()}
    print_table(
        f"Known frequency, 2 harmonics, median of {n_rounds} rounds",
        ["", "walks a round", "µs a walk", "GB/s", "of bandwidth", "time / ours", "most off ours, m"],
        [_cells(name, counts, walks, seconds, errors) for name in seconds]
        + [[name, reason, *[""] * 5] for name, reason in missing.items()],
    )
    print("curve_fit: on so few walks that its time for all of them is an extrapolation.")
    return [
        _measure.beside(
            "coefficients, frequency known, a walk",
            seconds,
            _OURS,
            name,
            wanted=_WANTED.get(name),
            error=errors.get(name),
            bound=_BOUNDS.get(name),
            unit="m",
            note=missing.get(name, ""),
        )
        for name in (_LSTSQ, _NORMAL, _CURVE, _FDA, _READING)
    ]


def _reading(walks: _Walks, megabytes: int) -> Callable[[int], float]:
    """Return a function for `interleaved` that reads as many bytes as so many walks have, and does nothing else."""
    large = np.ones(megabytes * 131072)

    def read(turn: int) -> float:
        _measure.sum_values(large)
        return large.nbytes / walks.bytes_per_walk

    return read


def _cells(name: str, counts: dict[str, str], walks: _Walks, seconds: dict, errors: dict[str, float]) -> list[str]:
    median = float(np.median(seconds[name]))
    return [
        name,
        counts.get(name, ""),
        f"{median * 1e6:.1f}",
        f"{walks.bytes_per_walk / median / 1e9:.2f}",
        f"{1 / _measure.ratio(seconds, name, _READING):.1%}",
        f"{_measure.ratio(seconds, name, _OURS):.1f}",
        f"{errors[name]:.1e}" if name in errors else "",
    ]


def _unknown_frequency(walks: _Walks, n_rounds: int) -> list[Row]:
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

    functions = {_OURS: (ours, 2000), _SEARCH: (all_channels, 100), _REFERENCE: (reference_only, 100)}
    portions = {name: _portions(walks, count, find) for name, (find, count) in functions.items()}
    seconds = _measure.interleaved(portions, n_rounds)
    checked = range(min(300, len(walks.channels)))
    truth = np.array([walks.frequencies[at] for at in checked])
    found = {name: np.array([find(at) for at in checked]) for name, (find, _) in functions.items()}
    errors = {name: float(np.abs(values - found[_OURS]).max()) for name, values in found.items()}
    print_table(
        f"Unknown frequency: found with 4 harmonics, then 2 fitted; median of {n_rounds} rounds",
        ["", "walks a round", "µs a walk", "time / ours", "rms error, Hz", "largest", "most off ours, Hz"],
        [
            [
                name,
                str(min(count, len(walks.channels))),
                f"{np.median(seconds[name]) * 1e6:.0f}",
                f"{_measure.ratio(seconds, name, _OURS):.1f}",
                f"{np.sqrt(np.mean((found[name] - truth) ** 2)):.2e}",
                f"{np.abs(found[name] - truth).max():.1e}",
                f"{errors[name]:.1e}",
            ]
            for name, (_, count) in functions.items()
        ],
    )
    task = "frequency and coefficients, a walk"
    return [
        _measure.beside(task, seconds, _OURS, name, wanted=_WANTED.get(name), error=errors[name], unit="Hz")
        for name in (_SEARCH, _REFERENCE)
    ]


if __name__ == "__main__":
    run(findings, __doc__, short="300 walks instead of 10,000")
