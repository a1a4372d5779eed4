"""Models of walks that come in parts: those of all walks at once."""

import copy
import pickle
import warnings
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from sklearn.base import BaseEstimator, clone
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler

from eigenwalker.datasets import make_walkers
from eigenwalker.display.viewer.contents import model_contents
from eigenwalker.model import (
    FourierLinearizer,
    Moments,
    TraitClassifier,
    TraitRegressor,
    axis_features,
    eigenwalker_features,
    fit_moments,
    fit_stream,
    make_eigenwalkers,
    score_walker,
    walk_along_axis,
)
from eigenwalker.motion import Walk, WalkPreparer
from eigenwalker.persistence import load_model, save_model

CUTS = [1, 2, 9, 30]  # parts of one walk among them


@pytest.fixture(scope="module")
def walkers():
    """Return fewer walks than features."""
    return make_walkers(48, duration=5, frame_rate=60, random_state=0)


@pytest.fixture(scope="module")
def many():
    """Return more walks than the 136 features of one harmonic."""
    return make_walkers(160, duration=3, frame_rate=30, random_state=1)


def _labels(walkers):
    """Return words and numbers, each with missing ones of its own, and the first part without any of one trait."""
    labels = walkers.target[["gender", "weight", "happy"]].copy()
    labels.iloc[::5, 0] = None
    labels.iloc[:9, 2] = np.nan
    labels.iloc[11::3, 2] = np.nan
    labels.iloc[20] = None  # labeled for nothing, but counted for the average walker
    return labels


def _in_parts(X, y, cuts=CUTS):
    edges = [0, *cuts, len(X)]
    return [(X[start:stop], y[start:stop]) for start, stop in pairwise(edges)]


def _assert_equal(found, expected, *, scale=1.0):
    """Equal to 1e-10 of the largest number in an array, infinite ones exactly."""
    found, expected = (np.asarray(each, dtype=float) for each in (found, expected))
    finite = np.isfinite(expected)
    assert_array_equal(found[~finite], expected[~finite])
    largest = max(np.abs(expected[finite]).max(initial=0.0), scale)
    assert_allclose(found[finite], expected[finite], rtol=0, atol=1e-10 * largest)


def _assert_same_attributes(found, expected, *, but=()):
    """Whatever `fit` sets is set, and the same."""
    names, others = (set(vars(each)) - {"_n_walkers", *but} for each in (expected, found))
    assert names == others
    for name in names:
        _assert_alike(vars(found)[name], vars(expected)[name])


def _assert_alike(found, expected):
    assert type(found) is type(expected)
    if isinstance(expected, BaseEstimator):
        _assert_same_attributes(found, expected)
    elif isinstance(expected, Walk):
        assert_array_equal(found.positions, expected.positions)
    elif isinstance(expected, list) and expected and isinstance(expected[0], dict):
        for one, other in zip(found, expected, strict=True):
            _assert_alike(one, other)
    elif isinstance(expected, dict):
        assert found.keys() == expected.keys()
        for key, value in expected.items():
            _assert_alike(found[key], value)
    elif isinstance(expected, float | np.ndarray) and np.asarray(expected).dtype.kind == "f":
        _assert_equal(found, expected, scale=1e-3)  # the average walker's score is 1e-17 here, 0 there
    else:
        assert np.all(found == expected)


def _assert_same(found, expected, walks, *, but=()):
    """What it has learned, and what is done with it: alphas, labels, axes, walks along them."""
    assert list(found.named_steps) == list(expected.named_steps)
    for one, other in zip(found, expected, strict=True):
        _assert_same_attributes(one, other, but=but)
    _assert_equal(found.transform(walks), expected.transform(walks))
    if isinstance(expected[-1], TraitRegressor):
        _assert_equal(found.predict(walks), expected.predict(walks))
    else:
        assert_array_equal(found.predict(walks), expected.predict(walks))
    assert_array_equal(found[-1].get_feature_names_out(), expected[-1].get_feature_names_out())
    _assert_equal(axis_features(found), axis_features(expected))
    for base in (None, walks[0]):
        pair = [walk_along_axis(model, 0, [0.5], base=base)[0].positions for model in (found, expected)]
        assert len(pair[0]) == len(pair[1])
        _assert_equal(*pair)


