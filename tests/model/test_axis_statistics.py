"""Every number about trait axes against another way to get it, with scikit-learn alone where there is one."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from joblib import parallel_config
from numpy.testing import assert_allclose, assert_array_equal
from pandas.testing import assert_frame_equal
from scipy.stats import pearsonr
from sklearn.base import clone
from sklearn.linear_model import LinearRegression
from sklearn.metrics import balanced_accuracy_score, roc_auc_score
from sklearn.model_selection import LeaveOneGroupOut, LeaveOneOut, cross_val_predict
from sklearn.pipeline import Pipeline

from eigenwalker.datasets import make_walkers
from eigenwalker.model import (
    FourierLinearizer,
    TraitClassifier,
    TraitRegressor,
    axis_features,
    axis_shares,
    axis_statistics,
    bootstrap_axes,
    make_eigenwalkers,
    nested_loo,
    permutation_test,
    score_interval,
    settings_of,
)
from eigenwalker.motion import JointWalk, Skeleton, WalkPreparer
from eigenwalker.motion.clip import cut

FAST = {"n_harmonics": [1, 2], "n_permutations": 99, "n_resamples": 20, "random_state": 0}
EXACT = {"rtol": 0, "atol": 1e-8}


def halves(walks):
    """Return the first half of each walk, then the second half of each: two walks a person."""
    middle = [walk.n_frames // 2 for walk in walks]
    first = [cut(walk, slice(0, end)) for walk, end in zip(walks, middle, strict=True)]
    return first + [cut(walk, slice(start, walk.n_frames)) for walk, start in zip(walks, middle, strict=True)]


def joint_walks(n_walks):
    """Return walks of two hips that swing, and how wide."""
    random = np.random.default_rng(0)
    skeleton = Skeleton(("hips", "left", "right"), [-1, 0, 0], np.zeros((3, 3)))
    swings = random.uniform(0.3, 0.6, size=n_walks)
    walks = []
    for number, (swing, frequency) in enumerate(zip(swings, random.uniform(0.8, 1.1, size=n_walks), strict=True)):
        phase = 2 * np.pi * frequency * np.arange(150) / 50
        posture, turns = 0.1 * random.normal(size=(2, 3, 3))
        rotations = posture + turns * np.cos(phase + random.uniform(0, 6))[:, np.newaxis, np.newaxis]
        rotations[:, 1, 0] += swing * np.cos(phase)
        rotations[:, 2, 0] -= swing * np.cos(phase)
        walks.append(JointWalk(rotations, np.zeros((150, 3)), skeleton, 50.0, f"walker_{number:02d}"))
    return walks, swings


def _plain():
    """Return one walk a person, words and numbers, some labels missing, weights by name."""
    walkers = make_walkers(16, duration=4, frame_rate=50, random_state=1)
    y = walkers.target[["gender", "weight", "happy"]].copy()
    y.iloc[[2, 9, 13], 0] = None
    y.iloc[[5, 9], 2] = np.nan
    model = make_eigenwalkers(n_components=5, weights={"head": 0.5, "frequency": 2.0, "harmonic2": 3.0})
    codes = y.assign(gender=y["gender"].map({"female": -1.0, "male": 1.0}))
    return SimpleNamespace(model=model, walks=walkers.data, y=y, codes=codes, scores=["auc", "r", "r"], groups=None)


def _persons():
    """Return two walks a person, controls, the scaling that needs both; poles that turn the sign."""
    walkers = make_walkers(10, duration=7, frame_rate=50, random_state=2)
    people = pd.concat([walkers.target] * 2, ignore_index=True)
    people.loc[3, "weight"] = np.nan  # of one walk of two
    poles = {"gender": ("male", "female"), "weight": ("light", "heavy")}
    model = make_eigenwalkers(n_components=6, scaling="noise", trait=TraitRegressor(poles=poles, direction="filter"))
    return SimpleNamespace(
        model=model,
        walks=halves(walkers.data),
        y=people[["gender", "weight"]],
        codes=people[["gender", "weight"]].assign(gender=people["gender"].map({"female": 1.0, "male": -1.0})),
        scores=["auc", "r"],
        groups=np.tile(np.arange(10), 2).astype(str),
        control=people[["height"]],
    )


def _classifier():
    """Return recordings over the floor, prepared by the model, whose last step has numbers for two groups."""
    walkers = make_walkers(14, duration=7, frame_rate=50, treadmill=False, random_state=3)
    y = walkers.target["gender"].map({"female": 1, "male": 0}).rename("woman")
    trait = TraitClassifier(poles={"woman": (1, 0)}, boundary="midpoint", alpha_unit="label")
    model = make_eigenwalkers(n_components=4, scaling="features", trait=trait, extras=("speed",))
    model = Pipeline([("preparer", WalkPreparer()), *model.steps])
    codes = pd.DataFrame({"woman": np.where(y == 1, -1.0, 1.0)})
    return SimpleNamespace(model=model, walks=walkers.data, y=y, codes=codes, scores=["auc"], groups=None)


def _joints():
    """Return joint walks."""
    walks, swings = joint_walks(14)
    y = pd.DataFrame({"swing": swings, "wide": np.where(swings > 0.45, "yes", "no")})
    model = make_eigenwalkers(n_components=3, scaling=None)
    model.set_params(linearizer__phase_reference={"left_x": 1.0, "right_x": -1.0})
    codes = y.assign(wide=y["wide"].map({"no": -1.0, "yes": 1.0}))
    return SimpleNamespace(model=model, walks=walks, y=y, codes=codes, scores=["r", "auc"], groups=None)


def _moods():
    """Return labels that differ between the walks of a person, one of them missing."""
    walkers = make_walkers(10, duration=7, frame_rate=50, random_state=4)
    mood = np.random.default_rng(0).permuted([["calm", "glad"]] * 10, axis=1).T.ravel().astype(object)
    mood[4] = None
    y = pd.DataFrame({"mood": mood})
    codes = y.assign(mood=y["mood"].map({"calm": -1.0, "glad": 1.0}))
    groups = np.tile(np.arange(10), 2)
    model = make_eigenwalkers(n_components=5)
    return SimpleNamespace(model=model, walks=halves(walkers.data), y=y, codes=codes, scores=["auc"], groups=groups)


@pytest.fixture(scope="module", params=[_plain, _persons, _classifier, _joints, _moods], ids=lambda make: make.__name__)
def case(request):
    """Return what is given, what comes of it, and the walks as vectors."""
    case = request.param()
    case.control = getattr(case, "control", None)
    case.found = axis_statistics(case.model, case.walks, case.y, groups=case.groups, control=case.control, **FAST)
    case.prepared = case.walks
    if isinstance(case.model[0], WalkPreparer):
        case.prepared, case.model = WalkPreparer().fit_transform(case.walks), case.model[1:]
    case.persons = np.arange(len(case.walks)) if case.groups is None else case.groups
    case.vectors = clone(case.model[0]).set_output(transform="pandas").fit_transform(case.prepared)
    case.options = {"groups": case.groups, "control": case.control}
    return case


def fit_options(model, groups, control):
    """Return what the steps of a model without its linearizer take in fit."""
    options = {} if control is None else {"trait__control": control}
    if groups is not None:
        options |= {"trait__groups": groups}
        if "scaler" in model.named_steps and model["scaler"].unit == "noise":
            options |= {"scaler__groups": groups}
    return options


def refit(case, model, codes, vectors=None):
    """Return predictions of persons left out, everything fitted anew by scikit-learn, shape (n_walks, n_columns)."""
    steps = Pipeline([*clone(model)[1:-1].steps, ("trait", TraitRegressor())])
    folds = LeaveOneOut() if case.groups is None else LeaveOneGroupOut()
    options = fit_options(steps, case.groups, case.control)
    vectors = case.vectors if vectors is None else vectors
    if model["scaler"].weights is None:
        vectors = vectors.to_numpy()  # faster than with names
    predicted = cross_val_predict(steps, vectors, codes, groups=case.groups, cv=folds, params=options)
    return predicted.reshape(len(vectors), -1)


def by_person(case, values, codes):
    """Return the mean of each person's labelled walks, and the label; walks where persons have several labels."""
    table = pd.DataFrame({"value": values, "code": codes, "person": case.persons}).dropna()
    if (table.groupby("person")["code"].nunique() > 1).any():
        return table["value"].to_numpy(), table["code"].to_numpy()
    means = table.groupby("person").mean()
    return means["value"].to_numpy(), means["code"].to_numpy()


