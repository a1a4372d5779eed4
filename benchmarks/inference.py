"""Leave-one-out, permutations and bootstrap of trait axes: ``python -m benchmarks.inference [--short]``.

This project beside scikit-learn's refits, and beside refits by hand that decompose each fold once, in the same run. All
of it is exact; how far apart the results are stands beside. One core for all of them.
"""

import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.decomposition import PCA
from sklearn.model_selection import GridSearchCV, LeaveOneOut, cross_val_predict
from sklearn.pipeline import Pipeline
from threadpoolctl import threadpool_limits

from benchmarks import _measure
from benchmarks._command import run
from benchmarks._findings import Check, Finding, Row
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table
from eigenwalker.model import (
    BlockScaler,
    TraitRegressor,
    bootstrap_axes,
    loo_matrix,
    loo_predict,
    nested_loo,
    permutation_test,
)

_N_FEATURES = 226
_N_COMPONENTS = 15
_OURS = "eigenwalker loo_predict"
_SKLEARN = "cross_val_predict"
_CACHED = "one SVD a fold, by hand"
_PERMUTED, _FOLDS = "eigenwalker permutation_test", "fold SVDs cached, a loop"
_RESAMPLED, _LOOP = "eigenwalker bootstrap_axes", "a loop of Pipeline fits"
_NESTED, _GRID = "eigenwalker nested_loo", "GridSearchCV in each fold"
_WANTED = {80: 100, 300: 120, 1000: 150}  # walkers left out one by one
_WANTED_BOOTSTRAP = {80: 5}
_PERMUTATION_SECONDS = 0.2
_BOUND = 1e-10  # of predictions, accuracies and cosines: all of it is exact
_MISSING = 0.2  # of the labels, where there are several traits


class _Case(NamedTuple):
    """What is left out of, and how."""

    n_walkers: int
    scaling: str | None = None
    n_controls: int = 0
    n_traits: int = 1

    def __str__(self) -> str:
        parts = [f"{self.n_walkers} walkers, scaling {self.scaling}"]
        parts += [f"{self.n_controls} controls"] * (self.n_controls > 0)
        parts += [f"{self.n_traits} traits with a fifth of the labels missing"] * (self.n_traits > 1)
        return ", ".join(parts)


def findings(*, short: bool) -> list[Finding]:
    """Print all tables, and return a row for each peer, and what is asked of the permutations alone."""
    start = time.perf_counter()
    loo_predict(np.eye(5), np.arange(5.0), n_components=2)
    compiling = time.perf_counter() - start
    with threadpool_limits(1):
        print(describe_machine())
        print("One core for every row: all pools limited to 1 thread by threadpoolctl.")
        print(f"First call, with compiling or loading what was compiled before: {compiling:.1f} s")
        print(f"Vectors: {_N_FEATURES} features, {_N_COMPONENTS} Eigenwalkers of them; variances as in walks")
        found: list[Finding] = [*_leave_one_out(_Case(80), 2 if short else 5)]
        found += _leave_one_out(_Case(300), 1 if short else 3, by_hand=not short)
        if not short:
            found += _leave_one_out(_Case(1000), 1)
        others = [_Case(80, "blocks"), _Case(80, "features")]
        others += [_Case(80, n_controls=2), _Case(80, n_traits=4), _Case(80, "blocks", 2, 4)]
        if not short:
            others += [_Case(300, "blocks"), _Case(300, n_controls=2), _Case(300, n_traits=4)]
        for case in others:
            found += _leave_one_out(case, 1 if short else 3)
        found += _permutations(3 if short else 20)
        found += _bootstrap(80, 200 if short else 1000)
        if not short:
            found += _bootstrap(300, 1000)
        found += _nested(None, 1 if short else 3, [5, 10, 15] if short else list(range(1, 31)))
        if not short:
            found += _nested("blocks", 3, list(range(1, 31)))
    return found


