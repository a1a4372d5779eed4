"""One walker against a group: where on each trait axis, how sure, how far from everybody, and in what."""

import warnings
from copy import copy
from dataclasses import replace
from html import escape
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import t as student
from sklearn.decomposition import PCA
from sklearn.pipeline import Pipeline

from eigenwalker.model._guards import LIMIT, share_beyond
from eigenwalker.model.eigenwalkers import split_model, trait_axes
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.model.scaling import BlockScaler
from eigenwalker.model.traits import TraitRegressor
from eigenwalker.motion.single_strides import split_strides
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["WalkerScore", "score_walker"]

_FEWEST = 3  # strides whose spread says something
_TIE = 1e-9  # SDs of alpha over walkers; what differs by less differs by rounding
_ALL_KEPT = 1e-12  # share of the variance left out by PCA, below which it is rounding


class WalkerScore(NamedTuple):
    """What `score_walker` returns. Printed it is a table of the axes and a sentence on the distance.

    Parameters
    ----------
    name : str
        The walk's name.
    level : float
        Of the intervals.
    axes : DataFrame, one row a trait
        With the columns alpha, in the trait step's `alpha_unit`; low and high, the ends of its interval; label, the
        predicted one in its own unit, for traits with two words the code, about -1 to +1; percentile, 0 to 100, among
        the training walkers or persons: the share with a smaller alpha and half of the share with the same; negative
        and positive, the words for the ends of the axis.
    n_strides : int
        Single strides from phase zero to phase zero, which the intervals are from.
    distance : float
        From the average walker, in SD of the training walkers: Mahalanobis, over all Eigenwalkers.
    distance_limit : float
        Distance within which 99 % of new walkers lie, or more, that are of the kind of those in training. Infinite
        where there are no more of these than Eigenwalkers.
    share_beyond : float
        Share, 0 to 1, of such new walkers who are expected further away, at most; NaN where the limit is infinite. It
        would be exact for Eigenwalkers of other people: these are the directions in which the training walkers vary
        most, and others vary less in them. With 10 Eigenwalkers of 200 simulated walkers half of all new ones get
        more than 0.64, with 15 of 80 more than 0.86. Few Eigenwalkers tell more surely who is far away.
    residual : float
        How much of the walk lies outside the Eigenwalkers: the mean square, over scaled features, of what they leave
        out, over that of the training walks on average. NaN where they leave nothing out. The Eigenwalkers fit the
        training walks better than any others: new walks of the same kind come out above 1, the more so the fewer were
        in training. A walk can be near in `distance` and yet be unlike all of them here.
    features : DataFrame, one row a feature
        With the columns value; mean and sd over the training walks, in the feature's own unit; and z = (value - mean)
        / sd, NaN where the feature is left out by a weight of 0, or where it is constant and its sd rounding: not
        above the `tolerance` of `BlockScaler` times the root mean square of the sd of all posture features.
    walk : Walk or JointWalk
        The walk as it was scored: prepared, where the model prepares.
    average : Walk or JointWalk
        The average walker of the model.
    """

    name: str
    level: float
    axes: pd.DataFrame
    n_strides: int
    distance: float
    distance_limit: float
    share_beyond: float
    residual: float
    features: pd.DataFrame
    walk: Walk | JointWalk
    average: Walk | JointWalk

    def to_frame(self) -> pd.DataFrame:
        """Return the table of the axes, a copy."""
        return self.axes.copy()

    def __str__(self) -> str:
        return f"{self._head()}\n{self.axes.round(2)}\n{self._sentence()}"

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        table = self.axes.round(2).to_html()
        return f"<p>{escape(self._head())}</p>\n{table}\n<p>{escape(self._sentence())}</p>"

    def _head(self) -> str:
        return f"{self.name or 'walk'}, {100 * self.level:g} % intervals from {self.n_strides} strides"

    def _sentence(self) -> str:
        if np.isnan(self.share_beyond):
            beyond = "too few training walkers to say how many of their kind are further away"
        else:
            share = f"at most {100 * self.share_beyond:.0f} %" if self.share_beyond >= 0.01 else "fewer than 1 %"
            beyond = f"{share} of walkers like those in training are further away"
        return f"distance {self.distance:.1f} SD; {beyond}"