def rate(case, values, codes, score):
    guess, truth = by_person(case, values, codes)
    return roc_auc_score(truth, guess) if score == "auc" else pearsonr(truth, guess).statistic


def rate_each(case, predicted):
    codes = case.codes.to_numpy().T
    return [rate(case, *columns) for columns in zip(predicted.T, codes, case.scores, strict=True)]


def interval_of_each(case, predicted):
    codes = case.codes.to_numpy().T
    return [
        score_interval(*by_person(case, values, truth), score)
        for values, truth, score in zip(predicted.T, codes, case.scores, strict=True)
    ]


def changed(case, **weights):
    """Return the model with further weights."""
    before = case.model["scaler"].weights or {}
    return clone(case.model).set_params(scaler__weights={**before, **weights})


def test_scores_are_of_persons_left_out(case):
    predicted = refit(case, case.model, case.codes)
    assert_allclose(case.found.predictions, predicted, **EXACT)
    assert list(case.found.predictions.index) == [walk.name for walk in case.walks]
    assert list(case.found.predictions) == list(case.found.summary.index) == list(case.codes)
    assert case.found.summary["score"].tolist() == case.scores
    assert_allclose(case.found.summary["left_out"], rate_each(case, predicted), **EXACT)
    ends = case.found.summary[["left_out_low", "left_out_high"]]
    assert_allclose(ends, interval_of_each(case, predicted), **EXACT)


