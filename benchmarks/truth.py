"""What the statistics say of walkers whose truth is known: ``python -m benchmarks.truth [--short]``.

Sets of walkers are drawn from one pool of synthetic walkers, each without replacement; fresh walkers are all others of
the pool. Given the pool, which is then the population, the draws are independent of each other, so that standard errors
over sets are right although sets share walkers.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy.stats import kstest
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline
from threadpoolctl import threadpool_limits

from benchmarks._command import run
from benchmarks._findings import Check
from benchmarks._machine import describe_machine
from benchmarks._tables import print_table
from eigenwalker.datasets import make_walkers
from eigenwalker.model import (
    BlockScaler,
    FourierLinearizer,
    TraitRegressor,
    feature_parts,
    loo_predict,
    make_eigenwalkers,
    nested_loo,
    permutation_test,
)

_N_COMPONENTS = 15
_CONTROLS = ["gender", "height"]


class _Pool(NamedTuple):
    """Walkers as vectors, their traits as numbers; what each trait changes, and what goes along with each trait."""

    vectors: pd.DataFrame
    traits: pd.DataFrame
    planted: pd.DataFrame
    together: pd.DataFrame

    def draw(self, n_walkers: int, n_sets: int) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp]]]:
        """Yield who is in each set, and who is not."""
        random = np.random.default_rng(n_walkers)
        for _ in range(n_sets):
            order = random.permutation(len(self.vectors))
            yield order[:n_walkers], order[n_walkers:]


def findings(*, short: bool) -> list[Check]:
    """Print all tables, and return what is asked of them."""
    with threadpool_limits(1):
        print(describe_machine())
        pool = _make_pool(500 if short else 3000)
        print(f"Pool: {len(pool.vectors)} walkers of make_walkers(duration=4, frame_rate=60), {pool.vectors.shape[1]}")
        print("features, scaling blocks. With standard errors over the sets of walkers drawn from it.")
        checks = _uniformity(pool, 40 if short else 500)
        checks += _planted(pool, 10 if short else 100)
        checks += _nested(pool, {20: 10, 40: 8} if short else {20: 500, 40: 200, 80: 80})
        checks += _controlled(pool, 20 if short else 200)
        _held(pool, 5 if short else 50)
        return checks + _parts(pool, 5 if short else 100)


def _make_pool(n_walkers: int) -> _Pool:
    walkers = make_walkers(n_walkers, duration=4, frame_rate=60, random_state=0)
    vectors = FourierLinearizer().set_output(transform="pandas").fit_transform(walkers.data)
    traits = walkers.target.assign(gender=np.where(walkers.target["gender"] == "male", 1.0, -1.0))
    return _Pool(vectors, traits, walkers.feature_axes, walkers.feature_axes @ traits.corr())


def _fit(
    pool: _Pool,
    walkers: NDArray[np.intp],
    labels: ArrayLike | pd.DataFrame,
    *,
    n_components: int = _N_COMPONENTS,
    control: pd.DataFrame | None = None,
) -> Pipeline:
    model = make_eigenwalkers(n_components=n_components)[1:]
    return model.fit(pool.vectors.iloc[walkers], labels, trait__control=control)


def _axis(model: Pipeline, trait: str) -> NDArray[np.float64]:
    """Return what a trait's alpha = 1 changes in the scaled features."""
    return (model["trait"].step([[1.0]], [trait]) @ model["eigenwalkers"].components_)[0]