# The same model.


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"scaling": None},
        {"scaling": "features"},
        {"extras": ("speed", "size")},
        {"extras": ("speed", "size"), "scaling": "features"},
        {"n_components": 0.9},
        {"n_components": 1},
        {"weights": {"dynamics": 2.0, "head": 0.0}},
        {"trait": TraitRegressor(alpha_unit="label", direction="filter", poles={"happy": ("sad", "happy")})},
        {"trait": TraitRegressor(poles={"gender": ("male", "female")})},
    ],
    ids=str,
)
def test_it_is_the_model_of_all_walks(walkers, options):
    """Fewer walks than features, labels that are missing, signs of Eigenwalkers included."""
    model = make_eigenwalkers(**{"n_components": 8} | options)
    labels = _labels(walkers)
    expected = clone(model).fit(walkers.data, labels)
    _assert_same(fit_stream(model, _in_parts(walkers.data, labels)), expected, walkers.data)


@pytest.mark.parametrize("scaling", ["blocks", "features", None])
@pytest.mark.parametrize("n_components", [12, 0.95])
def test_it_is_the_model_of_more_walks_than_features(many, scaling, n_components):
    model = make_eigenwalkers(1, n_components, scaling=scaling)
    labels = _labels(many)
    expected = clone(model).fit(many.data, labels)
    _assert_same(fit_stream(model, _in_parts(many.data, labels)), expected, many.data)


@pytest.mark.parametrize("scaling", ["blocks", "features"])
@pytest.mark.parametrize("few", [True, False])
@pytest.mark.filterwarnings("ignore::eigenwalker.model.OutsideDataWarning")
def test_all_components_are_the_same_but_those_without_variance(walkers, many, scaling, few):
    """In these any direction is as good; what is done with them is the same, as least squares leaves them out."""
    walks = walkers if few else many
    model, labels = make_eigenwalkers(1, None, scaling=scaling), _labels(walks)
    expected = clone(model).fit(walks.data, labels)
    found = fit_stream(model, _in_parts(walks.data, labels))
    free = ("components_", "coef_", "covariance_", "singular_values_", "explained_variance_", "alpha_boundary_")
    _assert_same(found, expected, walks.data, but=free)
    one, other = (each["eigenwalkers"] for each in (found, expected))
    _assert_equal(one.singular_values_, other.singular_values_)
    _assert_equal(one.explained_variance_, other.explained_variance_)
    vary = other.singular_values_ > 1e-6 * other.singular_values_[0]
    assert 10 < vary.sum() < len(vary)
    _assert_equal(one.components_[vary], other.components_[vary])
    _assert_equal(found[-1].coef_[:, vary], expected[-1].coef_[:, vary])


@pytest.mark.parametrize("boundary", ["zero", "midpoint"])
@pytest.mark.parametrize("poles", [None, {"gender": ("male", "female")}])
def test_classifiers_are_the_same(walkers, boundary, poles):
    model = make_eigenwalkers(n_components=6, trait=TraitClassifier(boundary=boundary, poles=poles))
    gender = walkers.target["gender"]
    expected = clone(model).fit(walkers.data, gender)
    found = fit_stream(model, _in_parts(walkers.data, gender))
    _assert_same(found, expected, walkers.data)
    _assert_equal(found.decision_function(walkers.data), expected.decision_function(walkers.data))


@pytest.mark.parametrize("classes", [(0, 1), (7, -2), (False, True), ("a", "b"), (0.0, 1.0)])
def test_classes_of_any_kind(walkers, classes):
    """They are numbers that are classes, words or truth values, and come back as such."""
    second = (walkers.target["gender"] == "male").to_numpy()
    labels = np.where(second, classes[1], classes[0])
    model = make_eigenwalkers(n_components=4, trait=TraitClassifier())
    expected = clone(model).fit(walkers.data, labels)
    found = fit_stream(model, _in_parts(walkers.data, labels))
    _assert_same(found, expected, walkers.data)
    assert found.predict(walkers.data[:3]).dtype == expected.predict(walkers.data[:3]).dtype


@pytest.mark.parametrize(
    "take",
    [
        lambda target: target["weight"],
        lambda target: target["weight"].to_numpy(),
        lambda target: target[["weight"]],
        lambda target: target[["weight", "happy"]].to_numpy(),
        lambda target: target["gender"].astype("category"),
        lambda target: target["gender"].to_numpy(dtype=object),
        lambda target: (target["gender"] == "male").to_numpy(),
        lambda target: (target["gender"] == "male").astype(object).where(target["happy"] > 0),
        lambda target: target["gender"].where(target["happy"] > 0),
    ],
)
def test_labels_of_any_kind(walkers, take):
    """One dimension or two, with names or without."""
    y = take(walkers.target)
    model = make_eigenwalkers(n_components=4)
    expected = clone(model).fit(walkers.data, y)
    found = fit_stream(model, _in_parts(walkers.data, y))
    _assert_same(found, expected, walkers.data)
    assert found.predict(walkers.data[:3]).shape == expected.predict(walkers.data[:3]).shape


