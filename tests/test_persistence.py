"""Models in files, and files that are no models: none of them runs, and each is refused in words."""

import inspect
import io
import json
import operator
import os
import pickle
import random
import sys
import zipfile
from functools import partial
from importlib import import_module
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from pkgutil import walk_packages
from tomllib import loads as read_toml

import joblib
import numpy as np
import pandas as pd
import pytest
import sklearn
import skops.io
from numpy.testing import assert_array_equal, assert_equal
from sklearn.base import BaseEstimator, clone
from sklearn.decomposition import PCA
from sklearn.ensemble import RandomForestClassifier
from sklearn.linear_model import Ridge, RidgeClassifier
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import FunctionTransformer, StandardScaler

import eigenwalker
from eigenwalker import (
    BlockScaler,
    FourierLinearizer,
    GaitHSMM,
    JointWalk,
    Skeleton,
    StyleClassifier,
    TraitClassifier,
    TraitRegressor,
    WalkPreparer,
    load_model,
    make_eigenwalkers,
    make_walkers,
    persistence,
    save_model,
)
from eigenwalker.experiment import make_style_judge
from eigenwalker.hsmm import WINDOWS, blend, make_labels
from eigenwalker.persistence import describe_model
from tests.hsmm.walking import shaken_walks, step_arrays
from tests.joint_bodies import over_floor, swinging
from tests.mutated_files import memory_limit
from tests.mutations import mutate_json
from tests.synthetic import make_walk

TRAITS = ["gender", "weight", "happy", "nervous"]


# Every estimator of the package, fitted, alone and in Pipelines.


def _joint_walks():
    skeleton = Skeleton(
        ("Hips", "LeftUpLeg", "RightUpLeg"), [-1, 0, 0], np.zeros((3, 3)), [1], [[0, 0, -0.4]], 0, ["XYZ"] * 3
    )
    times = np.arange(300) / 60
    for seed in range(6):
        rng = np.random.default_rng(seed)
        swing = np.sin(
            2 * np.pi * (0.9 + 0.02 * seed) * times[:, np.newaxis, np.newaxis] + 0.2 * rng.normal(size=(3, 3))
        )
        path = {"LeftUpLeg": np.tile([0.0, 0.1, 0.02 * seed], (300, 1))}
        yield JointWalk(
            0.3 * swing * [[1], [1], [-1]], np.zeros((300, 3)), skeleton, 60.0, f"{seed}", translations=path
        )


def _scores():
    scores = np.random.default_rng(1).normal(size=(12, 3))
    return scores, scores @ [[1.0], [0.5], [0.0]] > 0.1


def _fit_joints(walkers):
    walks = list(_joint_walks())
    model = make_eigenwalkers(n_components=2).set_params(
        linearizer__phase_reference={"LeftUpLeg_y": 1.0, "RightUpLeg_y": -1.0}
    )
    return model.fit(walks, np.arange(6.0)), walks


def _fit_joint_recordings(walkers):
    walks = [over_floor(swinging(0.1 * np.arange(400), seed=seed, frame_rate=60.0)) for seed in range(6)]
    reference = np.zeros((len(walks[0].skeleton.joint_names), 3))
    preparer = WalkPreparer(representation="joints", reference=reference, normalize_size=True)
    model = Pipeline([("preparer", preparer), *make_eigenwalkers(n_components=2, extras=("speed",)).steps])
    return model.fit(walks, np.arange(6.0)), walks


def _fit_recordings(walkers):
    walks = make_walkers(8, duration=6, frame_rate=60, treadmill=False, random_state=1)
    model = make_eigenwalkers(n_components=3, extras=("speed", "size"))
    model = Pipeline([("preparer", WalkPreparer(frequency_range=(0.5, 1.5))), *model.steps])
    return model.fit(walks.data, walks.target["happy"]), walks.data


def _fit_pandas(walkers):
    model = make_eigenwalkers(n_components=4, weights={"dynamics": 2.0, "head": 0}).set_output(transform="pandas")
    return model.fit(walkers.data, walkers.target[TRAITS]), walkers.data


def _fit_missing(walkers):
    labels = walkers.target[["weight", "happy"]].copy()
    labels.iloc[::4, 1] = np.nan
    trait = TraitRegressor(alpha_unit="label", direction="filter", poles={"happy": ("sad", "happy")})
    return make_eigenwalkers(n_components=4, trait=trait).fit(walkers.data, labels), walkers.data