def _cosine(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    return float(one @ other / np.linalg.norm(one) / np.linalg.norm(other))


def _error(values: ArrayLike) -> float:
    """Return the standard error of the mean."""
    return float(np.std(values, ddof=1) / np.sqrt(np.size(values)))


def _mean(values: ArrayLike) -> str:
    return f"{np.mean(values):.3f} ± {_error(values):.3f}"


def _uniformity(pool: _Pool, n_sets: int) -> list[Check]:
    """Print how often p is at most a when the labels are shuffled, and mean nothing."""
    levels = np.array([0.01, 0.05, 0.1, 0.25, 0.5, 0.75])
    rows, checks = [], []
    enough = n_sets >= 500  # fewer say nothing about three standard errors in four rows at once
    for score in ("accuracy", "balanced_accuracy", "auc", "r"):
        p_values = _null_p_values(pool, score, n_sets)
        shares = np.array([np.mean(p_values <= level) for level in levels])
        above = (shares - levels) / np.sqrt(levels * (1 - levels) / n_sets)
        rows.append([score, *[f"{share:.3f}" for share in shares]])
        met = bool(above.max() <= 3) if enough else None
        checks.append(Check(f"P(p <= a) <= a within 3 standard errors, {score}", f"{above.max():+.1f}", met))
    p = float(kstest(p_values, "uniform").pvalue)
    checks.append(Check("p uniform with a continuous score, r (Kolmogorov-Smirnov)", f"{p:.2f}", p > 0.01))
    title = f"Share of {n_sets} sets of 40 walkers with shuffled labels with p <= a; 8 Eigenwalkers, 999 shuffles"
    print_table(title, ["", *[f"a = {level}" for level in levels]], rows)
    return checks


def _null_p_values(pool: _Pool, score: str, n_sets: int) -> NDArray[np.float64]:
    random, p_values = np.random.default_rng(1), np.empty(n_sets)
    labels = pool.traits["weight" if score == "r" else "gender"].to_numpy()
    options = {"score": score, "n_components": 8, "scaling": "blocks", "n_permutations": 999}
    for number, (some, _) in enumerate(pool.draw(40, n_sets)):
        shuffled = random.permutation(labels[some])
        p_values[number] = permutation_test(pool.vectors.iloc[some], shuffled, random_state=number, **options).p_value
    return p_values


def _planted(pool: _Pool, n_sets: int) -> list[Check]:
    """Print how near the axes are to what goes along with each trait."""
    sizes, names = (20, 40, 80, 160, 320), list(pool.traits)
    cosines = np.empty((len(sizes), n_sets, len(names)))
    for found, size in zip(cosines, sizes, strict=True):
        for row, (some, _) in zip(found, pool.draw(size, n_sets), strict=True):
            model = _fit(pool, some, pool.traits.iloc[some])
            scale = model["scaler"].scale_
            row[:] = [_cosine(_axis(model, name), pool.together[name].to_numpy() / scale) for name in names]
    rows = [[str(size), *[_mean(column) for column in found.T]] for size, found in zip(sizes, cosines, strict=True)]
    title = f"Cosine of an axis with what goes along with its trait, {n_sets} sets, {_N_COMPONENTS} Eigenwalkers"
    print_table(title, ["walkers", *names], rows)
    means = cosines.mean(axis=1)
    met = bool((np.diff(means, axis=0) > 0).all())
    wanted = "planted axes are found the better the more walkers, all traits"
    return [Check(wanted, f"{means[-1].min():.2f} at least", met)]


def _nested(pool: _Pool, n_sets: dict[int, int]) -> list[Check]:
    """Print accuracies of gender: nested leave-one-out, the best of plain leave-one-out, and on fresh walkers."""
    rows, checks = [], []
    for size, number in n_sets.items():
        nested, best, fresh = np.array([_accuracies(pool, *parts) for parts in pool.draw(size, number)]).T
        rows.append([f"{size}", f"{number}", *map(_mean, (nested, best, fresh, nested - fresh, best - fresh))])
        over, error = np.mean(nested - fresh), _error(nested - fresh)
        text = f"nested accuracy of {size} not above that on fresh walkers by 2 standard errors"
        checks.append(Check(text, f"{over:+.4f} ± {error:.4f}", bool(over < 2 * error) if number >= 50 else None))
    header = ["walkers", "sets", "nested", "best of curve", "fresh", "nested - fresh", "best - fresh"]
    print_table("Accuracy of gender, the number of Eigenwalkers chosen of 2 to 15", header, rows)
    return checks


def _accuracies(pool: _Pool, some: NDArray[np.intp], others: NDArray[np.intp]) -> tuple[float, float, float]:
    codes = pool.traits["gender"].to_numpy()
    result = nested_loo(pool.vectors.iloc[some], codes[some], n_components=range(2, 16), scaling="blocks")
    chosen = result.candidates[np.argmax(result.curve > result.curve.max() - 1e-9)]  # the smallest of equals
    model = _fit(pool, some, codes[some], n_components=int(chosen))
    fresh = np.mean(model.predict(pool.vectors.iloc[others]) * codes[others] > 0)
    return float(result.score), float(result.curve.max()), float(fresh)


def _controlled(pool: _Pool, n_sets: int) -> list[Check]:
    """Print what is left of the controls in an axis of weight, among walkers in training and fresh ones."""
    rows, checks = [], []
    shown, hidden = _shown_and_hidden(pool)
    for size in (80, 160, 320):
        found = np.array([_left_of_controls(pool, *parts) for parts in pool.draw(size, n_sets)])
        expected = _expected_covariance(shown, hidden, size)
        for name, (free, held, covariance, training), value in zip(_CONTROLS, found.T, expected, strict=True):
            cells = [_mean(free), _mean(held), _mean(covariance), f"{value:.3f}", f"{abs(training).max():.0e}"]
            rows.append([f"{size}, {name}", *cells])
        most = abs(found[:, 3]).max()
        checks.append(
            Check(f"{size}: no covariance of a controlled axis in training", f"{most:.0e}", bool(most < 1e-10))
        )
        off = abs(found[:, 1, 1].mean()) / _error(found[:, 1, 1])
        checks.append(Check(f"{size}: fresh walkers, none with height (standard errors)", f"{off:.1f}", bool(off < 3)))
    off = abs(found[:, 2, 0].mean() - expected[0]) / _error(found[:, 2, 0])
    checks.append(Check("320: fresh walkers, with gender as expected (standard errors)", f"{off:.1f}", bool(off < 3)))
    header = ["walkers, control", "r, uncontrolled", "r, controlled", "covariance", "expected", "most in training"]
    title = (
        f"An axis of weight and its controls, gender and height, on fresh walkers, {n_sets} sets; covariances in SDs"
    )
    print_table(title, header, rows)
    known = ", ".join(f"{share:.2f} of {name}" for share, name in zip(np.diag(shown), _CONTROLS, strict=False))
    print(f"Walks show {known}; what they hide of a control stays in the axis, the less the more walkers")
    return checks


def _left_of_controls(pool: _Pool, some: NDArray[np.intp], others: NDArray[np.intp]) -> tuple[NDArray[np.float64], ...]:
    """Return of each control: fresh correlations without and with control, and covariances, fresh and in training."""
    controls, weight = pool.traits[_CONTROLS], pool.traits["weight"]
    reduction = make_eigenwalkers(n_components=_N_COMPONENTS)[1:-1]
    scores, fresh = reduction.fit_transform(pool.vectors.iloc[some]), reduction.transform(pool.vectors.iloc[others])
    free = TraitRegressor().fit(scores, weight.iloc[some])
    held = TraitRegressor().fit(scores, weight.iloc[some], control=controls.iloc[some])
    training, known = held.transform(scores)[:, 0], controls.iloc[others]
    correlations = [np.corrcoef(axis.transform(fresh)[:, 0], known.T)[0, 1:] for axis in (free, held)]
    covariance = _covariance(held.predict(fresh), known) / (controls.std() * weight.std()).to_numpy()
    return *correlations, covariance, _covariance(training, controls.iloc[some])


def _covariance(values: NDArray[np.float64], controls: pd.DataFrame) -> NDArray[np.float64]:
    return np.cov(values, controls.T)[0, 1:]


def _shown_and_hidden(pool: _Pool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the covariances of what scores predict of controls and weight, in SDs, and of what they leave."""
    scores = PCA(_N_COMPONENTS, svd_solver="full").fit_transform(BlockScaler().fit_transform(pool.vectors.to_numpy()))
    columns = pool.traits[[*_CONTROLS, "weight"]].to_numpy()
    columns = (columns - columns.mean(axis=0)) / columns.std(axis=0)
    predicted = scores @ np.linalg.lstsq(scores, columns)[0]
    return np.cov(predicted.T), np.cov((columns - predicted).T)


def _expected_covariance(
    shown: NDArray[np.float64], hidden: NDArray[np.float64], n_walkers: int
) -> NDArray[np.float64]:
    """Return the covariance of a controlled axis with its controls on fresh walkers, to first order in 1 / n_walkers.

    With k components, q controls Z and a label y, whose best predictions from the scores are P and p, and what these
    leave of them R and r, it is (k - q) / n (cov(R) A - cov(R, r)), A = cov(P)^-1 cov(P, p): the covariance of scores
    and controls is known up to what walks do not show of these, so that too little of it is taken out (errors in
    variables). None is expected of a control that walks show in full.
    """
    q = len(_CONTROLS)
    slopes = np.linalg.solve(shown[:q, :q], shown[:q, q])
    return (_N_COMPONENTS - q) / n_walkers * (hidden[:q, :q] @ slopes - hidden[:q, q])


def _held(pool: _Pool, n_sets: int) -> None:
    """Print how near axes of weight are to what weight itself changes, gender and height held."""
    rows = []
    for size, n_components in ((80, 15), (320, 15), (320, 60)):
        found = [_cosines_with_planted(pool, some, n_components) for some, _ in pool.draw(size, n_sets)]
        rows.append([f"{size}, {n_components} Eigenwalkers", *map(_mean, np.transpose(found))])
    title = f"Cosine of axes with what weight changes while gender and height stay, {n_sets} sets"
    print_table(title, ["walkers", "no control", "controlled", "label less its regression on both"], rows)


def _cosines_with_planted(pool: _Pool, some: NDArray[np.intp], n_components: int) -> list[float]:
    controls, weight = pool.traits[_CONTROLS].iloc[some], pool.traits["weight"].iloc[some]
    design = np.column_stack((np.ones(len(some)), controls))
    rest = weight - design @ np.linalg.lstsq(design, weight.to_numpy())[0]
    kinds: Sequence[tuple[pd.Series, pd.DataFrame | None]] = ((weight, None), (weight, controls), (rest, None))
    models = [_fit(pool, some, y, n_components=n_components, control=control) for y, control in kinds]
    planted = pool.planted["weight"].to_numpy()
    return [_cosine(_axis(model, "weight"), planted / model["scaler"].scale_) for model in models]


def _parts(pool: _Pool, n_sets: int) -> list[Check]:
    """Print what structure and dynamics tell about gender (Troje 2002, section 4)."""
    numbers = [5, 10, 15, 20, 30]
    found = [_parts_of_gender(pool, some, numbers) for some, _ in pool.draw(80, n_sets)]  # (n_sets, 4, n_numbers)
    rows = [
        [str(number), *map(_mean, values.T)] for number, values in zip(numbers, np.moveaxis(found, 2, 0), strict=True)
    ]
    header = ["Eigenwalkers", "both", "structure alone", "dynamics alone", "share of structure in the axis"]
    print_table(f"Accuracy of gender, leave-one-out of 80 walkers, {n_sets} sets", header, rows)
    scale = BlockScaler().fit(pool.vectors).scale_
    along, planted = (_share(axes["gender"].to_numpy() / scale, pool) for axes in (pool.together, pool.planted))
    print(f"Structure has {along:.3f} of what goes along with gender, {planted:.3f} of what gender itself changes")
    share = float(np.mean(found, axis=0)[3, 2])
    text = f"share of structure with 15 Eigenwalkers within 0.05 of that planted, {along:.3f}"
    return [Check(text, f"{share:.3f}", bool(abs(share - along) < 0.05))]


def _parts_of_gender(pool: _Pool, some: NDArray[np.intp], numbers: list[int]) -> list[NDArray[np.float64]]:
    vectors, codes = pool.vectors.iloc[some], pool.traits["gender"].to_numpy()[some]
    options = {"n_components": numbers, "scaling": "blocks"}
    weights: Sequence[dict[str, float] | None] = (None, {"dynamics": 0.0}, {"structure": 0.0})
    predicted = [loo_predict(vectors, codes, weights=each, **options) for each in weights]
    models = [_fit(pool, some, codes, n_components=number) for number in numbers]
    shares = [_share(_axis(model, model["trait"].trait_names_[0]), pool) for model in models]
    return [*[np.mean(one * codes > 0, axis=1) for one in predicted], np.array(shares)]


def _share(axis: NDArray[np.float64], pool: _Pool) -> float:
    """Return the share of structure in the squared length of an axis of scaled features."""
    squares = axis**2
    return float(squares[feature_parts(pool.vectors.columns) == "structure"].sum() / squares.sum())


if __name__ == "__main__":
    run(findings, __doc__, short="500 walkers instead of 3,000, few sets of them")