def test_labels_without_a_name_take_that_of_their_poles(walkers):
    model = make_eigenwalkers(n_components=4, trait=TraitRegressor(poles={"mood": ("sad", "happy")}))
    happy = walkers.target["happy"].to_numpy()
    expected = clone(model).fit(walkers.data, happy)
    _assert_same(fit_stream(model, _in_parts(walkers.data, happy)), expected, walkers.data)


def test_axes_that_control_for_others_are_the_same(walkers):
    model, target = make_eigenwalkers(n_components=8), walkers.target
    expected = clone(model).fit(walkers.data, target[["weight"]], trait__control=target[["gender", "height"]])
    parts = _in_parts(walkers.data, target[["height", "weight", "gender"]])
    found = fit_stream(model, parts, control=["gender", "height"])
    _assert_same(found, expected, walkers.data)
    assert found[-1].control_names_ == ["gender", "height"]
    alphas, sex = found.transform(walkers.data)[:, 0], target["gender"] == "male"
    assert abs(np.corrcoef(alphas, sex)[0, 1]) < 1e-10


@pytest.mark.parametrize("scaling", ["blocks", "noise"])
def test_persons_are_the_same(walkers, scaling):
    """SDs over persons, SDs within persons, alphas of persons, all from one reading."""
    model = make_eigenwalkers(n_components=8, scaling=scaling)
    persons = np.random.default_rng(0).integers(0, 17, 48)
    labels = walkers.target[["weight", "happy"]]
    groups = {"trait__groups": persons} | ({"scaler__groups": persons} if scaling == "noise" else {})
    expected = clone(model).fit(walkers.data, labels, **groups)
    found = fit_stream(model, iter(_in_parts(walkers.data, labels.assign(person=persons))), groups="person")
    _assert_same(found, expected, walkers.data)
    assert found[-1].n_walkers_ == expected[-1].n_walkers_ == len(np.unique(persons))


def test_steps_with_tables_between_them_are_the_same(walkers):
    model = make_eigenwalkers(n_components=4).set_output(transform="pandas")
    labels = walkers.target[["weight", "happy"]]
    expected = clone(model).fit(walkers.data, labels)
    found = fit_stream(model, _in_parts(walkers.data, labels))
    _assert_same(found, expected, walkers.data)
    pd.testing.assert_frame_equal(found.transform(walkers.data), expected.transform(walkers.data))


def test_walks_that_the_model_prepares_are_the_same():
    walkers = make_walkers(12, duration=6, frame_rate=60, treadmill=False, random_state=1)
    steps = make_eigenwalkers(n_components=3, extras=("speed", "size")).steps
    model = Pipeline([("preparer", WalkPreparer(frequency_range=(0.5, 1.5))), *steps])
    expected = clone(model).fit(walkers.data, walkers.target["happy"])
    found = fit_stream(model, _in_parts(walkers.data, walkers.target["happy"], [5]))
    _assert_equal(found.transform(walkers.data), expected.transform(walkers.data))
    vectors = expected[:2].transform(walkers.data)
    parts = _in_parts(vectors, walkers.target["happy"], [5])
    found = fit_stream(model, parts, template=walkers.data[0])
    _assert_equal(found.transform(walkers.data), expected.transform(walkers.data))


def test_pca_without_a_scaler_is_the_same(walkers):
    model = Pipeline([step for step in make_eigenwalkers(n_components=4).steps if step[0] != "scaler"])
    expected = clone(model).fit(walkers.data, walkers.target["happy"])
    _assert_same(fit_stream(model, _in_parts(walkers.data, walkers.target["happy"])), expected, walkers.data)


# Parts.


@pytest.fixture(scope="module")
def table(walkers):
    """Return coefficients as other tools keep them: by name, in any order, beside other things."""
    linearizer = FourierLinearizer().fit(walkers.data[:1])
    columns = linearizer.get_feature_names_out()
    found = pd.DataFrame(linearizer.transform(walkers.data), columns=columns)
    found = found.assign(name=walkers.target.index, explained_power=0.97)
    return found.iloc[:, ::-1]


