"""What the statistics say of synthetic walkers, whose truth is known.

Sets of walkers are drawn from one pool; fresh walkers are those that were not drawn. Given the pool, which is then the
population, draws are independent, so that standard errors over sets are right although sets share walkers.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.stats import kstest

from eigenwalker.datasets import make_walkers
from eigenwalker.model import (
    BlockScaler,
    FourierLinearizer,
    TraitRegressor,
    axis_shares,
    feature_parts,
    loo_predict,
    make_eigenwalkers,
    nested_loo,
    permutation_test,
    walk_along_axis,
)

N_WALKERS = 320


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(N_WALKERS, duration=4, frame_rate=60, random_state=0)


@pytest.fixture(scope="module")
def vectors(walkers):
    return FourierLinearizer().set_output(transform="pandas").fit_transform(walkers.data)


@pytest.fixture(scope="module")
def traits(walkers):
    return walkers.target.assign(gender=np.where(walkers.target["gender"] == "male", 1.0, -1.0))


def draw(n_walkers, n_sets):
    """Yield who is in each set, and who is not."""
    random = np.random.default_rng(n_walkers)
    for _ in range(n_sets):
        order = random.permutation(N_WALKERS)
        yield order[:n_walkers], order[n_walkers:]


def axes_of(model):
    """Return what alpha = 1 on each axis changes in the scaled features, shape (n_traits, n_features)."""
    steps = np.vstack([model["trait"].step([[1.0]], [name]) for name in model["trait"].trait_names_])
    return steps @ model["eigenwalkers"].components_


def standard_error(values):
    return np.std(values, axis=0, ddof=1) / np.sqrt(len(values))


@pytest.mark.parametrize(("score", "trait"), [("r", "weight"), ("accuracy", "gender")])
def test_p_is_uniform_when_labels_mean_nothing(vectors, traits, score, trait):
    """P(p <= a) <= a, and with a continuous score equal; 200 sets, within three standard errors."""
    random = np.random.default_rng(3)
    labels = traits[trait].to_numpy()
    options = {"n_components": 3, "score": score, "n_permutations": 99}
    p_values = np.array(
        [
            permutation_test(vectors.iloc[some], random.permutation(labels[some]), random_state=seed, **options).p_value
            for seed, (some, _) in enumerate(draw(16, 200))
        ]
    )
    for level in (0.05, 0.1, 0.25, 0.5, 0.75):
        assert np.mean(p_values <= level) <= level + 3 * np.sqrt(level * (1 - level) / 200)
    if score == "r":
        assert kstest(p_values, "uniform").pvalue > 0.01


def test_planted_axes_are_found_the_better_the_more_walkers(walkers, vectors, traits):
    """All that goes along with a trait counts: what it does itself, and what the traits do that go along with it."""
    planted = (walkers.feature_axes @ traits.corr()).to_numpy().T
    means = []
    for n_walkers in (20, 40, 80, 160):
        cosines = []
        for some, _ in draw(n_walkers, 15):
            model = make_eigenwalkers()[1:].fit(vectors.iloc[some], traits.iloc[some])
            one, other = axes_of(model), planted / model["scaler"].scale_
            cosines.append((one * other).sum(axis=1) / np.linalg.norm(one, axis=1) / np.linalg.norm(other, axis=1))
        means.append(np.mean(cosines, axis=0))
    assert (np.diff(means, axis=0) > 0).all()
    names = list(traits)
    assert means[-1][[names.index(name) for name in ("gender", "height", "weight")]].min() > 0.97
    assert means[-1][[names.index(name) for name in ("happy", "nervous")]].min() > 0.85


def test_nested_accuracy_is_not_above_that_of_fresh_walkers(vectors, traits):
    """The best of plain leave-one-out is: the number of components was chosen on those it is scored on."""
    codes = traits["gender"].to_numpy()
    nested, best = [], []
    for some, others in draw(24, 25):
        result = nested_loo(vectors.iloc[some], codes[some], n_components=range(2, 12))
        chosen = result.candidates[np.argmax(result.curve > result.curve.max() - 1e-9)]  # the smallest of equals
        model = make_eigenwalkers(n_components=int(chosen), scaling=None)[1:].fit(vectors.iloc[some], codes[some])
        fresh = np.mean(model.predict(vectors.iloc[others]) * codes[others] > 0)
        nested.append(result.score - fresh)
        best.append(result.curve.max() - fresh)
    assert np.mean(nested) < 2 * standard_error(nested)
    assert np.mean(best) > 2 * standard_error(best)


def test_a_controlled_axis_has_no_covariance_with_its_controls(walkers, traits):
    walks, names = walkers.data[:100], ["gender", "height"]
    model = make_eigenwalkers().fit(walks, traits["weight"][:100], trait__control=walkers.target[names][:100])
    covariance = np.cov(np.column_stack((model.transform(walks), traits[names][:100])).T)
    assert abs(covariance[0, 1:]).max() < 1e-10


def test_a_controlled_axis_is_nearly_free_of_its_controls_on_fresh_walkers(vectors, traits):
    """Free of height, which walks show in full; of gender up to what walks hide of it, the less the more walkers.

    The covariance of scores and a control is known up to its residual, and too little is taken out: errors in
    variables, of the order of n_components / n_walkers; see ``benchmarks.truth``.
    """
    controls, weight = traits[["gender", "height"]], traits["weight"]
    held = {}
    for n_walkers in (60, 160):
        found = np.empty((100, 2, 2))  # without and with control; gender and height
        for row, (some, others) in zip(found, draw(n_walkers, len(found)), strict=True):
            reduction = make_eigenwalkers()[1:-1]
            scores, fresh = reduction.fit_transform(vectors.iloc[some]), reduction.transform(vectors.iloc[others])
            for kind, control in enumerate((None, controls.iloc[some])):
                alphas = TraitRegressor().fit(scores, weight.iloc[some], control=control).transform(fresh)
                row[kind] = np.corrcoef(np.column_stack((alphas, controls.iloc[others])).T)[0, 1:]
        free, held[n_walkers] = found.mean(axis=0)
        assert free.min() > 0.7
        assert held[n_walkers][0] < 0.25 * free[0]
        assert abs(held[n_walkers][1]) < 3 * standard_error(found[:, 1, 1])
    assert held[160][0] < held[60][0]


def test_held_traits_stay_as_they_are(walkers, traits):
    """Each trait is moved, all others are held."""
    model, base = make_eigenwalkers().fit(walkers.data[:100], traits.iloc[:100]), walkers.data[7]
    start, labels = model.transform([base])[0], model.predict([base])[0]
    for moved, (name, alpha) in enumerate(zip(traits, start, strict=True)):
        held = np.arange(len(start)) != moved
        walks = walk_along_axis(model, name, [alpha - 1, alpha + 1], base=base, hold=list(traits.columns[held]))
        assert_allclose(model.transform(walks)[:, moved] - alpha, [-1, 1], rtol=0, atol=1e-9)
        assert_allclose(model.transform(walks)[:, held], [start[held]] * 2, rtol=0, atol=1e-9)
        assert_allclose(model.predict(walks)[:, held], [labels[held]] * 2, rtol=0, atol=1e-9)


def test_structure_and_dynamics_share_gender_as_planted(walkers, vectors, traits):
    """Troje 2002, section 4, asked of walkers in whom structure tells more."""
    codes, numbers = traits["gender"], [5, 10, 15, 20, 30]
    scale = BlockScaler().fit(vectors).scale_
    squares = (walkers.feature_axes @ traits.corr()["gender"] / scale) ** 2
    planted = squares[feature_parts(vectors.columns) == "structure"].sum() / squares.sum()
    model = make_eigenwalkers().fit(walkers.data, codes)
    assert abs(axis_shares(model).loc["gender", "structure"] - planted) < 0.03
    accuracy = {}
    for left_out in (None, "structure", "dynamics"):
        options = {"n_components": numbers, "scaling": "blocks", "weights": left_out and {left_out: 0.0}}
        right = [
            loo_predict(vectors.iloc[s], codes.iloc[s], **options) * codes.to_numpy()[s] > 0 for s, _ in draw(80, 8)
        ]
        accuracy[left_out] = np.mean(right, axis=(0, 2))  # (n_sets, n_numbers, n_walkers) -> (n_numbers,)
    assert (accuracy["dynamics"] > accuracy["structure"] + 0.05).all()
    assert (accuracy["structure"] > 0.6).all()
    assert (accuracy[None] > 0.75).all()
