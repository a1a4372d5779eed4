"""What a judge sees, and what it takes walks for."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.exceptions import NotFittedError
from sklearn.neighbors import KNeighborsClassifier

from eigenwalker.datasets import make_walkers
from eigenwalker.experiment import JudgedFeatures, judge_styles, make_style_judge, recognition_table
from eigenwalker.model import FourierLinearizer
from tests import contract
from tests.experiment.judging.styled import styled_walks

_INVERSE = ("is_not_fitted_before_fit", "input_is_unchanged", "transform_inverts")
CHECKS = [check for check in contract.CHECKS if check.__name__ not in _INVERSE]
"""All but those that call an inverse, which it does not have; the first two are tests of their own below."""
PLAIN = {"mean": True, "frequency": True, "share": 1.0, "noise": 0.0}


@pytest.fixture(scope="module")
def walks():
    return make_walkers(6, random_state=0).data


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
def test_contract(check, walks):
    check(JudgedFeatures(random_state=0) if "documented" not in check.__name__ else JudgedFeatures(), walks)


@pytest.mark.parametrize("method", ["transform", "get_feature_names_out"])
def test_not_fitted(method, walks):
    with pytest.raises(NotFittedError):
        getattr(JudgedFeatures(), method)(walks)


def test_input_is_unchanged(walks):
    before = [np.array(walk.channels) for walk in walks]
    JudgedFeatures(random_state=0).fit_transform(walks)
    for walk, copied in zip(walks, before, strict=True):
        np.testing.assert_array_equal(walk.channels, copied)


def test_all_that_is_seen_is_what_the_linearizer_has(walks):
    seen = JudgedFeatures((1, 2), **PLAIN).fit_transform(walks)
    assert_allclose(seen, FourierLinearizer(2).fit_transform(walks))


def test_harmonics_are_those_that_are_asked_for(walks):
    features = JudgedFeatures((2,), share=1.0, noise=0.0).fit(walks)
    linearizer = FourierLinearizer(2).fit(walks)
    names = linearizer.get_feature_names_out()
    wanted = [at for at, name in enumerate(names) if name.startswith(("sin2", "cos2"))]
    assert_allclose(features.transform(walks), linearizer.transform(walks)[:, wanted])
    assert features.get_feature_names_out().tolist() == names[wanted].tolist()


def test_whole_markers_are_picked(walks):
    names = JudgedFeatures(share=0.2, random_state=3).fit(walks).get_feature_names_out()
    markers = {name.split("_", 1)[1][:-2] for name in names}
    assert len(markers) == 3
    assert len(names) == 3 * 3 * 2


def test_noise_is_as_large_as_asked_for(walks):
    noisy = JudgedFeatures(share=1.0, noise=0.1, random_state=0).fit_transform(walks)
    clean = JudgedFeatures(share=1.0, noise=0.0).fit_transform(walks)
    assert_allclose((noisy - clean).std(), 0.1, rtol=0.1)  # 540 draws


def test_frequency_has_no_noise(walks):
    seen = JudgedFeatures(frequency=True, noise=1.0, random_state=0).fit_transform(walks)
    assert_allclose(seen[:, -1], FourierLinearizer(1).fit_transform(walks)[:, -1])


def test_styles_are_recognized_and_synthetic_walks_of_another_style_are_not():
    train, styles = styled_walks(5)
    test, truths = styled_walks(3, first=50)
    trials = judge_styles(
        train, styles, test, truths, test, truths[::-1], judge=make_style_judge(mean=True, share=1.0, noise=0.0)
    )
    assert trials.columns.tolist() == ["truth", "answer", "kind", "walk"]
    table = recognition_table(trials)
    assert table.loc["original", "rate"] == 1.0
    assert table.loc["synthetic", "rate"] == 0.0


def test_a_judge_that_sees_little_errs():
    """What styles differ in, mean posture, is hidden: a coin would do as well, from 0.2 to 0.8 of 20."""
    train, styles = styled_walks(8, bends=(0.0, 0.02))
    test, truths = styled_walks(10, first=50, bends=(0.0, 0.02))
    trials = judge_styles(train, styles, test, truths, test[:1], truths[:1])
    assert 0.2 <= recognition_table(trials).loc["original", "rate"] <= 0.8


def test_the_judge_is_not_touched():
    train, styles = styled_walks(3)
    judge = make_style_judge(KNeighborsClassifier(1), random_state=0)
    judge_styles(train, styles, train, styles, train, styles, judge=judge)
    assert not hasattr(judge["classifier"], "classes_")


def test_errors(walks):
    with pytest.raises(ValueError, match=r"different whole numbers of at least 1, got \(0,\)\nshare must .* got 2"):
        JudgedFeatures((0,), share=2).fit(walks)
    with pytest.raises(ValueError, match="must not be empty"):
        JudgedFeatures(()).fit(walks)
    with pytest.raises(ValueError, match="noise must be 0 or more, got -1"):
        JudgedFeatures(noise=-1).fit(walks)
    with pytest.raises(ValueError, match="a style for each of the 2 original walks"):
        judge_styles(walks, ["a", "b"] * 3, walks[:2], ["a"], walks[:1], ["a"])
    with pytest.raises(ValueError, match="none for: c"):
        judge_styles(walks, ["a", "b"] * 3, walks[:1], ["c"], walks[:1], ["a"])
