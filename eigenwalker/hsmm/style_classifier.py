"""Which style a walk has, by the likelihood of one gait model a style."""

from collections.abc import Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.base import BaseEstimator, ClassifierMixin, clone
from sklearn.utils.validation import check_is_fitted

from eigenwalker._validation import check_choice, check_walks
from eigenwalker.hsmm.adaptation import METHODS
from eigenwalker.hsmm.gait_hsmm import GaitHSMM
from eigenwalker.motion.walk import JointWalk

__all__ = ["StyleClassifier"]


class StyleClassifier(ClassifierMixin, BaseEstimator):
    """Style of walks: that of the model under which they are most likely.

    An average model is trained on all walks, and adapted to those of each style.

    Parameters
    ----------
    gait : GaitHSMM, default None
        The average model to train, cloned; None is ``GaitHSMM()``.
    method : str, default "csmaplr+map"
        See `GaitHSMM.adapt`.
    transform_weight : float, default 1000.0
        Of the prior of transforms.
    map_weight : float, default 30.0
        Of the prior of MAP.
    adapt_to : int, default None
        Most walks of each style that it is adapted to, the first ones. None is all.

    Attributes
    ----------
    classes_ : ndarray of shape (n_styles,)
        Names of the styles, sorted.
    average_ : GaitHSMM
        Of all walks.
    styles_ : list of GaitHSMM
        One a style.

    Examples
    --------
    >>> from eigenwalker.hsmm import StyleClassifier
    >>> from sklearn.model_selection import cross_val_score
    >>> cross_val_score(StyleClassifier(), walks, styles, cv=5)  # doctest: +SKIP
    """

    def __init__(
        self,
        gait: GaitHSMM | None = None,
        *,
        method: str = "csmaplr+map",
        transform_weight: float | None = 1000.0,
        map_weight: float | None = 30.0,
        adapt_to: int | None = None,
    ) -> None:
        self.gait = gait
        self.method = method
        self.transform_weight = transform_weight
        self.map_weight = map_weight
        self.adapt_to = adapt_to

    def fit(self, X: Sequence[JointWalk], y: Sequence[Any]) -> Self:
        """Train the average model and adapt it to each style.

        Parameters
        ----------
        X : list of JointWalk
            Whole walks, see `GaitHSMM.fit`.
        y : sequence of str
            The style of each.

        Returns
        -------
        self

        Raises
        ------
        ValueError
            If there is not one style a walk, or there are fewer than two styles.
        """
        walks = check_walks(X, kind=JointWalk)
        if self.adapt_to is not None and not self.adapt_to >= 1:
            raise ValueError(f"adapt_to must be 1 or more, or None, got {self.adapt_to!r}")
        check_choice(self.method, METHODS, name="method")
        styles = np.asarray(y)
        if styles.shape != (len(walks),):
            raise ValueError(f"expected a style for each of the {len(walks)} walks, got shape {styles.shape}")
        self.classes_ = np.unique(styles)
        if len(self.classes_) < 2:
            raise ValueError(f"expected walks of at least two styles, got {self.classes_.tolist()}")
        self.average_ = clone(GaitHSMM() if self.gait is None else self.gait).fit(walks)
        self.styles_ = [
            self.average_.adapt(
                [walk for walk, own in zip(walks, styles, strict=True) if own == style][: self.adapt_to],
                method=self.method,
                transform_weight=self.transform_weight,
                map_weight=self.map_weight,
            )
            for style in self.classes_
        ]
        return self

    def log_likelihoods(self, X: Sequence[JointWalk]) -> NDArray[np.float64]:
        """Return the log-likelihood per frame of walks under the model of each style.

        Parameters
        ----------
        X : list of JointWalk
            Walks.

        Returns
        -------
        ndarray of shape (n_walks, n_styles)
            In nats. Channels of neighboring frames tell nearly the same, so that differences times the number of frames
            are no fair odds.
        """
        check_is_fitted(self)
        walks = check_walks(X, kind=JointWalk)
        return np.array([[style.score([walk]) for style in self.styles_] for walk in walks])

    def decision_function(self, X: Sequence[JointWalk]) -> NDArray[np.float64]:
        """Return what scores such as "roc_auc" go by.

        Parameters
        ----------
        X : list of JointWalk
            Walks.

        Returns
        -------
        ndarray of shape (n_walks,) or (n_walks, n_styles)
            Of two styles how much more likely the second is, of more styles `log_likelihoods`; nats per frame.
        """
        likelihoods = self.log_likelihoods(X)
        return likelihoods[:, 1] - likelihoods[:, 0] if len(self.classes_) == 2 else likelihoods

    def predict(self, X: Sequence[JointWalk]) -> NDArray[Any]:
        """Return the style of each walk, shape (n_walks,).

        Parameters
        ----------
        X : list of JointWalk
            Walks.
        """
        check_is_fitted(self)
        return self.classes_[self.log_likelihoods(X).argmax(axis=1)]

    def __sklearn_tags__(self):
        """Tell scikit-learn that the input is a list of walks."""
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        tags.no_validation = True
        return tags
