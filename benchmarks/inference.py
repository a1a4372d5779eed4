"""Leave-one-out, permutations and bootstrap of trait axes: ``python -m benchmarks.inference [--short]``.

This project beside scikit-learn's refits, and beside refits by hand that decompose each fold once, in the same run. All
of it is exact; how far apart the results are stands beside. One core for all of them.
"""

import argparse
import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import kstest
from sklearn.decomposition import PCA
from sklearn.model_selection import LeaveOneOut, cross_val_predict
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
_WANTED = {80: 100, 300: 120, 1000: 150}
Target = tuple[str, str, bool | None]


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
        targets = _leave_one_out(80, None, 2 if short else 5, 1)
        targets += _leave_one_out(300, None, 1 if short else 3, 1)
        targets += _leave_one_out(1000, None, 1, 1 if not short else None)
        for n_walkers, scaling in ((80, "blocks"), (80, "features"), *(() if short else ((300, "blocks"),))):
            _leave_one_out(n_walkers, scaling, 1 if short else 3, 1)
        targets += _permutations(3 if short else 9)
        targets += _bootstrap(80, 1000) + _bootstrap(300, 300 if short else 1000)
        _nested(3 if short else 9)
        targets += _uniformity(60 if short else 500)
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


def _leave_one_out(n_walkers: int, scaling: str | None, n_rounds: int, n_slow: int | None) -> list[Target]:
    """Print one table; return the targets for unscaled vectors."""
    wanted = f"leave-one-out of {n_walkers} at least {_WANTED.get(n_walkers)} times as fast as cross_val_predict"
    if n_slow is None:
        return [(wanted, "", None)]
    vectors, labels = _make_walkers(n_walkers)
    found: dict[str, NDArray[np.float64]] = {}

    def run(name: str, predict: Callable[[], NDArray[np.float64]], times: int = 1) -> Callable[[int], float]:
        def turn(_: int) -> float:
            for _ in range(times):
                found[name] = predict()
            return times

        return turn

    functions = {
        _OURS: run(_OURS, lambda: loo_predict(vectors, labels, n_components=_N_COMPONENTS, scaling=scaling), 3),
        _CACHED: run(_CACHED, lambda: _predict_cached(_decompose_folds(vectors, scaling), labels)),
        _SKLEARN: run(_SKLEARN, lambda: cross_val_predict(_pipeline(scaling), vectors, labels, cv=LeaveOneOut())),
    }
    seconds = _interleave(functions, n_rounds, warm=n_walkers < 1000)
    rows = [
        [
            name,
            f"{np.median(seconds[name]) * 1e3:.1f}",
            f"{_measure.ratio(seconds, name, _OURS):.1f}",
            f"{np.abs(found[name] - found[_SKLEARN]).max():.1e}",
        ]
        for name in functions
    ]
    title = f"Leave-one-out, {n_walkers} walkers, scaling {scaling}, median of {n_rounds} rounds"
    _measure.print_table(title, ["", "ms", "time / ours", "most off sklearn"], rows)
    factor, error = _measure.ratio(seconds, _SKLEARN, _OURS), np.abs(found[_OURS] - found[_SKLEARN]).max()
    if scaling is not None:
        return []
    return [
        (wanted, f"{factor:.0f}", factor >= _WANTED[n_walkers]),
        (f"within 1e-10 of it, {n_walkers}", f"{error:.1e}", error <= 1e-10),
    ]


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

    seconds = _measure.interleaved({"eigenwalker bootstrap_axes": ours, "a loop of Pipeline fits": loop}, 3)
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


def _nested(n_candidates: int) -> None:
    vectors, labels = _make_walkers(80)
    start = time.perf_counter()
    numbers = range(1, 4 * n_candidates)
    result = nested_loo(vectors, labels, n_components=numbers)
    print(
        f"\nNested leave-one-out of 80 walkers over {len(numbers)} numbers of components: "
        f"{time.perf_counter() - start:.2f} s; accuracy {result.score:.3f}, best of the curve {result.curve.max():.3f}"
    )


def _uniformity(n_sets: int) -> list[Target]:
    """Print how often p is at most a when labels mean nothing."""
    levels = np.array([0.01, 0.05, 0.1, 0.25, 0.5, 0.75])
    rows, targets = [], []
    enough = n_sets >= 500  # fewer say nothing about three standard errors in four rows at once
    for score in ("accuracy", "balanced_accuracy", "auc", "r"):
        random = np.random.default_rng(1)
        p_values = np.empty(n_sets)
        for number in range(n_sets):
            vectors = random.normal(size=(40, 30)) * np.arange(1, 31) ** -0.5
            labels = random.normal(size=40) if score == "r" else random.permutation(np.repeat([-1.0, 1.0], 20))
            options = {"score": score, "n_permutations": 999, "random_state": number}
            p_values[number] = permutation_test(vectors, labels, n_components=8, **options).p_value
        shares = np.array([np.mean(p_values <= level) for level in levels])
        allowed = levels + 3 * np.sqrt(levels * (1 - levels) / n_sets)
        distance = kstest(p_values, "uniform").pvalue
        rows.append([score, *[f"{share:.3f}" for share in shares], f"{distance:.2f}"])
        met = bool((shares <= allowed).all()) if enough else None
        targets.append((f"P(p <= a) <= a within 3 standard errors, {score}", "", met))
        if score == "r":
            targets.append(
                (
                    "p uniform with a continuous score (Kolmogorov-Smirnov)",
                    f"{distance:.2f}",
                    distance > 0.01 if enough else None,
                )
            )
    title = f"Share of {n_sets} data sets without effect with p <= a; 40 walkers, 999 shuffles"
    _measure.print_table(title, ["", *[f"a = {level}" for level in levels], "KS p"], rows)
    return targets


if __name__ == "__main__":
    main()
