"""Leave-one-out, permutations and bootstrap of trait axes: ``python -m benchmarks.inference [--short]``.

This project beside scikit-learn's refits, and beside refits by hand that decompose each fold once, in the same run. All
of it is exact; how far apart the results are stands beside. One core for all of them.
"""

import argparse
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sklearn.decomposition import PCA
from sklearn.model_selection import GridSearchCV, LeaveOneOut, cross_val_predict
from sklearn.pipeline import Pipeline
from threadpoolctl import threadpool_limits

from benchmarks import _measure
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
_NESTED, _GRID = "eigenwalker nested_loo", "GridSearchCV in each fold"
_WANTED = {80: 100, 300: 120, 1000: 150}
_MISSING = 0.2  # of the labels, where there are several traits
Target = tuple[str, str, bool | None]


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


def main() -> None:
    """Print all tables and the targets."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="no 1,000 walkers, few rounds and data sets")
    short = parser.parse_args().short
    start = time.perf_counter()
    loo_predict(np.eye(5), np.arange(5.0), n_components=2)
    compiling = time.perf_counter() - start
    with threadpool_limits(1):
        print(_measure.describe_machine())
        print("One core for every row: all pools limited to 1 thread by threadpoolctl.")
        print(f"First call, with compiling or loading what was compiled before: {compiling:.1f} s")
        print(f"Vectors: {_N_FEATURES} features, {_N_COMPONENTS} Eigenwalkers of them; variances as in walks")
        targets = _leave_one_out(_Case(80), 2 if short else 5)
        targets += _leave_one_out(_Case(300), 1 if short else 3)
        targets += _leave_one_out(_Case(1000), 0 if short else 1)
        others = [_Case(80, "blocks"), _Case(80, "features")]
        others += [_Case(80, n_controls=2), _Case(80, n_traits=4), _Case(80, "blocks", 2, 4)]
        if not short:
            others += [_Case(300, "blocks"), _Case(300, n_controls=2), _Case(300, n_traits=4)]
        for case in others:
            _leave_one_out(case, 1 if short else 3)
        targets += _permutations(3 if short else 9)
        targets += _bootstrap(80, 200 if short else 1000)
        if not short:
            _bootstrap(300, 1000)
        _nested(None, 1 if short else 3, [5, 10, 15] if short else list(range(1, 31)))
        if not short:
            _nested("blocks", 3, list(range(1, 31)))
    _measure.print_targets(targets)


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


def _leave_one_out(case: _Case, n_rounds: int) -> list[Target]:
    """Print one table; return the targets for unscaled vectors."""
    wanted = f"leave-one-out of {case.n_walkers} at least {_WANTED.get(case.n_walkers)} times as fast as {_SKLEARN}"
    if not n_rounds:
        return [(wanted, "", None)]
    functions, found = _ways(case)
    seconds = _interleave(functions, n_rounds, warm=n_rounds > 1)
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
    _measure.print_table(title, ["", "ms", "time / ours", "most off sklearn"], rows)
    factor, error = _measure.ratio(seconds, _SKLEARN, _OURS), np.abs(found[_OURS] - found[_SKLEARN]).max()
    if case != _Case(case.n_walkers):
        return []
    return [
        (wanted, f"{factor:.0f}", factor >= _WANTED[case.n_walkers]),
        (f"within 1e-10 of it, {case.n_walkers}", f"{error:.1e}", error <= 1e-10),
    ]


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

    def run(name: str, predict: Callable[[], NDArray[np.float64]], times: int = 1) -> Callable[[int], float]:
        def turn(_: int) -> float:
            for _ in range(times):
                found[name] = predict()
            return times

        return turn

    def by_sklearn() -> NDArray[np.float64]:
        return cross_val_predict(_pipeline(case.scaling), vectors, labels, cv=LeaveOneOut(), params=params)

    ways = {_OURS: run(_OURS, lambda: loo_predict(vectors, labels, **options), 3)}
    if not case.n_controls and case.n_traits == 1:
        ways[_CACHED] = run(_CACHED, lambda: _predict_cached(_decompose_folds(vectors, case.scaling), labels))
    return ways | {_SKLEARN: run(_SKLEARN, by_sklearn)}, found


def _interleave(
    functions: Mapping[str, Callable[[int], float]], n_rounds: int, *, warm: bool = True
) -> dict[str, NDArray[np.float64]]:
    """Return `interleaved` seconds; without the round that is not counted where it would take minutes."""
    if warm:
        return _measure.interleaved(functions, n_rounds)
    seconds = {name: np.empty(n_rounds) for name in functions}
    for turn in range(n_rounds):
        for name, function in functions.items():
            start = time.perf_counter()
            n_done = function(turn)
            seconds[name][turn] = (time.perf_counter() - start) / n_done
    return seconds


def _permutations(n_rounds: int) -> list[Target]:
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
    names = ("eigenwalker permutation_test", "the same from its matrix", "fold SVDs cached, a loop", _SKLEARN)
    functions = dict(zip(names, (ours, from_matrix, cached, brute), strict=True))
    seconds = _measure.interleaved(functions, max(n_rounds, 20 if n_rounds > 5 else n_rounds))
    null = results["ours"].null[:n_brute]
    checked = [turn for turn in range(n_brute) if turn in results]
    off_cached = np.abs(null - results["cached"]).max()
    off_brute = max(abs(null[turn] - results[turn]) for turn in checked)
    rows = [
        [
            name,
            f"{np.median(seconds[name]) * n_shuffles:.3g}",
            f"{_measure.ratio(seconds, name, names[0]):.3g}",
            error,
        ]
        for name, error in zip(names, ("", "", f"{off_cached:.1e}", f"{off_brute:.1e}"), strict=True)
    ]
    title = f"10,000 permutations, 80 walkers; peers on {n_brute} and {len(checked)} of the same shuffles, extrapolated"
    _measure.print_table(title, ["", "s", "time / ours", "accuracies off"], rows)
    total = float(np.median(seconds[names[0]]) * n_shuffles)
    return [("10,000 permutations of 80 walkers in 0.2 s", f"{total:.3f} s", total < 0.2)]


def _bootstrap(n_walkers: int, n_resamples: int) -> list[Target]:
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

    seconds = _measure.interleaved({"eigenwalker bootstrap_axes": ours, "a loop of Pipeline fits": loop}, 5)
    error = np.abs(found["ours"][:n_loop] - found["loop"]).max()
    factor = _measure.ratio(seconds, "a loop of Pipeline fits", "eigenwalker bootstrap_axes")
    rows = [
        [name, f"{np.median(values) * 1e3:.2f}", f"{_measure.ratio(seconds, name, 'eigenwalker bootstrap_axes'):.1f}"]
        for name, values in seconds.items()
    ]
    _measure.print_table(
        f"Bootstrap, {n_walkers} walkers, scaling blocks; {n_resamples} resamples and jackknife, beside {n_loop}",
        ["", "ms a fit", "time / ours"],
        rows,
    )
    print(f"cosines with the axis of everybody differ by {error:.1e} at most")
    return [("bootstrap of 80 at least 5 times as fast as a loop", f"{factor:.1f}", factor >= 5)] * (n_walkers == 80)


def _fit_axis(vectors: NDArray[np.float64], labels: NDArray[np.float64]) -> tuple:
    """Return the change of the features for alpha = 1, and their scales."""
    model = _pipeline("blocks").fit(vectors, labels)
    step = model[-1].step([[1.0]], model[-1].trait_names_) @ model["eigenwalkers"].components_
    return step[0] * model["scaler"].scale_, model["scaler"].scale_


def _cosine(axis: tuple, whole: tuple) -> float:
    one, other = axis[0] / whole[1], whole[0] / whole[1]
    return float(one @ other / np.linalg.norm(one) / np.linalg.norm(other))


def _nested(scaling: str | None, n_slow: int, numbers: list[int]) -> None:
    """Print nested leave-one-out beside a grid search in each fold, of some walkers."""
    vectors, labels = _make_walkers(80)
    start = time.perf_counter()
    ours = nested_loo(vectors, labels, n_components=numbers, scaling=scaling)
    middle = time.perf_counter()
    searches = [_search_others(vectors, labels, walker, scaling, numbers) for walker in range(n_slow)]
    seconds, slow = middle - start, (time.perf_counter() - middle) * 80 / n_slow
    chosen, predicted = np.transpose(searches)
    n_same, error = np.sum(chosen == ours.n_components[:n_slow]), np.abs(predicted - ours.predictions[:n_slow]).max()
    rows = [[_NESTED, f"{seconds:.3g}", "1"], [_GRID, f"{slow:.3g}", f"{slow / seconds:.3g}"]]
    title = f"Nested leave-one-out, 80 walkers, scaling {scaling}, {len(numbers)} numbers of Eigenwalkers"
    _measure.print_table(f"{title}; the peer on {n_slow} walkers, extrapolated", ["", "s", "time / ours"], rows)
    print(f"{n_same} of {n_slow} numbers are the same, predictions differ by {error:.1e} at most;")
    print(f"accuracy {ours.score:.3f}, best of the curve {ours.curve.max():.3f}")


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
    main()
