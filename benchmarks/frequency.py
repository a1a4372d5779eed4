"""Errors of the stride frequency: ``python -m benchmarks.frequency [--short]``.

First beside the Cramer-Rao bound and beside two estimates from an FFT, on harmonic walks in white noise. Then octave
errors on walks that are as irregular as real ones.
"""

from collections.abc import Callable

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks import _peers
from benchmarks._command import run
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._synthetic import ANKLES, random_coefficients, random_walk
from benchmarks._tables import print_table
from eigenwalker.motion.phase import find_stride

_RATE = 120.0
_N_CYCLES = (2, 3, 5, 10, 20)
_NOISES = (0.001, 0.005)
_OCTAVE = 0.2  # relative error from which an estimate is that of another period
_WORST = 1.3  # times the bound


def findings(*, short: bool) -> list[Check]:
    """Print both tables, and return what is asked of the errors."""
    print(describe_machine())
    return [_bound_table(100 if short else 2000), _octave_table(200 if short else 10_000)]


def _in_parallel(function: Callable, seeds: list[list[int]], *arguments: object) -> NDArray[np.float64]:
    """Return what `function(random, *arguments)` returns for each seed, stacked; the seeds in batches."""

    def batch(part: list[list[int]]) -> list:
        with threadpool_limits(1):
            return [function(np.random.default_rng(seed), *arguments) for seed in part]

    parts = [seeds[first : first + 50] for first in range(0, len(seeds), 50)]
    return np.array([row for part in Parallel(n_jobs=2)(delayed(batch)(part) for part in parts) for row in part])


def _bound_table(n_trials: int) -> Check:
    rows, ratios = [], []
    for cell, (n_cycles, noise) in enumerate((n, noise) for noise in _NOISES for n in _N_CYCLES):
        seeds = [[cell, trial] for trial in range(n_trials)]
        errors = _in_parallel(_bound_trial, seeds, n_cycles, noise)  # (n_trials, 4): three errors, the bound
        in_bounds = np.sqrt((errors[:, :3] ** 2).mean(axis=0))
        ratios.append(in_bounds[0])
        rows.append(
            [
                f"{n_cycles} cycles, {noise * 1000:.0f} mm",
                f"{np.sqrt((errors[:, 3] ** 2).mean()):.1e}",
                f"{in_bounds[0]:.2f}",
                f"{in_bounds[1]:.0f}",
                f"{in_bounds[2]:.0f}",
                f"{np.abs(errors[:, 0]).max():.1f}",
            ]
        )
    print_table(
        f"Root mean square error over the Cramer-Rao bound, 45 channels at {_RATE:g} Hz, {n_trials} trials a cell",
        ["", "bound, Hz", "eigenwalker", "FFT bin", "padded FFT, parabola", "eigenwalker's largest"],
        rows,
    )
    worst = max(ratios)
    wanted = f"rms error of the frequency at most {_WORST:g} times the Cramer-Rao bound in each cell"
    return Check(wanted, f"{worst:.2f}", bool(worst <= _WORST))


def _bound_trial(random: np.random.Generator, n_cycles: int, noise: float) -> list[float]:
    """Return the errors of three estimates as multiples of the bound, and the bound in hertz."""
    frequency = random.uniform(0.7, 1.3)
    coefficients = random_coefficients(random)
    n_frames = round(n_cycles * _RATE / frequency)
    angles = 2 * np.pi * frequency / _RATE * np.arange(n_frames) + random.uniform(0, 2 * np.pi)
    channels = random_walk(random, coefficients, angles, noise)
    reference = (channels @ ANKLES)[:, np.newaxis]
    found = [
        find_stride(channels, _RATE, ANKLES),
        _peers.frequency_by_fft(reference, _RATE, padding=1, parabola=False),
        _peers.frequency_by_fft(reference, _RATE),
    ]
    bound = _cramer_rao_bound(coefficients, angles, noise)
    return [*((np.array(found) - frequency) / bound), bound]


