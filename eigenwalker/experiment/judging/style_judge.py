"""A judge of styles that learns from recorded walks alone, and is asked about walks that it has not seen."""

from collections.abc import Sequence
from typing import Any, Self
from zlib import crc32

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from sklearn.base import BaseEstimator, TransformerMixin, clone
from sklearn.discriminant_analysis import LinearDiscriminantAnalysis
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils import check_random_state
from sklearn.utils.validation import check_is_fitted

from eigenwalker._validation import check_walks
from eigenwalker.model.linearization import FourierLinearizer
from eigenwalker.motion.walk import JointWalk, Walk

__all__ = ["JudgedFeatures", "judge_styles", "make_style_judge"]

_Walks = Sequence[Walk | JointWalk]


class JudgedFeatures(TransformerMixin, BaseEstimator):
    """What a judge sees of walks: Fourier coefficients, less what it is not to see, and not very well.

    With everything that a walk shows a judge of acted styles is right nearly always, and agrees with any synthesis that
    is not all wrong. What tells styles apart too easily, mean posture and frequency, is left out by default, and so are
    most joints; and noise is added to the coefficients of all walks alike.

    Parameters
    ----------
    harmonics : sequence of int, default (1,)
        Which are seen; 1 is the fundamental.
    mean : bool, default False
        Whether the mean posture is seen.
    frequency : bool, default False
        Whether the stride frequency is seen.
    share : float, default 0.3
        Of the joints, or markers, that are seen, picked at random when it is fitted.
    noise : float, default 0.05
        Standard deviation of what is added to each coefficient, in units of the channels: radians of joint walks, where
        0.05 is 3 degrees, or metres.
    random_state : int, RandomState or None, default None
        Seed of what is picked, and of the noise.

    Attributes
    ----------
    linearizer_ : FourierLinearizer
        With as many harmonics as the highest.
    columns_ : ndarray of int of shape (n_seen,)
        Which of its features are seen.
    seed_ : int
        Of the noise: the same walks look the same each time.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import JudgedFeatures
    >>> walks = make_walkers(4, random_state=0).data
    >>> JudgedFeatures(share=0.2, random_state=0).fit_transform(walks).shape  # 3 markers, sine and cosine of x, y, z
    (4, 18)
    """

    def __init__(
        self,
        harmonics: Sequence[int] = (1,),
        *,
        mean: bool = False,
        frequency: bool = False,
        share: float = 0.3,
        noise: float = 0.05,
        random_state: int | np.random.RandomState | None = None,
    ) -> None:
        self.harmonics = harmonics
        self.mean = mean
        self.frequency = frequency
        self.share = share
        self.noise = noise
        self.random_state = random_state

    def fit(self, X: _Walks, y: object = None) -> Self:
        """Pick what is seen.

        Parameters
        ----------
        X : list of Walk or JointWalk
            Prepared walks, all with the same channels.
        y : object, default None
            Ignored.

        Returns
        -------
        self

        Raises
        ------
        WalkError
            If walks differ in their channels.
        ValueError
            If a parameter is out of range.
        """
        walks = check_walks(X, kind=(Walk, JointWalk))
        self._check_parameters()
        random = check_random_state(self.random_state)
        self.linearizer_ = FourierLinearizer(max([1, *self.harmonics])).fit(walks)
        n_channels = len(self.linearizer_.template_.channel_names)
        n_parts = n_channels // 3
        picked = np.sort(random.choice(n_parts, max(1, round(self.share * n_parts)), replace=False))
        channels = (3 * picked[:, np.newaxis] + np.arange(3)).ravel()
        blocks = [0] * self.mean + [row for k in self.harmonics for row in (2 * k - 1, 2 * k)]
        last = [(2 * self.linearizer_.n_harmonics + 1) * n_channels] * self.frequency
        self.columns_ = np.concatenate([*(n_channels * block + channels for block in blocks), last]).astype(np.intp)
        self.seed_ = int(random.randint(2**31 - 1))
        return self

    def transform(self, X: _Walks) -> NDArray[np.float64]:
        """Return what is seen of each walk.

        Parameters
        ----------
        X : list of Walk or JointWalk
            Prepared walks with the channels of `fit`.

        Returns
        -------
        ndarray of shape (n_walks, n_seen)
            Coefficients with noise; the frequency, the last one where it is seen, has none.
        """
        check_is_fitted(self)
        seen = self.linearizer_.transform(X)[:, self.columns_]
        n_noisy = seen.shape[1] - bool(self.frequency)
        for row in seen:  # its own noise for each walk, whatever walks are beside it
            random = np.random.default_rng([self.seed_, crc32(row.tobytes())])
            row[:n_noisy] += self.noise * random.normal(size=n_noisy)
        return seen

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:
        """Return the names of what is seen, as `FourierLinearizer` has them.

        Parameters
        ----------
        input_features : object, default None
            Ignored; the input is walks.
        """
        check_is_fitted(self)
        return self.linearizer_.get_feature_names_out()[self.columns_]

    def _check_parameters(self) -> None:
        whole = [k for k in self.harmonics if int(k) == k and k >= 1]
        faults = []
        if len(whole) < len(self.harmonics) or len(set(whole)) < len(whole):
            faults.append(f"harmonics must be different whole numbers of at least 1, got {tuple(self.harmonics)!r}")
        if not (self.harmonics or self.mean or self.frequency):
            faults.append("harmonics must not be empty where neither mean nor frequency is seen")
        if not 0 < self.share <= 1:
            faults.append(f"share must be above 0 and at most 1, got {self.share!r}")
        if not self.noise >= 0:
            faults.append(f"noise must be 0 or more, got {self.noise!r}")
        if faults:
            raise ValueError("\n".join(faults))

    def __sklearn_tags__(self):
        """Tell scikit-learn that the input is a list of walks."""
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        tags.no_validation = True
        return tags


