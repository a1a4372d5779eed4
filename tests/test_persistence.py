"""Models in files, and files that are no models."""

import pickle
import zipfile

import numpy as np
import pytest
import skops.io
from numpy.testing import assert_allclose
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import FunctionTransformer

from eigenwalker import TraitClassifier, WalkPreparer, load_model, make_eigenwalkers, make_walkers, save_model
from tests.synthetic import make_walk


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(12, duration=5, frame_rate=60, random_state=0)


def test_models_come_back(walkers, tmp_path):
    model = make_eigenwalkers(n_components=4, trait=TraitClassifier(), extras=("speed",))
    model = Pipeline([("preparer", WalkPreparer()), *model.steps]).fit(walkers.data, walkers.target["gender"])
    save_model(model, tmp_path / "model.skops")
    loaded = load_model(tmp_path / "model.skops")
    assert_allclose(loaded.transform(walkers.data), model.transform(walkers.data))
    assert (loaded.predict(walkers.data) == model.predict(walkers.data)).all()
    assert loaded["linearizer"].template_.positions.flags.writeable is False


class _Harm:
    def __reduce__(self):
        return (exec, ("raise SystemExit('executed')",))


def test_a_pickle_is_refused_and_not_executed(tmp_path):
    path = tmp_path / "model.skops"
    path.write_bytes(pickle.dumps(_Harm()))
    with pytest.raises(ValueError, match=r"model\.skops: expected a model written by save_model"):
        load_model(path)


def test_a_foreign_type_is_refused_by_name(tmp_path):
    path = tmp_path / "model.skops"
    skops.io.dump(FunctionTransformer(make_walk), path)
    with pytest.raises(ValueError, match=r"refused, because the file asks for types .*tests\.synthetic\.make_walk"):
        load_model(path)
    with pytest.raises(TypeError, match=r"cannot save the model: load_model would refuse its .*make_walk"):
        save_model(FunctionTransformer(make_walk), tmp_path / "other.skops")
    assert not (tmp_path / "other.skops").exists()


@pytest.mark.parametrize("share", [0.0, 0.5, 0.99])
def test_a_truncated_file_is_refused(walkers, tmp_path, share):
    path = tmp_path / "model.skops"
    save_model(make_eigenwalkers(n_components=2).fit(walkers.data, np.arange(12.0)), path)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(ValueError, match="a part of one"):
        load_model(path)


def test_another_archive_is_refused(tmp_path):
    path = tmp_path / "photos.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("photo.txt", "no model")
    with pytest.raises(ValueError, match="expected a model written by save_model"):
        load_model(path)