def _cramer_rao_bound(coefficients: NDArray[np.float64], angles: NDArray[np.float64], noise: float) -> float:
    """Return the smallest standard error of the frequency in hertz, when all coefficients are unknown as well.

    With basis Phi, coefficients beta and projection P on the basis, all at the true frequency:
    var(omega) = noise^2 / ||(I - P) (d Phi / d omega) beta||^2, the square summed over frames and channels.
    """
    orders = np.arange(1, len(coefficients) // 2 + 1)
    times = np.arange(len(angles)) - 0.5 * (len(angles) - 1)
    sines, cosines = np.sin(np.outer(angles, orders)), np.cos(np.outer(angles, orders))
    basis = np.hstack((np.ones((len(angles), 1)), sines, cosines))
    slope = times[:, np.newaxis] * ((orders * cosines) @ coefficients[1::2] - (orders * sines) @ coefficients[2::2])
    orthonormal = np.linalg.qr(basis)[0]
    free = slope - orthonormal @ (orthonormal.T @ slope)
    return float(noise / np.linalg.norm(free) * _RATE / (2 * np.pi))


def _octave_table(n_walks: int) -> Check:
    rows = _in_parallel(_irregular_trial, [[99, trial] for trial in range(n_walks)])
    n_cycles, truth = rows[:, 0], rows[:, 1]
    short, middle = n_cycles < 3, (n_cycles >= 3) & (n_cycles < 6)
    table, counts = [], {}
    for column, name in ((2, "eigenwalker"), (3, "padded FFT of left minus right"), (4, "padded FFT of all channels")):
        errors = np.abs(rows[:, column] / truth - 1)
        counts[name] = int((~(errors <= _OCTAVE)).sum())
        worst = [f"{np.nanmax(errors[few], initial=0):.1%}" for few in (short, middle, n_cycles >= 6)]
        table.append([name, str(counts[name]), str(int(np.isnan(errors).sum())), f"{np.nanmedian(errors):.2%}", *worst])
    print_table(
        f"{n_walks} irregular walks, 5 mm noise, 2 to 12 cycles at 30 to 120 Hz, against the mean frequency",
        ["", f"off by > {_OCTAVE:.0%}", "refused", "median error", "worst, 2-3 cycles", "3-6", "6-12"],
        table,
    )
    errors = counts["eigenwalker"]
    return Check(f"no octave error in {n_walks} irregular walks", f"{errors}", errors == 0)


def _irregular_trial(random: np.random.Generator) -> list[float]:
    """Return cycles, mean frequency, and three estimates of it, for a walk with drift, varying steps and a limp."""
    frequency, frame_rate = random.uniform(0.6, 1.4), random.uniform(30, 120)
    n_cycles = random.uniform(2, 12)
    n_frames = int(np.ceil(n_cycles * frame_rate / frequency))
    angles = _uneven_angles(random, n_frames, 2 * np.pi * frequency / frame_rate)
    channels = random_walk(random, _limping_coefficients(random), angles, 0.005)
    truth = (angles[-1] - angles[0]) / (n_frames - 1) * frame_rate / (2 * np.pi)
    try:
        ours = find_stride(channels, frame_rate, ANKLES)
    except ValueError:
        ours = np.nan
    one = _peers.frequency_by_fft((channels @ ANKLES)[:, np.newaxis], frame_rate)
    return [n_cycles, truth, ours, one, _peers.frequency_by_fft(channels, frame_rate, n_harmonics=4)]


def _uneven_angles(random: np.random.Generator, n_frames: int, omega: float) -> NDArray[np.float64]:
    """Return the fundamental's phase: a cadence that drifts by a few percent, and steps that last 3 % more or less."""
    time = np.linspace(-1, 1, n_frames)
    drift = random.normal(scale=0.03) * time + random.normal(scale=0.02) * np.sin(np.pi * time + random.uniform(0, 6))
    regular = np.cumsum(omega * (1 + drift))
    n_steps = int(regular[-1] / np.pi) + 2
    durations = np.clip(random.normal(1, 0.03, n_steps), 0.85, 1.15)
    step_ends = np.concatenate(([0], np.cumsum(durations))) * np.pi
    return np.interp(regular, step_ends, np.pi * np.arange(n_steps + 1)) + random.uniform(0, 2 * np.pi)


def _limping_coefficients(random: np.random.Generator) -> NDArray[np.float64]:
    """Return coefficients in which every channel's harmonics are stronger or weaker by chance.

    The second harmonic is up to 6 times as strong, often stronger than the first, as in the vertical; left and right
    differ. The ankles' forward swing, which tells strides from steps, keeps its first harmonic at 0.6 or more.
    """
    coefficients = random_coefficients(random)
    shape = coefficients.shape[1]
    for order in range(1, len(coefficients) // 2 + 1):
        factor = random.uniform(0.6, 1.4, shape) if order == 1 else random.uniform(0, 2, shape)
        if order == 2:
            factor *= np.where(ANKLES == 0, random.uniform(1, 3), 1)
        coefficients[2 * order - 1 : 2 * order + 1] *= factor
    return coefficients


if __name__ == "__main__":
    run(findings, __doc__, short="100 trials a cell and 200 irregular walks")
