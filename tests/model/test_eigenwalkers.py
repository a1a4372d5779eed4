"""The Pipeline from walks to traits, and walks along its axes."""

import pickle

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose
from sklearn.base import clone
from sklearn.decomposition import PCA
from sklearn.model_selection import (
    GridSearchCV,
    GroupKFold,
    LeaveOneOut,
    cross_val_predict,
    cross_val_score,
)
from sklearn.pipeline import Pipeline

from eigenwalker import (
    BlockScaler,
    FourierLinearizer,
    TraitClassifier,
    TraitRegressor,
    WalkPreparer,
    load_model,
    make_eigenwalkers,
    make_walkers,
    save_model,
    walk_along_axis,
    walk_at,
)

TRAITS = ["gender", "weight", "happy", "nervous"]
SCALINGS = ["blocks", "features", None]
ALPHAS = np.array([[0.5, -1.0, 2.0, 0.0], [-2.0, 0.3, 0.1, 1.0]])


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(40, duration=6, frame_rate=60, random_state=0)


@pytest.fixture(scope="module", params=SCALINGS)
def model(request, walkers):
    return make_eigenwalkers(scaling=request.param).fit(walkers.data, walkers.target[TRAITS])


def _copies(model, walkers, folder):
    """Yield the model after each way in which models travel."""
    save_model(model, folder / "model.skops")
    yield "as it is", model
    yield "clone", clone(model).fit(walkers.data, walkers.target[TRAITS])
    yield "pickle", pickle.loads(pickle.dumps(model))
    yield "skops", load_model(folder / "model.skops")
    search = GridSearchCV(model, {"eigenwalkers__n_components": [15]}, cv=3)
    yield "grid search", search.fit(walkers.data, walkers.target[TRAITS]).best_estimator_


def test_alpha_survives_the_walk(model, walkers, tmp_path):
    """Four traits at once through the inverse of the whole Pipeline, and one trait along its axis."""
    for how, copied in _copies(model, walkers, tmp_path):
        assert_allclose(copied.transform(copied.inverse_transform(ALPHAS)), ALPHAS, atol=1e-6, err_msg=how)
        made = walk_along_axis(copied, "happy", [-3.0, 2.0])
        assert_allclose(copied.transform(made)[:, 2], [-3.0, 2.0], atol=1e-6, err_msg=how)


def test_the_walk_itself_survives_copying(model, walkers, tmp_path):
    expected = model.inverse_transform(ALPHAS)[0].positions
    for how, copied in _copies(model, walkers, tmp_path):
        assert_allclose(copied.inverse_transform(ALPHAS)[0].positions, expected, atol=1e-9, err_msg=how)


def test_one_trait_alone(walkers):
    for scaling in SCALINGS:
        for trait in (TraitRegressor(), TraitClassifier()):
            model = make_eigenwalkers(scaling=scaling, trait=trait).fit(walkers.data, walkers.target["gender"])
            assert_allclose(model.transform(model.inverse_transform([[-2.0], [1.5]])), [[-2.0], [1.5]], atol=1e-6)


@pytest.mark.parametrize("scaling", SCALINGS)
def test_filter_with_coefficient_is_equation_six(walkers, scaling):
    """Troje 2002, Eq. 2 to 6, written out: w = w0 + alpha V c'."""
    codes = np.where(walkers.target["gender"] == "male", 1.0, -1.0)
    trait = TraitRegressor(alpha_unit="coefficient", direction="filter")
    model = make_eigenwalkers(scaling=scaling, trait=trait).fit(walkers.data, codes)
    vectors = FourierLinearizer().fit_transform(walkers.data)
    scale = np.ones(226)
    spread = vectors.std(axis=0)
    reference = np.sqrt((spread[:-1] ** 2).mean())
    if scaling == "blocks":
        scale[-1] = spread[-1] / reference
    elif scaling == "features":
        scale = np.where(spread > 1e-6 * reference, spread, 1.0)
    scaled = vectors / scale
    average = scaled.mean(axis=0)
    eigenwalkers = np.linalg.svd(scaled - average)[2][:15].T
    scores = (scaled - average) @ eigenwalkers
    c = np.linalg.lstsq(np.column_stack((np.ones(40), scores)), codes)[0][1:]
    expected = (average + 0.02 * eigenwalkers @ c) * scale
    (walk,) = walk_along_axis(model, 0, [0.02])
    assert_allclose(model["linearizer"].transform([walk])[0], expected, atol=1e-9)