def make_style_judge(classifier: BaseEstimator | None = None, **seen: Any) -> Pipeline:
    """Return a judge: what it sees of walks, in standard units, and a classifier.

    Parameters
    ----------
    classifier : estimator, default None
        Any classifier of scikit-learn. None is linear discriminant analysis with Ledoit and Wolf's shrinkage, which
        takes more features than walks.
    **seen
        Parameters of `JudgedFeatures`.

    Returns
    -------
    Pipeline
        Not fitted; its input is a list of prepared walks.

    Examples
    --------
    >>> from eigenwalker.experiment import make_style_judge
    >>> [name for name, _ in make_style_judge(harmonics=(1, 2)).steps]
    ['features', 'scaler', 'classifier']
    """
    if classifier is None:
        classifier = LinearDiscriminantAnalysis(solver="lsqr", shrinkage="auto")
    return Pipeline([("features", JudgedFeatures(**seen)), ("scaler", StandardScaler()), ("classifier", classifier)])


def judge_styles(
    train: _Walks,
    train_styles: ArrayLike,
    originals: _Walks,
    original_styles: ArrayLike,
    synthetics: _Walks,
    synthetic_styles: ArrayLike,
    *,
    judge: BaseEstimator | None = None,
) -> pd.DataFrame:
    """Return what a judge that has learned from recorded walks takes others for: trials as of people.

    Parameters
    ----------
    train, originals, synthetics : list of Walk or JointWalk
        Recorded walks to learn from; recorded ones that it has not seen; and synthetic ones, none of which it has seen
        and whose models should not have learned from `originals`. All prepared alike, see `cut_alike`.
    train_styles, original_styles, synthetic_styles : array-like of str
        Of each walk.
    judge : estimator, default None
        What learns; None is `make_style_judge` with random_state=0. It is cloned.

    Returns
    -------
    DataFrame
        One row a walk: truth, answer, kind, walk. It is what `recognition_table` and its neighbors take.

    Raises
    ------
    ValueError
        If there is not one style a walk, or a style that is asked about was not learned.

    Examples
    --------
    >>> from eigenwalker.datasets import make_walkers
    >>> from eigenwalker.experiment import judge_styles
    >>> walks, styles = make_walkers(12, random_state=0).data, ["a", "b"] * 6
    >>> judge_styles(walks[:8], styles[:8], walks[8:10], styles[8:10], walks[10:], styles[10:]).columns.tolist()
    ['truth', 'answer', 'kind', 'walk']
    """
    series = {"train": (train, train_styles), "original": (originals, original_styles)}
    known = {
        name: (check_walks(walks, kind=(Walk, JointWalk)), np.asarray(styles, dtype=str))
        for name, (walks, styles) in (series | {"synthetic": (synthetics, synthetic_styles)}).items()
    }
    for name, (walks, styles) in known.items():
        if styles.shape != (len(walks),):
            raise ValueError(f"expected a style for each of the {len(walks)} {name} walks, got shape {styles.shape}")
    learned = set(known["train"][1])
    foreign = sorted((set(known["original"][1]) | set(known["synthetic"][1])) - learned)
    if foreign:
        raise ValueError(f"expected styles to learn from for all that are asked about, none for: {', '.join(foreign)}")
    fitted = clone(make_style_judge(random_state=0) if judge is None else judge).fit(*known.pop("train"))
    return pd.concat([_answers(fitted, kind, *part) for kind, part in known.items()], ignore_index=True)


def _answers(judge: Any, kind: str, walks: list[Walk | JointWalk], styles: NDArray[np.str_]) -> pd.DataFrame:
    names = [walk.name for walk in walks]
    return pd.DataFrame({"truth": styles, "answer": judge.predict(walks), "kind": kind, "walk": names})
