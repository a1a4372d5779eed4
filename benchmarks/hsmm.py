"""The core of hidden semi-Markov gait models: ``python -m benchmarks.hsmm [--short]``.

One EM iteration at the scale of Tilmanne et al. 2012: 123 walks, 1365 steps of five states in ten contexts, about
48,264 frames of 162 values, synthetic. Then its forward and backward messages beside the same in NumPy, densities and
messages beside hmmlearn's ordinary hidden Markov model of the same 50 states, and the generation of channels beside
scipy and nnmnkwii. One core for all of them.
"""

import resource
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from benchmarks import _measure
from benchmarks._command import run
from benchmarks._findings import Check, Finding, Row
from benchmarks._hsmm_generation import compare_generation
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table
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
_ITERATION_SECONDS = 0.5
_WANTED = {_NUMPY: 15, _HMM: 1}
_BOUND = 1e-8  # of posteriors and counts of durations


def findings(*, short: bool) -> list[Finding]:
    """Print the tables, and return a row for each peer, and what is asked of an iteration alone."""
    n_rounds = 3 if short else 9
    with threadpool_limits(1):
        print(describe_machine(("numpy", "scipy", "numba", "hmmlearn", "nnmnkwii")))
        print("One core for every row: all pools limited to 1 thread by threadpoolctl.")
        random = np.random.default_rng(0)
        # At the paper's 7.07 frames a state.
        parameters = draw_parameters(random, n_states=_N_STATES, n_features=_N_FEATURES, duration=7.07, spread=1.0)
        lengths = [12] * 12 + [11] * 111
        walks, _ = draw_walks(random, parameters, [_chain(n_steps, at % 2) for at, n_steps in enumerate(lengths)])
        n_frames = sum(len(walk.observations) for walk in walks)
        print(f"Walks: {len(walks)}, {sum(lengths)} steps, {_N_FEATURES} values a frame")
        print(f"Frames: {n_frames}, where the paper has {_FRAMES}")
        found: list[Finding] = [_time_iteration(walks, parameters, n_rounds)]
        found += [_beside_numpy(walks, parameters), _beside_hmmlearn(walks, parameters, 1 if short else 3)]
        found += compare_generation(n_rounds)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"\nPeak memory of this process: {peak:.0f} MB, of which the walks {n_frames * _N_FEATURES * 8 / 2**20:.0f} MB"
    )
    return found


def _chain(n_steps: int, side: int) -> NDArray[np.int_]:
    """Return five states for each step: of ten contexts, two sides times first, second, inside, last but one, last."""
    steps = np.arange(n_steps)
    places = np.select([steps == n_steps - 1, steps == n_steps - 2, steps < 2], [4, 3, steps], 2)
    contexts = 5 * ((steps + side) % 2) + places
    return (5 * contexts[:, np.newaxis] + np.arange(5)).ravel()  # (n_steps, 5) in a row


def _time_iteration(walks: list[ObservedWalk], parameters: StateParameters, n_rounds: int) -> Check:
    chains = _chains(walks, parameters)
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
    seconds = _measure.interleaved({name: _measure.once(job) for name, job in jobs.items()}, n_rounds)
    rows = [[name, f"{np.median(taken) * 1e3:.0f}", f"{taken.min() * 1e3:.0f}"] for name, taken in seconds.items()]
    print_table(f"All walks, {n_rounds} rounds", ["", "ms, median", "ms, best"], rows)
    iteration = float(np.median(seconds[_ITERATION]))
    wanted = f"one EM iteration at most {_ITERATION_SECONDS:g} s"
    return Check(wanted, f"{iteration:.2f} s", iteration <= _ITERATION_SECONDS, guarded=False)


def _cumulate(walk: ObservedWalk, parameters: StateParameters) -> NDArray[np.float64]:
    """Return running sums of log-densities for each position of a walk's chain."""
    used, positions = np.unique(walk.states, return_inverse=True)
    densities = log_densities(walk.observations, parameters.means[used], parameters.variances[used])
    return accumulate_over_time(densities)[positions]