def _fit(scaling, trait, walkers):
    model = make_eigenwalkers(n_components=4, scaling=scaling, trait=trait)
    groups = {"scaler__groups": np.repeat(np.arange(6), 2)} if scaling == "noise" else {}
    labels = walkers.target["gender" if isinstance(trait, TraitClassifier) else TRAITS]
    return model.fit(walkers.data, labels, **groups), walkers.data


def _gait_walks():
    """Return plain walks, and walks on bent knees."""
    return shaken_walks(3), shaken_walks(2, first=20, bend=0.3, frequency=0.75)


def _fit_gait(_, **parameters):
    plain, _ = _gait_walks()
    return GaitHSMM(**parameters).fit(plain), plain


def _adapt_gait(_, **options):
    plain, bent = _gait_walks()
    return GaitHSMM().fit(plain).adapt(bent, **options), bent


def _adapt_people(_):
    plain, bent = _gait_walks()
    return GaitHSMM(max_iter=2).fit([*plain, *bent], walkers=["a", "a", "a", 7, 7]).adapt(bent[:1]), bent


def _blend_gaits(_):
    plain, bent = _gait_walks()
    average = GaitHSMM().fit(plain)
    return blend(average, average.adapt(bent[:1]), 1.5), plain


def _fit_styles(_):
    plain, bent = _gait_walks()
    classifier = StyleClassifier(GaitHSMM(n_states=4, windows=WINDOWS), adapt_to=1)
    return classifier.fit([*plain, *bent], ["plain"] * 3 + ["bent"] * 2), bent


def _on_scores(estimator, kind=None):
    scores, labels = _scores()
    return lambda _: (estimator.fit(scores, labels[:, 0] if kind is None else np.where(labels[:, 0], *kind)), scores)


MODELS = {
    "BlockScaler": lambda _: (BlockScaler(unit="features").fit(_scores()[0]), _scores()[0]),
    "FourierLinearizer": lambda walkers: (FourierLinearizer(robust=True).fit(walkers.data), walkers.data[:2]),
    "TraitRegressor": lambda _: (TraitRegressor().fit(_scores()[0], _scores()[0] @ np.eye(3, 2)), _scores()[0]),
    "TraitClassifier": _on_scores(TraitClassifier(boundary="midpoint"), ("happy", "sad")),
    "WalkPreparer": lambda _: (WalkPreparer(), make_walkers(2, treadmill=False, random_state=0).data),
    "labels true and false": _on_scores(TraitClassifier()),
    "labels true and false, regressed": _on_scores(TraitRegressor()),
    "labels 0 and 1": _on_scores(TraitClassifier(), (0, 1)),
    "GaitHSMM": partial(_fit_gait, frame_rate=60.0),
    "GaitHSMM untied": partial(_fit_gait, tying=None, windows=WINDOWS),
    "GaitHSMM adapted": partial(_adapt_gait, n_classes=2, map_weight=30.0, max_iter=1),
    "GaitHSMM adapted with MAP": partial(_adapt_gait, method="map", map_weight=10.0),
    "GaitHSMM of people, adapted": _adapt_people,
    "GaitHSMM blended": _blend_gaits,
    "StyleClassifier": _fit_styles,
    "judge of styles": lambda walkers: (
        make_style_judge(RidgeClassifier(), random_state=0).fit(walkers.data, walkers.target["gender"]),
        walkers.data[:2],
    ),
    "joint walks": _fit_joints,
    "joint recordings": _fit_joint_recordings,
    "recordings": _fit_recordings,
    "pandas": _fit_pandas,
    "missing labels": _fit_missing,
    "parts of scikit-learn": _on_scores(
        make_pipeline(FunctionTransformer(np.arcsinh, np.sinh), StandardScaler(), PCA(2), Ridge())
    ),
} | {
    f"{scaling} {type(trait).__name__}": partial(_fit, scaling, trait)
    for scaling in ("blocks", "features", "noise", None)
    for trait in (TraitRegressor(), TraitClassifier())
}


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(12, duration=5, frame_rate=60, random_state=0)


@pytest.fixture(scope="module")
def models(walkers):
    return {name: fit(walkers) for name, fit in MODELS.items()}


@pytest.fixture(scope="module")
def small(models, tmp_path_factory):
    """Return a model's bytes, as saved."""
    path = tmp_path_factory.mktemp("small") / "model.skops"
    save_model(models["blocks TraitClassifier"][0], path)
    return path.read_bytes()


@pytest.fixture
def path(tmp_path):
    return tmp_path / "model.skops"


def _defined_estimators():
    """Yield every estimator class that a module of the package defines."""
    for module in walk_packages(eigenwalker.__path__, "eigenwalker."):
        if not module.name.endswith("__main__"):
            for value in vars(import_module(module.name)).values():
                if inspect.isclass(value) and issubclass(value, BaseEstimator) and value.__module__ == module.name:
                    yield value


