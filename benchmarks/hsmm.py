"""The core of hidden semi-Markov gait models: ``python -m benchmarks.hsmm [--short]``.

One EM iteration at the scale of Tilmanne et al. 2012: 123 walks, 1365 steps of five states in ten contexts, about
48,264 frames of 162 values, synthetic. Then its forward and backward messages beside the same in NumPy, densities and
messages beside hmmlearn's ordinary hidden Markov model of the same 50 states, and the generation of channels beside
scipy and nnmnkwii. One core for all of them.
"""

import argparse
import resource
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks import _measure
from benchmarks._hsmm_generation import compare_generation
from eigenwalker.hsmm import (
    ObservedWalk,
    StateParameters,
    accumulate_over_time,
    accumulate_walk,
    add_statistics,
    align_states,
    expect_statistics,
    infer_states,
    log_densities,
    log_durations,
    maximize_likelihood,
)
from tests.hsmm.planted import draw_parameters, draw_walks
from tests.hsmm.reference import numpy_messages

_N_STATES, _N_FEATURES, _FRAMES = 50, 162, 48_264
_ITERATION, _OURS, _NUMPY = "one EM iteration", "forward and backward", "the same in NumPy"
_E_STEP, _HMM = "densities, forward and backward", "hmmlearn GaussianHMM.score_samples"


def main() -> None:
    """Print the tables and the targets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="3 rounds instead of 9")
    n_rounds = 3 if parser.parse_args().short else 9
    with threadpool_limits(1):
        print(_measure.describe_machine(("numpy", "scipy", "numba", "hmmlearn", "nnmnkwii")))
        print("One core for every row: all pools limited to 1 thread by threadpoolctl.")
        random = np.random.default_rng(0)
        # At the paper's 7.07 frames a state.
        parameters = draw_parameters(random, n_states=_N_STATES, n_features=_N_FEATURES, duration=7.07, spread=1.0)
        lengths = [12] * 12 + [11] * 111
        walks, _ = draw_walks(random, parameters, [_chain(n_steps, at % 2) for at, n_steps in enumerate(lengths)])
        n_frames = sum(len(walk.observations) for walk in walks)
        print(f"Walks: {len(walks)}, {sum(lengths)} steps, {_N_FEATURES} values a frame")
        print(f"Frames: {n_frames}, where the paper has {_FRAMES}")
        targets = [*_time_training(walks, parameters, n_rounds), *compare_generation(n_rounds)]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"\nPeak memory of this process: {peak:.0f} MB, of which the walks {n_frames * _N_FEATURES * 8 / 2**20:.0f} MB"
    )
    _measure.print_targets(targets)


def _chain(n_steps: int, side: int) -> NDArray[np.int_]:
    """Return five states for each step: of ten contexts, two sides times first, second, inside, last but one, last."""
    steps = np.arange(n_steps)
    places = np.select([steps == n_steps - 1, steps == n_steps - 2, steps < 2], [4, 3, steps], 2)
    contexts = 5 * ((steps + side) % 2) + places
    return (5 * contexts[:, np.newaxis] + np.arange(5)).ravel()  # (n_steps, 5) in a row


def _time_training(
    walks: list[ObservedWalk], parameters: StateParameters, n_rounds: int
) -> list[tuple[str, str, bool | None]]:
    durations = log_durations(parameters.duration_means, parameters.duration_variances)
    chains = [(_cumulate(walk, parameters), durations[walk.states]) for walk in walks]
    posteriors = [infer_states(*chain) for chain in chains]
    statistics = [expect_statistics(walk, parameters) for walk in walks]

    def iterate() -> None:
        sums = expect_statistics(walks[0], parameters)
        for walk in walks[1:]:
            sums = add_statistics(sums, expect_statistics(walk, parameters))
        maximize_likelihood(sums, parameters, floors=1e-3)

    def accumulate() -> None:
        for walk, posterior in zip(walks, posteriors, strict=True):
            accumulate_walk(walk, posterior, n_states=_N_STATES, n_duration_states=_N_STATES)

    jobs: dict[str, Callable[[], object]] = {
        _ITERATION: iterate,
        "  densities": lambda: [_cumulate(walk, parameters) for walk in walks],
        f"  {_OURS}": lambda: [infer_states(*chain) for chain in chains],
        "  sums": accumulate,
        "  M step": lambda: maximize_likelihood(statistics[0], parameters, floors=1e-3),
        "best path": lambda: [align_states(*chain) for chain in chains],
    }
    seconds = _measure.interleaved({name: _whole(job) for name, job in jobs.items()}, n_rounds)
    rows = [[name, f"{np.median(taken) * 1e3:.0f}", f"{taken.min() * 1e3:.0f}"] for name, taken in seconds.items()]
    _measure.print_table(f"All walks, {n_rounds} rounds", ["", "ms, median", "ms, best"], rows)
    iteration = float(np.median(seconds[_ITERATION]))
    return [
        ("one EM iteration at most 0.5 s", f"{iteration:.2f} s", iteration <= 0.5),
        *_beside_numpy(chains, min(n_rounds, 3)),
        *_beside_hmmlearn(walks, parameters, min(n_rounds, 3)),
    ]


def _cumulate(walk: ObservedWalk, parameters: StateParameters) -> NDArray[np.float64]:
    """Return running sums of log-densities for each position of a walk's chain."""
    used, positions = np.unique(walk.states, return_inverse=True)
    densities = log_densities(walk.observations, parameters.means[used], parameters.variances[used])
    return accumulate_over_time(densities)[positions]


