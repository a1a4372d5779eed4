"""What every estimator over walks keeps to. One contract for all of them, called from their tests."""

import copy
import inspect
import pickle
import re

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.exceptions import NotFittedError

from eigenwalker.motion import JointWalk, Walk

__all__ = ["CHECKS"]


def _values(output):
    """Turn whatever a transformer returns into one array that can be compared."""
    if isinstance(output, list):
        return np.concatenate(
            [np.append(walk.channels.ravel(), [walk.speed, walk.size, walk.frequency]) for walk in output]
        )
    return np.asarray(output)


def arguments_are_stored_untouched(estimator, walks):
    for name, default in estimator.get_params(deep=False).items():
        marker = object()
        assert getattr(type(estimator)(**{name: marker}), name) is marker
        assert getattr(estimator, name) is default


def clone_forgets_and_keeps_parameters(estimator, walks):
    fitted = clone(estimator).fit(walks)
    again = clone(fitted)
    assert again.get_params() == estimator.get_params()
    assert not [name for name in vars(again) if name.endswith("_") and not name.startswith("_")]


def fit_returns_the_estimator_and_forgets_the_fit_before(estimator, walks):
    twice = clone(estimator).fit(walks[:1])
    assert twice.fit(walks) is twice
    np.testing.assert_array_equal(
        _values(twice.transform(walks)), _values(clone(estimator).fit(walks).transform(walks))
    )


def is_not_fitted_before_fit(estimator, walks):
    if not estimator.__sklearn_tags__().requires_fit:
        return
    for method in ("transform", "inverse_transform", "get_feature_names_out"):
        with pytest.raises(NotFittedError):
            getattr(clone(estimator), method)(*([] if method == "get_feature_names_out" else [walks]))


def input_is_unchanged(estimator, walks):
    before = copy.deepcopy(walks)
    fitted = clone(estimator).fit(walks)
    fitted.inverse_transform(fitted.transform(walks))
    for walk, copied in zip(walks, before, strict=True):
        np.testing.assert_array_equal(walk.channels, copied.channels)
        assert (walk.name, walk.frame_rate, walk.size) == (copied.name, copied.frame_rate, copied.size)


def pickle_keeps_the_fit(estimator, walks):
    fitted = clone(estimator).fit(walks)
    restored = pickle.loads(pickle.dumps(fitted))
    np.testing.assert_array_equal(_values(restored.transform(walks)), _values(fitted.transform(walks)))


def is_repeatable(estimator, walks):
    first, second = (clone(estimator).fit(walks).transform(walks) for _ in range(2))
    np.testing.assert_array_equal(_values(first), _values(second))


def one_walk_at_a_time_is_the_same(estimator, walks):
    """Nothing is learned across walks in `transform`."""
    fitted = clone(estimator).fit(walks)
    alone = [fitted.transform([walk]) for walk in walks]
    together = fitted.transform(walks)
    for position, output in enumerate(alone):
        np.testing.assert_array_equal(_values(output), _values(together[position : position + 1]))


def feature_names_match_columns(estimator, walks):
    if not hasattr(estimator, "get_feature_names_out"):
        return
    fitted = clone(estimator).fit(walks)
    names = fitted.get_feature_names_out()
    assert fitted.transform(walks).shape == (len(walks), len(names))
    assert len(set(names)) == len(names)
    table = fitted.set_output(transform="pandas").transform(walks)
    assert list(table.columns) == list(names)


def parameters_are_documented(estimator, walks):
    """Names, order and defaults in the docstring are those of the signature."""
    section = inspect.getdoc(type(estimator)).split("Parameters\n----------\n")[1].split("\n\n")[0]
    documented = re.findall(r"^(\w+) : (.*)$", section, flags=re.MULTILINE)
    signature = inspect.signature(type(estimator)).parameters
    assert [name for name, _ in documented] == list(signature)
    for name, kind in documented:
        assert kind.endswith(f"default {signature[name].default!r}".replace("'", '"')), name


def other_things_than_walks_are_refused(estimator, walks):
    with pytest.raises(TypeError, match="expected a list of walks, got a single"):
        clone(estimator).fit(walks[0])
    with pytest.raises(TypeError, match="expected a list"):
        clone(estimator).fit("walks")
    with pytest.raises(TypeError, match="at position 1"):
        clone(estimator).fit([walks[0], walks[0].channels])
    with pytest.raises(ValueError, match="at least one walk"):
        clone(estimator).fit([])


def transform_inverts(estimator, walks):
    """What was transformed once comes back through the inverse and the transform."""
    fitted = clone(estimator).fit(walks)
    output = fitted.transform(walks)
    back = fitted.inverse_transform(output)
    assert all(isinstance(walk, (Walk, JointWalk)) for walk in back)
    again = fitted.transform(back)
    if isinstance(output, list):
        assert [walk.channel_names for walk in again] == [walk.channel_names for walk in output]
    else:
        np.testing.assert_allclose(again, output, atol=1e-9)


CHECKS = [
    arguments_are_stored_untouched,
    clone_forgets_and_keeps_parameters,
    fit_returns_the_estimator_and_forgets_the_fit_before,
    is_not_fitted_before_fit,
    input_is_unchanged,
    pickle_keeps_the_fit,
    is_repeatable,
    one_walk_at_a_time_is_the_same,
    feature_names_match_columns,
    parameters_are_documented,
    other_things_than_walks_are_refused,
    transform_inverts,
]