def score_walker(model: Pipeline, walk: Walk | JointWalk, *, level: float = 0.95) -> WalkerScore:
    r"""Return where one walker stands in the group that a model was fitted to: a patient among controls.

    The interval of alpha is from the single strides of the walk. Each is fitted alone, with its own duration and in its
    own phase (`split_strides`). With their number n, the mean m and the SD s of their alphas, and the quantile t of
    Student's distribution with n - 1 degrees of freedom,

    .. math:: low = \min(alpha, m) - t s / \sqrt n, \qquad high = \max(alpha, m) + t s / \sqrt n

    m and alpha differ where the cadence varies: a fit of one frequency to the whole walk blurs its strides, and is
    biased toward less motion the longer the walk is, while m is not. Prepared with ``cadence="steady"`` they differ
    little, but the interval then holds nothing of how stride times vary. In simulated walks of 5, 10 and 20 strides
    that vary independently of each other, stride times by 0 to 4 %, an interval of 95 % holds the alpha of the mean
    stride in 93 to 99 % of all cases. Around alpha alone it would in as few as 58 %, for 20 strides and stride times
    that vary by 2 %.

    It says how well this recording pins down the walker's alpha on that day. Strides are taken for independent of each
    other: where neighbors are alike, as in a slow drift of posture, the interval is too narrow, by the factor
    sqrt((1 + r) / (1 - r)) for a correlation of r^k between strides k apart. It holds nothing of what differs from day
    to day, from shoe to shoe and between preparations, nor of how uncertain the axis itself is (`bootstrap_axes`). The
    extras speed and size are those of the whole walk for every stride; strides of `pool_walks` are given one mean
    frequency, and those of a symmetrized walk are means of neighbors.

    Parameters
    ----------
    model : Pipeline
        Fitted, from `make_eigenwalkers`, or with a `BlockScaler` after its linearizer, and a PCA, as there. Steps
        before the linearizer are applied to the walk first.
    walk : Walk or JointWalk
        One walk of one walker, who need not be among those in training; also from `pool_walks`.
    level : float, default 0.95
        Of the intervals, between 0 and 1.

    Returns
    -------
    WalkerScore

    Raises
    ------
    TypeError
        If `walk` is not one walk.
    ValueError
        If `level` is out of range, or if the model lacks a linearizer, a `BlockScaler` or a PCA.
    WalkError
        If the linearizer, or a step before it, refuses the walk, or if `split_strides` does.

    Warns
    -----
    UserWarning
        If the walk has fewer than 3 strides, for which there is no interval: low and high are NaN.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.model import make_eigenwalkers
    >>> from eigenwalker.model.walker_score import score_walker
    >>> walkers = make_walkers(25, duration=6, frame_rate=60, random_state=0)
    >>> model = make_eigenwalkers(n_components=5).fit(walkers.data[1:], walkers.target["weight"][1:])
    >>> score = score_walker(model, walkers.data[0])
    >>> alpha, low, high = score.axes.loc["weight", ["alpha", "low", "high"]]
    >>> bool(low < alpha < high), bool(alpha == model.transform(walkers.data[:1])[0, 0])
    (True, True)
    """
    _check(walk, level)
    before, linearizer, reduction = split_model(model)
    _check_steps(reduction)
    prepared = before.transform([walk])[0] if before else walk
    axes, vector = trait_axes(model), linearizer.transform([prepared])
    scores = reduction.transform(vector)
    alphas = np.asarray(axes.transform(scores))[0]
    strides = split_strides(prepared, phase_reference=linearizer.phase_reference)
    interval = _interval(alphas, _stride_alphas(model, strides, prepared.name), level)
    distance = axes.distance(scores)
    return WalkerScore(
        name=prepared.name,
        level=level,
        axes=_axes_table(axes, alphas, interval, np.ravel(axes.predict(scores))),
        n_strides=len(strides),
        distance=float(distance[0]),
        distance_limit=axes.distance_limit(LIMIT),
        share_beyond=float(share_beyond(distance, axes.n_walkers_, len(axes.mean_))[0]),
        residual=_residual(reduction, vector),
        features=_features_table(linearizer, reduction[0], np.asarray(vector)[0]),
        walk=prepared,
        average=_average(linearizer, reduction, axes),
    )


def _check(walk: object, level: float) -> None:
    if not isinstance(walk, (Walk, JointWalk)):
        raise TypeError(f"expected one Walk or JointWalk, got {type(walk).__name__}; score walkers one at a time")
    if not 0 < level < 1:
        raise ValueError(f"level must be between 0 and 1, got {level!r}")