def _parts(value):
    """Yield the types of this package in a fitted model."""
    if type(value).__module__.startswith("eigenwalker."):
        yield type(value)
    inner = value if isinstance(value, (dict, list, tuple, set)) else getattr(value, "__dict__", ())
    for part in inner.values() if isinstance(inner, dict) else inner:
        yield from _parts(part)


def _name(part):
    return f"{part.__module__}.{part.__name__}"


def _complaints(defined, held):
    """Yield what to do about each type that is not trusted, or that no model of this file holds."""
    tried = "a fitted one to MODELS in tests/test_persistence.py"
    for part in sorted({*defined, *held}, key=_name):
        if _name(part) not in persistence._TRUSTED:
            place = "_ESTIMATORS" if part in defined else "_HELD"
            yield f"load_model refuses {_name(part)}: add it to {place} in eigenwalker/persistence.py, and {tried}"
        elif part not in held:
            yield f"no model is tried that holds {_name(part)}: add {tried}"


def test_every_estimator_of_the_package_can_be_loaded(models):
    held = {part for model, _ in models.values() for part in _parts(model)}
    complaints = list(_complaints(set(_defined_estimators()), held))
    assert not complaints, "\n".join(complaints)
    assert {_name(part) for part in held} == persistence._TRUSTED  # and not one type more


def test_a_new_estimator_is_missed():
    class NewEstimator(BaseEstimator):
        pass

    (complaint,) = _complaints({NewEstimator}, set())
    assert "load_model refuses tests.test_persistence" in complaint
    assert "NewEstimator: add it to _ESTIMATORS in eigenwalker/persistence.py, and a fitted one to MODELS" in complaint
    (complaint,) = _complaints(set(), {NewEstimator})
    assert "add it to _HELD" in complaint
    (complaint,) = _complaints({BlockScaler}, set())
    assert "BlockScaler: add a fitted one to MODELS" in complaint


@pytest.mark.parametrize("name", MODELS)
def test_models_come_back(models, path, name):
    model, given = models[name]
    save_model(model, path)
    loaded = load_model(path)
    assert repr(loaded) == repr(model)
    _assert_same_answers(loaded, model, given)


def _assert_same_answers(loaded, model, given):
    for method in ("predict", "transform", "inverse_transform"):
        if hasattr(model, method):
            argument = model.transform(given) if method == "inverse_transform" else given
            _assert_same(getattr(loaded, method)(argument), getattr(model, method)(argument))
    for name in ("alpha_means_", "alpha_boundary_", "poles_"):
        last = (loaded[-1], model[-1]) if isinstance(model, Pipeline) else (loaded, model)
        if hasattr(last[1], name):
            assert getattr(last[0], name) == getattr(last[1], name)


def _assert_same(got, expected):
    assert type(got) is type(expected)
    if isinstance(got, pd.DataFrame):
        pd.testing.assert_frame_equal(got, expected)
    elif isinstance(got, list) and isinstance(got[0], np.ndarray):
        for array, other in zip(got, expected, strict=True):
            assert_array_equal(array, other)
    elif isinstance(got, list):
        for walk, other in zip(got, expected, strict=True):
            assert type(walk) is type(other)
            assert walk.channel_names == other.channel_names
            assert_array_equal(walk.channels, other.channels)
            assert_array_equal([walk.speed, walk.size], [other.speed, other.size])
    else:
        assert_array_equal(got, expected)


def test_templates_stay_read_only(models, path):
    for name, arrays in (("pandas", ["positions"]), ("joint walks", ["rotations", "root"])):
        save_model(models[name][0], path)
        template = load_model(path)["linearizer"].template_
        assert not any(getattr(template, array).flags.writeable for array in arrays)


def test_prepared_joints_come_back(models, path):
    """The template stands upright and has the same channels; the preparer knows which joints those are."""
    model, walks = models["joint recordings"]
    save_model(model, path)
    loaded = load_model(path)
    assert loaded["preparer"].joints_ == model["preparer"].joints_ == walks[0].skeleton.joint_names
    template = loaded["linearizer"].template_
    assert template.skeleton.upright
    assert template.channel_joints == model["linearizer"].template_.channel_joints
    assert template.phase_channels == {"LeftUpLeg_y": -1.0, "RightUpLeg_y": 1.0}