def test_filter_and_pattern_coincide_after_whitening(walkers):
    made = []
    for direction in ("filter", "pattern"):
        model = make_eigenwalkers(trait=TraitRegressor(direction=direction))
        model.set_params(eigenwalkers__whiten=True).fit(walkers.data, walkers.target[TRAITS])
        made.append([walk.positions for walk in walk_along_axis(model, "weight", [-2.0, 2.0])])
        made[-1] += [walk.positions for walk in model.inverse_transform(ALPHAS)]
    for filtered, patterned in zip(*made, strict=True):
        assert_allclose(filtered, patterned, atol=1e-9)


def test_base_with_its_own_alpha_is_the_base(model, walkers):
    base = walkers.data[5]
    linearizer = model["linearizer"]
    own = dict(zip(TRAITS, model.transform([base])[0], strict=True))
    band_limited = linearizer.inverse_transform(linearizer.transform([base]))[0].positions
    assert_allclose(walk_along_axis(model, "weight", [own["weight"]], base=base)[0].positions, band_limited, atol=1e-9)
    same = walk_at(model, own, base=base)
    assert_allclose(same.positions, band_limited, atol=1e-9)
    assert (same.speed, same.size) == (base.speed, base.size)


def test_base_gets_its_alpha_and_keeps_what_pca_leaves_out(model, walkers):
    base = walkers.data[7]
    (moved,) = walk_along_axis(model, "happy", [2.5], base=base)
    assert_allclose(model.transform([moved])[0, 2], 2.5, atol=1e-6)
    linearizer, reduction = model["linearizer"], model[1:-1]
    vectors = linearizer.transform([base, moved])
    rest = vectors - reduction.inverse_transform(reduction.transform(vectors))
    assert np.abs(rest).max() > 1e-3
    assert_allclose(rest[0], rest[1], atol=1e-8)


def test_held_traits_stay(model, walkers):
    for base in (None, walkers.data[2]):
        (moved,) = walk_along_axis(model, "gender", [2.0], base=base, hold=("weight", "nervous"))
        start = np.zeros(4) if base is None else model.transform([base])[0]
        assert_allclose(model.transform([moved])[0, [0, 1, 3]], [2.0, *start[[1, 3]]], atol=1e-6)


def test_zero_is_the_average_walker(model, walkers):
    (average,) = walk_along_axis(model, "gender", [0.0])
    mean = model["linearizer"].transform(walkers.data).mean(axis=0)
    assert_allclose(model["linearizer"].transform([average])[0], mean, atol=1e-9)


def test_collinear_traits_still_have_axes(walkers):
    twice = walkers.target[["happy"]].assign(gloom=-walkers.target["happy"])
    model = make_eigenwalkers().fit(walkers.data, twice)
    first, second = (walk_along_axis(model, name, [alpha])[0] for name, alpha in (("happy", 1.0), ("gloom", -1.0)))
    assert_allclose(first.positions, second.positions, atol=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda model: walk_along_axis(model, "mood", [1.0]), "trait must be one of 'gender', .*, got 'mood'"),
        (lambda model: walk_along_axis(model, 4, [1.0]), "position below 4 or one of .*, got 4"),
        (lambda model: walk_along_axis(model, "happy", 1.0), r"alphas must have shape \(n_walks,\)"),
        (lambda model: walk_at(model, {"happy": 1.0, "age": 2}), "trait must be one of .*, got 'age'"),
        (
            lambda model: walk_along_axis(model, "happy", [1.0], hold=("happy",)),
            "either set or held, got both for happy",
        ),
        (
            lambda model: walk_along_axis(model, "happy", [-1e4]),
            "would be -97.7 Hz.* becomes 0 at alpha = -95.5",
        ),
        (lambda model: walk_along_axis(model[1:], "happy", [1.0]), "must have a FourierLinearizer among its steps"),
        (lambda model: model.inverse_transform([[1.0]]), "expected alpha for the 4 traits"),
    ],
)
def test_wrong_requests_are_refused(walkers, call, message):
    model = make_eigenwalkers().fit(walkers.data, walkers.target[TRAITS])
    with pytest.raises(ValueError, match=message):
        call(model)


