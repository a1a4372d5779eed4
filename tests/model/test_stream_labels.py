"""Walks in parts find their labels by their names, or by another column."""

import numpy as np
import pandas as pd
import pytest

from eigenwalker import make_eigenwalkers, make_walkers
from eigenwalker.model import FourierLinearizer, Moments, fit_stream


@pytest.fixture(scope="module")
def walkers():
    return make_walkers(12, random_state=0)


@pytest.fixture(scope="module")
def model(walkers):
    return make_eigenwalkers(n_components=3).set_params(linearizer=FourierLinearizer().fit(walkers.data[:1]))


@pytest.fixture(scope="module")
def table(walkers, model):
    """Coefficients of walks whose names come twice, in two folders."""
    vectors = model["linearizer"].transform(walkers.data)
    names = [f"walk_{number % 6}" for number in range(12)]
    files = [f"{number // 6}/{name}.c3d" for number, name in enumerate(names)]
    return pd.DataFrame(vectors, columns=model["linearizer"].get_feature_names_out()).assign(name=names, file=files)


@pytest.fixture(scope="module")
def weight(walkers):
    return walkers.target["weight"].to_numpy()


def test_labels_may_be_by_file(model, table, weight):
    labels = pd.Series(weight, index=table["file"], name="weight")
    found = fit_stream(model, [table[:5], table[5:]], labels[::-1], labels_by="file")
    expected = fit_stream(model, [(table[:5], labels[:5]), (table[5:], labels[5:])])
    np.testing.assert_array_equal(found[-1].coef_, expected[-1].coef_)


def test_a_name_in_several_files_is_warned_of(model, table):
    labels = pd.Series(np.arange(6.0), index=[f"walk_{number}" for number in range(6)], name="weight")
    parts = [table[:5], table[5:8]]  # walk_0 and walk_1 come again
    with pytest.warns(UserWarning, match=r"several files have the same name.*: walk_0, walk_1; .*labels_by='file'"):
        fit_stream(model, parts, labels)
    fit_stream(model, [table[:6]], labels)  # no name comes twice
    fit_stream(model, [table.assign(file="all.csv")], labels)  # in one file names may be those of people


def test_labels_by_another_column_are_told(model, table, weight):
    labels = pd.Series(weight, index=table["file"], name="weight")
    with pytest.raises(ValueError, match=r"by their name: .*; they have by file, labels_by='file'; or"):
        fit_stream(model, [table], labels)
    with pytest.raises(ValueError, match="a table with a column person, to find their labels, got DataFrame"):
        fit_stream(model, [table], labels, labels_by="person")


def test_labels_are_a_table(model, table):
    with pytest.raises(TypeError, match="labels must be a DataFrame or Series by names of walks, got dict"):
        fit_stream(model, [table], {"walk_0": 1.0})


def test_numbers_that_are_text_are_told(model, table):
    texts = pd.Series(list("123456123456"), index=table["file"], name="weight")
    with pytest.raises(ValueError, match="these are numbers written as text"):
        fit_stream(model, [table], texts, labels_by="file")


def test_predictions_without_walks(walkers, model, table, weight):
    fitted = fit_stream(model, [(table, weight)])
    names = fitted[0].get_feature_names_out()
    np.testing.assert_allclose(fitted[1:].predict(table[names].to_numpy()), fitted.predict(walkers.data), rtol=1e-12)


def test_moments_have_a_sum(table, weight):
    vectors = table.drop(columns=["name", "file"])
    here, there = Moments().update(vectors[:5], weight[:5]), Moments().update(vectors[5:], weight[5:])
    np.testing.assert_array_equal(sum([here, there]).total().everyone.mean, (here + there).total().everyone.mean)