def _tables(table, cuts=CUTS):
    return [table.iloc[start:stop] for start, stop in zip([0, *cuts], [*cuts, len(table)], strict=True)]


def test_tables_of_coefficients_find_their_labels_by_name(walkers, table):
    labels = _labels(walkers)
    expected = make_eigenwalkers(n_components=8).fit(walkers.data, labels)
    shuffled = labels.sample(frac=1, random_state=0)
    found = fit_stream(make_eigenwalkers(n_components=8), _tables(table), shuffled, template=walkers.data[0])
    _assert_same(found, expected, walkers.data)


def test_walks_find_their_labels_by_name(walkers):
    names = [walk.name for walk in walkers.data]
    expected = make_eigenwalkers(n_components=8).fit(walkers.data, walkers.target.loc[names, "weight"])
    parts = [walkers.data[:20], walkers.data[20:]]
    found = fit_stream(make_eigenwalkers(n_components=8), parts, walkers.target["weight"].iloc[::-1])
    _assert_same(found, expected, walkers.data)


def test_a_fitted_linearizer_needs_no_template(walkers, table):
    model = make_eigenwalkers(n_components=8)
    expected = clone(model).fit(walkers.data, walkers.target["weight"])
    model.set_params(linearizer=FourierLinearizer().fit(walkers.data[:1]))
    found = fit_stream(model, _tables(table), walkers.target["weight"])
    _assert_same(found, expected, walkers.data)
    assert found["linearizer"] is not model["linearizer"]


def test_the_model_stays_as_it_is(walkers):
    model = make_eigenwalkers(n_components=8)
    before = copy.deepcopy([vars(step) for step in model])
    fit_stream(model, _in_parts(walkers.data, walkers.target["weight"]))
    assert str([vars(step) for step in model]) == str(before)


def test_single_precision_is_exact_for_the_numbers_it_holds(walkers, table):
    numbers = table.drop(columns="name").astype(np.float32)
    narrow = _tables(numbers.assign(name=table["name"]))
    wide = _tables(numbers.astype(np.float64).assign(name=table["name"]))
    found, expected = (
        fit_stream(make_eigenwalkers(n_components=8), parts, walkers.target["weight"], template=walkers.data[0])
        for parts in (narrow, wide)
    )
    _assert_same(found, expected, walkers.data)


def test_empty_parts_are_passed_over(walkers):
    gender, nothing = walkers.target["gender"], walkers.target["gender"].iloc[:0]
    parts = [([], nothing), *_in_parts(walkers.data, gender), ([], nothing)]
    expected = make_eigenwalkers(n_components=8).fit(walkers.data, gender)
    _assert_same(fit_stream(make_eigenwalkers(n_components=8), parts), expected, walkers.data)


# Readings.


def test_parts_are_read_twice_or_alphas_are_left_out(walkers):
    model, weight = make_eigenwalkers(n_components=8), walkers.target["weight"]
    parts = _in_parts(walkers.data, weight)
    expected = clone(model).fit(walkers.data, weight)
    _assert_same(fit_stream(model, lambda: iter(parts)), expected, walkers.data)
    with pytest.raises(ValueError, match=r"parts can be read once only, .* or alphas=False"):
        fit_stream(model, iter(parts))
    found = fit_stream(model, iter(parts), alphas=False)
    _assert_same(found, expected, walkers.data, but=("alphas_",))
    assert found[-1].n_walkers_ == 48
    assert found[-1].distance_limit() == expected[-1].distance_limit()
    for use in (lambda: score_walker(found, walkers.data[0]), lambda: model_contents(found, None)):
        with pytest.raises(
            ValueError, match=r"of which they were not kept; fit it anew with fit_stream\(\.\.\., alphas"
        ):
            use()


def test_parts_that_change_between_readings_are_noticed(walkers):
    weight, readings = walkers.target["weight"], []

    def read():
        readings.append(1)
        return _in_parts(walkers.data, weight)[: 6 - len(readings)]

    with pytest.raises(ValueError, match="the same parts in both readings, got 48 walks, then 30"):
        fit_stream(make_eigenwalkers(n_components=8), read)