def _chains(walks: list[ObservedWalk], parameters: StateParameters) -> list[tuple]:
    """Return for each walk what inference takes: running sums of log-densities, and logs of durations."""
    durations = log_durations(parameters.duration_means, parameters.duration_variances)
    return [(_cumulate(walk, parameters), durations[walk.states]) for walk in walks]


def _beside_numpy(walks: list[ObservedWalk], parameters: StateParameters) -> Row:
    some, n_rounds = _chains(walks[:12], parameters), 3
    jobs = {
        _OURS: lambda: [infer_states(*chain) for chain in some],
        _NUMPY: lambda: [numpy_messages(*chain) for chain in some],
    }
    seconds = _measure.interleaved({name: _measure.once(job) for name, job in jobs.items()}, n_rounds)
    error = max(
        float(np.abs(mine - theirs).max())
        for chain in some
        for mine, theirs in zip(infer_states(*chain)[1:], numpy_messages(*chain)[1:], strict=True)
    )
    ratio = _measure.ratio(seconds, _NUMPY, _OURS)
    rows = [[name, f"{np.median(seconds[name]) / len(some) * 1e3:.2f}"] for name in jobs]
    print_table(f"Messages of 12 walks, {n_rounds} rounds", ["", "ms a walk"], rows)
    print(f"Posteriors and duration counts differ by {error:.1e} at most; NumPy takes {ratio:.0f} times as long.")
    task = "HSMM training, forward and backward, 12 walks"
    return _measure.beside(task, seconds, _OURS, _NUMPY, wanted=_WANTED[_NUMPY], error=error, bound=_BOUND)


def _beside_hmmlearn(walks: list[ObservedWalk], parameters: StateParameters, n_rounds: int) -> Row:
    durations = log_durations(parameters.duration_means, parameters.duration_variances)
    jobs: dict[str, Callable[[], object]] = {
        _E_STEP: lambda: [infer_states(_cumulate(walk, parameters), durations[walk.states]) for walk in walks]
    }
    found, missing = _measure.try_peers({_HMM: lambda: _score_by_hmmlearn(walks, parameters)})
    jobs |= found
    # The round that is not counted takes the peer seven seconds.
    seconds = _measure.interleaved(
        {name: _measure.once(job) for name, job in jobs.items()}, n_rounds, warm=n_rounds > 1
    )
    rows = [[name, f"{np.median(seconds[name]) * 1e3:.0f}"] for name in jobs]
    rows += [[name, reason] for name, reason in missing.items()]
    print_table(f"An ordinary HMM on all walks, {n_rounds} rounds", ["", "ms"], rows)
    print("Another model: its states last for geometric times, and any of the 50 may follow where the chains allow it.")
    note = missing.get(_HMM, "the peer's is an ordinary hidden Markov model, of which no difference is told")
    task = f"HSMM training, densities, forward and backward, {len(walks)} walks"
    return _measure.beside(task, seconds, _E_STEP, _HMM, wanted=_WANTED[_HMM], note=note)


def _score_by_hmmlearn(walks: list[ObservedWalk], parameters: StateParameters) -> Callable[[], object]:
    """Return what scores all walks by hmmlearn, which is imported here."""
    from hmmlearn.hmm import GaussianHMM

    model = GaussianHMM(n_components=_N_STATES, covariance_type="diag", implementation="scaling")  # its faster one
    model.startprob_, model.transmat_ = _markov_chain(walks, parameters)
    model.means_, model.covars_ = parameters.means, parameters.variances
    frames, lengths = np.concatenate([walk.observations for walk in walks]), [len(walk.observations) for walk in walks]
    return lambda: model.score_samples(frames, lengths)


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
    run(findings, __doc__, short="3 rounds instead of 9")