def test_units_and_poles_are_those_of_the_fitted_model(case):
    summary, own = case.found.summary, clone(case.model)
    poles = getattr(own[-1], "poles", None) or {}
    named = {"gender": ("female", "male"), "wide": ("no", "yes"), "mood": ("calm", "glad")} | poles
    for name, row in summary.iterrows():
        assert (row["negative"], row["positive"]) == tuple(map(str, named.get(name, ("low", "high"))))
    known = case.codes.notna().to_numpy()
    assert_array_equal(summary["n_walks"], known.sum(axis=0))
    assert_array_equal(summary["n_persons"], [len(set(case.persons[column])) for column in known.T])
    steps = Pipeline([*own[1:-1].steps, ("trait", TraitRegressor())])
    steps.fit(case.vectors, case.codes, **fit_options(steps, case.groups, case.control))
    displacements = pd.DataFrame(steps.predict(case.vectors).reshape(len(case.vectors), -1))
    spreads = displacements.groupby(case.persons).mean().std()
    assert_allclose(summary["unit"], 1.0 if own[-1].alpha_unit == "label" else spreads, **EXACT)


def test_the_fitted_model_is_that_of_all_walks(case):
    by_name = case.model["scaler"].weights is not None
    own = clone(case.model).set_output(transform="pandas" if by_name else "default")
    own.fit(case.prepared, case.y, **fit_options(own, case.groups, case.control))
    assert_allclose(case.found.model.transform(case.prepared), own.transform(case.prepared), **EXACT)
    shares = case.found.parts["share"].unstack("part")[["structure", "dynamics"]]
    assert_allclose(shares.loc[list(case.codes)], axis_shares(own), **EXACT)
    trait = getattr(own[-1], "axis_", own[-1])
    steps = np.vstack([trait.step([[1.0]], [name]) for name in trait.trait_names_])  # rotated, but not stretched
    unit = steps / np.linalg.norm(steps, axis=1, keepdims=True)
    assert_allclose(case.found.cosines, unit @ unit.T, **EXACT)
    assert list(case.found.cosines) == list(case.found.cosines.index) == list(case.codes)