def test_moments_may_come_from_anywhere(walkers):
    """Added up in other processes, in another order, from tables or arrays."""
    model, labels = make_eigenwalkers(n_components=8), _labels(walkers)
    expected = clone(model).fit(walkers.data, labels)
    linearizer = FourierLinearizer().fit(walkers.data[:1])
    names = linearizer.get_feature_names_out()
    parts = _in_parts(linearizer.transform(walkers.data), labels)
    several = [
        Moments(names).update(pd.DataFrame(X, columns=names) if number % 2 else X, y)
        for number, (X, y) in enumerate(parts)
    ]
    total = sum(pickle.loads(pickle.dumps(several[::-1])), start=Moments(names))
    found = fit_moments(model, total, template=walkers.data[0])
    _assert_same(found, expected, walkers.data, but=("alphas_",))
    again = fit_moments(model.set_params(linearizer=linearizer), total)
    _assert_same(again, expected, walkers.data, but=("alphas_",))


def test_a_streamed_model_is_saved_scored_and_shown(walkers, tmp_path):
    model, labels = make_eigenwalkers(n_components=4), walkers.target[["gender", "weight"]]
    expected = clone(model).fit(walkers.data[1:], labels[1:])
    found = fit_stream(model, _in_parts(walkers.data[1:], labels[1:]))
    save_model(found, tmp_path / "model.skops")
    loaded = load_model(tmp_path / "model.skops")
    assert_array_equal(loaded.transform(walkers.data), found.transform(walkers.data))
    one, other = (score_walker(each, walkers.data[0]) for each in (loaded, expected))
    assert_allclose(one.axes.select_dtypes(float), other.axes.select_dtypes(float), rtol=1e-9)
    assert_allclose(one.features, other.features, rtol=1e-9, atol=1e-9)
    assert one.residual == pytest.approx(other.residual, rel=1e-9)
    assert one.share_beyond == pytest.approx(other.share_beyond, rel=1e-9)
    _assert_alike(*(model_contents(each, None)["traits"] for each in (loaded, expected)))
    _assert_equal(eigenwalker_features(loaded), eigenwalker_features(expected))


# What is refused.


def test_coefficients_need_to_know_their_channels(walkers, table):
    with pytest.raises(ValueError, match=r"part 0: .* linearizer is not fitted; give template=walk"):
        fit_stream(make_eigenwalkers(), _tables(table), walkers.target["weight"])


def test_what_is_wrong_with_a_part_is_said_with_its_number(walkers, table):
    def fit(parts, labels=walkers.target["weight"], model=None, **options):
        fit_stream(model or make_eigenwalkers(n_components=8), parts, labels, template=walkers.data[0], **options)

    parts = _tables(table)
    with pytest.raises(ValueError, match=r"part 3: .* 226 features .* got 1 missing: sin2_pelvis_y"):
        fit([*parts[:3], parts[3].drop(columns="sin2_pelvis_y"), parts[4]])
    with pytest.raises(ValueError, match=r"part 0: .* got 1 missing: speed"):
        fit(parts, model=make_eigenwalkers(extras=("speed",)))
    with pytest.raises(ValueError, match=r"part 0: .* got 90 of another model: cos2"):
        fit_stream(make_eigenwalkers(1), parts, walkers.target["weight"], template=walkers.data[0])
    with pytest.raises(ValueError, match="part 4: 18 of 18 walks have no row in labels"):
        fit(parts, walkers.target["weight"].iloc[:30])
    with pytest.raises(ValueError, match="part 0: expected one row a walk in labels, got several for"):
        fit(parts, walkers.target["weight"].iloc[[0, 0, *range(1, 48)]])
    with pytest.raises(ValueError, match="part 0: expected walks, or a table with a column name"):
        fit([part.drop(columns="name") for part in parts])
    with pytest.raises(ValueError, match="part 0: expected labels with the columns height, height not found"):
        fit(parts, control="height")
    with pytest.raises(TypeError, match=r"part 0: expected a pair \(X, y\), got DataFrame"):
        fit(parts, None)
    with pytest.raises(TypeError, match="part 0: expected X alone, as labels are given, got a pair"):
        fit([(parts[0], [1.0])])
    with pytest.raises(TypeError, match=r"part 0: .* got 'part.parquet'; read the file first"):
        fit([("part.parquet", [1.0])], None)
    for wrong in (table, table.to_numpy(), "parts", 3):
        with pytest.raises(TypeError, match="parts must be a list of parts, or a function"):
            fit(wrong)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"trait": TraitRegressor(alpha_unit="meter")}, "alpha_unit must be one of"),
        ({"trait": TraitClassifier(boundary="middle")}, "boundary must be one of"),
        ({"trait": TraitRegressor(poles={"weigth": ("light", "heavy")})}, "poles name the trait 'weigth'"),
        ({"n_components": 49}, "n_components=49 must be between 0 and .*48"),
        ({"scaling": "noise"}, "unit='noise' needs to know which person each walk is of; pass groups"),
        ({"weights": {"heda": 0.0}}, "weights: 'heda' fits no feature"),
    ],
)
def test_settings_are_checked_as_they_are_in_fit(walkers, options, message):
    model = make_eigenwalkers(**{"n_components": 4} | options)
    with pytest.raises(ValueError, match=message):
        fit_stream(model, _in_parts(walkers.data, walkers.target["gender"]))


