"""Shares of the variance."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from sklearn.decomposition import PCA

from eigenwalker.display import ScreeDisplay
from eigenwalker.model import make_eigenwalkers


def _heights(ax):
    return [bar.get_height() for bar in ax.patches]


def test_bars_are_the_shares_and_the_line_their_sum(model):
    ax = ScreeDisplay.from_estimator(model).ax_
    shares = model["eigenwalkers"].explained_variance_ratio_
    assert_allclose(_heights(ax), [*shares, 1 - shares.sum()])
    assert_allclose(ax.lines[0].get_xydata(), np.column_stack((np.arange(1, 11), np.cumsum(shares))))
    assert f"10 Eigenwalkers hold {shares.sum():.1%} of the variance" in ax.get_title(loc="left")


def test_no_bar_where_nothing_is_left_out():
    pca = PCA().fit(np.random.default_rng(0).normal(size=(12, 4)))
    ax = ScreeDisplay.from_estimator(pca).ax_
    assert_allclose(_heights(ax), pca.explained_variance_ratio_)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["cumulative", "each Eigenwalker"]


def test_one_eigenwalker_is_a_scree_too():
    ax = ScreeDisplay([0.6]).plot().ax_
    assert_allclose(_heights(ax), [0.6, 0.4])


@pytest.mark.parametrize("model", [PCA(), make_eigenwalkers()])
def test_models_without_fitted_eigenwalkers_are_refused(model):
    with pytest.raises(ValueError, match=r"model must be a fitted PCA or have one among its steps, got .*PCA"):
        ScreeDisplay.from_estimator(model)