def test_accuracy_is_with_the_boundary_midway(case):
    folds = LeaveOneGroupOut().split(case.vectors, groups=case.persons)
    decisions = np.full(case.codes.shape, np.nan)
    control = None if case.control is None else case.control.to_numpy()
    for others, left_out in folds:
        steps = Pipeline([*clone(case.model)[1:-1].steps, ("trait", TraitRegressor())])
        groups = None if case.groups is None else case.groups[others]
        options = fit_options(steps, groups, None if control is None else control[others])
        vectors, codes = case.vectors.iloc[others], case.codes.iloc[others].reset_index(drop=True)
        fitted = pd.DataFrame(steps.fit(vectors, codes, **options).predict(vectors).reshape(len(others), -1))
        predicted = steps.predict(case.vectors.iloc[left_out]).reshape(len(left_out), -1)
        for trait, (name, score) in enumerate(zip(case.codes, case.scores, strict=True)):
            if score == "auc":
                middle = fitted[trait].groupby(codes[name].to_numpy()).mean().mean()
                decisions[left_out, trait] = predicted[:, trait] - middle
    for trait, (name, score) in enumerate(zip(case.codes, case.scores, strict=True)):
        row = case.found.summary.loc[name, ["accuracy", "accuracy_low", "accuracy_high"]].astype(float)
        if score == "r":
            assert row.isna().all()
            continue
        guess, truth = by_person(case, decisions[:, trait], case.codes[name])
        assert_allclose(row.iloc[0], balanced_accuracy_score(truth, np.where(guess > 0, 1, -1)), **EXACT)
        assert_allclose(row.iloc[1:], score_interval(guess, truth, "balanced_accuracy"), **EXACT)


def test_accuracy_is_that_of_a_classifier():
    walkers = make_walkers(16, duration=4, frame_rate=50, random_state=6)
    gender = walkers.target["gender"]
    model = make_eigenwalkers(n_components=4, trait=TraitClassifier(boundary="midpoint"))
    found = axis_statistics(model, walkers.data, gender, **FAST)
    vectors = FourierLinearizer().fit_transform(walkers.data)
    predicted = cross_val_predict(model[1:], vectors, gender, cv=LeaveOneOut())
    assert_allclose(found.summary.loc["gender", "accuracy"], balanced_accuracy_score(gender, predicted))


def test_tempo_is_frequency_and_speed_alone(case):
    tempo = case.vectors[["frequency"]].assign(speed=[walk.speed for walk in case.prepared]).dropna(axis=1)
    assert tempo.shape[1] == (1 if isinstance(case.walks[0], JointWalk) else 2)
    folds = LeaveOneOut() if case.groups is None else LeaveOneGroupOut()
    predicted = np.empty(case.codes.shape)
    for trait, column in enumerate(case.codes.to_numpy().T):
        known = ~np.isnan(column)
        for others, left_out in folds.split(tempo, groups=case.groups):
            some = others[known[others]]
            line, control = LinearRegression(), {}
            if case.control is not None:
                line, control = TraitRegressor(), {"control": case.control.iloc[others]}
                some = others  # those without a label count for the covariance with the control
            line.fit(tempo.iloc[some].to_numpy(), column[some], **control)
            predicted[left_out, trait] = line.predict(tempo.iloc[left_out].to_numpy())
    assert_allclose(case.found.summary["tempo"], rate_each(case, predicted), **EXACT)


def test_parts_are_models_without_the_other_part(case):
    for part, other in (("structure", "dynamics"), ("dynamics", "structure")):
        predicted = refit(case, changed(case, **{other: 0}), case.codes)
        rows = case.found.parts.xs(part, level="part").loc[list(case.codes)]
        assert_allclose(rows["alone"], rate_each(case, predicted), **EXACT)
        assert_allclose(rows[["alone_low", "alone_high"]], interval_of_each(case, predicted), **EXACT)


def test_components_are_other_models(case):
    curve = case.found.components
    n_controls = 0 if case.control is None else 1
    n_others = len(case.walks) - (1 if case.groups is None else 2)
    rank = np.linalg.matrix_rank(case.vectors - case.vectors.mean())
    assert curve.index.tolist() == list(range(1 + n_controls, min(rank, n_others - 1, 40) + 1))
    assert list(curve) == list(case.codes)
    for number in (2, curve.index[-1]):
        model = clone(case.model).set_params(eigenwalkers__n_components=number)
        assert_allclose(curve.loc[number], rate_each(case, refit(case, model, case.codes)), **EXACT)
    own = case.model["eigenwalkers"].n_components
    assert_allclose(curve.loc[own], case.found.summary["left_out"], **EXACT)