@pytest.mark.parametrize("name", [name for name in MODELS if name.startswith("GaitHSMM")])
def test_gait_models_score_and_walk_as_before(models, path, name):
    """To the last bit: likelihoods, trees, how it was adapted, and walks that are made, drawn and blended."""
    model, walks = models[name]
    save_model(model, path)
    loaded = load_model(path)
    assert set(vars(loaded)) == set(vars(model))
    for attribute in set(vars(model)) - {"template_"}:
        assert_equal(getattr(loaded, attribute), getattr(model, attribute))
    assert loaded.means_.dtype == model.means_.dtype
    assert loaded.trees_ == model.trees_
    assert [str(tree) for tree in loaded.trees_] == [str(tree) for tree in model.trees_]
    assert loaded.score(walks) == model.score(walks)
    steps = {"n_steps": 4, "first": "left"}  # which an untied model has seen
    assert_array_equal(loaded.sample(**steps, random_state=0)[0], model.sample(**steps, random_state=0)[0])
    for options in ({}, {"global_variance": None, "durations": "sample", "random_state": 3, "travel": False}):
        new, expected = (one.synthesize(**steps, **options) for one in (loaded, model))
        assert_array_equal(new.rotations, expected.rotations)
        assert_array_equal(new.root, expected.root)


def test_a_loaded_gait_model_is_adapted_and_blended(models, path):
    model, walks = models["GaitHSMM"]
    save_model(model, path)
    _, bent = _gait_walks()
    adapted = [average.adapt(bent[:1]) for average in (load_model(path), model)]
    assert adapted[0].score(bent) == adapted[1].score(bent)
    mixed = [blend(load_model(path), style, 0.5) for style in adapted]
    assert mixed[0].score(walks) == mixed[1].score(walks)


def test_gait_models_of_arrays_come_back(path):
    """They have no template and no frame rate."""
    arrays, _ = step_arrays(4)
    labels = [make_labels(8)] * 4
    model = GaitHSMM().fit(arrays, labels)
    save_model(model, path)
    loaded = load_model(path)
    assert loaded.template_ is None
    assert np.isnan(loaded.frame_rate_)
    assert loaded.score(arrays, labels) == model.score(arrays, labels)
    assert_array_equal(loaded.synthesize(6), model.synthesize(6))


def test_styles_are_as_likely_as_before(models, path):
    classifier, walks = models["StyleClassifier"]
    save_model(classifier, path)
    loaded = load_model(path)
    assert_array_equal(loaded.classes_, classifier.classes_)
    assert_array_equal(loaded.log_likelihoods(walks), classifier.log_likelihoods(walks))
    for one, other in zip(loaded.styles_, classifier.styles_, strict=True):
        assert_array_equal(one.synthesize(4).rotations, other.synthesize(4).rotations)


def test_settings_of_gait_models_come_back(path):
    for estimator in (GaitHSMM(4, windows=WINDOWS), StyleClassifier(GaitHSMM(tying="paper"), map_weight=None)):
        save_model(estimator, path)
        assert repr(load_model(path)) == repr(estimator)
        assert load_model(path).get_params(deep=False).keys() == estimator.get_params(deep=False).keys()


def test_settings_come_back_without_a_fit(walkers, path):
    model = make_eigenwalkers(n_components=3, scaling="features", extras=("speed",), trait=TraitClassifier())
    save_model(model, path)
    loaded = load_model(path)
    assert repr(loaded.get_params()) == repr(model.get_params())
    gender = walkers.target["gender"]
    _assert_same_answers(loaded.fit(walkers.data, gender), clone(model).fit(walkers.data, gender), walkers.data)


# The stamp.


def test_a_model_says_what_wrote_it(small, path, monkeypatch):
    path.write_bytes(small)
    monkeypatch.setattr(skops.io, "loads", None)
    monkeypatch.setattr(skops.io, "get_untrusted_types", None)
    project = read_toml(Path(eigenwalker.__file__).parents[1].joinpath("pyproject.toml").read_text(encoding="utf-8"))
    assert describe_model(path) == {
        "format": "1",
        "eigenwalker": project["project"]["version"],
        "scikit-learn": sklearn.__version__,
        "numpy": np.__version__,
        "python": ".".join(map(str, sys.version_info[:3])),
    }


def test_skops_reads_what_is_saved(small, models):
    loaded = skops.io.loads(small, trusted=skops.io.get_untrusted_types(data=small))
    _assert_same_answers(loaded, *models["blocks TraitClassifier"])


