"""The discriminant between two groups of walkers, as a scikit-learn classifier (Troje 2002, section 3)."""

from collections.abc import Hashable
from typing import Self

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, TransformerMixin
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import check_consistent_length, check_is_fitted, column_or_1d, validate_data

from eigenwalker._validation import check_choice
from eigenwalker.model._labels import Poles, tabulate
from eigenwalker.model.traits import TraitRegressor

__all__ = ["TraitClassifier"]


class TraitClassifier(ClassifierMixin, TransformerMixin, BaseEstimator):
    """The least-squares discriminant between two groups of walkers (Troje 2002, section 3).

    Groups are coded -1 and +1 and regressed on the scores by `TraitRegressor`; the predicted group is the side on
    which the result falls. `transform` and `inverse_transform` are those of the trait axis.

    Parameters
    ----------
    alpha_unit : {"sd", "label", "coefficient"}, default "sd"
        See `TraitRegressor`.
    direction : {"pattern", "filter"}, default "pattern"
        See `TraitRegressor`.
    poles : mapping of str to (label, label), default None
        The two groups, the one of negative alpha first. None takes them in alphabetical order.
    boundary : {"zero", "midpoint"}, default "zero"
        Where one group ends and the other begins on the axis. "zero" is where 0 is predicted, which favors the larger
        group; "midpoint" is midway between the means of the groups, so that neither is favored.

    Attributes
    ----------
    classes_ : ndarray of shape (2,)
        The groups, sorted.
    axis_ : TraitRegressor
        The trait axis.
    alpha_means_ : dict
        Mean alpha of each group.
    alpha_boundary_ : float
        The alpha at which the prediction changes sides.
    n_features_in_ : int
        Number of components.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import TraitClassifier
    >>> scores = np.array([[-2.0, 0.0], [-1.0, 1.0], [1.0, -1.0], [2.0, 0.5]])
    >>> gender = TraitClassifier().fit(scores, ["female", "female", "male", "male"])
    >>> gender.predict([[0.5, 0.0]]).tolist()
    ['male']
    """

    def __init__(
        self,
        *,
        alpha_unit: str = "sd",
        direction: str = "pattern",
        poles: Poles | None = None,
        boundary: str = "zero",
    ) -> None:
        self.alpha_unit = alpha_unit
        self.direction = direction
        self.poles = poles
        self.boundary = boundary

    def fit(
        self, X: ArrayLike, y: ArrayLike, groups: ArrayLike | None = None, control: ArrayLike | None = None
    ) -> Self:
        """Learn the axis.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.
        y : Series, one-column DataFrame or array-like of shape (n_walkers,)
            The group of each walker, two different ones.
        groups : array-like of shape (n_walkers,), default None
            Which person each walk is of; see `TraitRegressor.fit`.
        control : DataFrame, Series or array-like of shape (n_walkers,) or (n_walkers, n_controls), default None
            What the axis may not go along with; see `TraitRegressor.fit`.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If there are not exactly two groups, or labels are missing.
        """
        check_choice(self.boundary, ("zero", "midpoint"), name="boundary")
        if y is None:
            raise ValueError("requires y to be passed, but the target y is None")
        scores = validate_data(self, X, dtype=np.float64, ensure_min_samples=2)
        labels = _one_trait(y, self.poles)
        check_consistent_length(scores, labels, groups)
        self.axis_ = self._make_axis(labels)
        negative, positive = self._poles(labels.name)
        self.axis_.fit(scores, labels.eq(positive).map({False: -1.0, True: 1.0}), groups, control)
        alphas = pd.Series(self.axis_.transform(scores)[:, 0])
        self._report_groups([float(alphas[labels.eq(pole)].mean()) for pole in (negative, positive)])
        return self

    def _make_axis(self, labels: pd.Series) -> TraitRegressor:
        """Learn the classes, and return the axis that is to be fitted to their codes."""
        self.classes_ = _two_classes(labels)
        poles = {labels.name: self._poles(labels.name)}
        return TraitRegressor(alpha_unit=self.alpha_unit, direction=self.direction, poles=poles)

    def _report_groups(self, means: list[float]) -> None:
        """Set what follows from the mean alpha of each group, the negative one first."""
        self.alpha_means_ = dict(zip(self._poles(self.trait_names_[0]), means, strict=True))
        fitted = [self.axis_.to_label(alpha) for alpha in means]
        self._boundary = 0.0 if self.boundary == "zero" else float(np.mean(fitted))
        self.alpha_boundary_ = self.axis_.to_alpha(self._boundary)

    def _poles(self, name: str) -> tuple[Hashable, Hashable]:
        if not self.poles:
            first, second = self.classes_.tolist()
            return first, second
        if list(self.poles) != [name] or set(self.poles[name]) != set(self.classes_.tolist()):
            raise ValueError(
                f"poles must be {{{name!r}: (group, group)}} with the groups {self.classes_.tolist()}, "
                f"got {dict(self.poles)}"
            )
        negative, positive = self.poles[name]
        return negative, positive

    @property
    def mean_(self) -> NDArray[np.float64]:
        """Score of the average walker."""
        check_is_fitted(self)
        return self.axis_.mean_

    @property
    def trait_names_(self) -> list[str]:
        """Name of the trait, in a list."""
        check_is_fitted(self)
        return self.axis_.trait_names_

    @property
    def poles_(self) -> dict[str, tuple[Hashable, Hashable]]:
        """The groups at the negative and the positive end."""
        check_is_fitted(self)
        return self.axis_.poles_

    def decision_function(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return the predicted code of each walker less that of the boundary; positive for the second of `classes_`.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.

        Returns
        -------
        ndarray of shape (n_walkers,)
        """
        check_is_fitted(self)
        scores = validate_data(self, X, dtype=np.float64, reset=False)
        sign = 1.0 if self.axis_.poles_[self.trait_names_[0]][1] == self.classes_[1] else -1.0
        return sign * (self.axis_.predict(scores) - self._boundary)

    def predict(self, X: ArrayLike) -> NDArray:
        """Return the predicted group of each walker.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.

        Returns
        -------
        ndarray of shape (n_walkers,)
        """
        check_is_fitted(self)
        return self.classes_[(self.decision_function(X) > 0).astype(int)]

    def transform(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return alpha; see `TraitRegressor.transform`.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.

        Returns
        -------
        ndarray of shape (n_walkers, 1)
        """
        check_is_fitted(self)
        return self.axis_.transform(validate_data(self, X, dtype=np.float64, reset=False))

    def inverse_transform(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return the scores that have the given alpha; see `TraitRegressor.inverse_transform`.

        Parameters
        ----------
        X : array-like of shape (n_walkers, 1)
            In `alpha_unit`.

        Returns
        -------
        ndarray of shape (n_walkers, n_components)
        """
        check_is_fitted(self)
        return self.axis_.inverse_transform(X)

    def step(self, alphas: ArrayLike, traits: list[str]) -> NDArray[np.float64]:
        """Return the steps that change alpha; see `TraitRegressor.step`.

        Parameters
        ----------
        alphas : array-like of shape (n_steps, 1)
            Changes of alpha, in `alpha_unit`.
        traits : list of str
            The name of the trait.

        Returns
        -------
        ndarray of shape (n_steps, n_components)
        """
        check_is_fitted(self)
        return self.axis_.step(alphas, traits)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Return the name of the trait.

        Parameters
        ----------
        input_features : object, default None
            Ignored.
        """
        return np.array(self.trait_names_, dtype=object)

    def __sklearn_tags__(self):
        """Tell scikit-learn that there are two classes."""
        tags = super().__sklearn_tags__()
        tags.classifier_tags.multi_class = False
        return tags


def _one_trait(y: object, poles: Poles | None) -> pd.Series:
    """Return the labels of one trait as a Series with its name."""
    if isinstance(y, pd.DataFrame) and y.shape[1] != 1:
        raise ValueError(f"y must have one column, got {y.shape[1]}; use TraitRegressor for many traits")
    if not isinstance(y, (pd.DataFrame, pd.Series)):
        y = column_or_1d(y, warn=True)
    labels = tabulate(y, poles).iloc[:, 0]
    if labels.isna().any():
        raise ValueError(
            f"Input y, trait {labels.name!r}, contains NaN: {int(labels.isna().sum())} of {len(labels)} labels are "
            "missing; leave these walkers out, or use TraitRegressor"
        )
    if pd.api.types.is_float_dtype(labels) and np.isinf(labels).any():
        raise ValueError(f"Input y, trait {labels.name!r}, contains infinity, which is no group")
    check_classification_targets(labels.to_numpy())
    return labels


def _two_classes(labels: pd.Series) -> NDArray:
    """Return the two classes, sorted."""
    classes = np.unique(labels.to_numpy())
    if len(classes) != 2:
        shown = ", ".join(map(repr, classes[:6].tolist()))
        count = "one class only" if len(classes) == 1 else f"{len(classes)} classes"
        raise ValueError(
            f"trait {labels.name!r}: expected two classes, got {count}: {shown}. "
            "Only binary classification is supported."
        )
    return classes