def test_harmonics_are_other_models(case):
    curve = case.found.harmonics
    assert curve.index.tolist() == [1, 2]
    assert_allclose(curve.loc[2], case.found.summary["left_out"], **EXACT)
    linearizer = clone(case.model[0]).set_params(n_harmonics=1).set_output(transform="pandas")
    fitting = {name: weight for name, weight in (case.model["scaler"].weights or {}).items() if name != "harmonic2"}
    model = clone(case.model).set_params(scaler__weights=fitting or None)
    predicted = refit(case, model, case.codes, linearizer.fit_transform(case.prepared))
    assert_allclose(curve.loc[1], rate_each(case, predicted), **EXACT)


def test_nested_is_nested_by_error(case):
    n_others = len(case.walks) - (2 if case.groups is None else 4)
    numbers = [number for number in case.found.components.index if number <= n_others - 1]
    options = settings_of(case.model) | case.options | {"n_components": numbers, "criterion": "error"}
    result = nested_loo(case.vectors, case.codes, **options)
    assert_allclose(case.found.summary["nested"], rate_each(case, result.predictions), **EXACT)
    ends = case.found.summary[["nested_low", "nested_high"]]
    assert_allclose(ends, interval_of_each(case, result.predictions), **EXACT)
    assert_allclose(case.found.summary["nested_components"], np.median(result.n_components, axis=0))


def test_p_is_of_shuffled_labels(case):
    """The matrix from labels to predictions has the predictions of one label at a time as its columns."""
    for (name, codes), score in zip(case.codes.items(), case.scores, strict=True):
        known = codes.notna().to_numpy()
        columns = np.where(known[:, np.newaxis], np.eye(len(codes))[:, known], np.nan)
        matrix, labels = refit(case, case.model, columns)[known], codes[known]
        persons = case.persons[known]
        several = labels.groupby(persons).nunique().max() > 1
        who = {"strata": persons} if several else {"groups": persons}
        fixed = {"n_permutations": 99, "random_state": 0}
        expected = permutation_test(matrix, labels, score=score, **who, **fixed)
        result = case.found.permutations[name]
        assert_allclose(result.null, expected.null, **EXACT)
        assert_allclose([result.score, result.p_value], [expected.score, expected.p_value], **EXACT)
        assert_allclose(result.score, case.found.summary.loc[name, "left_out"], **EXACT)
        assert case.found.summary.loc[name, "p"] == result.p_value == (1 + sum(result.null >= result.score)) / 100
        if known.all() and not several:
            plain = settings_of(case.model) | case.options | fixed
            assert_allclose(permutation_test(case.vectors, codes, score=score, **plain).null, result.null, **EXACT)


def test_stability_is_of_persons_drawn_again(case):
    direction = case.model[-1].direction
    options = settings_of(case.model) | case.options | {"direction": direction, "n_resamples": 20, "random_state": 0}
    expected = bootstrap_axes(case.vectors, case.codes, **options)
    for name, values in expected._asdict().items():
        assert_allclose(getattr(case.found.bootstrap, name), values, **EXACT)
    assert_allclose(case.found.summary["stability"], np.median(expected.cosines, axis=0))
    assert_allclose(case.found.summary["stability_low"], np.quantile(expected.cosines, 0.05, axis=0))
    trait = getattr(case.found.model[-1], "axis_", case.found.model[-1])
    sds = trait.alpha_sd_ / case.found.summary["unit"]  # as alpha
    assert_allclose(expected.axes, axis_features(case.found.model).mul(sds.to_numpy(), axis=0), **EXACT)


def test_the_given_model_is_left_as_it_is(case):
    assert not any(hasattr(step, "mean_") or hasattr(step, "template_") for _, step in case.model.steps)
    settings = case.found.settings
    assert settings["n_components"] == case.model["eigenwalkers"].n_components
    assert settings["weights"] == case.model["scaler"].weights
    assert settings["control"] == ([] if case.control is None else ["height"])
    assert (settings["level"], settings["n_permutations"], settings["n_resamples"]) == (0.95, 99, 20)