def test_the_release_is_known_without_an_installation(monkeypatch, tmp_path):
    def refuse(name):
        raise PackageNotFoundError(name)

    here = persistence._release()
    monkeypatch.setattr(persistence, "version", refuse)
    assert persistence._release() == here != "unknown"
    monkeypatch.setattr(persistence, "__file__", str(tmp_path / "eigenwalker" / "persistence.py"))
    assert persistence._release() == "unknown"
    (tmp_path / "pyproject.toml").write_text('[project]\nname = "other"\nversion = "7"', encoding="utf-8")
    monkeypatch.setattr(persistence, "version", lambda name: f"{name} installed")
    assert persistence._release() == "eigenwalker installed"


def _rewrite(data, *, schema=None, entries=(), **stamp):
    """Return the bytes of a model with other bytes as schema, other entries, or another stamp."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    contents["eigenwalker.json"] = json.dumps(json.loads(contents["eigenwalker.json"]) | stamp).encode()
    contents |= {"schema.json": contents["schema.json"] if schema is None else schema, **dict(entries)}
    changed = io.BytesIO()
    with zipfile.ZipFile(changed, "w") as archive:
        for name, content in contents.items():
            if content is not None:
                archive.writestr(name, content)
    return changed.getvalue()


def _schema(data):
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return json.loads(archive.read("schema.json"))


def _refuse(path, data, match):
    """Check that bytes are refused, by one error of our own that names the file in one line."""
    path.write_bytes(data)
    with memory_limit(), pytest.raises(ValueError, match=match) as caught:
        load_model(path)
    assert caught.value.__suppress_context__
    assert str(caught.value).startswith(f"{path}: ")
    assert len(str(caught.value)) < 900
    assert str(caught.value).isprintable()
    return str(caught.value)


def test_a_newer_format_is_refused_with_its_release(small, path):
    message = "expected a model of format 1, got format 2, written by eigenwalker 9.8.7; this is .*, update it"
    _refuse(path, _rewrite(small, schema=b"{}", format="2", eigenwalker="9.8.7"), message)
    assert describe_model(path)["format"] == "2"
    _refuse(path, _rewrite(small, format="0"), "got format 0")


def test_a_file_without_stamp_is_refused(small, path):
    message = r"expected a model written by save_model, got an archive without its stamp.* skops\.io\.load, and save it"
    _refuse(path, _rewrite(small, entries={"eigenwalker.json": None}), message)
    with pytest.raises(ValueError, match=message):
        describe_model(path)


@pytest.mark.parametrize(
    "stamp", [b"", b"[]", b"{", b'{"format": 1}', b"\xff", b"null", b"[" * 4000, b'{"format": "one"}', b" " * 5000]
)
def test_a_strange_stamp_is_refused(small, path, stamp):
    _refuse(path, _rewrite(small, entries={"eigenwalker.json": stamp}), "expected")
    with pytest.raises(ValueError, match=r"model\.skops: expected"):
        describe_model(path)


def test_another_scikit_learn_is_named_once(small, path, walkers, models):
    schema = json.dumps(_schema(small)).replace(sklearn.__version__, "1.4.2").encode()
    path.write_bytes(_rewrite(small, schema=schema, **{"scikit-learn": "1.4.2"}))
    with pytest.warns(UserWarning, match=f"written with scikit-learn 1.4.2, read with {sklearn.__version__}") as caught:
        loaded = load_model(path)
    assert [warning.filename for warning in caught] == [__file__]
    _assert_same_answers(loaded, *models["blocks TraitClassifier"])


# Attacks.


class _Harm:
    """Creates a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (open, (str(self.path), "w"))


@pytest.mark.parametrize(
    "dump", [lambda harm: pickle.dumps(harm), lambda harm: _joblib(harm)], ids=["pickle", "joblib"]
)
def test_a_pickle_is_refused_and_not_executed(small, tmp_path, path, dump):
    harm = dump(_Harm(tmp_path / "harm"))
    _refuse(path, harm, r"model\.skops: expected a model written by save_model.* not a zip file; get the file again")
    arrays = [name for name in zipfile.ZipFile(io.BytesIO(small)).namelist() if name.endswith(".npy")]
    _refuse(path, _rewrite(small, entries=dict.fromkeys(arrays, harm)), "expected a model written by save_model")
    assert not (tmp_path / "harm").exists()
    pickle.loads(pickle.dumps(_Harm(tmp_path / "harm"))).close()
    assert (tmp_path / "harm").exists()


def _joblib(harm):
    joblib.dump(harm, content := io.BytesIO())
    return content.getvalue()


class _Local(BaseEstimator):
    def fit(self, X, y=None):
        return self


