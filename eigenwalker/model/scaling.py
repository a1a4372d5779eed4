"""Scaling of features before PCA, so that units do not decide what an Eigenwalker is."""

from collections.abc import Mapping
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, OneToOneFeatureMixin, TransformerMixin
from sklearn.utils.validation import check_array, check_is_fitted, validate_data

from eigenwalker._validation import check_choice
from eigenwalker.model._persons import mean_by_person, number_persons
from eigenwalker.model.blocks import take_weights

__all__ = ["SCALINGS", "BlockScaler", "feature_scales"]

SCALINGS = ("blocks", "features", "noise", None)


class BlockScaler(OneToOneFeatureMixin, TransformerMixin, BaseEstimator):
    r"""Bring posture in metres and frequency in hertz to one scale, and back.

    The columns are the posture features first, then `n_scalars` single features such as frequency and speed. With
    r the root mean square over the posture features of their standard deviations,

    - ``unit="blocks"`` divides the posture features by 1 and each single feature by its own SD over r, so that a
      single feature weighs as much as one average posture feature, and posture keeps its proportions;
    - ``unit="features"`` divides every feature by its own SD;
    - ``unit="noise"`` divides every feature by its SD within persons, between the walks of one person, so that what a
      noisy sensor does not see the same way twice counts little. It takes `groups` in `fit`;
    - ``unit=None`` divides by 1. Then the unit decides: frequency holds a tenth of the variance beside metres and
      nothing beside millimetres.

    Parameters
    ----------
    n_scalars : int, default 1
        How many of the last columns are single features: the frequency, and each of the linearizer's extras.
    unit : {"blocks", "features", "noise", None}, default "blocks"
        What is brought to one scale.
    tolerance : float, default 1e-6
        A posture feature whose SD is below `tolerance` times r is constant by convention, and what varies in it is
        rounding; it keeps scale 1, as does a single feature that does not vary.
    weights : mapping of str to float or array-like of shape (n_features,), default None
        What scaled features are multiplied by; see `block_weights` for the names. Names need columns with names, see
        `make_eigenwalkers`. A feature with weight 0 is left out, of r as well: it is 0 after scaling, and
        `inverse_transform` returns its mean over the training walks.

    Attributes
    ----------
    scale_ : ndarray of shape (n_features,)
        What each feature is divided by, weights included; infinite where it is left out.
    mean_ : ndarray of shape (n_features,)
        Mean of each feature over the training walks. It is not subtracted.
    spread_ : ndarray of shape (n_features,)
        SD of each feature over the training walks.
    block_shares_ : ndarray of shape (1 + n_scalars,)
        Share of the variance after scaling in the posture features together, and in each single feature.
    n_features_in_ : int
        Number of features.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import BlockScaler
    >>> vectors = np.array([[0.0, 3.0, 100.0], [2.0, 1.0, 300.0]])
    >>> BlockScaler().fit_transform(vectors)
    array([[0., 3., 1.],
           [2., 1., 3.]])
    """

    def __init__(
        self,
        n_scalars: int = 1,
        *,
        unit: str | None = "blocks",
        tolerance: float = 1e-6,
        weights: Mapping[str, float] | ArrayLike | None = None,
    ) -> None:
        self.n_scalars = n_scalars
        self.unit = unit
        self.tolerance = tolerance
        self.weights = weights

    def fit(self, X: ArrayLike, y: object = None, groups: ArrayLike | None = None) -> Self:
        """Learn the scales.

        Parameters
        ----------
        X : array-like of shape (n_walks, n_features)
            Feature vectors, the posture features first.
        y : object, default None
            Ignored.
        groups : array-like of shape (n_walks,), default None
            Which person each walk is of. For ``unit="noise"``; in a Pipeline ``fit(walks, y, scaler__groups=persons)``.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If there are fewer features than `n_scalars`, for "noise" no person with two walks, or if `weights` do not
            fit the features.
        """
        vectors = validate_data(self, X, dtype=np.float64)
        spread = vectors.std(axis=0)
        counted = _spreads_within(vectors, groups) if self.unit == "noise" else spread
        return self._learn(vectors.mean(axis=0), spread, counted, vectors)

    def _learn(
        self,
        mean: NDArray[np.float64],
        spread: NDArray[np.float64],
        counted: NDArray[np.float64],
        vectors: NDArray[np.float64],
    ) -> Self:
        """Set what is learned from the mean, the SD and the SD that counts; `vectors` tell how large features are."""
        check_choice(self.unit, SCALINGS, name="unit")
        n_posture = len(mean) - self.n_scalars
        if n_posture < 0 or self.n_scalars < 0:
            raise ValueError(
                f"expected at least the n_scalars={self.n_scalars} single features, got {len(mean)} feature(s) in all"
            )
        weights = take_weights(self.weights, len(mean), getattr(self, "feature_names_in_", None))
        self.mean_, self.spread_ = mean, spread
        self.scale_ = feature_scales(
            vectors, counted, n_scalars=self.n_scalars, unit=self.unit, tolerance=self.tolerance, weights=weights
        )
        variances = (self.spread_ / self.scale_) ** 2
        blocks = np.concatenate(([variances[:n_posture].sum()], variances[n_posture:]))
        self.block_shares_ = blocks / blocks.sum() if blocks.sum() > 0 else np.zeros_like(blocks)
        return self

    def transform(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return the scaled features.

        Parameters
        ----------
        X : array-like of shape (n_walks, n_features)
            Feature vectors.

        Returns
        -------
        ndarray of shape (n_walks, n_features)
        """
        check_is_fitted(self)
        return validate_data(self, X, dtype=np.float64, reset=False) / self.scale_

    def inverse_transform(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return the features in their own units.

        Parameters
        ----------
        X : array-like of shape (n_walks, n_features)
            Scaled features.

        Returns
        -------
        ndarray of shape (n_walks, n_features)
        """
        check_is_fitted(self)
        scaled = check_array(X, dtype=np.float64, input_name="X")
        if scaled.shape[1] != self.n_features_in_:
            raise ValueError(f"expected {self.n_features_in_} features, got {scaled.shape[1]}")
        kept = np.isfinite(self.scale_)
        return np.where(kept, scaled * np.where(kept, self.scale_, 0.0), self.mean_)


def feature_scales(
    vectors: NDArray[np.float64],
    spreads: NDArray[np.float64],
    *,
    n_scalars: int,
    unit: str | None,
    tolerance: float,
    weights: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return what `BlockScaler` divides each feature by, shape (n_features,).

    Parameters
    ----------
    vectors : ndarray of shape (n_walks, n_features)
        Their size tells which spreads are rounding.
    spreads : ndarray of shape (n_features,)
        The SD of each feature that counts: over all walks, weighted, or within persons.
    n_scalars, unit, tolerance : int, str or None, float
        Of `BlockScaler`.
    weights : ndarray of shape (n_features,)
        What scaled features are multiplied by.
    """
    n_posture = vectors.shape[1] - n_scalars
    scale = np.ones_like(spreads)
    if unit is not None:
        posture = spreads[:n_posture]
        kept = posture[weights[:n_posture] > 0]
        reference = np.sqrt(np.mean(kept**2)) if kept.size else 1.0
        if unit != "blocks":
            vary = posture > tolerance * reference
            scale[:n_posture][vary] = posture[vary]
            reference = 1.0
        scalars = spreads[n_posture:]
        magnitudes = np.abs(vectors[:, n_posture:]).max(axis=0, initial=0.0)
        varies = (scalars > 1e-12 * magnitudes) & (reference > 0)
        scale[n_posture:][varies] = scalars[varies] / reference
    return np.divide(scale, weights, out=np.full_like(scale, np.inf), where=weights > 0)


def _spreads_within(vectors: NDArray[np.float64], groups: ArrayLike | None) -> NDArray[np.float64]:
    """Return the SD of each feature between the walks of one person, pooled over persons."""
    if groups is None:
        raise ValueError("unit='noise' needs to know which person each walk is of; pass groups, one entry a walk")
    persons = number_persons(groups, len(vectors))
    n_persons = int(persons.max()) + 1
    n_free = len(vectors) - n_persons
    if n_free < 1:
        raise ValueError(
            f"unit='noise' needs persons with two walks or more, got {n_persons} persons with one each; "
            "use unit='features'"
        )
    about_person = vectors - mean_by_person(vectors, persons)[persons]
    return np.sqrt((about_person**2).sum(axis=0) / n_free)