def test_walks_may_be_linearized_in_every_fold():
    """The model as it is, from walks to labels."""
    case = _joints()
    found = axis_statistics(case.model, case.walks, case.y, **FAST | {"n_harmonics": [2]})
    expected = cross_val_predict(case.model, case.walks, case.codes, cv=LeaveOneOut())
    assert_allclose(found.predictions, expected, **EXACT)


def assert_same(one, other):
    for name in ("summary", "components", "harmonics", "parts", "cosines", "predictions"):
        assert_frame_equal(getattr(one, name), getattr(other, name), check_exact=True)
    for name, result in one.permutations.items():
        assert_array_equal(result.null, other.permutations[name].null)
    assert_array_equal(one.bootstrap.low, other.bootstrap.low)
    assert (one.faults, one.notes, one.settings) == (other.faults, other.notes, other.settings)


def test_the_same_seed_gives_the_same_numbers_with_any_number_of_jobs():
    walks, swings = joint_walks(14)
    model = make_eigenwalkers(n_components=3)
    model.set_params(linearizer__phase_reference={"left_x": 1.0, "right_x": -1.0})
    first, again = (axis_statistics(model, walks, swings, n_jobs=n_jobs, **FAST) for n_jobs in (1, None))
    assert_same(first, again)
    with parallel_config("threading"):  # processes take seconds to begin
        assert_same(first, axis_statistics(model, walks, swings, n_jobs=2, **FAST))
    other = axis_statistics(model, walks, swings, **FAST | {"random_state": 1})
    assert (other.permutations["trait"].null != first.permutations["trait"].null).any()
    assert_frame_equal(other.components, first.components)


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(16, duration=4, frame_rate=50, random_state=0)


def study(walkers, y, n_components=5, **options):
    model = make_eigenwalkers(n_components=n_components, **options.pop("model", {}))
    return axis_statistics(model, walkers.data, y, **FAST | {"n_harmonics": [2], "n_resamples": 10} | options)


@pytest.fixture(scope="module")
def plain(walkers):
    return study(walkers, walkers.target["gender"])


def test_a_fitted_model_and_one_of_tables_give_the_same(walkers, plain):
    y = walkers.target["gender"]
    model = make_eigenwalkers(n_components=5).set_output(transform="pandas").fit(walkers.data[:10], y[:10])
    mean = model[-1].mean_.copy()
    options = FAST | {"n_harmonics": [2], "n_resamples": 10}
    assert_same(axis_statistics(model, walkers.data, y, **options), plain)
    assert_array_equal(model[-1].mean_, mean)


def test_turned_poles_turn_the_axis_and_no_score(walkers, plain):
    poles = {"gender": ("male", "female")}
    turned = study(walkers, walkers.target["gender"], model={"trait": TraitRegressor(poles=poles)})
    assert turned.summary.loc["gender", ["negative", "positive"]].tolist() == ["male", "female"]
    assert_allclose(turned.predictions, -plain.predictions, **EXACT)
    assert_allclose(turned.bootstrap.axes, -plain.bootstrap.axes, **EXACT)
    numbers = plain.summary.select_dtypes("number").columns
    assert_allclose(turned.summary[numbers].astype(float), plain.summary[numbers].astype(float), **EXACT)


def test_words_truth_values_and_numbers_are_the_same_groups(walkers, plain):
    gender = walkers.target["gender"]
    words = plain.summary.drop(columns=["negative", "positive"])
    for labels in (gender == "male", gender.map({"female": -1, "male": 1})):
        assert_frame_equal(study(walkers, labels).summary[list(words)], words)
    trait = {"trait": TraitClassifier()}
    numbers = study(walkers, gender.map({"female": 3.0, "male": 7.0}), model=trait).summary
    assert_frame_equal(numbers[list(words)], words)
    assert numbers.loc["gender", ["negative", "positive"]].tolist() == ["3.0", "7.0"]


def test_a_part_that_the_model_leaves_out_has_no_score(walkers):
    found = study(walkers, walkers.target[["gender", "weight"]], model={"weights": {"structure": 0}})
    for trait in ("gender", "weight"):
        assert found.parts.loc[(trait, "structure")].tolist()[0] == 0
        assert found.parts.loc[(trait, "structure"), ["alone", "alone_low", "alone_high"]].isna().all()
        assert_allclose(found.parts.loc[(trait, "dynamics"), "alone"], found.summary.loc[trait, "left_out"])


