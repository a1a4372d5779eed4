"""Synthetic walks told from recorded ones: where they differ, where they do not, and in styles that are not known."""

from dataclasses import replace

import pytest

from eigenwalker.experiment import answer_shares, discriminate_walks
from tests.experiment.judging.styled import styled_walks


def renamed(walks, kind):
    """Return walks that are called by their kind."""
    return [replace(walk, name=f"{kind} {walk.name}") for walk in walks]


@pytest.fixture(scope="module")
def straight():
    return styled_walks(24, bends=(0.0,))[0]


def test_what_differs_is_told(straight):
    bent, _ = styled_walks(10, first=60, bends=(0.3,))
    found = discriminate_walks(straight[:10], bent)
    assert found.accuracy.value == found.auc.value == 1.0
    assert found.accuracy.low > 0.7
    assert answer_shares(found.trials).loc["synthetic", "synthetic"] == 1.0


def test_what_does_not_differ_is_not_told(straight):
    found = discriminate_walks(straight[::2], straight[1::2])
    assert found.auc.low < 0.5 < found.auc.high
    assert found.accuracy.low < 0.5 < found.accuracy.high


def test_a_sign_that_one_style_alone_has_is_not_known_in_another():
    """Style a is synthesized with knees too straight, b with knees too bent: what is learned from one misleads."""
    originals, _ = styled_walks(8, bends=(0.1,))
    straighter, _ = styled_walks(4, first=40, bends=(0.0,))
    more, _ = styled_walks(4, first=50, bends=(0.2,))
    groups = ["a"] * 4 + ["b"] * 4
    known = discriminate_walks(originals, straighter + more)
    unknown = discriminate_walks(originals, straighter + more, original_groups=groups, synthetic_groups=groups)
    assert unknown.auc.value < known.auc.value


def test_trials_name_walks(straight):
    found = discriminate_walks(renamed(straight[:4], "real"), renamed(straight[4:8], "made"))
    assert found.trials["walk"].str.startswith("real").tolist() == [True] * 4 + [False] * 4
    assert (found.trials["truth"] == found.trials["kind"]).all()


def test_errors(straight):
    with pytest.raises(ValueError, match=r"two walks or more of each kind, and two groups or more, got \(3, 1\)"):
        discriminate_walks(straight[:3], straight[3:4])
    with pytest.raises(ValueError, match=r"a group for each of 2 and 2 walks, got shapes \(\(2,\), None\)"):
        discriminate_walks(straight[:2], straight[2:4], original_groups=["a", "b"])
    with pytest.raises(ValueError, match="two groups or more"):
        discriminate_walks(straight[:2], straight[2:4], original_groups=["a", "a"], synthetic_groups=["a", "a"])