FOREIGN = {
    r"tests\..*make_walk": make_walk,
    r"(posix|nt)\.system": os.system,
    r"builtins\.eval": eval,
    r"functools\.partial \(PartialNode\)": partial(os.system, "true"),
    r"operator\.methodcaller \(OperatorFuncNode\)": operator.methodcaller("transform"),
    r"BlockScaler \(MethodNode\)": BlockScaler().fit,
    r"RandomState \(RandomStateNode\)": np.random.RandomState(0),
    r"test_persistence\._Local": _Local(),
    r"zipfile\.ZipFile": zipfile.ZipFile,
}


@pytest.mark.parametrize("name", FOREIGN)
def test_a_foreign_type_is_refused_by_name(path, name):
    model = FunctionTransformer(FOREIGN[name])
    stamped = persistence._finish(skops.io.dumps(model))
    _refuse(path, stamped, f"refused, because the file asks for types that no model needs: .*{name}")
    with pytest.raises(TypeError, match=f"cannot save the model: load_model would refuse its .*{name}"):
        save_model(model, path.with_name("other.skops"))
    assert os.listdir(path.parent) == [path.name]


def _nodes(schema):
    """Yield each node of a schema once it is complete, the inner ones first."""
    for value in schema.values() if isinstance(schema, dict) else schema:
        if isinstance(value, (dict, list)):
            yield from _nodes(value)
    if isinstance(schema, dict) and "__loader__" in schema:
        yield schema


@pytest.mark.parametrize("name", ["os.system", "builtins.eval", "builtins.exec", "subprocess.Popen", "runpy.run_path"])
@pytest.mark.parametrize("loader", ["Dict", "List", "Tuple", "NdArray", "Object", "Type", "Function"])
def test_a_trusted_name_that_was_exchanged_is_refused(models, path, loader, name):
    stamped = persistence._finish(skops.io.dumps(models["parts of scikit-learn"][0]))
    schema = _schema(stamped)
    node = next(node for node in _nodes(schema) if node["__loader__"] == f"{loader}Node")
    node["__module__"], node["__class__"] = name.split(".")
    _refuse(path, _rewrite(stamped, schema=json.dumps(schema).encode()), f"no model needs: {name}")


LOADERS = (
    *("Bytearray", "Bytes", "Cached", "ConstructorFromReduce", "DType", "DefaultDict", "Loss", "MaskedArray", "Method"),
    *("OperatorFunc", "Partial", "QuantileForest", "RandomGenerator", "RandomState", "SparseMatrix", "Tree", "Unheard"),
)


@pytest.mark.parametrize("loader", LOADERS)
def test_a_trusted_name_does_not_open_another_loader(small, path, loader):
    """skops compares a node's name only: by one of ours a node of partial would pass, and call what it holds."""
    schema = _schema(small)
    node = next(node for node in _nodes(schema) if node["__class__"] == "BlockScaler")
    node["__loader__"] = f"{loader}Node"
    _refuse(path, _rewrite(small, schema=json.dumps(schema).encode()), rf"BlockScaler \({loader}Node\)")


def test_trust_is_not_asked_from_the_file(path, monkeypatch):
    """Even where the types that a file asks for are told wrong, no more than our own list is trusted."""
    given, loads = [], skops.io.loads
    monkeypatch.setattr(skops.io, "loads", lambda data, trusted: given.append(trusted) or loads(data, trusted=trusted))
    model = make_pipeline(BlockScaler(), FunctionTransformer(os.system))
    path.write_bytes(persistence._finish(skops.io.dumps(model)))
    monkeypatch.setattr(skops.io, "get_untrusted_types", lambda data: ["eigenwalker.model.scaling.BlockScaler"])
    with pytest.raises(ValueError, match=r"Untrusted types found in the file: \['(posix|nt)\.system'\]"):
        load_model(path)
    assert given == [["eigenwalker.model.scaling.BlockScaler"]]


def test_other_models_of_scikit_learn(path):
    """Those that skops trusts are; trees can make predict read any memory, so that they are not."""
    scores, labels = _scores()
    save_model(Ridge().fit(scores, labels), path)
    assert_array_equal(load_model(path).predict(scores), Ridge().fit(scores, labels).predict(scores))
    forest = RandomForestClassifier(2).fit(scores, labels[:, 0])
    with pytest.raises(TypeError, match=r"would refuse its sklearn\.tree\._tree\.Tree"):
        save_model(forest, path)


@pytest.mark.parametrize("part", [PCA, np.zeros(3), {"model": 1}, "model", None])
def test_what_is_no_estimator_is_refused(small, path, part):
    with pytest.raises(TypeError, match="cannot save the model: expected an estimator, got"):
        save_model(part, path)
    if not inspect.isclass(part):
        _refuse(path, persistence._finish(skops.io.dumps(part)), "expected an estimator, got")