def test_scaling_is_a_choice():
    assert make_eigenwalkers(scaling=None)["scaler"].unit is None
    assert list(make_eigenwalkers().named_steps) == ["linearizer", "scaler", "eigenwalkers", "trait"]
    with pytest.raises(ValueError, match="scaling must be one of 'blocks', 'features', 'noise', None"):
        make_eigenwalkers(scaling="metres")
    trait = TraitRegressor()
    assert make_eigenwalkers(trait=trait)["trait"] is not trait


def test_extras_are_scaled_as_blocks(walkers):
    model = make_eigenwalkers(extras=("speed",)).fit(walkers.data, walkers.target["happy"])
    assert len(model["scaler"].block_shares_) == 3
    (walk,) = walk_along_axis(model, "happy", [2.0])
    assert 0.5 < walk.speed < 3


@pytest.mark.parametrize("missing", [False, True])
def test_grid_search(walkers, missing):
    labels = walkers.target[["weight", "happy"]].copy()
    if missing:
        labels.iloc[::5, 1] = np.nan
    grid = {"linearizer__n_harmonics": [1, 2], "eigenwalkers__n_components": [4, 8]}
    search = GridSearchCV(make_eigenwalkers(), grid, cv=3, error_score="raise").fit(walkers.data, labels)
    assert np.isfinite(search.cv_results_["mean_test_score"]).all()
    assert search.best_estimator_.transform(walkers.data).shape == (40, 2)


def test_cross_validation_on_a_list_of_walks(walkers):
    model = make_eigenwalkers(n_components=8, trait=TraitClassifier())
    gender = walkers.target["gender"]
    alone = cross_val_score(model, walkers.data, gender, cv=LeaveOneOut())
    assert set(alone) <= {0.0, 1.0}
    assert alone.mean() > 0.6
    persons = np.repeat(np.arange(10), 4)
    one, two = (
        cross_val_predict(model, walkers.data, gender, cv=GroupKFold(5), groups=persons, n_jobs=jobs) for jobs in (1, 2)
    )
    assert (one == two).all()


def test_pandas_output(walkers):
    model = make_eigenwalkers().set_output(transform="pandas").fit(walkers.data, walkers.target[TRAITS])
    table = model.transform(walkers.data)
    assert list(table.columns) == TRAITS
    plain = make_eigenwalkers().fit(walkers.data, walkers.target[TRAITS])
    assert_allclose(table.to_numpy(), plain.transform(walkers.data))
    assert_allclose(model.transform(walk_along_axis(model, "happy", [2.0], base=walkers.data[0]))["happy"], 2.0)
    assert list(model["linearizer"].transform(walkers.data).columns[:2]) == ["mean_head_x", "mean_head_y"]


def test_recordings_in_walks_out():
    """Preparation as the first step, speed as a feature: the inverse walks over the floor."""
    walkers = make_walkers(20, duration=8, frame_rate=60, treadmill=False, random_state=1)
    model = Pipeline(
        [
            ("preparer", WalkPreparer()),
            ("linearizer", FourierLinearizer(extras=("speed",))),
            ("scaler", BlockScaler(2)),
            ("eigenwalkers", PCA(5, svd_solver="full")),
            ("trait", TraitRegressor()),
        ]
    ).fit(walkers.data, walkers.target["happy"])
    (walk,) = model.inverse_transform([[1.0]])
    assert walk.marker("pelvis")[-1, 0] > 5
    assert_allclose(
        model[1:].transform(walk_along_axis(model, "happy", [1.5], base=walkers.data[0])), [[1.5]], atol=1e-6
    )


def test_labels_keep_their_names(walkers):
    model = make_eigenwalkers(n_components=4).fit(walkers.data, pd.Series(walkers.target["weight"], name="kilograms"))
    assert model["trait"].trait_names_ == ["kilograms"]
