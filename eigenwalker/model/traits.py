"""Trait axes: what walkers differ in, learned from labels, and steps along it (Troje 2002, section 3)."""

from collections.abc import Mapping, Sequence
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, RegressorMixin, TransformerMixin
from sklearn.metrics import r2_score
from sklearn.utils.validation import (
    check_array,
    check_consistent_length,
    check_is_fitted,
    validate_data,
)

from eigenwalker._validation import check_choice
from eigenwalker.model._axes import ALPHA_UNITS, DIRECTIONS, Axes, displacement, fit_axes, move, unit_lengths
from eigenwalker.model._control import take_controls
from eigenwalker.model._guards import LIMIT, distance_limit, distances, warn_outside
from eigenwalker.model._labels import Coding, Poles, encode, learn_coding, tabulate
from eigenwalker.model._persons import mean_by_person, number_persons

__all__ = ["TraitRegressor"]


class TraitRegressor(RegressorMixin, TransformerMixin, BaseEstimator):
    r"""Least-squares trait axes in Eigenwalker space, for numbers, ratings and pairs of words.

    Fits the labels of one or many traits on the scores, with intercept (Troje 2002, Eq. 5). For trait t with filter
    c_t the displacement of a walker with centered score s is a_t = c_t . s, in units of the label. `predict` gives
    labels, `transform` gives alpha, and `inverse_transform` gives scores that have a wanted alpha on every trait,
    with C the matrix of all filters and a the displacements:

    .. math:: s = Cov\, C' (C\, Cov\, C')^{-1} a \quad\text{or}\quad s = C' (C C')^{-1} a

    One trait with ``alpha_unit="coefficient"`` and ``direction="filter"`` is Troje 2002, Eq. 6 to the letter.

    With control variables z given to `fit` the axes are the best of those with cov(c . s, z) = 0 over the training
    walkers: an alpha that says nothing about gender and height, and as much about weight as one such can. A step along
    such an axis in the direction "pattern" leaves alone what the scores tell about the controls, as Cov c is orthogonal
    to the filter of z. On new walkers the covariance is small, not zero, where walks hide a part of a control: of the
    order of n_components / n_walkers (`python -m benchmarks.truth`). What weight does to a walk while gender and height
    stay is another question: regress the label on the controls first, and learn its residual.

    Parameters
    ----------
    alpha_unit : {"sd", "label", "coefficient"}, default "sd"
        What alpha = 1 is: one standard deviation of the displacement over the training walkers (over persons when
        `fit` is given groups); one unit of the label; or the step c_t itself.
    direction : {"pattern", "filter"}, default "pattern"
        Which way a walker is moved: along what changes together with the trait among the training walkers, or
        along the filter that reads it best, which is not the same when scores are correlated or differ in variance.
    poles : mapping of str to (label, label), default None
        Words for the negative and the positive end of a trait, {"mood": ("sad", "happy")}. Traits with two words as
        labels are coded -1 and +1 in this order, alphabetically without poles. The published convention is that
        plus is male, heavy, nervous and happy.

    Attributes
    ----------
    coef_ : ndarray of shape (n_traits, n_components)
        The filters.
    intercept_ : ndarray of shape (n_traits,)
        Predicted label of the average walker.
    mean_ : ndarray of shape (n_components,)
        Score of the average walker, which has alpha = 0.
    covariance_ : ndarray of shape (n_components, n_components)
        Of the training walkers' scores.
    alpha_sd_ : ndarray of shape (n_traits,)
        SD of the displacement over training walkers or persons, in label units.
    trait_names_ : list of str
        From the columns of `y`.
    control_names_ : list of str
        From the columns of `control`.
    alphas_ : ndarray of shape (n_persons, n_traits)
        Alpha of each training walker, or the mean over the walks of each person. Missing after ``fit_stream(...,
        alphas=False)``, which leaves them out.
    poles_ : dict of str to tuple
        Words for the ends of each trait.
    alpha_means_ : dict of str to dict
        For traits labelled with two words: mean alpha of each group.
    alpha_boundary_ : dict of str to float
        For these traits: the alpha at which the predicted label changes sides.
    n_features_in_ : int
        Number of components.

    Examples
    --------
    >>> import numpy as np
    >>> from eigenwalker.model import TraitRegressor
    >>> scores = np.array([[-2.0, 0.0], [-1.0, 1.0], [1.0, -1.0], [2.0, 0.0]])
    >>> axis = TraitRegressor(alpha_unit="label").fit(scores, [-4.0, -2.0, 2.0, 4.0])
    >>> axis.coef_.round(6) + 0, axis.transform([[0.5, 0.0]]).round(6)
    (array([[2., 0.]]), array([[1.]]))
    >>> axis.transform(axis.inverse_transform([[3.0]])).round(6)
    array([[3.]])
    """

    def __init__(self, *, alpha_unit: str = "sd", direction: str = "pattern", poles: Poles | None = None) -> None:
        self.alpha_unit = alpha_unit
        self.direction = direction
        self.poles = poles

    def fit(
        self, X: ArrayLike, y: ArrayLike, groups: ArrayLike | None = None, control: ArrayLike | None = None
    ) -> Self:
        """Learn the axes.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.
        y : DataFrame, Series or array-like of shape (n_walkers,) or (n_walkers, n_traits)
            Numbers, or two words a trait. A missing label (NaN, None) leaves its walker out of that trait's fit.
        groups : array-like of shape (n_walkers,), default None
            Which person each walk is of. One unit of alpha is then an SD over persons.
        control : DataFrame, Series or array-like of shape (n_walkers,) or (n_walkers, n_controls), default None
            What no axis may go along with: numbers, or two words a column, without missing values. In a Pipeline
            ``fit(walks, y, trait__control=people[["gender", "height"]])``.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If a trait has no labels, one class only or more than two words, if `control` has missing values or leaves
            no direction for an axis, or if a parameter is out of range.
        """
        self._check_settings()
        if y is None:
            raise ValueError("requires y to be passed, but the target y is None")
        scores = validate_data(self, X, dtype=np.float64, ensure_min_samples=2)
        check_consistent_length(scores, y, groups)
        table = tabulate(y, self.poles)
        codings = learn_coding(table, self.poles)
        labels = encode(table, codings)
        controls, control_names = take_controls(control, len(scores), [coding.name for coding in codings])
        persons = None if groups is None else number_persons(groups, len(scores))
        is_single = len(getattr(y, "shape", np.shape(np.asarray(y)))) == 1
        self._learn(fit_axes(scores, labels, persons, controls), codings, control_names, is_single=is_single)
        alphas = self._alphas(scores)
        self.alphas_ = alphas if persons is None else mean_by_person(alphas, persons)
        self._report_groups(
            {
                coding.name: [float(alphas[labels[:, trait] == code, trait].mean()) for code in (-1.0, 1.0)]
                for trait, coding in enumerate(codings)
                if coding.two_valued
            }
        )
        return self

    def _check_settings(self) -> None:
        check_choice(self.alpha_unit, ALPHA_UNITS, name="alpha_unit")
        check_choice(self.direction, DIRECTIONS, name="direction")

    def _learn(self, axes: Axes, codings: list[Coding], control_names: list[str], *, is_single: bool) -> None:
        self.coef_, self.intercept_, self.mean_, self.covariance_, self.alpha_sd_ = axes
        self._codings, self._is_single = codings, is_single
        self.trait_names_ = [coding.name for coding in codings]
        self.control_names_ = control_names
        self.poles_ = {coding.name: coding.poles for coding in codings}

    def _report_groups(self, means: Mapping[str, Sequence[float]]) -> None:
        self.alpha_means_ = {name: dict(zip(self.poles_[name], pair, strict=True)) for name, pair in means.items()}
        self.alpha_boundary_ = {name: self.to_alpha(0.0, self.trait_names_.index(name)) for name in means}

    def to_alpha(self, label: float, trait: int = 0) -> float:
        """Return the alpha at which a label is predicted.

        Parameters
        ----------
        label : float
            As a number.
        trait : int, default 0
            Position of the trait.

        Returns
        -------
        float
            In `alpha_unit`; NaN for an axis without direction.
        """
        check_is_fitted(self)
        length = unit_lengths(self._axes, self.alpha_unit)[trait]
        return float((label - self.intercept_[trait]) / length) if length > 0 else float("nan")

    def to_label(self, alpha: float, trait: int = 0) -> float:
        """Return the label that is predicted at an alpha.

        Parameters
        ----------
        alpha : float
            In `alpha_unit`.
        trait : int, default 0
            Position of the trait.

        Returns
        -------
        float
            As a number.
        """
        check_is_fitted(self)
        return float(self.intercept_[trait] + alpha * unit_lengths(self._axes, self.alpha_unit)[trait])

    @property
    def _axes(self) -> Axes:
        return Axes(self.coef_, self.intercept_, self.mean_, self.covariance_, self.alpha_sd_)

    def _alphas(self, scores: NDArray[np.float64]) -> NDArray[np.float64]:
        lengths = unit_lengths(self._axes, self.alpha_unit)
        return displacement(self._axes, scores) / np.where(lengths > 0, lengths, 1.0)

    def predict(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return the predicted labels as numbers.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.

        Returns
        -------
        ndarray of shape (n_walkers,) or (n_walkers, n_traits)
            As `y` was in fit. Traits with two words are predicted between -1 and +1 and beyond.
        """
        check_is_fitted(self)
        scores = validate_data(self, X, dtype=np.float64, reset=False)
        labels = self.intercept_ + displacement(self._axes, scores)
        return labels[:, 0] if self._is_single else labels

    def transform(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return alpha, the position of each walker on each trait axis; 0 is the average walker.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.

        Returns
        -------
        ndarray of shape (n_walkers, n_traits)
            In `alpha_unit`.
        """
        check_is_fitted(self)
        return self._alphas(validate_data(self, X, dtype=np.float64, reset=False))

    def inverse_transform(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return the scores that have the given alpha on every trait.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_traits)
            In `alpha_unit`.

        Returns
        -------
        ndarray of shape (n_walkers, n_components)

        Raises
        ------
        ValueError
            If the axes are combinations of each other, so that not every alpha can be had.

        Warns
        -----
        OutsideDataWarning
            If scores are beyond `distance_limit`.
        """
        check_is_fitted(self)
        alphas = check_array(X, dtype=np.float64, input_name="X")
        if alphas.shape[1] != len(self.coef_):
            raise ValueError(
                f"expected alpha for the {len(self.coef_)} traits {self.trait_names_}, got {alphas.shape[1]}"
            )
        scores = self.mean_ + self.step(alphas, self.trait_names_)
        away = distances(scores - self.mean_, self.covariance_)
        warn_outside(away, self.distance_limit(), [f"walk {row}" for row in range(len(scores))])
        return scores

    def distance(self, X: ArrayLike) -> NDArray[np.float64]:
        """Return how far walkers are from the average walker, in SDs of the training walkers: Mahalanobis distance.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.

        Returns
        -------
        ndarray of shape (n_walkers,)
            sqrt(s' Cov^-1 s), with centered scores s.
        """
        check_is_fitted(self)
        scores = validate_data(self, X, dtype=np.float64, reset=False)
        return distances(scores - self.mean_, self.covariance_)

    def distance_limit(self, share: float = LIMIT) -> float:
        """Return the distance within which a share of new walkers lie, if they are of the kind of those in training.

        Parameters
        ----------
        share : float, default 0.99
            Between 0 and 1.

        Returns
        -------
        float
            From the F distribution (Hotelling), for normally distributed scores and as many walkers, or persons, as
            were in training. Infinite where they are no more than components. New walkers vary less than those in
            training in the directions that PCA chose because these vary most in them: more than the share lie within.
        """
        check_is_fitted(self)
        return distance_limit(self.n_walkers_, len(self.mean_), share)

    @property
    def n_walkers_(self) -> int:
        """How many walkers there were in training, or persons."""
        check_is_fitted(self)
        return len(self.alphas_) if hasattr(self, "alphas_") else self._n_walkers

    def training_alphas(self) -> NDArray[np.float64]:
        """Return `alphas_`.

        Returns
        -------
        ndarray of shape (n_persons, n_traits)

        Raises
        ------
        ValueError
            If the axes were learned without keeping them.
        """
        check_is_fitted(self)
        if not hasattr(self, "alphas_"):
            raise ValueError(
                "expected a model that knows the alphas of its training walkers, got one of which they were not kept; "
                "fit it anew with fit_stream(..., alphas=True)"
            )
        return self.alphas_

    def step(self, alphas: ArrayLike, traits: list[str]) -> NDArray[np.float64]:
        """Return the steps from a walker's score that change its alpha on some traits and leave the others free.

        Parameters
        ----------
        alphas : array-like of shape (n_steps, n_specified)
            Changes of alpha, in `alpha_unit`.
        traits : list of str
            The specified traits, of `trait_names_`.

        Returns
        -------
        ndarray of shape (n_steps, n_components)

        Raises
        ------
        ValueError
            If a trait is unknown or the traits cannot be set independently of each other.
        """
        check_is_fitted(self)
        for trait in traits:
            check_choice(trait, self.trait_names_, name="trait")
        chosen = [self.trait_names_.index(trait) for trait in traits]
        displacements = np.atleast_2d(np.asarray(alphas, dtype=np.float64))
        displacements = displacements * unit_lengths(self._axes, self.alpha_unit)[chosen]
        return move(self._axes, displacements, chosen, direction=self.direction, names=self.trait_names_)

    def score(self, X: ArrayLike, y: ArrayLike, sample_weight: ArrayLike | None = None) -> float:
        """Return the mean over traits of R2, each over the walkers that have a label.

        Parameters
        ----------
        X : array-like of shape (n_walkers, n_components)
            Scores.
        y : as in fit
            Labels.
        sample_weight : array-like of shape (n_walkers,), default None
            Weights of the walkers.

        Returns
        -------
        float
            NaN if no trait has two labelled walkers.
        """
        check_is_fitted(self)
        labels = self.encode(y)
        predicted = np.reshape(self.predict(X), labels.shape)
        weights = None if sample_weight is None else np.asarray(sample_weight)
        scores = []
        for truth, guess in zip(labels.T, predicted.T, strict=True):
            known = ~np.isnan(truth)
            if known.sum() > 1:
                share = None if weights is None else weights[known]
                scores.append(r2_score(truth[known], guess[known], sample_weight=share))
        return float(np.mean(scores)) if scores else float("nan")

    def encode(self, y: ArrayLike) -> NDArray[np.float64]:
        """Return labels as the numbers that are regressed.

        Parameters
        ----------
        y : as in fit
            Labels.

        Returns
        -------
        ndarray of shape (n_walkers, n_traits)
            Words are -1 and +1, missing labels NaN.
        """
        check_is_fitted(self)
        return encode(tabulate(y, self.poles), self._codings)

    def is_two_valued(self, trait: str) -> bool:
        """Return whether a trait was labelled with two words, not with numbers.

        Parameters
        ----------
        trait : str
            One of `trait_names_`.
        """
        check_is_fitted(self)
        check_choice(trait, self.trait_names_, name="trait")
        return self._codings[self.trait_names_.index(trait)].two_valued

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Return the names of the traits.

        Parameters
        ----------
        input_features : object, default None
            Ignored.
        """
        check_is_fitted(self)
        return np.array(self.trait_names_, dtype=object)

    def __sklearn_tags__(self):
        """Tell scikit-learn that many traits can be learned at once."""
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        tags.target_tags.single_output = True
        return tags
