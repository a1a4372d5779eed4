"""Resemblance: walks of a style are as far as its own, and those of another as far as that."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from eigenwalker.experiment import resemblance_table
from tests.experiment.judging.styled import styled_walks


@pytest.fixture(scope="module")
def originals():
    return styled_walks(6)


def test_other_walks_of_a_style_are_as_far_as_its_own(originals):
    table = resemblance_table(*originals, *styled_walks(6, first=30))
    assert table.index.tolist() == ["bent", "straight"]
    assert (table[["n_originals", "n_synthetics"]] == 6).all(axis=None)
    assert_allclose(table["dissimilarity"], 0.0, atol=0.3)  # medians of 36 pairs
    for name in ("variance_ratio", "stride_variability_ratio", "jerk_ratio"):
        assert_allclose(table[name], 1.0, atol=0.5)
    assert (table["foot_slip_m_per_step"] > 0).all()


def test_walks_of_the_other_style_are_as_far_as_that(originals):
    walks, styles = styled_walks(6, first=30)
    table = resemblance_table(*originals, walks, styles[::-1])
    assert_allclose(table["dissimilarity"], 1.0, atol=0.3)


def test_the_order_of_walks_changes_nothing(originals):
    walks, styles = styled_walks(3, first=30)
    turned = resemblance_table(originals[0][::-1], originals[1][::-1], walks[::-1], styles[::-1])
    assert_allclose(turned, resemblance_table(*originals, walks, styles), rtol=1e-9)


def test_only_styles_that_were_made_have_a_row(originals):
    walks, styles = styled_walks(2, first=30)
    assert resemblance_table(*originals, walks[:2], styles[:2]).index.tolist() == ["straight"]


def test_errors(originals):
    walks, styles = originals
    with pytest.raises(ValueError, match=r"got shapes \(1,\) and \(12,\)"):
        resemblance_table(walks, ["bent"], walks, styles)
    with pytest.raises(ValueError, match="too few of: proud"):
        resemblance_table(walks, styles, walks[:1], ["proud"])
    with pytest.raises(ValueError, match="too few of: other styles"):
        resemblance_table(walks[:3], styles[:3], walks[:1], styles[:1])
    assert np.isfinite(resemblance_table(walks, styles, walks[:1], styles[:1])["to_style"]).all()