def test_a_cache_is_refused(small, path):
    """Its folder could hold pickles, and the next fit would load them."""
    with pytest.raises(TypeError, match="cannot save the model: expected memory=None, got a cache"):
        save_model(make_eigenwalkers().set_params(memory="cache"), path)
    schema = _schema(small)
    schema["content"]["content"]["memory"]["content"] = '"cache"'
    _refuse(path, _rewrite(small, schema=json.dumps(schema).encode()), "expected memory=None, got a cache")


# Bombs: no more than 1 GiB may be asked for while they are refused.


def _deflated(size):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("schema.json", "w") as entry:
        for _ in range(size // 2**20):
            entry.write(bytes(2**20))
    return content.getvalue()


def test_a_zip_bomb_is_refused_with_its_size(path):
    bomb = _deflated(2**28)
    _refuse(path, bomb, rf"without compression, got {len(bomb):,} bytes that unpack to 268,435,456")
    small = bytearray(bomb)
    place = bomb.rindex(b"PK\x01\x02") + 24  # where the directory says how large the entry is unpacked
    small[place : place + 4] = bytes([10, 0, 0, 0])
    _refuse(path, bytes(small), "without compression, got .* that unpack to 10")


def test_a_large_file_is_refused_unread(path):
    with path.open("wb") as file:
        file.truncate(2**30 + 1)
    with memory_limit(2**24), pytest.raises(ValueError, match=r"at most 1,073,741,824 bytes, got 1,073,741,825"):
        load_model(path)


def test_a_large_schema_is_refused_unread(small, path):
    _refuse(path, _rewrite(small, schema=b" " * (2**24 + 1)), r"schema\.json of at most 16,777,216 bytes")


def _array_node(name, kind="numpy.ndarray"):
    module, _, kind = kind.rpartition(".")
    return {"__class__": kind, "__module__": module, "__loader__": "NdArrayNode", "type": "numpy", "file": name}


def _list_node(content, **more):
    node = {"__class__": "list", "__module__": "builtins", "__loader__": "ListNode", "content": content}
    return node | {"protocol": 2} | more


def _npy(array=0.0, shape=None):
    np.save(content := io.BytesIO(), np.asarray(array))
    return content.getvalue() if shape is None else content.getvalue().replace(b"()", shape)


def test_an_array_that_is_read_again_and_again_is_refused(small, path):
    schema = _list_node([_array_node("0.npy")] * 70_000)
    data = _rewrite(small, schema=json.dumps(schema).encode(), entries={"0.npy": bytes(2**14)})
    _refuse(path, data, "expected arrays of at most 1,073,741,824 bytes, got 1,146,880,000")


@pytest.mark.parametrize("kind", ["bytes_", "void"])
def test_a_number_is_not_turned_into_so_many_bytes(small, path, kind):
    schema = json.dumps(_list_node([_array_node("0.npy", f"numpy.{kind}")])).encode()
    data = _rewrite(small, schema=schema, entries={"0.npy": _npy(2**31 - 1)})
    _refuse(path, data, rf"no model needs: numpy\.{kind} \(NdArrayNode\)")


@pytest.mark.parametrize("shape", [b"(999999999999,)", b"(-1,)", b"(9" + b"9" * 40 + b",)", b"(3,)", b"(" * 5000])
def test_an_array_that_claims_more_than_there_is_is_refused(small, path, shape):
    schema = json.dumps(_list_node([_array_node("0.npy")])).encode()
    data = _rewrite(small, schema=schema, entries={"0.npy": _npy(shape=shape)})
    _refuse(path, data, "expected a model written by save_model, got something else or a part of one")


def test_nodes_that_refer_to_each_other_are_refused(small, path):
    """Forty lists of two that are one and the same are 2^40 lists; a list in itself is without end."""
    doubled = _list_node([], __id__=1)
    for number in range(2, 42):
        doubled = _list_node([doubled, {"__id__": number - 1}], __id__=number)
    endless = _list_node([{"__id__": 1}], __id__=1)
    for schema in (doubled, endless):
        _refuse(path, _rewrite(small, schema=json.dumps(schema).encode()), "without addresses, got one with them")


@pytest.mark.parametrize("depth", [300, 900, 100_000])
def test_deep_nesting_is_refused(small, path, depth):
    node = json.dumps(_list_node(["?"])).encode()
    head, tail = node.split(b'"?"')
    _refuse(path, _rewrite(small, schema=head * depth + tail * depth), "expected")
    _refuse(path, _rewrite(small, schema=b"[" * depth + b"]" * depth), "expected")


# Accidents.


def test_parts_of_a_file_are_refused(small, path):
    lengths = random.Random(0).sample(range(len(small)), 50)
    for length in (0, 1, 22, *lengths, len(small) - 1):
        _refuse(path, small[:length], "expected a model written by save_model, got something else or a part of one")


def _try(path, data):
    """Return the model, or None where it is refused as it should be."""
    path.write_bytes(data)
    try:
        return load_model(path)
    except ValueError as error:
        message = str(error)
    assert message.startswith(f"{path}: ")
    return None


def test_a_changed_byte_changes_nothing_or_is_refused(small, path, models):
    model, given = models["blocks TraitClassifier"]
    dice = random.Random(1)
    n_refused = 0
    for _ in range(200):
        changed = bytearray(small)
        changed[dice.randrange(len(small))] ^= 1 << dice.randrange(8)
        loaded = _try(path, changed)
        n_refused += loaded is None
        if loaded is not None:
            _assert_same(loaded.transform(given[:2]), model.transform(given[:2]))
    assert n_refused > 150  # others change what no one reads, such as dates


def test_a_changed_schema_gives_an_estimator_or_is_refused(small, path):
    """Written anew, so that the checksum is right."""
    dice = random.Random(2)
    schema = json.dumps(_schema(small)).encode()
    for _ in range(200):
        loaded = _try(path, _rewrite(small, schema=mutate_json(dice, schema)))
        assert loaded is None or isinstance(loaded, BaseEstimator)


@pytest.mark.parametrize("content", [b"", b"time,head_x\n0,1\n", b"PK\x05\x06", bytes(1000)])
def test_other_files_are_refused(path, content):
    _refuse(path, content, "expected a model written by save_model, got something else or a part of one")


@pytest.mark.parametrize("schema", [None, b"", b"null", b"[]", b"{}", b'{"protocol": 2}', b'{"protocol": 99}', b"\xff"])
def test_other_archives_are_refused(small, path, schema):
    _refuse(path, _rewrite(small, entries={"schema.json": schema}), "expected a model written by save_model")


def test_folders_are_refused_and_missing_files_are_missing(tmp_path):
    for read in (load_model, describe_model):
        with pytest.raises(ValueError, match=r"expected a model, a file of at most .*, got a folder"):
            read(tmp_path)
        with pytest.raises(FileNotFoundError, match=r"none\.skops"):
            read(tmp_path / "none.skops")


# Saving.


@pytest.mark.parametrize("step", ["fsync", "replace"])
@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError("disk full")])
def test_an_interrupted_save_leaves_what_was_there(small, path, monkeypatch, step, error):
    def interrupt(*_):
        raise error

    path.write_bytes(small)
    monkeypatch.setattr(os, step, interrupt)
    with pytest.raises((KeyboardInterrupt, OSError)):
        save_model(make_eigenwalkers(), path)
    assert path.read_bytes() == small
    assert os.listdir(path.parent) == [path.name]