def _make_walkers(n_walkers: int, seed: int = 0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return vectors whose variances fall as those of walks do, and a label that some of them carry."""
    random = np.random.default_rng(seed)
    mixing = np.linalg.qr(random.normal(size=(_N_FEATURES, _N_FEATURES)))[0]
    scores = random.normal(size=(n_walkers, _N_FEATURES)) * 0.1 * np.arange(1, _N_FEATURES + 1) ** -1.0
    labels = np.sign(scores[:, :8] @ random.normal(size=8) + 0.05 * random.normal(size=n_walkers))
    return scores @ mixing, labels


def _pipeline(scaling: str | None) -> Pipeline:
    steps = [] if scaling is None else [("scaler", BlockScaler(unit=scaling))]
    return Pipeline([*steps, ("eigenwalkers", PCA(_N_COMPONENTS, svd_solver="full")), ("trait", TraitRegressor())])


def _decompose_folds(
    vectors: NDArray[np.float64], scaling: str | None
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Return, for each walker left out, least squares of the others on their scores, and the walker's own scores."""
    folds = []
    for walker in range(len(vectors)):
        others = np.delete(vectors, walker, axis=0)
        scale = 1.0 if scaling is None else BlockScaler(unit=scaling).fit(others).scale_
        center = others.mean(axis=0)
        left, lengths, right = np.linalg.svd((others - center) / scale, full_matrices=False)
        solver = (left[:, :_N_COMPONENTS] / lengths[:_N_COMPONENTS]).T
        folds.append((solver, (vectors[walker] - center) / scale @ right[:_N_COMPONENTS].T))
    return folds


def _predict_cached(folds: Sequence[tuple], labels: NDArray[np.float64]) -> NDArray[np.float64]:
    predicted = np.empty(len(labels))
    for walker, (solver, score) in enumerate(folds):
        others = np.delete(labels, walker)
        predicted[walker] = others.mean() + score @ (solver @ others)
    return predicted


def _leave_one_out(case: _Case, n_rounds: int, *, by_hand: bool = True) -> list[Row]:
    """Print one table; more than what is exact is asked of unscaled vectors alone."""
    functions, found = _ways(case)
    if not by_hand:
        functions.pop(_CACHED, None)
    # The round that is not counted would take minutes where there is only one that is.
    seconds = _measure.interleaved(functions, n_rounds, warm=n_rounds > 1)
    rows = [
        [
            name,
            f"{np.median(seconds[name]) * 1e3:.1f}",
            f"{_measure.ratio(seconds, name, _OURS):.1f}",
            f"{np.abs(found[name] - found[_SKLEARN]).max():.1e}",
        ]
        for name in functions
    ]
    title = f"Leave-one-out, {case}, median of {n_rounds} rounds"
    print_table(title, ["", "ms", "time / ours", "most off sklearn"], rows)
    wanted = _WANTED[case.n_walkers] if case == _Case(case.n_walkers) else None
    error = float(np.abs(found[_OURS] - found[_SKLEARN]).max())
    asked = {"wanted": wanted, "error": error, "bound": _BOUND}
    return [_measure.beside(f"leave-one-out, {case}", seconds, _OURS, _SKLEARN, **asked)]


def _ways(case: _Case) -> tuple[dict[str, Callable[[int], float]], dict[str, NDArray[np.float64]]]:
    """Return the ways to leave one out, by name, and the predictions that each of them leaves when it is called."""
    vectors, labels = _make_walkers(case.n_walkers)
    found: dict[str, NDArray[np.float64]] = {}
    options: dict[str, Any] = {"n_components": _N_COMPONENTS, "scaling": case.scaling}
    params = {}
    random = np.random.default_rng(1)
    if case.n_controls:
        options["control"] = labels[:, np.newaxis] + random.normal(size=(case.n_walkers, case.n_controls))
        params["trait__control"] = options["control"]
    if case.n_traits > 1:
        labels = labels[:, np.newaxis] + random.normal(size=(case.n_walkers, case.n_traits))
        labels[random.random(labels.shape) < _MISSING] = np.nan

    def several(name: str, predict: Callable[[], NDArray[np.float64]], times: int = 1) -> Callable[[int], float]:
        def turn(_: int) -> float:
            for _ in range(times):
                found[name] = predict()
            return times

        return turn

    def by_sklearn() -> NDArray[np.float64]:
        return cross_val_predict(_pipeline(case.scaling), vectors, labels, cv=LeaveOneOut(), params=params)

    ways = {_OURS: several(_OURS, lambda: loo_predict(vectors, labels, **options), 3)}
    if not case.n_controls and case.n_traits == 1:
        ways[_CACHED] = several(_CACHED, lambda: _predict_cached(_decompose_folds(vectors, case.scaling), labels))
    return ways | {_SKLEARN: several(_SKLEARN, by_sklearn)}, found


def _permutations(n_rounds: int) -> list[Finding]:
    vectors, labels = _make_walkers(80)
    n_shuffles, n_brute = 10_000, 20
    folds = _decompose_folds(vectors, None)
    keys = np.random.RandomState(np.random.RandomState(0).randint(2**31 - 1)).random_sample((n_brute, 80))
    shuffled = labels[np.argsort(keys, axis=1)]  # the first shuffles of random_state=0
    results = {}

    def ours(turn: int) -> float:
        results["ours"] = permutation_test(
            vectors, labels, n_components=_N_COMPONENTS, n_permutations=n_shuffles, random_state=0
        )
        return n_shuffles

    def from_matrix(turn: int) -> float:
        permutation_test(matrix, labels, n_permutations=n_shuffles, random_state=0)
        return n_shuffles

    def cached(turn: int) -> float:
        results["cached"] = [np.mean(_predict_cached(folds, one) * one > 0) for one in shuffled]
        return n_brute

    def brute(turn: int) -> float:
        one = shuffled[turn % n_brute]
        results[turn] = np.mean(cross_val_predict(_pipeline(None), vectors, one, cv=LeaveOneOut()) * one > 0)
        return 1

    matrix = loo_matrix(vectors, n_components=_N_COMPONENTS)
    functions = {_PERMUTED: ours, "the same from its matrix": from_matrix, _FOLDS: cached, _SKLEARN: brute}
    seconds = _measure.interleaved(functions, n_rounds)
    null = results["ours"].null[:n_brute]
    checked = [turn for turn in range(n_brute) if turn in results]
    errors = {
        _FOLDS: float(np.abs(null - results["cached"]).max()),
        _SKLEARN: float(max(abs(null[turn] - results[turn]) for turn in checked)),
    }
    rows = [
        [
            name,
            f"{np.median(seconds[name]) * n_shuffles:.3g}",
            f"{_measure.ratio(seconds, name, _PERMUTED):.3g}",
            f"{errors[name]:.1e}" if name in errors else "",
        ]
        for name in functions
    ]
    title = f"10,000 permutations, 80 walkers; peers on {n_brute} and {len(checked)} of the same shuffles, extrapolated"
    print_table(title, ["", "s", "time / ours", "accuracies off"], rows)
    total = float(np.median(seconds[_PERMUTED]) * n_shuffles)
    wanted = f"10,000 permutations of 80 walkers in {_PERMUTATION_SECONDS:g} s"
    asked = {"times": n_shuffles, "bound": _BOUND, "note": "the peer on some of the shuffles, extrapolated"}
    return [
        *(
            _measure.beside("10,000 permutations, 80 walkers", seconds, _PERMUTED, name, error=errors[name], **asked)
            for name in (_SKLEARN, _FOLDS)
        ),
        Check(wanted, f"{total:.3f} s", total < _PERMUTATION_SECONDS, guarded=False),
    ]


def _bootstrap(n_walkers: int, n_resamples: int) -> list[Row]:
    vectors, labels = _make_walkers(n_walkers)
    n_loop = 10
    draws = np.random.RandomState(0).randint(n_walkers, size=(n_resamples, n_walkers))[:n_loop]
    found = {}

    def ours(turn: int) -> float:
        options = {"n_components": _N_COMPONENTS, "scaling": "blocks", "random_state": 0}
        found["ours"] = bootstrap_axes(vectors, labels, n_resamples=n_resamples, **options).cosines
        return n_resamples + n_walkers + 1  # the jackknife of BCa, and everybody

    def loop(turn: int) -> float:
        whole, *others = (_fit_axis(vectors[draw], labels[draw]) for draw in (np.arange(n_walkers), *draws))
        found["loop"] = np.array([_cosine(axis, whole) for axis in others])
        return n_loop + 1

    seconds = _measure.interleaved({_RESAMPLED: ours, _LOOP: loop}, 5)
    error = float(np.abs(found["ours"][:n_loop] - found["loop"]).max())
    rows = [
        [name, f"{np.median(values) * 1e3:.2f}", f"{_measure.ratio(seconds, name, _RESAMPLED):.1f}"]
        for name, values in seconds.items()
    ]
    print_table(
        f"Bootstrap, {n_walkers} walkers, scaling blocks; {n_resamples} resamples and jackknife, beside {n_loop}",
        ["", "ms a fit", "time / ours"],
        rows,
    )
    print(f"cosines with the axis of everybody differ by {error:.1e} at most")
    asked = {"wanted": _WANTED_BOOTSTRAP.get(n_walkers), "error": error, "bound": _BOUND}
    return [_measure.beside(f"bootstrap of axes, {n_walkers} walkers, a fit", seconds, _RESAMPLED, _LOOP, **asked)]


def _fit_axis(vectors: NDArray[np.float64], labels: NDArray[np.float64]) -> tuple:
    """Return the change of the features for alpha = 1, and their scales."""
    model = _pipeline("blocks").fit(vectors, labels)
    step = model[-1].step([[1.0]], model[-1].trait_names_) @ model["eigenwalkers"].components_
    return step[0] * model["scaler"].scale_, model["scaler"].scale_


def _cosine(axis: tuple, whole: tuple) -> float:
    one, other = axis[0] / whole[1], whole[0] / whole[1]
    return float(one @ other / np.linalg.norm(one) / np.linalg.norm(other))


def _nested(scaling: str | None, n_slow: int, numbers: list[int]) -> list[Row]:
    """Print nested leave-one-out beside a grid search in each fold, of some walkers, and return its row."""
    vectors, labels = _make_walkers(80)
    start = time.perf_counter()
    ours = nested_loo(vectors, labels, n_components=numbers, scaling=scaling)
    middle = time.perf_counter()
    searches = [_search_others(vectors, labels, walker, scaling, numbers) for walker in range(n_slow)]
    seconds, slow = middle - start, (time.perf_counter() - middle) * 80 / n_slow
    chosen, predicted = np.transpose(searches)
    n_same = np.sum(chosen == ours.n_components[:n_slow])
    error = float(np.abs(predicted - ours.predictions[:n_slow]).max())
    rows = [[_NESTED, f"{seconds:.3g}", "1"], [_GRID, f"{slow:.3g}", f"{slow / seconds:.3g}"]]
    title = f"nested leave-one-out, 80 walkers, scaling {scaling}, {len(numbers)} numbers of Eigenwalkers"
    print_table(f"{title}; the peer on {n_slow} walkers, extrapolated", ["", "s", "time / ours"], rows)
    print(f"{n_same} of {n_slow} numbers are the same, predictions differ by {error:.1e} at most;")
    print(f"accuracy {ours.score:.3f}, best of the curve {ours.curve.max():.3f}")
    asked = {"error": error, "bound": _BOUND, "note": f"the peer on {n_slow} walkers, extrapolated"}
    return [Row(title, seconds, _GRID, slow, slow / seconds, **asked)]


def _search_others(
    vectors: NDArray[np.float64], labels: NDArray[np.float64], walker: int, scaling: str | None, numbers: list[int]
) -> tuple[int, float]:
    """Return the number of Eigenwalkers that is best for the others among themselves, and what it predicts."""
    others, grid = np.arange(len(labels)) != walker, {"eigenwalkers__n_components": numbers}
    search = GridSearchCV(_pipeline(scaling), grid, scoring=_is_right, cv=LeaveOneOut())
    search.fit(vectors[others], labels[others])
    return search.best_params_["eigenwalkers__n_components"], search.predict(vectors[[walker]])[0]


def _is_right(model: Pipeline, vectors: NDArray[np.float64], labels: NDArray[np.float64]) -> float:
    return float(np.mean(model.predict(vectors) * labels > 0))


if __name__ == "__main__":
    run(findings, __doc__, short="no 1,000 walkers, few rounds and data sets")