def test_harmonics_for_which_the_model_does_not_fit_have_no_score(walkers):
    """Nothing is left of it, or fewer features than components."""
    weights = {"mean": 0, "harmonic1": 0, "frequency": 0}
    found = study(walkers, walkers.target["gender"], model={"weights": weights}, n_harmonics=[1, 2, 3])
    assert found.harmonics["gender"].isna().tolist() == [True, False, False]
    model = make_eigenwalkers(n_components=5).set_params(scaler__weights=np.linspace(0, 2, 226))
    found = axis_statistics(model, walkers.data, walkers.target["gender"], **FAST | {"n_resamples": 10})
    assert found.harmonics["gender"].isna().tolist() == [True, False]


def test_a_group_of_one_person_has_no_accuracy(walkers):
    labels = np.where(np.arange(16) == 3, "odd", "even")
    found = study(walkers, labels)
    assert_allclose(found.predictions.loc["walker_003", "trait"], -1)  # by others who are all of the other group
    assert np.isfinite(found.summary.loc["trait", "left_out"])
    assert np.isnan(found.summary.loc["trait", "accuracy"])


def test_controls_that_are_all_of_tempo_leave_none(walkers):
    tempo = FourierLinearizer().fit_transform(walkers.data)[:, -1:]
    control = np.column_stack((tempo, [walk.speed for walk in walkers.data]))
    found = study(walkers, walkers.target["gender"], control=control)
    assert np.isnan(found.summary.loc["gender", "tempo"])
    assert found.settings["control"] == ["control_0", "control_1"]
    assert "Controlled for control_0, control_1" in found.notes[-1]


def test_level_is_that_of_all_intervals(walkers, plain):
    wide, narrow = study(walkers, walkers.target["gender"], level=0.99), plain
    for name in ("left_out", "nested", "accuracy"):
        assert wide.summary[f"{name}_low"].item() < narrow.summary[f"{name}_low"].item()
        assert wide.summary[f"{name}_high"].item() > narrow.summary[f"{name}_high"].item()
    assert (wide.parts["alone_high"] > narrow.parts["alone_high"]).all()
    assert (wide.bootstrap.low <= narrow.bootstrap.low).all()
    assert (wide.bootstrap.high >= narrow.bootstrap.high).all()
    assert (wide.bootstrap.high > narrow.bootstrap.high).any()


@pytest.mark.parametrize(
    ("y", "options", "message"),
    [
        ("gender", {"n_harmonics": [2, 1.5]}, "n_harmonics must be a whole number of at least 1, got 1.5"),
        ("gender", {"n_harmonics": [0]}, "n_harmonics must be a whole number of at least 1, got 0"),
        ("gender", {"level": 95}, "level must be between 0 and 1, got 95"),
        ("gender", {"n_permutations": 0}, "n_permutations must be at least 1"),
        ("gender", {"n_resamples": 1}, "n_resamples must be at least 2"),
        ("gender", {"groups": [1, 2]}, "inconsistent numbers of samples"),
        ("gender", {"sources": [1, 2]}, "inconsistent numbers of samples"),
        ("gender", {"model": {"weights": {"hat": 1}}}, "'hat' fits no feature"),
        ("gender", {"n_components": 16}, "n_components must be between 1 and 15"),
        ("name", {}, "expected numbers or two classes, got 16 classes"),
    ],
)
def test_wrong_arguments_are_refused(walkers, y, options, message):
    labels = walkers.target.assign(name=walkers.target.index)[y]
    with pytest.raises(ValueError, match=message):
        study(walkers, labels, **options)


@pytest.mark.parametrize("steps", [slice(0, 1), slice(1, 4), slice(0, 4, 3)])
def test_models_with_other_steps_are_refused(walkers, steps):
    model = make_eigenwalkers(n_components=5)
    with pytest.raises(ValueError, match=r"a FourierLinearizer among its steps|a PCA before the trait"):
        axis_statistics(Pipeline(model.steps[steps]), walkers.data, walkers.target["gender"])