def test_a_save_follows_links_and_keeps_permissions(small, tmp_path):
    (tmp_path / "there").mkdir()
    target, link = tmp_path / "there" / "model.skops", tmp_path / "link.skops"
    target.write_bytes(small)
    target.chmod(0o640)
    link.symlink_to(target)
    save_model(make_eigenwalkers(), link)
    assert link.is_symlink()
    assert target.read_bytes() != small
    assert target.stat().st_mode & 0o777 == 0o640
    assert os.listdir(target.parent) == [target.name]


def test_a_save_needs_its_folder(tmp_path):
    with pytest.raises(FileNotFoundError, match="nowhere"):
        save_model(make_eigenwalkers(), tmp_path / "nowhere" / "model.skops")
    with pytest.raises(OSError, match=str(tmp_path)):
        save_model(make_eigenwalkers(), tmp_path)


@pytest.mark.parametrize("label", [pd.Timestamp("2020-01-01"), ("a", "b"), None])
def test_keys_that_would_not_come_back_are_refused(path, label):
    scaler = BlockScaler().fit(_scores()[0])
    scaler.notes_ = {label: 1, "word": 2}
    with pytest.raises(TypeError, match="cannot save the model: "):
        save_model(scaler, path)


def test_without_skops_it_says_how_to_get_it(monkeypatch, small, path):
    path.write_bytes(small)
    monkeypatch.setitem(sys.modules, "skops.io", None)
    for call in (partial(save_model, BlockScaler()), load_model):
        with pytest.raises(ImportError, match=r"pip install 'eigenwalker\[persist\]'"):
            call(path)
    assert describe_model(path)["format"] == "1"