def _check_steps(reduction: Pipeline) -> None:
    """Raise unless features are known before PCA with their means and SDs, and what PCA leaves out is."""
    names = [name for name, _ in reduction.steps]
    if not isinstance(reduction[0] if names else None, BlockScaler):
        raise ValueError(
            "model must have a BlockScaler right after its linearizer to score a walker by its features, got the steps "
            f"{names}; BlockScaler(unit=None) scales nothing and learns their means and SDs"
        )
    if not any(isinstance(step, PCA) for _, step in reduction.steps):
        raise ValueError(f"model must have a PCA before its trait step to score a walker, got the steps {names}")


def _stride_alphas(model: Pipeline, strides: list[Walk | JointWalk], name: str) -> NDArray[np.float64]:
    """Return the alphas of single strides, shape (n_strides, n_traits); none where there are too few."""
    _, linearizer, reduction = split_model(model)
    axes = trait_axes(model)
    if len(strides) < _FEWEST:
        warnings.warn(
            f"walk {name!r}: an interval of alpha needs at least {_FEWEST} strides from phase zero to phase zero, got "
            f"{len(strides)}; low and high are NaN. Use a longer recording, or pool_walks of several",
            stacklevel=3,
        )
        return np.empty((0, len(axes.trait_names_)))
    quiet = copy(linearizer)
    quiet.warn_below = -np.inf  # the whole walk has been warned about
    return np.asarray(axes.transform(reduction.transform(quiet.transform(strides))))


def _interval(alphas: NDArray[np.float64], by_stride: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    """Return low and high, shape (2, n_traits)."""
    if not len(by_stride):
        return np.full((2, len(alphas)), np.nan)
    mean, quantile = by_stride.mean(axis=0), student.ppf((1 + level) / 2, len(by_stride) - 1)
    half = quantile * by_stride.std(axis=0, ddof=1) / np.sqrt(len(by_stride))
    return np.stack((np.minimum(alphas, mean) - half, np.maximum(alphas, mean) + half))


def _axes_table(
    axes: TraitRegressor, alphas: NDArray[np.float64], interval: NDArray[np.float64], labels: NDArray[np.float64]
) -> pd.DataFrame:
    trained = axes.training_alphas()
    ties = _TIE * trained.std(axis=0)
    below, with_ties = trained < alphas - ties, trained <= alphas + ties
    negative, positive = zip(*(axes.poles_[name] for name in axes.trait_names_), strict=True)
    columns = {
        "alpha": alphas,
        "low": interval[0],
        "high": interval[1],
        "label": labels,
        "percentile": 50.0 * (below.mean(axis=0) + with_ties.mean(axis=0)),
        "negative": negative,
        "positive": positive,
    }
    return pd.DataFrame(columns, index=pd.Index(axes.trait_names_, name="trait"))


def _residual(reduction: Pipeline, vector: object) -> float:
    """Return the squares that PCA leaves out of a vector, shape (1, n_features), over those of training walks."""
    position, pca = next((place, step) for place, (_, step) in enumerate(reduction.steps) if isinstance(step, PCA))
    n_walks, n_left_out = pca.n_samples_, min(pca.n_samples_, pca.n_features_in_) - pca.n_components_
    usual = pca.noise_variance_ * n_left_out * (n_walks - 1) / n_walks  # its variances divide by n - 1
    if usual <= _ALL_KEPT * pca.explained_variance_.sum():
        return float("nan")
    scaled = reduction[:position].transform(vector)
    rest = np.asarray(scaled) - pca.inverse_transform(np.asarray(pca.transform(scaled)))
    return float((rest**2).sum() / usual)


def _features_table(linearizer: FourierLinearizer, scaler: BlockScaler, values: NDArray[np.float64]) -> pd.DataFrame:
    mean, spread = scaler.mean_, scaler.spread_
    posture = spread[: len(spread) - scaler.n_scalars]
    varies = spread > scaler.tolerance * np.sqrt(np.mean(posture**2))
    scored = varies & np.isfinite(scaler.scale_)
    z = np.divide(values - mean, spread, out=np.full_like(values, np.nan), where=scored)
    names = pd.Index(linearizer.get_feature_names_out(), name="feature")
    return pd.DataFrame({"value": values, "mean": mean, "sd": spread, "z": z}, index=names)


def _average(linearizer: FourierLinearizer, reduction: Pipeline, axes: TraitRegressor) -> Walk | JointWalk:
    vectors = reduction.inverse_transform(axes.mean_[np.newaxis])
    return replace(linearizer.inverse_transform(vectors)[0], name="average")