@pytest.mark.parametrize(
    ("labels", "trait", "message"),
    [
        (lambda t: t["weight"], TraitClassifier(), "Unknown label type: continuous"),
        (lambda t: pd.Series(np.arange(48) % 3, t.index), TraitClassifier(), "expected two classes, got 3 classes"),
        (
            lambda t: t["gender"].where(t["gender"] == "male"),
            TraitClassifier(),
            "'gender', contains NaN: .* of 48 labels",
        ),
        (lambda t: t[["gender", "happy"]], TraitClassifier(), "y must have one column, got 2"),
        (lambda t: t["gender"].where(t["gender"] == "male"), TraitRegressor(), "got one class only, 'male'"),
        (
            lambda t: t[["weight"]].assign(mood=np.nan),
            TraitRegressor(),
            "'mood': expected labels, got none but missing",
        ),
    ],
)
def test_labels_are_checked_as_they_are_in_fit(walkers, labels, trait, message):
    model, y = make_eigenwalkers(n_components=4, trait=trait), labels(walkers.target)
    for fit in (lambda: fit_stream(model, _in_parts(walkers.data, y)), lambda: model.fit(walkers.data, y)):
        with pytest.raises(ValueError, match=message):
            fit()


def test_controls_are_checked_as_they_are_in_fit(walkers):
    model, y = make_eigenwalkers(n_components=1), walkers.target[["weight", "height"]]
    with pytest.raises(ValueError, match=r"control leaves no direction for an axis: .* got 1"):
        fit_stream(model, _in_parts(walkers.data, y), control="height")
    with pytest.raises(ValueError, match="trait 'sex': expected two classes, got one class only, 'm'"):
        fit_stream(model, _in_parts(walkers.data, y.assign(sex="m")), control="sex")


@pytest.mark.parametrize(
    ("name", "step"),
    [
        ("eigenwalkers", PCA(3, svd_solver="randomized")),
        ("eigenwalkers", PCA("mle", svd_solver="full")),
        ("eigenwalkers", PCA(3, svd_solver="full", whiten=True)),
        ("scaler", StandardScaler()),
        ("trait", StandardScaler()),
    ],
)
def test_steps_that_need_the_walks_themselves_are_refused(walkers, name, step):
    model = make_eigenwalkers().set_params(**{name: step})
    with pytest.raises(ValueError, match=r"expected .*PCA.*, got "):
        fit_stream(model, _in_parts(walkers.data, walkers.target["weight"]))


def test_one_walk_is_too_few_and_no_moments_are_none(walkers):
    model = make_eigenwalkers(n_components=1)
    with pytest.raises(ValueError, match="expected at least 2 walks, got 1"):
        fit_stream(model, [(walkers.data[:1], [1.0])])
    with pytest.raises(ValueError, match="expected parts with walks in them, got none"):
        fit_stream(model, [])
    with pytest.raises(TypeError, match="expected Moments, got list"):
        fit_moments(model, [], template=walkers.data[0])
    with pytest.raises(TypeError, match="expected a Pipeline as of make_eigenwalkers, got TraitRegressor"):
        fit_stream(model[-1], [])
    other = Moments(["a", "b"]).update([[1.0, 2.0], [2.0, 1.0]], [1.0, 2.0])
    with pytest.raises(ValueError, match=r"moments of the 226 features of the linearizer .* got 2 features, also a, b"):
        fit_moments(model, other, template=walkers.data[0])


def test_nothing_is_warned_about(walkers):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fit_stream(make_eigenwalkers(n_components=3), _in_parts(walkers.data, _labels(walkers)))