def _whole(job: Callable[[], object]) -> Callable[[int], int]:
    """Return a function for `interleaved` that does all walks in each round, counted as one."""

    def run(turn: int) -> int:
        job()
        return 1

    return run


def _beside_numpy(chains: list, n_rounds: int) -> list[tuple[str, str, bool | None]]:
    some = chains[:12]
    jobs = {
        _OURS: lambda: [infer_states(*chain) for chain in some],
        _NUMPY: lambda: [numpy_messages(*chain) for chain in some],
    }
    seconds = _measure.interleaved({name: _whole(job) for name, job in jobs.items()}, n_rounds)
    off = max(
        float(np.abs(mine - theirs).max())
        for chain in some
        for mine, theirs in zip(infer_states(*chain)[1:], numpy_messages(*chain)[1:], strict=True)
    )
    ratio = _measure.ratio(seconds, _NUMPY, _OURS)
    rows = [[name, f"{np.median(seconds[name]) / len(some) * 1e3:.2f}"] for name in jobs]
    _measure.print_table(f"Messages of 12 walks, {n_rounds} rounds", ["", "ms a walk"], rows)
    print(f"Posteriors and duration counts differ by {off:.1e} at most; NumPy takes {ratio:.0f} times as long.")
    return [
        ("forward and backward at least 15 times as fast as NumPy", f"{ratio:.0f}", ratio >= 15),
        ("posteriors within 1e-8 of NumPy's", f"{off:.1e}", off <= 1e-8),
    ]


def _beside_hmmlearn(
    walks: list[ObservedWalk], parameters: StateParameters, n_rounds: int
) -> list[tuple[str, str, bool | None]]:
    wanted = "not slower than hmmlearn's ordinary HMM"
    try:
        from hmmlearn.hmm import GaussianHMM
    except ImportError as error:
        return [(wanted, f"did not import: {error}", None)]
    model = GaussianHMM(n_components=_N_STATES, covariance_type="diag", implementation="scaling")  # its faster one
    model.startprob_, model.transmat_ = _markov_chain(walks, parameters)
    model.means_, model.covars_ = parameters.means, parameters.variances
    durations = log_durations(parameters.duration_means, parameters.duration_variances)
    frames, lengths = np.concatenate([walk.observations for walk in walks]), [len(walk.observations) for walk in walks]
    jobs = {
        _E_STEP: lambda: [infer_states(_cumulate(walk, parameters), durations[walk.states]) for walk in walks],
        _HMM: lambda: model.score_samples(frames, lengths),
    }
    seconds = _measure.interleaved({name: _whole(job) for name, job in jobs.items()}, n_rounds)
    ratio = _measure.ratio(seconds, _HMM, _E_STEP)
    rows = [[name, f"{np.median(seconds[name]) * 1e3:.0f}"] for name in jobs]
    _measure.print_table(f"An ordinary HMM on all walks, {n_rounds} rounds", ["", "ms"], rows)
    print("Another model: its states last for geometric times, and any of the 50 may follow where the chains allow it.")
    return [(wanted, f"{ratio:.1f} times as fast", ratio >= 1)]


def _markov_chain(
    walks: list[ObservedWalk], parameters: StateParameters
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return start and transition probabilities of the ordinary model with the same mean durations."""
    start, following = np.zeros(_N_STATES), np.zeros((_N_STATES, _N_STATES))
    for walk in walks:
        start[walk.states[0]] += 1
        np.add.at(following, (walk.states[:-1], walk.states[1:]), 1.0)
    last = following.sum(axis=1) == 0
    following[last, last] = 1.0
    leave = np.where(last, 0.0, 1 / parameters.duration_means)[:, np.newaxis]
    following /= following.sum(axis=1, keepdims=True)
    return start / start.sum(), leave * following + (1 - leave) * np.eye(_N_STATES)


if __name__ == "__main__":
    main()
